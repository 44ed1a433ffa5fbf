"""Lanes of four numbers in a row of a flat array."""

import numpy as np
from numba import njit

from anet_lumped.compiled.rows_of_lanes import load_row, store_row


@njit
def _move(numbers, source, target):
    store_row(numbers, target, 2.0 * load_row(numbers, source))


def test_four_numbers_are_read_and_written_at_any_address():
    for source, target in ((0, 4), (1, 6), (3, 0), (2, 3)):
        numbers = np.arange(10.0)
        expected = numbers.copy()
        expected[target : target + 4] = 2.0 * numbers[source : source + 4]
        _move(numbers, source, target)
        np.testing.assert_array_equal(numbers, expected)
