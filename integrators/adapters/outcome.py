"""The task and the outcome of a march with a solver of another package."""

from dataclasses import dataclass

import numpy as np

from integrators.system import POWER_INSIDE, POWER_OUTSIDE, POWER_PUT_IN

LARGEST_COORDINATE = 1e12  # [m], [m/s], beyond which a motion has diverged


@dataclass(frozen=True, eq=False)
class Task:
    """The task of a march.

    Parameters
    ----------
    method : str
    t0, t_end : float [s]
    stops : increasing (k,) float64 [s]
        Times that a step must end on, where the solver starts anew.
    q, v : (n, 3) float64 [m], [m/s], at t0; not changed
        Of all nodes, the moving ones first.
    times : increasing (k,) float64 [s], from t0 to t_end, at which to save
    first_step : float [s]
    rtol, atol : float, [m] and [m/s]
        The error of a component y_i in a step is kept below atol + rtol |y_i|.
    """

    method: str
    t0: float
    t_end: float
    stops: np.ndarray
    q: np.ndarray
    v: np.ndarray
    times: np.ndarray
    first_step: float
    rtol: float
    atol: float

    def ends(self):
        """Times at which the solver has to end a step and start anew, and t_end last, as a list of floats [s]."""
        between = (self.stops > self.t0) & (self.stops < self.t_end)
        return [*self.stops[between].tolist(), float(self.t_end)]

    def saved_times(self):
        """Times to save at, as an array of its own that begins at t0 to the last bit."""
        times = np.array(self.times, float)
        times[0] = self.t0
        return times


@dataclass(frozen=True, eq=False)
class Outcome:
    """How a march ended, and its results.

    Parameters
    ----------
    status, counts : int, (COUNTS,) int64, as in `integrators.system`
    reason : str, why it stopped, if it did not reach its end
    node : int, where it diverged, else -1
    t : (k,) float64 [s]
        The times of the task up to the time reached, and the time reached.
    q, v : (k, n_free, 3) float64 [m], [m/s], of the moving nodes at these times
    work : (k, 3) float64 [J], taken inside, taken outside and put in since the start, see `integrators.system`
    wall_time : float [s], without that of compiling
    """

    status: int
    reason: str
    node: int
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    work: np.ndarray
    counts: np.ndarray
    wall_time: float

    @property
    def put_in(self):
        """(k,) float64 [J], since the start."""
        return self.work[:, POWER_PUT_IN]

    @property
    def dissipated(self):
        """(k,) float64 [J], taken inside and outside since the start."""
        return self.work[:, POWER_INSIDE] + self.work[:, POWER_OUTSIDE]


def fastest_node(rates):
    """Node whose rate (n_free, 3) is the largest, or the first one whose rate is not a number."""
    return int(np.argmax(np.abs(np.asarray(rates).ravel()))) // 3
