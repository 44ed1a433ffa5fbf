"""Prescribed scalar functions of time, such as a temperature or a length paid out: the paths of `paths`, of one coordinate."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from anet_lumped.checks import SceneError, check_number, shown

from . import paths
from .paths import Path


@dataclass(frozen=True, repr=False)
class Signal:
    """A scalar function of time; make one with `line`, `samples` or `harmonic`.

    Parameters
    ----------
    kind : "line", "samples" or "harmonic"
    parameters : pairs (name, value) of that function's arguments; they alone decide equality
    path : Path whose x it is
    """

    kind: str
    parameters: tuple[tuple[str, Any], ...]
    path: Path = field(compare=False)

    def __repr__(self) -> str:
        return f"{self.kind}({', '.join(f'{name}={value!r}' for name, value in self.parameters)})"

    def at(self, t: float) -> tuple[float, float]:
        """Return the value at time `t` [s] and its rate of change."""
        x, rate, _ = self.path.at(t)
        return float(x[0]), float(rate[0])


def line(start: float, rate: float, ramp: float) -> Signal:
    """Return a function that is `start` up to t = 0 and then changes, from rest to a constant `rate`; see `paths.line`.

    Parameters
    ----------
    start : float, value up to t = 0
    rate : float, its change a second once the ramp is over
    ramp : float [s], time to reach the rate; 0 for at once
    """
    start, rate = check_number("start", start, "", "line"), check_number("rate", rate, "", "line")
    path = paths.line(_along_x(start), _along_x(rate), ramp)
    return _signal("line", path, start=start, rate=rate)


def samples(t: Sequence[float], values: Sequence[float], ends: Sequence[float] | None = None, periods: int | None = None) -> Signal:
    """Return the cubic spline through samples, from rest at the first to rest at the last; see `paths.samples`.

    Parameters
    ----------
    t : (k,) array_like [s], increasing, k >= 2
    values : (k,) array_like
    ends : (2,) array_like or None, rates at the first and at the last sample, with which it then goes on; at rest if None
    periods : int or None, times that it is run through, as a periodic spline; it must end where it begins
    """
    values = _scalars("values", values)
    if len(values) < 2:
        raise SceneError(
            f"Argument `values` of samples must hold at least two numbers, one for each of `t`, but holds {shown(values)}."
        )
    if len(t := _scalars("t", t)) != len(values):
        raise SceneError(f"Arguments `t` and `values` of samples must be of one length, but are of {len(t)} and {len(values)}.")
    rates = None if ends is None else _scalars("ends", ends)
    along = None if rates is None else tuple(map(_along_x, rates))
    path = paths.samples(t, tuple(map(_along_x, values)), along, periods)
    return _signal("samples", path, values=values, **({} if rates is None else {"ends": rates}))


def _scalars(argument: str, values: Any) -> tuple[float, ...]:
    try:
        return tuple(map(float, values))
    except (TypeError, ValueError, OverflowError) as error:
        raise SceneError(f"Argument `{argument}` of samples must be numbers, but {error}.") from None


def harmonic(center: float, amplitude: float, frequency: float, phase: float = 0.0, ramp: float = 0.0) -> Signal:
    """Return center + S(t/ramp) amplitude sin(2 pi frequency t + phase); see `paths.harmonic`.

    Parameters
    ----------
    center : float, value about which it swings
    amplitude : float
    frequency : float [Hz]
    phase : float [rad]
    ramp : float [s], time in which the swing grows from nothing; 0: full swing for ever
    """
    center, amplitude = check_number("center", center, "", "harmonic"), check_number("amplitude", amplitude, "", "harmonic")
    path = paths.harmonic(_along_x(center), _along_x(amplitude), frequency, phase, ramp)
    return _signal("harmonic", path, center=center, amplitude=amplitude)


def check_number_or_signal(argument: str, value: Any, unit: str, owner: str) -> float | Signal:
    """Return a number as a float, or a Signal as it is; arguments as in `checks.check_number`."""
    if isinstance(value, Signal):
        return value
    try:
        return check_number(argument, value, unit, owner)
    except SceneError:
        raise SceneError(
            f"Argument `{argument}` must be a finite number [{unit}] or a signal of anet_lumped.signals, but {owner} has "
            f"{argument}={shown(value)}."
        ) from None


KINDS: dict[str, Callable] = {"line": line, "samples": samples, "harmonic": harmonic}
OF_VECTORS = {"velocity": "rate", "xyz": "values"}  # what an argument of a path is called here


def _along_x(value: float) -> tuple[float, float, float]:
    return value, 0.0, 0.0


def _signal(kind: str, path: Path, **scalars: Any) -> Signal:
    named = ((OF_VECTORS.get(name, name), value) for name, value in path.parameters)
    return Signal(kind, tuple((name, scalars.get(name, value)) for name, value in named), path)
