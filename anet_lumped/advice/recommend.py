"""The cheapest segments, method and step that keep an error, by short pilots and a check by a finer run.

Both errors are of second order, of segments and of an implicit step, so that two pilots tell what is left of either:
q_N - q_2N = 3/4 of the error of q_N. Cost grows as segments over step, which is least where both take half of the error.
"""

import logging
import math
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from anet_lumped.checks import InputError, number, printable, quoted, shown
from anet_lumped.model.build import build
from anet_lumped.motion.choice import (
    EXPLICIT_COST,
    SHARE_OF_LIMIT,
    SHARE_OF_TIME_SCALE,
    has_inner_states,
    shedding_cable,
    time_scale,
)
from anet_lumped.motion.simulate import RunError, simulate
from anet_lumped.motion.stability import predict
from anet_lumped.motion.times import stops
from anet_lumped.results.state import State
from anet_lumped.scene.creep import WITHOUT_CREEP
from anet_lumped.scene.scene import Free, Scene, SceneError, check_scene
from anet_lumped.statics.equilibrium import EquilibriumError
from anet_lumped.statics.first_state import first_state
from integrators import schemes

LOG = logging.getLogger(__name__)
SAVES, SAVES_OF_TENSION = 40, 160  # times at which places are compared, and tensions, which change sooner
MOST_SEGMENTS = 3000  # of the longest cable
PATIENCE = 20.0  # times as long as the implicit step may an explicit method take before it is left out
ATTEMPTS = 5  # at meeting a share of the error, and at passing the check
REPEATS = 3  # of a timing
CLOCK = time.perf_counter if sys.platform == "win32" else time.process_time  # that of Windows ticks every 16 ms
DOUBLED = 1.0 - 2.0**-2  # of the error is the difference to twice the segments or half the step


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
                f"simulated for {self.t_end:.4g} s from {self.start}" + ("" if self.fast_enough else "; slower than was asked for"),
            ]
        )

    @property
    def segments(self) -> dict[str, int]:
        """Segments of each cable by name."""
        return {cable.name: cable.segments for cable in self.scene.cables}


def recommend(
    scene: Scene,
    error: float,
    *,
    at: str | None = None,
    tension: str | None = None,
    t_end: float | None = None,
    start: str = "equilibrium",
    realtime: float | None = None,
) -> Recommendation:
    """Find the cheapest segments, method and step for which places, or a tension, are within an error.

    Ctrl-C ends the search with what it has found, once there is a method that keeps its part of the error.

    Parameters
    ----------
    scene : Scene
        Of its segments only the proportion between the cables counts.
    error : float [m], or [N] with `tension`
        Largest distance of a free point from where the continuous cables of the scene would have it, at any time.
    at : str or None
        The free point that counts; None takes all, or the middles of the cables where there is none.
    tension : str or None
        The cable whose tensions at its ends count, in place of a place.
    t_end : float or None [s]
        How long to simulate; None takes two swings after the last corner of a driven path.
    start : "equilibrium", "calm" or "straight"
    realtime : float or None
        How many times faster than real time it must run.

    Returns
    -------
    Recommendation

    Raises
    ------
    RecommendError : the error is out of reach
    SceneError : no free point or cable of that name
    InputError : an argument out of its range; a scene without cables
    """
    check_scene(scene)
    if not scene.cables:
        raise InputError(
            "Segments are recommended for cables, but the scene has none; `simulate` with an `error` finds the step by itself."
        )
    for name, value in (("error", error), ("t_end", t_end), ("realtime", realtime)):
        if value is not None and not 0 < number(value) < math.inf:
            raise InputError(f"Argument `{name}` must be positive and finite, but it is {shown(value)}.")
    error, t_end, realtime = number(error), *(None if x is None else number(x) for x in (t_end, realtime))
    free = [point.name for point in scene.points if isinstance(point, Free)]
    if at is not None and not isinstance(scene.point(at), Free):
        raise SceneError(f"The error can be asked of a free point, but {quoted(at)} is held; free are {', '.join(free) or 'none'}.")
    if at is not None and tension is not None:
        raise InputError(f"Only one of `at` and `tension` may be given, but they are {quoted(at)} and {quoted(tension)}.")
    if tension is not None:
        scene.cable(tension)
    scale = scale_of_motion(scene, start)
    search = _Search(scene, tuple(free) if at is None else (at,), t_end or two_swings(scene, scale), start, scale, tension)
    share, found = 0.5 * error, None
    left_out = "other methods and the check by a finer run"
    try:
        for _ in range(ATTEMPTS):
            count, segments_error = search.segments(share)
            methods: list[Candidate] = []
            for one in search.candidates(count, share):
                methods = sorted([*methods, one], key=lambda c: -c.times_real_time)
                found = _as_far(search, count, segments_error, methods, error, realtime)
            assert found is not None  # the first method keeps its share, or there is an error
            checked = search.check(count, found.best)
            found = replace(found, checked_error=checked)
            if checked <= error:
                break
            share *= 0.7 * error / checked
        else:
            unit = search.unit
            raise RecommendError(f"An error of {error:g} {unit} was not reached: a finer run is still {checked:.3g} {unit} away.")
        left_out = "the same cables without stretch"
        elasticity, best = search.elasticity(count, found.best), found.best
        found = replace(found, elasticity=elasticity)
        if best.method != "links" and elasticity + checked <= error and shedding_cable(scene) is None:
            rigid = search.by_links(search.without_stretch(count), share)
            if rigid is not None and rigid.times_real_time > best.times_real_time:
                found = replace(found, rigid=rigid)
    except KeyboardInterrupt:
        if found is None:
            raise
        return replace(found, left_out=left_out)
    return found


