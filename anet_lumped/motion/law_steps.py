"""Steps of a session under a compiled law, which gives the forces and torques on its bodies at the start of each or of some.

A step is that of `Session.step`, bit for bit. Python is asked only where the law asks it, and at events.
"""

from typing import Any, NamedTuple, Protocol

import numpy as np
from numba import float64, int64, types

from anet_lumped.compiled.addresses import callable_at
from anet_lumped.results.energy_balance import BY_EFFECTS, WORK
from integrators.addresses import view_at, words_of
from integrators.compile_once import compile_for
from integrators.jit import march_loop
from integrators.marching import held_march
from integrators.system import DONE, SAME_TIME, entry_point

from .body_readings import BodyTable
from .given_forces import spread, work_of
from .readings import TABLE

_f1, _f2, _i1, _i2 = float64[::1], float64[:, ::1], int64[::1], int64[:, ::1]
LAW_AT_START = int64(int64, float64)  # of the address of its data, and the time [s]; returns `GO_ON` or a number of its own
GO_ON = 0
as_law = callable_at(LAW_AT_START)


class StepLaw(Protocol):
    """A law that `LawSteps` marches under."""

    address: int  # of a compiled function of the signature `LAW_AT_START`

    def attach(self, session: Any) -> int:
        """Take what the session works on until its next event; returns the address of the data of the law."""

    def ask(self, t: float, reason: int) -> None:
        """Do what the law has asked for at a time [s]; then it is called again."""


class Given(NamedTuple):
    """What a march needs to write the forces of a law on the nodes: arguments of `spread` and `work_of`, and the march.

    Parameters
    ----------
    q, v : (n, 3) float64 [m], [m/s]
    force, torque, axes, of_body, slot, table, rows, params : of `spread`
    node : (k,) int64, and before : (k, 3) float64 [m], scratch: places that forces act at
    carried : (ENERGIES,) float64 [J], account of the session
    at_end : (1,) int64, of `Readings`, and explicit : int, what it is after a step
    march : address of the `HeldMarch`
    evaluates_force : 1 if a step takes over the force at the end of the last one
    law, law_data : addresses
    first_t, dt : float [s]
    parts : steps from one call of the law to the next
    """

    q: np.ndarray
    v: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    axes: np.ndarray
    of_body: np.ndarray
    slot: np.ndarray
    table: BodyTable
    rows: np.ndarray
    params: np.ndarray
    node: np.ndarray
    before: np.ndarray
    carried: np.ndarray
    at_end: np.ndarray
    explicit: int
    march: int
    evaluates_force: int
    law: int
    law_data: int
    first_t: float
    dt: float
    parts: int


GIVEN = types.NamedTuple(
    (_f2, _f2, _f2, _f2, _i2, _i1, _i1, TABLE, _i1, _f1, _i1, _f2, _f1, _i1) + (int64,) * 5 + (float64,) * 2 + (int64,), Given
)
_given_at = view_at(GIVEN)


@march_loop
def steps_under_law(address, t, first, last):
    """Take the steps from number ``first`` to ``last``, which is not taken, at most until the law asks or a step does not end.

    Returns
    -------
    steps, t, reason, status, node : int64, float64, int64, int64, int64
        Number of the step that did not end, or ``last``; the time there [s]; what the law returned; of `held_march.step_to`.
    """
    given = _given_at(address)
    table, law = given.table, as_law(given.law)
    for k in range(first, last):
        if k % given.parts == 0:
            reason = law(given.law_data, t)
            if reason != GO_ON:
                return k, t, reason, DONE, -1
        spread(
            0.5 * given.dt, given.q, given.v, given.force, given.torque, given.axes, given.of_body, given.slot, table.first,
            table.node, table.weights, table.directions, table.share, given.rows, given.params,
        )  # fmt: skip
        if given.evaluates_force == 1:
            held_march.begin(given.march)
        node, before, q = given.node, given.before, given.q
        for i in range(node.shape[0]):
            for x in range(3):
                before[i, x] = q[node[i], x]
        goal = given.first_t + (k + 1) * given.dt
        status, worst = held_march.step_to(given.march, goal)
        work = work_of(given.params, given.slot, node, before, q)
        given.carried[WORK] += work
        given.carried[BY_EFFECTS] += work
        if status != DONE:
            return k, t, reason, status, worst
        given.at_end[0] = given.explicit
        t = goal
    return last, t, GO_ON, DONE, -1


@march_loop
def law_at_start(address, t):
    """Call the law at a time [s]; returns what it returns."""
    given = _given_at(address)
    return as_law(given.law)(given.law_data, t)


class LawSteps:
    """A session that is marched under a law.

    Parameters
    ----------
    session : Session
    law : StepLaw
    parts : int, steps from one call of the law to the next, through which its forces and torques are held
    """

    def __init__(self, session: Any, law: StepLaw, parts: int = 1) -> None:
        self.session, self.law, self.parts = session, law, parts
        held_march.compiled()
        self._march = entry_point(compile_for(steps_under_law, (int64, float64, int64, int64)))
        self._call = entry_point(compile_for(law_at_start, (int64, float64)))
        self._readings: Any = None

    def march(self, count: int) -> None:
        """Take ``count`` steps.

        Raises
        ------
        SessionError, SceneError : as `Session.step`; what the law raises where it is asked
        """
        session, reason = self.session, GO_ON
        last = session._steps + count
        while session._steps < last:
            self._attach()
            end = self._steps_in_one(last)
            if end == session._steps:
                while session._steps % self.parts == 0 and (reason := self._call(self._at, session.t)) != GO_ON:
                    self.law.ask(session.t, reason)
                session.step()
                continue
            step, t, reason, status, node = self._march(self._at, session.t, session._steps, end)
            session._count_steps(step - session._steps)
            if reason != GO_ON:
                self.law.ask(t, reason)
            elif status != DONE:
                session._after(status, node)
                session._finish_step()

    def _steps_in_one(self, last: int) -> int:
        """Number of the first step, up to ``last``, that Python has to take: what is driven from outside, reeled, or changes."""
        session = self.session
        if session._motions.tracks or len(session._net.lengths.cable):
            return session._steps
        if not session._due:
            return last
        before = (session._due[0] - session._first_t) / session.dt - SAME_TIME  # steps that end before the event
        return int(min(last, max(session._steps, np.ceil(before) - 1)))

    def _attach(self) -> None:
        """Take what the session works on, which is made anew at events."""
        session = self.session
        if self._readings is session.readings:
            return
        forces, self._readings = session._forces, session.readings
        forces.acts = forces.turns = True
        state = session._state
        self._given = Given(
            state.q, state.v, forces.force, forces.torque, forces.axes, forces.of_body, forces._slot, session._table, forces._rows,
            forces._params, forces._node, np.zeros((len(forces._node), 3)), session._legs.carried, session.readings.at_end,
            int(session._scheme.explicit), session._address, int(session._scheme.evaluates_force), self.law.address,
            self.law.attach(session), session._first_t, session.dt, self.parts,
        )  # fmt: skip
        self._words = np.array(words_of(self._given), np.int64)
        self._at = self._words.ctypes.data
