"""Signals that end a command: Ctrl-C, SIGTERM and SIGHUP, each of them as a KeyboardInterrupt, so that what is done is kept."""

import _thread
import contextlib
import signal
import sys
import threading
import time
from collections.abc import Iterator

NAMES = ("SIGINT", "SIGTERM", "SIGHUP")  # the last is unknown to Windows
BURST = 1.0  # [s] after a signal, in which others are part of it


@contextlib.contextmanager
def stop_signals() -> Iterator[list[int]]:
    """Within it, a signal raises KeyboardInterrupt in the main thread; gives the list of the signals that came.

    Those of a burst, such as Ctrl-C pressed five times, count as one, so that none of them disturbs what puts things in order.
    One that comes later interrupts that too. Signals that are ignored, as `nohup` does, stay so. Once one has come, those that
    come as Python ends are ignored.
    """
    came: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield came
        return
    last = -BURST

    def stop(number, frame):
        nonlocal last
        if time.monotonic() - last > BURST:
            last = time.monotonic()
            came.append(number)
            raise KeyboardInterrupt

    def again(unraisable):
        """A callback of a library, which cannot raise, has taken the interrupt: give it once more."""
        nonlocal last
        if not issubclass(unraisable.exc_type, KeyboardInterrupt):
            return hook(unraisable)
        last = -BURST
        threading.Timer(0.05, _thread.interrupt_main, came[-1:]).start()

    numbers = [getattr(signal, name) for name in NAMES if hasattr(signal, name)]
    heard = {number: was for number in numbers if (was := signal.getsignal(number)) not in (signal.SIG_IGN, None)}
    hook, sys.unraisablehook = sys.unraisablehook, again
    for number in heard:
        signal.signal(number, stop)
    try:
        yield came
    finally:
        for number, was in heard.items():
            signal.signal(number, signal.SIG_IGN if came else was)
        sys.unraisablehook = hook
