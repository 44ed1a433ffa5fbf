"""Which method and which step: from the predicted limits and the motion's own time scale, with the reason in words."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from anet_lumped.checks import InputError, nearest, number, quoted, shown
from integrators import schemes
from integrators.linear_stability import NoLimit
from integrators.schemes.record import EnergyPromise

from . import stability

# Cost of a node and step, measured on the four-cable net (study `speed`): an explicit step, and an implicit one of one Newton
# iteration.
EXPLICIT_COST, IMPLICIT_COST = 14e-9, 130e-9  # [s]
LINK_COST = 600e-9  # [s] of a node and step of links, 13 stages of 45 ns
LINK_STEPS = 2.0  # fixed steps of the motion's time scale in one of links, where no transverse vibration holds it
DEFAULT_IMPLICIT, DEFAULT_EXPLICIT = "edmc", "verlet"
SHARE_OF_LIMIT = 0.5  # of the predicted limit for an explicit step
# Of the limit for the schemes whose energy swings about one that they keep, where a cable may go slack undamped. In free flight,
# whip and crumple at EA = 1e4 and 1e6 N the energy rises by up to 1.6 of that in play at 1/2 of the limit, 0.8 at 0.35, 0.24 at
# 1/4, 0.11 at 0.18 and 0.06 at 1/8; with rk4, which damps the fastest motion, by 0.01 at any.
SHARE_OF_LIMIT_SLACK = 0.125
CALM_DAMPING_RATIO = 0.01  # from which on a cable that goes slack and snaps taut gains no energy in explicit steps
STANDARD_GRAVITY = 9.80665  # [m/s2]
DRAWN = 10.0  # times the weight of all, beyond which the tension of a cable is that of a string
SHARE_OF_TIME_SCALE = 1.0 / 32.0  # of the motion's time scale for an implicit one: 10 ms for a metre of hanging cable
FIRST_CHOSEN = 8.0  # the first of chosen steps is that part of a fixed one
LONGEST_CHOSEN = FIRST_CHOSEN / SHARE_OF_TIME_SCALE  # times the first, the longest that chosen steps become in a motion


@dataclass(frozen=True)
class Choice:
    """Method, step [s], why, the method's predicted limit [s] and warnings about the step."""

    method: str
    dt: float
    reason: str
    limit: float
    warnings: tuple[str, ...]


def check_method(method, rho_inf=None):
    """Refuse a method that there is not, and a rho_inf that its scheme does not take.

    Parameters
    ----------
    method : str or None
    rho_inf : float or None

    Raises
    ------
    InputError
    """
    if method is not None and not (isinstance(method, str) and method in schemes.MODULES):
        known, near = ", ".join(schemes.MODULES), nearest(method, schemes.MODULES)
        raise InputError(f"Argument `method` must be one of {known}, but it is {shown(method)}" + (near or "."))
    if rho_inf is not None:
        if method is not None and "rho_inf" not in schemes.scheme(method).options:
            able = " and ".join(name for name in schemes.MODULES if "rho_inf" in schemes.scheme(name).options)
            raise InputError(f"Argument `rho_inf` belongs to {able}, but the method is {method}.")
        if not 0 <= number(rho_inf) <= 1:
            raise InputError(f"Argument `rho_inf` must lie between 0 and 1, but it is {shown(rho_inf)}.")


def time_scale(scene, tension=0.0, speed=0.0):
    """Time in which the motion changes [s]: the shortest of

    sqrt(L/g) of a cable that swings, or of a body (`Scene.longest` without cables), the ramps of the driven points, 2/omega of
    those that shake and of the vortices that cables shed, what an effect says of itself, and without gravity L sqrt(mu/EA) times
    ten, or of a cable that does not stretch, or without cables, L over the ``speed`` [m/s] between nodes, but no more than under
    gravity. Where the ``tension`` [N] of each cable is beyond `DRAWN` times the weight of all, they are like one string with all
    their length and mass, sqrt(m L/T)/pi.
    """
    g = float(np.linalg.norm(scene.gravity))
    scales = [_cable_scale(cable, g, speed) for cable in scene.cables]
    for path in scene.motions:
        scales += _path_scales(path)
    for effect in scene.effects:
        scales += effect.time_scales
        if (shed := effect.on_shedding(scene)) is not None:
            fastest = shed.highest_frequency(scene)
            scales += [2.0 / fastest] if fastest > 0.0 else []
    scales += [math.sqrt(body.radius / g) for body in scene.bodies if g > 0.0 and not body.is_driven]
    scales += [] if scene.cables else [_scale_of_length(scene.longest, g, speed)]
    payloads = [min([p.mass, *(e.mass for e in scene.payload_changes if e.point == p.name)]) for p in scene.free_points]
    mass = sum(cable.mass_per_length * cable.length for cable in scene.cables) + sum(payloads)
    if tension > DRAWN * mass * g:
        scales.append(math.sqrt(mass * sum(cable.length for cable in scene.cables) / tension) / math.pi)
    return min(scales)


