"""What a sweep measures: each entry of MEASURES is one number (or word) of a state at rest or of a run.

A measure is asked for by name, or by name and target: `stretch` is the largest over all cables, `stretch:s0-p0` that of
one cable, `height:p0` that of a point; `module:function` is a function of a user's own (`own_measure`). To add one, add an entry of
MEASURES whose function is defined in a module; nothing else knows measures by name.
"""

from collections.abc import Callable
from enum import StrEnum
from functools import partial
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import InputError, nearest
from anet_lumped.results.end_forces import GROUND
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.results.sag import sag
from anet_lumped.scene.scene import Free, Scene
from studies.sweeping import over_time
from studies.sweeping.own_measure import own_measure


class MeasureError(InputError):
    """A measure that does not exist, or a target that it cannot have."""


class Source(StrEnum):
    """What a measure is taken from."""

    REST = "rest"
    RUN = "run"


class Target(StrEnum):
    """What a measure may be taken of; of all cables where it may be a cable and none is given."""

    NONE = ""
    CABLE = "cable"
    CABLE_OR_POINT = "cable or point"
    POINT = "point"
    HOLDER = "support"


OF_CABLES = (Target.CABLE, Target.CABLE_OR_POINT)  # what a scene without cables has no measure of


class Measure(NamedTuple):
    """One number or word of a sweep's table.

    Parameters
    ----------
    function : of the state at rest or of the run, of the target's name (None for all cables) unless there is no target, and of the
        time [s] from which on it looks (None for all) if it is one over time
    source : Source
    target : Target
    unit : str, "-" for a number without one
    about : str, what it is
    over_time : bool, whether it may look at a run from a time on
    of_ground : bool, whether the scene must have a ground
    """

    function: Callable
    source: Source
    target: Target
    unit: str
    about: str
    over_time: bool = False
    of_ground: bool = False


def read_measure(text: str, scene: Scene, runs: bool = False) -> tuple[Measure, tuple]:
    """Measure that `text` ("name", "name:target" or "module:function") asks for, and its arguments after the state or run.

    Parameters
    ----------
    text : str
    scene : Scene
    runs : whether there is a run, which a function of one's own is given then; else it is given the state at rest

    Raises
    ------
    MeasureError : unknown measure, missing or unknown target; names the nearest known one
    OwnMeasureError : a module that does not import, or has no such function
    """
    name, colon, target = text.partition(":")
    if name not in MEASURES:
        own = own_measure(text)
        if own is not None:
            return Measure(own, Source.RUN if runs else Source.REST, Target.NONE, "", "a function of one's own"), ()
        known = nearest(name, MEASURES, quote="`") or f"; known are {', '.join(MEASURES)}."
        neither = "neither a measure nor, here or where Python looks, a module" if colon and target.isidentifier() else "no measure"
        raise MeasureError(f"There is {neither} called `{name}`{known}")
    measure = MEASURES[name]
    if measure.of_ground and not any(effect.is_ground for effect in scene.effects):
        raise MeasureError(f"The measure `{name}` is of what lies on the ground, but this scene has no ground.")
    cables, points = [cable.name for cable in scene.cables], [point.name for point in scene.points]
    if not cables and measure.target in OF_CABLES:
        raise MeasureError(f"The measure `{name}` is of cables, but this scene has none.")
    bodies = [body.name for body in scene.bodies]
    holders = [point.name for point in scene.all_points if not isinstance(point, Free)]
    holders += [GROUND] if any(effect.is_ground for effect in scene.effects) else []
    allowed = {
        Target.NONE: [], Target.CABLE: cables, Target.CABLE_OR_POINT: cables + points,
        Target.POINT: points + bodies, Target.HOLDER: holders,
    }[measure.target]  # fmt: skip
    if colon and measure.target == Target.NONE:
        raise MeasureError(f"The measure `{name}` takes no target, but `{text}` was given.")
    if target not in allowed and (colon or measure.target in (Target.POINT, Target.HOLDER)):
        known = (
            f"one of {', '.join(allowed)}, as in {name}:{allowed[-1]}"
            if allowed
            else f"a {measure.target}, and this scene has none"
        )
        raise MeasureError(f"The target of measure `{name}` must be {known}, but `{text}` was given.")
    return measure, (target or None,) if measure.target else ()


