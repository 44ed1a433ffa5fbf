"""The interval after which threads switch is short for as long as anyone asks for it, and then what it was."""

import sys
import threading

import pytest

from anet_lumped import load_scene, simulate_many
from anet_lumped.motion import simulate_many as many
from anet_lumped.motion.quick_switches import LONGEST_WAIT, quick_switches


@pytest.fixture(autouse=True)
def interval():
    """Python's default [s], whatever another test left."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(5e-3)
    yield 5e-3
    sys.setswitchinterval(before)


def test_the_last_to_leave_gives_the_interval_back(interval):
    entered, leave = threading.Event(), threading.Event()

    def other():
        with quick_switches():
            entered.set()
            leave.wait()

    thread = threading.Thread(target=other)
    with quick_switches():
        thread.start()
        entered.wait()
    assert sys.getswitchinterval() == pytest.approx(LONGEST_WAIT, rel=1e-3)  # kept in whole microseconds
    leave.set()
    thread.join()
    assert sys.getswitchinterval() == pytest.approx(interval, rel=1e-3)


def test_a_shorter_interval_stays():
    sys.setswitchinterval(2e-5)
    with quick_switches():
        assert sys.getswitchinterval() == pytest.approx(2e-5, rel=1e-3)


def test_the_interval_is_given_back_after_an_error(interval):
    with pytest.raises(ZeroDivisionError), quick_switches():
        1 / 0  # noqa: B018
    assert sys.getswitchinterval() == pytest.approx(interval, rel=1e-3)


@pytest.mark.parametrize(("workers", "expected"), [(1, 5e-3), (2, LONGEST_WAIT)])
def test_threads_of_many_runs_switch_soon(monkeypatch, workers, expected, interval):
    seen, prepared = [], many.prepared

    def looked(repeated, scene):
        seen.append(sys.getswitchinterval())
        return prepared(repeated, scene)

    monkeypatch.setattr(many, "prepared", looked)
    scene = load_scene("net_carried")
    simulate_many(scene, 0.016, vary={"EA": [1e3, 1e4]}, method="edmc", dt=0.008, workers=workers)
    assert seen == pytest.approx([expected] * 2, rel=1e-3)
    assert sys.getswitchinterval() == pytest.approx(interval, rel=1e-3)
