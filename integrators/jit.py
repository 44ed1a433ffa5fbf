"""How functions are compiled: `njit`, and four decorators, one for each way in which a function is called.

None of the four counts references to arrays: these functions allocate nothing, and their callers hold the arrays that they read and
write. Without reference counts, and without wrappers that no caller needs, a function compiles in half the time.
"""

import numba

from . import compiler_shortcuts, typing_rules  # noqa: F401  which every kernel is compiled with
from .compile_once import compile_for
from .kept_code import KeptCode
from .linked_code import LinkedCompiler


def njit(signature=None, cache=False, **options):
    """`numba.njit` for all that these packages compile: Ctrl-C does not leave a function half compiled, and `KeptCode` keeps it.

    Parameters
    ----------
    signature : of Numba's, or None
        The only one, for which it is compiled at once; without, each caller has it compiled for the types that it calls it with.
    cache : bool
        Whether compiled code is kept on the disk.
    options : of `numba.njit`
    """

    def decorate(function):
        dispatcher = numba.njit(**options)(function)
        if cache:
            dispatcher._cache = KeptCode(function)
        return dispatcher if signature is None else compile_for(dispatcher, signature)

    return decorate


SHARED = {"cache": True, "error_model": "numpy", "_nrt": False}
WITHOUT_PYTHON, WITHOUT_ADDRESS = {"no_cpython_wrapper": True}, {"no_cfunc_wrapper": True}
ONLY_LINKED = WITHOUT_PYTHON | WITHOUT_ADDRESS | {"pipeline_class": LinkedCompiler}

inlined = njit(forceinline=True, **SHARED, **ONLY_LINKED)
"""A part of a function, written once, copied into every function that calls it."""

internal = njit(**SHARED, **ONLY_LINKED)
"""A function that compiled functions call."""

scheme_step = njit(**SHARED, **WITHOUT_PYTHON)
"""The step of a scheme, which a march calls by its address."""

march_loop = njit(nogil=True, **SHARED, **WITHOUT_ADDRESS)
"""A loop over steps, which Python calls."""
