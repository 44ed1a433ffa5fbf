"""Scene → MoorDyn's input file.

Written so that MoorDyn v2 runs it and that `moordyn_file` reads it back as an equal scene, like_moordyn where the bottom is
`MoordynBottom` and points do not float; names travel as remarks. What a deck cannot hold is refused: two-way springs, cables that
do not stretch or may break, payloads that change, damping by the environment; of bodies see `moordyn_body_rows`, of forces, dampers
and friction along and across cables `moordyn_loads_writer`. What it has no
place for is lost: the path of a driven point or body, which MoorDyn moves from outside, the EI of a scene without bending, the zeta
of a cable that creeps, the window of one that sheds vortices, that a cable has no diameter and that a free point has no place. Of
polyester see `moordyn_syrope_writer`, of waves and currents `moordyn_flow_writer`.
"""

import math
import pathlib
import warnings
from collections.abc import Mapping
from os import PathLike
from typing import Any

from anet_lumped.checks import SceneError, quoted, shown
from anet_lumped.regular_files import check_target, write_text
from anet_lumped.scene.scene import Cable, Driven, Fixed, Free, Point, Scene, check_scene

from .moordyn_body_rows import body_points, body_rows, pins, rod_ends
from .moordyn_flow_writer import flow_files, flow_options
from .moordyn_loads_writer import friction_options, load_rows
from .moordyn_rows import named
from .moordyn_seafloor import seafloor_text
from .moordyn_shedding import shedding_columns
from .moordyn_syrope import PREFIX
from .moordyn_syrope_writer import curve_of, syrope_name, syrope_rows, syrope_text

NO_DIAMETER = 1e-3  # [m], of a cable without one: MoorDyn divides by the section, and in air nothing else asks for it
WRITTEN = (
    "gravity", "water", "ground", "ground_map", "moordyn_bottom", "bending", "moment_curvature", "applied_forces", "dashpots",
    "cable_friction", "cable_friction_map",
)  # fmt: skip
AT_ONCE = 1e-9  # [s], time of what fails at the start
NO_BOTTOM = 1e4  # [m], depth of water without a bottom


def save_moordyn(scene: Scene, path: str | PathLike[str], options: Mapping[str, Any] | None = None) -> None:
    """Write a scene as a MoorDyn v2 input file, and beside it the files that it names.

    Waves and a current are in files whose names are MoorDyn's: current_profile.txt and wave_frequencies.txt.

    Parameters
    ----------
    scene : Scene
    path : str or pathlib.Path
    options : dict of option to value
        What the file shall say besides, such as {"dtM": 1e-3}: MoorDyn's own step, scheme and output.

    Raises
    ------
    SceneError : a scene with something that MoorDyn does not have; names it
    InputError : no file can be there
    """
    check_scene(scene)
    check_target(path, "A MoorDyn file")
    for cable in scene.cables:
        if cable.compression == "none" and cable.axial_viscosity:
            warnings.warn(
                'MoorDyn\'s dampers act on slack segments too: its law is compression="damped", but cable '
                f'{quoted(cable.name)} has "none".',
                stacklevel=2,
            )
            break
    if any(len(set(body.CdA)) > 1 for body in scene.bodies):
        warnings.warn("MoorDyn 2.7.2 passes over the first CdA of a body that has several.", stacklevel=2)
    path = pathlib.Path(path)
    write_text(path, moordyn_text(scene, options, stem=path.stem), "A MoorDyn file")
    if (ground := _seafloor(scene)) is not None:
        text = seafloor_text(ground.x, ground.y, ground.heights)
        write_text(path.with_name(f"{path.stem}_seafloor.txt"), text, "A MoorDyn file")
    for name, moments in dict(_moments(scene, path.stem).values()).items():
        rows = ("curvature moment", "(1/m) (N m)", "0 0", *(f"{kappa!r} {M!r}" for kappa, M in moments))
        write_text(path.with_name(name), "\n".join(rows), "A MoorDyn file")
    for name, text in flow_files(scene).items():
        write_text(path.with_name(name), text, "A MoorDyn file")
    for (curve, working), name in _curves(scene, path.stem).items():
        rows = ("strain tension", "(-) (N)", "0 0", *(f"{strain!r} {tension!r}" for strain, tension in curve))
        if working is not None:
            write_text(path.with_name(syrope_name(name)), syrope_text(working, name), "A MoorDyn file")
            rows = ("the original curve of a polyester rope", *rows)  # MoorDyn passes over three lines
        write_text(path.with_name(name), "\n".join(rows), "A MoorDyn file")  # MoorDyn takes no empty last line


