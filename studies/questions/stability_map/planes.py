"""What the energy does in each cell of two planes, where the border of each explicit scheme lies, and the thesis's two failures."""

import numpy as np

from anet_lumped.motion.energy_gain import GAINED
from anet_lumped.motion.stability import step_limit, top_modes
from anet_lumped.statics.equilibrium import equilibrium
from integrators import schemes
from studies.sweeping.rows import run_rows
from studies.thesis_cable import (
    FOUND_EA,
    FOUND_K,
    LENGTH,
    REST_GROWTH,
    SEGMENT_MASS,
    SEGMENTS,
    WHIP_RISE,
    disturbed,
    explicit_schemes,
    hung,
    implicit_schemes,
    predicted_step,
    rest_growth,
    whip_rise,
)  # fmt: skip

STEPS = np.geomspace(1e-3, 0.1, 11)  # [s]
STIFFNESSES = np.geomspace(1.0, 1e8, 11)  # EA [N]
DAMPERS = np.geomspace(1e-3, 1e3, 11)  # of a segment [N s/m], beside springs of FOUND_K
BORDER_EA = (FOUND_EA, 100.0, 1e4)  # where the border is measured to BORDER_RESOLUTION [N]
BORDER_DAMPERS = (0.05, 0.2, 2.0)  # [N s/m]
BORDER_STEPS, BORDER_RESOLUTION = 4000, 2e-3
CLOSE = 0.98  # of the largest stable step, where the thesis's cable is put
NUMBERS = ("dt_s", "predicted_s", "rest_growth", "whip_rise")  # columns of a cell
OTHERS = ("rest_at_once", "rest_ended", "whip_ended")
LONG_EA, LONG_TIME = 1e4, 3.0  # [N], [s]: the whip of the schemes that do not damp, just within their border
LONG_SHARES, LONG_ZETAS = (0.5, 0.8, 0.95), (0.0, 0.05)  # of the largest stable step; damping ratios of a segment


def compute(quick=False, executor=None, out=None):
    """The tables."""
    every = 2 if quick else 1
    steps = list(STEPS[::every])
    lines = [
        {"plane": plane, "scheme": scheme, "EA_N": EA, "damper_Ns_per_m": c, "steps": steps}
        for scheme in explicit_schemes() + implicit_schemes()
        for plane, grid in (
            ("stiffness", [(EA, 0.0) for EA in STIFFNESSES[::every]]),
            ("damper", [(FOUND_EA, c) for c in DAMPERS[::every]]),
        )
        for EA, c in grid
    ]
    pairs = [(EA, 0.0) for EA in BORDER_EA[: 1 if quick else None]]
    pairs += [(FOUND_EA, c) for c in BORDER_DAMPERS[:: 2 if quick else 1]]
    borders = [
        {"scheme": scheme, "EA_N": EA, "damper_Ns_per_m": c}
        for scheme in explicit_schemes()
        for EA, c in pairs
        if c > 0 or schemes.scheme(scheme).stable_undamped
    ]
    long = [
        {"scheme": scheme, "share_of_limit": share, "zeta": zeta}
        for scheme in explicit_schemes(stable_undamped=True)
        for share in (LONG_SHARES[1:2] if quick else LONG_SHARES)
        for zeta in LONG_ZETAS
    ]
    planes = run_rows(line_of_cells, lines, executor=executor, out=out and out / "planes")
    planes = planes.drop(columns="steps").explode([*NUMBERS, *OTHERS], ignore_index=True)
    return {
        "planes": planes.astype(dict.fromkeys(NUMBERS, float)),
        "borders": run_rows(border, borders, executor=executor, out=out and out / "borders"),
        "long_whip": run_rows(long_whip, long, executor=executor, out=out and out / "long_whip"),
        "thesis": run_rows(failure, _failures(), executor=executor, out=out and out / "thesis"),
    }


def line_of_cells(row):
    """Cells of one stiffness and damper, for all steps: a list for each of NUMBERS and OTHERS."""
    scheme, EA, c = row["scheme"], row["EA_N"], row["damper_Ns_per_m"]
    # Two-way springs about rest, the thesis's law, are linear in the axial direction, for which the prediction is exact.
    about_rest, loose = hung(EA, c, compression="linear"), hung(EA, c, tip=(LENGTH, 0.0, 0.0))
    start, predicted, explicit = disturbed(about_rest), predicted_step(scheme, about_rest), schemes.scheme(scheme).explicit
    cells = []
    for dt in row["steps"]:
        rest, whip = (np.nan, False, ""), (np.nan, "")
        # An implicit scheme is put to the hard test first; where it fails, rest tells whether small motions grow as well.
        if not explicit:
            whip = whip_rise(loose, scheme, dt)
        if explicit or whip[0] > WHIP_RISE:
            rest = rest_growth(about_rest, scheme, dt, start=start)
        if explicit and rest[0] <= REST_GROWTH:
            whip = whip_rise(loose, scheme, dt)
        cells.append((dt, predicted, rest[0], whip[0], *rest[1:], whip[1]))
    return dict(zip((*NUMBERS, *OTHERS), map(list, zip(*cells, strict=True)), strict=True))


