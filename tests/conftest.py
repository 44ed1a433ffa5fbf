"""What several test files need, and what a run of all of them compiles once for both of its workers."""

import os
from importlib.metadata import version

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads of two workers on two cores wait for each other
os.environ["ANET_LUMPED_QUIET"] = "1"  # tests compare what is told on stderr
if version("jax").startswith("0.10."):  # JAX 0.12 without its optimisations gives wrong derivatives of `where`
    os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")  # what JAX compiles here runs for milliseconds

import gc
import signal
from functools import partialmethod

import pytest

from integrators.schemes.record import Scheme


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config):
    """Have what all tests need compiled before workers start, who would compile the same things at the same time."""
    if config.args_source is pytest.Config.ArgsSource.TESTPATHS:
        from compiled_first import compile_motions_of_tests

        from studies.sweeping.compiled_ahead import compile_ahead, compile_effects

        compile_ahead((compile_effects, compile_motions_of_tests))


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Look for garbage neither while files of tests are imported nor, later, in what these have imported: that stays."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture
def ctrl_c():
    """Ctrl-C raises KeyboardInterrupt, here and in child processes, even where the suite runs in the background."""
    was = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, was)


@pytest.fixture
def solve_to(monkeypatch):
    """Set Newton's tolerance, relative to the largest force on a node, so that a motion does not depend on when it stops."""
    original = Scheme.parameters

    def solve_to(tolerance):
        monkeypatch.setattr(Scheme, "parameters", partialmethod(original, tolerance=tolerance))

    return solve_to
