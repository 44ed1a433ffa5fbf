"""Which method and which step: from the predicted limits and the motion's own time scale, with the reason in words."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from integrators import schemes

from . import stability

# Cost of a node and step, measured on the four-cable net (study `speed`): an explicit step, and an implicit one of one Newton
# iteration.
EXPLICIT_COST, IMPLICIT_COST = 14e-9, 130e-9  # [s]
OF_LIMIT = 0.5  # of the predicted limit for an explicit step
SWINGS_ABOUT = ("symplectic_euler", "verlet")  # no step is damped: the energy swings about one that the scheme keeps
# Of the limit for these two where a cable may go slack undamped. Of free flight, whip and crumple at EA = 1e4 and 1e6 N the energy
# rises by up to 1.6 of that in play at 1/2 of the limit, 0.8 at 0.35, 0.24 at 1/4, 0.11 at 0.18 and 0.06 at 1/8; with rk4, which
# damps the fastest motion, by 0.01 at any.
OF_LIMIT_SLACK = 0.125
CALM = 0.01  # damping ratio from which on a cable that goes slack and snaps taut does not pump an explicit step
OF_TIME_SCALE = 1.0 / 32.0  # of the motion's time scale for an implicit one: 10 ms for a metre of hanging cable


@dataclass(frozen=True)
class Choice:
    """Method, step [s], why, the method's predicted limit [s] and warnings about the step."""

    method: str
    dt: float
    reason: str
    limit: float
    warnings: tuple[str, ...]


def time_scale(scene):
    """Time in which the motion changes [s]: the shortest of

    sqrt(L/g) of a cable that swings, the ramps of the driven points, 2/omega of those that shake, what an effect
    says of itself, and without gravity L sqrt(mu/EA) times ten.
    """
    g = float(np.linalg.norm(scene.gravity))
    scales = [math.sqrt(c.length / g) if g > 0 else 10.0 * c.length * math.sqrt(c.mass_per_length / c.EA) for c in scene.cables]
    for path in scene.motions:
        scales += _path_scales(path)
    for effect in scene.effects:
        scales += effect.time_scales
    return min(scales)


def _path_scales(path):
    parameters = dict(path.parameters)
    scales = [parameters["ramp"]] if parameters.get("ramp") else []
    if parameters.get("frequency"):
        scales.append(1.0 / (math.pi * parameters["frequency"]))
    if path.kind == "samples":
        scales.append(4.0 * float(np.min(np.diff(parameters["t"]))))
    return scales


@lru_cache(maxsize=32)
def _predict(scene, names):
    return stability.predict(scene, schemes=names)


def choose(scene, method=None, dt=None, adaptive=False):
    """Fill in what the user left open.

    An explicit step is cheap but tied to the top axial frequency; an implicit one is tied to the motion. Whichever needs less
    time for a second of motion is taken; a step that is given decides by its stability. An effect that is ``stiff``, so that
    axial frequencies do not tell the limit, asks for the implicit one.

    Returns
    -------
    Choice
    """
    stiff = [cable.name for cable in scene.cables if cable.inextensible]
    if stiff and method not in (None, "edmc"):
        raise ValueError(
            f'A cable that does not stretch needs method="edmc", but cable "{stiff[0]}" has EA=inf and the method is {method}.'
        )
    if stiff and method is None:
        method = "edmc"
    prediction = _predict(scene, tuple(sorted({"verlet", "edmc" if method is None else method})))
    limit = prediction.limits["verlet"].step
    motion = OF_TIME_SCALE * time_scale(scene)
    explicit = OF_LIMIT * limit
    whips = next((c.name for c in scene.cables if c.compression != "linear" and c.damping_ratio < CALM), None)
    stiffens = next((type(effect).__name__ for effect in scene.effects if effect.stiff), None)
    never = whips is not None or stiffens is not None
    if method is None and adaptive:
        method, why = "edmc", "adaptive steps: no limit of stability, and no energy gained"
    elif method is None and dt is not None:
        method = "edmc" if never or dt > explicit else "verlet"
        why = f"dt={dt:.3g} s is {'within' if dt <= explicit else 'beyond'} the stable step of verlet, {limit:.3g} s"
    elif method is None:
        cost = EXPLICIT_COST / explicit if explicit > 0 else math.inf, IMPLICIT_COST / motion
        method = "edmc" if never or cost[0] > cost[1] else "verlet"
        why = (
            f"a second of motion costs {cost[0] * 1e6:.3g} µs a node with verlet at {explicit:.3g} s (stable to {limit:.3g} s) and "
            f"{cost[1] * 1e6:.3g} µs with edmc at {motion:.3g} s (1/{1 / OF_TIME_SCALE:.0f} of the motion's time scale)"
        )
    else:
        why = "asked for"
    if whips is not None and why != "asked for":
        why += f'; cable "{whips}" may go slack undamped, where an explicit step gains energy'
    if stiffens is not None and why != "asked for":
        why += f"; no limit of an explicit step is known before the run for the forces of {stiffens}"
    of_method = prediction.limits[method].step
    if dt is None:
        if method in schemes.EXPLICIT:
            share = OF_LIMIT_SLACK if whips is not None and method in SWINGS_ABOUT else OF_LIMIT
            dt = min(share * of_method, motion) if of_method > 0 else motion / 32.0
        else:
            dt = motion / 8.0 if adaptive else motion
        why += f"; dt={dt:.3g} s from the {'predicted limit' if method in schemes.EXPLICIT else 'time scale of the motion'}"
    warning = "" if adaptive else prediction.warning(method, dt)
    return Choice(method, dt, f"{method}: {why}", of_method, (warning,) if warning else ())
