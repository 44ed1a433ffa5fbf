"""Python code that threads pass on to one another soon: marches of one thread start while another one prepares its runs."""

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

LONGEST_WAIT = 1e-4  # [s] a twentieth of a short march; a switch takes some 10 microseconds


class _Switches:
    """How many are within `quick_switches`, and the interval before the first of them [s]."""

    def __init__(self) -> None:
        self.lock, self.count, self.before = threading.Lock(), 0, 0.0


_SWITCHES = _Switches()


@contextmanager
def quick_switches() -> Iterator[None]:
    """Let a thread that asks for the interpreter get it after `LONGEST_WAIT` at most, instead of Python's 5 ms.

    Compiled code does without the interpreter, but each march begins and ends in Python. Where one thread prepares runs for some
    20 ms, another one would wait for 5 ms after every march of 2 ms. A shorter interval of the caller is left as it is.
    """
    with _SWITCHES.lock:
        _SWITCHES.count += 1
        if _SWITCHES.count == 1:
            _SWITCHES.before = sys.getswitchinterval()
            sys.setswitchinterval(min(LONGEST_WAIT, _SWITCHES.before))
    try:
        yield
    finally:
        with _SWITCHES.lock:
            _SWITCHES.count -= 1
            if _SWITCHES.count == 0:
                sys.setswitchinterval(_SWITCHES.before)
