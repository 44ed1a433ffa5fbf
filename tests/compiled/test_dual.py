"""Dual numbers in compiled code: every function against JAX's first and second derivatives, branches, loops, mixed numbers."""

import math
import operator

import numpy as np
import pytest
from numba import njit

from anet_lumped.compiled.dual import NAMES, OF_TWO, RULES, seeded, slope, value_of

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)
jnp = jax.numpy

EPS = np.finfo(float).eps


def with_derivatives(f, x):
    """JAX's value, first and second derivatives of all numbers that f returns, compiled together."""
    first = jax.jacfwd(f)
    return jax.jit(lambda x: (f(x), first(x), jax.jacfwd(first)(x)))(x)


@njit
def of_one(x):
    """Every function of one number, in the order of `LIKE_ONE`."""
    return (
        math.sqrt(x), math.exp(x), math.expm1(x), math.log(x), math.log1p(x), math.log10(x), math.sin(x), math.cos(x), math.tan(x),
        math.asin(x), math.acos(x), math.atan(x), math.sinh(x), math.cosh(x), math.tanh(x), math.asinh(x), math.erf(x),
        math.fabs(-x), abs(-x), -x, +x, x**3, x**-2, x**0.5, 2.0**x, 1.0 - x, x - 1, 3 / x, x / 3, x * x, max(x, 0.5), min(x, 0.5),
        np.sqrt(x), np.arcsin(x), np.exp(x),
    )  # fmt: skip


LIKE_ONE = (
    jnp.sqrt, jnp.exp, jnp.expm1, jnp.log, jnp.log1p, jnp.log10, jnp.sin, jnp.cos, jnp.tan, jnp.arcsin, jnp.arccos, jnp.arctan,
    jnp.sinh, jnp.cosh, jnp.tanh, jnp.arcsinh, jax.scipy.special.erf, lambda x: abs(-x), lambda x: abs(-x), lambda x: -x,
    lambda x: +x, lambda x: x**3, lambda x: x**-2, lambda x: x**0.5, lambda x: 2.0**x, lambda x: 1.0 - x, lambda x: x - 1,
    lambda x: 3 / x, lambda x: x / 3, lambda x: x * x, lambda x: jnp.maximum(x, 0.5), lambda x: jnp.minimum(x, 0.5), jnp.sqrt,
    jnp.arcsin, jnp.exp,
)  # fmt: skip


@njit
def slopes_of_one(x):
    """Value and first derivative of each."""
    rows = np.zeros((35, 2))
    first, _, _ = seeded(x, 0.0, 0.0)
    k = 0
    for f in of_one(first):
        rows[k, 0], rows[k, 1] = value_of(f), slope(f, 0)
        k += 1
    return rows


@njit
def some_of_one(x):
    """Functions of one number with all kinds of rules, one in the other, in the order of `LIKE_SOME`."""
    return math.sqrt(math.exp(x)), math.atan(x**3), math.log(math.cosh(x)), abs(math.sin(-x)) / x, math.erf(2.0**x)


LIKE_SOME = (
    lambda x: jnp.sqrt(jnp.exp(x)), lambda x: jnp.arctan(x**3), lambda x: jnp.log(jnp.cosh(x)), lambda x: abs(jnp.sin(-x)) / x,
    lambda x: jax.scipy.special.erf(2.0**x),
)  # fmt: skip


@njit
def second_slopes_of_some(x):
    """Value, first and second derivative of each of `some_of_one`."""
    rows = np.zeros((5, 3))
    first, _, _ = seeded(x, 0.0, 0.0)
    second, _, _ = seeded(first, 0.0, 0.0)
    k = 0
    for f in some_of_one(second):
        rows[k, 0], rows[k, 1], rows[k, 2] = value_of(f), value_of(slope(f, 0)), slope(slope(f, 0), 0)
        k += 1
    return rows


def test_every_function_of_one_number():
    rows = slopes_of_one(0.37)
    assert len(LIKE_ONE) == len(rows) >= len(RULES)
    exact = with_derivatives(lambda x: jnp.stack([like(x) for like in LIKE_ONE]), 0.37)[:2]
    for row, like in zip(rows, np.transpose(exact), strict=True):
        np.testing.assert_allclose(row, like, rtol=16 * EPS, atol=16 * EPS)  # a handful of roundings


