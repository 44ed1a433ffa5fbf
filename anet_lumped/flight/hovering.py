"""Where a flight begins: quadrotors that hover, each with its thrust against its weight and the pull of its cables."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.scene.scene import Scene
from anet_lumped.statics.equilibrium import equilibrium
from anet_lumped.statics.held_bodies import with_bodies_held

from .geometric import attitudes

LEVEL = 1e-10  # change of an attitude, from which on it is found
TURNS = 50  # at most; each leaves some pull times arm over weight times length of the change before


class Hovering(NamedTuple):
    """A scene whose bodies start in the attitude in which they hover.

    Parameters
    ----------
    scene : Scene
    shapes : dict of cable name to (segments + 1, 3) float64 [m], for the ``start`` of a session
    force, moment : (m, 3) float64 [N], [N m], of the cables on each body about its origin, in the axes of the world
    """

    scene: Scene
    shapes: dict[str, np.ndarray]
    force: np.ndarray
    moment: np.ndarray


def hovering(scene: Scene, heading: float = 0.0) -> Hovering:
    """Attitudes in which all bodies that move freely hover where they start: their z axes lie along the thrust that is needed.

    Parameters
    ----------
    scene : Scene
    heading : float [rad], of the x axes about z

    Raises
    ------
    InputError : no body moves freely
    NoRestError : a cable does not reach, for example
    """
    free = [body for body in scene.bodies if not body.is_driven]
    if not free:
        raise InputError("A flight needs a body that moves freely, but the scene has none.")
    from scipy.spatial.transform import Rotation

    weight = np.array([[body.whole.total] for body in free]) * scene.gravity
    for _ in range(TURNS):
        rest = equilibrium(with_bodies_held(scene))
        force, moment = np.zeros((len(free), 3)), np.zeros((len(free), 3))
        for cable in scene.cables:
            shape, tension = rest.shape(cable.name), rest.tension(cable.name)
            half = cable.half_segment_mass * scene.gravity  # the half segment that ends there
            for name, T, d in ((cable.start, tension[0], shape[1] - shape[0]), (cable.end, tension[-1], shape[-2] - shape[-1])):
                for b, body in enumerate(free):
                    if name in [point.name for point in body.points]:
                        pull = T * d / np.linalg.norm(d) + half
                        force[b] += pull
                        moment[b] += np.cross(rest.position(name) - np.array(body.at), pull)
        turned = Rotation.from_matrix(attitudes(-weight - force, heading)).as_rotvec()
        change = float(np.abs(turned - [body.rotation for body in free]).max())
        new = {body.name: replace(body, rotation=tuple(row.tolist())) for body, row in zip(free, turned, strict=True)}
        scene = replace(scene, bodies=[new.get(body.name, body) for body in scene.bodies])
        free = [new[body.name] for body in free]
        if change < LEVEL:
            break
    return Hovering(scene, {cable.name: rest.shape(cable.name) for cable in scene.cables}, force, moment)