def _as_far(
    search: "_Search", count: int, segments_error: float, methods: list[Candidate], error: float, realtime: float | None
) -> Recommendation:
    """What is known once some methods, the cheapest first, keep their part of the error."""
    best = methods[0]
    return Recommendation(
        scene=search.divided(count),
        best=best,
        runner_up=methods[1] if len(methods) > 1 else None,
        points=search.points,
        t_end=search.t_end,
        start=search.start,
        error=error,
        segments_error=segments_error,
        time_error=best.error,
        checked_error=None,
        elasticity=None,
        fast_enough=realtime is None or best.times_real_time >= realtime,
        tension=search.tension,
    )


def scale_of_motion(scene: Scene, start: str | State) -> float:
    """Time in which a motion changes that starts so, with the tension that its cables have there [s]."""
    rests = isinstance(start, State) or start in ("equilibrium", "calm")
    return time_scale(scene, first_state(scene, start).least_tension if rests else 0.0)


def two_swings(scene: Scene, scale: float) -> float:
    """Time of two swings after the last corner of a driven path [s]."""
    return float(max(stops(scene).max(initial=0.0), 0.0) + 4.0 * math.pi * scale)


def _halfway(q: np.ndarray) -> np.ndarray:
    """Places halfway along a cable, (k, 3) from (k, nodes, 3): a node, or between nodes on the cubic through the four beside it.

    A straight line would be off by an eighth of the curvature times the square of a segment, for odd numbers of segments alone.
    """
    a, b = (q.shape[1] - 1) // 2, q.shape[1] // 2
    middle = 0.5 * (q[:, a] + q[:, b])
    return middle if a == b or a == 0 else middle + (q[:, a] + q[:, b] - q[:, a - 1] - q[:, b + 1]) / 16.0