@pytest.mark.slow
def test_second_derivatives():
    exact = with_derivatives(lambda x: jnp.stack([like(x) for like in LIKE_SOME]), 0.37)
    np.testing.assert_allclose(
        second_slopes_of_some(0.37), np.transpose(exact), rtol=32 * EPS, atol=32 * EPS
    )  # a handful of roundings


@njit
def of_two(x, y, z):
    return (
        x + y, x - y, x * y, x / y, math.atan2(x, y), math.hypot(x, y), x**y, max(x, y), min(x, y), np.arctan2(y, x) + 0 * z,
    )  # fmt: skip


LIKE_TWO = (
    operator.add, operator.sub, operator.mul, operator.truediv, jnp.arctan2, jnp.hypot, operator.pow, jnp.maximum, jnp.minimum,
    lambda x, y: jnp.arctan2(y, x),
)  # fmt: skip


@njit
def slopes_of_two(x, y):
    values, first, second = np.zeros(10), np.zeros((10, 2)), np.zeros((10, 2, 2))
    a, b, c = seeded(x, y, 1.0)
    a, b, c = seeded(a, b, c)
    k = 0
    for f in of_two(a, b, c):
        values[k] = value_of(f)
        for i in range(2):
            first[k, i] = value_of(slope(f, i))
            for j in range(2):
                second[k, i, j] = slope(slope(f, i), j)
        k += 1
    return values, first, second


@pytest.mark.slow
def test_every_function_of_two_numbers():
    at = np.array([0.6, 1.7])
    values, first, second = slopes_of_two(*at)
    assert len(LIKE_TWO) >= len(OF_TWO)
    exact = with_derivatives(lambda x: jnp.stack([like(x[0], x[1]) for like in LIKE_TWO]), at)
    for k, (f, of_x, of_xx) in enumerate(zip(*map(np.array, exact), strict=True)):
        assert values[k] == pytest.approx(f, rel=8 * EPS)
        np.testing.assert_allclose(first[k], of_x, rtol=16 * EPS, atol=16 * EPS)
        np.testing.assert_allclose(second[k], of_xx, rtol=32 * EPS, atol=32 * EPS)


@njit
def branching(x, y):
    """Sums that begin as plain numbers, branches and loops over dual ones, values that are dual in one branch only."""
    total = 0.0
    for k in range(3):
        total += x * k
        total -= 0.5 * y
        total *= 2.0
    total /= 4
    if x > y and not (x == y) and x != y:
        scale = 1
    else:
        scale = x**2
    return total * scale if 0.0 < x <= 10 and y >= -1 else 0.0


@njit
def slopes_of_branching(x, y):
    a, b, _ = seeded(x, y, 0.0)
    f = branching(a, b)
    return value_of(f), slope(f, 0), slope(f, 1)


@pytest.mark.parametrize(("x", "y", "scale", "of_x"), [(2.0, 1.0, 1.0, 0.0), (1.0, 2.0, 1.0, 2.0)])
def test_branches_and_loops(x, y, scale, of_x):
    """total = ((-y/2 2 + x - y/2) 2 + 2 x - y/2) 2/4 = 2 x - 7/4 y, times 1 or x^2."""
    total = 2 * x - 1.75 * y
    assert slopes_of_branching(x, y) == pytest.approx((total * scale, 2 * scale + total * of_x, -1.75 * scale), rel=8 * EPS)
    assert slopes_of_branching(20.0, 1.0) == (0.0, 0.0, 0.0)


@njit
def slopes_at_rest():
    """Slopes of three lengths of a vector of nothing, times its first number: those of |v| v."""
    a, b, c = seeded(0.0, 0.0, 0.0)
    found = np.zeros((3, 4))
    k = 0
    for length in (math.sqrt(a * a + b * b + c * c), (a * a + b * b + c * c) ** 0.5, math.hypot(a, b)):
        f = length * a
        found[k, 0], found[k, 1], found[k, 2], found[k, 3] = value_of(f), slope(f, 0), slope(f, 1), slope(f, 2)
        k += 1
    return found


def test_a_root_of_zero_has_a_slope():
    assert (slopes_at_rest() == 0.0).all()


def test_what_is_understood_is_listed():
    assert {"sqrt", "atan2", "erf", "max"} <= set(NAMES) and "add" not in NAMES
