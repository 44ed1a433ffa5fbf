"""The contact of nodes with a ground: the areas with which cables, bodies and rods touch it, and the force by the depth.

A node at a depth s is pressed back with

    N = k s + c r(s) ds/dt >= 0 ,     k = stiffness A ,   c = damping A ,   r = min(s/depth, 1) ,

with the area A of `contact_area`. On a rigid body, `Body.contact_area` is shared by its attachments, and each segment of a rod has
the area d L0. The damper acts in full from a depth of `DEPTH` diameters on, of a body `DEPTH` diameters of a disc of the area of an
attachment, so that N has no jump when a node touches down (as Hunt & Crossley argue). Over a whole step from a to b, N is the
secant of k s^2/2 plus c/h (R_b - R_a), R the integral of r, plus the numerical damper of `unresolved_contact` where s_a > 0.
Source: Hunt & Crossley, J. Appl. Mech. 42 (1975) 440; Armero & Petocz, Comput. Methods Appl. Mech. Engrg. 158 (1998) 269.
"""

import math
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError
from anet_lumped.compiled.jit import inlined_law
from anet_lumped.effects.laws.axial import secant_tension
from anet_lumped.effects.laws.contact_area import frequencies, sums_over_halves

DEPTH = 1e-2  # depth over the cable's diameter, at which the damper acts in full
EACH = 5  # numbers of each node in ``params``


def numbers_of_nodes(model: Any, effect: str, stiffness: float, damping: float) -> np.ndarray:
    """Numbers of each moving node for the functions below, one after the other (5 n_free,).

    k [N/m], c [N s/m], depth [m], the mass [kg] that resists the node, and that of the node itself, which on a body is smaller.

    Parameters
    ----------
    model : Model
    effect : str, name of the class of effects that asks
    stiffness : float [Pa/m]
    damping : float [Pa s/m]

    Raises
    ------
    SceneError : a cable without a diameter; nothing that could touch the ground
    """
    scene = model.scene
    if scene.whole and not scene.cables and not any(map(_contacts, scene.bodies)):
        raise SceneError(
            f"The effect {effect} acts on cables, on rods and on bodies with a `contact_area`, but the scene has none."
        )
    nodes = sums_over_halves(
        model, effect, 3, lambda cable, half: (stiffness * half, damping * half, DEPTH * cable.diameter * half)
    )
    mass = model.mass.copy()
    for body in scene.bodies:
        areas = _contacts(body)
        for name, (area, width) in areas.items():
            nodes[model.node(name)] += stiffness * area, damping * area, DEPTH * width * area
            mass[model.node(name)] = body.least_masses[name] / len(areas)
    nodes, resisting = nodes[: model.n_free], np.column_stack([mass, model.mass])
    of_area, at = (stiffness, 0) if stiffness else (damping, 1)
    touching = nodes[:, at] > 0.0  # of a body only some points do
    nodes[touching, 2] *= of_area / nodes[touching, at]  # the mean over the area
    nodes[~touching, 2] = 1.0
    return np.column_stack([nodes, resisting[: model.n_free]]).ravel()


def frequencies_of_contact(scene: Any, stiffness: float) -> list[float]:
    """Circular frequencies of segments, and of bodies on the springs at one of their points [rad/s]."""
    found = frequencies(scene.cables, stiffness)
    for body in scene.bodies:
        areas = _contacts(body)
        found += [math.sqrt(stiffness * area * len(areas) / body.least_masses[name]) for name, (area, _) in areas.items()]
    return found


def _contacts(body):
    """Area [m2] and width [m] with which points of a body that moves touch the ground, by their names."""
    found = {}
    if body.is_driven:
        return found
    if body.contact_area > 0.0:
        names = [f"{body.name}.{name}" for name, _ in body.attachments] or [body.name]
        area = body.contact_area / len(names)
        found = dict.fromkeys(names, (area, math.sqrt(4.0 * area / math.pi)))
    for rod in body.rods:
        half = 0.5 * rod.diameter * rod.L0
        for k in range(rod.segments + 1):
            found[f"{body.name}[{rod.name}.{k}]"] = (half if k in (0, rod.segments) else 2.0 * half), rod.diameter
    return found


@inlined_law
def of_node(params, header, i):
    """k, c, depth and mass of a node, whose numbers follow ``header`` others."""
    first = header + EACH * i
    return params[first], params[first + 1], params[first + 2], params[first + 3]


@inlined_law
def normal_force(s, rate, k, c, depth):
    """N of the module's docstring [N], and its slopes in s [N/m] and in ds/dt [N s/m]."""
    if s <= 0.0:
        return 0.0, 0.0, 0.0
    damper_share = min(s / depth, 1.0)
    N = k * s + c * damper_share * rate
    if N <= 0.0:
        return 0.0, 0.0, 0.0
    return N, k + (c / depth * rate if s < depth else 0.0), c * damper_share


@inlined_law
def _damper_depth(s, depth):
    """R of the module's docstring [m], and its slope r."""
    if s <= 0.0:
        return 0.0, 0.0
    if s < depth:
        return 0.5 * s * s / depth, s / depth
    return s - 0.5 * depth, 1.0


@inlined_law
def normal_force_between(s_a, s_b, h, k, c, depth, numerical):
    """N over a whole step [N], its slope in s_b [N/m], and what damper and numerical damper [N/m] take [J]."""
    secant, slope = secant_tension(s_a, s_b, k, 0.0)
    before, _ = _damper_depth(s_a, depth)
    after, r = _damper_depth(s_b, depth)
    viscous, numerical = c / h * (after - before), numerical if s_a > 0.0 else 0.0
    damped = numerical * (max(s_b, 0.0) - s_a)  # of the sign of `viscous`
    N = secant + viscous + damped
    share = viscous / (viscous + damped) if damped != 0.0 else 1.0
    if N <= 0.0:
        N, slope = 0.0, 0.0
    else:
        slope += c / h * r + (numerical if s_b > 0.0 else 0.0)
    taken = (N - secant) * (s_b - s_a)
    return N, slope, share * taken, (1.0 - share) * taken
