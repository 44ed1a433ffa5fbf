"""How functions are compiled: `njit`, and seven decorators, one for each way in which a function is called.

Only those of laws count references to arrays. The others allocate nothing, and their callers hold the arrays that they read and
write. Without reference counts, and without a wrapper for Python, a function compiles in half the time.
"""

from integrators.jit import ONLY_LINKED, SHARED, WITHOUT_PYTHON, njit

__all__ = ["inlined", "inlined_law", "internal", "kernel", "law", "njit", "on_demand", "sum_on_demand"]

_SHARED = SHARED | {"fastmath": {"contract"}}

inlined = njit(forceinline=True, **_SHARED, **ONLY_LINKED)
"""A part of a kernel, written once and copied into every kernel that calls it."""

internal = njit(**_SHARED, **ONLY_LINKED)
"""A part of a kernel, written once and called."""

on_demand = njit(**_SHARED, **WITHOUT_PYTHON)
"""A kernel that other kernels call by its address, compiled when a scene first needs it, see `addresses.address_of`."""

sum_on_demand = njit(**(_SHARED | {"fastmath": {"contract", "reassoc", "nsz"}}), **WITHOUT_PYTHON)
"""As `on_demand`, for long sums: terms are added in any order, so that a processor works on several at once; NaN stays NaN."""


def kernel(signature):
    """A kernel that Python or an integrator calls, compiled when its module is first imported."""
    return njit(signature, **_SHARED)


_OF_A_LAW = {"cache": True, "error_model": "numpy"}

inlined_law = njit(forceinline=True, **_OF_A_LAW)
"""The law of one element, or a part of one, copied into every effect and kernel that calls it. Python may call it, too.

A function that does not say its error model takes that of its first caller, and is kept so on the disk for all others. If Python
were the first, a division in it could raise in every effect that calls it.
"""

law = njit(**_OF_A_LAW)
"""A longer law of one element, written once and called; as `inlined_law` otherwise."""
