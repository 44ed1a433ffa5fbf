"""What several test files need."""

import signal
from functools import partialmethod

import pytest

from integrators.schemes.record import Scheme


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
