"""A run beside measured tensions and marker positions over time: aligned in time, and how far apart they are.

The clock of a measurement is not that of the run. Sample y(t) is compared with the run at t - t_0 + s, t_0 the first time that was
measured, and the shift s is the one that minimises, over the times that both have,

    J(s) = mean over channels of  m(s)/max(min m, 1e-6 var y) ,   m(s) = mean |y(t) - Y(t - t_0 + s)|^2 ,

so that a channel counts by how well it can be met at all, and noisy ones count little. Of shifts that are nearly as good, as of a
periodic motion, the smallest is taken. The phase error of a channel is its own such shift less the common one: positive where the
run is late. Positions are those of the scene's frame.
"""

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from anet_lumped.checks import InputError, check_number, nearest, quoted
from anet_lumped.files.measured_series import Series
from anet_lumped.results.run import Run

ENDS = {".start": "start", ".end": "end"}  # of a cable
MOST_SHIFT = 0.25  # of the measured time, that a shift is sought within
TRIED, SEARCHED = 401, 2000  # shifts that are tried, and samples of a channel that they are tried with
BARRIER, NEARLY = (
    0.5,
    0.02,
)  # of what J rises by from its least to its median: between shifts that are two, and of one as good as the best
SURE = 0.25  # rise of J from its least to its median, over its least
LEAST, TINY = 1e-6, 1e-300  # of a channel's variance, below which a difference is none; against division by zero
STILL = 1e-9  # of its size: a channel that varies less has no phase
ON_CABLE = re.compile(r"(.+)@([0-9.eE+-]+)")


@dataclass(frozen=True)
class ChannelMismatch:
    """One channel beside the run; [N] for a tension and [m] for a marker.

    Attributes
    ----------
    name : of the channel
    samples : that were compared
    rmse, largest : of the difference
    measured_peak, model_peak : largest tension; of a marker, largest distance from the middle of its path
    peak_error : the model's over the measured one, less 1
    phase_error : float [s], positive where the model is late; NaN where the channel tells none, as one that hardly varies
    """

    name: str
    samples: int
    rmse: float
    largest: float
    measured_peak: float
    model_peak: float
    peak_error: float
    phase_error: float


@dataclass(frozen=True)
class MotionMismatch:
    """A run beside what was measured.

    Attributes
    ----------
    shift : float [s], time of the run at the first sample
    found : bool, whether the shift was sought, and not given
    sure : bool, whether J is larger by a quarter or more at half of all shifts; else the motion tells little of the shift
    at_end : bool, whether J is least at an end of the shifts that are tried, so that the right one may lie beyond
    overlap : float [s], that both have
    before, after : float [s], that were measured before the run begins and after it ends, and are not compared
    tensions, markers : channels
    curves : by channel, times of the run (k,) [s], what was measured and what the run has, (k, d)
    """

    shift: float
    found: bool
    sure: bool
    at_end: bool
    overlap: float
    before: float
    after: float
    tensions: list[ChannelMismatch]
    markers: list[ChannelMismatch]
    curves: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]

    def plot(self) -> Any:
        """A figure of matplotlib: what was measured and what the run has over time, the channels that differ most."""
        from anet_lumped.views.series_figure import plot_series

        return plot_series(self)


