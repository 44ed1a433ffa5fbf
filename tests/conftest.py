"""What several test files need, and what a run of all of them compiles once for both of its workers."""

import os
from importlib.metadata import version

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads of two workers on two cores wait for each other
os.environ["ANET_LUMPED_QUIET"] = "1"  # tests compare what is told on stderr
if version("jax").startswith("0.10."):  # JAX 0.12 without its optimisations gives wrong derivatives of `where`
    os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")  # what JAX compiles here runs for milliseconds

import gc
import signal
from collections import Counter
from functools import partialmethod

import pytest

from integrators.schemes.record import Scheme


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config):
    """Have what all tests need compiled before workers start, who would compile the same things at the same time."""
    if config.args_source is pytest.Config.ArgsSource.TESTPATHS:
        from compiled_first import compile_effects_of_tests, compile_motions_of_tests

        from studies.sweeping.compiled_ahead import compile_ahead

        compile_ahead((compile_effects_of_tests, compile_motions_of_tests))


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Look for garbage neither while files of tests are imported nor, later, in what these have imported: that stays."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_configure(config):
    """Have hypothesis try all examples where the slow tests run, before files of tests are imported."""
    if runs_slow(config):
        import tried

        tried.all_of_them = True


def runs_slow(config) -> bool:
    """Whether it is the slow tests that were asked for."""
    return config.option.markexpr == "slow"


@pytest.hookimpl(tryfirst=True)  # before those that are slow are left out
def pytest_collection_modifyitems(config, items):
    """Choose among parameters and have properties tried once more with the slow tests.

    Of a test that is marked `each_once`, each value of each parameter is tried once by default, not each pair: of two lists of N
    and M values the longer one is gone through, with the values of the other in turn. All other pairs are slow. Properties of
    hypothesis are tried in both runs, with more examples among the slow tests.
    """
    tests = {}
    for item in items:
        if runs_slow(config) and getattr(item.obj, "is_hypothesis_test", False):
            item.add_marker(pytest.mark.slow)
        if item.get_closest_marker("each_once") and not item.get_closest_marker("slow"):
            tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in tests.values():
        left, tried = {item: values_of(item) for item in cases}, Counter()
        while any(tried[value] == 0 for values in left.values() for value in values):
            most = max(left, key=lambda item: (sum(tried[value] == 0 for value in left[item]), -sum(tried[v] for v in left[item])))
            tried.update(left.pop(most))
        for item in left:
            item.add_marker(pytest.mark.slow)


def values_of(item) -> set:
    """What a test is called with, as names and identities; parameters that are given together are one value."""
    given = item.callspec.params
    together = [mark.args[0] for mark in item.iter_markers("parametrize")]
    names = [tuple(name.strip() for name in (one.split(",") if isinstance(one, str) else one)) for one in together]
    names += [(name,) for name in given if not any(name in some for some in names)]  # of fixtures
    return {(some, *(id(given[name]) for name in some)) for some in names}


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
