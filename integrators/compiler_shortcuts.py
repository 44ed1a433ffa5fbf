"""Quicker ways through Numba's own Python code, which takes half of the time in which a function compiles.

What is compiled is the same to the last bit: each shortcut gives the answer that Numba's code gives.
"""

import gc
from collections.abc import Iterable
from typing import Any

from llvmlite.binding import ffi
from numba.core import ir
from numba.core.targetconfig import TargetConfig

_WITHOUT_VARIABLES = frozenset({str, int, float, bool, type(None), ir.Loc})


def variables_in(instruction: ir.Inst, value: Any) -> list[ir.Var]:
    """Variables in a field of an instruction of Numba's, however deep, in their order; some millions of fields are asked."""
    found: list[ir.Var] = []
    _collect((value,), found)
    return found


def _collect(values: Iterable[Any], found: list[ir.Var]) -> None:
    """Append the variables in `values` to `found`."""
    for value in values:
        kind = type(value)
        if kind is ir.Var:
            found.append(value)
        elif kind in _WITHOUT_VARIABLES:
            continue
        elif isinstance(value, ir.Var):
            found.append(value)
        elif isinstance(value, ir.Inst):
            found.extend(value.list_vars())
        elif isinstance(value, list | tuple):
            _collect(value, found)
        elif isinstance(value, dict):
            _collect(value.values(), found)


def same_flags(flags: TargetConfig, other: object) -> bool:
    """Whether two sets of flags are equal: where they set the same options to the same values, no default need be compared."""
    if type(flags) is type(other) and flags._values == other._values:
        return True
    return _compare_all(flags, other)


def keep_as_old() -> None:
    """Count all objects as old, if nobody holds some apart from the search for garbage (`gc.freeze`).

    What a compiler leaves behind stays, and Python would go through all of it two times before it believes that.
    """
    if gc.get_freeze_count() == 0:
        gc.freeze()
        gc.unfreeze()


_compare_all = TargetConfig.__eq__
ir.Inst._rec_list_vars = variables_in
TargetConfig.__eq__ = same_flags
for _callbacks in list(ffi.lib._lock._cblist):  # which time every call of LLVM, some hundred thousand, and nobody asks for
    if _callbacks[0].__module__ == "numba.core.base":
        ffi.lib._lock.unregister(*_callbacks)
