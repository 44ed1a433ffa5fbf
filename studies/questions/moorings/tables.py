"""Rows of the study `moorings`."""

import numpy as np
import pandas as pd

from anet_lumped.checks import InputError
from studies.peers import peer
from studies.questions.moorings import decks
from studies.questions.moorings.motion import SAVED, Peer, is_driven, own_run, prepare, tensions
from studies.questions.moorings.prices import COLUMNS, cost_rows
from studies.sweeping.rows import run_rows

T_END = {True: 10.0, False: 30.0}  # [s], in a first look or not
REFINED_ABOVE = 0.01  # of the mean tension: motions that differ by more are computed again, by both codes, with shorter steps
FINER_OWN, FINER_PEER, FINER_COUPLING = 8.0, 0.3, 1.25e-3  # steps shorter by; of MoorDyn's limit; [s] between coupled places
COST_DECKS = (  # those of a folder whose cost is asked; of its own decks the study asks all, in a first look one
    "IEAWindTask37__IEA-15-240-RWT-UMaineSemi_MoorDyn.dat",
    "FloatingArrayDesign__lines.txt",
    "FloatingArrayDesign__no_waves.txt",
    "FloatingArrayDesign__simple.txt",
    "NREL__case1.dat",
    "NREL__case8.dat",
    "NREL__sample.txt",
    "michaelcdevin__VolturnUS-15MW_MoorDyn_Taut_1000m.dat",
)
RESULTS = (
    "segments", "laws", "read", "rest", "statics_error", "moordyn", "moves", "step_s", "motion_error", "motion_rms",
    "finer_motion_error", "own_change", "moordyn_change",
)  # fmt: skip


def deck_row(row):
    """Read, rest and move one deck; beside MoorDyn if `peer`."""
    found = dict.fromkeys(RESULTS, np.nan) | dict.fromkeys(("laws", "rest", "moordyn", "moves"), "")
    try:
        deck, laws = decks.read(row["file"])
    except InputError as error:
        return found | {"read": "refused", "status": "refused", "reason": str(error).splitlines()[0]}
    found |= {"read": "read", "laws": laws, "segments": sum(cable.segments for cable in deck.scene.cables)}
    try:
        prepared = prepare(deck)
    except InputError as error:
        prepared = None
        found |= {"rest": "none", "status": "no rest", "reason": str(error)}
    if prepared is not None:
        found |= {"rest": prepared.changed or "found", "moves": "nothing is coupled"}
    run = None
    if prepared is not None and is_driven(deck):
        run, _ = own_run(prepared, row["t_end_s"], save_every=SAVED)
        found |= {"moves": run.status, "step_s": run.dt, "reason": run.message, "status": run.status}
    if row["peer"] and prepared is not None:
        found |= _beside(row, deck, prepared, run)
    return found


def _beside(row, deck, prepared, run):
    """The columns that MoorDyn gives."""
    other = Peer(row["file"], deck)
    try:
        rest, way, state = other.rest(prepared.rest)
        found = {
            "moordyn": ("reads the file as written here" if other.written_anew else "reads it") + f", {way}",
            "statics_error": _largest(tensions(deck, prepared.rest) - rest) / np.abs(rest).max(),
        }
        if run is None:
            return found
        own = tensions(deck, run)[1:]
        theirs, _ = other.march(state, row["t_end_s"], SAVED, dt=0.6 * other.limit)
        mean = np.abs(theirs).mean()
        found |= {
            "motion_error": _largest(own - theirs) / mean,
            "motion_rms": float(np.sqrt(np.mean((own - theirs) ** 2))) / mean,
        }
        if found["motion_error"] > REFINED_ABOVE:
            finer, _ = own_run(prepared, row["t_end_s"], save_every=SAVED, method="edmc", dt=run.dt / FINER_OWN)
            finer = tensions(deck, finer)[1:]
            fine, _ = other.march(state, row["t_end_s"], SAVED, dt=FINER_PEER * other.limit, coupling=FINER_COUPLING)
            found |= {
                "finer_motion_error": _largest(finer - fine) / mean,
                "own_change": _largest(finer - own) / mean,
                "moordyn_change": _largest(fine - theirs) / mean,
            }
        return found
    except (RuntimeError, ValueError) as error:
        return {"moordyn": f"fails: {error}"}


def _largest(difference):
    return float(np.abs(difference).max())


def compute(quick=False, executor=None, out=None, data=None):
    """The rows; `data` is a folder of decks, without which the study writes small ones."""
    from pathlib import Path
    from tempfile import mkdtemp

    folder = Path(mkdtemp(prefix="decks")) if out is None else Path(out) / "decks_written"
    found, has_peer = decks.files(data, folder), peer("moordyn").version() is not None
    asked = [{"file": str(file), "t_end_s": T_END[quick], "peer": has_peer} for file in found]
    table = run_rows(deck_row, asked, executor=executor, out=out and Path(out) / "decks")
    table.insert(0, "deck", [Path(file).name for file in table["file"]])
    priced = [file for file in found if file.name in COST_DECKS] or found
    if quick:
        priced = priced[:1]
    rows = [{"file": str(file), "t_end_s": T_END[quick], "peer": has_peer, "quick": quick} for file in priced]
    lists = run_rows(cost_rows, rows, executor=executor, out=out and Path(out) / "cost")
    return {"decks": table.drop(columns=["file", "peer"]), "cost": _unpacked(lists)}


def _unpacked(lists):
    """A line for each setting, from the JSON of each file's row."""
    import json

    lines = [line for text in lists["settings"].dropna() for line in json.loads(text)] if "settings" in lists else []
    return pd.DataFrame(lines, columns=list(COLUMNS))
