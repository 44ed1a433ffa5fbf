"""The short runs by which `recommend` finds segments, methods and steps whose error is within a share of what was asked for.

Both errors are of second order, of segments and of an implicit step, so that two pilots tell what is left of either:
q_N - q_2N = 3/4 of the error of q_N.
"""

import logging
import math
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, cast

import numpy as np

from anet_lumped.advice.recommendation import Candidate, RecommendError
from anet_lumped.checks import InputError
from anet_lumped.model.build import build
from anet_lumped.motion.choice import EXPLICIT_COST, SHARE_OF_LIMIT, SHARE_OF_TIME_SCALE, has_inner_states
from anet_lumped.motion.simulate import RunError, simulate
from anet_lumped.motion.stability import predict
from anet_lumped.scene.creep import WITHOUT_CREEP
from anet_lumped.scene.scene import Scene, SceneError
from anet_lumped.statics.equilibrium import EquilibriumError
from integrators import schemes

LOG = logging.getLogger(__name__)
SAVES, SAVES_OF_TENSION = 40, 160  # times at which places are compared, and tensions, which change sooner
SAVES_OF_ALL = 4000  # the most of them, where two swings are a small part of a motion
MOST_SEGMENTS = 3000  # of the longest cable
PATIENCE = 20.0  # times as long as the implicit step may an explicit method take before it is left out
ATTEMPTS = 5  # at meeting a share of the error
REPEATS = 3  # of a timing
CLOCK = time.perf_counter if sys.platform == "win32" else time.process_time  # that of Windows ticks every 16 ms
DOUBLED = 1.0 - 2.0**-2  # of the error is the difference to twice the segments or half the step


class Pilots:
    """Short runs of one scene with several segments, methods and steps, each run once; all have the same motion."""

    def __init__(
        self, scene: Scene, points: tuple[str, ...], t_end: float, start: str, scale: float, tension: str | None = None
    ) -> None:
        self.scene, self.points, self.t_end, self.start, self.tension = scene, points, t_end, start, tension
        self.unit, saves = ("m", SAVES) if tension is None else ("N", SAVES_OF_TENSION)
        late = 1.0 if not scene.events else max(1.0, t_end / (4.0 * math.pi * scale))  # two swings may come after a long calm
        self.save = t_end / min(math.ceil(saves * late), SAVES_OF_ALL)
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
                values = [halfway(run.shape(cable.name)) for cable in scene.cables]
            self.runs[key] = np.stack(values, axis=1)
        return self.runs[key]

    def apart(self, one: tuple[Scene, dict[str, Any]], other: tuple[Scene, dict[str, Any]]) -> float:
        """Largest distance between the places, or tensions, of two runs [m] or [N]."""
        apart = self.values(one[0], **one[1]) - self.values(other[0], **other[1])
        return float(np.linalg.norm(apart, axis=2).max())

    def way(self, count: int, best: Candidate) -> float:
        """Largest change of what the error is of in the motion, from its first value [m] or [N]."""
        values = self.values(self.divided(count), **best.stepping)
        return float(np.linalg.norm(values - values[0], axis=2).max())

    def segments(self, share: float) -> tuple[int, float]:
        """Number of segments whose error is within a share, and that error [m]."""
        count, stepping, within = 8, {"method": "edmc", "dt": self.step(0.5 * self.first_step)}, []
        for _ in range(2 * ATTEMPTS):
            scene = self.divided(count)
            error = self.apart((scene, stepping), (self.doubled(scene), stepping)) / DOUBLED
            enough = max(2, math.ceil(1.05 * count * math.sqrt(error / share)))
            if error <= share and enough > 0.8 * count:
                return count, error
            if error <= share:
                within.append((count, error))
            else:  # by a fifth at least: the corners of a plucked string make the error fall slower
                enough = max(enough, math.ceil(1.2 * count))
            if enough > MOST_SEGMENTS:
                raise RecommendError(
                    f"{share:.3g} {self.unit} of error would take {enough} segments in the finest cable, of which {MOST_SEGMENTS} "
                    "are the most that are tried; ask for a larger error or a shorter time."
                )
            count = enough
        if within:  # of errors that rise and fall with the number
            return min(within)
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
        options, within = {"extrapolate": True} if extrapolate else {}, []
        for _ in range(2 * ATTEMPTS):
            error = self.halves(scene, "edmc", dt, order, **options)
            enough = self.step(min(0.95 * dt * (share / error) ** (1.0 / order) if error > 0 else np.inf, self.save))
            if error <= share and enough < 1.2 * dt:
                return self.candidate(scene, "edmc", error, dt=dt, **options)
            within += [(dt, error)] if error <= share else []
            dt = enough if enough < dt or error <= share else 0.8 * dt
            if dt < least:
                return None
        if within:  # of errors that rise and fall with the step
            dt, error = max(within)
            return self.candidate(scene, "edmc", error, dt=dt, **options)
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


def halfway(q: np.ndarray) -> np.ndarray:
    """Places halfway along a cable, (k, 3) from (k, nodes, 3): a node, or between nodes on the cubic through the four beside it.

    A straight line would be off by an eighth of the curvature times the square of a segment, for odd numbers of segments alone.
    """
    a, b = (q.shape[1] - 1) // 2, q.shape[1] // 2
    middle = 0.5 * (q[:, a] + q[:, b])
    return middle if a == b or a == 0 else middle + (q[:, a] + q[:, b] - q[:, a - 1] - q[:, b + 1]) / 16.0
