"""Signals that end a program wait until what must not be left half done is done."""

import os
import signal
import threading
import time

import pytest

from integrators.ctrl_c import SIGNALS, ctrl_c_later
from integrators.marching import interruptible as interruptible_module
from integrators.marching.interruptible import interruptible


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


def test_ctrl_c_in_a_short_march_waits_for_its_end(ctrl_c):
    """A short march runs in the thread that asks for it, and what it did is handed over."""

    def march(stop):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.01)
        return threading.current_thread(), stop[0]

    (thread, stop), interrupted = interruptible(march, short=True)
    assert interrupted and thread is threading.main_thread() and stop == 0


def test_ctrl_c_ends_a_long_march(ctrl_c):
    def march(stop):
        os.kill(os.getpid(), signal.SIGINT)
        while not stop[0]:
            time.sleep(0.001)
        return threading.current_thread()

    thread, interrupted = interruptible(march)
    assert interrupted and thread is not threading.main_thread()


def test_what_is_told_may_raise_and_the_march_has_ended_by_then(monkeypatch):
    """A march works on arrays by their addresses: nobody may let them go while it runs."""
    ended = []

    def march(stop):
        while not stop[0]:
            time.sleep(0.001)
        time.sleep(0.05)
        ended.append(True)

    def tell():
        raise OSError("the terminal is gone")

    monkeypatch.setattr(interruptible_module, "TOLD_EVERY", 0.01)
    with pytest.raises(OSError, match="the terminal is gone"):
        interruptible(march, tell=tell)
    assert ended == [True]


def test_handlers_that_raise_as_soon_as_they_are_set_leave_none_unset(monkeypatch):
    """As that of a timer may, between any two lines in which handlers are set."""

    def handler(number, frame):
        raise TimeoutError

    def set_and_raise(number, given, set_it=signal.signal):
        set_it(number, given)
        if given is handler:
            signal.raise_signal(number)

    was = {number: signal.signal(number, handler) for number in SIGNALS}
    try:
        with monkeypatch.context() as patched:
            patched.setattr(signal, "signal", set_and_raise)
            with pytest.raises(TimeoutError), ctrl_c_later():
                pass
        assert all(signal.getsignal(number) is handler for number in SIGNALS)
    finally:
        for number, handler in was.items():
            signal.signal(number, handler)
