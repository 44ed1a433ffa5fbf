"""A run in one netCDF file: its arrays, and its scene and account as attributes.

Files say which format they have, and a checksum of all that is read of them. Those of version 0.1, and of 0.2 before there was a
checksum, say neither; their shapes, types and names are all that can be checked.
"""

import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import asdict
from os import PathLike
from typing import Any

import numpy as np

from anet_lumped.checks import shown
from anet_lumped.limits import BYTES
from anet_lumped.regular_files import check_target, read_bytes, whole_file
from anet_lumped.results.energy_balance import COLUMNS, UNDIVIDED
from anet_lumped.scene.as_dict import scene_to_dict

from .labelled import LABELS, energy_names, labels

FORMAT = 3  # of the files that are written here; the first had no labels, the second no largest tensions
WHAT = "A saved run"  # for messages
AXES = ["x", "y", "z"]
DIMENSIONS = {
    "t": ("t",), "q": ("t", "node", "axis"), "v": ("t", "node", "axis"), "tension": ("t", "segment"), "energy": ("t", "energy_of"),
    "error": ("t",), "crept": ("t", "segment"), "T_max": ("t", "segment"), "shedding": ("t", "node", "inner"),
    "rotation": ("t", "body", "quaternion"), "largest_tension": ("t", "cable_number"),
}  # fmt: skip


class DamagedError(Exception):
    """Why a file is no saved run, or not any more; within this room."""


def write(run: Any, path: str | PathLike[str]) -> None:
    """Write a run, its scene and its account."""
    import xarray as xr

    check_target(path, "A run")
    columns = list(energy_names(run))
    account = {
        "format": FORMAT,
        "scene": json.dumps(scene_to_dict(run.scene)),
        "work": json.dumps(asdict(run.work)),
        "warnings": json.dumps(run.warnings),
        "method": run.method,
        "dt": float(run.dt),
        "reason": run.reason,
        "status": run.status,
        "message": run.message,
        "wall_time": float(run.wall_time),
        "audit": json.dumps(asdict(run.audit) if run.audit else None),
        "events": json.dumps([asdict(event) for event in run.events]),
        "extrapolated": int(run.extrapolated),
        "kept": json.dumps(run.kept),
        "error_factor": float(run.error_factor),
        "pushed": int(run.pushed),
        "peak_at_most": json.dumps(run.peak_at_most),
    }
    arrays = {"t": run.t, "q": run.q, "v": run.v, "energy": run.energy}
    told = labels(run.model)
    if run.model.n_segments:
        arrays["tension"] = run.segment_tension
    else:  # a dimension of no length means another thing in netCDF-3
        told = {name: one for name, one in told.items() if one[0] != "segment"}
    if run.error_growth is not None:
        arrays["error"] = run.error_growth
    if run.largest_tension is not None and run.scene.cables:
        arrays["largest_tension"] = run.largest_tension
    if run.crept is not None:
        arrays["crept"] = run.crept
    if run.T_max is not None:
        arrays["T_max"] = run.T_max
    if run.shedding is not None:
        arrays["shedding"] = run.shedding
    if run.scene.bodies:
        arrays["rotation"] = np.stack([run.quaternion(body.name) for body in run.scene.bodies], axis=1)
    about: dict[str, dict[str, str]] = {
        "t": {"units": "s"},
        "q": {"units": "m", "long_name": "place"},
        "v": {"units": "m/s", "long_name": "velocity"},
        "tension": {"units": "N"},
        "largest_tension": {"units": "N", "long_name": "largest tension of each cable up to each time, in all steps"},
        "energy": {"units": "J"},
        "rotation": {"units": "1", "long_name": "unit quaternion (w, x, y, z) of each body"},
        "crept": {"units": "m", "long_name": "how far each segment has crept"},
        "T_max": {"units": "N", "long_name": "largest tension that each segment has held for long"},
        "shedding": {"long_name": "phase [rad], f d/U, and mean squares [m2/s2], [m2/s4] of vortices"},
        "error": {"units": "m", "long_name": "what the steps left out of places"},
    }
    variables: dict[str, Any] = {name: (DIMENSIONS[name], array, about[name]) for name, array in arrays.items()}
    dataset = xr.Dataset(
        {name: variable for name, variable in variables.items() if name != "t"},
        coords={"t": variables["t"], "axis": AXES, "energy_of": columns} | told,
        attrs=account | {"checksum": _checksum(arrays, account)},
    )
    with whole_file(path, "A run") as half:
        dataset.to_netcdf(half, engine="scipy")


