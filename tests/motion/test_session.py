"""A session gives the run that `simulate` gives, bit for bit; what is given and read means what its docstring says."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import (
    Cable,
    Driven,
    Fixed,
    Free,
    InputError,
    PayloadChange,
    Scene,
    Session,
    SessionError,
    equilibrium,
    load_scene,
    paths,
    simulate,
)
from anet_lumped.effects import Gravity, LineChange, Water
from anet_lumped.prescribed import signals
from integrators import schemes

DT = 0.004
NET = load_scene("net_carried")
EXTERNAL = replace(
    NET, points=[Driven(p.name, paths.external(p.path.at(0.0)[0])) if isinstance(p, Driven) else p for p in NET.points]
)


def breaking(**changes):
    """A payload between a support that moves away and one that stands, on cables one of which breaks; its mass changes before."""
    made = {"length": 1.0, "mass_per_length": 0.1, "EA": 1e4, "zeta": 0.05, "segments": 8}
    return Scene(
        points=[Driven("a", paths.line((0, 0, 0), (-1.0, 0, 0), 0.5)), Fixed("c", (1, 0, 0)), Free("b", mass=0.5)],
        cables=[Cable("a", "b", breaking_tension=5.0, **made), Cable("c", "b", **made)],
        effects=[Gravity(9.81)],
        events=[PayloadChange("b", 0.0501, 0.4)],
    )


def assert_same(session, run, k):
    """All that a run saves of its k-th state, to the last bit."""
    state = session.state
    assert session.t == run.t[k]
    for own, saved in ((state.q, run.q[k]), (state.v, run.v[k]), (state.segment_tension, run.segment_tension[k])):
        assert np.array_equal(own, saved)
    assert np.array_equal(session.energy, run.energy[k])


@pytest.mark.parametrize("method", schemes.names(own=True, stable_undamped=True))
def test_it_is_the_run_of_simulate(method):
    dt = DT if not schemes.scheme(method).explicit else 1e-4
    run = simulate(NET, 20 * dt, method=method, dt=dt, save_every=dt)
    session = Session(NET, dt, method=method)
    for k in range(21):
        assert_same(session, run, k)
        session.step()
    assert session.work.steps == 21


def test_links_and_the_choice_by_default():
    rigid = replace(NET, cables=tuple(replace(cable, EA=np.inf, compression="linear") for cable in NET.cables))
    run = simulate(rigid, 20 * DT, method="links", dt=DT, save_every=DT)
    session = Session(rigid, DT, method="links")
    for k in range(21):
        assert_same(session, run, k)
        session.step()
    assert Session(NET, DT).method == simulate(NET, DT, dt=DT).method
    with pytest.raises(InputError, match=r'Links in a session need cables with compression="linear"'):
        Session(replace(NET, cables=tuple(replace(cable, EA=np.inf) for cable in NET.cables)), DT, method="links")


@pytest.mark.parametrize(("method", "dt"), [("edmc", 1e-3), ("verlet", 1e-4)])
def test_events_are_those_of_the_run(method, dt):
    scene = breaking()
    run = simulate(scene, 0.4, method=method, dt=dt, save_every=0.1)
    session = Session(scene, dt, method=method)
    first = session.save()
    for _ in range(2):
        for _ in range(round(0.4 / dt)):
            session.step()
        assert_same(session, run, -1)
        for cable in scene.cables if schemes.scheme(method).explicit else ():  # whose tensions acted at the end of the step
            assert np.array_equal(session.tension(cable.name), run.tension(cable.name)[-1])
        assert session.events == run.events and len(run.events) == 1 + (method == "verlet")
        session.restore(first)
    assert session.events == () and session.t == 0.0


def test_lengths_and_water_that_change():
    scene = Scene(
        points=[Fixed("a", (0, 0, 0)), Free("b", mass=0.1)],
        cables=[Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=6, diameter=0.01)],
        effects=[Gravity(9.81), LineChange({"a-b": signals.line(0.0, 0.2, 0.05)}), Water(level=-0.5)],
    )
    run = simulate(scene, 40 * DT, method="edmc", dt=DT, save_every=DT)
    session = Session(scene, DT, method="edmc")
    for k in range(41):
        assert_same(session, run, k)
        session.step()


def test_points_that_are_driven_from_outside_follow_what_is_given():
    run = simulate(NET, 20 * DT, method="edmc", dt=DT, save_every=DT)
    with Session(EXTERNAL, DT, method="edmc") as session:
        for k in range(1, 21):
            for name in ("s0", "s1", "s2", "s3"):
                session.drive(name, run.position(name)[k], run.velocity(name)[k])
            session.step()
            assert np.array_equal(session.position("s0"), run.position("s0")[k])
            assert np.array_equal(session.state.q, run.q[k]) and np.array_equal(session.state.v, run.v[k])


def test_within_a_step_a_driven_point_moves_along_a_cubic():
    """rk4 looks at the middle of a step: the same motion by a path of the same cubics, which a spline through its samples is."""
    t = np.linspace(0.0, 20 * DT, 21)
    wanted = np.column_stack([0.05 * np.sin(8.0 * t) ** 2, 0.02 * t, np.zeros(21)])
    path = paths.samples(t, wanted)
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, zeta=0.05, segments=6)
    points = [Free("b", mass=0.1)]
    run = simulate(Scene([Driven("a", path), *points], [cable], [Gravity(9.81)]), t[-1], method="rk4", dt=DT / 8, save_every=DT / 8)
    session = Session(Scene([Driven("a", paths.external((0, 0, 0))), *points], [cable], [Gravity(9.81)]), DT / 8, method="rk4")
    for k in range(1, 161):
        session.drive("a", *path.at(k * DT / 8)[:2])
        session.step()
    # the cubics are the same but for the rounding of their coefficients, some 1e-16 m/h^2 h^2 a step
    assert np.abs(session.state.q - run.q[-1]).max() < 1e-11


def test_a_point_goes_on_with_the_velocity_that_was_given_last():
    session = Session(EXTERNAL, DT, method="edmc")
    start = session.position("s0")
    session.drive("s0", start, (0.5, 0.0, 0.0))
    for k in range(4):
        session.step()
        assert session.position("s0") == pytest.approx(start + k * DT * np.array([0.5, 0.0, 0.0]), abs=1e-15)
    assert session.velocity("s0").tolist() == [0.5, 0.0, 0.0] and session.velocity("s1").tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("method", ["edmc", "backward_euler"])
def test_pulls_and_pushes_are_what_acted_in_the_step(method):
    """m (v_b - v_a)/h is gravity, the push and the pull of the cables, to Newton's tolerance: 1e-6 of 5 N of tensions, twice."""
    session = Session(NET, DT, method=method)
    mass = session.state.model.mass[session.state.model.node("p0")]
    push = np.array([0.3, -0.1, 0.2])
    session.push("p0", push)
    for _ in range(30):
        before = session.velocity("p0")
        session.step()
        change = mass * (session.velocity("p0") - before) / DT
        assert change == pytest.approx(session.pull("p0") + push + mass * np.array([0.0, 0.0, -9.81]), abs=1e-5)
    ends = sum(session.pull(f"s{i}") for i in range(4))
    assert np.abs(ends[2]) > 1.0  # the corners carry the net
    assert session.tension("s0-p0").shape == (20,) and session.shape("s0-p0").shape == (21, 3)


