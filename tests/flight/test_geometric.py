"""The geometric controller: its law, hover, a step against the linear prediction, large turns, feed-forward, timing, sensors."""

from dataclasses import replace

import numpy as np
import pytest
from flying import AGILE, alone
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from anet_lumped import load_scene, paths
from anet_lumped.checks import InputError, SceneError
from anet_lumped.flight.fly import fly
from anet_lumped.flight.geometric import AttitudeControl, Cascade, Goal, PositionControl, attitudes, follow, geometric, hold
from anet_lumped.flight.hovering import hovering
from anet_lumped.flight.quadrotor import THESIS_QUADROTOR
from anet_lumped.flight.seen import Seen, Sensors
from anet_lumped.flight.timing import Held

DT = 0.004
BOTH = (1.0 / DT, 1.0 / DT)


def seen_at(t=0.0, m=2, seed=3):
    random = np.random.default_rng(seed)
    rotation = Rotation.random(m, random_state=seed).as_matrix()
    return Seen(t, *random.normal(size=(2, m, 3)), rotation, *random.normal(size=(3, m, 3)), *random.normal(size=(2, 1, 3)))


def test_law_of_attitudes():
    """The slow twin, written from the equations of the source."""
    seen, crew = seen_at(), [AGILE, THESIS_QUADROTOR]
    force = np.array([[1.0, 2.0, 9.0], [-3.0, 0.5, 8.0]])
    control = AttitudeControl(crew, frequency=12.0, damping=0.7, heading=0.4)
    told = control(seen, force)
    for b in range(2):
        R, J = seen.rotation[b], crew[b].inertia_tensor
        z = force[b] / np.linalg.norm(force[b])
        y = np.cross(z, (np.cos(0.4), np.sin(0.4), 0.0))
        y /= np.linalg.norm(y)
        R_d = np.column_stack([np.cross(y, z), y, z])
        wedge = 0.5 * (R_d.T @ R - R.T @ R_d)
        e_R = np.array([wedge[2, 1], wedge[0, 2], wedge[1, 0]])
        W = R.T @ seen.angular_velocity[b]
        torque = J @ (-(12.0**2) * e_R - 2.0 * 0.7 * 12.0 * W) + np.cross(W, J @ W) - R.T @ seen.moment[b]
        assert told.thrust[b] == pytest.approx(force[b] @ R[:, 2], rel=1e-12)
        assert told.torque[b] == pytest.approx(torque, rel=1e-10)
        assert attitudes(force, 0.4)[b] == pytest.approx(R_d, abs=1e-14)


@pytest.mark.parametrize("scene", ["quadrotor_hover", "quadrotors_net"])
def test_hover_thrust_is_the_weight(scene):
    """Of all that hangs there: upward parts of the thrusts in the attitudes of hovering, to the tolerance of statics."""
    scene = load_scene(scene)
    ready = hovering(scene)
    weight = 9.81 * (sum(b.mass for b in scene.bodies) + sum(c.length * c.mass_per_length for c in scene.cables) + 0.01)
    assert 9.81 * sum(b.mass for b in scene.bodies) - ready.force[:, 2].sum() == pytest.approx(weight, rel=1e-9)
    run = fly(scene, geometric([THESIS_QUADROTOR] * len(scene.bodies), hold([b.at for b in scene.bodies])), 1.0)
    assert run.ok
    for body in scene.bodies:  # they stay where they are
        assert run.position(body.name)[-1] == pytest.approx(body.at, abs=1e-9)
        assert np.abs(run.velocity(body.name)).max() < 1e-8  # attitudes are found to 1e-10 rad: 1e-9 m/s2


def linear_step(size, steps):
    """The sideways motion after a step of the goal, linearised: x' = v, v' = g theta, theta'' = u, with u held over each step."""
    w_x, zeta, w_R, damping = 2.0, 0.9, 15.0, 0.8
    A = np.zeros((5, 5))
    A[0, 1], A[1, 2], A[2, 3], A[3, 4] = 1.0, 9.81, 1.0, 1.0
    whole, z, found = expm(A * DT), np.zeros(4), [0.0]
    for _ in range(steps):
        lean = (w_x**2 * (size - z[0]) - 2.0 * zeta * w_x * z[1]) / 9.81
        u = -(w_R**2) * (z[2] - lean) - 2.0 * damping * w_R * z[3]
        z = whole[:4, :4] @ z + whole[:4, 4] * u
        found.append(z[0])
    return np.array(found)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_step_is_that_of_the_linear_prediction(axis):
    goal, size = np.zeros((1, 3)), 0.01
    goal[0, axis] = size
    run = fly(alone(), geometric([AGILE], hold(goal), rates=BOTH), 3.0, quadrotors=AGILE, save_every=DT)
    expected = linear_step(size, 750)
    # angles of 5 mrad: their cubes; the thrust acts along the axes in the middle of a step: (omega h)^2/24 of them
    assert run.ok and np.abs(run.position("quad")[:, axis] - expected).max() < 2e-3 * size
    assert expected[-1] == pytest.approx(size, rel=0.02)
    assert np.abs(run.position("quad")[:, 2]).max() < 1e-5


