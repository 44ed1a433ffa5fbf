"""The answer of the study `moorings` in words."""

import numpy as np

from studies.questions.moorings.prices import TOLERANCES, cheapest, ratio
from studies.shown.sentences import counted, listed, percent

STATICS, MOTION = 1e-3, 1e-2  # what is asked, of the largest tension and of the mean one


def answer(rows):
    """The answer, every number and every claim from `rows`."""
    return "\n\n".join([*_decks(rows["decks"]), _cost(rows["cost"]), "Left out: waves and currents, and bodies that turn."])


def _decks(decks):
    read, rest = decks["read"] == "read", decks["rest"].isin(("", "none"))
    driven = read & ~rest & (decks["moves"] != "nothing is coupled")
    moved = driven & (decks["moves"] == "done")
    yield (
        f"Of {counted(len(decks), 'file')}, {read.sum()} are read, {(read & ~rest).sum()} rest and {moved.sum()} of the "
        f"{driven.sum()} with coupled points move to the end." + _refused(decks[~read | rest])
    )
    beside = decks[decks["statics_error"].notna()]
    if beside.empty:
        yield "MoorDyn is not installed or ran none of them, so that no tension is set beside its own."
        return
    good, bad = (beside[mask] for mask in (beside["statics_error"] <= STATICS, beside["statics_error"] > STATICS))
    yield (
        f"At rest the tensions of {len(good)} of {counted(len(beside), 'file')} are within {percent(STATICS)} of MoorDyn's."
        + "".join(f" {line.deck}: {percent(line.statics_error)} ({line.moordyn})." for line in bad.itertuples())
    )
    moving = beside[beside["motion_error"].notna()]
    near, far = (moving[mask] for mask in (moving["motion_error"] <= MOTION, moving["motion_error"] > MOTION))
    yield (
        f"Moved, {len(near)} of {counted(len(moving), 'file')} are within {percent(MOTION)} of the mean tension at every time."
        + "".join(
            f" {line.deck}: {percent(line.motion_error)} at its worst time and {percent(line.motion_rms)} rms, and with shorter "
            f"steps {percent(line.finer_motion_error)}, by which this library changed by {percent(line.own_change)} and MoorDyn by "
            f"{percent(line.moordyn_change)}."
            for line in far.itertuples()
        )
    )


def _refused(decks):
    return "".join(f" {line.deck}: {line.reason}" for line in decks.itertuples())


def _cost(cost):
    names = list(dict.fromkeys(cost["deck"]))
    told = []
    for tolerance in TOLERANCES:
        ratios = {name: ratio(cost, name, tolerance) for name in names}
        known = {name: value for name, value in ratios.items() if np.isfinite(value)}
        if known:
            least = min(known, key=known.get)
            told.append(
                f"Within {percent(tolerance)} of the range of the tension this library takes "
                f"{listed(f'{value:.2g} times less ({name})' for name, value in known.items())} processor time than MoorDyn"
                + (f"; the least is {known[least]:.2g}." if len(known) > 1 else ".")
            )
        else:
            done = [cheapest(cost, name, "this library", tolerance) for name in names]
            times = [f"{line['cpu_s']:.2g} s ({line['setting']})" for line in done if line is not None]
            told.append(
                f"Within {percent(tolerance)} of the range this library takes {listed(times)}."
                if times
                else f"Within {percent(tolerance)} of the range is no run with the steps that were tried."
            )
    return " ".join(told)
