"""Values of a parameter that are tried with the slow tests."""

import pytest


def slow(*values) -> list:
    """The same values, marked; several parameters of one case are a tuple."""
    return [pytest.param(*(value if isinstance(value, tuple) else (value,)), marks=pytest.mark.slow) for value in values]
