"""MoorDyn's input file → Scene: the decks of the mooring field run here as they stand.

MoorDyn v2's files are read and MoorDyn v1's, of the C++ and of the Fortran version (its documentation, "Input Files"; its sources
MoorDyn2.cpp, Line.cpp, MoorDyn.f90). Each section has a file here that says what it means: `moordyn_line_types`, `moordyn_points`,
`moordyn_bodies`, `moordyn_rods`, `moordyn_lines`, `moordyn_failure`, `moordyn_options`, `moordyn_seafloor`, `moordyn_effects`,
`moordyn_flow`, `moordyn_water_file`, `moordyn_syrope`, `moordyn_shedding`.

What has no meaning here, such as options of MoorDyn's integrator, is listed in one warning. What would change the answer and cannot
be had is refused, all of it at once.
"""

import pathlib
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field

from anet_lumped.checks import NAMED, SceneError, one_line
from anet_lumped.prescribed.paths import Path
from anet_lumped.regular_files import read_text
from anet_lumped.scene.body import Body
from anet_lumped.scene.scene import Free, Point, Scene

from .moordyn_bodies import moving_body
from .moordyn_effects import read_effects
from .moordyn_failure import Failures, read_failures
from .moordyn_findings import DeckWarning, Findings
from .moordyn_line_types import Tables, read_line_types
from .moordyn_lines import Line, read_lines, type_of
from .moordyn_loads import read_loads
from .moordyn_options import read_options, without_held
from .moordyn_points import OnMovingBody, Places, read_points
from .moordyn_rods import Rods, bodies_under, read_rods
from .moordyn_rows import rows_by_section
from .moordyn_seafloor import read_seafloor
from .moordyn_shedding import with_windows
from .moordyn_syrope import read_largest_tensions

NEEDED = ("line types", "lines")
ALONE = ("bodies", "rods", "points")  # what moves without lines, in files that have none