def compare_motion(
    run: Run, tensions: Series | None = None, tracks: Series | None = None, shift: float | None = None
) -> MotionMismatch:
    """Compare a run with measured series.

    Parameters
    ----------
    run : Run
    tensions : Series or None
        By the name of a cable: `Run.end_tension` at its end, as `NAME.end`; `NAME.start` is that at its start.
    tracks : Series or None
        By the name of a point, or `CABLE@ARC`, the unstretched length from the cable's start [m].
    shift : float or None [s]
        Time of the run at the first sample; sought within a quarter of the measured time if not given.

    Raises
    ------
    InputError : a channel that the scene has not, nothing to compare, or times that do not meet
    """
    if tensions is None and tracks is None:
        raise InputError("A run must be compared with tensions or with tracks, but neither is given.")
    if shift is not None:
        shift = check_number("shift", shift, "s", "the comparison")
    starts = [series.t[0] for series in (tensions, tracks) if series is not None]
    pairs = [_pair(name, series, min(starts), _tension(run, name)) for series in [tensions] if series for name in series.channels]
    pairs += [_pair(name, series, min(starts), _track(run, name)) for series in [tracks] if series for name in series.channels]
    span = max(series.t[-1] for series in (tensions, tracks) if series is not None) - min(starts)
    common, rise = _best_shift(pairs, run.t, MOST_SHIFT * span) if shift is None else (shift, math.inf)
    if math.isnan(common):
        raise InputError(
            f"Measured times must meet those of the run, which ends at {run.t[-1]:g} s, but at no shift does half of them."
        )
    found = [_mismatch(pair, run.t, common, MOST_SHIFT * span) for pair in pairs]
    number = len(tensions.channels) if tensions else 0
    curves = {pair.name: _together(pair, run.t, common) for pair in pairs}
    times = np.concatenate([t for t, _, _ in curves.values()])
    sure = shift is not None or (rise >= SURE and not all(_still(pair.measured) for pair in pairs))
    at_end = shift is None and _at_end(common, MOST_SHIFT * span)
    overlap, before, after = float(np.ptp(times)), max(0.0, run.t[0] - common), max(0.0, common + span - run.t[-1])
    return MotionMismatch(
        common, shift is None, sure, at_end, overlap, float(before), float(after), found[:number], found[number:], curves
    )


@dataclass(frozen=True)
class _Pair:
    """A channel: its times from the first sample on (k,), samples (k, d), and the run's values at its saved times (m, d)."""

    name: str
    t: np.ndarray
    measured: np.ndarray
    model: np.ndarray


def _pair(name: str, series: Series, begin: float, model: np.ndarray) -> _Pair:
    seen = np.isfinite(series.channels[name]).all(axis=1)
    return _Pair(name, series.t[seen] - begin, series.channels[name][seen], model)


def _tension(run: Run, name: str) -> np.ndarray:
    """Tension of a cable at the node where it ends, (m, 1) [N]."""
    cables = [cable.name for cable in run.scene.cables]
    cable, end = next(((name.removesuffix(ending), at) for ending, at in ENDS.items() if name.endswith(ending)), (name, "end"))
    if name in cables:
        cable, end = name, "end"
    if cable not in cables:
        raise InputError(
            f"A measured tension must have the name of a cable, but the scene has none called {quoted(cable)}"
            + (nearest(cable, cables) or ".")
        )
    return run.end_tension(cable, getattr(run.scene.cable(cable), end))[:, None]


def _track(run: Run, name: str) -> np.ndarray:
    """Places of a point, or of a place on a cable, (m, 3) [m]."""
    points = [*run.model.node_of]
    if name in points:
        return run.position(name)
    on_cable = ON_CABLE.fullmatch(name)
    cables = {cable.name: cable for cable in run.scene.cables}
    if on_cable is None or on_cable[1] not in cables:
        raise InputError(
            f"A marker must have the name of a point, or of a cable and an arc as in s0-p0@0.25, but it is {quoted(name)}"
            + (nearest(name, points) or ".")
        )
    cable, shape = cables[on_cable[1]], run.shape(on_cable[1])
    try:
        arc = float(on_cable[2])
    except ValueError:
        arc = math.nan
    if not 0.0 <= arc <= cable.length:
        raise InputError(f"The arc of a marker must be between 0 and {cable.length:g} m, but it is {quoted(name)}.")
    k = min(int(arc / cable.length * cable.segments), cable.segments - 1)
    share = arc / cable.length * cable.segments - k
    return (1.0 - share) * shape[:, k] + share * shape[:, k + 1]


