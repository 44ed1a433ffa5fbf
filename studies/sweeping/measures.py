"""What a sweep measures: each entry of MEASURES is one number (or word) taken from a state at rest or from a run.

A measure is asked for by name, or by name and target: `stretch` is the largest over all cables, `stretch:s0-p0` that of
one cable, `height:p0` that of a point. To add one, add an entry whose function is defined in a module.
"""

from collections.abc import Callable
from functools import partial
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import nearest
from anet_lumped.scene.scene import Scene


class MeasureError(ValueError):
    """A measure that does not exist, or a target that it cannot have."""


class Measure(NamedTuple):
    """A function of the state at rest or of the run (`of`), and of a target unless `target` is "".

    `target` says what the target may be: "cable" or "cable or point", all cables if none is given, or "point".
    """

    function: Callable
    of: str
    target: str
    unit: str
    about: str


def read_measure(text: str, scene: Scene) -> tuple[Measure, tuple]:
    """Measure that `text` ("name" or "name:target") asks for, and the arguments behind its state or run.

    Raises
    ------
    MeasureError : unknown measure, missing or unknown target; names the nearest known one
    """
    name, colon, target = text.partition(":")
    if name not in MEASURES:
        known = nearest(name, MEASURES, quote="`") or f"; known are {', '.join(MEASURES)}."
        raise MeasureError(f"There is no measure called `{name}`{known}")
    measure = MEASURES[name]
    cables, points = [cable.name for cable in scene.cables], [point.name for point in scene.points]
    allowed = {"": [], "cable": cables, "cable or point": cables + points, "point": points}[measure.target]
    if colon and not allowed:
        raise MeasureError(f"The measure `{name}` takes no target, but `{text}` was given.")
    if target not in allowed and (colon or measure.target == "point"):
        known = f"one of {', '.join(allowed)}, as in {name}:{allowed[-1]}"
        raise MeasureError(f"The target of measure `{name}` must be {known}, but `{text}` was given.")
    return measure, (target or None,) if measure.target else ()


def _cables(x, target):
    return [cable for cable in x.scene.cables if target in (None, cable.name)]


def _stretch(x, target, of=max):
    return max(of(np.atleast_1d(x.length(cable.name))) / cable.length - 1.0 for cable in _cables(x, target))


def _last(values):
    return values[-1]


def _tension(x, target):
    ends = [
        x.tension(cable.name)[..., index].max()
        for cable in x.scene.cables
        for point, index in ((cable.start, 0), (cable.end, -1))
        if point == target
    ]
    return max(ends or [x.tension(cable.name).max() for cable in _cables(x, target)])


def _slack(state, target):
    return sum(np.count_nonzero(state.tension(cable.name) <= 0.0) for cable in _cables(state, target))


def sag(state, cable: str) -> float:
    """Largest distance of a cable's nodes below its chord, along gravity [m]; NaN where nothing weighs."""
    from anet_lumped.advice.compare import below_chord

    gravity, shape = state.scene.gravity, state.shape(cable)
    weight = np.linalg.norm(gravity)
    return float(below_chord(shape, shape[0], shape[-1], -gravity / weight).max()) if weight else np.nan


def _sag(state, target):
    return max(sag(state, cable.name) for cable in _cables(state, target))


def _shape_error(state, target):
    from anet_lumped.advice.compare import compare

    return max(cable.rmse for cable in compare(state).cables if target in (None, cable.cable))


def _coordinate(x, target, axis):
    return np.atleast_1d(x.position(target)[..., axis])[-1]


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

MEASURES = {
    "stretch": Measure(_stretch, "rest", "cable", "-", "stretched length / length - 1 at rest"),
    "sag": Measure(_sag, "rest", "cable", "m", "largest distance below the chord, along gravity, at rest"),
    "tension": Measure(_tension, "rest", "cable or point", "N", "largest tension at rest, in a cable or at a point"),
    "slack": Measure(_slack, "rest", "cable", "-", "number of slack segments at rest"),
    "shape_error": Measure(_shape_error, "rest", "cable", "m", "RMSE of the nodes against the elastic catenary"),
    "x": Measure(_x, "rest", "point", "m", "x of a point at rest"),
    "y": Measure(_y, "rest", "point", "m", "y of a point at rest"),
    "height": Measure(_z, "rest", "point", "m", "z of a point at rest"),
    "end_stretch": Measure(partial(_stretch, of=_last), "run", "cable", "-", "the same at the end of the run"),
    "peak_stretch": Measure(_stretch, "run", "cable", "-", "the same, largest at a saved time"),
    "peak_tension": Measure(_tension, "run", "cable or point", "N", "largest tension at a saved time"),
    "end_x": Measure(_x, "run", "point", "m", "x of a point at the end"),
    "end_y": Measure(_y, "run", "point", "m", "y of a point at the end"),
    "end_height": Measure(_z, "run", "point", "m", "z of a point at the end"),
    "energy_rise": Measure(_energy_rise, "run", "", "J", "largest rise of the energy beyond the work done"),
    "imbalance": Measure(attrgetter("energy_balance.imbalance"), "run", "", "-", "relative imbalance of the energy"),
    "error_estimate": Measure(attrgetter("error_estimate"), "run", "", "m", "error that the scheme estimates"),
    "steps": Measure(attrgetter("work.steps"), "run", "", "-", "steps taken"),
    "rejected": Measure(attrgetter("work.rejected"), "run", "", "-", "steps rejected by the error control"),
    "halvings": Measure(attrgetter("work.halvings"), "run", "", "-", "steps halved because Newton failed"),
    "force_evaluations": Measure(attrgetter("work.force_evaluations"), "run", "", "-", "evaluations of the force"),
    "newton_iterations": Measure(attrgetter("work.newton_iterations"), "run", "", "-", "Newton iterations"),
    "newton_per_step": Measure(_newton_per_step, "run", "", "-", "Newton iterations a step"),
    "factorisations": Measure(attrgetter("work.factorisations"), "run", "", "-", "factorisations"),
    "method_used": Measure(attrgetter("method"), "run", "", "", "the method, for runs that choose their own"),
    "step_used": Measure(attrgetter("dt"), "run", "", "s", "the step, for runs that choose their own"),
    "end_time": Measure(_reached, "run", "", "s", "time reached"),
    "wall_time": Measure(attrgetter("wall_time"), "run", "", "s", "time that the run took"),
    "speed": Measure(_speed, "run", "", "-", "simulated time / time that the run took"),
}
