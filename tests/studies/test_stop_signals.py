"""Signals that end a command: what is done is kept, the exit status names the signal, and a burst of them is one."""

import os
import signal
import sys
import threading
import time
from types import SimpleNamespace

import pytest
from program import PROGRAM, call
from slow import slow
from test_commands_of_many import SLOW
from test_rows import start_and_wait_for_rows, wait_for_end_of

import anet_lumped.flight.fly  # noqa: F401 (its module is changed by name)
from anet_lumped import load_run
from integrators.marching import interruptible
from studies import stop_signals as module
from studies import telling
from studies.stop_signals import stop_signals
from studies.sweeping.processes import held_back
from studies.sweeping.rows import run_rows


@pytest.fixture(autouse=True)
def heard():
    """No signal is ignored, as one is in what runs in the background."""
    ignored = [number for number in SIGNALS if signal.getsignal(number) == signal.SIG_IGN]
    for number in ignored:
        signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
    yield
    for number in ignored:
        signal.signal(number, signal.SIG_IGN)


SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.fixture(autouse=True)
def handlers(ctrl_c):
    were = {number: signal.getsignal(number) for number in SIGNALS}
    yield
    for number, handler in were.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_is_an_interrupt_and_its_burst_is_none(number):
    in_order = False
    with pytest.raises(KeyboardInterrupt), stop_signals() as came:
        try:
            os.kill(os.getpid(), number)
            time.sleep(10)
        finally:
            for _ in range(5):
                os.kill(os.getpid(), number)  # would end what puts things in order
            in_order = True
    assert in_order and came == [number]
    assert signal.getsignal(number) is signal.SIG_IGN  # while Python ends


def test_a_signal_that_comes_later_interrupts_again(monkeypatch):
    monkeypatch.setattr(module, "BURST", 0.0)
    with pytest.raises(KeyboardInterrupt), stop_signals() as came:
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(10)
        except KeyboardInterrupt:
            time.sleep(0.01)
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(10)
    assert came == [signal.SIGINT, signal.SIGTERM]


def test_an_interrupt_that_a_callback_has_taken_comes_again(monkeypatch):
    told = []
    monkeypatch.setattr(sys, "unraisablehook", told.append)
    with pytest.raises(KeyboardInterrupt), stop_signals():
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(10)
        sys.unraisablehook(SimpleNamespace(exc_type=OSError))
        sys.unraisablehook(SimpleNamespace(exc_type=KeyboardInterrupt))
        for _ in range(1000):  # it comes between two lines of Python, and ends no wait
            time.sleep(0.01)
    assert [one.exc_type for one in told] == [OSError]


def test_ignored_signals_stay_so_and_others_are_given_back():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    before = signal.getsignal(signal.SIGTERM)
    with stop_signals() as came:
        os.kill(os.getpid(), signal.SIGHUP)
        assert signal.getsignal(signal.SIGTERM) is not before
    assert came == [] and signal.getsignal(signal.SIGTERM) is before and signal.getsignal(signal.SIGHUP) is signal.SIG_IGN


def test_another_thread_leaves_signals_alone():
    seen = []

    def elsewhere():
        with stop_signals() as came:
            seen.append((came, signal.getsignal(signal.SIGTERM)))

    before = signal.getsignal(signal.SIGTERM)
    thread = threading.Thread(target=elsewhere)
    thread.start()
    thread.join()
    assert seen == [([], before)]


def blocked(row):
    """Whether a worker gets the signals that a terminal sends to all."""
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    return {number.name: number in mask for number in SIGNALS}


def test_workers_leave_signals_of_the_terminal_to_who_began_them():
    table = run_rows(blocked, [{"x": 1}], workers=1)
    assert table[["SIGINT", "SIGHUP", "SIGTERM"]].values.tolist() == [[True, True, False]]


def test_signals_are_held_back_while_workers_start():
    with stop_signals() as came, pytest.raises(KeyboardInterrupt):
        with held_back("SIGTERM"):
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(0.05)
            assert came == []
        time.sleep(10)
    assert came == [signal.SIGTERM]


@pytest.mark.parametrize("number", [SIGNALS[0], *slow(*SIGNALS[1:])])
def test_a_run_that_is_stopped_is_saved(number, monkeypatch, tmp_path):
    """The signal comes as the march first says how far it is."""
    monkeypatch.setattr(interruptible, "TOLD_EVERY", 0.2)
    monkeypatch.setattr(telling, "QUIET", 0.0)
    monkeypatch.setattr(telling, "tell", lambda line: os.kill(os.getpid(), number) if " step" in line else None)
    long = [
        "simulate",
        "loose_cable",
        "--start",
        "straight",
        "--t-end",
        5e4,
        "--method",
        "edmc",
        "--dt",
        "10ms",
        "--save-every",
        "1s",
    ]
    assert call(*long, "--out", tmp_path) == 128 + number
    assert {"run.json", "run.nc"} <= {file.name for file in tmp_path.iterdir()}
    assert '"status": "interrupted"' in (tmp_path / "run.json").read_text()


def test_a_flight_that_is_stopped_is_saved(monkeypatch, tmp_path):
    monkeypatch.setattr(sys.modules["anet_lumped.flight.fly"], "TOLD_EVERY", 0.2)
    monkeypatch.setattr(telling, "QUIET", 0.0)
    monkeypatch.setattr(telling, "tell", lambda line: os.kill(os.getpid(), signal.SIGINT) if "step " in line else None)
    flight = ["fly", "quadrotor_hover", "--t-end", 1e4, "--save-every", "1s"]
    assert call(*flight, "--out", tmp_path) == 130
    run = load_run(tmp_path / "run.nc")
    assert run.status == "interrupted" and 0.0 < run.t[-1] < 1e4 and "stopped by the user" in (tmp_path / "run.json").read_text()


@pytest.mark.parametrize(
    ("number", "whole_group"),
    [
        (signal.SIGTERM, True),
        pytest.param(signal.SIGHUP, False, marks=pytest.mark.slow),
        pytest.param(signal.SIGTERM, False, marks=pytest.mark.slow),
        pytest.param(signal.SIGHUP, True, marks=pytest.mark.slow),
    ],
)
def test_a_sweep_that_is_stopped_leaves_its_rows_and_nothing_else(number, whole_group, tmp_path):
    process = start_and_wait_for_rows(tmp_path, *PROGRAM, *SLOW, "--out", str(tmp_path))
    for _ in range(5):
        (os.killpg if whole_group else os.kill)(process.pid, number)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 128 + number
    assert f"which are in {tmp_path}/rows.jsonl. The same command with --resume does the rest." in said
    assert "Traceback" not in said and "leak" not in said and "ignored" not in said
    assert wait_for_end_of(process.pid)
    assert {file.name for file in tmp_path.iterdir()} == {"rows.jsonl", "meta.json"}
