"""A first shape for scenes with bodies: the rest of their cables with the bodies held where they start."""

from dataclasses import replace

import numpy as np

from anet_lumped.model.model import Model
from anet_lumped.model.tables import JOINT_BODY, JOINT_OTHER_NODE, JOINT_POSITION
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Fixed, Scene

from .starts import straight


def with_bodies_held(scene: Scene) -> Scene:
    """The scene with a fixed point in place of each attachment that holds a cable, and without events."""
    ends = {end for cable in scene.cables for end in (cable.start, cable.end)}
    free = [body for body in scene.bodies if not body.is_driven]
    held = [Fixed(point.name, point.at) for body in free for point in body.points if point.name in ends and point.at is not None]
    driven = tuple(body for body in scene.bodies if body.is_driven)
    names = [point.name for body in free for point in body.points]
    effects = [effect.without_bodies(names) for effect in scene.effects]
    left = [effect for effect in effects if effect is not None]
    return replace(scene, points=(*scene.points, *held), bodies=driven, effects=left, events=())


def first_shape(model: Model, held: State | None) -> tuple[np.ndarray, np.ndarray]:
    """Places (n, 3) [m] and tensions (n_segments,) [N] with the bodies where they start, and cables at rest between them.

    Parameters
    ----------
    model : Model
    held : State of the scene `with_bodies_held`, or None for straight cables
    """
    scene, tension = model.scene, np.zeros(model.n_segments)
    q = straight_around(model) if held is None else np.zeros((model.n, 3))
    if held is not None:
        for cable in scene.cables:
            q[model.nodes(cable.name)] = held.shape(cable.name)
            tension[model.segments(cable.name)] = held.tension(cable.name)
        for point in scene.points:
            q[model.node(point.name)] = held.position(point.name)
    for body in scene.bodies:
        for point in body.points:
            q[model.node_of[point.name]] = point.path.at(0.0)[0] if body.is_driven else point.at
    return q, tension


def straight_around(model: Model) -> np.ndarray:
    """`straight`, with free points that have no place in the middle of all others."""
    scene = model.scene
    known = [point.at for point in scene.free_points if point.at is not None] + scene.supports
    known += [body.at for body in scene.bodies if not body.is_driven]
    middle = tuple(np.mean(known, axis=0).tolist())
    points = [replace(p, at=middle) if p in scene.free_points and p.at is None else p for p in scene.points]
    return straight(replace(model, scene=replace(scene, points=points)))


def keep_shapes(model: Model, q: np.ndarray) -> None:
    """Move the nodes of each body that moves, in q (n, 3) [m], to the nearest place where it has its shape (Kabsch).

    A displacement along turns is that of a body to first order only. Joints are closed by shifts.
    """
    bodies = model.bodies
    for b, pivot in enumerate(bodies.pivot):
        own = slice(bodies.node_at[b], bodies.node_at[b + 1])
        nodes, arms = bodies.node[own], bodies.arm[own]
        about = nodes == pivot if pivot >= 0 else np.full(len(nodes), True)
        middle, centre = arms[about].mean(axis=0), q[nodes[about]].mean(axis=0)
        U, _, Vt = np.linalg.svd((q[nodes] - centre).T @ (arms - middle))
        U[:, 2] *= np.linalg.det(U @ Vt)
        q[nodes] = centre + (arms - middle) @ (U @ Vt).T
    for row in bodies.joint:
        b = row[JOINT_BODY]
        q[bodies.node[bodies.node_at[b] : bodies.node_at[b + 1]]] += q[row[JOINT_OTHER_NODE]] - q[bodies.node[row[JOINT_POSITION]]]
