"""Ctrl-C held back while something must not be left half done."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def ctrl_c_later(then: Callable[[], None] = lambda: None) -> Iterator[None]:
    """Within it Ctrl-C raises nothing; its exception is raised at the end, as `then()` is called at once.

    Python raises an exception for a signal between any two lines of its main thread, and none in other threads, where there is
    nothing to do. A handler that a program has set for Ctrl-C is called as ever; only what it raises has to wait.
    """
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    raised: list[BaseException] = []

    def later(number, frame):
        try:
            handler(number, frame)
        except BaseException as error:
            raised.append(error)
            then()

    signal.signal(signal.SIGINT, later)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if raised:
            raise raised[0]
