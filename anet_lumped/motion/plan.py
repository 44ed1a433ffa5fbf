"""What a run is to be: arguments that can be, a method that can move the scene, its step, and the times at which it saves."""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import SMALLEST, InputError, number, quoted, shown
from anet_lumped.model import rest_lengths
from anet_lumped.model.reach import off_length
from anet_lumped.model.remainder import lightest
from anet_lumped.results.events import broken_at, released
from anet_lumped.results.state import State
from anet_lumped.scene.origin import largest_distance
from anet_lumped.scene.scene import Driven, Scene
from integrators import schemes
from integrators.schemes.record import Scheme

from .choice import LONGEST_CHOSEN, Choice, check_method, choose
from .stability import transverse_frequency
from .times import check_counts

CLOSE = 1e-6  # of the longest cable: by how much a point that is held may start away from its holder


class Asked(NamedTuple):
    """What a run is asked for, in numbers that `check_arguments` has seen: arguments of `simulate`."""

    t_end: float
    method: str | None
    dt: float | None
    save_every: float | None
    rtol: float | None
    atol: float | None
    extrapolate: bool = False


class Plan(NamedTuple):
    """How a run is marched.

    Parameters
    ----------
    choice : Choice
    adaptive : bool, whether its steps are chosen by a tolerance
    transverse : float [rad/s], of the fastest transverse vibration at the start, where cables do not stretch; else 0
    """

    choice: Choice
    adaptive: bool
    transverse: float


def planned(scene: Scene, begin: State, asked: Asked) -> Plan:
    """Method, step and times of a run.

    Parameters
    ----------
    scene : Scene
    begin : State, that the run starts from
    asked : Asked

    Returns
    -------
    Plan

    Raises
    ------
    InputError : what is asked for cannot be of this scene
    """
    t_end, method, dt, save_every, rtol, atol, extrapolate = asked
    scheme = None if method is None else schemes.scheme(method)
    check_start(scene, begin)
    adaptive = rtol is not None or atol is not None or (scheme is not None and scheme.chooses_steps(dt))
    if scheme is not None and not scheme.takes_changing_rest_lengths and rest_lengths.changes(scene):
        able = ", ".join(schemes.names(takes_changing_rest_lengths=True))
        raise InputError(f"Lengths that change in time need a method of this package, {able}, but the method is {method}.")
    if scheme is not None and not scheme.takes_rigid_bodies and begin.model.has_bodies:
        able = ", ".join(schemes.names(takes_rigid_bodies=True))
        raise InputError(f"Bodies that move need one of the methods {able}, but the method is {method}.")
    if scheme is not None and not scheme.own and begin.model.n_free == 0:
        raise InputError(
            f"Solvers of other packages need a node that moves freely, but the scene has none and the method is {method}."
        )
    lightest_scene = lightest(rest_lengths.at_shortest(scene, begin.t, begin.t + t_end))
    transverse = transverse_frequency(begin) if any(cable.inextensible for cable in scene.cables) else 0.0  # of links alone
    speed = float(np.ptp(begin.v, axis=0).max())
    choice = choose(lightest_scene, method, dt, adaptive, begin.least_tension, transverse, speed)
    scheme = schemes.scheme(choice.method)
    _check_breaks(scene, scheme, extrapolate)
    if adaptive:
        longest = LONGEST_CHOSEN * choice.dt if dt is None else None
    else:
        longest = choice.dt if dt is not None or save_every is None else min(choice.dt, save_every)
    check_counts(scene, begin.t, begin.t + t_end, longest, save_every, adaptive)
    if dt is None and not adaptive:
        span = save_every or t_end
        choice = _ending_on(choice, span, "t_end" if save_every is None else "save_every")
    return Plan(choice, adaptive, transverse)


def check_start(scene: Scene, begin: State) -> None:
    """Refuse a start whose nodes are too far from each other, or which is not one of what is held, driven or does not stretch."""
    _check_external(scene, begin)
    _check_held(scene, begin)
    check_lengths(scene, begin)
    most, places = largest_distance(scene), begin.q.ravel()
    if 2.0 * math.sqrt(float(places @ places)) < 0.9 * most:
        return  # the farthest from the origin, and any two from each other, are no farther than that
    along = np.ascontiguousarray(begin.q.T)  # the largest of three rows takes a seventh of that of three columns
    apart = float((along.max(axis=1) - along.min(axis=1)).max())
    if not apart < most:
        raise InputError(
            f"Nodes must start within {most:.3g} m of each other, beyond which a motion counts as diverged, but they are "
            f"{apart:.3g} m apart."
        )


def check_lengths(scene: Scene, begin: State) -> None:
    """Refuse a start from which no motion of cables that do not stretch can go on: every step would have to give lengths back."""
    words = off_length(begin.model, begin.q, begin.t, broken_at(scene, begin.events, begin.t))
    if words is not None:
        raise InputError(words)


