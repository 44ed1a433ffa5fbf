"""Ctrl-C, and what handlers of other signals raise, held back while something must not be left half done."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

# Those of timers come last: they are the likeliest to raise between two lines that set handlers.
NAMES = ("SIGINT", "SIGBREAK", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGCHLD", "SIGPROF", "SIGVTALRM", "SIGALRM")
SIGNALS = [getattr(signal, name) for name in NAMES if hasattr(signal, name)]


@contextmanager
def ctrl_c_later(then: Callable[[], None] = lambda: None) -> Iterator[None]:
    """Within it Ctrl-C raises nothing; its exception is raised at the end, as `then()` is called at once.

    Python raises an exception for a signal between any two lines of its main thread, and none in other threads, where there is
    nothing to do. A handler that a program has set for one of SIGNALS is called as ever; only what it raises waits, be it the
    TimeoutError of an alarm.
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

    try:
        for number in handlers:
            signal.signal(number, later)
        yield
    finally:
        _set(handlers, raised)
        if raised:
            raise raised[0]


def _set(handlers, raised):
    """Set all handlers, also if one of them raises as soon as it is set."""
    for number, handler in handlers.items():
        is_set = False
        while not is_set:
            try:
                signal.signal(number, handler)
                is_set = True
            except BaseException as error:
                raised.append(error)
                is_set = signal.getsignal(number) is handler
