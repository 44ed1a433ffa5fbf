"""Ctrl-C held back while something must not be left half done."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


@contextmanager
def ctrl_c_later(then: Callable[[], None] = lambda: None) -> Iterator[None]:
    """Within it Ctrl-C raises nothing; its exception is raised at the end, as `then()` is called at once.

    Python raises an exception for a signal between any two lines of its main thread, and none in other threads, where there is
    nothing to do. A handler that a program has set for Ctrl-C, SIGTERM or SIGHUP is called as ever; only what it raises waits.
    """
    handlers = {number: handler for number in SIGNALS if callable(handler := signal.getsignal(number))}
    if threading.current_thread() is not threading.main_thread() or not handlers:
        yield
        return
    raised: list[BaseException] = []

    def later(number, frame):
        try:
            handlers[number](number, frame)
        except BaseException as error:
            raised.append(error)
            then()

    for number in handlers:
        signal.signal(number, later)
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        if raised:
            raise raised[0]
