"""Forces and torques on points and bodies: their sum and moment, motions against Euler's equations, rests, account, messages."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from anet_lumped import Body, Cable, Driven, Fixed, Free, Scene, SceneError, equilibrium, load_scene, paths, save_scene, simulate
from anet_lumped.effects import AppliedForces, Gravity
from anet_lumped.effects.laws.couple import direction_weights
from anet_lumped.model.build import build
from anet_lumped.results.energy_balance import error_of_steps

J = np.array([0.010, 0.014, 0.020])
TAU, F = np.array([0.02, 0.01, -0.03]), np.array([0.3, 0.0, 0.2])
HOOK = (0.0, 0.1, -0.05)


def apart(*effects, inertia=tuple(J), hook=HOOK):
    """A body in free flight, beside a cable that keeps to itself."""
    body = Body("box", mass=1.0, inertia=inertia, at=(0, 0, 0), rotation=(0.3, -0.2, 0.5), attachments={"hook": hook})
    cable = Cable("far", "near", length=1.0, mass_per_length=0.1, EA=100.0, segments=2)
    return Scene([Fixed("far", (10, 0, 0)), Free("near", mass=0.1, at=(9.0, 0, 0))], [cable], effects, bodies=[body])


def by_euler(axes, t, at=(0.0, 0.0, 0.0), torque=True):
    """Place of the centre [m] and rotation matrix of the body by Newton's and Euler's equations, solved by SciPy."""
    first = Rotation.from_rotvec((0.3, -0.2, 0.5))

    def rate(_, y):
        R, w = Rotation.from_quat(y[:4] / np.linalg.norm(y[:4])), y[4:7]
        tau, force = (TAU, R.apply(F)) if axes == "body" else (R.inv().apply(TAU), F)
        tau = torque * tau + np.cross(at, R.inv().apply(force))
        x, y_, z, s = y[:4]
        quaternion = 0.5 * np.array([
            s * w[0] + y_ * w[2] - z * w[1], s * w[1] + z * w[0] - x * w[2], s * w[2] + x * w[1] - y_ * w[0],
            -x * w[0] - y_ * w[1] - z * w[2],
        ])  # fmt: skip
        return np.concatenate([quaternion, (tau - np.cross(w, J * w)) / J, force, y[7:10]])

    start = np.concatenate([first.as_quat(), np.zeros(9)])
    end = solve_ivp(rate, (0.0, t), start, method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    return end[10:], Rotation.from_quat(end[:4]).as_matrix()


@pytest.mark.each_once
@pytest.mark.parametrize("axes", ["world", "body"])
@pytest.mark.parametrize(("method", "order"), [("edmc", 2), ("rk4", 4)])
def test_euler_equations(axes, method, order):
    scene = apart(AppliedForces(force={"box": tuple(F)}, torque={"box": tuple(TAU)}, axes=axes))
    r, R = by_euler(axes, 1.0)
    errors, steps = [], (0.02, 0.01, 0.005)
    for dt in steps:
        run = simulate(scene, 1.0, method=method, dt=dt, start="straight")
        errors.append(np.linalg.norm(run.rotation("box")[-1] - R))
        assert run.position("box")[-1] == pytest.approx(r, abs=1e-4)  # edmc at 20 ms in a force that turns
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(order, abs=0.15)
    if method == "edmc":
        assert run.work.newton_iterations <= 1.1 * run.work.steps


@pytest.mark.parametrize("axes", ["world", "body"])
def test_a_force_at_an_attachment_turns_the_body(axes):
    scene = apart(AppliedForces(force={"box.hook": tuple(F)}, torque={"box": tuple(TAU)}, axes=axes))
    r, R = by_euler(axes, 0.5, HOOK)
    run = simulate(scene, 0.5, method="rk4", dt=1e-3, start="straight")
    # of order 4: 1e-9; the attachment has a billionth of the mass
    assert run.rotation("box")[-1] == pytest.approx(R, abs=1e-7) and run.position("box")[-1] == pytest.approx(r, abs=1e-7)


def test_forces_in_the_axes_of_a_body_beside_those_in_the_world():
    """As by `axes`: the torque is of the world."""
    r, R = by_euler("body", 0.5, HOOK, torque=False)
    scene = apart(AppliedForces(force_in_body={"box.hook": tuple(F)}))
    run = simulate(scene, 0.5, method="rk4", dt=1e-3, start="straight")
    assert run.rotation("box")[-1] == pytest.approx(R, abs=1e-7) and run.position("box")[-1] == pytest.approx(r, abs=1e-7)


@pytest.mark.parametrize(("inertia", "hook"), [(tuple(J), HOOK), ((0.01, 0.01, 0.02), (0.1, 0.0, 0.0))])
@pytest.mark.parametrize("axes", ["world", "body"])
def test_the_forces_of_a_torque_have_no_sum_and_its_moment(inertia, hook, axes):
    """Also of a flat body, whose nodes lie in a plane."""
    effect = AppliedForces(torque={"box": tuple(TAU)}, axes=axes)
    scene = apart(effect, inertia=inertia, hook=hook)
    model, body = build(scene), scene.body("box")
    R = Rotation.from_rotvec((0.7, 0.1, -2.0)).as_matrix()
    q, f = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    nodes = [model.node_of[point.name] for point in body.points]
    q[nodes] = np.array([point.arm for point in body.points]) @ R.T + np.array([1.0, 2.0, 3.0])
    v = np.random.default_rng(1).normal(size=q.shape)
    power = effect.kernels()["force"](0.0, q, v, *effect.table(model), f)
    assert np.abs(f.sum(axis=0)).max() < 1e-13  # of forces of about tau/0.1 m
    assert np.cross(q, f).sum(axis=0) == pytest.approx(R @ TAU if axes == "body" else TAU, abs=1e-12)
    assert power == pytest.approx(-np.sum(f * v), rel=1e-12)
    assert not np.delete(f, nodes, axis=0).any()


def test_weights():
    arms = [point.arm for point in apart().body("box").points]
    weights, directions, share = direction_weights(arms)
    assert weights.sum(axis=1) == pytest.approx(np.zeros(3), abs=1e-12) and weights @ arms == pytest.approx(directions, abs=1e-12)
    assert np.linalg.det(directions) == pytest.approx(1.0) and share == 0.5
    _, _, of_flat = direction_weights([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)])
    assert of_flat == 1.0


def test_functions_of_time():
    """m v = integral of F: a half wave of 0.2 s and a spline, at a free point and a body."""
    wave = paths.harmonic((0.0, 0.0, 1.0), (2.0, 0.0, 0.0), 2.5)
    ramp = paths.samples((0.0, 0.2), ((0, 0, 0), (0.0, 1.0, 0.0)))
    run = simulate(apart(AppliedForces(force={"box": wave, "near": ramp})), 0.2, method="rk4", dt=1e-3, start="straight")
    speed = run.velocity("box")[-1]
    assert speed == pytest.approx([2.0 * 2.0 / (5.0 * np.pi), 0.0, 0.2], abs=1e-9)  # the integral of a half wave
    mass = 0.1 + 0.1 / 4
    assert run.velocity("near")[-1, 1] == pytest.approx(0.5 * 0.2 / mass, rel=1e-2)  # the cable pulls back across, by its angle


def hung(*effects):
    body = Body("box", mass=1.0, inertia=tuple(J), at=(0, 0, -1.1), attachments={"hook": (0, 0, 0.1), "side": (0.1, 0, 0)})
    cable = Cable("top", "box.hook", length=1.0, mass_per_length=0.01, EA=1e5, zeta=0.1, segments=5)
    return Scene([Fixed("top", (0, 0, 0))], [cable], [Gravity(9.81), *effects], bodies=[body])


def test_rest_under_a_constant_force():
    """The force at the centre makes a pendulum of body and cable lean: moments of a body about its hook, force over weight."""
    effect = AppliedForces(force={"box": (1.0, 0.0, 0.0)})
    assert effect.dead_load
    rest = equilibrium(hung(effect))
    arm = rest.position("box") - rest.position("box.hook")
    assert rest.stable and arm[0] / -arm[2] == pytest.approx(1.0 / 9.81, rel=1e-9)


def test_account():
    """The work of constant forces is potential, that of others is given by effects; edmc keeps both to Newton's tolerance."""
    constant = AppliedForces(force={"box.side": (0.5, 0.3, 0.0)})
    turning = AppliedForces(force={"box.side": (0.5, 0.3, 0.0)}, torque={"box": (0.0, 0.1, 0.0)}, axes="body")
    for effect in (constant, turning):
        run = simulate(hung(effect), 0.5, method="edmc", dt=2e-3, start=equilibrium(hung()))
        assert run.ok and error_of_steps(run) < 1e-6
        given = run.energy[-1, 5]
        assert (given == 0.0) if effect.dead_load else (given < -1e-3)


