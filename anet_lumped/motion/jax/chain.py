"""Block tridiagonal systems in JAX: many chains at once, a block after the other, in a time that grows with their length."""

import jax.numpy as jnp
from jax import lax

from anet_lumped.mechanics.linear.node_elimination import inverse


def times(a, b):
    """Product of blocks (..., 3, 3) with blocks or columns (..., 3, k)."""
    return (a[..., :, :, None] * b[..., None, :, :]).sum(-2)


def inverted(blocks):
    """Inverses of blocks (..., 3, 3), by the lines that the compiled elimination has for one of them."""
    rows = inverse.py_func(tuple(blocks[..., i, j] for i in range(3) for j in range(3)))
    return jnp.stack(rows, -1).reshape(blocks.shape)


def factorised(lower, diagonal, upper):
    """Block LU without pivoting of the matrices with rows lower_j x_(j-1) + diagonal_j x_j + upper_j x_(j+1).

    Parameters
    ----------
    lower, diagonal, upper : (n, chains, 3, 3) float64
        What lower[0] and upper[-1] hold is not used.

    Returns
    -------
    tuple for `solved`
    """

    def eliminate(ahead, row):
        lower, diagonal, upper = row
        pivot = inverted(diagonal - times(lower, ahead))
        ahead = times(pivot, upper)
        return ahead, (lower, pivot, ahead)

    return lax.scan(eliminate, jnp.zeros(diagonal.shape[1:]), (lower, diagonal, upper))[1]


def solved(factors, r):
    """Solutions (n, chains, 3, k) for the right-hand sides r (n, chains, 3, k)."""
    lower, pivot, ahead = factors

    def forward(x, row):
        lower, pivot, r = row
        x = times(pivot, r - times(lower, x))
        return x, x

    def backward(x, row):
        ahead, y = row
        x = y - times(ahead, x)
        return x, x

    nothing = jnp.zeros(r.shape[1:])
    y = lax.scan(forward, nothing, (lower, pivot, r))[1]
    return lax.scan(backward, nothing, (ahead, y), reverse=True)[1]
