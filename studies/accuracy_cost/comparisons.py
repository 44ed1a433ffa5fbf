"""Methods compared at equal error: the best of ours and of other engines, the library's own choice, and pairs of their timings."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from studies.accuracy_cost.contestants import OURS, OWN_CHOICE
from studies.accuracy_cost.equal_error import time_at, weights_at
from studies.accuracy_cost.paired_timing import ratio, take_turns

TARGETS_MM = (10.0, 1.0, 0.1, 0.01)
PAIRS = 9  # turns in which two methods are timed that are compared
NET, SEGMENTS, NET_TARGET = "carried net", 20, 0.1  # motion and error [mm] at which stiffnesses are compared
PEER_OVER_OURS, CHOICE_OVER_BEST = "best other engine over best of ours", "own choice over best method"
DEAREST_OVER_CHEAPEST = "dearest over cheapest stiffness"


def equal_errors(runs):
    """Best of ours and best peer for each motion and error asked for; a reference's own doubt counts as error."""
    rows = []
    for keys, part in runs.groupby(["motion", "EA_N", "segments"], sort=False):
        for target in TARGETS_MM:
            best = {}
            for (engine, method), line in part[part["method"] != OWN_CHOICE].groupby(["engine", "method"], sort=False):
                errors = np.maximum(line["error_mm"], line["reference_mm"])
                seconds, error = time_at(errors, line["wall_s"], target)
                side = "ours" if engine == OURS else "peer"
                if seconds < best.get(side, (np.inf,))[0]:
                    best[side] = seconds, error, method if side == "ours" else f"{engine} {method}".strip()
            row = dict(zip(("motion", "EA_N", "segments"), keys, strict=True)) | {"target_mm": target}
            for side in ("ours", "peer"):
                seconds, error, who = best.get(side, (np.nan, np.nan, ""))
                row |= {f"best_{side}": who, f"{side}_s": seconds, f"{side}_error_mm": error}
            duration = (part["wall_s"] * part["times_real_time"]).median()
            rows.append(row | {"ratio": row["peer_s"] / row["ours_s"], "ours_times_real_time": duration / row["ours_s"]})
    return pd.DataFrame(rows)


def own_choices(runs):
    """What the library picks by itself against the best of its methods at the error that the choice had."""
    rows, ours = [], runs[runs["engine"] == OURS]
    for keys, part in ours.groupby(["motion", "EA_N", "segments"], sort=False):
        judged = part["method"] == OWN_CHOICE
        for own in part[judged & (part["status"] == "done")].itertuples():
            target, best, who = max(own.error_mm, own.reference_mm), np.inf, ""
            for method, line in part[~judged].groupby("method", sort=False):
                seconds, _ = time_at(np.maximum(line["error_mm"], line["reference_mm"]), line["wall_s"], target)
                if seconds < best:
                    best, who = seconds, method
            row = dict(zip(("motion", "EA_N", "segments"), keys, strict=True)) | {"choice": own.reason, "error_mm": own.error_mm}
            rows.append(row | {"target_mm": target, "wall_s": own.wall_s, "best": who, "best_s": best, "run": own.Index})
    return pd.DataFrame(rows)


@dataclass(frozen=True)
class Side:
    """A method at an error: its runs by number, with their weights in the logarithm of its time."""

    name: str
    weights: dict[int, float]


def paired(runs, entries, equal, own):
    """A line for each comparison that the answer makes: the two are timed in turns, at the same error, and compared pair by "
    "pair."""
    lines = []
    for row in equal.itertuples():
        if np.isfinite(row.ratio):
            ours, peer = (_side(runs, row, who, row.target_mm) for who in (row.best_ours, row.best_peer))
            lines.append({"compared": PEER_OVER_OURS, **_of(row), "error_mm": row.target_mm} | _compare(entries, peer, ours))
    for row in own.itertuples():
        if row.best:
            choice = Side("own choice", {row.run: 1.0})
            best = _side(runs, row, row.best, row.target_mm)
            lines.append({"compared": CHOICE_OVER_BEST, **_of(row), "error_mm": row.target_mm} | _compare(entries, choice, best))
    nets = equal[(equal["motion"] == NET) & (equal["segments"] == SEGMENTS) & (equal["target_mm"] == NET_TARGET)].dropna(
        subset="ours_s"
    )
    if len(nets) > 1:
        dear, cheap = (next(nets.loc[[found]].itertuples()) for found in (nets["ours_s"].idxmax(), nets["ours_s"].idxmin()))
        sides = [_side(runs, row, row.best_ours, row.target_mm) for row in (dear, cheap)]
        lines.append({"compared": DEAREST_OVER_CHEAPEST, **_of(dear), "error_mm": NET_TARGET} | _compare(entries, *sides))
    columns = ["compared", "motion", "EA_N", "segments", "error_mm", "first", "second", "median_ratio", "low", "high", "pairs"]
    return pd.DataFrame(lines, columns=columns)


def _of(row):
    return {"motion": row.motion, "EA_N": row.EA_N, "segments": row.segments}


def _side(runs, row, who, target):
    """A method, or "engine method", at an error on a motion."""
    names = (runs["engine"] + " " + runs["method"]).str.strip()
    here = runs[(runs["motion"] == row.motion) & (runs["EA_N"] == row.EA_N) & (runs["segments"] == row.segments)]
    here = here[((here["engine"] == OURS) & (here["method"] == who)) | (names[here.index] == who)]
    found = weights_at(np.maximum(here["error_mm"], here["reference_mm"]), here["wall_s"], target)
    return Side(who, {int(here.index[i]): weight for i, weight in found.items()})


def _compare(entries, first, second):
    """Ratio of the times of two sides, from runs that take turns."""
    numbers = list(dict.fromkeys([*first.weights, *second.weights]))
    times = take_turns({number: entries[number] for number in numbers}, PAIRS, warm_up=0)

    def at_error(side):
        return np.exp(sum(weight * np.log(times[number]) for number, weight in side.weights.items()))

    found = ratio(at_error(first), at_error(second))
    names = {"first": first.name, "second": second.name, "median_ratio": found.median}
    return names | {"low": found.low, "high": found.high, "pairs": found.pairs}
