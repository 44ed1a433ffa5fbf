"""Bodies in a session: pushed, turned, driven, read; saved and gone back to."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from anet_lumped import Body, Cable, Driven, Fixed, Free, InputError, Scene, Session, equilibrium, paths, simulate
from anet_lumped.effects import AppliedForces, Gravity

J, HOOK, DT = np.array([0.010, 0.014, 0.020]), (0.05, 0.0, -0.05), 0.004
START = (0.3, -0.2, 0.5)


def apart(**changes):
    """A body in free flight, beside a cable that keeps to itself."""
    body = Body("box", mass=1.0, inertia=tuple(J), at=(0, 0, 0), rotation=START, attachments={"hook": HOOK})
    cable = Cable("far", "near", length=1.0, mass_per_length=0.1, EA=100.0, segments=2)
    return Scene([Fixed("far", (10, 0, 0)), Free("near", mass=0.1, at=(9.0, 0, 0))], [cable], bodies=[replace(body, **changes)])


def slung(body):
    """A load that hangs from a body."""
    cable = Cable(f"{body.name}.hook", "load", length=1.0, mass_per_length=0.02, EA=1e4, zeta=0.05, segments=8)
    return Scene([Free("load", mass=0.2)], [cable], [Gravity(9.81)], bodies=[body])


FREE = Body("quad", mass=1.0, inertia=tuple(J), at=(0, 0, 2.0), attachments={"hook": HOOK})
DRIVEN = Body("deck", path=paths.external((0, 0, 2.0)), turning=paths.external((0, 0, 0)), rotation=START,
              attachments={"hook": HOOK, "left": (0, 0.1, 0), "front": (0.1, 0, 0)})  # fmt: skip


def held(body):
    return Body(body.name, path=paths.line(body.at, (0, 0, 0), 0), attachments=dict(body.attachments))


def start_of(scene):
    """Shapes of the cables with the bodies held."""
    rest = equilibrium(replace(scene, bodies=[held(body) for body in scene.bodies]))
    return {cable.name: rest.shape(cable.name) for cable in scene.cables}


def by_euler(tau, force, axes, t):
    """Place [m], rotation matrix and angular velocity [rad/s] under a held torque and force, by Euler's equations and SciPy."""

    def rate(_, y):
        R, w = Rotation.from_quat(y[:4] / np.linalg.norm(y[:4])), y[4:7]
        own, f = (tau, R.apply(force)) if axes == "body" else (R.inv().apply(tau), force)
        x, y_, z, s = y[:4]
        quaternion = 0.5 * np.array([
            s * w[0] + y_ * w[2] - z * w[1], s * w[1] + z * w[0] - x * w[2], s * w[2] + x * w[1] - y_ * w[0],
            -x * w[0] - y_ * w[1] - z * w[2],
        ])  # fmt: skip
        return np.concatenate([quaternion, (own - np.cross(w, J * w)) / J, f, y[7:10]])

    start = np.concatenate([Rotation.from_rotvec(START).as_quat(), np.zeros(9)])
    end = solve_ivp(rate, (0.0, t), start, method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    R = Rotation.from_quat(end[:4])
    return end[10:], R.as_matrix(), R.apply(end[4:7])


@pytest.mark.parametrize("axes", ["world", "body"])
@pytest.mark.parametrize("method", ["edmc", "verlet"])
def test_a_held_torque_against_eulers_equations(axes, method):
    tau, force = np.array([0.02, 0.01, -0.03]), np.array([0.3, 0.0, 0.2])
    r, R, w = by_euler(tau, force, axes, 0.8)
    errors, steps = [], (0.008, 0.004, 0.002)
    for dt in steps:
        session = Session(apart(), dt, method=method, start="straight")
        session.push("box", force, tau, axes=axes)
        for _ in range(round(0.8 / dt)):
            session.step()
        errors.append(np.linalg.norm(session.rotation("box") - R))
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 1e-4 and session.position("box") == pytest.approx(r, abs=1e-5)
    assert session.angular_velocity("box") == pytest.approx(w, abs=1e-4)


def test_momenta_are_those_that_were_put_in():
    """Of a free body in the axes of the world: m v = F t, and its angular momentum tau t, to second order of the turn in a step."""
    tau, force = np.array([0.02, 0.01, -0.03]), np.array([0.3, 0.0, 0.2])
    session = Session(apart(), 0.001, method="edmc", start="straight")
    session.push("box", force, tau)
    for _ in range(500):
        session.step()
    R, w = session.rotation("box"), session.angular_velocity("box")
    assert session.velocity("box") == pytest.approx(0.5 * force, abs=1e-9)  # Newton's tolerance
    assert R @ (J * (R.T @ w)) == pytest.approx(0.5 * tau, rel=1e-5)  # (h w)^2/8 at 1.5 rad/s: 3e-7, and of the prediction
    assert session.energy[3] == pytest.approx(session.energy[0], rel=1e-6)


def test_readings_are_those_of_the_state():
    scene = slung(FREE)
    session = Session(scene, DT, method="edmc", start=start_of(scene))
    session.push("quad", (0.1, 0.2, 11.0), (0.001, -0.002, 0.003))
    for _ in range(50):
        session.step()
    state = session.state
    assert session.rotation("quad") == pytest.approx(state.rotation("quad"), abs=1e-12)
    assert session.angular_velocity("quad") == pytest.approx(state.angular_velocity("quad"), abs=1e-11)
    assert session.quaternion("quad") == pytest.approx(state.quaternion("quad"), abs=1e-12)
    assert np.array_equal(session.position("quad.hook"), state.position("quad.hook"))
    motions = session.motions()
    assert np.array_equal(motions.position[0], state.position("quad")) and np.array_equal(
        motions.velocity[0], state.velocity("quad")
    )


@pytest.mark.parametrize("method", ["edmc", "verlet"])
def test_save_and_restore_go_on_bit_for_bit(method):
    scene = slung(FREE)
    dt = DT if method == "edmc" else 1e-4

    def march(session, count=25):
        found = []
        for k in range(count):
            session.push("quad", (0.0, 0.1, 12.0 + 0.1 * k), (1e-3 * k, 0.0, 2e-3), axes="body")
            session.push("load", (0.05 * np.sin(k), 0.0, 0.0))
            session.step()
            found.append(session.state.q)
        return np.array(found), session.energy, session.work

    session = Session(scene, dt, method=method, start=start_of(scene))
    march(session)
    mark = session.save()
    first = march(session)
    session.restore(mark)
    again = march(session)
    assert np.array_equal(first[0], again[0]) and np.array_equal(first[1], again[1]) and first[2] == again[2]
    session.reset()
    march(session)
    other = march(session)
    assert np.array_equal(first[0], other[0])
    other = Session(scene, dt, method=method, start=start_of(scene))
    march(other)
    assert np.array_equal(march(other)[0], first[0])


def test_the_pull_on_a_body_is_asked_for_where_cables_end():
    """At the origin, where no cable ends, it is 0 N whatever hangs at the attachments."""
    session = Session(slung(FREE), DT, start=start_of(slung(FREE)))
    session.push("quad", (0.0, 0.0, 12.0))
    session.step()
    assert session.pull("quad.hook")[2] < -1.0
    with pytest.raises(InputError, match=r'none ends at the origin of body "quad"; ask for "quad.hook", or for `pulls\(\)`'):
        session.pull("quad")
    cable = replace(slung(FREE).cables[0], start="quad")
    scene = replace(slung(FREE), cables=[cable])
    session = Session(scene, DT, start=start_of(scene))
    session.step()
    assert session.pull("quad")[2] < -1.0
    assert not Session(apart(), DT, start="straight").pull("box").any()  # nothing at all is tied to it


def test_a_push_that_is_held_is_the_run_with_that_force():
    """A constant force in the axes of the world, as an effect of its own: the same steps, but for the order of sums."""
    scene = slung(FREE)
    lift = AppliedForces(force={"quad": (0.1, 0.0, 12.0)})
    start = start_of(scene)
    run = simulate(replace(scene, effects=(*scene.effects, lift)), 30 * DT, method="edmc", dt=DT, start=start, save_every=DT)
    session = Session(scene, DT, method="edmc", start=start)
    session.push("quad", (0.1, 0.0, 12.0))
    for _ in range(30):
        session.step()
    assert session.state.q == pytest.approx(run.q[-1], abs=1e-10)


def test_a_driven_body_follows_what_is_given():
    """The same motion as by paths of the same body: sines of place and rotation; cubics differ by the fourth order of a step."""
    waves = {"path": paths.harmonic((0, 0, 2.0), (0.1, 0, 0.05), 0.5), "turning": paths.harmonic((0, 0, 0), (0.2, 0.1, 0.4), 0.7)}
    by_path = replace(DRIVEN, **waves)
    start = equilibrium(slung(replace(DRIVEN, turning=None))).shape("deck.hook-load")
    run = simulate(slung(by_path), 100 * DT, method="edmc", dt=DT, start={"deck.hook-load": start}, save_every=DT)
    session = Session(slung(DRIVEN), DT, method="edmc", start={"deck.hook-load": start})
    from anet_lumped.prescribed.turning import spin

    session.drive("deck", *waves["path"].at(0.0)[:2])  # at once up to speed, as the path is
    for k in range(1, 101):
        phi, rate, second = (tuple(row) for row in waves["turning"].at(k * DT))
        place, velocity, _ = waves["path"].at(k * DT)
        session.drive("deck", place, velocity, rotation=phi, angular_velocity=spin(phi, rate, second)[0])
        session.step()
    for point in ("deck", "deck.hook", "deck.left"):
        assert session.position(point) == pytest.approx(run.position(point)[-1], abs=1e-12)
        assert session.velocity(point) == pytest.approx(run.velocity(point)[-1], abs=1e-11)
    assert session.rotation("deck") == pytest.approx(run.rotation("deck")[-1], abs=1e-12)
    assert session.angular_velocity("deck") == pytest.approx(run.angular_velocity("deck")[-1], abs=1e-9)
    assert session.position("load") == pytest.approx(run.position("load")[-1], abs=1e-6)
    onward = Session(slung(DRIVEN), DT, method="edmc", start=session.state)  # from where the state has the body
    onward.step()
    assert onward.rotation("deck") == pytest.approx(
        Rotation.from_rotvec(DT * session.angular_velocity("deck")).as_matrix() @ session.rotation("deck"), abs=1e-5
    )


def test_messages():
    session = Session(slung(FREE), DT, method="edmc", start=start_of(slung(FREE)))
    with pytest.raises(InputError, match=r'A torque is given to a body that moves freely, but "load" is none; "quad" is'):
        session.push("load", (0, 0, 1), (0, 0, 1))
    with pytest.raises(InputError, match=r'axes="body" is given to a body or an attachment, but "load" is a free point'):
        session.push("load", (0, 0, 1), axes="body")
    with pytest.raises(InputError, match=r'`axes` of push must be "world" or "body", but it is \'boddy\''):
        session.push("quad", (0, 0, 1), axes="boddy")
    with pytest.raises(InputError, match=r'no point "quat", did you mean "quad"'):
        session.push("quat", (0, 0, 1))
    with pytest.raises(InputError, match=r"torque.*three finite numbers"):
        session.push("quad", (0, 0, 1), (0, 0))
    with pytest.raises(InputError, match=r'no body "quat", did you mean "quad"'):
        session.rotation("quat")
    driven = Session(slung(DRIVEN), DT, method="edmc")
    with pytest.raises(InputError, match=r"`rotation` of drive must be less than a whole turn \[rad\]"):
        driven.drive("deck", (0, 0, 2), rotation=(0, 0, 7.0))
    with pytest.raises(InputError, match=r'a body that moves freely, but "deck" is not free'):
        driven.push("deck", (0, 0, 1))
    with pytest.raises(InputError, match=r'driven from outside if its path is paths.external, but "load" is not; "deck" is'):
        driven.drive("load", (0, 0, 1))
    still = Session(slung(replace(DRIVEN, turning=None)), DT, method="edmc")
    with pytest.raises(InputError, match=r"turned from outside if its `turning` is paths.external, but that of \"deck\" is not"):
        still.drive("deck", (0, 0, 2), rotation=(0, 0, 1.0))
    turned = Session(slung(replace(DRIVEN, path=None, at=(0, 0, 2.0))), DT, method="edmc")
    with pytest.raises(InputError, match=r'Only the rotation of "deck" is driven from outside; leave `position` out'):
        turned.drive("deck", (0, 0, 2))
    assert isinstance(DRIVEN.points[0], Driven)