def _seafloor(scene: Scene) -> Any:
    """The `GroundMap` of a scene, or None."""
    return next((effect for effect in scene.effects if _name(effect) == "ground_map"), None)


def _curves(scene: Scene, stem: str) -> dict[Any, str]:
    """Name of the file of each tension-strain curve, by `curve_of` its cables."""
    curves = dict.fromkeys(curve_of(cable) for cable in scene.cables if cable.tension_strain is not None)
    return {curve: f"{stem}_curve{number}.txt" for number, curve in enumerate(curves, start=1)}


def _moments(scene: Scene, stem: str) -> dict[str, tuple[str, Any]]:
    """Name of the file and curve of moments, by the names of the cables that have one."""
    effect: Any = next((effect for effect in scene.effects if _name(effect) == "moment_curvature"), None)
    curves = {} if effect is None else dict(effect.curves)
    numbers = {curve: number for number, curve in enumerate(dict.fromkeys(curves.values()), start=1)}
    return {cable: (f"{stem}_moments{numbers[curve]}.txt", curve) for cable, curve in curves.items()}


def moordyn_text(
    scene: Scene, options: Mapping[str, Any] | None = None, places: Mapping[str, Any] | None = None, stem: str = "deck"
) -> str:
    """Return the text of a MoorDyn v2 input file; as `save_moordyn`.

    Parameters
    ----------
    places : dict of point name to (3,) array_like [m]
        Where points start, in place of `at` or of the start of a path.
    stem : str
        Tension-strain curves are taken to be in the files "stem_curve1.txt" and so on, those of moments in "stem_moments1.txt", a
        `GroundMap` in "stem_seafloor.txt".
    """
    if scene.payload_changes:
        raise SceneError(
            f"A scene must have no payloads that change to be written for MoorDyn, but it has {shown(scene.payload_changes[0])}."
        )
    places = _places(scene, places or {})
    environment = _environment(scene, max((abs(float(at[2])) for at in places.values()), default=0.0))
    given = {_name(effect): effect for effect in scene.effects}
    bends = "bending" in given
    curves, moments = _curves(scene, stem), _moments(scene, stem)
    rows = [" ".join((_type(one, bends, curves, moments), *map(repr, shedding_columns(scene.cables, one)))) for one in scene.cables]
    sheds = any(cable.Cl for cable in scene.cables)
    types = {row: f"type{number}" for number, row in enumerate(dict.fromkeys(rows), start=1)}
    of_bodies, left_out = body_points(scene), {*pins(scene), *(event.point for event in scene.releases)}
    points = [point for point in scene.points if point.name not in left_out]
    number: dict[str, Any] = {name: i for i, name in enumerate([*(point.name for point in points), *of_bodies], start=1)}
    number |= rod_ends(scene)
    number |= {event.point: number[event.holder] for event in scene.releases}
    lines = [
        "--------------------- MoorDyn Input File ---------------------",
        "written by anet-lumped",
        "--------------------- LINE TYPES ---------------------",
        "TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx" + (" Cl dF cF" if sheds else ""),
        "(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)" + (" (-) (-) (-)" if sheds else ""),
        *(f"{name} {row}" for row, name in types.items()),
        *body_rows(scene),
        "--------------------- POINTS ---------------------",
        "ID Type X Y Z Mass Volume CdA Ca",
        "(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)",
        *(f"{number[point.name]} {_point(point, places[point.name])}" for point in points),
        *(f"{number[name]} {row}" for name, row in of_bodies.items()),
        "--------------------- LINES ---------------------",
        "ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs",
        "(#) (name) (#) (#) (m) (-) (-)",
        *(
            f"{i} {types[row]} {number[cable.start]} {number[cable.end]} {cable.length!r} {cable.segments} -{named(cable.name)}"
            for i, (cable, row) in enumerate(zip(scene.cables, rows, strict=True), start=1)
        ),
        *_failures(scene, number),
        *syrope_rows(scene),
        *load_rows(scene, given, number),
        "--------------------- OPTIONS ---------------------",
        *(f"{value} {name}" for name, value in (options or {}).items()),
        *(f"{value!r} {name}" for name, value in environment.items()),
        *([f"{stem}_seafloor.txt SeafloorFile"] if _seafloor(scene) else []),
        "--------------------- OUTPUTS ---------------------",
        "--------------------- need this line ---------------------",
    ]
    return "\n".join(lines) + "\n"


