"""Has Numba ask first for what kernels are made of: items of arrays, and arithmetic of two numbers.

Its own order begins with strings, dictionaries and lists, and asking for those at every `a[i]` and every `x * y` takes a fifth of
the time in which a function compiles. The answers are Numba's own: of arrays by its own rule, of two numbers float64 or int64 as in
its tables, and no rule that is asked later has another answer for them. A rule of the target "cpu" is asked before those of any
target.
"""

import operator
from typing import ClassVar

from numba import types
from numba.core.typing.arraydecl import GetItemBuffer, SetItemBuffer
from numba.core.typing.templates import AbstractTemplate, infer_global, signature

_FIRST = {"target": "cpu"}
_ARITHMETIC = ("add", "sub", "mul", "iadd", "isub", "imul")
_COMPARISONS = ("lt", "le", "gt", "ge", "eq", "ne")


@infer_global(operator.getitem)
class _Read(GetItemBuffer):
    """The types in `a[i]`."""

    metadata: ClassVar = _FIRST


@infer_global(operator.setitem)
class _Write(SetItemBuffer):
    """The types in `a[i] = x`."""

    metadata: ClassVar = _FIRST


class _TwoNumbers(AbstractTemplate):
    """The types in an operation of two numbers of one type."""

    metadata: ClassVar = _FIRST
    results: ClassVar[dict] = {}

    def generic(self, args, kws):
        """The result and the arguments; None for types that others know of."""
        if len(args) == 2 and args[0] == args[1] and args[0] in self.results:
            return signature(self.results[args[0]], *args)
        return None


@infer_global(operator.truediv)
@infer_global(operator.itruediv)
class _Quotient(_TwoNumbers):
    results: ClassVar = {types.float64: types.float64}


class _Arithmetic(_TwoNumbers):
    results: ClassVar = {types.float64: types.float64, types.int64: types.int64}


class _Comparison(_TwoNumbers):
    results: ClassVar = {types.float64: types.boolean, types.int64: types.boolean}


for _names, _rule in ((_ARITHMETIC, _Arithmetic), (_COMPARISONS, _Comparison)):
    for _name in _names:
        infer_global(getattr(operator, _name))(_rule)
