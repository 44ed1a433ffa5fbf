"""Quicker ways through Numba's own Python code, which takes half of the time in which a function compiles.

What is compiled is the same to the last bit: each shortcut gives the answer that Numba's code gives.
"""

import gc
from collections.abc import Callable, Iterable
from functools import lru_cache, wraps
from typing import Any

from llvmlite.binding import ffi
from numba.core import base, ir, utils
from numba.core.targetconfig import TargetConfig
from numba.core.types.abstract import _TypeMetaclass
from numba.core.typing import BaseContext as TypingContext
from numba.core.typing import context
from numba.np import arrayobj

_WITHOUT_VARIABLES = frozenset({str, int, float, bool, type(None), ir.Loc, ir.Arg, ir.Const, ir.FreeVar, ir.Global})


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
        elif kind is ir.Expr:
            _collect(value._kws.values(), found)
        elif isinstance(value, ir.Var):
            found.append(value)
        elif isinstance(value, ir.Inst):
            found.extend(value.list_vars())
        elif isinstance(value, list | tuple):
            _collect(value, found)
        elif isinstance(value, dict):
            _collect(value.values(), found)


def same_flags(flags: TargetConfig, other: object) -> bool:
    """Whether two sets of flags are equal: of two of one class only the options that either sets need be compared."""
    if type(flags) is not type(other):
        return _compare_all(flags, other)
    told, others = flags._values, other._values
    return told == others or all(getattr(flags, name) == getattr(other, name) for name in told.keys() | others.keys())


def keep_as_old() -> None:
    """Count all objects as old, if nobody holds some apart from the search for garbage (`gc.freeze`).

    What a compiler leaves behind stays, and Python would go through all of it two times before it believes that.
    """
    if gc.get_freeze_count() == 0:
        gc.freeze()
        gc.unfreeze()


def unless_all_is_known(refresh: Callable[[Any], None]) -> Callable[[Any], None]:
    """A context's `refresh`, which does nothing where no rule was added to its registries since it last ran.

    Numba refreshes before and after each function, and for each array that a function sees; to find that there is nothing new it
    goes through some fifty import statements.
    """

    @wraps(refresh)
    def refresh_if_new(of: Any) -> None:
        known = _number_of_rules(of)
        if getattr(of, "_known_rules", None) != known:
            refresh(of)
            of._known_rules = _number_of_rules(of)

    return refresh_if_new


def _number_of_rules(of: Any) -> int:
    """How many rules the registries of a context hold, and those of the types that it works with."""
    number = sum(
        len(getattr(registry, kind)) for registry, loader in list(of._registries.items()) for kind in loader.registry_items
    )
    return number + (_number_of_rules(of.typing_context) if isinstance(of, base.BaseContext) else 0)


@lru_cache(maxsize=4096)
def _order_kept(target: type, rules: tuple[type, ...], called: Any) -> list[type]:
    return _order_of_rules(target, list(rules), called)


def rules_in_order(target: type, templates: list[type], fnkey: Any = "") -> list[type]:
    """The rules for a function or an attribute, most specific ones first, kept for each list of rules; arguments as Numba's."""
    return list(_order_kept(target, tuple(templates), fnkey))


_order_of_rules = utils.order_by_target_specificity
utils.order_by_target_specificity = context.order_by_target_specificity = rules_in_order
_compare_all = TargetConfig.__eq__
ir.Inst._rec_list_vars = variables_in
TargetConfig.__eq__ = same_flags
_TypeMetaclass.__instancecheck__ = type.__instancecheck__  # no class of types has others registered as its own
_TypeMetaclass.__subclasscheck__ = type.__subclasscheck__
arrayobj.make_array = lru_cache(maxsize=None)(arrayobj.make_array)  # makes a class, at each item of an array
base.BaseContext.refresh, TypingContext.refresh = map(unless_all_is_known, (base.BaseContext.refresh, TypingContext.refresh))
base._has_loc = lru_cache(maxsize=4096)(base._has_loc)  # reads a signature, at each operation that a function has
for _callbacks in list(ffi.lib._lock._cblist):  # which time every call of LLVM, some hundred thousand, and nobody asks for
    if _callbacks[0].__module__ == "numba.core.base":
        ffi.lib._lock.unregister(*_callbacks)