def _check_held(scene: Scene, begin: State) -> None:
    """Points that are held start where their holders are."""
    gone = released(begin.events)
    for event in scene.releases:
        if event.point in gone or (event.t is not None and event.t < begin.t):
            continue
        apart = float(np.linalg.norm(begin.position(event.point) - begin.position(event.holder)))
        if apart > CLOSE * scene.longest:
            raise InputError(
                f"A point that is held must start at its holder, but {quoted(event.point)} is {apart:.3g} m from "
                f"{quoted(event.holder)}."
            )


def _check_breaks(scene: Scene, scheme: Scheme, extrapolate: bool) -> None:
    """Cables that may break need a march that looks for it, and one motion."""
    brittle = next((cable.name for cable in scene.cables if cable.breaking_tension is not None), None)
    parting = next((event.point for event in scene.releases if event.tension is not None), None)
    if (brittle or parting) is not None and (extrapolate or not scheme.stops_at_events):
        unable = ", ".join(schemes.names(stops_at_events=False))
        given = "`extrapolate` is set" if extrapolate else f"the method is {scheme.name}"
        if brittle is None:
            raise InputError(
                f"A release at a tension needs a method other than {unable} and one run, but point {quoted(parting)} has one and "
                f"{given}."
            )
        raise InputError(
            f"A cable with a `breaking_tension` needs a method other than {unable} and one run, but cable {quoted(brittle)} "
            f"has one and {given}."
        )


def _check_external(scene: Scene, begin: State) -> None:
    """Points that a session drives stand at their start in a run of their own, so that it cannot begin with them elsewhere."""
    for point in scene.all_points:
        if isinstance(point, Driven) and point.path.kind == "external":
            start = point.path.at(begin.t)[0]
            if not np.allclose(begin.position(point.name), start, rtol=1e-12, atol=1e-12):
                raise InputError(
                    f"A point with the path paths.external stands at its start in a run, {tuple(start.tolist())}, but the state to "
                    f"start from has {quoted(point.name)} at {tuple(begin.position(point.name).tolist())}; go on in a Session, or "
                    "give the point another path."
                )


def _ending_on(choice: Choice, span: float, called: str) -> Choice:
    """The choice with steps that end on what is saved, which its reason says where it shows in three digits."""
    dt = span / math.ceil(span / choice.dt)
    shorter = f"; shortened to {1e3 * dt:.3g} ms to meet {called}" if f"{dt:.3g}" != f"{choice.dt:.3g}" else ""
    return replace(choice, dt=dt, reason=choice.reason + shorter)


def check_arguments(
    t_end: Any, method: Any, dt: Any, save_every: Any, rtol: Any, atol: Any, rho_inf: Any, audit: Any, *errors: Any
) -> None:
    """Refuse arguments of a run that no scene could have, see `simulate`; ``errors`` are `error` and `tension_error`."""
    sizes = dict(t_end=t_end, dt=dt, save_every=save_every, rtol=rtol, atol=atol, audit=1.0 if isinstance(audit, bool) else audit)
    sizes |= dict(zip(("error", "tension_error"), errors, strict=True))
    for name, value in sizes.items():
        if (value is not None or name in ("t_end", "audit")) and not (0 < number(value) < math.inf):
            unit = "" if name in ("rtol", "tension_error") else " [m]" if name in ("atol", "audit", "error") else " [s]"
            raise InputError(f"Argument `{name}` must be positive and finite{unit}, but it is {shown(value)}.")
    if number(t_end) < SMALLEST:  # the square of a step would be less than a float holds
        raise InputError(f"Argument `t_end` must be {SMALLEST:g} s or more, but it is {shown(t_end)}.")
    for name, value in (("dt", dt), ("save_every", save_every)):
        if value is not None and number(value) > number(t_end) * (1 + 1e-9):
            raise InputError(f"Argument `{name}` must not exceed t_end={number(t_end):g} s, but it is {number(value):g} s.")
    if rtol is not None and number(rtol) > 1.0:
        raise InputError(f"Argument `rtol` must not exceed 1, all of the largest coordinate, but it is {number(rtol):g}.")
    if errors[1] is not None and number(errors[1]) > 1.0:
        raise InputError(
            f"Argument `tension_error` must not exceed 1, all of the largest tension, but it is {number(errors[1]):g}; 0.02 is 2 %."
        )
    check_method(method, rho_inf)


def check_flags(**flags: Any) -> None:
    """Refuse arguments that are to be True or False and are something else, such as a string."""
    for name, value in flags.items():
        if not isinstance(value, bool | np.bool_):
            raise InputError(f"Argument `{name}` must be True or False, but it is {shown(value)}.")