@dataclass(frozen=True)
class Deck:
    """What a MoorDyn input file says.

    Parameters
    ----------
    scene : Scene
    options : dict of option to number or word
        What it says and the scene does not hold, under MoorDyn's names of today: `dtM` and `dtOut`, the steps of its integrator
        and of its output [s], `TmaxIC`, how long it may look for rest [s], `tScheme`, `FricDamp`, ...; only what is given.
    remarks : tuple of str
        Sentences of the warning: what no use is made of, and what means another thing here than it may seem.
    points, lines : dict of int to str
        Names that the points and lines of the file have in the scene, by their numbers.
    channels : tuple of str
        Words of the section OUTPUTS.
    line_outputs : dict of int to str
        Letters of output of each line that has some, by its number.
    """

    scene: Scene
    options: dict[str, float | str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    points: dict[int, str] = field(default_factory=dict)
    lines: dict[int, str] = field(default_factory=dict)
    channels: tuple[str, ...] = ()
    line_outputs: dict[int, str] = field(default_factory=dict)


def read_moordyn(
    path: str | pathlib.Path, coupled: Mapping[int, Path] | None = None, *, outside: bool = False, like_moordyn: bool = False
) -> Deck:
    """Read a MoorDyn input file (v2, or v1).

    Point 3 is called "point3" and line 2 "line2", unless a remark `! name: "..."` on its row says otherwise.

    Parameters
    ----------
    path : str or pathlib.Path
    coupled : dict of point number to Path
        Motions of coupled points, from `paths.line`, `samples` or `harmonic`. Those without one have the path `paths.external`:
        they stay where they are until a `Session` moves them.
    outside : bool
        Whether tables that the deck names may be outside its folder.
    like_moordyn : bool
        Whether MoorDyn's laws are taken where they are others: of the damper of the bottom, of friction on it, of points at the
        surface, and of the time in which vibrations by vortices are known.

    Returns
    -------
    Deck

    Raises
    ------
    DeckError : things in it that are wrong or have no counterpart here, all of them; names the file, the lines and what they say
    SceneError : no such file
    """
    text = read_text(path, "A MoorDyn file", SceneError, errors="replace")
    path = pathlib.Path(path)
    deck = deck_from_text(text, one_line(path.name, NAMED), coupled, path.parent, outside=outside, like_moordyn=like_moordyn)
    if deck.remarks:
        warnings.warn(f"{one_line(path.name, NAMED)}: " + "\n".join(deck.remarks), DeckWarning, stacklevel=2)
    return deck


def deck_from_text(
    text: str,
    source: str = "deck",
    coupled: Mapping[int, Path] | None = None,
    folder: str | pathlib.Path = ".",
    *,
    outside: bool = False,
    like_moordyn: bool = False,
) -> Deck:
    """Return what the text of a MoorDyn input file says; as `read_moordyn`, but without a warning.

    `source` is its name for messages, `folder` where the tables are that it names.
    """
    findings = Findings(source)
    sections = rows_by_section(text, findings)
    alone = not sections.get("lines") and any(sections.get(section) for section in ALONE)
    for section in NEEDED:
        if not sections.get(section) and not alone:
            with findings.refusing():
                if section in sections:
                    raise SceneError(
                        f"{source}: {section.upper()} must have rows below its two lines of names and units, but has none."
                    )
                raise SceneError(f"{source}: a MoorDyn file must have a section {section.upper()}, but this has none.")
    for row in sections.get("control", ()):
        findings.unused(f"channel {row.words[0]}", row.line, "control channels, for which there is no controller")
    rows = sections.get("lines", [])
    tables = Tables(folder, outside)
    types = read_line_types(sections.get("line types", []), set(map(type_of, rows)), tables, findings)
    under = bodies_under(sections.get("rods", []))
    if alone:
        under |= {int(row.words[0]) for row in sections.get("bodies", []) if row.words[0].isdecimal()}
    places = read_points(sections.get("points", []), sections.get("bodies", []), under, coupled or {}, findings)
    rods = read_rods(sections.get("rods", []), sections.get("rod types", []), rows, places, findings)
    bodies = [*_bodies(places, rods, findings), *rods.bodies]
    names = [row.words[0] for row in sections.get("line types", [])]
    held = read_largest_tensions(sections.get("syrope ic", []), findings)
    lines = read_lines(rows, names, types, places, held, findings)
    failures = read_failures(sections.get("failure", []), lines, places, types, findings)
    lines = failures.lines
    options = read_options(sections.get("options", []), findings)
    lines = with_windows(lines, options, findings, like_moordyn)
    seafloor = read_seafloor(options, tables, findings)
    effects = read_effects(options, places, bodies, lines, types, tables, like_moordyn=like_moordyn, seafloor=seafloor)
    reached = {number for line in lines for number in line.ends}
    effects += read_loads(sections, places, bodies, set(places.points) if alone else reached)
    findings.raise_if_refused()
    try:
        scene = _scene(places, bodies, lines, failures, effects, findings)
    except ValueError as error:
        raise SceneError(f"{source}: {error}") from None
    known = {point.name for point in scene.all_points}
    points = {number: point.name for number, point in places.points.items() if isinstance(number, int) and point is not None}
    return Deck(
        scene=scene,
        options=dict(without_held(options)),
        remarks=findings.remarks,
        points={number: name for number, name in points.items() if name in known},
        lines={line.number: line.cable.name for line in lines},
        channels=tuple(word.strip("\"',") for row in sections.get("outputs", []) for word in row.words if word.upper() != "END"),
        line_outputs={line.number: line.outputs for line in lines if line.outputs},
    )


def _bodies(places: Places, rods: Rods, findings: Findings) -> list[Body]:
    """Bodies that move by themselves."""
    bodies = []
    for number, attachments in places.attachments.items():
        frame = places.frames[number]
        assert frame is not None
        with findings.refusing():
            bodies.append(moving_body(frame, attachments, rods.on_bodies.get(number, []), places.carried.get(number, {})))
    return bodies


def _scene(places: Places, bodies: list[Body], lines: list[Line], failures: Failures, effects: list, findings: Findings) -> Scene:
    """The scene, without free points that no line reaches; those with a mass stay in a file without lines."""
    ends = {number for line in lines for number in line.ends}
    points: list[Point] = []
    for number, point in places.points.items():
        if isinstance(point, Free) and number not in ends and (lines or not point.mass):
            without = "" if lines else ", and it has no mass"
            findings.remark(f"Point {number} is left out: it moves freely and no line ends there{without}.")
        elif point is not None and not isinstance(point, OnMovingBody) and point not in points:  # both ends of a rod may be one
            points.append(point)
    if not (lines or bodies or any(isinstance(point, Free) for point in points)):
        raise SceneError("a MoorDyn file must have lines, or bodies, rods or points that move by themselves, but this has none.")
    return Scene([*points, *failures.points], [line.cable for line in lines], effects, failures.events, bodies)