def shedding_cable(scene):
    """Name of the first cable that sheds vortices; None if none does."""
    if not any(effect.on_shedding(scene) is not None for effect in scene.effects):
        return None
    return next(cable.name for cable in scene.cables if cable.Cl)


def has_inner_states(scene):
    """Whether a scene has states beside places and velocities: of cables that creep or shed vortices."""
    return any(cable.creeps for cable in scene.cables) or shedding_cable(scene) is not None


def _cable_scale(cable, g, speed):
    if g > 0.0:
        return math.sqrt(cable.length / g)
    if cable.inextensible:
        return _scale_of_length(cable.length, g, speed)
    return 10.0 * cable.length * math.sqrt(cable.mass_per_length / cable.EA_fast)


def _scale_of_length(length, g, speed):
    """sqrt(L/g), or without gravity L over the speed, but no more than under that of the Earth."""
    if g > 0.0:
        return math.sqrt(length / g)
    return min(math.sqrt(length / STANDARD_GRAVITY), length / speed if speed > 0.0 else math.inf)


def _path_scales(path):
    parameters = dict(path.parameters)
    scales = [parameters["ramp"]] if parameters.get("ramp") else []
    if parameters.get("frequency"):
        scales.append(1.0 / (math.pi * parameters["frequency"]))
    if path.kind == "samples":
        scales.append(4.0 * float(np.min(np.diff(parameters["t"]))))
    if path.kind == "states":
        fastest, hardest = (float(np.abs(parameters[name]).max()) for name in ("velocity", "acceleration"))
        scales += [2.0 * fastest / hardest] if hardest > 0.0 and fastest > 0.0 else []
    return scales


@lru_cache(maxsize=32)
def _predict(scene, schemes):
    return stability.predict(scene, schemes=schemes)


def _limits(scene, wanted):
    """Largest stable step of each scheme wanted [s]; only of those that have one are modes computed."""
    limited = tuple(name for name in wanted if not isinstance(schemes.scheme(name).limit, NoLimit))
    known = {name: limit.step for name, limit in _predict(scene, limited).limits.items()} if limited else {}
    return {name: known.get(name, math.inf) for name in wanted}


