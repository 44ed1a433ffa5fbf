"""Rows of the study `measured`."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd

from studies.questions.measured import flights, hanging, lindahl
from studies.questions.measured.lindahl import Chain
from studies.sweeping.rows import run_rows

GIVEN, TUNED, FINER, TUNED_FINER = "as given", "fitted at 3.5 s", "as given, finer", "fitted at 3.5 s, finer"
FINEST = {"segments": 160, "steps": 1600}
FITTED_STEPS = {"distance": 5e-3, "Cdn": 0.1}  # differences for the slopes of a fit [m], [1]
FIT_PERIOD = 3.5  # [s], the only one that anything is fitted to
FIT_CYCLES, FIT_FOLDED = 6, 2  # cycles of the runs of a fit, and those that are folded
FIT_SEGMENTS = {TUNED: 40, TUNED_FINER: 80}  # of the chain that is fitted
ROUNDS = {True: 1, False: 2}  # of a fit, in a first look or not
MOORDYN = {3.5: (1.07, 51.99, 25.03), 1.25: (3.95, 72.55, 27.88)}  # rms, peak and mean [N] of MoorDyn 2.7.2 at 40 segments
CHANGES = {  # of one number each; those of the first look first
    "friction": (0.0, 1.0),
    "Cdt": (0.0, 1.0),
    "Cdn": (2.0, 3.0),
    "distance": (32.544, 32.564),
    "EA": (9e3, 1.1e4),
    "segments": (20, 80),
    "steps": (800, 3200),
    "ground_stiffness": (1e5, 1e8),
    "ground_damping": (0.0, 1e5),
    "slip_speed": (1e-4, 1e-2),
    "Can": (1.0, 5.0),
    "Cat": (1.0, 3.8),
    "zeta": (0.1, 1.0),
    "compression": ("damped", "linear"),
    "height": (3.28, 3.32),
    "radius": (0.198, 0.202),
    "water_level": (2.9, 3.3),
    "water_density": (998.0, 1025.0),
    "mass_per_length": (0.0802, 0.0834),
    "steel_density": (7600.0, 8000.0),
    "nominal_diameter": (2.1e-3, 2.3e-3),
    "length": (32.99, 33.01),
    "start_up": (0.5, 4.0),
    "cycles": (16,),
}
FIRST_LOOK = 6  # numbers of CHANGES in a first look


def chain_row(row):
    """Fold the tension of one setting at each period; both, and what was fitted, as JSON."""
    numbers, errors = {}, {}
    if row["setting"] in FIT_SEGMENTS:
        chain = Chain(cycles=FIT_CYCLES, folded=FIT_FOLDED, segments=FIT_SEGMENTS[row["setting"]])
        fitted = lindahl.fit(chain, FITTED_STEPS, FIT_PERIOD, ROUNDS[row["quick"]])
        numbers, errors = {name: getattr(fitted.chain, name) for name in FITTED_STEPS}, fitted.errors
    finest = FINEST if row["setting"] in (FINER, TUNED_FINER) else {}
    chain, periods = replace(Chain(), **numbers, **finest), []
    for period in lindahl.PERIODS:
        folded = lindahl.fold(chain, period)
        periods.append({"tension": folded.tension.tolist()} | lindahl.beside_measured(folded, period))
    return {"periods": json.dumps(periods), "numbers": json.dumps(numbers), "errors": json.dumps(errors)}


def sensitivity_row(row):
    """What one number that is changed alone makes of the tension; `value` is JSON."""
    folded = lindahl.fold(replace(Chain(), **{row["number"]: json.loads(row["value"])}), row["period_s"])
    found = lindahl.beside_measured(folded, row["period_s"])
    return {name: found[name] for name in ("rms_N", "peak_N", "mean_N", "taken_up_N", "status", "reason")}


def flight_row(row):
    """How far a payload is from where it was measured."""
    return flights.payload_distances(row["file"], row["damping_per_s"])


def compute(quick=False, executor=None, out=None, data=None):
    """The rows; `data` is a folder of measured flights, without which their table is empty."""
    flown = [] if data is None else flights.files(data)
    settings = (TUNED, GIVEN) if quick else (TUNED_FINER, FINER, TUNED, GIVEN)  # those that take longest first
    asked = [{"setting": setting, "quick": quick} for setting in settings]
    found = run_rows(chain_row, asked, executor=executor, out=out and out / "chain").set_index("setting")
    numbers = list(CHANGES.items())[: FIRST_LOOK if quick else None]
    changed = [
        {"number": name, "value": json.dumps(value), "period_s": period}
        for name, values in numbers
        for value in (values[-1:] if quick else values)
        for period in lindahl.PERIODS
    ]
    sensitivity = run_rows(sensitivity_row, changed, executor=executor, out=out and out / "sensitivity")
    return {
        "chain": pd.concat([_chain(found), _moordyn()], ignore_index=True),
        "folded": _folded(found),
        "sensitivity": sensitivity,
        "fitted": _fitted(found),
        "hanging": pd.DataFrame(hanging.rows()),
        "flights": _flights(flown, executor, out),
    }


def _moordyn():
    """What another code says of the chain as it is given, which was noted once."""
    lines = []
    for period, (rms, peak, mean) in MOORDYN.items():
        measured = np.mean(lindahl.MEASURED[period])
        errors = {
            "peak_error_percent": 100.0 * (peak / lindahl.PEAK[period] - 1),
            "mean_error_percent": 100.0 * (mean / measured - 1),
        }
        lines.append(
            {"setting": "MoorDyn 2.7.2", "period_s": period, "rms_N": rms, "peak_N": peak, "mean_N": mean}
            | errors
            | {"status": "done", "reason": ""}
        )
    return pd.DataFrame(lines)


def _chain(found):
    """A line for each setting and period."""
    lines = []
    for setting, row in found[::-1].iterrows():
        for period, line in zip(lindahl.PERIODS, json.loads(row["periods"]), strict=True):
            lines.append({"setting": setting, "period_s": period} | {name: line[name] for name in line if name != "tension"})
    return pd.DataFrame(lines)


def _folded(found):
    lines = []
    given, fitted = (json.loads(found.loc[setting, "periods"]) for setting in (GIVEN, TUNED))
    for p, period in enumerate(lindahl.PERIODS):
        for k, measured in enumerate(lindahl.MEASURED[period]):
            line = {"period_s": period, "phase": k / lindahl.PHASES, "measured_N": measured}
            lines.append(line | {"as_given_N": given[p]["tension"][k], "fitted_N": fitted[p]["tension"][k]})
    return pd.DataFrame(lines)


def _fitted(found):
    numbers, errors = (json.loads(found.loc[TUNED, name]) for name in ("numbers", "errors"))
    return pd.DataFrame(
        {"number": name, "given": getattr(Chain(), name), "fitted": value, "standard_error": errors[name]}
        for name, value in numbers.items()
    )


def _flights(flown, executor, out):
    """A line for each flight at the damping that is least wrong over those that it is fitted to."""
    columns = ["flight", "kind", "half", "damping_per_s", "model_rms_mm", "guess_rms_mm", "status", "reason"]
    if not flown:
        return pd.DataFrame(columns=columns)
    asked = [{"file": str(file), "damping_per_s": damping} for file, _, _ in flown for damping in flights.DAMPINGS]
    found = run_rows(flight_row, asked, executor=executor, out=out and out / "flights")
    about = {str(file): (file.stem, kind, half) for file, kind, half in flown}
    found[["flight", "kind", "half"]] = [about[file] for file in found["file"]]
    fitted = found[found["half"] == flights.FITTED].assign(square=lambda table: table["model_rms_mm"] ** 2)
    damping = fitted.groupby("damping_per_s")["square"].mean().idxmin()
    return found.loc[found["damping_per_s"] == damping, columns].reset_index(drop=True)
