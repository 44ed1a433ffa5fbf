"""What a pilot does at the start of each step, compiled, see `pilot`: what controllers tell, and what rotors make of it."""

from typing import NamedTuple

import numpy as np
from numba import float64, int64, types, void

from anet_lumped.compiled.jit import inlined, kernel, njit
from anet_lumped.motion.law_steps import GO_ON
from anet_lumped.motion.readings import SIGHT, Sight, see
from integrators.addresses import view_at

from .compiled_law import as_compiled_law
from .laws import command_rotors, turn_rotors
from .seen import Seen
from .timing import SAME_TIME

_f1, _f2, _f3, _i1 = float64[::1], float64[:, ::1], float64[:, :, ::1], int64[::1]
ASK_POSITION, ASK_ATTITUDE, NOT_FINITE = 1, 2, 3  # why the pilot returns to Python
# Numbers of a clock: time between two calls [s], delay of an answer [s], time of the first call and of the last one [s], calls so
# far, number of the answer that acts, answers that act or will.
PERIOD, DELAY, BEGIN, LAST_CALL, CALLS, ACTING, PENDING = range(7)
CLOCK = 7
UNANSWERED = -1


class Stage(NamedTuple):
    """A controller with its rate, hold and delay, compiled or in Python.

    Parameters
    ----------
    guide, law : addresses of laws, 0 for none; a controller without a law is asked in Python
    guide_numbers, numbers : (k,) float64, of both
    goal : (3 m, 3) float64, scratch
    clock : (CLOCK,) float64
    times : (a,) float64 [s], from when each of the answers acts
    answers : (a, m, columns) float64
    """

    guide: int
    law: int
    guide_numbers: np.ndarray
    numbers: np.ndarray
    goal: np.ndarray
    clock: np.ndarray
    times: np.ndarray
    answers: np.ndarray


class Cockpit(NamedTuple):
    """What the pilot works on.

    Parameters
    ----------
    sight : Sight
    position, attitude : Stage
    whole : int, 1 if the attitude's stage is the whole controller
    state : (1,) int64, 0 before the rotors turn
    nothing : (0, 3) float64
    speed, command, limits, mixing, sharing, lags, drag, acting : of `Rotors`
    origins : (m,) int64, rows of the bodies in ``force``
    force, torque : of `GivenForces`
    readings : address
    """

    sight: Sight
    position: Stage
    attitude: Stage
    whole: int
    state: np.ndarray
    nothing: np.ndarray
    speed: np.ndarray
    command: np.ndarray
    limits: np.ndarray
    mixing: np.ndarray
    sharing: np.ndarray
    lags: np.ndarray
    drag: np.ndarray
    acting: np.ndarray
    origins: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    readings: int


STAGE = types.NamedTuple((int64, int64, _f1, _f1, _f2, _f1, _f1, _f3), Stage)
COCKPIT = types.NamedTuple(
    (SIGHT, STAGE, STAGE, int64, _i1, _f2, _f2, _f2, _f2, _f3, _f3, _f2, _f2, _f2, _i1, _f2, _f2, int64), Cockpit
)
_cockpit_at = view_at(COCKPIT)


@kernel(int64(_f1, _f1, float64))
def slot_of_call(clock, times, t):
    """Number of the answer that a call at t [s] is to write, or `UNANSWERED` if no call is due."""
    if clock[CALLS] == 0.0:
        clock[BEGIN] = t
    elif clock[LAST_CALL] == t or t < clock[BEGIN] + clock[CALLS] * clock[PERIOD] - SAME_TIME * clock[PERIOD]:
        return UNANSWERED
    return int(clock[ACTING] + clock[PENDING]) % times.shape[0]


@kernel(void(_f1, _f1, float64, int64))
def book_call(clock, times, t, slot):
    """Book an answer of a call at t [s]: it acts later by the delay, the very first one at once."""
    times[slot] = t + clock[DELAY] if clock[CALLS] > 0.0 else t
    by_time = int((t - clock[BEGIN]) / clock[PERIOD] + SAME_TIME) + 1 if clock[PERIOD] > 0.0 else 0
    clock[CALLS] = max(int(clock[CALLS]) + 1, by_time)
    clock[PENDING] += 1.0
    clock[LAST_CALL] = t


@inlined
def _answer(stage, seen, given):
    """Number of the answer of a stage that acts now, or `UNANSWERED` if Python has to be called."""
    clock, times, t = stage.clock, stage.times, seen.t
    slot = slot_of_call(clock, times, t)
    if slot != UNANSWERED:
        if stage.law == 0:
            return UNANSWERED
        if stage.guide != 0:
            as_compiled_law(stage.guide)(seen, given, stage.guide_numbers, stage.goal)
            as_compiled_law(stage.law)(seen, stage.goal, stage.numbers, stage.answers[slot])
        else:
            as_compiled_law(stage.law)(seen, given, stage.numbers, stage.answers[slot])
        book_call(clock, times, t, slot)
    while clock[PENDING] > 1.0 and times[int(clock[ACTING] + 1.0) % times.shape[0]] <= t + SAME_TIME * clock[PERIOD]:
        clock[ACTING] = (clock[ACTING] + 1.0) % times.shape[0]
        clock[PENDING] -= 1.0
    return int(clock[ACTING])


@njit(error_model="numpy", fastmath={"contract"}, _nrt=False, cache=True)
def pilot(data, t):
    """Write the forces and torques of the rotors in the step that begins at t [s].

    Returns
    -------
    reason : int64
        `GO_ON`, or what Python has to do before the pilot is called again: `ASK_POSITION`, `ASK_ATTITUDE`; `NOT_FINITE`.
    """
    c = _cockpit_at(data)
    s, given = c.sight, c.nothing
    see(c.readings, s)
    seen = Seen(t, s.position, s.velocity, s.rotation, s.angular_velocity, s.pull, s.moment, s.point, s.point_velocity)
    if c.whole == 0:
        slot = _answer(c.position, seen, given)
        if slot == UNANSWERED:
            return ASK_POSITION
        given = c.position.answers[slot]
    slot = _answer(c.attitude, seen, given)
    if slot == UNANSWERED:
        return ASK_ATTITUDE
    wrench = c.attitude.answers[slot]
    for b in range(wrench.shape[0]):
        for x in range(4):
            if wrench[b, x] - wrench[b, x] != 0.0:
                return NOT_FINITE
    if c.state[0] == 0:
        command_rotors(wrench, c.sharing, c.limits, c.speed)
        c.state[0] = 1
    command_rotors(wrench, c.sharing, c.limits, c.command)
    turn_rotors(c.command, c.speed, c.limits, c.mixing, c.lags, c.drag, s.rotation, s.velocity, c.acting)
    for b in range(wrench.shape[0]):
        for x in range(3):
            c.force[c.origins[b], x], c.torque[b, x] = c.acting[b, x], c.acting[b, 3 + x]
    return GO_ON
