"""A time by which marches of a thread have to end, whatever they have reached."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

_of_thread = threading.local()


@contextmanager
def deadline(seconds: float | None) -> Iterator[None]:
    """Within it a compiled march of this thread that goes on after so many seconds [s] ends, as by Ctrl-C; None is no limit.

    A deadline within another one does not put that off.
    """
    before = getattr(_of_thread, "at", None)
    own = before if seconds is None else time.monotonic() + seconds
    _of_thread.at = own if before is None else min(before, own)
    try:
        yield
    finally:
        _of_thread.at = before


def time_left() -> float | None:
    """Time until the deadline of this thread [s], 0 once it is over; None if there is none."""
    at = getattr(_of_thread, "at", None)
    return None if at is None else max(0.0, at - time.monotonic())
