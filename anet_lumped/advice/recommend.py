"""The cheapest segments, method and step that keep an error, by short pilots and a check by a finer run.

Cost grows as segments over step, which is least where both take half of the error, for both errors are of second order.
"""

import math
from dataclasses import replace

from anet_lumped.advice.pilots import Pilots
from anet_lumped.advice.recommendation import Candidate, Recommendation, RecommendError
from anet_lumped.checks import InputError, number, quoted, shown
from anet_lumped.motion.choice import shedding_cable, time_scale
from anet_lumped.motion.times import stops
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Free, Scene, SceneError, check_scene
from anet_lumped.statics.first_state import first_state

ATTEMPTS = 5  # at passing the check


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
        How long to simulate; None takes two swings after the last corner of a driven path and the last event.
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
    pilots = Pilots(scene, tuple(free) if at is None else (at,), t_end or two_swings(scene, scale), start, scale, tension)
    share, found = 0.5 * error, None
    left_out = "other methods and the check by a finer run"
    try:
        for _ in range(ATTEMPTS):
            count, segments_error = pilots.segments(share)
            methods: list[Candidate] = []
            for one in pilots.candidates(count, share):
                methods = sorted([*methods, one], key=lambda c: -c.times_real_time)
                found = _as_far(pilots, count, segments_error, methods, error, realtime)
            assert found is not None  # the first method keeps its share, or there is an error
            checked = pilots.check(count, found.best)
            found = replace(found, checked_error=checked, way=pilots.way(count, found.best))
            if checked <= error:
                break
            share *= 0.7 * error / checked
        else:
            unit = pilots.unit
            raise RecommendError(f"An error of {error:g} {unit} was not reached: a finer run is still {checked:.3g} {unit} away.")
        left_out = "the same cables without stretch"
        elasticity, best = pilots.elasticity(count, found.best), found.best
        found = replace(found, elasticity=elasticity)
        if best.method != "links" and elasticity + checked <= error and shedding_cable(scene) is None:
            rigid = pilots.by_links(pilots.without_stretch(count), share)
            if rigid is not None and rigid.times_real_time > best.times_real_time:
                found = replace(found, rigid=rigid)
    except KeyboardInterrupt:
        if found is None:
            raise
        return replace(found, left_out=left_out)
    return found


def _as_far(
    pilots: Pilots, count: int, segments_error: float, methods: list[Candidate], error: float, realtime: float | None
) -> Recommendation:
    """What is known once some methods, the cheapest first, keep their part of the error."""
    best = methods[0]
    return Recommendation(
        scene=pilots.divided(count),
        best=best,
        runner_up=methods[1] if len(methods) > 1 else None,
        points=pilots.points,
        t_end=pilots.t_end,
        start=pilots.start,
        error=error,
        segments_error=segments_error,
        time_error=best.error,
        checked_error=None,
        elasticity=None,
        fast_enough=realtime is None or best.times_real_time >= realtime,
        tension=pilots.tension,
    )


def scale_of_motion(scene: Scene, start: str | State) -> float:
    """Time in which a motion changes that starts so, with the tension that its cables have there [s]."""
    rests = isinstance(start, State) or start in ("equilibrium", "calm")
    return time_scale(scene, first_state(scene, start).least_tension if rests else 0.0)


def two_swings(scene: Scene, scale: float) -> float:
    """Time of two swings after the last corner of a driven path, and the last event that has a time [s]."""
    begins = [float(stops(scene).max(initial=0.0)), *(event.t for event in scene.events if event.t is not None)]
    return max(*begins, 0.0) + 4.0 * math.pi * scale
