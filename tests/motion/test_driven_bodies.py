"""Bodies whose motion is prescribed: their points move as one piece, and cables follow."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from anet_lumped import Body, Cable, Driven, Free, Scene, equilibrium, load_run, load_scene, paths, save_scene, simulate
from anet_lumped.effects import Gravity

TURNING = {
    "steady": paths.line((0.0, 0.0, 0.0), (0.0, 0.0, 2.0), ramp=1.0),
    "shaken": paths.harmonic((0.1, 0.2, 0.0), (0.5, -0.7, 1.1), frequency=0.7),
    "small": paths.harmonic((0.0, 0.0, 0.0), (1e-3, 2e-3, -1e-3), frequency=1.3),
    "none": None,
}


def arm(turning=None, **given):
    arguments = dict(path=paths.line((0.0, 0.0, 1.0), (0.1, 0.0, 0.0), ramp=1.0), rotation=(0.1, 0.2, 0.3)) | given
    return Body("arm", turning=turning, attachments={"tip": (0.5, 0.1, 0.0)}, **arguments)


def hung(body, **given):
    cable = Cable("arm.tip", "w", **dict(length=0.5, mass_per_length=0.05, EA=1e4, zeta=0.1, segments=6) | given)
    return Scene([Free("w", mass=0.2)], [cable], [Gravity()], bodies=[body])


@pytest.mark.parametrize("turning", TURNING)
@pytest.mark.parametrize("t", [0.0, 0.3, 1.0, 2.7])
def test_paths_of_its_points(turning, t):
    """Place by SciPy's rotations; velocity and acceleration by differences of five points."""
    body = arm(TURNING[turning])
    tip = body.points[1].path
    phi = np.zeros(3) if body.turning is None else body.turning.at(t)[0]
    expected = body.path.at(t)[0] + (Rotation.from_rotvec(phi) * Rotation.from_rotvec(body.rotation)).apply((0.5, 0.1, 0.0))
    assert_allclose(tip.at(t)[0], expected, atol=1e-14)
    if t == 0.0:  # a corner of the shaken ones, which are at rest before
        return
    h = 1e-3
    for order in (0, 1):
        at = [tip.at(t + k * h)[order] for k in (-2, -1, 1, 2)]
        assert_allclose(tip.at(t)[order + 1], (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h), atol=1e-7)


@pytest.mark.parametrize("method", ["edmc", "dop853", "verlet"])
def test_compiled_paths_are_those_of_python(method):
    scene = hung(arm(TURNING["shaken"]))
    steps = {"edmc": {"dt": 0.002}, "verlet": {"dt": 1e-4}, "dop853": {"rtol": 1e-8}}[method]
    run = simulate(scene, 1.0, method=method, save_every=0.1, **steps)
    tip = scene.point("arm.tip").path
    assert_allclose(run.position("arm.tip"), [tip.at(t)[0] for t in run.t], atol=1e-14)
    assert_allclose(run.velocity("arm.tip"), [tip.at(t)[1] for t in run.t], atol=1e-13)
    assert abs(run.energy_balance.imbalance) < 1e-7


def test_a_body_that_shifts_alone_is_a_driven_point():
    body = arm()
    carried = hung(body)
    path = paths.line(tuple(body.points[1].path.at(0.0)[0]), (0.1, 0.0, 0.0), ramp=1.0)
    driven = Scene([Driven("tip", path), *carried.points], [replace(carried.cables[0], start="tip")], carried.effects)
    one, other = (simulate(scene, 1.0, method="edmc", dt=0.005) for scene in (carried, driven))
    assert_allclose(one.position("w"), other.position("w"), atol=1e-13)


def test_edmc_tends_to_dop853_and_to_links():
    scene = hung(arm(TURNING["steady"]))
    rigid = replace(scene, cables=[replace(scene.cables[0], EA=np.inf, zeta=0.0)])
    for one, fine in ((scene, "dop853"), (rigid, "links")):
        exact = simulate(one, 2.0, method=fine, rtol=1e-10).position("w")[-1]
        errors = [np.abs(simulate(one, 2.0, method="edmc", dt=dt).position("w")[-1] - exact).max() for dt in (0.008, 0.004)]
        assert errors[1] < 3e-4 and errors[0] / errors[1] > 3.3


def test_rotations_are_told_and_saved(tmp_path):
    scene = hung(arm(TURNING["steady"]))
    run = simulate(scene, 2.0, method="edmc", dt=0.01)
    phi = scene.bodies[0].turning.at(2.0)[0]
    expected = Rotation.from_rotvec(phi) * Rotation.from_rotvec((0.1, 0.2, 0.3))
    assert_allclose(run.rotation("arm")[-1], expected.as_matrix(), atol=1e-14)
    assert_allclose(run.final.angular_velocity("arm"), (0.0, 0.0, 2.0), atol=1e-13)
    assert_allclose(np.linalg.norm(run.quaternion("arm"), axis=1), 1.0, atol=1e-14)
    run.save(tmp_path / "run.nc")
    again = load_run(tmp_path / "run.nc")
    assert np.array_equal(again.q, run.q) and again.scene == scene
    save_scene(scene, tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == scene


def test_far_from_the_origin_it_moves_as_near_it():
    near = hung(arm(TURNING["shaken"]))
    body = arm(TURNING["shaken"], path=paths.line((5e5, -3e5, 1.0), (0.1, 0.0, 0.0), ramp=1.0))
    one, other = (simulate(scene, 0.5, method="edmc", dt=0.005) for scene in (near, hung(body)))
    assert_allclose(other.position("w") - (5e5, -3e5, 0.0), one.position("w"), atol=1e-8)
    assert_allclose(other.segment_tension, one.segment_tension, rtol=1e-9)


def test_a_rest_stands_where_the_motion_begins():
    rest = equilibrium(hung(arm(TURNING["shaken"])))
    assert_allclose(rest.position("w")[:2], rest.position("arm.tip")[:2], atol=1e-9)
