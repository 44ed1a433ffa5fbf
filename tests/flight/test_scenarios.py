"""Flights by the names of their scenes and controllers, and what the net weighs in and out of water."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from looked_on import looked_on

from anet_lumped import Free, InputError, SceneError, load_scene
from anet_lumped.files.scene_file import SCENES
from anet_lumped.flight.fly import fly
from anet_lumped.flight.geometric import geometric, hold
from anet_lumped.flight.quadrotor import THESIS_QUADROTOR
from anet_lumped.flight.scenarios import (
    ADMITTANCE,
    CONTROLLERS,
    HOLD,
    NET,
    SCENARIOS,
    Scenario,
    carried_point,
    controller_for,
    point_at_hover,
    scenario_of,
    way_from,
)  # fmt: skip
from anet_lumped.scene.payload_change import PayloadChange

FOUR = load_scene("quadrotors_net")
SCOOP = load_scene("quadrotors_scoop")
LITTER = 0.036  # [kg]
G, WATER = 9.81, 1000.0  # [m/s2], [kg/m3]


def test_every_bundled_scene_of_quadrotors_has_a_flight():
    assert set(SCENARIOS) == {file.stem for file in SCENES.glob("quadrotor*.toml")}


def test_a_way_rests_at_its_stops():
    way = way_from((1.0, 2.0, 3.0), [(1.0, (0, 0, 0)), (3.0, (0, 4, 0)), (5.0, (0, 4, -1))])
    for t, place in ((0.0, (1, 2, 3)), (1.0, (1, 2, 3)), (3.0, (1, 6, 3)), (5.0, (1, 6, 2)), (9.0, (1, 6, 2))):
        q, v, a = way.at(t)
        assert q == pytest.approx(place) and v == pytest.approx(np.zeros(3)) and a == pytest.approx(np.zeros(3), abs=1e-12)
    assert way.at(2.0)[1][1] == pytest.approx(4.0 / 2.0 * 1.875)  # the quintic's largest slope
    assert way_from((1.0, 2.0, 3.0), ()).at(7.0)[0].tolist() == [1.0, 2.0, 3.0]


def test_a_flight_is_chosen_and_changed():
    assert scenario_of(FOUR, "quadrotors_net") == SCENARIOS["quadrotors_net"]
    assert scenario_of(FOUR, "mine.toml", t_end=2.0) == Scenario(NET, 2.0)
    assert scenario_of(load_scene("quadrotor_hover"), "mine.toml", t_end=2.0).controller == HOLD
    changed = scenario_of(FOUR, "quadrotors_net", controller=ADMITTANCE, by=(1, 0, 0), within=2.0)
    assert changed == Scenario(ADMITTANCE, 7.0, [(0.0, (0.0, 0.0, 0.0)), (2.0, (1.0, 0.0, 0.0))])


@pytest.mark.parametrize(
    "call, sentence",
    [
        (lambda: scenario_of(FOUR, "mine.toml"), 'A flight needs a `t_end` [s], but "mine.toml" has no flight of its own'),
        (lambda: scenario_of(FOUR, "mine.toml", t_end=1.0, by=(1, 0, 0), within=-1.0), "Argument `within` must be positive"),
        (lambda: scenario_of(FOUR, "mine.toml", t_end=1.0, by=(1, 0)), "Argument `by` must be"),
        (lambda: controller_for(FOUR, Scenario("nett", 1.0)), 'There is no controller "nett", did you mean "net"?'),
        (lambda: controller_for(FOUR, Scenario("?", 1.0)), "known are hold, net, admittance, predictive"),
        (lambda: carried_point(replace(FOUR, points=[Free("a"), Free("b")], cables=_renamed())), 'but the scene has "a", "b"'),
    ],
)  # fmt: skip
def test_what_cannot_be_flown_is_refused(call, sentence):
    with pytest.raises((InputError, SceneError)) as refused:
        call()
    assert sentence in str(refused.value)


def _renamed():
    return [replace(cable, end="a" if k < 2 else "b") for k, cable in enumerate(FOUR.cables)]


@pytest.mark.parametrize("name", [HOLD, NET, ADMITTANCE])
def test_controllers_by_name_move_the_net(name):
    stops = [(0.0, (0, 0, 0)), (2.0, (0, 0.5, 0))]
    run = fly(FOUR, controller_for(FOUR, Scenario(name, 5.0, stops)), 5.0, dt=0.02)
    start = point_at_hover(FOUR, carried_point(FOUR))
    assert run.ok and run.position("p0")[0] == pytest.approx(start, abs=1e-9)
    assert run.position("p0")[-1] == pytest.approx(np.add(start, (0, 0.5, 0)), abs=0.01)
    assert set(CONTROLLERS) >= {HOLD, NET, ADMITTANCE}


def buoyancy(state):
    """Weight of the water that p0 and the parts of the cables below its level push aside [N]."""
    level, volume = SCOOP.effects[1].level, 0.0
    for cable in SCOOP.cables:
        z = state.shape(cable.name)[:, 2] - level
        for a, b in itertools.pairwise(z):
            under = np.clip(-min(a, b) / max(abs(a - b), 1e-12), 0.0, 1.0)  # share of a straight segment
            volume += under * cable.L0 * np.pi / 4.0 * cable.diameter**2
    return WATER * G * (volume + (SCOOP.points[0].volume if state.position("p0")[2] < level else 0.0))


@pytest.mark.parametrize("depth, litter, picked", [(0.0, 0.0, 0.0), (0.0, LITTER, 0.0), (0.6, 0.0, LITTER)])
def test_the_thrust_of_hovering_is_the_weight_less_the_buoyancy(depth, litter, picked):
    """Out of the water without and with 36 g of litter, and in it before and after it was picked up."""
    lowered = [replace(body, at=(*body.at[:2], body.at[2] - depth)) for body in SCOOP.bodies]
    basket = replace(SCOOP.points[0], mass=SCOOP.points[0].mass + litter)
    events = [PayloadChange("p0", 1.0, basket.mass + picked)] if picked else []
    scene = replace(SCOOP, points=[basket], bodies=lowered, events=events)
    lifted, controller = looked_on(geometric([THESIS_QUADROTOR] * 4, hold([body.at for body in lowered])))
    run = fly(scene, controller, 8.0 if picked else 1.0, dt=0.02)
    mass = sum(b.mass for b in scene.bodies) + sum(c.length * c.mass_per_length for c in scene.cables) + basket.mass
    assert run.ok and len(run.events) == len(events)
    for at, k in ((0.9, 0), (run.t[-1] - 0.02, len(run.t) - 1)):
        pushed = buoyancy(run.state(k))
        assert (pushed > 0.1) == (depth > 0.0)
        held = mass + (picked if at > 1.0 else 0.0)
        # what the water leaves of swinging after 7 s; in air nothing swings from the start
        assert lifted(at) == pytest.approx(held * G - pushed, abs=2e-3)


def test_litter_is_scooped_out():
    run = fly(SCOOP, controller_for(SCOOP, SCENARIOS["quadrotors_scoop"]), SCENARIOS["quadrotors_scoop"].t_end, dt=0.02)
    z, (event,) = run.position("p0")[:, 2], run.events
    level = SCOOP.effects[1].level
    assert run.ok and event.t == 5.0 and event.mass == pytest.approx(SCOOP.points[0].mass + LITTER)
    assert z[0] > level and np.interp(5.0, run.t, z) < level - 0.3 and z[-1] == pytest.approx(z[0], abs=0.02)
    assert run.energy_balance.imbalance < 1e-8 and run.energy_balance.by_effects > 0.1  # the water's drag
