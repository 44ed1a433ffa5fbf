"""Rest and motion wherever a scene stands: the same tensions, places in the user's coordinates, and restarts without loss."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, RunError, Scene, equilibrium, load_run, simulate
from anet_lumped.effects import REGISTRY, Gravity, node_force

HERE, UTM = (0.0, 0.0, 0.0), (500_000.0, 5_000_000.0, 0.0)
AT = [(999_990.0, 0.0, 0.0), (1_000_010.0, 0.0, 0.0), UTM, (0.0, 0.0, -4e7)]


def hung(at, EA=1e6, effects=(), **cable):
    points = [Fixed("a", at), Fixed("b", np.add(at, (1.5, 0.25, 0.5))), Free("p", 0.1)]
    both = {"length": 1.0, "mass_per_length": 0.1, "EA": EA, "segments": 5, "zeta": 0.05} | cable
    return Scene(points, [Cable("a", "p", **both), Cable("p", "b", **both)], [Gravity(9.81), *effects])


@pytest.mark.parametrize("at", AT)
def test_rest_is_the_same(at):
    here, there = equilibrium(hung(HERE)), equilibrium(hung(at))
    np.testing.assert_allclose(there.segment_tension, here.segment_tension, rtol=1e-9)
    np.testing.assert_array_equal(there.q, here.q + at)
    assert there.scene == hung(at)


@pytest.mark.each_once
@pytest.mark.parametrize("method", ["edmc", "verlet", "dop853", "RK45"])
@pytest.mark.parametrize("at", AT[1:])
def test_motion_is_the_same(at, method):
    asked = {"method": method, "start": "straight"} | ({"dt": 1e-3} if method == "edmc" else {})
    scenes = [
        replace(hung(one, EA=1e3), points=[*hung(one).points[:2], Free("p", 0.1, at=np.add(one, (0.75, 0.0, -0.5)))])
        for one in (HERE, at)
    ]
    here, there = (simulate(scene, 0.2, **asked) for scene in scenes)
    assert there.status == "done"
    np.testing.assert_allclose(there.segment_tension, here.segment_tension, rtol=1e-9, atol=1e-9 * here.segment_tension.max())
    np.testing.assert_array_equal(there.q, here.q + at)
    assert there.scene == scenes[1]


@pytest.mark.parametrize("start", ["state", "shapes"])
def test_a_run_goes_on_where_another_ended(start):
    """From a State no digit is lost; shapes of the user's have those of their coordinates, 1e-9 m, or 1e-3 N in a segment here."""
    runs = []
    for at in (HERE, UTM):
        state = simulate(hung(at), 0.1, method="edmc", dt=1e-3).state(-1)
        shapes = {cable: state.shape(cable) for cable in ("a-p", "p-b")}
        runs.append(simulate(hung(at), 0.2, method="edmc", dt=1e-3, start=state if start == "state" else shapes))
    here, there = (run.segment_tension for run in runs)
    atol = 1e-9 * here.max() if start == "state" else 1e6 / 0.2 * 1e-9
    np.testing.assert_allclose(there, here, rtol=0, atol=atol)


def test_places_that_a_user_has_changed_are_those_that_count():
    rest = equilibrium(hung(UTM))
    lifted = replace(rest, q=rest.q + np.where(np.arange(len(rest.q))[:, None] < rest.model.n_free, (0.0, 0.0, 0.01), 0.0))
    run = simulate(hung(UTM), 0.01, method="edmc", dt=1e-3, start=lifted)
    np.testing.assert_allclose(run.q[0], lifted.q, atol=1e-9)


def test_a_saved_run_comes_back(tmp_path):
    run = simulate(hung(UTM), 0.05, method="edmc", dt=1e-3)
    run.save(tmp_path / "run.nc")
    again = load_run(tmp_path / "run.nc")
    np.testing.assert_array_equal(again.q, run.q)
    assert simulate(again.scene, 0.05, method="edmc", dt=1e-3, start=again.state(-1)).status == "done"


def test_a_run_that_fails_comes_back_in_the_coordinates_of_the_scene():
    far = hung(UTM, EA=1e8)
    with pytest.warns(UserWarning, match="step"), pytest.raises(RunError) as stopped:
        simulate(far, 0.5, method="verlet", dt=1e-3, check=True, start="straight" if far.points[2].at else "equilibrium")
    assert stopped.value.run.scene == far
    assert np.abs(stopped.value.run.q[0] - UTM).max() < 5.0


def test_where_the_origin_is_held_it_is_said(monkeypatch):
    monkeypatch.setattr(REGISTRY, "classes", dict(REGISTRY.classes))

    @node_force
    def nothing_at_all(t, q, v):
        return 0.0, 0.0, 0.0

    far = hung(UTM, effects=[nothing_at_all()])
    with pytest.warns(UserWarning, match=r"rounded to 9e-10 m, which is 0.005 N in a segment .* nothing_at_all depends on places"):
        run = simulate(far, 0.05, method="edmc", dt=1e-3, start=equilibrium(hung(UTM)))
    assert run.status == "done"


def test_a_scene_larger_than_a_million_metres_moves():
    tether = Scene(
        [Fixed("a", HERE), Free("b", 100.0, at=(0.0, 0.0, -3e7))],
        [Cable("a", "b", length=3e7, mass_per_length=1e-3, EA=1e6, segments=10, zeta=0.1)],
        [Gravity(0.1)],
    )  # fmt: skip
    assert simulate(tether, 100.0, start="straight").status == "done"
