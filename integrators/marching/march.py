"""A march with a scheme of this package: its arrays, its compiled loop and its outcome."""

import logging
import math
import time
from dataclasses import dataclass

import numpy as np

from integrators.compile_once import compile_for
from integrators.schemes.record import Scheme
from integrators.states import Saved, scratch_for
from integrators.system import (
    BALANCE,
    COUNTS,
    ENERGIES,
    STEP,
    STEPS,
    StepState,
    System,
    entry_point,
    first_class,
    words_in_memory,
)

from . import embedded_steps
from .adaptive_steps import AdaptiveSteps, compiled_adaptive_steps
from .embedded_steps import PairLimits, compiled_embedded_steps
from .error_growth import Growth, step_error
from .fixed_steps import FixedSteps, compiled_fixed_steps
from .interruptible import interruptible
from .stepper import Stepper

LOG = logging.getLogger(__name__)
SHORT = 1e5  # nodes times steps of a march that Ctrl-C may wait for: some 10 ms, of the dearest forces 0.3 s


@dataclass(frozen=True, eq=False)
class Outcome:
    """How a march ended, and its results.

    Parameters
    ----------
    status : int, see `integrators.system`
    t : float [s], time reached
    node : int, where it went wrong, or -1
    saved : Saved, the rows written
    counts : (COUNTS,) int64, work counts
    wall_time : float [s], of the march alone
    interrupted : bool, Ctrl-C came; the caller has to raise it again
    error : float or None [m], sum of the estimated errors of the steps, where they were chosen by comparing steps
    held, held_for : int, float [s]
        Steps of an embedded pair that stability held, and their time.
    """

    status: int
    t: float
    node: int
    saved: Saved
    counts: np.ndarray
    wall_time: float
    interrupted: bool
    error: float | None = None
    held: int = 0
    held_for: float = 0.0


class March:
    """A march of a system with a scheme of this package: its arrays and its compiled loop. It may be marched again and again.

    Parameters
    ----------
    scheme : Scheme, of this package
    system : System
    data_address : int, of what the functions of the system work on
    times : FixedSteps or AdaptiveSteps
    n : number of nodes
    saves : (times, numbers observed)
        Times: increasing (k,) float64 [s] at which an adaptive march saves, from its start on; for a march with fixed steps, the
        number of rows that it may write. Numbers observed: how many numbers the system observes of a state.
    parameters : (k,) float64 or None
        From `Scheme.parameters`; None takes the defaults.
    """

    def __init__(
        self, scheme: Scheme, system: System, data_address: int, times: FixedSteps | AdaptiveSteps, n, saves, parameters=None
    ) -> None:
        self.scheme, self.system, self.times, self.words = scheme, system, times, words_in_memory(system)
        self.adaptive, (times_or_rows, observed) = isinstance(times, AdaptiveSteps), saves
        t = np.array(times_or_rows, float) if self.adaptive else np.empty(times_or_rows)
        looks = self.adaptive or times.look_every > 0
        self.saved = _rows(t, n, observed, system.notices if looks else 0)
        self.rooms = [self.saved]
        self.state = StepState(np.empty((n, 3)), np.empty((n, 3)), np.zeros((scheme.memory_rows, n, 3)), np.zeros(BALANCE))
        self.counts = np.zeros(COUNTS, np.int64)
        step = first_class(compile_for(scheme.step, STEP))
        parameters = scheme.parameters() if parameters is None else parameters
        stepper = Stepper(step, self.words.ctypes.data, data_address, parameters, self.counts)
        steps = 0.0
        if self.adaptive and scheme.embedded:
            loop, loop_argument = compiled_embedded_steps(), PairLimits(scheme.order, embedded_steps.MOST_WORK, scheme.stiff_beyond)
        elif self.adaptive:
            loop, loop_argument = compiled_adaptive_steps(), scheme.order
        else:
            loop = compiled_fixed_steps()
            steps = (times.t_end - times.origin) / times.dt
            loop_argument = step_error(scheme, steps)
        self.scratch = scratch_for(self.state, scheme.carried_rows, observed, system.notices)
        room = () if self.adaptive else (Growth(np.empty((n, 3)), np.zeros((n, 3))),)
        self.loop, self.short = entry_point(loop), not self.adaptive and steps * n < SHORT
        self.given = stepper, times, loop_argument, self.state, self.scratch, *room, self.saved

    def renew(self, times: FixedSteps, room: int = 0) -> None:
        """Make ready to march once more, with other fixed steps, as many as before.

        Parameters
        ----------
        times : FixedSteps
        room : int
            Number of the arrays in which the next march saves; what the last march saved in these is overwritten.
        """
        while len(self.rooms) <= room:
            shapes = self.saved.q.shape[1], self.saved.observed.shape[1], self.saved.noticed.shape[1]
            self.rooms.append(_rows(np.empty_like(self.saved.t), *shapes))
        self.times, self.saved = times, self.rooms[room]
        stepper, _, *others, _ = self.given
        self.given = stepper, times, *others, self.saved
        for numbers in (self.state.memory, self.state.balance, self.counts, self.saved.energy):
            numbers.fill(0)
        self.saved.error.fill(np.nan)
        self.words[-1:].view(np.float64)[0] = self.system.largest

    def march(self, q, v) -> Outcome:
        """March from the state q, v (n, 3) float64 [m], [m/s], which are not changed."""
        times, counts, saved = self.times, self.counts, self.saved
        self.state.q[:], self.state.v[:] = q, v
        started = time.perf_counter()

        def tell():
            if not self.adaptive and counts[STEPS]:
                total, seconds = math.ceil((times.t_end - times.t0) / times.dt), time.perf_counter() - started
                left = (total / counts[STEPS] - 1.0) * seconds
                if left > 0.0:
                    LOG.info("step %d of %d, %.0f s left if the others take as long", counts[STEPS], total, left)
                else:  # steps that did not converge were cut
                    LOG.info("step %d, where %d were meant: steps that do not converge are cut", counts[STEPS], total)

        (status, rows, t, node, *more), interrupted = interruptible(self.loop, *self.given, tell=tell, short=self.short)
        wall_time = time.perf_counter() - started
        if self.scheme.error_shift and not self.adaptive:
            saved.error[:rows] += (
                self.scheme.error_shift * times.dt * np.maximum.accumulate(np.abs(saved.v[:rows]).max(axis=(1, 2)))
            )
        return Outcome(status, t, node, Saved(*(part[:rows] for part in saved)), counts.copy(), wall_time, interrupted, *more)


def march(
    scheme: Scheme, system: System, data_address: int, times: FixedSteps | AdaptiveSteps, q, v, saves, parameters=None
) -> Outcome:
    """March a system once, from the state q, v (n, 3) float64 [m], [m/s]; the rest is as of a `March`."""
    return March(scheme, system, data_address, times, len(q), saves, parameters).march(q, v)


def _rows(t, n, observed, notices) -> Saved:
    """Room for the rows of a march of n nodes at times ``t`` (k,)."""
    q, v, energy = np.empty((len(t), n, 3)), np.empty((len(t), n, 3)), np.zeros((len(t), ENERGIES))
    return Saved(t, q, v, energy, np.empty((len(t), observed)), np.full(len(t), np.nan), np.empty((len(t), notices)))
