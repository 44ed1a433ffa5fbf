"""The rules that Numba asks first answer as its own do, and leave to those what they do not know."""

import operator

import pytest
from numba import types
from numba.core import utils
from numba.core.registry import cpu_target
from numba.core.target_extension import get_local_target

from integrators import typing_rules

ARRAY, INDEX = types.Array(types.float64, 2, "C"), types.UniTuple(types.int64, 2)
ARITHMETIC = ("add", "sub", "mul", "truediv", "iadd", "isub", "imul", "itruediv")
COMPARISONS = ("lt", "le", "gt", "ge", "eq", "ne")
NUMBERS = [
    (name, (number, number)) for name in (*ARITHMETIC, *COMPARISONS) for number in (types.float64, types.int64, types.float32)
]


@pytest.fixture(scope="module")
def rules():
    """What Numba asks about an operation, in order: the rules of this package, and its own."""
    context = cpu_target.typing_context
    context.refresh()

    def rules(name):
        templates = context.resolve_value_type(getattr(operator, name)).templates
        order = utils.order_by_target_specificity(get_local_target(context), templates)
        assert issubclass(order[0], (typing_rules._Read, typing_rules._Write, typing_rules._TwoNumbers))
        return [order[0](context)], [rule(context) for rule in order[1:]]

    return rules


def first_answer(rules, asked):
    """The signature that is found, and what its code is found by."""
    for rule in rules:
        found = rule.apply(asked, {})
        if found is not None:
            return found, rule.get_impl_key(found)
    return None


@pytest.mark.parametrize(("name", "asked"), [
    *NUMBERS,
    ("getitem", (ARRAY, INDEX)), ("getitem", (ARRAY, types.int64)), ("getitem", (ARRAY, types.slice2_type)),
    ("setitem", (ARRAY, INDEX, types.float64)), ("setitem", (ARRAY, INDEX, types.int64)), ("setitem", (ARRAY, types.int64, ARRAY)),
])  # fmt: skip
def test_they_answer_as_numba_does(rules, name, asked):
    ours, own = rules(name)
    expected = first_answer(own, asked)
    assert expected is not None and first_answer([*ours, *own], asked) == expected
    assert (first_answer(ours, asked) is None) == (asked[0] == types.float32 or (asked[0] == types.int64 and "truediv" in name))


@pytest.mark.parametrize("asked", [(types.float64, types.int64), (ARRAY, ARRAY), (types.boolean, types.boolean), (types.float64,)])
def test_what_they_do_not_know_is_left_to_numba(rules, asked):
    assert first_answer(rules("add")[0], asked) is None


@pytest.mark.parametrize("held", [types.unicode_type, types.UniTuple(types.float64, 3), types.List(types.float64)])
def test_items_of_other_things_are_left_to_numba(rules, held):
    assert first_answer(rules("getitem")[0], (held, types.int64)) is None
