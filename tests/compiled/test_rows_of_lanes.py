"""Lanes of four numbers in a row of a flat array."""

import numpy as np
from numba import njit

from anet_lumped.compiled.lanes import sum_of_lanes
from anet_lumped.compiled.rows_of_lanes import columns_apart, load_row, load_tile, spread, store_row, store_tile, thrice


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


@njit
def _move_tile(numbers, source, target, like):
    a, b, c, d = load_tile(numbers, source, like)
    store_tile(numbers, target, (d, c, b, a))


@njit
def _move_lanes(numbers, source, target):
    _move_tile(numbers, source, target, spread(0.0))


def test_a_tile_is_four_numbers_or_four_lanes_in_a_row():
    numbers = np.arange(12.0)
    _move_tile(numbers, 1, 6, 0.0)
    np.testing.assert_array_equal(numbers[6:10], [4.0, 3.0, 2.0, 1.0])
    numbers = np.arange(40.0)
    _move_lanes(numbers, 2, 21)
    np.testing.assert_array_equal(numbers[21:37].reshape(4, 4), np.arange(2.0, 18.0).reshape(4, 4)[::-1])
    np.testing.assert_array_equal(numbers[:21], np.arange(21.0))


@njit
def _of_coordinates(numbers, found):
    for k, one in enumerate(thrice(load_row(numbers, 1))):
        store_row(found, 4 * k, one)
    return sum_of_lanes(spread(numbers[0])), columns_apart(1), columns_apart((1, 2, 3, 4))


def test_a_number_of_each_node_for_its_three_coordinates():
    numbers, found = np.array([7.0, 1.0, 2.0, 3.0, 4.0]), np.zeros(12)
    assert _of_coordinates(numbers, found) == (28.0, 1, 4)
    np.testing.assert_array_equal(found, np.repeat(numbers[1:], 3))
