"""Ratios of times from runs that take turns: the median, its interval, and whether it is resolved."""

import itertools

import numpy as np
import pytest

from studies.accuracy_cost.paired_timing import CONFIDENCE, FEWEST, UNRESOLVED, Ratio, in_words, ratio, seconds_of, take_turns


def test_things_take_turns_and_the_first_turn_does_not_count():
    order, clock = [], itertools.count()

    def thing(name):
        def run():
            order.append(name)
            return next(clock)

        return run

    times = take_turns({"a": thing("a"), "b": thing("b")}, 3)
    assert order == ["a", "b"] * 4 and times == {"a": [2, 4, 6], "b": [3, 5, 7]}


def test_a_drift_of_the_machine_does_not_move_the_ratio():
    """Both take three times as long in the end: their medians are of different moments, the ratios of pairs are not."""
    slower = np.linspace(1.0, 3.0, 11)
    found = ratio(2.0 * slower, slower)
    assert found.median == pytest.approx(2.0) and (found.low, found.high) == pytest.approx((2.0, 2.0)) and found.resolved


def test_noise_larger_than_the_difference_is_not_resolved():
    noise = np.array([0.7, 1.4, 0.9, 1.2, 0.8, 1.3, 0.6, 1.1, 1.5, 1.0])
    found = ratio(1.02 * noise, np.ones(10))
    assert not found.resolved and found.low < 1.0 < found.high
    assert in_words(found).startswith(f"{UNRESOLVED} (") and "1.02" not in in_words(found).split("(")[0]
    clear = ratio(3.0 * noise, np.ones(10))
    assert clear.resolved and in_words(clear, 2) == "3.2 (2.1 to 4.2)"


def test_few_pairs_resolve_nothing():
    few = ratio([3.0] * (FEWEST - 1), [1.0] * (FEWEST - 1))
    assert not few.resolved and in_words(few) == f"{UNRESOLVED}, by 5 pairs of timings"
    assert ratio([3.0] * FEWEST, [1.0] * FEWEST).resolved
    assert ratio([], []).pairs == 0 and not ratio([], []).resolved


def test_less_than_one_is_resolved_too():
    faster = ratio([0.5, 0.52, 0.49, 0.51, 0.5, 0.5], [1.0] * 6)
    assert faster.resolved and faster.percent == pytest.approx(-50.0)


@pytest.mark.parametrize("pairs", [6, 9, 15, 40])
def test_the_interval_holds_the_median_as_often_as_it_says(pairs):
    """Of 2000 draws from a skewed distribution of median 1; three standard deviations of the count below CONFIDENCE."""
    rng = np.random.default_rng(1)
    draws = rng.exponential(size=(2000, pairs)) / np.log(2.0)
    held = np.mean([found.low <= 1.0 <= found.high for found in (ratio(draw, np.ones(pairs)) for draw in draws)])
    assert held > CONFIDENCE - 3 * np.sqrt(CONFIDENCE * (1 - CONFIDENCE) / 2000)
    assert all(isinstance(found, Ratio) for found in [ratio(draws[0], draws[1])])


def test_seconds_of_a_call():
    called = []
    assert seconds_of(lambda: called.append(1)) >= 0.0 and called == [1]