def choose(scene, method=None, dt=None, adaptive=False, tension=0.0, transverse=0.0, speed=0.0):
    """Fill in what the user left open.

    An explicit step is cheap but tied to the top axial frequency; an implicit one is tied to the motion. Whichever needs less
    time for a second of motion is taken; a step that is given decides by its stability. An effect that is ``stiff``, so that
    axial frequencies do not tell the limit, asks for the implicit one; so does one whose own motions need shorter explicit steps.
    At the start each cable is drawn by ``tension`` [N] or more, no transverse vibration is faster than ``transverse`` [rad/s],
    which bounds the explicit steps of links, and nodes differ by ``speed`` [m/s].

    Returns
    -------
    Choice
    """
    rigid = next((cable.name for cable in scene.cables if cable.inextensible), None)
    able = schemes.names(takes_rigid_springs=True) + schemes.names(keeps_constraints=True)
    if rigid is not None and method not in (None, *able):
        needed = " or ".join(f'method="{name}"' for name in able)
        raise InputError(
            f"A cable that does not stretch needs {needed}, but cable {quoted(rigid)} has EA=inf and the method is {method}."
        )
    elastic = next((cable.name for cable in scene.cables if not cable.inextensible), None)
    if elastic is not None and method is not None and schemes.scheme(method).keeps_constraints:
        raise InputError(
            f'Method "{method}" needs cables that do not stretch, EA=inf, but cable {quoted(elastic)} has '
            f"EA={scene.cable(elastic).EA:g} N."
        )
    jointed = next((body for body in scene.bodies if body.is_jointed), None)
    if jointed is not None and method is not None and schemes.scheme(method).keeps_constraints:
        raise InputError(
            f'Method "{method}" takes no body that is pinned to a point which may move, but {quoted(jointed.name)} is pinned to '
            f"{quoted(jointed.pinned_to)}; edmc and the explicit methods take it."
        )
    creeping = next((cable.name for cable in scene.cables if cable.creeps), None)
    if creeping is not None:
        _check_inner_states(method, adaptive, "A cable that creeps", f"cable {quoted(creeping)} has an `EA_dynamic`")
    shedding = shedding_cable(scene)
    if shedding is not None:
        _check_inner_states(method, adaptive, "A cable that sheds vortices", f"cable {quoted(shedding)} has a `Cl`")
    chosen_by_user = method is not None
    if method is not None and dt is not None and not adaptive:
        method = schemes.scheme(method).with_given_steps or method
    limits = _limits(scene, (method,) if chosen_by_user else (DEFAULT_IMPLICIT, DEFAULT_EXPLICIT))
    limit = limits.get(DEFAULT_EXPLICIT, math.inf)
    step_given = dt is not None and chosen_by_user and not schemes.scheme(method).keeps_constraints
    motion = math.inf if step_given else SHARE_OF_TIME_SCALE * time_scale(scene, tension, speed)
    explicit_step = SHARE_OF_LIMIT * limit
    undamped_slack_cable = next(
        (c.name for c in scene.cables if c.compression != "linear" and c.damping_ratio < CALM_DAMPING_RATIO), None
    )
    stiff_effect = next(
        (type(effect).__name__ for effect in scene.effects if effect.stiff or _stable_step(effect, scene) < explicit_step), None
    )
    needs_implicit = undamped_slack_cable is not None or stiff_effect is not None
    if chosen_by_user:
        why = "asked for"
    elif rigid is not None:
        method, why = DEFAULT_IMPLICIT, f"cable {quoted(rigid)} does not stretch"
    elif not scene.cables:
        method, why = DEFAULT_IMPLICIT, "without cables nothing stretches, and the energy is kept"
    elif creeping is not None:
        method, why = DEFAULT_IMPLICIT, f"cable {quoted(creeping)} creeps"
    elif shedding is not None:
        method, why = DEFAULT_IMPLICIT, f"cable {quoted(shedding)} sheds vortices"
    elif adaptive:
        method, why = DEFAULT_IMPLICIT, "adaptive steps: no limit of stability, and no energy gained"
    elif dt is not None:
        method = DEFAULT_IMPLICIT if needs_implicit or dt > explicit_step else DEFAULT_EXPLICIT
        within = "within" if dt <= explicit_step else "beyond"
        why = f"dt={dt:.3g} s is {within} the stable step of {DEFAULT_EXPLICIT}, {limit:.3g} s"
    else:
        explicit_cost = EXPLICIT_COST / explicit_step if explicit_step > 0 else math.inf
        implicit_cost = IMPLICIT_COST / motion
        method = DEFAULT_IMPLICIT if needs_implicit or explicit_cost > implicit_cost else DEFAULT_EXPLICIT
        costs = {DEFAULT_EXPLICIT: explicit_cost, DEFAULT_IMPLICIT: implicit_cost}
        why = (
            f"{_cheaper(method, costs)} ({DEFAULT_IMPLICIT} with steps of {motion:.3g} s, 1/{1 / SHARE_OF_TIME_SCALE:.0f} of the "
            f"motion's time scale, {DEFAULT_EXPLICIT} with {explicit_step:.3g} s, stable to {limit:.3g} s)"
        )
    by_need = chosen_by_user or any(name is not None for name in (rigid, creeping, shedding))
    if undamped_slack_cable is not None and not by_need:
        why += f"; cable {quoted(undamped_slack_cable)} may go slack undamped, where an explicit step gains energy"
    if stiff_effect is not None and not by_need:
        why += f"; an explicit step may be unstable by the forces of {stiff_effect}"
    scheme, limit = schemes.scheme(method), limits[method]
    if scheme.keeps_constraints:
        return _of_links(scheme, dt, motion, adaptive, transverse)
    if dt is None and scheme.explicit and scheme.own:
        pumps = undamped_slack_cable is not None and scheme.energy is EnergyPromise.SWINGS_ABOUT
        dt = min((SHARE_OF_LIMIT_SLACK if pumps else SHARE_OF_LIMIT) * limit, motion) if limit > 0 else motion / 32.0
        why += f"; dt={dt:.3g} s from the predicted limit"
    elif dt is None:
        dt = motion / FIRST_CHOSEN if adaptive else motion
        why += f"; dt={dt:.3g} s from the time scale of the motion"
    warning = "" if adaptive or dt <= limit else _predict(scene, (method,)).warning(method, dt)
    return Choice(method, dt, f"{method}: {why}", limit, (warning,) if warning else ())


