"""Variables of the environment with which what this package is built on does not work."""

import os
from collections.abc import Mapping

from anet_lumped.checks import InputError


def check_environment(variables: Mapping[str, str] = os.environ) -> None:
    """Refuse settings of Numba under which nothing here can be compiled.

    Raises
    ------
    InputError : NUMBA_DISABLE_JIT is set, or NUMBA_NUM_THREADS is below 1
    """
    if (_integer(variables, "NUMBA_DISABLE_JIT") or 0) != 0:
        told = "must be 0 or not set, as this package calls compiled functions by their addresses"
        raise InputError(f"The variable NUMBA_DISABLE_JIT of the environment {told}, but it is {variables['NUMBA_DISABLE_JIT']}.")
    threads = _integer(variables, "NUMBA_NUM_THREADS")
    if threads is not None and threads < 1:
        raise InputError(f"The variable NUMBA_NUM_THREADS of the environment must be at least 1 or not set, but it is {threads}.")


def _integer(variables, name):
    """An integer, or None where there is none, of which Numba warns itself and takes its default."""
    try:
        return int(variables[name])
    except (KeyError, ValueError):
        return None
