"""How functions are compiled: `njit`, and four decorators, one for each way in which a function is called.

None of the four counts references to arrays: the functions allocate nothing, and their callers hold the arrays that they read and
write. Without reference counts, and without a wrapper for Python, a function compiles in half the time.
"""

from integrators.jit import SHARED, WITHOUT_ADDRESS, WITHOUT_PYTHON, njit

__all__ = ["inlined", "internal", "kernel", "njit", "on_demand"]

_SHARED = SHARED | {"fastmath": {"contract"}}

inlined = njit(forceinline=True, **_SHARED, **WITHOUT_PYTHON, **WITHOUT_ADDRESS)
"""A part of a kernel, written once and copied into every kernel that calls it."""

internal = njit(**_SHARED, **WITHOUT_PYTHON, **WITHOUT_ADDRESS)
"""A part of a kernel, written once and called."""

on_demand = njit(**_SHARED, **WITHOUT_PYTHON)
"""A kernel that other kernels call by its address, compiled when a scene first needs it, see `addresses.address_of`."""


def kernel(signature):
    """A kernel that Python or an integrator calls, compiled when its module is first imported."""
    return njit(signature, **_SHARED)