def _stable_step(effect, scene):
    """Largest stable step of the explicit method for the motions that an effect brings to a scene, such as a contact [s]."""
    omega, rate = effect.highest_frequency(scene), effect.highest_damping_rate(scene)
    return float(stability.step_limit(DEFAULT_EXPLICIT, omega, 0.0, rate))


def _cheaper(method, costs):
    """How the cost of the method that is taken compares with that of the other, in words."""
    ((other, cost),) = ((name, cost) for name, cost in costs.items() if name != method)
    if math.isinf(cost):
        return f"{other} has no stable step here"
    if not (cost and costs[method]):
        return "no node moves freely"
    ratio = cost / costs[method]
    return (
        f"about {ratio:.2g} times cheaper than {other} here"
        if ratio >= 1.0
        else f"{other} is about {1.0 / ratio:.2g} times cheaper here"
    )


def _check_inner_states(method, adaptive, who, what):
    """Inner states, such as how far a cable has crept, are carried by few methods, and by none from a step that is taken again."""
    able = schemes.names(takes_inner_states=True)
    if method is not None and method not in able:
        needed = " or ".join(f'method="{name}"' for name in able)
        raise InputError(f"{who} needs {needed}, but {what} and the method is {method}.")
    if adaptive:
        raise InputError(f"{who} needs fixed steps, but {what} and a tolerance is given.")


def _of_links(scheme, dt, motion, adaptive, transverse):
    """Choice for cables that do not stretch, with the time in which the motion changes [s], see `choose`."""
    limit, warning = float(scheme.limit.largest_step(np.array(transverse), np.array(0.0))), ""
    if not adaptive and dt is not None and dt > limit:
        warning = (
            f'Step dt={dt:g} s is beyond the largest stable step of "{scheme.name}", {limit:.3g} s, set by transverse vibrations '
            f'of {transverse:.4g} rad/s under the tensions at the start; take a smaller step, leave it out, or method="edmc".'
        )
    why = "asked for"
    if dt is None:
        dt = min(motion / FIRST_CHOSEN, SHARE_OF_LIMIT * limit)
    return Choice(scheme.name, dt, f"{scheme.name}: {why}", limit, (warning,) if warning else ())


def by_links(choice, transverse):
    """Method, first step and limit for marching by links what `choose` chose an implicit method for.

    Parameters
    ----------
    choice : Choice
    transverse : float [rad/s], see `choose`

    Returns
    -------
    Choice
    """
    made = _of_links(schemes.scheme("links"), None, choice.dt, True, transverse)
    return replace(made, reason="links: no cable stretches")


def links_are_cheaper(choice, limit, parts, iterations):
    """Whether two runs with links cost less than one with an implicit method whose steps are taken in parts.

    Parameters
    ----------
    choice : Choice, of the implicit method
    limit : float [s], largest stable step of links
    parts : float, number of steps that each of its steps is to be replaced by
    iterations : float, Newton iterations a step
    """
    step = min(limit, LINK_STEPS * choice.dt)
    return 2.0 * LINK_COST / step < parts * max(iterations, 1.0) * IMPLICIT_COST / choice.dt
