"""Flights: the scenarios that are bundled, steps, events, failures, names."""

import os
import signal
import sys
from dataclasses import replace

import numpy as np
import pytest
from flying import AGILE, alone
from slow import slow

from anet_lumped import Cable, Free, InputError, NoRestError, RunInterrupt, Scene, equilibrium, load_run, load_scene, paths
from anet_lumped.effects import Gravity
from anet_lumped.flight.admittance import Admittance
from anet_lumped.flight.fly import fly
from anet_lumped.flight.geometric import Goal, Wrench, follow, geometric, hold
from anet_lumped.flight.hovering import hovering
from anet_lumped.flight.net_guide import NetGuide
from anet_lumped.flight.quadrotor import CRAZYFLIE, THESIS_QUADROTOR, quadrotor
from anet_lumped.flight.seen import Seen, Sensors

CREW = [THESIS_QUADROTOR] * 4
NET = load_scene("quadrotors_net")
REST = np.array([0.0, 0.0, -0.693])  # of p0, where the quadrotors hover at their starts


def journey(start):
    """From a place to 10 m along y: up to 5 m/s within 2 s and down again, with no jump of the acceleration."""
    t = np.linspace(0.0, 4.0, 81)
    s = t / 4.0
    along = 10.0 * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    return paths.samples(t, np.array(start) + np.outer(along, (0.0, 1.0, 0.0)))


def test_the_flight_of_the_thesis():
    """From (0,0,0) to (0,10,0) with 10 g, at up to 5 m/s: all arrive, and the net keeps its shape."""
    guide = NetGuide(NET, journey(REST))
    run = fly(NET, geometric(CREW, guide), 7.0)
    assert run.ok and run.velocity("p0")[:, 1].max() == pytest.approx(5.0, abs=0.6)
    assert run.position("p0")[-1] == pytest.approx(np.add(REST, (0, 10, 0)), abs=0.03)
    spread = run.position("quad2") - run.position("quad0")
    assert np.linalg.norm(spread, axis=1) == pytest.approx(np.full(len(run.t), np.sqrt(2.0)), abs=0.05)


def test_steps_of_other_lengths_give_the_same_flight():
    """p0 after 5 m, with controllers that act as often: 10 ms against 2.5 ms. The pull fed forward is that of the last step."""
    ends = []
    for dt in (0.01, 0.005, 0.0025):
        run = fly(NET, geometric(CREW, NetGuide(NET, journey(REST)), rates=(100.0, 100.0)), 2.0, dt=dt)
        ends.append(run.position("p0")[-1])
    assert np.linalg.norm(ends[0] - ends[-1]) < 2e-3 and np.linalg.norm(ends[1] - ends[-1]) < 1e-3


def test_wind_is_made_up_for():
    """A gust that stays: p0 comes back by the sum of its errors; without it, it stays away."""
    scene, errors = load_scene("quadrotors_gust"), []
    for rate in (0.0, 1.0):
        guide = NetGuide(scene, REST, rate=rate)
        run = fly(scene, geometric(CREW, guide), 8.0)
        errors.append(np.linalg.norm(run.position("p0") - REST, axis=1))
        assert run.ok
    assert errors[0].max() > 0.03 and errors[0][-1] > 0.02
    assert errors[1][-1] < 0.1 * errors[0][-1] and errors[1].max() > 0.03


def test_a_cable_breaks():
    """The quadrotors stay where they are: three with the load, one with the rest of its cable."""
    scene = load_scene("quadrotors_break")
    run = fly(scene, geometric(CREW, hold([body.at for body in scene.bodies])), 6.0)
    assert run.ok and run.events[1].kind == "broke" and run.events[1].where == "quad1.hook-p0"
    for body in scene.bodies:
        assert run.position(body.name)[-1] == pytest.approx(body.at, abs=0.02)
    assert run.position("p0")[-1, 2] < REST[2] - 0.05


@pytest.mark.parametrize("shape", [{"spread": 0.8, "tilt": (0.1, 0.0, 0.0)}, *slow({"height": 0.5}, {"spread": 0.5})])
def test_the_net_is_brought_to_a_shape(shape):
    guide = NetGuide(NET, REST, **shape)
    run = fly(NET, geometric(CREW, guide), 10.0)
    middle = np.mean([run.position(f"quad{i}")[-1] for i in range(4)], axis=0)
    assert run.position("p0")[-1] == pytest.approx(REST, abs=2e-3)
    assert middle[2] - REST[2] == pytest.approx(shape.get("height", guide.height), abs=3e-3)
    apart = np.linalg.norm(run.position("quad2")[-1] - run.position("quad0")[-1])
    assert apart == pytest.approx(2.0 * guide.spread, abs=5e-3)
    assert guide.spread == pytest.approx(shape.get("spread", guide.spread))
    normal = np.cross(run.position("quad2")[-1] - run.position("quad0")[-1], run.position("quad3")[-1] - run.position("quad1")[-1])
    assert normal[1] / -normal[2] == pytest.approx(np.tan(shape.get("tilt", (0.0,))[0]), abs=5e-3)