def _failures(scene: Scene, number: Mapping[str, int]) -> list[str]:
    """Section of the lines that are cut or released, which MoorDyn's Fortran version parts at their ends; none without."""
    rows = []
    for row, cut in enumerate(scene.cable_cuts, start=1):
        cable = scene.cable(cut.cable)
        at_end = cut.segment % cable.segments == cable.segments - 1
        if not at_end and cut.segment % cable.segments:
            raise SceneError(
                f"A cable must be cut at an end to be written for MoorDyn, but of {quoted(cut.cable)} segment {cut.segment} is."
            )
        point = number[cable.end if at_end else cable.start]
        rows.append(f"{row} {point} {scene.cable_numbers[cut.cable] + 1} {_when(cut.t)} 0")
    for row, event in enumerate(scene.releases, start=len(rows) + 1):
        held = scene.point(event.point)
        if isinstance(held, Free) and (held.mass or held.volume or held.CdA):
            raise SceneError(
                f"A point that is released must carry nothing to be written for MoorDyn, but {quoted(event.point)} does."
            )
        lines = [str(k) for k, cable in enumerate(scene.cables, start=1) if event.point in (cable.start, cable.end)]
        rows.append(f"{row} {number[event.holder]} {','.join(lines)} {_when(event.t)} {event.tension or 0.0!r}{named(event.point)}")
    title, names = "--------------------- FAILURE ---------------------", "FailureID Point Line(s) FailTime FailTen"
    heads = (title, names, "() () (,) (s or 0) (N or 0)")
    return [*heads, *rows] if rows else []


def _when(t: float | None) -> str:
    """A time of a failure [s], of which 0 means never."""
    return repr(0.0 if t is None else t or AT_ONCE)


def _type(cable: Cable, bends: bool, curves: dict[Any, str], moments: dict[str, tuple[str, Any]]) -> str:
    """Columns of a line type, but for its name."""
    if cable.compression == "linear" or cable.EA_compression:
        raise SceneError(
            'A cable must have compression="damped" or "none" to be written for MoorDyn, whose springs do not push, but cable '
            f'{quoted(cable.name)} has "{cable.compression}" and EA_compression={cable.EA_compression}.'
        )
    if cable.inextensible:
        raise SceneError(f"A cable must have a finite `EA` to be written for MoorDyn, but cable {quoted(cable.name)} has EA=inf.")
    if cable.breaking_tension is not None:
        raise SceneError(
            f"A cable must have no `breaking_tension` to be written for MoorDyn, but cable {quoted(cable.name)} has "
            f"breaking_tension={cable.breaking_tension}."
        )
    diameter = NO_DIAMETER if cable.diameter is None else cable.diameter
    damping = -cable.zeta if cable.BA is None else cable.BA
    EA = repr(cable.EA) if cable.tension_strain is None else curves[curve_of(cable)]
    of_damping = repr(damping or 0.0)
    if cable.working_curve is not None:
        EA = f"{PREFIX}{syrope_name(EA)}|{cable.EA_dynamic!r}|{cable.EA_dynamic_per_tension!r}"
        of_damping = f"{cable.BA_creep!r}|{cable.axial_viscosity!r}"
    elif cable.creeps:
        EA += "".join(f"|{x!r}" for x in (cable.EA_dynamic, cable.EA_dynamic_per_tension) if x)
        of_damping = f"{cable.BA_creep!r}|{cable.axial_viscosity!r}"
    EI = moments[cable.name][0] if cable.name in moments else repr(cable.EI if bends else 0.0)
    numbers = (cable.Cdn, cable.Can, cable.Cdt, cable.Cat)
    return " ".join((repr(diameter), repr(cable.mass_per_length), EA, of_damping, EI, *map(repr, numbers)))


