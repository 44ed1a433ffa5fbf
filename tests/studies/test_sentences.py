"""Pieces of sentences: no range of one number, no list of nothing, one way to write powers of ten."""

import numpy as np
import pytest

from studies.shown.sentences import between, counted, listed, percent, power, share, stiffness


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ([1046.2, 1046.4], "1046 times"), ([1.0, 3.5, 2.0], "1 to 3.5 times"), ([np.nan, 2.0], "2 times"), ([np.inf], "not known"),
        ([], "not known"),
    ],
)  # fmt: skip
def test_a_range_of_one_number_is_that_number(values, text):
    assert between(values, "times") == text


def test_lists_counts_and_shares():
    assert listed(["a", "b", "a", "c"]) == "a, b and c" and listed(["a"]) == "a" and listed([]) == "none"
    assert [counted(n, "run") for n in (0, 1, 5)] == ["no run", "1 run", "5 runs"]
    assert [share(n, 5) for n in (0, 3, 5)] == ["none of 5", "3 of 5", "all 5"]
    assert counted(2, "slope of errors", "slopes of errors") == "2 slopes of errors"


@pytest.mark.parametrize(
    ("value", "text"),
    [(1e4, "1e4"), (9e3, "9000"), (2.5e-4, "2.5e-4"), (98.1, "98.1"), (0.0, "0"), (1e-9, "1e-9"), (-1e6, "-1e6"), (np.inf, "∞")],
)
def test_powers_of_ten(value, text):
    assert power(value) == text


def test_a_stiffness():
    assert percent(0.98) == "98 %" and percent(0.001) == "0.1 %"
    assert stiffness(1e4) == "EA = 1e4 N" and stiffness(np.inf) == "EA = ∞"