def test_the_derivative_of_the_place_at_rest():
    """All quadrotors together move the point as far; its place at rest is a linear function up to second order."""
    guide = NetGuide(NET, REST)
    together = guide.jacobian.reshape(3, 4, 3).sum(axis=1)
    assert together == pytest.approx(np.eye(3), abs=1e-5)  # differences over 1e-4 of what statics leave, 1e-12
    arms, moved = guide._arms(guide.spread), 1e-3 * np.random.default_rng(2).normal(size=(4, 3))
    change = guide._rest(arms + moved) - guide._rest(arms)
    assert change == pytest.approx(guide.jacobian @ moved.ravel(), abs=2e-5)  # squares of 1e-3


def test_admittance_gives_way_as_a_mass_on_a_spring():
    """A pull held from t = 0: x = P/K (1 - e^(-3 t)(1 + 3 t)) for M = 1, D = 6, K = 9; here with two samplings."""
    still, nothing = Goal(*np.zeros((3, 1, 3))), np.zeros((1, 3))
    for dt in (0.01, 0.02):
        law = Admittance(lambda seen: still, nothing)
        for k in range(round(1.0 / dt) + 1):
            pull = np.array([[1.8, 0.0, 0.0]])
            goal = law(Seen(k * dt, nothing, nothing, np.eye(3)[None], nothing, pull, nothing, nothing, nothing))
        assert goal.position[0, 0] == pytest.approx(0.2 * (1.0 - np.exp(-3.0) * 4.0), rel=1e-9)
        assert goal.velocity[0, 0] == pytest.approx(0.2 * 9.0 * np.exp(-3.0), rel=1e-9)


def test_quadrotors_give_way_to_the_pull_of_a_load():
    """The load grows by 0.29 kg: without cables that break, each quadrotor comes down by its share over the stiffness."""
    scene = load_scene("quadrotors_break")
    scene = replace(scene, cables=[replace(cable, breaking_tension=None) for cable in scene.cables])
    places = [body.at for body in scene.bodies]
    expected = hovering(replace(scene, events=())).force
    guide = Admittance(hold(places), expected)
    run = fly(scene, geometric(CREW, guide), 8.0)
    heavier = [replace(p, mass=0.3) for p in scene.points]
    low = hovering(replace(scene, points=heavier, events=())).force[0, 2] - expected[0, 2]
    assert run.ok and run.position("quad0")[-1, 2] == pytest.approx(low / 9.0, rel=0.05)


def test_two_crazyflies_carry_a_load_by_what_they_measure():
    """With noise and delay, in the plane of both, where nothing swings: the load comes within some noise of its place."""
    crew = [quadrotor(f"cf{i}", (0.0, y, 1.0), CRAZYFLIE, attachments={"hook": (0, 0, -0.01)}) for i, y in enumerate((-0.2, 0.2))]
    made = {"length": 0.5, "mass_per_length": 0.002, "EA": 500.0, "zeta": 0.05, "segments": 6}
    scene = Scene(
        [Free("load", mass=0.010)], [Cable(f"cf{i}.hook", "load", **made) for i in range(2)], [Gravity(9.81)], bodies=crew
    )
    guide = NetGuide(scene, (0.0, 0.1, 0.6), point="load")
    sensors = Sensors(position=1e-3, velocity=1e-2, rotation=2e-3, angular_velocity=1e-2, delay=0.004, seed=1)
    run = fly(scene, geometric([CRAZYFLIE] * 2, guide, delay=0.002), 8.0, quadrotors=CRAZYFLIE, sensors=sensors)
    assert run.ok and run.work.halvings == 0
    assert run.position("load")[-1, 1:] == pytest.approx((0.1, 0.6), abs=0.01)
    assert run.energy_balance.imbalance < 1e-6  # Newton's tolerance


def test_cables_that_do_not_stretch():
    """Links, whose explicit steps are of order 5, against edmc with EA = inf: both see the pull of the last step."""
    cables = [replace(cable, EA=np.inf, compression="linear", zeta=0.0) for cable in NET.cables]
    rigid, controller = replace(NET, cables=cables), geometric(CREW, NetGuide(NET, REST + 0.1))
    links, edmc = (fly(rigid, controller, 1.0, method=method) for method in ("links", "edmc"))
    assert links.ok and np.abs(links.position("p0") - edmc.position("p0")).max() < 1e-3
    assert np.ptp(links.position("p0")[:, 2]) > 0.05


def test_what_has_to_be_flown_has_no_rest_of_its_own():
    with pytest.raises(NoRestError, match=r'nothing holds .* "p0" .*, and anet_lumped\.flight lets quadrotors carry it\.'):
        equilibrium(NET)


def test_a_flight_is_a_run(tmp_path):
    run = fly(NET, geometric(CREW, hold([body.at for body in NET.bodies])), 0.4, save_every=0.1)
    assert run.t == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4]) and run.method == "edmc" and run.work.steps == 100
    run.save(tmp_path / "flight.nc")
    again = load_run(tmp_path / "flight.nc")
    assert np.array_equal(again.q, run.q) and np.array_equal(again.rotation("quad1"), run.rotation("quad1"))


