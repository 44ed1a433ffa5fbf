"""Flights whose controllers are compiled: those of Python, to the last bit; laws of one's own; what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from flying import AGILE, alone

from anet_lumped import InputError, Session, load_scene, paths
from anet_lumped.effects import LineChange
from anet_lumped.flight.compiled_law import CompiledLaw
from anet_lumped.flight.fly import fly
from anet_lumped.flight.geometric import AttitudeControl, Cascade, Goal, PositionControl, Wrench, follow, geometric, hold
from anet_lumped.flight.hovering import hovering
from anet_lumped.flight.net_guide import NetGuide
from anet_lumped.flight.quadrotor import THESIS_QUADROTOR
from anet_lumped.flight.rotors import Rotors
from anet_lumped.flight.seen import Seen, look
from anet_lumped.flight.timing import Held
from anet_lumped.prescribed import signals

CREW = [THESIS_QUADROTOR] * 4
NET = load_scene("quadrotors_net")
GUIDE = NetGuide(NET, paths.line((0.0, 0.0, -0.629), (0.0, 1.0, 0.0), 0.5))
STARTS = [body.at for body in NET.bodies]


class InPython:
    """A controller that a flight cannot see through."""

    def __init__(self, controller):
        self.controller = controller

    def reset(self):
        if hasattr(self.controller, "reset"):
            self.controller.reset()

    def __call__(self, *given):
        return self.controller(*given)


def assert_same(first, second):
    """Two runs that are the same to the last bit."""
    assert first.status == second.status and first.work == second.work and first.events == second.events
    for name in ("t", "q", "v", "segment_tension", "energy"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), name


@pytest.mark.parametrize("rates, delay", [pytest.param((100.0, 500.0), 0.0, marks=pytest.mark.slow), ((90.0, 300.0), 0.013)])
def test_it_is_the_flight_of_python(rates, delay):
    """With guide, position control, attitude control or all in Python: called at their rates, held and delayed alike."""
    control = {"rates": rates, "delay": delay}
    flown = fly(NET, geometric(CREW, GUIDE, **control), 0.6, save_every=0.1)
    assert flown.ok and flown.velocity("p0")[-1, 1] > 0.2
    position, attitude = PositionControl(CREW, GUIDE), AttitudeControl(CREW)
    for other in (
        geometric(CREW, InPython(GUIDE), **control),
        Cascade(InPython(position), attitude, rates, delay),
        Cascade(position, InPython(attitude), rates, delay),
        InPython(geometric(CREW, GUIDE, **control)),
    ):
        assert_same(flown, fly(NET, other, 0.6, save_every=0.1))


def test_it_is_the_flight_of_python_through_events():
    """The payload changes, and a cable breaks within a step."""
    scene = load_scene("quadrotors_break")
    controller = geometric(CREW, hold(STARTS))
    flown = fly(scene, controller, 1.2, save_every=0.2)
    assert [event.kind for event in flown.events] == ["payload changed", "broke"]
    assert_same(flown, fly(scene, InPython(controller), 1.2, save_every=0.2))


def test_it_is_the_flight_of_python_with_a_cable_that_is_reeled():
    """Steps that Python has to take, one by one."""
    reeled = replace(NET, effects=[*NET.effects, LineChange({NET.cables[0].name: signals.line(0.0, -0.05, 0.1)})])
    controller = geometric(CREW, hold(STARTS))
    flown = fly(reeled, controller, 0.2, save_every=0.1)
    assert np.abs(flown.position("p0")[-1, :2]).max() > 1e-5
    assert_same(flown, fly(reeled, InPython(controller), 0.2, save_every=0.1))


def test_a_flight_is_a_session_that_is_pushed():
    """The same flight by hand: look, ask, let the rotors turn, push, step."""
    controller, ready = geometric(CREW, GUIDE), hovering(NET)
    flown = fly(NET, controller, 0.4, save_every=0.1)
    session, rotors = Session(ready.scene, 0.004, start=ready.shapes), Rotors(CREW, 0.004)
    controller.reset()
    for k in range(100):
        seen = look(session)
        told = controller(seen)
        if k == 0:
            rotors.settle(*told)
        session.push_bodies(*rotors.step(*told, seen.rotation, seen.velocity), axes="body")
        session.step()
    state = session.state
    for own, saved in ((state.q, flown.q), (state.v, flown.v), (state.segment_tension, flown.segment_tension)):
        assert np.array_equal(own, saved[-1])
    assert np.array_equal(session.energy, flown.energy[-1])


def test_it_is_the_flight_of_python_with_explicit_steps():
    controller = geometric(CREW, hold(np.add(STARTS, (0.0, 0.0, 0.02))))
    runs = [fly(NET, one, 0.004, dt=2e-5, method="verlet", save_every=0.001) for one in (controller, InPython(controller))]
    assert_same(*runs)


def test_a_path_is_followed_as_python_does():
    """`Path.at` in plain Python, against the same path compiled, with a sine and before its first piece."""
    way = paths.harmonic((0.0, 0.0, 0.0), (0.1, 0.0, 0.05), 0.5, 0.3, 0.4)
    late = paths.samples((0.1, 0.6, 1.0), ((0, 0, 0), (0.1, 0.1, 0.0), (0.1, 0.2, 0.0)))
    empty = np.zeros((2, 3))
    for t in (0.0, 0.05, 0.3, 0.61, 2.0):
        seen = Seen(t, empty, empty, np.zeros((2, 3, 3)), empty, empty, empty, empty, empty)
        goal = follow([way, late])(seen)
        for b, path in enumerate((way, late)):
            for told, exact in zip(goal, path.at(t), strict=True):
                assert told[b] == pytest.approx(exact, abs=1e-13)


def climb(seen, given, numbers, told):
    """Thrust of the weight and a number more; counts its calls."""
    numbers[1] += 1.0
    for b in range(told.shape[0]):
        told[b, 0] = 9.81 * 1.04 + numbers[0]
        told[b, 1] = told[b, 2] = told[b, 3] = 0.0


def lift(seen, given, numbers, told):
    for b in range(told.shape[0]):
        told[b, 0] = told[b, 1] = 0.0
        told[b, 2] = 9.81 * 1.04 + numbers[0]


def test_laws_of_ones_own():
    """A thrust of m (g + a) gives the velocity a t, for a whole controller, one with a rate, and forces in a cascade.

    To what steps leave out of balance that Newton's method takes for solved, far below its 1e-6 of 10 m/s.
    """
    law = CompiledLaw(climb, (0.52, 0.0))
    run = fly(alone(), law, 1.0, quadrotors=AGILE)
    assert run.velocity("quad")[-1, 2] == pytest.approx(0.5, abs=1e-8) and law.numbers[1] == 250
    again = fly(alone(), Held(law, rate=100.0), 1.0, quadrotors=AGILE)
    assert again.velocity("quad")[-1, 2] == pytest.approx(0.5, abs=1e-8) and law.numbers[1] == 100
    assert_same(again, fly(alone(), InPython(Held(law, rate=100.0)), 1.0, quadrotors=AGILE))
    position = CompiledLaw(lift, (0.52,), gives="force")
    run = fly(alone(), Cascade(position, AttitudeControl([AGILE])), 1.0, quadrotors=AGILE)
    assert run.velocity("quad")[-1, 2] == pytest.approx(0.5, abs=1e-8)


def test_a_class_with_another_call_is_called():
    """A guide that changes what it inherits is not flown by the law that it inherits."""

    class Higher(NetGuide):
        def __call__(self, seen):
            goal = super().__call__(seen)
            return Goal(np.add(goal.position, (0.0, 0.0, 0.1)), goal.velocity, goal.acceleration)

    low, high = np.array([0.0, 0.0, -0.629]), np.array([0.0, 0.0, -0.529])
    runs = [fly(NET, geometric(CREW, guide), 1.0) for guide in (Higher(NET, low, rate=0.0), NetGuide(NET, high, rate=0.0))]
    assert runs[0].position("quad0")[-1] == pytest.approx(runs[1].position("quad0")[-1], abs=1e-9)
    assert runs[0].position("quad0")[-1, 2] > 0.05


def test_what_is_refused():
    def of_two(seen, given, numbers, told):
        return numbers + seen

    with pytest.raises(InputError, match='`gives` of a CompiledLaw must be "goal", "force" or "wrench", but it is \'torque\''):
        CompiledLaw(climb, gives="torque")
    with pytest.raises(InputError, match='guide of a CompiledLaw must give a "goal", and the law a "force", but the guide is 3'):
        CompiledLaw(climb, gives="force", guide=3)
    with pytest.raises(InputError, match=r"needs a function \(seen, given, numbers, told\), but it is 3"):
        CompiledLaw(3)
    with pytest.raises(InputError, match=r'function .* that Numba compiles, but "of_two" is none: '):
        CompiledLaw(of_two)
    with pytest.raises(InputError, match="must be for as many quadrotors as fly, 4, but it is for 1"):
        fly(NET, geometric(CREW, hold((0, 0, 0))), 1.0)
    with pytest.raises(InputError, match="control of attitudes needs the forces of a position control, but it is given none"):
        fly(NET, AttitudeControl(CREW), 1.0)
    with pytest.raises(InputError, match='that is to give a "force" must not give a "wrench"'):
        fly(NET, Cascade(CompiledLaw(climb, (0, 0)), AttitudeControl(CREW)), 1.0)
    seen = Seen(0.0, *np.zeros((2, 4, 3)), np.zeros((4, 3, 3)), *np.zeros((3, 4, 3)), *np.zeros((2, 1, 3)))
    with pytest.raises(InputError, match=r'law of a "wrench" must be given numbers \(4, 3\), but it is given \(2, 3\)'):
        AttitudeControl(CREW)(seen, np.ones((2, 3)))


@pytest.mark.parametrize("answer", [None, (np.ones(4), np.ones((3, 3))), Wrench(np.ones((2, 4)), np.ones((4, 3)))])
def test_answers_of_another_shape(answer):
    with pytest.raises(InputError, match=r"must give a Wrench, thrusts \(4,\) \[N\] and torques \(4, 3\) \[N m\], but it gives"):
        fly(NET, lambda seen: answer, 1.0)
    with pytest.raises(InputError, match=r"position control must give forces \(4, 3\) \[N\], but it gives 7"):
        fly(NET, Cascade(lambda seen: 7, AttitudeControl(CREW)), 1.0)


@pytest.mark.parametrize("thrust", [np.inf, np.nan])
def test_answers_that_are_not_finite(thrust):
    law = CompiledLaw(climb, (thrust, 0.0))
    for controller in (law, InPython(law)):
        with pytest.raises(InputError, match="must give finite thrusts and torques, but at t = 0 s it gives"):
            fly(alone(replace(AGILE)), controller, 1.0, quadrotors=AGILE)
