"""What many cables at one point cost grows as they do: no two of them are compared, and each is looked at a few times."""

import numpy as np
import pytest

from anet_lumped import Cable, EquilibriumError, Fixed, Free, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity
from anet_lumped.model.reach import shortfall


def star(n, EA=1e4):
    """Cables from n points on a circle to one junction in its middle."""
    turns = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    points = [Fixed(f"p{i}", (np.cos(turn), np.sin(turn), 0.0)) for i, turn in enumerate(turns)]
    cables = [Cable(f"p{i}", "q", length=1.2, mass_per_length=0.1, EA=EA, zeta=0.05, segments=2) for i in range(n)]
    return Scene([*points, Free("q", 1.0, at=(0.0, 0.0, 0.0))], cables, [Gravity(9.81)])


@pytest.mark.parametrize("compute", [equilibrium, lambda scene: simulate(scene, 0.02, dt=0.01, start="straight")])
def test_no_two_cables_are_compared(compute, monkeypatch):
    scene, compared = star(150), []
    monkeypatch.setattr(Cable, "__eq__", lambda one, other: compared.append(one) or one.name == other.name)
    compute(scene)
    assert len(compared) <= 6 * 150  # equal scenes are looked up by hash and compared, cable by cable


def test_the_search_for_supports_is_quick():
    """A second; with sets of points that are merged one by one it would take minutes."""
    assert equilibrium(star(20_000)).residual < 1e-9


def test_parts_that_nothing_holds_are_named():
    scene = star(3)
    apart = [Free("u"), Free("v"), Free("w")]
    loose = [Cable(a, b, length=1.0, mass_per_length=0.1, EA=1e4, segments=2) for a, b in (("u", "v"), ("v", "w"))]
    with pytest.raises(EquilibriumError, match='nothing holds free point "u" and the 2 others it is tied to'):
        equilibrium(Scene([*scene.points, *apart], [*scene.cables, *loose], scene.effects))


def test_a_way_that_is_too_short_is_found_among_many():
    scene = star(200, EA=np.inf)
    assert shortfall(scene, 0.0) is None
    cables = [Cable(c.start, c.end, length=0.9 if c.start in ("p10", "p110") else 1.2, mass_per_length=0.1, EA=np.inf, segments=2)
              for c in scene.cables]  # fmt: skip
    found = shortfall(Scene(scene.points, cables, scene.effects), 0.0)
    assert found.ends == ("p10", "p110")
    assert found.length == pytest.approx(1.8) and found.distance == pytest.approx(2.0)
