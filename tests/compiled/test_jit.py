"""Laws: what Python calls first must not decide what they do in an effect."""

import math
from importlib import import_module
from pathlib import Path

import pytest
from numba import float64
from numba.core.dispatcher import Dispatcher

import anet_lumped
from anet_lumped.compiled.exceptions import may_raise
from anet_lumped.compiled.jit import inlined_law, law, njit

ROOT = Path(anet_lumped.__file__).parents[1]
EFFECTS = [".".join(file.relative_to(ROOT).with_suffix("").parts) for file in sorted((ROOT / "anet_lumped/effects").rglob("*.py"))]


def reciprocal(x):
    return 1.0 / x


@pytest.mark.parametrize("decorate", [inlined_law, law])
def test_a_law_that_python_called_first_raises_nothing_in_an_effect(decorate):
    one_law = decorate(reciprocal)
    assert one_law(0.0) == math.inf
    kernel = njit(float64(float64), error_model="numpy")(lambda x: one_law(x))
    assert may_raise(kernel) == () and kernel(0.0) == math.inf


@pytest.mark.parametrize("module", EFFECTS)
def test_every_part_of_an_effect_says_what_a_division_by_zero_is(module):
    """One that is compiled for whatever calls it would take that from its first caller, and on the disk keep it for all others."""
    names = vars(import_module(module))
    parts = {name: part for name, part in names.items() if isinstance(part, Dispatcher) and part._can_compile}
    assert {name for name, part in parts.items() if part.targetoptions.get("error_model") != "numpy"} == set()
