"""Compiling in one thread at a time, each function once, and never by halves."""

import gc
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from functools import wraps
from threading import RLock
from typing import Any

from numba.core.compiler_lock import global_compiler_lock

from .compiler_shortcuts import keep_as_old
from .ctrl_c import ctrl_c_later
from .deadline import uncounted


@contextmanager
def compiling() -> Iterator[None]:
    """Other threads wait, and so does Ctrl-C: what Numba leaves behind when it is interrupted compiles no more in this process.

    The lock is Numba's own, so that no two locks can wait for each other. The time is not counted for a deadline: where nothing is
    compiled yet, the first run of a sweep would otherwise be over its budget.
    """
    with uncounted(), ctrl_c_later(), global_compiler_lock, _without_collection():
        yield


@contextmanager
def _without_collection() -> Iterator[None]:
    """Python's search for circular garbage waits: it takes a tenth of the time in which a function compiles, and finds little."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            keep_as_old()
            gc.enable()


def once(make: Callable[..., Any]) -> Callable[..., Any]:
    """Have a function that compiles called once for the same arguments: threads that ask at the same time wait for the first.

    `functools.cache` would have each of them compile.
    """
    made: dict[tuple[Hashable, ...], Any] = {}
    lock = RLock()

    @wraps(make)
    def ask(*given: Hashable) -> Any:
        if given not in made:
            with uncounted(), lock:
                if given not in made:
                    made[given] = make(*given)
        return made[given]

    return ask


def compile_for(function, signature):
    """Compile a function of Numba's for one signature alone, or load it from the disk, unless that is done; returns it.

    Parameters
    ----------
    function : compiled by Numba
    signature : of Numba's, or the types of its arguments
    """
    if not function.overloads:  # `signatures` makes a list of them
        with compiling():
            if not function.overloads:
                function.compile(signature)
                function.disable_compile()
    return function