def test_a_step_that_fails_ends_the_flight_with_what_was_done():
    def wild(seen):
        return Wrench(np.full(1, np.nan if seen.t > 0.1 else 10.0), np.zeros((1, 3)))

    with pytest.raises(InputError, match=r"must give finite thrusts and torques, but at t = 0\.104 s it gives"):
        fly(alone(), wild, 1.0, quadrotors=AGILE)


def test_a_flight_that_is_stopped_gives_what_was_flown(monkeypatch, ctrl_c):
    """Ctrl-C comes in the middle of a step, between two saved states and ten steps after the last look."""
    monkeypatch.setattr(sys.modules["anet_lumped.flight.fly"], "AT_ONCE", 10)
    inner = geometric([AGILE], hold([(0.0, 0.0, 1.0)]))

    def controller(stop_at):
        def wrench(seen):
            if seen.t > stop_at:
                os.kill(os.getpid(), signal.SIGINT)
            return inner(seen)

        return wrench

    settings = {"quadrotors": AGILE, "save_every": 0.1}
    whole = fly(alone(), controller(9.0), 0.4, **settings)
    inner.reset()
    with pytest.raises(RunInterrupt, match=r"edmc with dt=0\.004 s was stopped by the user at t=0\.24 s") as stopped:
        fly(alone(), controller(0.25), 0.4, **settings)
    run = stopped.value.run
    assert run.status == "interrupted" and not run.ok and run.t == pytest.approx([0.0, 0.1, 0.2, 0.24])
    assert np.array_equal(run.q[:3], whole.q[:3]) and np.array_equal(run.energy[:3], whole.energy[:3])
    inner.reset()
    finer = fly(alone(), controller(9.0), 0.24, quadrotors=AGILE, save_every=0.04)
    assert np.array_equal(run.q[-1], finer.q[-1]) and np.array_equal(run.segment_tension[-1], finer.segment_tension[-1])


@pytest.mark.parametrize(
    ("scene", "thrust", "words"),
    [
        (NET, 0.0, "The quadrotors fall, at 9.81 m/s at t=1 s, by 100% of gravity from the start on: the controller gives no"),
        (
            replace(NET, points=[replace(NET.points[0], mass=30.0)]),
            15.0,
            "or less than what they and their load weigh, so that nothing holds them up.",
        ),
        (NET, 9.81 * (4 * 1.04 + 0.41) / 4, ""),
    ],
)
def test_quadrotors_that_nothing_holds_up_are_told(scene, thrust, words):
    run = fly(scene, lambda seen: Wrench(np.full(4, thrust), np.zeros((4, 3))), 1.0)
    said = " ".join(run.warnings)
    assert run.ok and (words in said if words else said == "")


def test_names_and_numbers():
    controller = geometric(CREW, hold([body.at for body in NET.bodies]))
    with pytest.raises(InputError, match='name bodies that move freely, but it names "quat1", did you mean "quad1"'):
        fly(NET, controller, 1.0, quadrotors={"quat1": THESIS_QUADROTOR})
    with pytest.raises(InputError, match='must have a Quadrotor, but body "quad1" has None'):
        fly(NET, controller, 1.0, quadrotors={"quad0": THESIS_QUADROTOR})
    with pytest.raises(InputError, match=r'have the mass of its Quadrotor, 0.028 kg, but "quad0" has 1.04 kg'):
        fly(NET, controller, 1.0, quadrotors=CRAZYFLIE)
    with pytest.raises(InputError, match="`quadrotors` must be a Quadrotor or a dict of them by body, but it is 3"):
        fly(NET, controller, 1.0, quadrotors=3)
    with pytest.raises(InputError, match=r"`t_end` must be positive and finite \[s\], but fly has t_end=0"):
        fly(NET, controller, 0)
    with pytest.raises(InputError, match=r"`dt` must not exceed t_end=0\.001 s, but it is 0\.004 s"):
        fly(NET, controller, 0.001)
    with pytest.raises(InputError, match=r"`save_every` must not exceed t_end=1 s, but it is 2 s"):
        fly(NET, controller, 1.0, save_every=2.0)
    with pytest.raises(InputError, match=r"`save_every` must be positive and finite \[s\], but fly has save_every=-1"):
        fly(NET, controller, 1.0, save_every=-1)
    with pytest.raises(
        InputError, match=r"`controller` must be a callable .* it is None: without one nothing holds the quadrotors up"
    ):
        fly(NET, None, 1.0)
    with pytest.raises(InputError, match="needs a body that moves freely, but the scene has none"):
        hovering(load_scene("net_held"))
    with pytest.raises(InputError, match='guided by a free point, but "quad0" is none'):
        NetGuide(NET, REST, point="quad0")
    with pytest.raises(InputError, match="Only one of `spread` and `height`"):
        NetGuide(NET, REST, spread=0.5, height=0.5)
    with pytest.raises(InputError, match=r"`height` of a NetGuide must be one at which the net can hang"):
        NetGuide(NET, REST, height=3.0)
    assert isinstance(NET, Scene) and callable(follow([journey(REST)]))
