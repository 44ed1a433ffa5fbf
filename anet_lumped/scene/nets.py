"""Nets as a user thinks of them: rectangles, scoops, and any points and edges; each gives points and cables of a scene."""

import math
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike, fspath
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from anet_lumped.checks import SceneError, Vector, check_count, check_number, check_vector, nearest, quoted, shown

from .cable import Cable
from .netting import Netting
from .point import Fixed, Free

__all__ = ["NetParts", "Netting", "cone", "from_edges", "from_file", "grid"]

PATTERNS = ("square", "diagonal")
SIDES = {"line": ((0, 1),), "triangle": ((0, 1), (1, 2), (2, 0)), "quad": ((0, 1), (1, 2), (2, 3), (3, 0))}  # of a file's cells


class NetParts(NamedTuple):
    """Points and cables of a net, for a scene: ``Scene(net.points, net.cables, [Gravity()])``."""

    points: tuple[Fixed | Free, ...]
    cables: tuple[Cable, ...]


class _Twines:
    """How many twines and knots of a netting the cables and points of a grid stand for.

    Parameters
    ----------
    netting : Netting
    corners : (4, 3) float64 [m], of the field
    counts : (2,) int, steps of the lattice along its sides
    diagonal : bool, whether bars run across the field
    """

    def __init__(self, netting: Netting, corners: np.ndarray, counts: tuple[int, int], diagonal: bool) -> None:
        a, b, c, d = corners
        steps = 0.5 * (b + c - a - d) / counts[0], 0.5 * (c + d - a - b) / counts[1]  # in the middle of the field
        self.netting, self.counts, self.diagonal = netting, counts, diagonal
        if diagonal:
            self.bars = tuple(float(np.linalg.norm(steps[1] + sign * steps[0])) / netting.bar for sign in (1.0, -1.0))
        else:
            self.bars = tuple(float(np.linalg.norm(step)) / netting.bar for step in steps)

    def _line(self, axis: int, k: int) -> float:
        """Twines that the k-th line of cables across an axis stands for: half of those up to the next line on either side."""
        return 0.5 * (self.bars[axis] + 1.0) if k in (0, self.counts[axis]) else self.bars[axis]

    def of_bar(self, i: int, j: int, towards: int) -> float:
        """Twines of the bar from the point (i, j) that goes on ``towards`` along the first side."""
        if self.diagonal:
            return self.bars[0 if towards > 0 else 1]
        return self._line(1, j) if towards else self._line(0, i)

    def knots(self, i: int, j: int) -> float:
        """Knots of the point (i, j); of diagonal meshes those of its field, which a side halves."""
        if not self.diagonal:
            return self._line(0, i) * self._line(1, j)
        return self.bars[0] * self.bars[1] * 0.5 ** ((i in (0, self.counts[0])) + (j in (0, self.counts[1])))


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
    held: Iterable[Any] = (),
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
    held : numbers or names of points that are Fixed
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
    SceneError : an edge or a held point that is none, a point without an edge, what a point or a cable refuses
    """
    places = _places(points, name)
    names = list(places)

    def name_of(point: Any, what: str) -> str:
        number = isinstance(point, int | np.integer) and not isinstance(point, bool) and 0 <= point < len(names)
        if isinstance(point, str) and point in places:
            return point
        if not number or isinstance(points, Mapping):
            kind = "names of its points" if isinstance(points, Mapping) else f"numbers from 0 to {len(names) - 1}"
            raise SceneError(f"A net's {what} must be given by {kind}, but one is {shown(point)}.")
        return names[point]

    def pair(edge: Any, what: str) -> tuple[str, str]:
        if not isinstance(edge, Sequence | np.ndarray) or isinstance(edge, str) or len(edge) != 2:
            raise SceneError(f"A net's {what} must be pairs of points, but one is {shown(edge)}.")
        return name_of(edge[0], what), name_of(edge[1], what)

    pairs = [pair(edge, "edges") for edge in edges]
    of_border = {frozenset(pair(edge, "border_edges")) for edge in border_edges}
    strange = of_border - {frozenset(edge) for edge in pairs}
    if strange:
        raise SceneError(f"A net's border_edges must be among its edges, but {' to '.join(sorted(strange.pop()))} is not.")
    if of_border and border is None:
        raise SceneError("Argument `border` must be given for border_edges, but it is None.")
    return _parts(
        places, [_Edge(*edge, border=frozenset(edge) in of_border) for edge in pairs],
        [name_of(point, "held points") for point in held], cable, border, knot_mass, slack, None, {},
    )  # fmt: skip


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
    diagonal = pattern == "diagonal"
    columns, rows = (2 * across, 2 * along) if diagonal else (across, along)
    lattice = [(i, j) for j in range(rows + 1) for i in range(columns + 1) if not diagonal or (i + j) % 2 == 0]
    places = {f"{name}{i}_{j}": _inside(at, i / columns, j / rows) for i, j in lattice}
    twines = None if netting is None else _Twines(netting, at, (columns, rows), diagonal)
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


def from_file(path: str | PathLike[str], *, scale: float = 1.0, **arguments: Any) -> NetParts:
    """Net of a mesh file, as CAD and meshing programs write them; the package meshio reads it.

    Its lines, and the sides of its triangles and quadrilaterals, become cables, each once.

    Parameters
    ----------
    path : str or path, of a file whose format meshio knows by its ending: .vtk, .msh, .obj, .stl, .ply, .inp and others
    scale : float, length of a unit of the file [m], 1e-3 of a file in millimetres
    **arguments : those of `from_edges`

    Returns
    -------
    NetParts

    Raises
    ------
    ImportError : meshio is not installed
    SceneError : no such file, one that meshio cannot read, one without lines and surfaces
    """
    import meshio

    scale = check_number("scale", scale, "m", "a mesh file", sign="positive")
    try:
        mesh = meshio.read(fspath(path))
    except (Exception, SystemExit) as error:  # of readers of some thirty formats; some of them exit
        raise SceneError(f"A mesh file must be one that meshio reads, but of {quoted(fspath(path))} it says: {error}") from None
    corners = np.zeros((len(mesh.points), 3))
    corners[:, : mesh.points.shape[1]] = scale * mesh.points  # those of a plane have two numbers
    edges: dict[tuple[int, int], None] = {}
    for block in mesh.cells:
        for a, b in SIDES.get(block.type, ()):
            edges |= dict.fromkeys(zip(*np.sort(block.data[:, [a, b]], axis=1).T.tolist(), strict=True))
    if not edges:
        kinds = ", ".join(sorted({block.type for block in mesh.cells})) or "none"
        raise SceneError(f"A mesh file must have {', '.join(SIDES)} cells, but {quoted(fspath(path))} has {kinds}.")
    return from_edges(corners, list(edges), **arguments)


def _parts(places, edges, held, cable, border, knot_mass, slack, netting, knots) -> NetParts:  # type: ignore[no-untyped-def]
    """`NetParts` of edges."""
    if cable is None and netting is None:
        raise SceneError("A net must have a `cable` or a `netting`, but it has neither.")
    for argument, given in (("cable", cable), ("border", border)):
        if given is not None and not isinstance(given, Mapping):
            raise SceneError(f"Argument `{argument}` of a net must be a dict of a cable's arguments, but it is {shown(given)}.")
    own = {"segments": 1} | dict(cable or {})
    rope = {"segments": 1} | dict(border or {})
    taken = {"start", "end", "length", "name"} & (own.keys() | rope.keys())
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
    cables = []
    for start, end, twines, of_border in edges:
        arguments = rope if of_border else own if netting is None else netting.cable(twines) | own
        length = (1.0 + slack) * float(np.linalg.norm(places[end] - places[start]))
        cables.append(Cable(start, end, length=length, **_known(arguments)))
    return NetParts(tuple(points), tuple(cables))


def _known(arguments: Mapping[str, Any]) -> Mapping[str, Any]:
    """Arguments of a `Cable`, if they are."""
    wrong = [key for key in arguments if key not in Cable.__dataclass_fields__]
    if wrong:
        raise SceneError(f"Cables have no argument `{wrong[0]}`{nearest(wrong[0], Cable.__dataclass_fields__, '`') or '.'}")
    return arguments


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
        if held not in words:
            known = ", ".join(quoted(word) for word in words)
            raise SceneError(f"Argument `held` must be {known} or names of points, but a net has held={shown(held)}.")
        return words[held]
    names = list(held)
    for name in names:
        if name not in places:
            raise SceneError(f"Argument `held` must name points of the net, but {shown(name)} is none.")
    return set(names)


def _inside(corners: np.ndarray, s: float, t: float) -> np.ndarray:
    """Place at the shares s and t of the sides, (3,) [m]."""
    a, b, c, d = corners
    return (1.0 - s) * (1.0 - t) * a + s * (1.0 - t) * b + s * t * c + (1.0 - s) * t * d
