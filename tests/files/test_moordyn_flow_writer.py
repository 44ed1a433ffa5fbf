"""Waves and currents written for MoorDyn: read back, and run by MoorDyn."""

import math

import numpy as np
import pytest
from beside_moordyn import begun, march, nodes_of_line
from slow import slow

from anet_lumped import Cable, Fixed, Scene, SceneError, equilibrium, read_moordyn, save_moordyn, simulate, waves, wind
from anet_lumped.effects import Gravity, GroundMap, MoordynBottom, Water
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.waves.kernel import wave_at
from anet_lumped.files.moordyn_writer import moordyn_text

PROFILE = wind.Sampled(((-40.0, 0.1, 0.2), (-10.0, 0.5, 0.3), (0.0, 1.0, 0.1)))
SUM = waves.Components(((0.8, 0.6, 0.4, 0.2), (0.5, 0.9, 1.0, -0.4)), depth=50.0)
BOTTOM = MoordynBottom(-50.0)


def scene(*bottom, **flow):
    fields = {"EA": 5e6, "BA": 1e5, "diameter": 0.1, "Cdn": 1.2, "Can": 1.0, "Cdt": 0.05, "Cat": 0.0, "compression": "damped"}
    cable = Cable("a", "b", length=66.0, segments=12, mass_per_length=25.0, **fields)
    water = Water(1025.0, points_float=False, **flow)
    return Scene([Fixed("a", (50, 0, -40)), Fixed("b", (0, 0, -2))], [cable], [Gravity(9.80665), water, *bottom])


def read_back(of, folder):
    save_moordyn(of, folder / "flow.txt")
    return read_moordyn(folder / "flow.txt", like_moordyn=True).scene


@pytest.mark.filterwarnings("ignore::anet_lumped.files.moordyn_findings.DeckWarning")
def test_a_profile_is_read_back(tmp_path):
    of = scene(BOTTOM, current=PROFILE)
    assert read_back(of, tmp_path) == of


@pytest.mark.filterwarnings("ignore::anet_lumped.files.moordyn_findings.DeckWarning")
def test_currents_add_up(tmp_path):
    """At each height of either, and linear in between, as both are."""
    rising = wind.Gridded(((0.0, 0.0, 0.1), (0.2, 0.0, 0.1)), (-20.0, 0.0))
    back = read_back(scene(BOTTOM, current=(wind.Uniform((0.1, 0.0, 0.0)), PROFILE, rising)), tmp_path)
    current = back.effects[1].current
    assert current.z == (-40.0, -20.0, -10.0, 0.0)
    expected = [(0.2, 0.2, 0.1), (0.1 + 0.1 + 0.4 * 2 / 3, 0.2 + 0.1 * 2 / 3, 0.1), (0.7, 0.3, 0.1), (1.3, 0.1, 0.1)]
    np.testing.assert_allclose(current.velocity, expected, rtol=1e-12)
    uniform = read_back(scene(BOTTOM, current=wind.Uniform((0.1, 0.2, 0.0))), tmp_path).effects[1].current
    assert {sample[1:] for sample in uniform.samples} == {(0.1, 0.2)}


@pytest.mark.filterwarnings("ignore::anet_lumped.files.moordyn_findings.DeckWarning")
@pytest.mark.parametrize("bottom", [(BOTTOM,), ()], ids=["bottom", "no bottom"])
def test_waves_are_read_back(tmp_path, bottom):
    of = scene(*bottom, waves=(SUM, waves.Airy(height=1.0, period=7.0, direction=(0, 1, 0), depth=50.0, phase=0.3)))
    back = read_back(of, tmp_path)
    for t, place in ((0.0, (3.0, 2.0, -5.0)), (1.5, (10.0, -4.0, -20.0))):
        ours, theirs = (wave_at(t, *place, pack_waves(one.effects[1].all_waves, 9.80665, 0.0)) for one in (of, back))
        assert theirs[0][0] == pytest.approx(ours[0][0], abs=1e-13)
        np.testing.assert_allclose(theirs[1], ours[1], atol=1e-13)


@pytest.mark.parametrize(
    ("bottom", "flow", "message"),
    [
        (
            (),
            {"current": wind.PowerLaw(1.0, 10.0, exponent=0.1)},
            "A current must be made of Uniform and Sampled, .* Water has PowerLaw",
        ),
        ((), {"current": wind.Gridded(((0, 0, 0), (1, 0, 0)), (0.0,), (0.0, 9.0))}, "that changes over the height alone"),
        ((BOTTOM,), {"wave": waves.Airy(1.0, 7.0, ramp=5.0, depth=50.0)}, r"must be there from the start .* one has ramp=5\.0"),
        ((BOTTOM,), {"wave": waves.Airy(1.0, 7.0)}, r"must have the depth of the water .* have \[inf\] m over a bottom 50 m deep"),
        ((), {"waves": waves.Components(((0.5, 0.0, 0.0, 0.0), (0.1, 1.0, 0.0, 0.0)))}, "no constant elevation"),
        ((GroundMap((0, 1), (0, 1), ((-50, -50), (-50, -51))),), {"wave": waves.Airy(1.0, 7.0)}, "over a flat bottom"),
    ],
)
def test_flow_that_moordyn_does_not_have(bottom, flow, message):
    with pytest.raises(SceneError, match=message):
        moordyn_text(scene(*bottom, **flow))


def test_deep_water_is_as_deep_as_it_has_to_be():
    assert math.isinf(waves.Airy(1.0, 7.0).depth) and "10000.0 WtrDpth" in moordyn_text(scene(wave=waves.Airy(1.0, 7.0)))


@pytest.mark.filterwarnings("ignore::anet_lumped.files.moordyn_findings.DeckWarning")
@pytest.mark.parametrize(
    ("flow", "share"),
    [*slow(({"current": PROFILE}, 5e-4)), ({"current": wind.Uniform((0.8, 0.3, 0.0)), "waves": SUM}, 5e-3)],
    ids=["profile", "waves and a current"],
)
def test_moordyn_moves_as_we_do(tmp_path, flow, share):
    """From the rest in still water. MoorDyn takes drag along the chord of two segments: 0.3 % of the way where the flow is fast."""
    of, quiet = (
        scene(BOTTOM, **flow),
        {"dtM": 1e-3, "TmaxIC": 120, "threshIC": 1e-6, "tScheme": "RK4", "disableOutput": 1, "writeLog": 0},
    )
    save_moordyn(of, tmp_path / "flow.txt", quiet)
    with begun(tmp_path / "flow.txt") as (moordyn, engine):
        march(moordyn, engine, 3.0, 0.1)
        theirs = nodes_of_line(moordyn, engine, 12)
    run = simulate(of, 3.0, method="edmc", dt=5e-3, start=equilibrium(scene(BOTTOM)))
    shapes = run.shape("a-b")
    way = np.linalg.norm(shapes[-1] - shapes[0], axis=1).max()
    assert way > 0.1 and np.abs(shapes[-1] - theirs).max() < share * way
