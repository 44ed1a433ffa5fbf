"""TOML ⇄ Scene.

A scene file holds the arguments of the Python classes under the same names::

    [effects.gravity]
    g = 9.81                                 # m/s²

    [effects.air]
    wind = {kind = "power_law", speed = 8.0, height = 10.0, exponent = 0.14}   # or a list of winds, which add up

    [effects.water]
    current = {kind = "sampled", samples = [[-50.0, 0.1, 0.0], [0.0, 0.8, 0.0]]}   # (z, u, v): m, m/s
    wave = {kind = "airy", height = 2.0, period = 8.0}

    [effects.line_change.paid_out]           # by cable; a length [m] as a function of time
    s0-s1 = {kind = "line", start = 0.0, rate = 0.1, ramp = 1.0}

    [[points]]
    name = "s0"
    kind = "fixed"                           # or "free", "driven"
    at = [0.0, 0.0, 0.0]                     # m

    [[points]]
    name = "s1"
    kind = "driven"
    path = {kind = "line", start = [1, 0, 0], velocity = [0.2, 0, 0], ramp = 1.0}

    [cable_defaults]                         # what all cables share, if anything
    EA = 1e4                                 # N

    [[cables]]
    start = "s0"
    end = "s1"
    length = 1.5                             # m
    mass_per_length = 0.1                    # kg/m
    segments = 20
    breaking_tension = 900.0                 # N, if it may break

    [[attach]]                               # if anything sits on a cable
    cable = "s0-s1"
    length = 0.5                             # m, from its start
    name = "clump"
    mass = 0.2                               # kg

    [[tensioned]]                            # if the length of a cable is to follow from its rest
    cable = "s0-s1[1]"
    end_tension = 30.0                       # N; or sag = ..., lowest = ... [m]

    [[events]]                               # if anything happens
    kind = "payload_change"
    point = "p0"
    t = 1.5                                  # s
    mass = 0.0                               # kg

A cable, or cable_defaults, may have `rope = "nylon"` and the nominal `diameter` [m] of that rope (module `ropes`) in place of
`mass_per_length` and `EA`; what is given besides overrules what the rope says.

`anet_lumped.scene.as_dict` checks and makes what such a file holds. A file that ends in .txt, .dat or .moordyn is MoorDyn's
(`moordyn_file`).
"""

import os
import pathlib
import re
import tomllib
from dataclasses import asdict, dataclass
from os import PathLike
from typing import Any

from anet_lumped.checks import NAMED, InputError, SceneError, nearest, one_line, quoted, shown
from anet_lumped.regular_files import check_target, read_text, write_text
from anet_lumped.scene.as_dict import DEEPEST, made_from_tables, scene_from_dict, scene_to_dict
from anet_lumped.scene.scene import Scene

MOORDYN = (".txt", ".dat", ".moordyn")
LONG_KEY = re.compile(  # a.b.c. and so on, of bare or quoted parts: the time that TOML takes grows with the square of their number
    rf"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{DEEPEST}}}"""
)
SCENES = pathlib.Path(__file__).parents[1] / "scenes"  # that come with this package


def load_scene(path: str | PathLike[str]) -> Scene:
    """Read a scene from a TOML file, from a MoorDyn input file by its ending, or by its name one that comes with this package.

    Raises
    ------
    SceneError : no such file, one that is no UTF-8 text, no valid TOML, or a scene that `scene_from_dict` refuses; names the file
        and the place
    """
    if not isinstance(path, str | PathLike):
        raise SceneError(f"A scene file must be given by its path, but it is {shown(path)}.")
    path = pathlib.Path(path)
    if path.suffix.lower() != ".toml" and not os.path.isfile(path):
        bundled = {file.stem: file for file in SCENES.glob("*.toml")}
        if path.suffix.lower() not in MOORDYN and str(path) not in bundled:
            hint = nearest(str(path), bundled) or f"; the scenes that come with this are {', '.join(sorted(bundled))}."
            raise SceneError(f"There is no scene and no file {quoted(str(path))}{hint}")
        path = bundled.get(str(path), path)
    if path.suffix.lower() in MOORDYN:
        from .moordyn_file import read_moordyn

        return read_moordyn(path).scene
    text = read_text(path, "A scene file", SceneError)
    named = one_line(str(path), NAMED)
    if LONG_KEY.search(text):
        raise SceneError(f"A scene file must not nest deeper than {DEEPEST} tables, but {named} has a key of more parts.")
    try:
        entries = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"A scene file must be valid TOML, but {named}: {error}.") from None
    except ValueError:
        raise SceneError(f"A scene file must hold numbers, but {named} has an integer of thousands of digits.") from None
    except RecursionError:
        raise SceneError(f"A scene file must not nest deeper than {DEEPEST} tables and arrays, but {named} does.") from None
    return scene_of_entries(entries, one_line(path.name, NAMED))


def scene_of_entries(entries: dict[str, Any], source: str) -> Scene:
    """Return the scene that the entries of a scene file describe, with the lengths that its section `tensioned` asks for.

    Raises
    ------
    SceneError : as of `scene_from_dict`, or no length has what is wanted; names the place
    """
    scene = scene_from_dict({section: entry for section, entry in entries.items() if section != "tensioned"}, source)
    if "tensioned" in entries:
        for wanted, place in made_from_tables("tensioned", Wanted, entries, source):
            scene = wanted.reached_by(scene, place)
    return scene


@dataclass(frozen=True)
class Wanted:
    """What is wanted of the rest of a cable, by its length; arguments as of `tensioned`."""

    cable: str
    sag: float | None = None
    end_tension: float | None = None
    lowest: float | None = None
    at: str | None = None

    def reached_by(self, scene: Scene, place: str) -> Scene:
        """The scene with the length of the cable that has it; errors name the ``place`` where it is asked for."""
        from anet_lumped.statics.equilibrium_error import EquilibriumError  # a file without this section loads no statics
        from anet_lumped.statics.tensioned import tensioned

        try:
            return tensioned(scene, **asdict(self))
        except (InputError, EquilibriumError) as error:
            raise SceneError(f"{place}: {error}") from None


def with_defaults(entries: dict[str, Any]) -> dict[str, Any]:
    """The scene that ``entries`` describe, with what all of its cables have alike said once, as `cable_defaults`."""
    cables = entries["cables"]
    if len(cables) < 2:
        return entries
    first = {key: value for key, value in cables[0].items() if key not in ("start", "end", "name")}
    shared = {key: value for key, value in first.items() if all(key in cable and cable[key] == value for cable in cables)}
    own = [{key: value for key, value in cable.items() if key not in shared} for cable in cables]
    entries = {section: value for section, value in entries.items() if section != "cables"}
    return entries | ({"cable_defaults": shared} if shared else {}) | {"cables": own}


def save_scene(scene: Scene, path: str | PathLike[str]) -> None:
    """Write a scene as a TOML file that `load_scene` reads back as an equal scene, or as a MoorDyn input file by its ending."""
    check_target(path, "A scene")
    if pathlib.Path(path).suffix.lower() in MOORDYN:
        from .moordyn_writer import save_moordyn

        return save_moordyn(scene, path)
    import tomli_w

    text = tomli_w.dumps(with_defaults(scene_to_dict(scene)))
    # tomli_w gives each number of a vector a line of its own; strings hold no bare line ends, so only vectors match.
    text = re.sub(r"\[\n((?: +[-+.\de]+,\n)+) *\]", lambda found: f"[{' '.join(found[1].split())[:-1]}]", text)
    write_text(path, text, "A scene")
