"""The answer of the study `nets` in words."""

import numpy as np

from studies.accuracy_cost.equal_error import time_at
from studies.questions.nets.junctions import OWN as FRONTS
from studies.questions.nets.tables import AIR, OWN, STREAM, TARGETS_MM
from studies.shown.sentences import listed
from studies.shown.show import as_text


def answer(rows):
    """The answer, every number and every claim from `rows`."""
    words = [_motions(rows["motions"]), _solves(rows["solves"]), _rests(rows["rests"], rows["solves"])]
    return "\n\n".join(
        [*words, "Left out: set-up and compiling; cables of more than one segment; engines that divide a step among cores."]
    )


def least_times(motions, target):
    """Least processor time [s] of each engine within an error [mm]; NaN where none of its settings is as accurate."""
    done = motions[motions["status"] == "done"]
    return {name: time_at(line["error_mm"], line["cpu_s"], target)[0] for name, line in done.groupby("engine", sort=False)}


def _motions(motions):
    told = []
    for target in TARGETS_MM:
        times = {name: time for name, time in least_times(motions, target).items() if np.isfinite(time)}
        own = times.pop(OWN, np.nan)
        if not times:
            told.append(
                f"within {target:g} mm this library takes {as_text(own, 2)} s of the processor, and nothing is set beside it"
            )
            continue
        others = listed(f"{name} {as_text(time, 2)} s" for name, time in times.items())
        told.append(
            f"within {target:g} mm this library takes {as_text(own, 2)} s of the processor, {others}: "
            f"{as_text(min(times.values()) / own, 2)} times as much at the least"
        )
    first, *more = told
    return f"A net that sways is marched {'; '.join([first, *more])}."


def _solves(solves):
    largest = solves[solves["side"] == solves["side"].max()].set_index("solver")
    own = largest.loc[FRONTS]
    others = listed(
        f"{name} {as_text(1e3 * row['solve_s'], 2)} ms, {as_text(row['solve_s'] / own['solve_s'], 2)} times as long"
        for name, row in largest.iterrows()
        if name != FRONTS
    )
    return (
        f"One solve for {own['points']:.0f} junctions takes {as_text(1e3 * own['solve_s'], 2)} ms, after a set-up of "
        f"{as_text(own['set_up_s'], 2)} s for a scene; {others}. Their solutions are within {as_text(largest['apart'].max(), 1)} "
        "of each other."
    )


def _rests(rests, solves):
    side = rests["side"].max()
    own = solves[(solves["side"] == side) & (solves["solver"] == FRONTS)]["solve_s"].iloc[0]
    table = rests[rests["side"] == side].set_index("around")["rest_s"]
    return (
        f"The rest of {side} by {side} points takes {as_text(table[AIR], 2)} s in air and {as_text(table[STREAM], 2)} s in a "
        f"current, as long as {as_text(table[AIR] / own, 2)} and {as_text(table[STREAM] / own, 2)} such solves."
    )