def border(row):
    """Largest stable step of an explicit scheme, by bisection: about rest with springs that push and that do not, whip."""
    scheme, EA, c = row["scheme"], row["EA_N"], row["damper_Ns_per_m"]
    predicted = predicted_step(scheme, hung(EA, c))
    # No axial damper acts on swings, which explicit Euler lets grow at any step: its border is that of axial motion.
    swings = schemes.scheme(scheme).stable_undamped
    axes = (1.0, 1.0, 1.0) if swings else (0.0, 0.0, 1.0)
    found = {}
    for name, compression in (("rest", "linear"), ("rest_one_way", "none")):
        scene = hung(EA, c, compression=compression)
        start = disturbed(scene, axes)
        found[name] = _largest_step(
            lambda dt, scene=scene, start=start: rest_growth(scene, scheme, dt, BORDER_STEPS, start)[0] <= REST_GROWTH,
            predicted,
        )
    if swings:
        loose = hung(EA, c, tip=(LENGTH, 0.0, 0.0))
        found["whip"] = _largest_step(lambda dt: whip_rise(loose, scheme, dt)[0] <= WHIP_RISE, predicted)
    return {"predicted_ms": 1e3 * predicted} | {f"{name}_over_predicted": h / predicted for name, h in found.items()}


def long_whip(row):
    """A longer whip just within the border: rise of energy over what the swing is worth."""
    damper = row["zeta"] * np.sqrt(LONG_EA * SEGMENTS / LENGTH * SEGMENT_MASS)
    loose = hung(LONG_EA, damper, tip=(LENGTH, 0.0, 0.0))
    dt = row["share_of_limit"] * predicted_step(row["scheme"], loose)
    rise, ended = whip_rise(loose, row["scheme"], dt, LONG_TIME)
    return {"dt_s": dt, "whip_rise": rise, "ended": ended}


def _largest_step(stable, about):
    low, high = about / 2, about * 2
    while high / low > 1 + BORDER_RESOLUTION:
        middle = np.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return float(low)


def _failures():
    """The thesis's cable just within the border of each scheme, and what it tried next."""
    rows = []
    for scheme in ("symplectic_euler", "verlet", "rk4", "edmc"):
        dt = min(CLOSE * predicted_step(scheme, hung(FOUND_EA)), 0.01)
        for change, k, c, rate in (
            ("as found", 1.0, 0.0, 0.0),
            ("k × 1.2", 1.2, 0.0, 0.0),
            ("k × 10", 10.0, 0.0, 0.0),
            ("k × 10 and environment 2 /s", 10.0, 0.0, 2.0),
            ("c = m/dt", 1.0, SEGMENT_MASS / dt, 0.0),
            ("c = 10 m/dt", 1.0, 10 * SEGMENT_MASS / dt, 0.0),
        ):
            spring = k * FOUND_K
            rows.append({"scheme": scheme, "dt_s": dt, "change": change, "spring_N_per_m": spring,
                         "damper_Ns_per_m": c, "environment_per_s": rate})  # fmt: skip
    return rows


def failure(row):
    """The thesis's hanging cable with one thing changed: predicted step and damper, and what the energy does."""
    EA, rate = row["spring_N_per_m"] * LENGTH / SEGMENTS, row["environment_per_s"]
    scene = hung(EA, row["damper_Ns_per_m"], compression="linear", rate=rate)
    (mode,) = top_modes(scene).values()
    growth, _, ended = rest_growth(scene, row["scheme"], row["dt_s"])
    return {
        "length_m": equilibrium(scene).length("top-tip"),
        "largest_step_ms": 1e3 * float(step_limit(row["scheme"], mode.omega, mode.zeta, rate)),
        "energy_growth": growth,
        "stable": bool(growth <= REST_GROWTH),
        "ended": ended,
    }


STABLE, RISES, UNSTABLE = 0, 1, 2


def verdict(cells):
    """What the energy says of each cell: STABLE, RISES (in the whip, or at the very start and then falls) or UNSTABLE."""
    grows = (cells["rest_growth"] > REST_GROWTH) & ~cells["rest_at_once"].astype(bool)
    rises = (cells["whip_rise"] > WHIP_RISE) | (cells["rest_growth"] > REST_GROWTH)
    return np.where(grows, UNSTABLE, np.where(rises, RISES, STABLE))


def survived(cells):
    """Whether the run by which a cell failed reached its end all the same."""
    ended = cells["whip_ended"].where(cells["whip_rise"] > WHIP_RISE, cells["rest_ended"])
    return (verdict(cells) != STABLE) & ended.isin(("done", GAINED))
