"""Shortcuts through Numba's code: the same answers as Numba's own."""

import gc
import operator

import pytest
from llvmlite.binding import ffi
from numba.core import ir
from numba.core.compiler import Flags

from integrators import compiler_shortcuts

LOC = ir.unknown_loc
SCOPE = ir.Scope(None, LOC)
A, B, C, D = (ir.Var(SCOPE, name, LOC) for name in "abcd")


@pytest.mark.parametrize(
    ("instruction", "variables"),
    [
        (ir.Assign(ir.Expr.binop(operator.add, A, B, LOC), C, LOC), [A, B, C]),
        (ir.Assign(ir.Const(2.0, LOC), C, LOC), [C]),
        (ir.Assign(ir.Expr.call(A, [B, C], {"key": D}, LOC), A, LOC), [A, B, C, D, A]),
        (ir.Assign(ir.Expr.build_tuple((A, B), LOC), C, LOC), [A, B, C]),
        (ir.SetItem(A, B, C, LOC), [A, B, C]),
        (ir.Return(D, LOC), [D]),
        (ir.Jump(0, LOC), []),
    ],
)
def test_variables_of_an_instruction(instruction, variables):
    assert [variable.name for variable in instruction.list_vars()] == [variable.name for variable in variables]


def test_flags_are_equal_where_all_options_are():
    plain, told, other = Flags(), Flags(), Flags()
    told.no_cpython_wrapper = Flags.options["no_cpython_wrapper"].default  # said, and as it is by itself
    other.no_cpython_wrapper = True
    assert plain == Flags() and plain == told and plain != other and other == other.copy() and plain != 1


def test_llvm_is_not_timed():
    assert not [acquire for acquire, _ in ffi.lib._lock._cblist if acquire.__module__ == "numba.core.base"]


@pytest.mark.parametrize("held", [False, True])
def test_old_objects(held):
    was = gc.get_freeze_count()
    if held:
        gc.freeze()
    elif was:
        gc.unfreeze()
    try:
        new = [[]]
        compiler_shortcuts.keep_as_old()
        assert any(new is one for one in gc.get_objects(generation=2)) != held
        assert (gc.get_freeze_count() > 0) == held
    finally:
        gc.freeze() if was else gc.unfreeze()