def _together(pair: _Pair, t: np.ndarray, shift: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times of the run, and measured and model values, at the samples that the run has at a shift."""
    at = pair.t + shift
    both = (at >= t[0]) & (at <= t[-1])
    model = np.column_stack([np.interp(at[both], t, column) for column in pair.model.T])
    return at[both], pair.measured[both], model


def _mean_squares(pairs: list[_Pair], t: np.ndarray, shift: float) -> np.ndarray:
    """m of the module's docstring of each channel; infinite where half of its samples or more find no time of the run."""
    found = np.full(len(pairs), np.inf)
    for k, pair in enumerate(pairs):
        at, measured, model = _together(pair, t, shift)
        if len(at) > len(pair.t) / 2:
            found[k] = ((measured - model) ** 2).sum() / len(at)
    return found


def _best_shift(pairs: list[_Pair], t: np.ndarray, most: float, about: float = 0.0) -> tuple[float, float]:
    """Shift within ``most`` [s] of another that minimises J, the nearest of those that are nearly as good, and J's rise.

    The shift is NaN where at none half of every channel's samples find a time of the run. The rise is that of J from its least to
    its median, over its least; without one the shift is the other.
    """
    few = [_Pair(p.name, p.t[:: 1 + len(p.t) // SEARCHED], p.measured[:: 1 + len(p.t) // SEARCHED], p.model) for p in pairs]
    tried = about + np.linspace(-most, most, TRIED)
    squares = np.array([_mean_squares(few, t, shift) for shift in tried])
    if not np.isfinite(squares).all(axis=1).any():
        return math.nan, 0.0
    scales = np.maximum(squares.min(axis=0), [LEAST * pair.measured.var(axis=0).sum() + TINY for pair in few])
    costs = (squares / scales).mean(axis=1)
    rise = costs - costs.min()
    high = float(np.median(rise[np.isfinite(rise)]))
    if high <= STILL * costs.min():
        return about, 0.0
    low = np.flatnonzero(rise <= BARRIER * high)
    basins = np.split(low, np.flatnonzero(np.diff(low) > 1) + 1)  # shifts between which J rises
    lowest = np.array([basin[rise[basin].argmin()] for basin in basins])
    good = lowest[rise[lowest] <= NEARLY * high]
    best = int(good[np.abs(tried[good] - about).argmin()])
    step = tried[1] - tried[0]
    bounds = tried[best] - step, tried[best] + step
    finer = minimize_scalar(
        lambda shift: (_mean_squares(few, t, shift) / scales).mean(),
        bounds=bounds,
        method="bounded",
        options={"xatol": 1e-4 * step},
    )
    return float(finer.x if finer.fun <= costs[best] else tried[best]), high / costs.min()


def _mismatch(pair: _Pair, t: np.ndarray, shift: float, most: float) -> ChannelMismatch:
    at, measured, model = _together(pair, t, shift)
    if len(at) < 2:
        raise InputError(
            f"Measured times must meet those of the run, which ends at {t[-1]:g} s, but those of {quoted(pair.name)} do not."
        )
    error = np.linalg.norm(measured - model, axis=1)
    measured_peak, model_peak = _peak(measured), _peak(model)
    return ChannelMismatch(
        pair.name,
        len(at),
        float(np.sqrt((error**2).mean())),
        float(error.max()),
        measured_peak,
        model_peak,
        model_peak / measured_peak - 1.0 if measured_peak > STILL * np.abs(measured).max() else math.nan,
        _phase_error(pair, t, shift, most, (measured, model)),
    )


def _peak(values: np.ndarray) -> float:
    """Largest tension, or largest distance from the middle of a path."""
    return float(values.max() if values.shape[1] == 1 else np.linalg.norm(values - values.mean(axis=0), axis=1).max())


def _still(values: np.ndarray) -> bool:
    return bool(values.std(axis=0).max() <= STILL * np.abs(values).max())


def _at_end(shift: float, most: float) -> bool:
    """Whether a shift [s] is, but for one of those tried, the largest that was tried to either side."""
    return abs(shift) >= (1.0 - 2.0 / TRIED) * most


def _phase_error(pair: _Pair, t: np.ndarray, shift: float, most: float, both: tuple[np.ndarray, np.ndarray]) -> float:
    if any(_still(values) for values in both):
        return math.nan
    own, rise = _best_shift([pair], t, most, shift)
    known = rise >= SURE and not _at_end(own - shift, most)  # else the motion tells little, or ends there
    return own - shift if known else math.nan