def test_what_a_push_does_is_work_put_in():
    session = Session(EXTERNAL, DT, method="edmc")
    session.push("p0", (0.0, 0.0, 0.3))
    first, work = session.energy, 0.0
    for _ in range(60):
        q = session.position("p0")
        session.step()
        work += 0.3 * (session.position("p0") - q)[2]
    change = session.energy - first
    assert change[3] == pytest.approx(work, rel=1e-9) and work > 1e-3
    assert change[:3].sum() + change[4:].sum() == pytest.approx(change[3], rel=1e-6)  # Newton's tolerance
    assert abs(change[5]) < 1e-12  # nothing of it counts as taken by an effect


def test_save_and_restore_go_on_bit_for_bit_and_sessions_do_not_disturb_each_other():
    def march(session, steps=15):
        found = []
        for k in range(steps):
            session.push("p0", (0.1 * np.sin(k), 0.0, 0.2))
            session.drive("s1", session.position("s1"), (0.0, 0.1 * k, 0.0))
            session.step()
            found.append(session.state.q)
        return np.array(found), session.energy

    one, other = Session(EXTERNAL, DT, method="edmc"), Session(EXTERNAL, DT, method="edmc")
    march(one)
    mark = one.save()
    expected = march(one)
    found = {}
    one.restore(mark)
    threads = [threading.Thread(target=lambda n=n, s=s: found.update({n: march(s)})) for n, s in (("one", one), ("other", other))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.array_equal(found["one"][0], expected[0]) and np.array_equal(found["one"][1], expected[1])
    other.reset()
    again = march(other)
    assert np.array_equal(again[0], found["other"][0]) and np.array_equal(again[1], found["other"][1])
    with pytest.raises(InputError, match=r"must be what `save` of the same session returned"):
        other.restore(mark)


def test_a_scene_far_from_its_origin_is_marched_near_it():
    moved = np.array([5e6, -2e6, 0.0])
    far = replace(
        EXTERNAL,
        points=[
            Driven(p.name, paths.external(np.array(p.path.at(0.0)[0]) + moved)) if isinstance(p, Driven) else p
            for p in EXTERNAL.points
        ],
    )
    here, there = Session(EXTERNAL, DT, method="edmc"), Session(far, DT, method="edmc")
    for k in range(10):
        for session, origin in ((here, 0.0 * moved), (there, moved)):
            session.drive("s0", EXTERNAL.point("s0").path.at(0.0)[0] + np.array([1e-3 * k, 0.0, 0.0]) + origin, (0.25, 0.0, 0.0))
            session.step()
    assert there.tension("s0-p0") == pytest.approx(here.tension("s0-p0"), rel=1e-5)  # 1e-9 m of a given place, in segments of 50 mm
    assert there.position("p0") - moved == pytest.approx(here.position("p0"), abs=1e-8)


def test_simulate_and_sessions_go_on_from_a_state():
    session = Session(NET, DT, method="edmc", start=equilibrium(NET))
    for _ in range(5):
        session.step()
    onward = Session(NET, DT, method="edmc", start=session.state)
    run = simulate(NET, 5 * DT, method="edmc", dt=DT, start=session.state, save_every=DT)
    for k in range(6):
        assert_same(onward, run, k)
        onward.step()


def test_points_driven_from_outside_go_on_from_where_a_state_has_them():
    """A second session goes on as the first; a run, in which such points stand, refuses a start elsewhere."""
    one = Session(EXTERNAL, 1e-4, method="rk4")
    one.drive("s0", one.position("s0") + np.array([2.5e-5, 0.0, 0.0]), (0.5, 0.0, 0.0))
    one.step()
    other = Session(EXTERNAL, 1e-4, method="rk4", start=one.state)
    for _ in range(5):
        one.step()
        other.step()
    # a step of rk4 leaves nothing to the next but its state; steps differ by the rounding of their ends
    assert other.position("s0") == pytest.approx(one.position("s0"), abs=1e-15) and one.position("s0")[0] > -0.5 + 2e-4
    assert other.state.q == pytest.approx(one.state.q, abs=1e-12)
    with pytest.raises(InputError, match=r'stands at its start in a run, .* but the state to start from has "s0" at'):
        simulate(EXTERNAL, 0.1, start=one.state)


def test_a_cable_cannot_be_reeled_in_by_more_than_it_has():
    scene = Scene(
        points=[Fixed("a", (0, 0, 0)), Free("b", mass=0.1)],
        cables=[Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=6)],
        effects=[Gravity(9.81), LineChange({"a-b": signals.line(0.0, -2.0, 0.0)})],
    )
    session = Session(scene, 0.1, method="edmc")
    with pytest.raises(InputError, match=r'must keep at least .* of cable "a-b" with length=1 m'):
        for _ in range(10):
            session.step()


