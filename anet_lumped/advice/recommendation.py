"""What `recommend` answers: segments, the best method with its step, the runner-up, and the errors that are left."""

from dataclasses import dataclass
from typing import Any

from anet_lumped.checks import printable
from anet_lumped.scene.scene import Scene


class RecommendError(RuntimeError):
    """An error that no segments, method and step within reach keep."""


@dataclass(frozen=True)
class Candidate:
    """A method with its step [s] or tolerance, its error in time [m] or [N], and how many times faster than real time it runs.

    Its time is that of the processor, so that what else the machine does decides nothing.
    """

    method: str
    dt: float | None
    rtol: float | None
    error: float
    times_real_time: float
    extrapolate: bool = False

    def __str__(self) -> str:
        return (
            f"{self.method} with "
            + (f"dt={self.dt:.3g} s" if self.rtol is None else f"rtol={self.rtol:.2g}")
            + (", extrapolated" if self.extrapolate else "")
        )

    @property
    def stepping(self) -> dict[str, Any]:
        """Arguments of `simulate`."""
        found = {"method": self.method} | ({"dt": self.dt} if self.rtol is None else {"rtol": self.rtol})
        return found | ({"extrapolate": True} if self.extrapolate else {})


@dataclass(frozen=True, repr=False)
class Recommendation:
    """What `recommend` found; ``str`` has all of it, ``repr`` a short line.

    Parameters
    ----------
    scene : Scene, with the segments recommended
    best, runner_up : Candidate, Candidate or None
    points : tuple of str, whose places the error is of
    tension : str or None, the cable whose tension the error is of instead
    t_end, start : float [s] and str, simulated
    error : float [m] or [N], asked for
    segments_error, time_error : float [m] or [N], parts of the error, estimated
    checked_error : float or None [m] or [N], against a run with twice the segments and half the step
    elasticity : float or None [m] or [N], how far the same net that does not stretch is from it
    fast_enough : bool, whether it reaches the pace asked for
    rigid : Candidate or None
        `links` for the same cables with EA = inf, where that changes places by less than the error allows and runs faster than the
        best.
    left_out : str, what Ctrl-C has left out, empty if nothing; errors that are not known are None then
    way : float or None [m] or [N], how far what the error is of moves, or changes, in what was simulated
    """

    scene: Scene
    best: Candidate
    runner_up: Candidate | None
    points: tuple[str, ...]
    t_end: float
    start: str
    error: float
    segments_error: float
    time_error: float
    checked_error: float | None
    elasticity: float | None
    fast_enough: bool
    rigid: Candidate | None = None
    tension: str | None = None
    left_out: str = ""
    way: float | None = None

    @property
    def note(self) -> str:
        """What to know of the motion that was simulated: that it has less in it than the error asked for; or nothing."""
        if self.way is None or self.way > self.error:
            return ""
        moves = "moves" if self.tension is None else "changes"
        return (
            f"what counts {moves} by {self.way:.2g} {self.unit} in {self.t_end:.4g} s from {self.start}, less than the error asked "
            "for, so that any step would do; give another start, or a time in which more happens"
        )

    @property
    def unit(self) -> str:
        """Of the errors, "m" or "N"."""
        return "m" if self.tension is None else "N"

    @property
    def of(self) -> str:
        """What the error is of, in words."""
        if self.tension is not None:
            return f"the tension at the ends of {printable(self.tension)}"
        return ", ".join(map(printable, self.points)) or "the middles of the cables"

    def __repr__(self) -> str:
        counts = sorted(set(self.segments.values()))
        segments = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
        error = "not checked" if self.checked_error is None else f"{self.checked_error:.2g} {self.unit}"
        return (
            f"<Recommendation: {segments} segments a cable, {self.best}, "
            f"error {error} (asked {self.error:g} {self.unit}), "
            f"{self.best.times_real_time:.4g} times real time>"
        )

    def __str__(self) -> str:
        unit = self.unit
        named = {"best": self.best, "runner-up": self.runner_up, "with EA = inf": self.rigid}
        lines = [
            f"{name}: {one}, error in time {one.error:.3g} {unit}, {one.times_real_time:.3g} times faster than real time"
            for name, one in named.items()
            if one
        ]
        checked = "" if self.checked_error is None else f", checked {self.checked_error:.3g} {unit}"
        return "\n".join(
            [
                *lines,
                "segments: " + ", ".join(f"{name} {count}" for name, count in self.segments.items()),
                f"error of {self.of}: asked {self.error:g} {unit}, of segments "
                f"{self.segments_error:.3g} {unit}, of time {self.time_error:.3g} {unit}{checked}",
                *([] if self.elasticity is None else [f"without stretch: {self.elasticity:.3g} {unit} away"]),
                *([f"stopped before {self.left_out}"] if self.left_out else []),
                *([self.note] if self.note else []),
                f"simulated for {self.t_end:.4g} s from {self.start}" + ("" if self.fast_enough else "; slower than was asked for"),
            ]
        )

    @property
    def segments(self) -> dict[str, int]:
        """Segments of each cable by name."""
        return {cable.name: cable.segments for cable in self.scene.cables}
