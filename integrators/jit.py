"""How functions are compiled: four decorators, one for each way in which a function is called.

None of them counts references to arrays: these functions allocate nothing, and their callers hold the arrays that they read and
write. Without reference counts, and without wrappers that no caller needs, a function compiles in half the time.
"""

from numba import njit

SHARED = {"cache": True, "error_model": "numpy", "_nrt": False}
WITHOUT_PYTHON, WITHOUT_ADDRESS = {"no_cpython_wrapper": True}, {"no_cfunc_wrapper": True}

inlined = njit(forceinline=True, **SHARED, **WITHOUT_PYTHON, **WITHOUT_ADDRESS)
"""A part of a function, written once, copied into every function that calls it."""

internal = njit(**SHARED, **WITHOUT_PYTHON, **WITHOUT_ADDRESS)
"""A function that compiled functions call."""

scheme_step = njit(**SHARED, **WITHOUT_PYTHON)
"""The step of a scheme, which a march calls by its address."""

march_loop = njit(nogil=True, **SHARED, **WITHOUT_ADDRESS)
"""A loop over steps, which Python calls."""
