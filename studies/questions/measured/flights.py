"""Two drones that carry a payload on two cables: measured places, the model driven by the drones' places, and a guess at rest.

The public logs of the flights are in IMRCLab/col-trans on GitHub (MIT licence), (c) 2022 Intelligent Multi-Robot Coordination Lab,
TU Berlin. A file here is one flight as CSV: t [s], places of drone 1, of drone 2 and of the payload [m], ten columns, after lines
that begin with #. Its name begins with the kind of flight, as in fast_01.csv.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from anet_lumped import Cable, Driven, Free, Scene, paths, simulate
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity, ViscousDamping

COLUMNS = 10
LEFT_OUT = ("slow_34",)  # the clocks of both logs differ by more than the motion tells apart: 13 mm
PAYLOAD, CABLE_MASS, EA, SEGMENTS = 0.010, 1e-3, 500.0, 4  # [kg], [kg/m], [N]
STEP, SAVED = 2.5e-3, 1e-2  # [s]
DAMPINGS = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0)  # [1/s] of which one is fitted
FITTED, HELD = "fitted", "held back"


@dataclass(frozen=True)
class Flight:
    """Times (k,) [s]; places of both drones (2, k, 3) and of the payload (k, 3) [m]; both cables' lengths [m]."""

    t: np.ndarray
    drones: np.ndarray
    payload: np.ndarray
    lengths: np.ndarray


def files(folder: str | Path) -> list[tuple[Path, str, str]]:
    """Flights in a folder: file, kind, and whether it is FITTED or HELD back, in turns within each kind.

    Raises
    ------
    InputError : a folder without flights
    """
    found = [file for file in sorted(Path(folder).glob("*.csv")) if file.stem not in LEFT_OUT]
    if not found:
        raise InputError(f"The folder of measured flights must hold a CSV file for each, but {folder} has none.")
    kinds = [file.stem.split("_")[0] for file in found]
    turns = [kinds[:k].count(kind) % 2 for k, kind in enumerate(kinds)]
    return [(file, kind, HELD if turn else FITTED) for file, kind, turn in zip(found, kinds, turns, strict=True)]


def read(file: str | Path) -> Flight:
    """Read one flight; the length of a cable is the median of the distances that were measured.

    Raises
    ------
    InputError : no ten columns of numbers, or times that do not grow
    """
    try:
        table = np.loadtxt(file, delimiter=",", ndmin=2)
    except ValueError as error:
        raise InputError(f"A measured flight must be a table of numbers in CSV, but {file}: {error}.") from None
    if table.shape[1] != COLUMNS or len(table) < 2 or not np.isfinite(table).all() or (np.diff(table[:, 0]) <= 0.0).any():
        raise InputError(
            f"A measured flight must have {COLUMNS} finite columns (time, and x, y, z of two drones and of the payload) and times "
            f"that grow, but {file} has {table.shape[1]} columns and {len(table)} rows."
        )
    drones, payload = np.array([table[:, 1:4], table[:, 4:7]]), table[:, 7:10]
    lengths = np.median(np.linalg.norm(payload - drones, axis=2), axis=1)
    return Flight(table[:, 0] - table[0, 0], drones, payload, lengths)


def scene(flight: Flight, damping: float) -> Scene:
    """The payload on two cables whose upper ends go where the drones were measured; velocities are damped at a rate [1/s]."""
    points = [Driven(f"drone{k + 1}", paths.samples(flight.t, places)) for k, places in enumerate(flight.drones)]
    cables = [
        Cable(point.name, "payload", length=float(length), mass_per_length=CABLE_MASS, EA=EA, segments=SEGMENTS)
        for point, length in zip(points, flight.lengths, strict=True)
    ]
    return Scene([*points, Free("payload", mass=PAYLOAD)], cables, [Gravity(9.81), ViscousDamping(damping)])


def guess(flight: Flight) -> np.ndarray:
    """Where the payload would rest: the lowest point of the circle that both cables allow it, (k, 3) [m]."""
    a, b = flight.drones
    span = np.linalg.norm(b - a, axis=1)
    along = (b - a) / span[:, None]
    foot = (flight.lengths[0] ** 2 - flight.lengths[1] ** 2 + span**2) / (2.0 * span)
    radius = np.sqrt(np.maximum(flight.lengths[0] ** 2 - foot**2, 0.0))
    down = np.array([0.0, 0.0, -1.0]) + along[:, 2:] * along
    return a + foot[:, None] * along + radius[:, None] * down / np.linalg.norm(down, axis=1)[:, None]


def payload_distances(file: str | Path, damping: float) -> dict:
    """Rms distance of the payload from where it was measured, of the model and of the guess [mm]."""
    flight = read(file)
    run = simulate(scene(flight, damping), float(flight.t[-1]), method="edmc", dt=STEP, save_every=SAVED)
    seen = np.column_stack([np.interp(run.t, flight.t, axis) for axis in flight.payload.T])
    return {
        "model_rms_mm": _rms(run.position("payload") - seen),
        "guess_rms_mm": _rms(guess(flight) - flight.payload),
        "status": run.status,
        "reason": run.message,
    }


def _rms(distances):
    return 1e3 * float(np.sqrt((distances**2).sum(axis=1).mean()))
