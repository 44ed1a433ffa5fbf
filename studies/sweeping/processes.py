"""How processes begin that work for this one: which signals reach them, what they import, and that they end with it."""

import contextlib
import logging
import multiprocessing
import os
import signal
import sys
import threading
import types
import warnings
from collections.abc import Iterator

_main_is_swapped = threading.Lock()


@contextlib.contextmanager
def held_back(*names: str) -> Iterator[None]:
    """Hold signals back from this thread; processes that a new program begins within never get them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {getattr(signal, name) for name in names})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def script_untouched() -> Iterator[None]:
    """Within it, one thread at a time begins a process, with the script which the program began with as `__main__`."""
    with _main_is_swapped:
        yield


@contextlib.contextmanager
def without_script() -> Iterator[None]:
    """Within it, a process that begins does not import the script which the program began with, so that it needs no guard."""
    with _main_is_swapped:
        script, sys.modules["__main__"] = sys.modules["__main__"], types.ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = script


def prepare_process() -> None:
    """Leave Ctrl-C to the parent, die with the parent, keep warnings off the progress bar (rows carry a status)."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.simplefilter("ignore")
    logging.getLogger("integrators").setLevel(logging.ERROR)  # that code cannot be kept on the disk, the parent tells
    threading.Thread(target=_die_with_parent, daemon=True).start()


def _die_with_parent():
    multiprocessing.parent_process().join()
    os._exit(1)
