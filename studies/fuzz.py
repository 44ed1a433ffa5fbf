"""Random trials on the command line: run as `python -m studies.fuzz`, see `--help`."""

import json
from collections import Counter
from enum import StrEnum
from typing import Annotated

import typer

from studies.catalogue import hostile_trials, random_trials, rest_trials
from studies.catalogue.hostile_outcomes import BAD
from studies.catalogue.outcome import FAILED, GAINED, REFUSED


class Kind(StrEnum):
    """What is tried."""

    RUNS = "runs"
    RESTS = "rests"
    HOSTILE = "hostile"


TRIALS = {  # how they are tried, how many of them at first, and which outcomes are shown
    Kind.RUNS: (random_trials.each, 2000, (FAILED, GAINED)),
    Kind.RESTS: (rest_trials.each, 300, (FAILED, REFUSED)),
    Kind.HOSTILE: (hostile_trials.each, 200, BAD),
}


def main(
    kind: Annotated[Kind, typer.Argument(help="Runs, rests on the ground, or input that cannot be, of each kind.")] = Kind.RUNS,
    seed: Annotated[int, typer.Option(help="Another seed draws others.")] = 7,
    first: Annotated[int, typer.Option(help="Number of the first trial.")] = 0,
    trials: Annotated[int | None, typer.Option(help="How many; as many as the kind needs where not given.")] = None,
) -> None:
    """Try scenes at random; print each that failed as it ends, and how many had each outcome."""
    each, enough, shown = TRIALS[kind]
    counts: Counter = Counter()
    for one in each(seed, first, trials or enough):
        counts[one.get("kind", kind.value), one["outcome"]] += 1
        if one["outcome"] in shown:
            print(json.dumps(one), flush=True)
    for (what, outcome), count in counts.items():
        print(f"{count:5d} {what}: {outcome}")


if __name__ == "__main__":
    typer.run(main)