def test_it_recovers_from_upside_down():
    """From 170 degrees, with rotors that only push one way: back at its place."""
    scene = alone(rotation=(np.radians(170.0), 0.0, 0.0))
    controller = geometric([AGILE], hold((0, 0, 0)), rates=BOTH)
    run = fly(scene, controller, 6.0, quadrotors=AGILE, start={"top-end": hovering(scene).shapes["top-end"]})
    assert run.ok and run.position("quad")[-1] == pytest.approx((0, 0, 0), abs=0.02)
    assert run.position("quad")[:, 2].min() < -0.3  # it fell meanwhile


def test_it_follows_a_path():
    path = paths.samples((0.0, 1.0, 2.0, 3.0), ((0, 0, 0), (0.4, 0.1, 0.1), (0.8, 0.5, 0.2), (1.0, 1.0, 0.2)))
    run = fly(alone(), geometric([AGILE], follow([path]), rates=BOTH), 4.0, quadrotors=AGILE)
    places = np.array([path.at(float(t))[0] for t in run.t])
    assert np.abs(run.position("quad") - places).max() < 0.1 and run.position("quad")[-1] == pytest.approx((1, 1, 0.2), abs=0.02)


def test_feed_forward_holds_the_height_under_a_load():
    """Without it the quadrotor sags by the weight of what hangs there over m omega_x^2."""
    scene = load_scene("quadrotor_hover")
    run = fly(scene, geometric([THESIS_QUADROTOR], hold((0, 0, 0)), feed_forward=False), 12.0)
    assert run.position("quad0")[-1, 2] == pytest.approx(-9.81 * 0.11 / (1.04 * 4.0), rel=0.01)


# --- timing and sensors ---------------------------------------------------------------------------------------------------


def test_rate_hold_and_delay():
    calls = []

    def controller(seen):
        calls.append(seen.t)
        return seen.t

    held = Held(controller, rate=100.0, delay=0.012)
    answers = [held(seen_at(0.004 * k)) for k in range(12)]
    assert calls == pytest.approx([0.0, 0.012, 0.02, 0.032, 0.04])  # the first steps that reach 0, 10, 20, 30, 40 ms
    assert answers == pytest.approx([0.0] * 6 + [0.012] * 2 + [0.02] * 3 + [0.032])
    held.reset()
    assert held(seen_at(1.0)) == 1.0 and held(seen_at(1.004)) == 1.0
    faster = Held(controller, rate=1000.0)
    assert [faster(seen_at(0.004 * k)) for k in range(3)] == [0.0, 0.004, 0.008]
    with pytest.raises(InputError, match=r"in the order of times, or be reset, but t = 0 s comes after .* s\."):
        held(seen_at(0.0))
    held.reset()
    with pytest.raises(SceneError, match=r"`rate` must be positive and finite \[1/s\], but Held has rate=0"):
        Held(controller, rate=0)


def test_sensors_have_noise_and_delay_by_their_seed():
    noisy = Sensors(position=0.1, velocity=0.2, rotation=0.01, angular_velocity=0.3, pull=0.4, seed=5)
    seen, drawn = seen_at(m=2), []
    for _ in range(2000):
        drawn.append(noisy(seen))
    for name, size in (("position", 0.1), ("velocity", 0.2), ("angular_velocity", 0.3), ("pull", 0.4), ("point", 0.1)):
        off = np.array([getattr(one, name) - getattr(seen, name) for one in drawn])
        assert off.std() == pytest.approx(size, rel=0.05)  # some thousand numbers: 1 %, five times
    turns = Rotation.from_matrix(np.array([one.rotation[0] @ seen.rotation[0].T for one in drawn])).as_rotvec()
    assert turns.std() == pytest.approx(0.01, rel=0.05)
    noisy.reset()
    assert np.array_equal(noisy(seen).position, drawn[0].position)
    late = Sensors(delay=0.01)
    assert [late(seen_at(0.004 * k)).t for k in range(6)] == pytest.approx([0.0, 0.0, 0.0, 0.0, 0.004, 0.008])
    with pytest.raises(SceneError, match=r"`pull` must be non-negative and finite \[N\], but Sensors has pull=-1"):
        Sensors(pull=-1)


def test_a_flight_with_noise_is_the_same_for_the_same_seed():
    scene = load_scene("quadrotor_hover")
    controller = geometric([THESIS_QUADROTOR], hold((0, 0, 0)), delay=0.004)
    runs = [fly(scene, controller, 0.5, sensors=Sensors(position=1e-3, delay=0.008, seed=seed)) for seed in (1, 1, 2)]
    assert np.array_equal(runs[0].q, runs[1].q) and np.array_equal(runs[0].energy, runs[1].energy)
    assert np.abs(runs[0].q - runs[2].q).max() > 1e-6


def test_a_controller_is_any_callable():
    """Position control written by hand, without feed-forward, in a cascade."""
    crew = [replace(AGILE)]

    def push_up(seen):
        return np.array([[0.0, 0.0, 9.81 * AGILE.mass + 1.0]])

    run = fly(alone(), Cascade(push_up, AttitudeControl(crew), BOTH), 1.0, quadrotors=crew[0])
    assert run.velocity("quad")[-1, 2] == pytest.approx(1.0 / AGILE.mass, rel=1e-6)
    goal = PositionControl(crew, lambda seen: Goal(*np.zeros((3, 1, 3))))(seen_at(m=1)._replace(pull=np.zeros((1, 3))))
    assert goal.shape == (1, 3)
