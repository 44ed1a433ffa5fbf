"""The environment of a MoorDyn file as effects: gravity, water, bottom and bending, as far as it has them.

`g` is Gravity, `rho` is Water (none for 0), `WtrDpth`, `kBot`, `cBot` and `FrictionCoefficient` are the bottom (none if `kBot` and
`cBot` are 0), and an `EI` brings Bending, clamped at the ends of rods that are held. Waves and currents are those of
`moordyn_flow` and `moordyn_water_file`. Values that are left out are MoorDyn's. As in MoorDyn, no fixed or coupled point lies below
the bottom: it is as deep as the deepest of them. A bottom that is not flat (`moordyn_seafloor`) is a `GroundMap`, as it is.

Three things mean one thing to MoorDyn and another here: what the damper of the bottom does to a node that rises, how friction grows
with the speed, and whether points float. `like_moordyn` takes MoorDyn's: `MoordynBottom` for `Ground`, and `points_float=False`.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from anet_lumped.checks import quoted
from anet_lumped.scene.body import Body
from anet_lumped.scene.scene import Driven, Fixed, Free

from .moordyn_flow import read_flow
from .moordyn_line_types import Tables, moment_curves
from .moordyn_lines import Line, type_of
from .moordyn_options import FRICTIONS, Options
from .moordyn_points import OnMovingBody, Places
from .moordyn_rows import Row, made
from .moordyn_seafloor import Seafloor
from .moordyn_water_file import read_water_file

OTHER = "; read_moordyn(..., like_moordyn=True) takes MoorDyn's."


def read_effects(
    options: Options,
    places: Places,
    bodies: Iterable[Body],
    lines: Iterable[Line],
    types: Mapping[str, tuple[Row, dict[str, Any]]],
    tables: Tables,
    *,
    like_moordyn: bool,
    seafloor: Seafloor | None = None,
) -> list[Any]:
    """Return the effects of a file.

    Parameters
    ----------
    options : Options
    places : Places
    bodies : iterable of Body
        Those that move by themselves.
    lines : iterable of Line
    types : dict
        Row and cable fields of each line type.
    tables : Tables
        Where the tables of waves and currents are.
    like_moordyn : bool
        Whether MoorDyn's laws are taken where they are others than this package's.
    seafloor : Seafloor or None
        Of a bottom that is not flat.
    """
    findings, effects = options.findings, []
    if options.value("g"):
        with findings.refusing():
            effects.append(_effect("gravity", options.row("g"), g=options.value("g")))

    def depth() -> float:
        return _depth(options, places)

    flow = read_flow(options, depth, tables.folder) | read_water_file(options, depth, tables)
    if flow and not options.value("rho"):
        findings.remark("No use is made of waves and currents: rho is 0.")
    if options.value("rho"):
        floating = any(isinstance(point, Free) and (point.volume or point.CdA) for point in places.points.values())
        floating |= any(body.loaded_points for body in bodies)
        with findings.refusing():
            law = {"points_float": False} if like_moordyn else {}
            effects.append(_effect("water", options.row("rho"), density=options.value("rho"), **law, **flow))
        kinds = ("Points with a volume or a CdA", floating), ("Bodies with a volume", any(body.volume for body in bodies))
        for kind, float_at_surface in kinds:
            if float_at_surface and not like_moordyn:
                findings.remark(f"{kind} float at the surface, where MoorDyn has them under water always{OTHER}")
    lines, bodies = list(lines), list(bodies)
    touches = bool(lines) or any(body.rods for body in bodies)
    if not touches and seafloor is not None:
        findings.unused("SeafloorFile", seafloor.row.line, "a bottom that nothing touches")
    if touches and (options.value("kBot") or options.value("cBot")):
        with findings.refusing():
            effects.append(_bottom(options, places, like_moordyn, seafloor))
            effects += _frictions(options, places, like_moordyn, seafloor)
    curves, of_curve = moment_curves(((type_of(line.row), line.cable.name) for line in lines), types, tables, findings)
    stiff = [line.row for line in lines if line.cable.EI]
    if stiff or curves:
        with findings.refusing():
            clamps = _clamps(places, [line for line in lines if line.cable.EI or line.cable.name in curves])
            curved = {end for line in lines if line.cable.name in curves for end in (line.cable.start, line.cable.end)}
            if stiff:
                effects.append(_effect("bending", stiff[0], clamped={of: to for of, to in clamps.items() if of not in curved}))
            if of_curve is not None:
                clamped = {of: to for of, to in clamps.items() if of in curved}
                effects.append(_effect("moment_curvature", of_curve, curves=curves, clamped=clamped))
    return effects


def _clamps(places: Places, lines: Iterable[Line]) -> dict[str, Any]:
    """Directions at the ends of rods of lines with an EI, which MoorDyn clamps there in line with the rod (Rod::addLine)."""
    clamps: dict[str, Any] = {}
    joined: dict[str, int] = {}
    for line in lines:
        for end in line.ends:
            point = places.points[end]
            if end in places.smooth and point is not None:
                joined[point.name] = joined.get(point.name, 0) + 1
                if joined[point.name] == 2:  # said once
                    line.row.findings.remark(
                        f"Line {line.row.line}: lines with an EI may meet at an angle at {quoted(point.name)}, a rod without a "
                        "length, where MoorDyn joins them without a kink."
                    )
            if end not in places.leaves:
                continue
            if isinstance(point, OnMovingBody):
                line.row.findings.remark(
                    f"Line {line.row.line}: {quoted(line.cable.name)} turns freely about the end of a rod that moves, where "
                    "MoorDyn clamps a line with an EI."
                )
            elif isinstance(point, Fixed | Driven):
                if point.name in clamps:
                    raise line.row.error("the end of a rod must clamp one line with an EI, but two of them end there.")
                clamps[point.name] = places.leaves[end]
                if isinstance(point, Driven):
                    line.row.findings.remark(
                        f"Line {line.row.line}: {quoted(line.cable.name)} is clamped at the end of a rod, whose direction stays "
                        "that of the file however a platform turns."
                    )
    return clamps


def _bottom(options: Options, places: Places, like_moordyn: bool, seafloor: Seafloor | None) -> Any:
    """The bottom, by this package's law or by MoorDyn's."""
    findings, friction, scale = options.findings, options.value("FrictionCoefficient"), options.value("StatDynFricScale")
    numbers = {"stiffness": options.value("kBot"), "damping": options.value("cBot"), "friction": friction}
    other = OTHER if seafloor is None else "."
    if seafloor is None:
        numbers["height"] = -_depth(options, places)
    if not numbers["stiffness"]:
        findings.remark(
            "The bottom has a kBot of 0: what lies on it sinks on against its damper, as by MoorDyn, and a rest is that without a "
            "bottom."
        )
    row = options.row("kBot", "cBot")
    if seafloor is not None and like_moordyn:
        raise seafloor.row.error("a bottom that is not flat has this package's law alone; it must be read without like_moordyn.")
    if like_moordyn:
        return _effect("moordyn_bottom", row, **numbers, friction_damping=options.value("FricDamp"), static_ratio=scale)
    if options.value("cBot"):
        findings.remark(f"The damper of the bottom never pulls, where MoorDyn's holds back nodes that rise{other}")
    if friction:
        findings.remark(
            f"Friction on the bottom is {friction:g} of the load at any speed, where MoorDyn's grows with it, {friction:g} times "
            f"FricDamp = {options.value('FricDamp'):g} N s/m a node"
            + (f", to {scale:g} of that before it slips, StatDynFricScale" if scale != 1.0 else "")
            + other
        )
    if seafloor is not None:
        findings.remark(
            f"Line {seafloor.row.line}: the bottom presses along its normal, where that of MoorDyn's C++ version presses along z "
            "on any slope: a line that lies along a slope without friction is drawn by its weight here."
        )
        return _effect("ground_map", seafloor.row, x=seafloor.x, y=seafloor.y, heights=seafloor.heights, **numbers)
    return _effect("ground", row, **numbers)


def _frictions(options: Options, places: Places, like_moordyn: bool, seafloor: Seafloor | None) -> list[Any]:
    """Friction of the Fortran version that differs along and across a line, in a list; MoorDyn's C++ version passes over it."""
    across, along = (float(options.values.get(name, 0.0)) for name in FRICTIONS)
    if across == along:
        return []
    row = options.rows.get("MU_KT") or options.rows["MU_KA"]
    if like_moordyn:
        options.findings.unused("MU_KT and MU_KA", row.line, "friction that differs along and across, as by MoorDyn's C++ version")
        return []
    if not options.value("kBot"):
        options.findings.unused("MU_KT and MU_KA", row.line, "friction on a bottom that carries nothing")
        return []
    options.findings.remark(
        f"Friction on the bottom is {across:g} of the load across a line and {along:g} along it at any speed, where that of "
        "MoorDyn's Fortran version grows with the speed, by CV; its C++ version has none."
    )
    of_both = {"along": along, "across": across, "stiffness": options.value("kBot")}
    if seafloor is not None:
        return [_effect("cable_friction_map", row, x=seafloor.x, y=seafloor.y, heights=seafloor.heights, **of_both)]
    return [_effect("cable_friction", row, height=-_depth(options, places), **of_both)]


def _depth(options: Options, places: Places) -> float:
    """Depth of the bottom [m]: as given, but not less than that of the deepest point that does not move freely."""
    given = options.value("WtrDpth") if "WtrDpth" in options.rows else None
    held = [-at[2] for number, at in places.at.items() if _counts(places, number, given)]
    deepest = max(0.0, *held) if held else 0.0
    if given is None:
        return deepest
    if deepest > given:
        options.findings.remark(
            f"The bottom, WtrDpth = {given:g} m, lies above a point that is held at {deepest:g} m; it is taken at {deepest:g} m, "
            "as by MoorDyn."
        )
    return max(given, deepest)


def _counts(places: Places, number: int | str, given: float | None) -> bool:
    """Whether a point is one that the bottom is not above."""
    point = places.points[number]
    return isinstance(point, Fixed | Driven) or (given is None and isinstance(point, Free))


def _effect(name: str, row: Row, **arguments: Any) -> Any:
    from anet_lumped.effects import REGISTRY

    return made(row, REGISTRY[name], **arguments)