def test_scene_file(tmp_path):
    path = paths.line((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.5)
    scene = apart(AppliedForces(force={"box.hook": (0.0, 1.0, 0.0), "near": path}, torque={"box": path}, axes="body"))
    save_scene(scene, tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == scene


@pytest.mark.parametrize(("arguments", "message"), [
    ({"axes": "wind"}, 'Argument `axes` must be "world" or "body", but effect AppliedForces has axes=\'wind\''),
    ({"force": {"near": (1.0, 2.0)}}, r'`force` must be three finite .* \[N\], but effect AppliedForces of "near"'),
    ({"torque": {"box": 3.0}}, r"`torque` must be three finite numbers \(x, y, z\) \[N m\]"),
    ({"force": {"near": paths.external((0, 0, 0))}}, "a path that is known before a run, .* a Session pushes from outside"),
    ({"force": 3}, "`force` must be a dict or pairs of a name and a vector or path"),
])  # fmt: skip
def test_refuses(arguments, message):
    with pytest.raises(SceneError, match=message):
        AppliedForces(**arguments)


@pytest.mark.parametrize(("arguments", "message"), [
    ({"force": {"bo": (0, 0, 1)}}, 'no point "bo", did you mean "box"'),
    ({"force": {"far": (0, 0, 1)}}, 'must act on a point or body that moves freely, but "far" of effect AppliedForces does not'),
    ({"torque": {"bax": (0, 0, 1)}}, 'no body "bax", did you mean "box"'),
    ({"torque": {"barge": (0, 0, 1)}}, 'A torque must act on a body that moves freely, but "barge"'),
    ({"force": {"barge": (0, 0, 1)}}, 'must act on a point or body that moves freely, but "barge"'),
    ({"force_in_body": {"near": (0, 0, 1)}}, 'in the axes of a body must be on one that moves freely, but "near"'),
])  # fmt: skip
def test_names(arguments, message):
    scene = apart(AppliedForces(**arguments))
    scene = Scene(
        scene.points, scene.cables, scene.effects, bodies=[*scene.bodies, Body("barge", path=paths.line((0, 0, 9), (0, 0, 0), 0))]
    )
    assert not any(isinstance(point, Driven) for point in scene.points)
    with pytest.raises(SceneError, match=message):
        build(scene)
