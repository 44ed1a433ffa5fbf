"""Signals that end a program wait until what must not be left half done is done."""

import os
import signal
import time

import pytest

from integrators.ctrl_c import SIGNALS, ctrl_c_later


@pytest.mark.parametrize("number", SIGNALS)
def test_what_a_handler_raises_waits(number):
    def handler(number, frame):
        raise SystemExit(128 + number)

    was, done, called = signal.signal(number, handler), [], []
    try:
        with pytest.raises(SystemExit, match=str(128 + number)), ctrl_c_later(lambda: called.append(number)):
            os.kill(os.getpid(), number)
            time.sleep(0.01)
            done.append(number)
        assert done == called == [number] and signal.getsignal(number) is handler
    finally:
        signal.signal(number, was)
