"""Nets as a user thinks of them: rectangles, scoops, and any points and edges; each gives points and cables of a scene."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING
from os import PathLike, fspath
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from anet_lumped.checks import SceneError, Vector, check_count, check_number, check_vector, nearest, quoted, shown
from anet_lumped.limits import BYTES, check_most

from .cable import Cable
from .mesh_files import read_mesh
from .netting import Netting, Twines
from .point import Fixed, Free

__all__ = ["NetParts", "Netting", "cone", "from_edges", "from_file", "grid"]

OF_NET = {"start", "end", "length", "name"}  # arguments of its cables that a net gives
PATTERNS = ("square", "diagonal")
BYTES_OF_CABLE = 1000.0  # of a net, with its share of the points: as measured from 30 x 30 to 200 x 200 meshes


class NetParts(NamedTuple):
    """Points and cables of a net, for a scene: ``Scene(net.points, net.cables, [Gravity()])``."""

    points: tuple[Fixed | Free, ...]
    cables: tuple[Cable, ...]


class _Edge(NamedTuple):
    """A cable to be: names of its ends, twines that it stands for, and whether it is of the border."""

    start: str
    end: str
    twines: float = 1.0
    border: bool = False


def from_edges(
    points: ArrayLike | Mapping[str, ArrayLike],
    edges: Iterable[Sequence[Any]],
    *,
    cable: Mapping[str, Any],
    held: Any = (),
    border: Mapping[str, Any] | None = None,
    border_edges: Iterable[Sequence[Any]] = (),
    knot_mass: float = 0.0,
    slack: float = 0.0,
    name: str = "p",
) -> NetParts:
    """Net of any points, joined by edges; each edge becomes a cable, each point that is not held a free one.

    Parameters
    ----------
    points : (n, 3) array_like [m], or dict of name to (3,) array_like [m]
        Places. Points of an array are named p0, p1 and so on.
    edges : pairs of numbers of points, or of names
    cable : dict, arguments of `Cable` beside its ends and its length; ``segments`` is 1 if it is not given
    held : numbers or names of points that are Fixed, or one of them
    border : dict or None, arguments of `Cable` for the ``border_edges``, in place of those of ``cable``
    border_edges : pairs out of ``edges``
    knot_mass : float [kg], of each free point
    slack : float, by which share cables are longer than the distance of their ends
    name : str, that names of points of an array begin with

    Returns
    -------
    NetParts

    Raises
    ------
    SceneError : an edge or a held point that is none, an edge that is there twice, a point without one, what a part refuses
    """
    places = _places(points, name)
    names = None if isinstance(points, Mapping) else list(places)
    return _of_edges(places, names, edges, cable, held, border, border_edges, knot_mass, slack)


def grid(
    meshes: Sequence[int],
    corners: Sequence[Vector],
    *,
    cable: Mapping[str, Any] | None = None,
    netting: Netting | None = None,
    pattern: Literal["square", "diagonal"] = "square",
    border: Mapping[str, Any] | None = None,
    held: Literal["corners", "sides", "first side"] | Iterable[str] = "corners",
    knot_mass: float = 0.0,
    slack: float = 0.0,
    name: str = "p",
) -> NetParts:
    """Net over a four-sided field, of square or of diagonal meshes; its points are p0_0, p1_0 and so on.

    The place of a point follows from the corners by bilinear interpolation. The point pI_J lies I meshes along the first side, from
    the first corner to the second, and J meshes along the last one, from the first corner to the fourth. Of diagonal meshes, whose
    bars run across the field, I and J count half meshes, and their sum is even.

    Parameters
    ----------
    meshes : (2,) int, along the first and the last side
    corners : (4, 3) array_like [m], one after the other around the field
    cable : dict or None
        Arguments of `Cable` beside its ends and its length; ``segments`` is 1 if it is not given. With ``netting`` what it gives
        counts, and what is given here besides.
    netting : Netting or None
        Each cable stands for as many twines as lie in the strip of netting half-way to the next ones on either side, and those on
        the sides for half of that and half a twine, so that the net has all twines of the netting over the field.
    pattern : "square" or "diagonal"
    border : dict or None, arguments of `Cable` for a rope along the sides; a diagonal net has a rope there only if it is given
    held : "corners", "sides", "first side" or names of points, which are Fixed
    knot_mass : float [kg], of each free point, beside what ``netting`` gives
    slack : float, by which share cables are longer than the distance of their ends
    name : str, that names of points begin with

    Returns
    -------
    NetParts

    Raises
    ------
    SceneError : no counts of meshes, no four corners, a word that is none, neither ``cable`` nor ``netting``
    """
    across, along = _counts(meshes, "a grid")
    if not isinstance(pattern, str) or pattern not in PATTERNS:
        raise SceneError(f"Argument `pattern` must be one of {', '.join(PATTERNS)}, but a grid has pattern={shown(pattern)}.")
    at = _array(corners, (4, 3), "corners", "a grid")
    _check_field(at)
    diagonal = pattern == "diagonal"
    columns, rows = (2 * across, 2 * along) if diagonal else (across, along)
    check_most(BYTES, BYTES_OF_CABLE * (2.0 if not diagonal else 4.0) * across * along, f"A grid of {across} by {along} meshes")
    lattice = [(i, j) for j in range(rows + 1) for i in range(columns + 1) if not diagonal or (i + j) % 2 == 0]
    places = {f"{name}{i}_{j}": _inside(at, i / columns, j / rows) for i, j in lattice}
    twines = None if netting is None else Twines(netting, at, (columns, rows), diagonal)
    edges: list[_Edge] = []
    inside = set(lattice)
    for i, j in lattice:
        for a, b in ((1, 1), (-1, 1)) if diagonal else ((1, 0), (0, 1)):
            if (i + a, j + b) in inside:
                side = (b == 0 and j in (0, rows)) or (a == 0 and i in (0, columns))
                count = 1.0 if twines is None else twines.of_bar(i, j, a)
                edges.append(_Edge(f"{name}{i}_{j}", f"{name}{i + a}_{j + b}", count, side and border is not None))
    if diagonal and border is not None:
        edges += [_Edge(f"{name}{i}_{j}", f"{name}{i + 2}_{j}", border=True) for j in (0, rows) for i in range(0, columns, 2)]
        edges += [_Edge(f"{name}{i}_{j}", f"{name}{i}_{j + 2}", border=True) for i in (0, columns) for j in range(0, rows, 2)]
    sides = {f"{name}{i}_{j}" for i, j in lattice if i in (0, columns) or j in (0, rows)}
    words = {
        "corners": {f"{name}{i}_{j}" for i in (0, columns) for j in (0, rows)},
        "sides": sides,
        "first side": {f"{name}{i}_{j}" for i, j in lattice if j == 0},
    }
    knots = {} if twines is None else {f"{name}{i}_{j}": twines.netting.knots(twines.knots(i, j)) for i, j in lattice}
    return _parts(places, edges, _held(held, words, places), cable, border, knot_mass, slack, netting, knots)


def cone(
    meshes: Sequence[int],
    *,
    radius: float,
    depth: float,
    cable: Mapping[str, Any],
    end_radius: float = 0.0,
    at: Sequence[float] = (0.0, 0.0, 0.0),
    border: Mapping[str, Any] | None = None,
    held: Literal["rim"] | Iterable[str] = "rim",
    knot_mass: float = 0.0,
    slack: float = 0.0,
    name: str = "p",
) -> NetParts:
    """Net in the shape of a cone, a scoop, that opens upwards, of rings and of cables from ring to ring.

    The point pI_J is the I-th of its ring; the rings are counted from the rim, J = 0. A cone whose ``end_radius`` is 0 ends in a
    point, "tip" behind ``name``.

    Parameters
    ----------
    meshes : (2,) int, around, at least 3, and from the rim down
    radius, depth : float [m], of the rim, and of the last ring below it
    cable : dict, arguments of `Cable` beside its ends and its length; ``segments`` is 1 if it is not given
    end_radius : float [m], of the last ring
    at : (3,) array_like [m], middle of the rim
    border : dict or None, arguments of `Cable` for a rope along the rim
    held : "rim" or names of points, which are Fixed
    knot_mass : float [kg], of each free point
    slack : float, by which share cables are longer than the distance of their ends
    name : str, that names of points begin with

    Returns
    -------
    NetParts

    Raises
    ------
    SceneError : fewer than three meshes around, a size that cannot be, a name that is none
    """
    around, down = _counts(meshes, "a cone")
    if around < 3:
        raise SceneError(f"A cone must have at least 3 meshes around, but it has {around}.")
    check_most(BYTES, BYTES_OF_CABLE * 2.0 * around * down, f"A cone of {around} by {down} meshes")
    radius, depth = (check_number(key, x, "m", "a cone", sign="positive") for key, x in (("radius", radius), ("depth", depth)))
    end_radius = check_number("end_radius", end_radius, "m", "a cone", sign="non-negative")
    centre = np.array(check_vector("at", at, "m", "a cone"))
    rings = down if end_radius == 0.0 else down + 1
    places: dict[str, np.ndarray] = {}
    for j in range(rings):
        ring = radius + (end_radius - radius) * j / down
        for i in range(around):
            angle = 2.0 * math.pi * i / around
            from_centre = ring * math.cos(angle), ring * math.sin(angle), -depth * j / down
            places[f"{name}{i}_{j}"] = centre + from_centre
    edges = [
        _Edge(f"{name}{i}_{j}", f"{name}{(i + 1) % around}_{j}", border=j == 0 and border is not None)
        for j in range(rings) for i in range(around)
    ]  # fmt: skip
    edges += [_Edge(f"{name}{i}_{j}", f"{name}{i}_{j + 1}") for j in range(rings - 1) for i in range(around)]
    if end_radius == 0.0:
        places[f"{name}tip"] = centre - (0.0, 0.0, depth)
        edges += [_Edge(f"{name}{i}_{rings - 1}", f"{name}tip") for i in range(around)]
    words = {"rim": {f"{name}{i}_0" for i in range(around)}}
    return _parts(places, edges, _held(held, words, places), cable, border, knot_mass, slack, None, {})


def from_file(
    path: str | PathLike[str],
    *,
    cable: Mapping[str, Any],
    scale: float = 1.0,
    held: Any = (),
    border: Mapping[str, Any] | None = None,
    border_edges: Iterable[Sequence[Any]] = (),
    knot_mass: float = 0.0,
    slack: float = 0.0,
    name: str = "p",
) -> NetParts:
    """Net of a mesh file, as CAD and meshing programs write them; the package meshio reads it, but for .obj files.

    Its lines, and the sides of its triangles, quadrilaterals and polygons, become cables, each once; sides with a node in their
    middle become two. Points nearer to each other than 1e-6 of the size of the mesh are one, the first of them. Points of no line
    and no surface are left out. Points have their numbers in the file, counted from 0, behind ``name``.

    Parameters
    ----------
    path : str or path, of a file whose format its ending tells: .obj, .vtk, .msh, .stl, .ply, .inp and others
    cable : dict, arguments of `Cable` beside its ends and its length; ``segments`` is 1 if it is not given
    scale : float, length of a unit of the file [m], 1e-3 of a file in millimetres
    held : numbers or names of points that are Fixed, or one of them
    border : dict or None, arguments of `Cable` for the ``border_edges``, in place of those of ``cable``
    border_edges : pairs of numbers or names; if none are given, the edges of one surface alone, the rim
    knot_mass : float [kg], of each free point
    slack : float, by which share cables are longer than the distance of their ends
    name : str, that names of points begin with

    Returns
    -------
    NetParts

    Raises
    ------
    ImportError : meshio is not installed, and the file is no .obj file
    SceneError : no such file, one that cannot be read, one without lines and surfaces, one with cells that are neither
    """
    scale = check_number("scale", scale, "m", "a mesh file", sign="positive")
    mesh = read_mesh(path)
    names = [f"{name}{i}" for i in mesh.one_of.tolist()]
    places = {names[i]: scale * mesh.places[i] for i in sorted({end for edge in mesh.edges for end in edge})}
    if border is not None and not border_edges:
        if not mesh.rim:
            raise SceneError(f"A mesh file must have surfaces for a `border` along their rim, but {quoted(fspath(path))} has none.")
        border_edges = mesh.rim
    return _of_edges(places, names, mesh.edges, cable, held, border, border_edges, knot_mass, slack)


def _of_edges(places, names, edges, cable, held, border, border_edges, knot_mass, slack) -> NetParts:  # type: ignore[no-untyped-def]
    """`NetParts` of points by name and edges; ``names`` are those of points that have numbers."""

    def name_of(point: Any, what: str) -> str:
        if isinstance(point, str) and point in places:
            return point
        number = isinstance(point, int | np.integer) and not isinstance(point, bool)
        if names is None or not number or not 0 <= point < len(names):
            kind = "names of its points" if names is None else f"numbers from 0 to {len(names) - 1}"
            raise SceneError(f"A net's {what} must be given by {kind}, but one is {shown(point)}.")
        if names[point] not in places:
            raise SceneError(f"A net's {what} must be points of its edges, but {point} is of none.")
        return names[point]

    def pair(edge: Any, what: str) -> tuple[str, str]:
        if not isinstance(edge, Sequence | np.ndarray) or isinstance(edge, str) or len(edge) != 2:
            raise SceneError(f"A net's {what} must be pairs of points, but one is {shown(edge)}.")
        return name_of(edge[0], what), name_of(edge[1], what)

    pairs: dict[frozenset[str], tuple[str, str]] = {}
    for edge in _listed(edges, "edges"):
        start, end = pair(edge, "edges")
        if start == end:
            raise SceneError(f"A net's edges must join two points, but one joins {quoted(start)} to itself.")
        if frozenset((start, end)) in pairs:
            raise SceneError(f"A net's edges must be given once each, but {quoted(start)} to {quoted(end)} is there twice.")
        pairs[frozenset((start, end))] = start, end
    of_border = {frozenset(pair(edge, "border_edges")) for edge in _listed(border_edges, "border_edges")}
    strange = of_border - pairs.keys()
    if strange:
        raise SceneError(f"A net's border_edges must be among its edges, but {' to '.join(sorted(strange.pop()))} is not.")
    if bool(of_border) != (border is not None):
        lacks = ("border", "border_edges, but it is None") if of_border else ("border_edges", "a border, but there are none")
        raise SceneError(f"Argument `{lacks[0]}` must be given for {lacks[1]}.")
    held = [held] if isinstance(held, str | int | np.integer) else _listed(held, "held points")
    return _parts(
        places, [_Edge(*ends, border=edge in of_border) for edge, ends in pairs.items()],
        [name_of(point, "held points") for point in held], cable, border, knot_mass, slack, None, {},
    )  # fmt: skip


def _listed(things: Any, what: str) -> list[Any]:
    """A list of what can be one."""
    if isinstance(things, str) or not isinstance(things, Iterable):
        raise SceneError(f"A net's {what} must be a list of them, but it has {shown(things)}.")
    return list(things)


def _parts(places, edges, held, cable, border, knot_mass, slack, netting, knots) -> NetParts:  # type: ignore[no-untyped-def]
    """`NetParts` of edges."""
    if cable is None and netting is None:
        raise SceneError("A net must have a `cable` or a `netting`, but it has neither.")
    for argument, given in (("cable", cable), ("border", border)):
        if given is not None and not isinstance(given, Mapping):
            raise SceneError(f"Argument `{argument}` of a net must be a dict of a cable's arguments, but it is {shown(given)}.")
    own = {"segments": 1} | dict(cable or {})
    rope = {"segments": 1} | dict(border or {})
    taken = OF_NET & (own.keys() | rope.keys())
    if taken:
        raise SceneError(f"A net gives its cables {', '.join(sorted(taken))}, but the arguments of its cables have it, too.")
    slack = check_number("slack", slack, "", "a net")
    if slack <= -1.0:
        raise SceneError(f"Argument `slack` must be above -1, but a net has slack={slack:g}.")
    knot_mass = check_number("knot_mass", knot_mass, "kg", "a net", sign="non-negative")
    held = set(held)
    reached = {end for edge in edges for end in (edge.start, edge.end)}
    points: list[Fixed | Free] = []
    for name, place in places.items():
        if name not in reached:
            raise SceneError(f"Each point of a net must be the end of an edge, but {quoted(name)} is of none.")
        knot = knots.get(name, {})
        free = {"mass": knot_mass + knot.get("mass", 0.0), "volume": knot.get("volume", 0.0)}
        at = tuple(place.tolist())
        points.append(Fixed(name, at) if name in held else Free(name, at=at, **free))
    known = own if netting is None else netting.cable(1.0) | own
    for argument, given in (("cable", known), ("border", known if border is None else rope)):
        _check_arguments(argument, given)
    cables = []
    for start, end, twines, of_border in edges:
        arguments = rope if of_border else own if netting is None else netting.cable(twines) | own
        length = (1.0 + slack) * float(np.linalg.norm(places[end] - places[start]))
        cables.append(Cable(start, end, length=length, **arguments))
    return NetParts(tuple(points), tuple(cables))


def _check_arguments(argument: str, given: Mapping[str, Any]) -> None:
    """Refuse what are no arguments of a `Cable`, or not all that it must have."""
    known = Cable.__dataclass_fields__
    wrong = [key for key in given if key not in known]
    if wrong:
        raise SceneError(f"Cables have no argument `{wrong[0]}`{nearest(wrong[0], known, '`') or '.'}")
    lacks = [
        key for key, field in known.items()
        if field.default is MISSING and field.default_factory is MISSING and key not in given and key not in OF_NET
    ]  # fmt: skip
    if lacks:
        raise SceneError(f"Argument `{argument}` of a net must have {', '.join(f'`{key}`' for key in lacks)}, but it does not.")


def _places(points: Any, name: str) -> dict[str, np.ndarray]:
    """(3,) places [m] by name."""
    if isinstance(points, Mapping):
        return {key: np.array(check_vector("at", at, "m", f"point {quoted(key)}")) for key, at in points.items()}
    return {f"{name}{i}": place for i, place in enumerate(_array(points, (-1, 3), "points", "a net"))}


def _counts(meshes: Any, owner: str) -> tuple[int, int]:
    """The two numbers of meshes of a net."""
    if not isinstance(meshes, Sequence | np.ndarray) or len(meshes) != 2:
        raise SceneError(f"Argument `meshes` must be two numbers of meshes, but {owner} has meshes={shown(meshes)}.")
    first, second = (check_count("meshes", count, owner) for count in meshes)
    return first, second


def _array(value: Any, shape: tuple[int, int], argument: str, owner: str) -> np.ndarray:
    """A finite array of a shape, whose -1 is any number."""
    try:
        array = np.asarray(value, float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 2 or any(want not in (-1, got) for want, got in zip(shape, array.shape, strict=True)):
        wanted = ", ".join("n" if want < 0 else str(want) for want in shape)
        raise SceneError(f"Argument `{argument}` must be ({wanted}) numbers [m], but {owner} has {argument}={shown(value)}.")
    if not np.isfinite(array).all():
        raise SceneError(f"Argument `{argument}` must be finite [m], but {owner} has {argument}={shown(value)}.")
    return array


def _held(held: Any, words: Mapping[str, set[str]], places: Mapping[str, Any]) -> set[str]:
    """Names of the points that are held."""
    if isinstance(held, str):
        if held in places:
            return {held}
        if held not in words:
            known = ", ".join(quoted(word) for word in words)
            raise SceneError(f"Argument `held` must be {known} or names of points, but a net has held={shown(held)}.")
        return words[held]
    names = _listed(held, "held points")
    for name in names:
        if not isinstance(name, str) or name not in places:
            raise SceneError(f"Argument `held` must name points of the net, but {shown(name)} is none.")
    return set(names)


def _check_field(corners: np.ndarray) -> None:
    """Refuse (4, 3) corners of a field that is nowhere, or whose net would turn over and lie on itself."""
    normals = np.cross(np.roll(corners, -1, axis=0) - corners, np.roll(corners, 1, axis=0) - corners)
    sizes = np.linalg.norm(normals, axis=1)
    turns = normals[sizes > 1e-9 * np.ptp(corners, axis=0).max() ** 2]  # a corner on a straight side has none
    if len(turns) == 0:
        raise SceneError("Argument `corners` must be four around a field, but those of a grid lie in one line.")
    turns = turns / np.linalg.norm(turns, axis=1)[:, None]
    if (turns @ turns.T).min() < -0.999:  # a field that is no plane may be turned by less
        raise SceneError("Argument `corners` must go around a field in one turn, but the sides of a grid cross or turn back.")


def _inside(corners: np.ndarray, s: float, t: float) -> np.ndarray:
    """Place at the shares s and t of the sides, (3,) [m]."""
    a, b, c, d = corners
    return (1.0 - s) * (1.0 - t) * a + s * (1.0 - t) * b + s * t * c + (1.0 - s) * t * d
