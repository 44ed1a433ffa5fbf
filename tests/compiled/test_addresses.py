"""Compiled functions called by their address: what they return, and what their callers may raise."""

import numpy as np
from numba import float64, int64, types

from anet_lumped.compiled.addresses import address_of, callable_at
from anet_lumped.compiled.exceptions import may_raise
from anet_lumped.compiled.jit import kernel, on_demand

PAIR = types.Tuple((float64, types.UniTuple(float64, 2)))(float64, float64[::1])
as_pair = callable_at(PAIR)


@on_demand
def scaled(x, numbers):
    return x * numbers[0], (x + numbers[1], numbers[2])


@kernel(float64(int64, float64[::1]))
def by_address(address, numbers):
    product, (total, last) = as_pair(address)(3.0, numbers[1:])
    return 100.0 * product + 10.0 * total + last


def test_the_function_at_the_address_is_called():
    numbers = np.array([9.0, 2.0, 4.0, 5.0])
    assert by_address(address_of(scaled, PAIR), numbers) == 100 * 6 + 10 * 7 + 5


def test_a_call_by_an_address_raises_nothing():
    """Nobody looks for an address that is null: an effect's force that calls a wind must not raise."""
    assert may_raise(by_address) == ()