def read(path: str | PathLike[str]) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Read what `write` wrote.

    Returns
    -------
    arrays : dict of str to float64
        t, q, v, energy and, if there are such, tension, largest_tension, error, crept, T_max and shedding; shapes agree with each
        other.
    account : dict
        The attributes, as text and numbers.

    Raises
    ------
    InputError : no regular file
    DamagedError : no saved run, a damaged one, or one of a newer version
    """
    variables, account = _content(read_bytes(path, WHAT, BYTES))
    form = account.get("format", 0)
    if not isinstance(form, int) or form < 0:
        raise DamagedError(f"its format is {shown(form)}")
    if form > FORMAT:
        raise DamagedError(
            f"it was written by a newer version of anet-lumped, in format {form} where this one reads up to {FORMAT}"
        )
    for name in ("t", "q", "v", "energy", "axis", "energy_of"):
        if name not in variables:
            raise DamagedError(f"it has no `{name}`")
    for name in LABELS:
        variables.pop(name, None)
    columns = _words(variables.pop("energy_of"))
    if _words(variables.pop("axis")) != AXES or columns not in (list(COLUMNS), list(UNDIVIDED)):
        raise DamagedError("its axes or kinds of energy are unknown")
    sizes = {"axis": len(AXES), "energy_of": len(columns)}
    arrays = {}
    for name, (dimensions, array) in variables.items():
        if dimensions != DIMENSIONS.get(name) or array.dtype != ">f8":
            raise DamagedError(f"its variable {shown(name)} is unknown, or not of the dimensions and type that it must have")
        for dimension, size in zip(dimensions, array.shape, strict=True):
            if sizes.setdefault(dimension, size) != size or size == 0:
                raise DamagedError(f"its variable `{name}` has the shape {array.shape}")
        arrays[name] = array.astype(float)
    if form and account.pop("checksum", None) != _checksum(arrays, account):
        raise DamagedError("its checksum is not that of its content, so that it was changed after it was written")
    return arrays, account


class _OnceThrough(io.BytesIO):
    """Bytes that are handed out no more than once: a header may claim sizes, and the same bytes for many arrays."""

    left: int

    def read(self, size: int | None = -1) -> bytes:
        found = super().read(size)
        self.left -= len(found)
        if self.left < 0:
            raise DamagedError("it claims to hold more than it does")
        return found


def _content(content: bytes) -> tuple[dict[str, tuple[tuple[str, ...], np.ndarray]], dict[str, Any]]:
    """Dimensions and array of each variable of a netCDF-3 file, and its attributes."""
    from scipy.io import netcdf_file

    stream = _OnceThrough(content)
    stream.left = len(content)
    try:
        with netcdf_file(stream, mmap=False) as file:
            variables = {name: (tuple(one.dimensions), np.asarray(one.data)) for name, one in file.variables.items()}
            account = {name: _plain(value) for name, value in file._attributes.items()}
    except DamagedError:
        raise
    except Exception:  # of junk, the reader raises whatever its code comes upon
        raise DamagedError("it is no netCDF-3 file, or is cut or damaged") from None
    return variables, account


def _plain(value: Any) -> Any:
    return value.decode() if isinstance(value, bytes) else value.item()


def _words(variable: tuple[tuple[str, ...], np.ndarray]) -> list[str]:
    """Words in an array of characters, a row each."""
    _, letters = variable
    if letters.dtype.kind != "S" or letters.ndim != 2:
        return []
    return [b"".join(row).rstrip(b"\0").decode("ascii", "replace") for row in letters]


def _checksum(arrays: Mapping[str, np.ndarray], account: Mapping[str, Any]) -> str:
    """SHA-256 of the account and of the bytes of the arrays, of whatever machine."""
    found = hashlib.sha256(json.dumps(account, sort_keys=True).encode())
    for name in sorted(arrays):
        found.update(f"{name}{arrays[name].shape}".encode())
        found.update(np.ascontiguousarray(arrays[name], "<f8").data)
    return found.hexdigest()
