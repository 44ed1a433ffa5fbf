"""A run in one netCDF file: its arrays, and its scene and account as attributes."""

import json
from dataclasses import asdict
from os import PathLike
from typing import Any

from anet_lumped.results.energy_balance import COLUMNS, UNDIVIDED
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict


def write(run: Any, path: str | PathLike[str]) -> None:
    """Write a run, its scene and its account."""
    import xarray as xr

    columns = list(COLUMNS if run.energy.shape[1] == len(COLUMNS) else UNDIVIDED)
    account = {
        "scene": json.dumps(scene_to_dict(run.scene)),
        "work": json.dumps(asdict(run.work)),
        "warnings": json.dumps(run.warnings),
        "method": run.method,
        "dt": run.dt,
        "reason": run.reason,
        "status": run.status,
        "message": run.message,
        "wall_time": run.wall_time,
        "audit": json.dumps(asdict(run.audit) if run.audit else None),
        "events": json.dumps([asdict(event) for event in run.events]),
        "extrapolated": int(run.extrapolated),
        "kept": json.dumps(run.kept),
    }
    arrays: dict[str, Any] = {
        "q": (("t", "node", "axis"), run.q, {"units": "m", "long_name": "place"}),
        "v": (("t", "node", "axis"), run.v, {"units": "m/s", "long_name": "velocity"}),
        "tension": (("t", "segment"), run.segment_tension, {"units": "N"}),
        "energy": (("t", "energy_of"), run.energy, {"units": "J"}),
    }
    if run.error_growth is not None:
        arrays["error"] = ("t", run.error_growth, {"units": "m", "long_name": "what the steps left out of places"})
    xr.Dataset(
        arrays,
        coords={"t": ("t", run.t, {"units": "s"}), "axis": list("xyz"), "energy_of": columns},
        attrs=account,
    ).to_netcdf(path, engine="scipy")


def read(path: str | PathLike[str]) -> dict[str, Any]:
    """Read what `write` wrote.

    Returns
    -------
    dict
        The fields of a run; of its model the scene, and its work, audit and events as plain dicts.
    """
    import xarray as xr

    with xr.open_dataset(path, engine="scipy") as data:
        account = data.attrs
        return {
            "model": scene_from_dict(json.loads(account["scene"])),
            "t": data["t"].values.copy(),
            "q": data["q"].values.copy(),
            "v": data["v"].values.copy(),
            "energy": data["energy"].values.copy(),
            "segment_tension": data["tension"].values.copy(),
            **{name: str(account[name]) for name in ("method", "reason", "status", "message")},
            **{name: float(account[name]) for name in ("dt", "wall_time")},
            "error_growth": data["error"].values.copy() if "error" in data else None,
            "work": json.loads(account["work"]),
            "warnings": tuple(json.loads(account["warnings"])),
            "audit": json.loads(account["audit"]),
            "events": json.loads(account["events"]),
            "kept": json.loads(account.get("kept", "null")),
            "extrapolated": bool(account.get("extrapolated", False)),  # a file of version 0.1 does not say
        }
