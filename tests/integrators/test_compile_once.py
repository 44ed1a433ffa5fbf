"""Compiling: each function once whatever threads ask for it, and never by halves whenever Ctrl-C comes."""

import gc
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numba
import pytest
from numba.core import event

from integrators.compile_once import compile_for, compiling, once
from integrators.ctrl_c import ctrl_c_later
from integrators.jit import njit

SIGNATURE = numba.float64(numba.float64)


def doubled():
    """A function of Numba's that is new."""
    return njit()(lambda x: 2.0 * x)


class Pressed(event.Listener):
    """Ctrl-C, three times in a row, as Numba begins to compile, and again as it ends."""

    def on_start(self, event):
        for _ in range(3):
            signal.raise_signal(signal.SIGINT)

    def on_end(self, event):
        signal.raise_signal(signal.SIGINT)


def in_threads(function, count=8):
    """What `function()` returns in threads that call it at the same time."""
    together = threading.Barrier(count)

    def call(_):
        together.wait()
        return function()

    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(call, range(count)))


def test_threads_that_need_a_function_at_once_all_get_it():
    for _ in range(5):
        function = doubled()
        assert in_threads(lambda function=function: compile_for(function, SIGNATURE)(1.5)) == [3.0] * 8
        assert len(function.signatures) == 1


def test_what_compiles_is_called_once():
    calls = []

    @once
    def slow(x):
        calls.append(x)
        time.sleep(0.05)
        return object()

    assert len(set(in_threads(lambda: slow(1)))) == 1 and calls == [1]
    assert slow(2) is not slow(1) and calls == [1, 2]


def test_what_fails_is_tried_again():
    calls = []

    @once
    def make(x):
        calls.append(x)
        if len(calls) == 1:
            raise KeyboardInterrupt
        return x

    with pytest.raises(KeyboardInterrupt):
        make(1)
    assert in_threads(lambda: make(1)) == [1] * 8 and calls == [1, 1]


def test_ctrl_c_waits_until_a_function_is_compiled(ctrl_c):
    function = doubled()
    with event.install_listener("numba:compile", Pressed()), pytest.raises(KeyboardInterrupt):
        compile_for(function, SIGNATURE)
    assert function.signatures == [(numba.float64,)]
    assert in_threads(lambda: compile_for(function, SIGNATURE)(1.5)) == [3.0] * 8  # no lock is left, either


def test_ctrl_c_in_a_module_that_compiles_leaves_a_module_that_can_be_imported(ctrl_c):
    source = "from integrators.jit import njit\n@njit('float64(float64)')\ndef f(x):\n    return 2.0 * x\n"
    with event.install_listener("numba:compile", Pressed()), pytest.raises(KeyboardInterrupt):
        exec(source, {})
    names = {}
    exec(source, names)
    assert names["f"](1.5) == 3.0


def test_ctrl_c_is_raised_at_the_end_once(ctrl_c):
    done, called = [], []
    with pytest.raises(KeyboardInterrupt), ctrl_c_later(lambda: called.append(1)):
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        done.append(1)
    assert done == [1] and called == [1, 1] and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with ctrl_c_later():
        pass


def test_ctrl_c_is_raised_in_place_of_another_error(ctrl_c):
    with pytest.raises(KeyboardInterrupt), ctrl_c_later():
        signal.raise_signal(signal.SIGINT)
        raise ValueError


def test_a_handler_of_the_program_is_called_as_ever(ctrl_c):
    """One that only counts stops nothing."""
    heard, called = [], []
    signal.signal(signal.SIGINT, lambda *given: heard.append(1))
    with ctrl_c_later(lambda: called.append(1)):
        signal.raise_signal(signal.SIGINT)
        assert heard == [1]
    assert called == []


@pytest.mark.parametrize("handler", [signal.SIG_IGN, signal.SIG_DFL])
def test_where_ctrl_c_raises_nothing_there_is_nothing_to_do(ctrl_c, handler):
    signal.signal(signal.SIGINT, handler)
    with ctrl_c_later():
        assert signal.getsignal(signal.SIGINT) == handler
    assert signal.getsignal(signal.SIGINT) == handler


def test_other_threads_leave_the_handler_alone(ctrl_c):
    def handler_within():
        with ctrl_c_later():
            return signal.getsignal(signal.SIGINT)

    assert in_threads(handler_within) == [signal.default_int_handler] * 8


@pytest.mark.parametrize("enabled", [True, False])
def test_garbage_waits_while_something_is_compiled(enabled):
    """And only then, also if compiling fails."""
    was_enabled = gc.isenabled()
    (gc.enable if enabled else gc.disable)()
    try:
        with pytest.raises(ZeroDivisionError), compiling():
            with compiling():
                assert not gc.isenabled()
            assert not gc.isenabled()
            raise ZeroDivisionError
        assert gc.isenabled() is enabled
    finally:
        (gc.enable if was_enabled else gc.disable)()
