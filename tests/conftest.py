"""What several test files need, and what a run of all of them compiles once for both of its workers."""

import os
from importlib.metadata import version

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads of two workers on two cores wait for each other
os.environ["ANET_LUMPED_QUIET"] = "1"  # tests compare what is told on stderr
if version("jax").startswith("0.10."):  # JAX 0.12 without its optimisations gives wrong derivatives of `where`
    os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")  # what JAX compiles here runs for milliseconds

import gc
import signal
import subprocess
import sys
from functools import partialmethod

import pytest

from integrators.schemes.record import Scheme

COMPILED_FIRST = (
    """if True:
    from anet_lumped import effects
    from anet_lumped.effects import fluid_on_bodies
    from anet_lumped.flight import laws, pilot_kernel
    from anet_lumped.mechanics import changing_lengths

    list(effects.REGISTRY.values())
    """,
    """if True:
    from anet_lumped import Cable, Driven, Fixed, Free, Scene, equilibrium, paths, simulate
    from anet_lumped.effects import Gravity
    from anet_lumped.motion import other_packages, scipy_methods
    from anet_lumped.statics import catenary_net

    held = [Driven("s0", paths.line((-1, 0, 0), (0.1, 0, 0), 1.0)), *(Fixed(f"s{i}", (0.5, i - 2, 0)) for i in (1, 2, 3))]
    cables = [Cable(f"s{i}", "p", length=1.5, mass_per_length=0.1, EA=1e3, segments=4) for i in range(4)]
    net = Scene([*held, Free("p")], [*cables, Cable("s1", "s3", length=3.0, mass_per_length=0.1, EA=1e3, segments=4)], [Gravity()])
    for method in ("edmc", "verlet"):
        simulate(net, 0.01, method=method, dt=1e-3)
    """,
)
"""Statements that together have most of the compiled functions compiled, and apart hardly any of the same."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config):
    """Have what all tests need compiled before workers start, who would compile the same things at the same time."""
    if config.args_source is pytest.Config.ArgsSource.TESTPATHS:
        processes = [subprocess.Popen([sys.executable, "-c", statements], cwd=config.rootpath) for statements in COMPILED_FIRST]
        for process in processes:
            process.wait()  # should one fail, a test will say why


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