def _cables(result, target):
    return [cable for cable in result.scene.cables if target in (None, cable.name)]


def _stretch(result, target):
    return max(np.max(result.stretch(cable.name)) for cable in _cables(result, target))


def _end_stretch(run, target):
    return max(run.stretch(cable.name)[-1] for cable in _cables(run, target))


def _touchdown(state, target):
    return max(state.touchdown_length(cable.name) for cable in _cables(state, target))


def _tension(result, target):
    ends = [
        np.max(result.end_tension(cable.name, target))
        for cable in result.scene.cables
        for point in (cable.start, cable.end)
        if point == target
    ]
    return max(ends or [result.tension(cable.name).max() for cable in _cables(result, target)])


def _reaction(result, target):
    return float(np.linalg.norm(result.reaction(target), axis=-1).max())


def _slack(state, target):
    return sum(np.count_nonzero(state.tension(cable.name) <= 0.0) for cable in _cables(state, target))


def _sag(state, target):
    return max(sag(state, cable.name) for cable in _cables(state, target))


def _shape_error(state, target):
    from anet_lumped.advice.compare import compare

    return max(cable.rmse for cable in compare(state).cables if target in (None, cable.cable))


def _coordinate(result, target, axis):
    return np.atleast_1d(result.position(target)[..., axis])[-1]


def _energy_rise(run):
    energy = run.energy[:, :3].sum(axis=1) - run.energy[:, 3]
    return energy.max() - energy[0]


def _newton_per_step(run):
    return run.work.newton_iterations / max(run.work.steps, 1)


def _speed(run):
    return (run.t[-1] - run.t[0]) / run.wall_time


def _reached(run):
    return run.t[-1]


_x, _y, _z = (partial(_coordinate, axis=axis) for axis in range(3))


def _peak(of_result):
    return partial(_of_window, of_result=of_result)


def _of_window(run, target, since, of_result):
    return of_result(over_time.window(run, since), target)


def _over_time(function, target, unit, about, of_ground=False):
    return Measure(function, Source.RUN, target, unit, about, over_time=True, of_ground=of_ground)


def _statistics():
    """Measures called `mean_tension`, `range_height`, ...: each statistic of each quantity."""
    statistics = {
        "least": (over_time.least, "least {} at a saved time"),
        "peak": (over_time.largest, "largest {} at a saved time"),
        "mean": (over_time.mean, "mean of the {} over time"),
        "deviation": (over_time.deviation, "standard deviation of the {} over time"),
        "range": (over_time.spread, "largest less least {}"),
    }
    quantities = {
        "tension": (over_time.tension, Target.CABLE_OR_POINT, "N", "tension"),
        **{
            name: (partial(over_time.coordinate, axis=axis), Target.POINT, "m", f"{'xyz'[axis]} of a point")
            for name, axis in over_time.AXES.items()
        },
        "touchdown": (over_time.touchdown, Target.CABLE, "m", "length on the ground"),
    }
    return {
        f"{name}_{quantity}": _over_time(
            partial(over_time.statistic, values=values, of=of), target, unit, about.format(what), of_ground=quantity == "touchdown"
        )
        for quantity, (values, target, unit, what) in quantities.items()
        for name, (of, about) in statistics.items()
    }


