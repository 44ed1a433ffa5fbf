"""The rigid-link twin of a net: each segment a rigid link as long as it is at rest, joined where nodes are.

Links form a tree from the supports outwards: a link's parent is the one before it along its cable, or the one that carries the
point at which its cable begins. Where a cable ends at a point that is carried already, the loop is closed by a constraint.
"""

from collections.abc import Iterable, Iterator
from heapq import heapify, heappop, heappush
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import InputError, SceneError, check_number, nearest, quoted, shown
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Cable, Free, Scene, check_scene

LINKS, JOINTS = ("cylinder", "lumped"), ("ball", "revolute")
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

    @property
    def length(self) -> float:
        """[m]."""
        return float(np.linalg.norm(self.end - self.begin))

    @property
    def whole_mass(self) -> float:
        """With what it carries [kg]."""
        return self.mass + self.load

    @property
    def middle(self) -> float:
        """Distance of the centre of mass of the link and what it carries from its begin [m]."""
        return (0.5 * self.mass + self.load) / self.whole_mass * self.length

    @property
    def whole_inertia(self) -> tuple[float, float, float]:
        """Of both about that centre of mass, along its axes [kg m2], by the theorem of Steiner."""
        apart = self.mass * self.load / self.whole_mass * (0.5 * self.length) ** 2
        return self.inertia[0], self.inertia[1] + apart, self.inertia[2] + apart


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
    for cable in from_supports(scene, supports):
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


def from_supports(scene: Scene, supports: Iterable[str]) -> Iterator[Cable]:
    """Cables so that each ends at a support or at a cable before it; of those that do, the first of the scene comes first.

    Raises
    ------
    SceneError : a part of the net that no support holds
    """
    of_point: dict[str, list[int]] = {}
    for c, cable in enumerate(scene.cables):
        for end in (cable.start, cable.end):
            of_point.setdefault(end, []).append(c)
    reached, found = set(supports), [c for name in supports for c in of_point.get(name, ())]
    heapify(found)
    taken: set[int] = set()
    while found:
        c = heappop(found)
        if c in taken:
            continue
        taken.add(c)
        cable = scene.cables[c]
        for end in (cable.start, cable.end):
            if end not in reached:
                reached.add(end)
                for other in of_point[end]:
                    heappush(found, other)
        yield cable
    if len(taken) < len(scene.cables):
        name = next(cable.name for c, cable in enumerate(scene.cables) if c not in taken)
        raise SceneError(f"A twin must hang on a fixed or driven point, but nothing holds cable {quoted(name)}.")


def check_twin(scene: Scene) -> None:
    """Refuse a scene that has no twin."""
    if scene.bodies:
        raise InputError("A twin of rigid links must be of a scene without bodies, but this one has some.")


def check_choices(scene: Any, links: Any, joints: Any, dt: Any, damping: Any) -> tuple[float, float]:
    """Refuse what no twin is made of, and other words for links and joints; returns the step [s] and the damping [N m s]."""
    check_scene(scene)
    for name, value, known in (("links", links, LINKS), ("joints", joints, JOINTS)):
        if not isinstance(value, str) or value not in known:
            raise InputError(
                f"Argument `{name}` must be one of {', '.join(known)}, but it is {shown(value)}" + (nearest(value, known) or ".")
            )
    dt = check_number("dt", dt, "s", "a twin", sign="positive")
    return dt, check_number("damping", damping, "N m s", "a twin", sign="non-negative")


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
