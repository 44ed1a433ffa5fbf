"""A run as one page for a browser, which needs nothing but itself: it turns, plays and is scrubbed there.

The page holds the states as base64 of float32, and three.js to draw them (`templates/three.min.js`; `templates/three.entry.js`
says how to make that). A policy in its head forbids the page to load anything.
"""

import base64
import json
import os
import pathlib
from os import PathLike
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, printable
from anet_lumped.model.body_rotation import quaternions
from anet_lumped.regular_files import check_target, write_text

from . import colours
from .boxes import box_of, poses
from .motion import Motion, kind_of, motion_of, thinned
from .surroundings import Plane, Solid, Surroundings, surroundings
from .verdict import verdict

MOST = 2_900_000  # bytes of a page
SPARE = 100  # bytes, for counts that are longer than those of a page without states
CURVES = 1200  # times of the curves below the scene, which have more points than a screen has columns
TEMPLATES = pathlib.Path(__file__).parent / "templates"


def write_page(run: Any, path: str | PathLike[str]) -> pathlib.Path:
    """Write the page of a run; states are thinned, evenly, until it is no larger than `MOST` bytes.

    Parameters
    ----------
    run : Run
    path : str or pathlib.Path, whose name is the page's title

    Returns
    -------
    path : pathlib.Path

    Raises
    ------
    InputError : no such path, or a run of so many nodes that not even two of its states are small enough
    """
    check_target(path, "A page")
    file = pathlib.Path(os.fsdecode(path))
    text = page_text(run, file.stem)
    write_text(file, text, "A page")
    return file


def page_text(run: Any, title: str, most: int = MOST) -> str:
    """Return the page of a run as HTML of at most so many bytes; as `write_page`."""
    motion = motion_of(run)
    content = _scene(run, motion) | {"title": title, "curves": _curves(motion)}
    empty = _rendered(run, motion, content | _states(run, motion, np.arange(0)), title)
    each = 4 / 3 * 4 * (1 + motion.q[0].size + motion.tension[0].size + 7 * len(run.scene.bodies))  # base64 of float32
    rows = thinned(len(motion.t), int((most - len(empty.encode()) - SPARE) / each))
    text = _rendered(run, motion, content | _states(run, motion, rows), title)
    if len(text.encode()) > most:
        raise InputError(
            f"A page must not have more than {most:.3g} bytes, but two states of this run of {run.model.n} nodes take more; "
            "`save_vtk` has no such limit."
        )
    return text


