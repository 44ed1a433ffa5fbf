"""A time by which marches of a thread have to end, whatever they have reached."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

_of_thread = threading.local()


@contextmanager
def deadline(seconds: float | None) -> Iterator[None]:
    """Within it a compiled march of this thread that goes on after so many seconds [s] ends, as by Ctrl-C; None is no limit."""
    before = getattr(_of_thread, "at", None)
    _of_thread.at = before if seconds is None else time.monotonic() + seconds
    try:
        yield
    finally:
        _of_thread.at = before


def time_left() -> float | None:
    """Time until the deadline of this thread [s], 0 once it is over; None if there is none."""
    at = getattr(_of_thread, "at", None)
    return None if at is None else max(0.0, at - time.monotonic())
