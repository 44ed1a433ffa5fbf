"""A time by which marches of a thread have to end, whatever they have reached."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

_of_thread = threading.local()


@contextmanager
def deadline(seconds: float | None) -> Iterator[None]:
    """Within it a compiled march of this thread that goes on after so many seconds [s] ends, as by Ctrl-C; None is no limit.

    A deadline within another one does not put that off. Time in a block that is `uncounted` does, and puts all of them off.
    """
    before, began = getattr(_of_thread, "at", None), _uncounted()
    own = before if seconds is None else time.monotonic() + seconds
    _of_thread.at = own if before is None else min(before, own)
    try:
        yield
    finally:
        _of_thread.at = None if before is None else before + _uncounted() - began


@contextmanager
def uncounted() -> Iterator[None]:
    """Time within it puts the deadline of this thread off: a march is not to blame for what has to compile first."""
    at = getattr(_of_thread, "at", None)
    if at is None:
        yield
        return
    began, before = time.monotonic(), _uncounted()
    try:
        yield
    finally:
        took = time.monotonic() - began
        _of_thread.at = at + took
        _of_thread.uncounted = before + took  # blocks within this one are a part of it


def _uncounted() -> float:
    """Time that this thread did not count while it had a deadline [s]."""
    return getattr(_of_thread, "uncounted", 0.0)


def time_left() -> float | None:
    """Time until the deadline of this thread [s], 0 once it is over; None if there is none."""
    at = getattr(_of_thread, "at", None)
    return None if at is None else max(0.0, at - time.monotonic())