def _point(point: Point, at: Any) -> str:
    """Columns of a point, but for its number."""
    x, y, z = map(float, at)
    if isinstance(point, Fixed | Driven):
        return f"{'Fixed' if isinstance(point, Fixed) else 'Coupled'} {x!r} {y!r} {z!r} 0 0 0 0{named(point.name)}"
    load = f"{point.mass!r} {point.volume!r} {point.CdA!r} {point.Ca!r}"
    return f"Free {x!r} {y!r} {z!r} {load}{named(point.name)}"


def _places(scene: Scene, given: Mapping[str, Any]) -> dict[str, Any]:
    """Where each point starts: as given, else on its path or at its place, else where it rests."""
    places: dict[str, Any] = {}
    for point in scene.points:
        places[point.name] = given.get(point.name, point.path.at(0.0)[0] if isinstance(point, Driven) else point.at)
    places |= {event.point: places.get(event.holder, (0.0, 0.0, 0.0)) for event in scene.releases}
    without = [name for name, at in places.items() if at is None]
    if without:
        from anet_lumped.statics.equilibrium import EquilibriumError, equilibrium

        try:
            rest = equilibrium(scene)
        except EquilibriumError as error:
            raise SceneError(
                f"A free point must have a place to be written for MoorDyn, but {quoted(without[0])} has no `at`, "
                f"and no rest: {error}"
            ) from None
        places |= {name: rest.position(name) for name in without}
    return places


def _name(effect: Any) -> str | None:
    from anet_lumped.effects import REGISTRY

    return REGISTRY.name_of(effect)


def _environment(scene: Scene, far: float) -> dict[str, float]:
    """Options that stand for the effects of a scene, whose points start no farther from z=0 than ``far`` [m]."""
    given: dict[str | None, Any] = {_name(effect): effect for effect in scene.effects}
    for name, effect in given.items():
        if name not in WRITTEN:
            raise SceneError(f"A scene must have no {type(effect).__name__} to be written for MoorDyn, which has no such effect.")
    clamps = [one for name in ("bending", "moment_curvature") for one in dict(getattr(given.get(name), "clamped", ()))]
    if clamps:
        raise SceneError(f"Bending must clamp nothing to be written for MoorDyn, but it clamps point {quoted(clamps[0])}.")
    x, y, z = scene.gravity.tolist()
    if x or y or z > 0.0:
        raise SceneError(f"Gravity must point along -z to be written for MoorDyn, but the scene's acceleration is {(x, y, z)}.")
    bottoms = [type(given[name]).__name__ for name in ("ground", "ground_map", "moordyn_bottom") if name in given]
    if len(bottoms) > 1:
        raise SceneError(f"A scene must have one bottom to be written for MoorDyn, but it has {' and '.join(bottoms)}.")
    water, ground = given.get("water"), given.get("ground", given.get("moordyn_bottom"))
    if water is not None:
        if water.level != 0.0:
            raise SceneError(f"Water must have level=0 to be written for MoorDyn, but it has level={water.level}.")
        if water.g not in (None, -z):
            raise SceneError(f"Water must have the g of Gravity, {-z:g} m/s2, to be written for MoorDyn, but it has g={water.g}.")
    options = {"g": -z + 0.0, "rho": 0.0 if water is None else water.density}
    if "ground_map" in given:
        if water is not None and water.all_waves:
            raise SceneError("Waves must be over a flat bottom to be written for MoorDyn, but the scene has a GroundMap.")
        options |= {} if water is None else flow_options(water, None)
        ground, friction = given["ground_map"], friction_options(given, given["ground_map"])
        return options | {"kBot": ground.stiffness, "cBot": ground.damping} | friction
    friction = friction_options(given, ground)
    if ground is None:
        reach = far + math.fsum(cable.length for cable in scene.cables)
        options |= {"WtrDpth": max(NO_BOTTOM, 2.0 * reach), "kBot": 0.0, "cBot": 0.0}
        return options | ({} if water is None else flow_options(water, None))
    if ground.height > 0.0:
        raise SceneError(f"The ground must lie at or below z=0 to be written for MoorDyn, but it has height={ground.height}.")
    options |= {"WtrDpth": -ground.height + 0.0, "kBot": ground.stiffness, "cBot": ground.damping} | friction
    options |= {} if water is None else flow_options(water, options["WtrDpth"])
    if "moordyn_bottom" not in given:
        return options
    static = {} if ground.static_ratio == 1.0 else {"StatDynFricScale": ground.static_ratio}
    return options | {"FricDamp": ground.friction_damping} | static