def _rendered(run: Any, motion: Motion, content: dict[str, Any], title: str) -> str:
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True
    )
    files = {name: (TEMPLATES / name).read_text(encoding="utf-8") for name in (
        "view.css", "three.min.js", "three.license.txt", "stage.js", "strips.js", "player.js"
    )}  # fmt: skip
    return environment.get_template("view.html").render(
        files=files,
        # A name may hold "</script>": as JSON it is the same with the less-than sign escaped.
        content=json.dumps(content, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        title=printable(title),
        ok=run.ok,
        verdict=printable(verdict(run)),
        warnings=[printable(warning) for warning in run.warnings],
        notes=_notes(run, motion, content["shown"]),
        broke=bool(np.isfinite(motion.broken_at).any()),
        kinds=dict.fromkeys(kind_of(point) for point in run.scene.points),
        bodies=len(run.scene.bodies),
        colours=colours,
    )


def _notes(run: Any, motion: Motion, shown: int) -> list[str]:
    """What a reader of the page must know of it."""
    states = len(motion.t)
    notes = [
        f"All {states} saved states are shown."
        if shown == states
        else f"{shown} of {states} saved states are shown, evenly thinned so that the page stays below 3 MB."
    ]
    notes.append("Between two of them the picture goes straight from one to the other.")
    if motion.left_out:
        notes.append(f"{motion.left_out} states are not finite, and left out.")
    if motion.full_scale < motion.tension.max(initial=0.0):
        notes.append(f"1 % of the tensions are above the scale of colours, the largest {_number(motion.tension.max())} N.")
    return notes


def _scene(run: Any, motion: Motion) -> dict[str, Any]:
    """What does not change in time."""
    model, around = run.model, surroundings(run.scene, motion.middle)
    return {
        "ends": model.ends.tolist(),
        "broken_at": [float(t) if np.isfinite(t) else None for t in motion.broken_at],
        "points": [{"name": printable(p.name), "kind": kind_of(p), "node": model.node(p.name)} for p in run.scene.points],
        "bodies": [{"name": printable(body.name), "sides": box_of(body).sides.tolist()} for body in run.scene.bodies],
        "events": [{"t": float(event.t), "text": printable(str(event))} for event in run.events],
        "middle": motion.middle.tolist(),
        "box": motion.box.tolist(),
        "size": motion.size,
        "follow": motion.drifts,
        "full_scale": motion.full_scale,
        "around": _around(around),
        "colours": {"tension": colours.TENSION, "slack": colours.SLACK, "points": colours.POINTS, "body": colours.BODY,
                    "ground": colours.GROUND, "obstacle": colours.OBSTACLE,
                    "water": colours.WATER, "wind": colours.WIND, "current": colours.CURRENT},
    }  # fmt: skip


def _around(around: Surroundings) -> dict[str, Any]:
    wave = around.wave
    return {
        "ground": _plane(around.ground),
        "obstacles": [_solid(solid) for solid in around.obstacles],
        "water": _plane(around.water),
        "wave": None if wave is None else vars(wave) | {"direction": wave.direction.tolist()},
        "flows": [
            {"name": name, "velocity": velocity.tolist(), "text": f"{name} {_number(float(np.linalg.norm(velocity)))} m/s"}
            for name, velocity in (("wind", around.wind), ("current", around.current))
            if velocity is not None
        ],
    }


def _plane(plane: Plane | None) -> dict[str, Any] | None:
    return None if plane is None else {"normal": plane.normal.tolist(), "height": plane.height}


def _solid(solid: Solid) -> dict[str, Any]:
    """Kind, centre, quaternion (x, y, z, w) and widths, None for an infinite one, as three.js takes them."""
    turn = np.roll(quaternions(solid.axes.T), -1)
    widths = [float(width) if np.isfinite(width) else None for width in solid.widths]
    return {"kind": solid.kind, "at": solid.at.tolist(), "turn": turn.tolist(), "widths": widths}


def _states(run: Any, motion: Motion, rows: np.ndarray) -> dict[str, Any]:
    """The states of these rows: how many, and arrays one after the other as base64 of float32.

    Of each body the middle of its box, and a quaternion (x, y, z, w) that turns the box to its place.
    """
    states = {"t": _packed(motion.t[rows]), "q": _packed(motion.q[rows]), "tension": _packed(motion.tension[rows])}
    if run.scene.bodies:
        middles, axes = poses(run, motion.t[rows], motion.q[rows])
        states["bodies"] = _packed(np.concatenate([middles, np.roll(quaternions(axes), -1, axis=-1)], axis=-1))
    return {"shown": len(rows), "states": states}


def _curves(motion: Motion) -> dict[str, Any]:
    """Curves over time: energies, and the largest tension since the point before, so that thinning hides no peak."""
    rows = thinned(len(motion.t), CURVES)
    largest = motion.tension.max(axis=1, initial=0.0)
    peaks = np.maximum.reduceat(largest, np.r_[0, rows[:-1] + 1]) if len(rows) > 1 else largest
    energies = dict(zip(colours.ENERGIES.items(), motion.energy[rows].T, strict=True))
    return {
        "t": _packed(motion.t[rows]),
        "tension": _packed(peaks),
        "energies": [{"name": n, "colour": c, "values": _packed(values)} for (n, c), values in energies.items() if values.any()],
    }


def _packed(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(np.clip(values, -3e38, 3e38), "<f4").tobytes()).decode()


def _number(value: float) -> str:
    return f"{value:.3g}"
