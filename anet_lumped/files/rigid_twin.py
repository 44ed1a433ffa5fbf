"""The rigid-link twin of a net: each segment a rigid link as long as it is at rest, joined where nodes are.

Links form a tree from the supports outwards: a link's parent is the one before it along its cable, or the one that carries the
point at which its cable begins. Where a cable ends at a point that is carried already, the loop is closed by a constraint.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import InputError, SceneError, quoted
from anet_lumped.results.run import State
from anet_lumped.scene.scene import Free, Scene

THIN = 0.02  # radius of a link over its length, of a cable without a diameter
THINNEST = 1e-3  # inertia about the axis of a lumped link over that across it: it has none, which no engine takes


class Link(NamedTuple):
    """A rigid link.

    Parameters
    ----------
    name : str, cable and number from its start, "s0-p0 3"
    parent : name of a link, or of the support at which it begins
    begin, end : (3,) [m], its ends at rest
    turn : (3, 3), its axes at rest; the first one leads from its begin to its end
    mass : [kg]
    radius : [m]
    inertia : (3,) [kg m2], about its middle, along its axes
    load : [kg], mass of the free point that it carries at its end
    """

    name: str
    parent: str
    begin: np.ndarray
    end: np.ndarray
    turn: np.ndarray
    mass: float
    radius: float
    inertia: tuple[float, float, float]
    load: float


class Twin(NamedTuple):
    """Links with parents before children; supports and their places [m]; and pairs of a link's end and what it is held to.

    The latter is the name of a link, at its end, or of a support.
    """

    links: list[Link]
    supports: dict[str, np.ndarray]
    closed: list[tuple[str, str]]


def twin_of(scene: Scene, rest: State, lumped: bool = False) -> Twin:
    """`Twin` of a scene at rest.

    Parameters
    ----------
    scene : Scene
    rest : State
    lumped : bool
        Whether a link's mass is at its ends, as in the model, instead of in a cylinder.

    Raises
    ------
    InputError : a scene with bodies, or a part of the net that no support holds
    """
    check_twin(scene)
    supports = {point.name: rest.position(point.name) for point in scene.points if not isinstance(point, Free)}
    carriers: dict[str, str] = {name: name for name in supports}
    links: list[Link] = []
    closed: list[tuple[str, str]] = []
    left = list(scene.cables)
    while left:
        cable = next((one for one in left if one.start in carriers or one.end in carriers), None)
        if cable is None:
            raise SceneError(f"A twin must hang on a fixed or driven point, but nothing holds cable {quoted(left[0].name)}.")
        left.remove(cable)
        forward = cable.start in carriers
        begin, end = (cable.start, cable.end) if forward else (cable.end, cable.start)
        shape = rest.shape(cable.name)[:: 1 if forward else -1]
        parent, axes = carriers[begin], np.eye(3)
        for k, (a, b) in enumerate(pairwise(shape)):
            axes = _turned(axes, b - a)
            length = float(np.linalg.norm(b - a))
            radius = 0.5 * cable.diameter if cable.diameter else THIN * length
            mass = cable.mass_per_length * cable.L0
            across = 0.25 * mass * length**2 if lumped else mass * (3.0 * radius**2 + length**2) / 12.0
            inertia = (THINNEST * across if lumped else 0.5 * mass * radius**2, across, across)
            link = Link(f"{cable.name} {k}", parent, a, b, axes, mass, radius, inertia, 0.0)
            links.append(link)
            parent = link.name
        point = scene.point(end)
        if end in carriers:
            closed.append((parent, carriers[end]))
        else:
            carriers[end] = parent
            assert isinstance(point, Free)
            links[-1] = links[-1]._replace(load=point.mass)
    return Twin(links, supports, closed)


def check_twin(scene: Scene) -> None:
    """Refuse a scene that has no twin."""
    if scene.bodies:
        raise InputError("A twin of rigid links must be of a scene without bodies, but this one has some.")


def _turned(axes: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Axes (3, 3) turned by the shortest way so that the first one lies along a vector (3,)."""
    from scipy.spatial.transform import Rotation

    first, to = axes[:, 0], along / np.linalg.norm(along)
    across, cosine = np.cross(first, to), float(first @ to)
    size = float(np.linalg.norm(across))
    if size < 1e-12:
        turn = np.zeros(3) if cosine > 0.0 else np.pi * axes[:, 1]
    else:
        turn = across / size * np.arctan2(size, cosine)
    return Rotation.from_rotvec(turn).as_matrix() @ axes
