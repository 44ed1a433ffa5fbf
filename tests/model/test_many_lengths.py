"""Many cables whose lengths change: the numbers that follow them are found for cables that do not meet at once."""

from types import SimpleNamespace

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Scene, nets, signals
from anet_lumped.effects import Gravity, Ground, LineChange, Water
from anet_lumped.model import build as building
from anet_lumped.model import rest_lengths
from anet_lumped.model.build import build


def reeled_net(meshes):
    """A net in the sea of which every cable is reeled."""
    cable = {"mass_per_length": 0.02, "EA": 5e3, "segments": 2, "diameter": 0.003}
    parts = nets.grid((meshes, meshes), [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], cable=cable, held="corners", slack=0.05)
    reels = LineChange({c.name: signals.line(0.0, 1e-3 * (1 + k), 0.1) for k, c in enumerate(parts.cables)})
    return Scene(parts.points, parts.cables, [Gravity(), Water(), Ground(height=-3.0), reels])


def test_slopes_are_those_of_one_cable_at_a_time():
    scene = reeled_net(3)
    model = build(scene)
    lengths = model.lengths
    assert len(lengths.cable) == len(scene.cables)
    for k, cable in enumerate(scene.cables):
        at, slopes = rest_lengths._slopes_of_cable(scene, model, cable.name, building._params_of)
        own = slice(lengths.param_at[k], lengths.param_at[k + 1])
        np.testing.assert_array_equal(lengths.param[own], at)
        np.testing.assert_allclose(lengths.param_slope[own], slopes, rtol=1e-9)
        longer = rest_lengths._with_lengths(scene, {cable.name: 1.0})
        mass, _ = building._numbers(longer, model.node_of, model.cable, model.n_free)
        grown = np.zeros(model.n)
        own = slice(lengths.mass_at[k], lengths.mass_at[k + 1])
        grown[lengths.mass_node[own]] = lengths.mass_slope[own]
        np.testing.assert_allclose(mass - model.mass, grown, atol=1e-12)


def test_a_larger_net_is_looked_at_as_often(monkeypatch):
    """Two looks at each cable made a net of 1740 cables wait for 200 s before its first step."""
    looks = []
    params_of = building._params_of
    monkeypatch.setattr(building, "_params_of", lambda *given: looks.append(1) or params_of(*given))
    counts = []
    for meshes in (4, 8):
        looks.clear()
        build(reeled_net(meshes))
        counts.append(len(looks))
    assert counts[0] == counts[1] < 20


@pytest.mark.parametrize(
    "of_lengths",
    [
        lambda a, b: [2.0 * a, 3.0 * b],
        lambda a, b: [a + b, b],  # of cables that do not meet
        lambda a, b: [a + 0.5 * b, a - b],
    ],
)
def test_numbers_that_change_with_cables_apart(of_lengths):
    ends = [Fixed(name, (k, 0, 0)) for k, name in enumerate("abcd")]
    kind = {"mass_per_length": 0.1, "EA": 1e3, "segments": 1}
    scene = Scene(ends, [Cable("a", "b", length=1.5, **kind), Cable("c", "d", length=2.0, **kind)])

    def params_of(_, longer):
        return np.array(of_lengths(*(cable.length for cable in longer.cables)))

    model = SimpleNamespace(effects=SimpleNamespace(params=params_of(None, scene)))
    slopes = rest_lengths._slopes(scene, model, ["a-b", "c-d"], params_of)
    for k, name in enumerate(("a-b", "c-d")):
        at, own = slopes[name]
        found = np.zeros(2)
        found[at] = own
        np.testing.assert_allclose(found, np.array(of_lengths(*np.eye(2)[k])), rtol=1e-12)
