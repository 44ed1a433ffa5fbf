"""Which of two is faster: both are timed in turns (A B A B ...), and compared pair by pair.

What else a machine does slows it down for a while, so that two times say little of each other unless they were taken side by
side. The ratio of a pair says what it says of that moment; the median of many pairs is the ratio, and an interval in which the
median of further pairs would lie tells how far it can be trusted. Where the interval holds 1 the noise is larger than the
difference, and the ratio is not resolved.
"""

import time
from collections.abc import Callable, Iterable
from math import comb
from typing import NamedTuple

import numpy as np

from studies.shown.sentences import counted
from studies.shown.show import as_text

CONFIDENCE = 0.95  # that the median lies in the interval
FEWEST = 6  # pairs for which the least and the largest ratio enclose the median with that confidence
UNRESOLVED = "not resolved on this machine"


class Ratio(NamedTuple):
    """Time of a first thing over that of a second one, pair by pair.

    Parameters
    ----------
    median : of the pairs' ratios
    low, high : interval in which the median lies with CONFIDENCE; minus and plus infinity for fewer than FEWEST pairs
    pairs : number of pairs
    """

    median: float
    low: float
    high: float
    pairs: int

    @property
    def resolved(self) -> bool:
        """Whether the difference is larger than the noise."""
        return bool(self.low > 1.0 or self.high < 1.0)

    @property
    def inverse(self) -> "Ratio":
        """The other one's time over this one's."""
        return Ratio(1.0 / self.median, 1.0 / self.high, 1.0 / self.low if self.low > 0.0 else np.inf, self.pairs)

    @property
    def percent(self) -> float:
        """How much more the first takes [%]."""
        return 100.0 * (self.median - 1.0)


def seconds_of(function: Callable[[], object]) -> float:
    """Time of one call [s]."""
    began = time.perf_counter()
    function()
    return time.perf_counter() - began


def take_turns(timed: dict[str, Callable[[], float]], pairs: int, *, warm_up: int = 1) -> dict[str, list[float]]:
    """Times of several things, each of which is done once in every turn.

    Parameters
    ----------
    timed : name -> function that does a thing and returns its time [s]
    pairs : turns that count
    warm_up : turns before them, which compile and fill the caches

    Returns
    -------
    dict : name -> (pairs,) times [s]; the k-th times of two names are a pair
    """
    times = {name: [] for name in timed}
    for turn in range(warm_up + pairs):
        for name, function in timed.items():
            seconds = function()
            if turn >= warm_up:
                times[name].append(seconds)
    return times


def ratio(first: Iterable[float], second: Iterable[float]) -> Ratio:
    """Times of one over times of another, that were taken in turns: the k-th of both are a pair.

    The interval is that between two of the ordered ratios, which no assumption about the noise is needed for (sign test).
    """
    ratios = np.sort(np.divide(list(first), list(second)))
    n = len(ratios)
    rank = _rank(n)
    low, high = (ratios[rank], ratios[n - 1 - rank]) if rank is not None else (-np.inf, np.inf)
    return Ratio(float(np.median(ratios)) if n else float("nan"), float(low), float(high), n)


def in_words(found: Ratio, digits: int = 3) -> str:
    """The ratio with its interval, "1.43 (1.38 to 1.5)", or that it is not resolved, with the interval that holds 1."""
    if found.pairs < FEWEST:
        return f"{UNRESOLVED}, by {counted(found.pairs, 'pair')} of timings"
    interval = f"{as_text(found.low, digits)} to {as_text(found.high, digits)}"
    return f"{as_text(found.median, digits)} ({interval})" if found.resolved else f"{UNRESOLVED} ({interval})"


def _rank(n):
    """Ordered ratios left out at either end, so that the median lies between the next ones; None of too few pairs."""
    tail, rank = 0.0, None
    for k in range(n // 2):
        tail += comb(n, k) / 2**n
        if 2.0 * tail > 1.0 - CONFIDENCE:
            break
        rank = k
    return rank
