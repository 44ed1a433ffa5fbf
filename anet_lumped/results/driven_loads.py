"""What acts on a body whose motion is prescribed: no part of the motion of the net, but of the force that drives the body.

Weight, air, water and ground act on a body that is driven as they would on one that moves freely and is at the same place in the
same motion. With the force f_k of the effects on its nodes, their masses and added masses B_k and their accelerations a_k, driving
it takes

    sum B_k a_k - f_k

beside what holds the cables, and the bodies that are pinned to it.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from anet_lumped.effects.effect import Effect
from anet_lumped.model.body_rotation import angular_velocities, rotations
from anet_lumped.model.build import build
from anet_lumped.model.model import Model
from anet_lumped.model.remainder import Pieces
from anet_lumped.prescribed.turning_path import TurningPath
from anet_lumped.scene.scene import Body, Cable, Free, Scene

MASSLESS = 1e-12  # [kg] in place of the mass of a body that has none, with the inertia of a sphere of 1 m


def has_loads(body: Body) -> bool:
    """Whether anything may act on a driven body itself."""
    return bool(body.mass or body.rods or any(body.CdA) or body.displaced or body.contact_area or body.carried)


@lru_cache(maxsize=64)
def alone(scene: Scene, name: str) -> Model:
    """A driven body of a scene as one that moves freely, where it starts, with all effects that act on it."""
    body, names = scene.body(name), [point.name for point in scene.all_points]
    no_cables: dict[str, tuple] = {cable.name: () for cable in scene.cables}
    effects: list[Effect] = []
    for effect in scene.effects:
        left = effect.after_break(no_cables, ())
        left = None if left is None else left.without_bodies(names)
        if left is not None:
            effects.append(left)
    mass, inertia = body.mass, body.inertia
    if not mass and not any(rod.mass_per_length for rod in body.rods):
        mass = MASSLESS
    if mass and inertia is None:
        inertia = (0.4 * mass,) * 3
    at = tuple(body.motion[0].at(0.0)[0].tolist())
    free = replace(body, path=None, turning=None, at=at, mass=mass, inertia=inertia)
    ends = [Free("[start]", at=(0.0, 0.0, 0.0)), Free("[end]", at=(1.0, 0.0, 0.0))]
    cable = Cable("[start]", "[end]", length=1.0, mass_per_length=1.0, EA=1.0, segments=1, diameter=1.0)  # effects ask for one
    return build.__wrapped__(Pieces(ends, [cable], effects, bodies=[free]))


def force_to_drive(now: Any, name: str, force: Callable, added_mass: Callable) -> np.ndarray:
    """Force that drives a body against its inertia and what acts on it, (k, 3) [N].

    Parameters
    ----------
    now : Rows
    name : of a body whose motion is prescribed
    force, added_mass : `end_forces.effect_forces` and `end_forces.added_masses`

    Raises
    ------
    InputError : a body that moves as it is driven from outside, whose acceleration is not known
    """
    model, rows = on_it(now, name)
    nodes = model.bodies.node
    total = -force(model, rows)[:, nodes].sum(axis=1)
    if now.moves:
        a, added = _accelerations(now, name, model)[:, nodes], added_mass(model, rows)[:, nodes]
        total = total + np.einsum("n,knx->kx", model.mass[nodes], a) + np.einsum("knxy,kny->kx", added, a)
    return total


def on_it(now: Any, name: str) -> tuple[Model, Any]:
    """A driven body `alone`, and the places and velocities of its nodes."""
    whole, t = now.left.model, now.t
    model = alone(whole.scene, name)
    points = model.scene.bodies[0].points
    R, turn = rotations(whole, name, t, now.q), angular_velocities(whole, name, t, now.q, now.v)
    origin, q, v = whole.node_of[name], *np.zeros((2, len(t), model.n, 3))
    q[:, model.node_of["[end]"], 0] = 1.0
    for point in points:
        k, arm = model.node_of[point.name], R @ point.arm
        q[:, k], v[:, k] = now.q[:, origin] + arm, now.v[:, origin] + np.cross(turn, arm)
    return model, now._replace(q=q, v=v)


def _accelerations(now: Any, name: str, model: Model) -> np.ndarray:
    """Accelerations of the nodes of a driven body, (k, n, 3) [m/s2]."""
    body, a = now.left.model.scene.body(name), np.zeros((len(now.t), model.n, 3))
    for point in model.scene.bodies[0].points:
        origin, turning = body.motion
        path = TurningPath.of(origin, turning, body.rotation, point.arm)
        a[:, model.node_of[point.name]] = [path.at(t)[2] for t in now.t.tolist()]
    return a