def test_messages():
    session = Session(EXTERNAL, DT, method="edmc")
    with pytest.raises(InputError, match=r'driven from outside if its path is paths.external, but "p0" is not; "s0", "s1"'):
        session.drive("p0", (0, 0, 0))
    with pytest.raises(InputError, match=r"position.* must be three finite numbers|position=.*nan"):
        session.drive("s0", (0, 0, np.nan))
    with pytest.raises(InputError, match=r'force is given to a free point or to a body that moves freely, but "s0" is not free'):
        session.push("s0", (0, 0, 1))
    with pytest.raises(InputError, match='no point "p1", did you mean'):
        session.position("p1")
    with pytest.raises(InputError, match=r"`dt` must be positive and finite \[s\], but it is -1"):
        Session(NET, -1)
    with pytest.raises(InputError, match=r"`rho_inf` must lie between 0 and 1, but it is 5"):
        Session(NET, DT, method="edmc", rho_inf=5)
    with pytest.raises(InputError, match=r"method of this package, but the method is RK45"):
        Session(NET, DT, method="RK45")
    with pytest.raises(InputError, match=r'must be one of .*did you mean "edmc"|must be one of .*edmc'):
        Session(NET, DT, method="edmcc")
    assert "Session at t=0 s: edmc" in repr(session)


def test_a_step_that_fails_says_why_and_the_session_can_go_back():
    with pytest.warns(UserWarning, match="beyond the largest stable step"):
        session = Session(NET, 2e-3, method="verlet")
    mark = session.save()
    with pytest.raises(SessionError, match=r"verlet with dt=0.002 s.* diverged at t="):
        for _ in range(2000):
            session.push("p0", (5.0, 0.0, 5.0))
            session.step()
    session.restore(mark)
    assert session.t == 0.0 and np.isfinite(session.state.q).all()
