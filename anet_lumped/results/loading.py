"""Saved runs: read, checked against their own scene, and made into a Run."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import cache
from os import PathLike
from typing import Any

import numpy as np

from anet_lumped.checks import NAMED, InputError, number, one_line, shown
from anet_lumped.model.build import build
from anet_lumped.scene.as_dict import scene_from_dict
from anet_lumped.scene.scene import Scene
from integrators import schemes

from . import run_file
from .audit import Audit
from .events import BLOW, BREAK, PAYLOAD, RELEASE, SLACK, TAUT, Event
from .run import FINISHED, STATUSES, Run, Work
from .run_file import DamagedError

OF_VERSION_0_1 = ("error_estimate",)  # attributes that are not written any more
NOT_OF_VERSION_0_1 = ("extrapolated", "kept", "error_factor", "format", "pushed", "peak_at_most")


def load_run(path: str | PathLike[str]) -> Run:
    """Read what `Run.save` wrote, this version or one before it.

    Returns
    -------
    Run

    Raises
    ------
    InputError : no such file, one that is no saved run, is damaged, was changed or was written by a newer version
    """
    try:
        arrays, account = run_file.read(path)
        return _run(arrays, account)
    except DamagedError as why:
        raise InputError(f"A saved run must be as `Run.save` wrote it, but {one_line(str(path), NAMED)}: {why}.") from None


def _run(arrays: Mapping[str, np.ndarray], account: Mapping[str, Any]) -> Run:
    texts = {name: _typed(str, name, account) for name in ("method", "reason", "status", "message")}
    known = {*texts, "scene", "dt", "wall_time", "work", "warnings", "audit", "events", *OF_VERSION_0_1, *NOT_OF_VERSION_0_1}
    for what, name, among in (
        ("attribute", next((name for name in account if name not in known), "scene"), known),
        ("status", texts["status"], STATUSES),
        ("method", texts["method"], schemes.MODULES),
    ):
        if name not in among:
            raise DamagedError(f"its {what} {shown(name)} is unknown")
    numbers = {"error_factor": 1.0} | dict(account)
    for name in ("dt", "wall_time", "error_factor"):
        if not 0 <= number(numbers.get(name)) < math.inf:
            raise DamagedError(f"its `{name}` is {shown(numbers.get(name))}")
    arrays = {"tension": np.zeros((len(arrays["t"]), 0))} | dict(arrays)  # files of scenes without cables have none
    scene = _scene(arrays, account)
    _check_finite(arrays, texts["status"] in FINISHED)
    events = tuple(_records(Event, "events", account))
    for event in events:
        _check_event(event, scene)
    work = _record(Work, "work", account)
    if work is None:
        raise DamagedError("its `work` is missing")
    if ("crept" in arrays) != any(cable.creeps for cable in scene.cables):
        raise DamagedError("it tells how far cables have crept, and none creeps, or it does not, and one does")
    if ("T_max" in arrays) != any(cable.working_curve is not None for cable in scene.cables):
        raise DamagedError("it tells the largest tensions held, and no cable has a working curve, or it does not, and one has")
    try:
        model = build(scene)
    except InputError as error:
        raise DamagedError(f"its scene has no model: {error}".rstrip(".")) from None
    if ("shedding" in arrays) != model.sheds:
        raise DamagedError("it tells the phases of vortices, and no cable sheds any, or it does not, and one does")
    return Run(
        model, arrays["t"], arrays["q"], arrays["v"], arrays["energy"], **texts,
        dt=float(account["dt"]), wall_time=float(account["wall_time"]), segment_tension=arrays["tension"],
        largest_tension=arrays.get("largest_tension"),
        peak_at_most=_read(float | None, "peak_at_most", _typed(str, "peak_at_most", {"peak_at_most": "null"} | dict(account))),
        error_growth=arrays.get("error"), error_factor=float(numbers["error_factor"]),
        crept=arrays.get("crept"), T_max=arrays.get("T_max"), shedding=arrays.get("shedding"), work=work,
        audit=_record(Audit, "audit", account), events=events,
        warnings=_read(tuple[str, ...], "warnings", _typed(str, "warnings", account)),
        extrapolated=bool(account.get("extrapolated", 0)),
        pushed=bool(account.get("pushed", 0)),
        kept=_read(bool | None, "kept", _typed(str, "kept", {"kept": "null"} | dict(account))),
    )  # fmt: skip


def _scene(arrays: Mapping[str, np.ndarray], account: Mapping[str, Any]) -> Scene:
    """The scene, of which the arrays must be: that is known before any model of it is made."""
    try:
        scene = scene_from_dict(json.loads(_typed(str, "scene", account)), source="scene")
    except (ValueError, RecursionError) as error:
        raise DamagedError(f"its scene cannot be read: {error}".rstrip(".")) from None
    segments = sum(cable.segments for cable in scene.cables)
    nodes = segments - len(scene.cables) + len(scene.all_points)
    found = arrays["q"].shape[1], arrays["v"].shape[1], arrays["tension"].shape[1]
    if segments and not found[2]:
        raise DamagedError("it has no `tension`")
    if found != (nodes, nodes, segments):
        raise DamagedError(
            f"its scene has {nodes} nodes and {segments} segments, but its arrays are of {found[0]} nodes and {found[2]} segments"
        )
    cables = arrays["largest_tension"].shape[1] if "largest_tension" in arrays else len(scene.cables)
    if cables != len(scene.cables):
        raise DamagedError(f"its scene has {len(scene.cables)} cables, but its largest tensions are of {cables}")
    return scene


def _check_finite(arrays: Mapping[str, np.ndarray], finished: bool) -> None:
    """Times are finite and increase; what a run that reached its end holds besides is finite too."""
    if not np.isfinite(arrays["t"]).all() or (np.diff(arrays["t"]) < 0.0).any():
        raise DamagedError("its times are not finite, or do not increase")
    for name in ("q", "v", "tension", "largest_tension", "energy", "crept", "T_max", "shedding") if finished else ():
        if name in arrays and not np.isfinite(arrays[name]).all():
            raise DamagedError(f"its run reached its end, but `{name}` is not finite")


def _check_event(event: Event, scene: Scene) -> None:
    """An event is one of those that happen, and at a place that there is."""
    cables = [cable.name for cable in scene.cables]
    points, held = [point.name for point in scene.points], [event.point for event in scene.releases]
    places = {PAYLOAD: points, RELEASE: held, BREAK: cables, SLACK: cables, TAUT: [""], BLOW: [""]}
    right = event.where in places.get(event.kind, ()) and math.isfinite(event.t)
    if right and event.kind == BREAK:
        right = event.tension is not None and event.segment is not None and 0 <= event.segment < scene.cable(event.where).segments
    elif right and event.kind == PAYLOAD:
        right = event.mass is not None
    if not right:
        raise DamagedError(f"its scene has no place for {shown(event)}")


def _typed(kind: type, name: str, account: Mapping[str, Any]) -> Any:
    value = account.get(name)
    if not isinstance(value, kind):
        raise DamagedError(f"its `{name}` is {'missing' if value is None else shown(value)}")
    return value


def _record(kind: type, name: str, account: Mapping[str, Any]) -> Any:
    """A dataclass, or None, from an object in JSON."""
    text = _typed(str, name, account)
    found = _read(kind | None, name, text)
    _check_fields(kind, name, [json.loads(text)])
    return found


def _records(kind: type, name: str, account: Mapping[str, Any]) -> list[Any]:
    """Dataclasses from an array of objects in JSON."""
    text = _typed(str, name, account)
    found = _read(Sequence[kind], name, text)  # type: ignore[valid-type]  # a value, known when it is read
    _check_fields(kind, name, json.loads(text))
    return found


def _check_fields(kind: type, name: str, entries: Sequence[Mapping[str, Any] | None]) -> None:
    """No object has a field that its dataclass lacks: of a field of another name, the default would be taken."""
    known = {field.name for field in fields(kind)}
    if any(key not in known for entry in entries for key in entry or ()):
        raise DamagedError(f"its `{name}` has a field that is unknown")


def _read(kind: Any, name: str, text: str) -> Any:
    """What a text in JSON says, of a type."""
    from pydantic import ValidationError

    try:
        return _adapter(kind).validate_json(text, strict=True)
    except ValidationError as error:
        raise DamagedError(f"its `{name}` cannot be read: {error.errors()[0]['msg']}") from None


@cache
def _adapter(kind: Any) -> Any:
    from pydantic import TypeAdapter

    return TypeAdapter(kind)