MEASURES = {
    "stretch": Measure(_stretch, Source.REST, Target.CABLE, "-", "stretched length / length at rest - 1, at rest"),
    "sag": Measure(_sag, Source.REST, Target.CABLE, "m", "largest distance below the chord, along gravity, at rest"),
    "tension": Measure(
        _tension, Source.REST, Target.CABLE_OR_POINT, "N", "largest tension at rest: of segments; at a point, of ends of cables"
    ),
    "reaction": Measure(_reaction, Source.REST, Target.HOLDER, "N", "size of the force of a support or the ground at rest"),
    "slack": Measure(_slack, Source.REST, Target.CABLE, "-", "number of slack segments at rest"),
    "stable": Measure(attrgetter("stable"), Source.REST, Target.NONE, "", "whether no direction leads down from the rest"),
    "shape_error": Measure(_shape_error, Source.REST, Target.CABLE, "m", "RMS distance from the elastic catenary at rest"),
    "x": Measure(_x, Source.REST, Target.POINT, "m", "x of a point at rest"),
    "y": Measure(_y, Source.REST, Target.POINT, "m", "y of a point at rest"),
    "height": Measure(_z, Source.REST, Target.POINT, "m", "z of a point at rest"),
    "touchdown": Measure(
        _touchdown, Source.REST, Target.CABLE, "m", "length on the ground at rest, to half a segment", of_ground=True
    ),
    "end_stretch": Measure(_end_stretch, Source.RUN, Target.CABLE, "-", "stretched length / length at rest - 1, at the end"),
    "peak_stretch": _over_time(_peak(_stretch), Target.CABLE, "-", "largest stretched length / length at rest - 1"),
    **_statistics(),
    "peak_tension": _over_time(
        over_time.peak_tension,
        Target.CABLE_OR_POINT,
        "N",
        "largest tension of segments in all steps; at a point, of ends at a saved time",
    ),
    "rainflow_tension": _over_time(
        partial(over_time.statistic, values=over_time.tension, of=over_time.rainflow),
        Target.CABLE_OR_POINT,
        "N",
        "largest range of a rainflow cycle of the tension",
    ),
    "equivalent_tension": _over_time(
        partial(over_time.statistic, values=over_time.tension, of=over_time.equivalent),
        Target.CABLE_OR_POINT,
        "N",
        "range of the tension that does the same damage at 1 Hz, exponent 3",
    ),
    "peak_reaction": _over_time(_peak(_reaction), Target.HOLDER, "N", "largest force of a support or the ground at a saved time"),
    "peak_displacement": _over_time(over_time.displacement, Target.POINT, "m", "largest distance of a point from where it started"),
    "slack_time": _over_time(over_time.slack_time, Target.CABLE, "s", "time for which a segment of a cable was slack"),
    "snaps": _over_time(over_time.snaps, Target.CABLE, "-", "times that a slack cable was taut again with a peak"),
    "end_x": Measure(_x, Source.RUN, Target.POINT, "m", "x of a point at the end"),
    "end_y": Measure(_y, Source.RUN, Target.POINT, "m", "y of a point at the end"),
    "end_height": Measure(_z, Source.RUN, Target.POINT, "m", "z of a point at the end"),
    "energy_rise": Measure(_energy_rise, Source.RUN, Target.NONE, "J", "largest rise of the energy beyond the work done"),
    "imbalance": Measure(error_of_steps, Source.RUN, Target.NONE, "-", "relative imbalance of the energy"),
    "error_estimate": Measure(attrgetter("error_estimate"), Source.RUN, Target.NONE, "m", "error that the scheme estimates"),
    "steps": Measure(attrgetter("work.steps"), Source.RUN, Target.NONE, "-", "steps taken"),
    "rejected": Measure(attrgetter("work.rejected"), Source.RUN, Target.NONE, "-", "steps rejected by the error control"),
    "halvings": Measure(attrgetter("work.halvings"), Source.RUN, Target.NONE, "-", "steps halved because Newton failed"),
    "force_evaluations": Measure(attrgetter("work.force_evaluations"), Source.RUN, Target.NONE, "-", "evaluations of the force"),
    "newton_iterations": Measure(attrgetter("work.newton_iterations"), Source.RUN, Target.NONE, "-", "Newton iterations"),
    "newton_per_step": Measure(_newton_per_step, Source.RUN, Target.NONE, "-", "Newton iterations a step"),
    "factorisations": Measure(attrgetter("work.factorisations"), Source.RUN, Target.NONE, "-", "factorisations"),
    "method_used": Measure(attrgetter("method"), Source.RUN, Target.NONE, "", "the method, for runs that choose their own"),
    "step_used": Measure(attrgetter("dt"), Source.RUN, Target.NONE, "s", "the step, for runs that choose their own"),
    "end_time": Measure(_reached, Source.RUN, Target.NONE, "s", "time reached"),
    "wall_time": Measure(attrgetter("wall_time"), Source.RUN, Target.NONE, "s", "time that the run took"),
    "speed": Measure(_speed, Source.RUN, Target.NONE, "-", "simulated time / time that the run took"),
}