class _Search:
    """Pilots of one scene, each run once."""

    def __init__(
        self, scene: Scene, points: tuple[str, ...], t_end: float, start: str, scale: float, tension: str | None = None
    ) -> None:
        self.scene, self.points, self.t_end, self.start, self.tension = scene, points, t_end, start, tension
        self.unit, self.save = ("m", t_end / SAVES) if tension is None else ("N", t_end / SAVES_OF_TENSION)
        most = max(cable.segments for cable in scene.cables)
        self.shares = [cable.segments / most for cable in scene.cables]
        self.first_step = SHARE_OF_TIME_SCALE * scale
        self.runs: dict[Any, np.ndarray] = {}

    def divided(self, count: int) -> Scene:
        """The scene with that many segments in its finest cable."""
        cables = [replace(c, segments=max(1, round(count * s))) for c, s in zip(self.scene.cables, self.shares, strict=True)]
        return replace(self.scene, cables=tuple(cables))

    def doubled(self, scene: Scene) -> Scene:
        """The scene with twice the segments in every cable."""
        return replace(scene, cables=tuple(replace(cable, segments=2 * cable.segments) for cable in scene.cables))

    def step(self, dt: float) -> float:
        """The largest step up to dt that ends on what is saved."""
        return self.save / math.ceil(self.save / dt - 1e-9)

    def values(self, scene: Scene, **stepping: Any) -> np.ndarray:
        """(k, points, 3) places of the points that count [m], or (k, 2, 1) tensions at the ends of the cable that does [N]."""
        key = scene, tuple(stepping.items())
        if key not in self.runs:
            sizes = ", ".join(
                f"{name} {value:.3g}" if isinstance(value, float) else name if value is True else f"{value}"
                for name, value in stepping.items()
            )
            most = max(cable.segments for cable in scene.cables)
            LOG.info(
                "pilot %d: %g s of motion with %d segments in the finest cable, %s", len(self.runs) + 1, self.t_end, most, sizes
            )
            run = simulate(scene, self.t_end, start=self.start, save_every=self.save, check=True, **stepping)
            if self.tension is not None:
                cable = scene.cable(self.tension)
                values = [run.end_tension(cable.name, end)[:, None] for end in (cable.start, cable.end)]
            elif self.points:
                values = [run.position(point) for point in self.points]
            else:
                values = [_halfway(run.shape(cable.name)) for cable in scene.cables]
            self.runs[key] = np.stack(values, axis=1)
        return self.runs[key]

    def apart(self, one: tuple[Scene, dict[str, Any]], other: tuple[Scene, dict[str, Any]]) -> float:
        """Largest distance between the places, or tensions, of two runs [m] or [N]."""
        apart = self.values(one[0], **one[1]) - self.values(other[0], **other[1])
        return float(np.linalg.norm(apart, axis=2).max())

    def segments(self, share: float) -> tuple[int, float]:
        """Number of segments whose error is within a share, and that error [m]."""
        count, stepping = 8, {"method": "edmc", "dt": self.step(0.5 * self.first_step)}
        for _ in range(ATTEMPTS):
            scene = self.divided(count)
            error = self.apart((scene, stepping), (self.doubled(scene), stepping)) / DOUBLED
            enough = max(2, math.ceil(1.05 * count * math.sqrt(error / share)))
            if error <= share and enough > 0.8 * count:
                return count, error
            if enough > MOST_SEGMENTS:
                raise RecommendError(
                    f"{share:.3g} {self.unit} of error would take {enough} segments in the finest cable, of which {MOST_SEGMENTS} "
                    "are the most that are tried; ask for a larger error or a shorter time."
                )
            count = enough
        raise RecommendError(f"The error does not fall as the square of the segments: {error:.3g} {self.unit} at {count} of them.")

    def candidates(self, count: int, share: float) -> Iterator[Candidate]:
        """Methods that keep a share of the error."""
        yield from (one for one in self._methods(self.divided(count), share) if one and one.error <= share)

    def _methods(self, scene: Scene, share: float) -> Iterator[Candidate | None]:
        plain = cast(Candidate, self.fixed(scene, share))  # None is for extrapolation alone
        inner = has_inner_states(scene)  # which edmc alone carries, at fixed steps
        yield plain
        yield None if inner else self.adaptive(scene, share)
        if all(cable.breaking_tension is None for cable in scene.cables):
            yield self.fixed(scene, share, extrapolate=True, least=cast(float, plain.dt))
        if not inner and all(cable.inextensible for cable in scene.cables):
            yield self.by_links(scene, share)
        if not inner and not any(cable.inextensible for cable in scene.cables):
            limit = predict(scene, schemes=("verlet",)).limits["verlet"].step
            dt, implicit = self.step(SHARE_OF_LIMIT * limit), self.t_end / plain.times_real_time
            if EXPLICIT_COST * build(scene).n * self.t_end / dt < PATIENCE * implicit:
                yield self.candidate(scene, "verlet", self.halves(scene, "verlet", dt), dt=dt)

    def halves(self, scene: Scene, method: str, dt: float, order: int = 2, **options: Any) -> float:
        """Error of a step of a method [m]."""
        coarse, fine = ({"method": method, "dt": step} | options for step in (dt, 0.5 * dt))
        return self.apart((scene, coarse), (scene, fine)) / (1.0 - 2.0**-order)

    def fixed(self, scene: Scene, share: float, extrapolate: bool = False, least: float = 0.0) -> Candidate | None:
        """The largest step of edmc whose error is within a share; None if extrapolation needs shorter ones than ``least`` [s]."""
        dt, edmc = self.step(self.first_step), schemes.scheme("edmc")
        order = cast(int, edmc.extrapolated_order if extrapolate else edmc.order)
        options = {"extrapolate": True} if extrapolate else {}
        for _ in range(2 * ATTEMPTS):
            error = self.halves(scene, "edmc", dt, order, **options)
            enough = self.step(min(0.95 * dt * (share / error) ** (1.0 / order) if error > 0 else np.inf, self.save))
            if error <= share and enough < 1.2 * dt:
                return self.candidate(scene, "edmc", error, dt=dt, **options)
            dt = enough if enough < dt or error <= share else 0.8 * dt
            if dt < least:
                return None
        if extrapolate:
            return None
        raise RecommendError(f"The error does not fall as the square of the step: {error:.3g} {self.unit} at {dt:.3g} s.")

    def adaptive(self, scene: Scene, share: float) -> Candidate | None:
        """The largest tolerance of adaptive edmc whose error is within a share, or None."""
        rtol = 1e-4
        for _ in range(ATTEMPTS):
            error = self.apart((scene, {"method": "edmc", "rtol": rtol}), (scene, {"method": "edmc", "rtol": 0.1 * rtol}))
            if error <= share:
                return self.candidate(scene, "edmc", error, rtol=rtol)
            rtol *= 0.8 * (share / error) ** 1.5  # an error in a step of h^3 makes a whole error of rtol^(2/3)
        return None

    def by_links(self, scene: Scene, share: float) -> Candidate | None:
        """The largest tolerance of links whose error is within a share, or None."""
        rtol = 1e-3
        for _ in range(ATTEMPTS):
            try:
                error = self.apart((scene, {"method": "links", "rtol": rtol}), (scene, {"method": "links", "rtol": 0.1 * rtol}))
            except (RunError, EquilibriumError, SceneError, InputError):
                return None
            if error <= share:
                return self.candidate(scene, "links", error, rtol=rtol)
            rtol *= max(0.5 * share / error, 1e-3)
        return None

    def candidate(
        self, scene: Scene, method: str, error: float, dt: float | None = None, rtol: float | None = None, extrapolate: bool = False
    ) -> Candidate:
        """A method with its pace."""
        one = Candidate(method, dt, rtol, error, np.inf, extrapolate)
        took = []
        for _ in range(REPEATS):
            began = CLOCK()
            simulate(scene, self.t_end, start=self.start, save_every=self.save, **one.stepping)
            took.append(CLOCK() - began)
        return replace(one, times_real_time=self.t_end / min(took))  # what else the machine does only adds

    def check(self, count: int, best: Candidate) -> float:
        """Distance of the recommended run from one with twice the segments and half the step, over what that leaves [m]."""
        scene = self.divided(count)
        finer = best.stepping | ({"dt": 0.5 * cast(float, best.dt)} if best.rtol is None else {"rtol": 0.1 * best.rtol})
        if best.method == "verlet":
            finer["dt"] *= 0.5  # twice the segments halve its limit
        return self.apart((scene, best.stepping), (self.doubled(scene), finer)) / DOUBLED

    def without_stretch(self, count: int) -> Scene:
        """The scene with that many segments in its finest cable, all with EA = inf."""
        scene = self.divided(count)
        return replace(
            scene,
            cables=tuple(replace(cable, EA=math.inf, tension_strain=None, **WITHOUT_CREEP) for cable in scene.cables),
        )

    def elasticity(self, count: int, best: Candidate) -> float:
        """What stretching changes [m]: the same net with EA = inf; infinite if its cables are too short for that."""
        scene, rigid = self.divided(count), self.without_stretch(count)
        stepping = {"method": "edmc", "dt": best.dt if best.method == "edmc" and best.dt else self.step(0.5 * self.first_step)}
        try:
            return self.apart((scene, stepping), (rigid, stepping))
        except (RunError, EquilibriumError, SceneError):
            return math.inf
