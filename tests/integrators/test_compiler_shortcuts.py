"""Shortcuts through Numba's code: the same answers as Numba's own."""

import gc
import operator
from typing import ClassVar

import pytest
from llvmlite.binding import ffi
from numba import njit, types
from numba.core import base, ir, utils
from numba.core.compiler import Flags
from numba.core.errors import UnsupportedError
from numba.core.registry import cpu_target
from numba.core.target_extension import target_registry
from numba.extending import overload
from numba.np import arrayobj

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
        (ir.Assign(ir.Global("name", operator, LOC), C, LOC), [C]),
        (ir.Assign(ir.Expr.phi(LOC), C, LOC), [C]),
        (ir.Assign(ir.Expr.build_map([(A, B), (C, D)], 2, {}, {}, LOC), A, LOC), [A, B, C, D, A]),
    ],
)
def test_variables_of_an_instruction(instruction, variables):
    assert [variable.name for variable in instruction.list_vars()] == [variable.name for variable in variables]


def test_flags_are_equal_where_all_options_are():
    plain, told, other = Flags(), Flags(), Flags()
    told.no_cpython_wrapper = Flags.options["no_cpython_wrapper"].default  # said, and as it is by itself
    other.no_cpython_wrapper = True
    assert told != other and other != told and not plain == other
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


def test_nothing_is_refreshed_that_is_known(monkeypatch):
    context = cpu_target.target_context
    context.refresh()
    asked = []
    monkeypatch.setattr(type(context), "load_additional_registries", lambda self: asked.append(self))
    context.refresh()
    assert not asked
    overload(test_llvm_is_not_timed)(lambda: None)  # a rule that was not there
    context.refresh()
    assert asked == [context]


def test_rules_that_are_added_later_are_found():
    """A function that was refused for want of a rule compiles when there is one."""

    def unknown(x):
        return x

    asks = njit(lambda x: unknown(x))
    with pytest.raises(Exception, match="Untyped global name"):
        asks(1.0)
    overload(unknown)(lambda x: lambda x: 2.0 * x)
    assert njit(lambda x: unknown(x))(1.0) == 2.0


def test_kinds_of_types():
    array = types.Array(types.float64, 2, "C")
    assert isinstance(array, types.Buffer) and isinstance(array, types.Type | int) and not isinstance(array, types.Number)
    assert issubclass(types.Array, types.Buffer) and not issubclass(types.Array, types.Number) and not isinstance(1, types.Type)


def test_what_says_where_it_is_called():
    assert base._has_loc(lambda context, loc: None) and not base._has_loc(lambda context: None)


def test_a_class_of_an_array_is_made_once():
    one, other = types.Array(types.float64, 2, "C"), types.Array(types.float64, 1, "C")
    assert arrayobj.make_array(one) is arrayobj.make_array(types.Array(types.float64, 2, "C"))
    assert arrayobj.make_array(one) is not arrayobj.make_array(other)


def test_rules_are_asked_in_the_same_order():
    class General:
        metadata: ClassVar = {"target": "generic"}

    class OfProcessors(General):
        metadata: ClassVar = {"target": "cpu"}

    class OfOthers(General):
        metadata: ClassVar = {"target": "gpu"}

    rules, target = [General, OfOthers, OfProcessors, General], target_registry["cpu"]
    for _ in range(2):
        assert utils.order_by_target_specificity(target, rules) == [OfProcessors, General, General]
        assert compiler_shortcuts._order_of_rules(target, rules) == [OfProcessors, General, General]
        with pytest.raises(UnsupportedError, match="any matches for function 'this'"):
            utils.order_by_target_specificity(target, [OfOthers], "this")
    assert utils.order_by_target_specificity(target, []) == []
