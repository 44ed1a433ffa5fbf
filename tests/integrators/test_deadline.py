"""A time by which marches of a thread have to end."""

import threading
import time

import pytest

from integrators.compile_once import compiling
from integrators.deadline import deadline, time_left, uncounted
from integrators.marching.interruptible import interruptible


def until_stopped(at_most, stop):
    """What a compiled march does: it goes on until it is told to stop, or is done."""
    end = time.monotonic() + at_most
    while not stop[0] and time.monotonic() < end:
        time.sleep(0.005)
    return bool(stop[0])


def in_another_thread(call):
    found = []
    thread = threading.Thread(target=lambda: found.append(call()))
    thread.start()
    thread.join()
    return found[0]


@pytest.mark.parametrize("within", [lambda call: call(), in_another_thread], ids=["main thread", "another thread"])
@pytest.mark.parametrize(
    ("seconds", "lasts", "ended"), [(0.05, 60.0, True), (0.0, 60.0, True), (60.0, 0.02, False), (None, 0.02, False)]
)
def test_a_march_ends_at_its_deadline_and_not_before(within, seconds, lasts, ended):
    def march():
        with deadline(seconds):
            return interruptible(until_stopped, lasts)

    assert within(march) == (ended, ended)


def test_a_deadline_is_that_of_its_thread_and_of_its_block():
    with deadline(60.0):
        assert 59.0 < time_left() <= 60.0
        for further in (None, 100.0):
            with deadline(further):
                assert time_left() <= 60.0
        with deadline(5.0):
            assert time_left() <= 5.0
        assert time_left() > 5.0 and in_another_thread(time_left) is None
    assert time_left() is None


def test_what_compiles_does_not_take_a_marchs_time():
    """Blocks within blocks are counted out once, for the deadlines around them, too."""
    with uncounted():
        assert time_left() is None
    with deadline(60.0):
        with deadline(1.0):
            with uncounted():
                with uncounted():
                    time.sleep(0.3)
                time.sleep(0.1)
            assert 0.8 < time_left() <= 1.0
            with compiling():
                time.sleep(0.3)
            assert 0.8 < time_left() <= 1.0
        assert 59.8 < time_left() <= 60.0
    assert time_left() is None
