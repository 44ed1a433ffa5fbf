"""Derivatives in compiled code: dual numbers, a value and its slopes in three variables at once.

A dual number x + x_1 d_1 + x_2 d_2 + x_3 d_3, with d_i d_j = 0, is a value x and its slopes x_i. Arithmetic on dual numbers
computes the slopes of the result together with its value, exact to rounding, through branches and loops alike. A dual number
whose parts are dual themselves carries second derivatives. Numba compiles any function for dual numbers whose operations, and
whose functions of `math` and numpy, are in `RULES` and `OF_TWO`. The length of a vector of nothing, as in a drag k |v| v at
rest, has the slope 0, the mean of those about it.
Source: Griewank & Walther, Evaluating Derivatives (2nd ed., 2008), ch. 3 (forward mode, vector version).
"""

import math
import operator

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.typeconv import Conversion
from numba.extending import intrinsic, lower_cast, make_attribute_wrapper, models, overload, register_model

from anet_lumped.compiled.jit import njit

from .lanes import select

PARTS = ("value", "d1", "d2", "d3")
ROOT_PI = math.sqrt(math.pi)


class Dual(types.Type):
    """Numba's type of a dual number whose parts are of type ``of``: float64, or dual again."""

    def __init__(self, of):
        self.of = of
        super().__init__(f"Dual({of})")

    def can_convert_from(self, typingctx, other):
        """A number may be given where a dual number is asked for; its slopes are 0."""
        return Conversion.safe if isinstance(other, types.Integer | types.Float | types.Boolean) else None

    def unify(self, typingctx, other):
        """A variable that is a number in one branch and dual in another is dual."""
        return self if isinstance(other, types.Integer | types.Float | types.Boolean) else None


FIRST, SECOND = Dual(types.float64), Dual(Dual(types.float64))


@register_model(Dual)
class _Model(models.StructModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, [(part, fe_type.of) for part in PARTS])


for _part in PARTS:
    make_attribute_wrapper(Dual, _part, _part)


@lower_cast(types.Integer, Dual)
@lower_cast(types.Float, Dual)
@lower_cast(types.Boolean, Dual)
def _constant(context, builder, fromty, toty, value):
    number = cgutils.create_struct_proxy(toty)(context, builder)
    number.value = context.cast(builder, value, fromty, toty.of)
    for part in PARTS[1:]:
        setattr(number, part, context.cast(builder, context.get_constant(types.float64, 0.0), types.float64, toty.of))
    return number._getvalue()


@intrinsic
def dual(typingctx, value, d1, d2, d3):
    """The dual number of four parts; their common type is that of ``value``."""
    of = value if isinstance(value, Dual) else types.float64

    def codegen(context, builder, signature, args):
        number = cgutils.create_struct_proxy(signature.return_type)(context, builder)
        for part, arg in zip(PARTS, args, strict=True):
            setattr(number, part, arg)
        return number._getvalue()

    return Dual(of)(of, of, of, of), codegen


def _is_number(kind):
    return isinstance(kind, types.Integer | types.Float | types.Boolean)


def value_of(x):
    """The plain number that a number or a dual number has for its value."""


def slope(x, k):
    """Slope in variable k, 0.0 for a plain number."""


@overload(value_of)
def _value_of(x):
    if isinstance(x, Dual):
        return lambda x: value_of(x.value)
    return (lambda x: float(x)) if _is_number(x) else None


@overload(slope)
def _slope(x, k):
    if isinstance(x, Dual):
        return lambda x, k: x.d1 if k == 0 else (x.d2 if k == 1 else x.d3)
    return (lambda x, k: 0.0) if _is_number(x) else None


@njit(error_model="numpy", cache=True)
def seeded(x, y, z):
    """Three variables as dual numbers: the slope of each is 1 in itself and 0 in the others."""
    return dual(x, 1.0, 0.0, 0.0), dual(y, 0.0, 1.0, 0.0), dual(z, 0.0, 0.0, 1.0)


@njit(error_model="numpy", cache=True)
def constant(x, y, z):
    """Three numbers as dual numbers whose slopes are 0."""
    return dual(x, 0.0, 0.0, 0.0), dual(y, 0.0, 0.0, 0.0), dual(z, 0.0, 0.0, 0.0)


def _of_each(function):
    """A function compiled twice, for `FIRST` and `SECOND`: one for both would call itself, which Numba takes for recursion."""
    return {kind: njit(error_model="numpy")(function) for kind in (FIRST, SECOND)}


def _chained(x, f, of_x):
    """f(x) as a dual number, from its value and its slope in x, by the chain rule."""
    return dual(f, of_x * x.d1, of_x * x.d2, of_x * x.d3)


def _chained_two(x, y, f, of_x, of_y):
    """f(x, y) as a dual number, from its value and its slopes in x and y, by the chain rule."""
    return dual(f, of_x * x.d1 + of_y * y.d1, of_x * x.d2 + of_y * y.d2, of_x * x.d3 + of_y * y.d3)


def _chained_root(x, f, of_x):
    """A root of x, as `_chained`; slopes of 0 at x = 0 stay 0, as in a sum of squares, whose root is a length."""
    if value_of(x) == 0.0 and value_of(x.d1) == 0.0 and value_of(x.d2) == 0.0 and value_of(x.d3) == 0.0:
        return dual(f, 0.0 * x.d1, 0.0 * x.d2, 0.0 * x.d3)
    return dual(f, of_x * x.d1, of_x * x.d2, of_x * x.d3)


CHAINED, CHAINED_TWO, CHAINED_ROOT = _of_each(_chained), _of_each(_chained_two), _of_each(_chained_root)


RULES = {  # function of one argument: its slope, from x and the value f of the function
    math.sqrt: lambda x, f: 0.5 / f,
    math.exp: lambda x, f: f,
    math.expm1: lambda x, f: f + 1.0,
    math.log: lambda x, f: 1.0 / x,
    math.log1p: lambda x, f: 1.0 / (1.0 + x),
    math.log10: lambda x, f: 1.0 / (math.log(10.0) * x),
    math.sin: lambda x, f: math.cos(x),
    math.cos: lambda x, f: -math.sin(x),
    math.tan: lambda x, f: 1.0 + f * f,
    math.asin: lambda x, f: 1.0 / math.sqrt(1.0 - x * x),
    math.acos: lambda x, f: -1.0 / math.sqrt(1.0 - x * x),
    math.atan: lambda x, f: 1.0 / (1.0 + x * x),
    math.sinh: lambda x, f: math.cosh(x),
    math.cosh: lambda x, f: math.sinh(x),
    math.tanh: lambda x, f: 1.0 - f * f,
    math.asinh: lambda x, f: 1.0 / math.sqrt(x * x + 1.0),
    math.erf: lambda x, f: 2.0 / ROOT_PI * math.exp(-x * x),
    math.fabs: lambda x, f: math.copysign(1.0, value_of(x)),
    abs: lambda x, f: math.copysign(1.0, value_of(x)),
}
OF_TWO = {  # function of two arguments: its slopes in both, from x, y and the value f of the function
    operator.add: lambda x, y, f: (1.0, 1.0),
    operator.sub: lambda x, y, f: (1.0, -1.0),
    operator.mul: lambda x, y, f: (y, x),
    operator.truediv: lambda x, y, f: (1.0 / y, -f / y),
    math.atan2: lambda x, y, f: (y / (x * x + y * y), -x / (x * x + y * y)),
    math.hypot: lambda x, y, f: (x / f, y / f) if value_of(f) > 0.0 else (0.0 * f, 0.0 * f),
}
NUMPY = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "asinh": "arcsinh", "atan2": "arctan2", "erf": "", "fabs": "fabs"}
NAMES = sorted({function.__name__ for function in (*RULES, *OF_TWO) if function.__module__ == "math"} | {"min", "max"})


def _under_both_names(function):
    """A function of `math` and the same function of numpy; for an operator or a builtin, itself alone."""
    of_numpy = getattr(np, NUMPY.get(function.__name__, function.__name__), None) if function.__module__ == "math" else None
    return [function] if of_numpy is None else [function, of_numpy]


def _teach(function, rule):
    """Let a function of one argument take a dual number, by the rule for its slope."""
    rules = _of_each(rule)

    def of_dual(x):
        if not isinstance(x, Dual):
            return None
        rule, chained = rules[x], (CHAINED_ROOT if function is math.sqrt else CHAINED)[x]

        def apply(x):
            f = function(x.value)
            return chained(x, f, rule(x.value, f))

        return apply

    for name in _under_both_names(function):
        overload(name)(of_dual)


def _teach_two(function, rule, *also):
    """Let a function of two arguments, and the operators ``also``, take dual numbers, by the rule for its slopes."""
    rules = _of_each(rule)

    def of_duals(x, y):
        kind = x if isinstance(x, Dual) else y
        if not isinstance(kind, Dual):
            return None
        rule, chained, chained_two = rules[kind], CHAINED[kind], CHAINED_TWO[kind]
        if isinstance(x, Dual) and isinstance(y, Dual):

            def apply(x, y):
                f = function(x.value, y.value)
                of_x, of_y = rule(x.value, y.value, f)
                return chained_two(x, y, f, of_x, of_y)

        elif isinstance(x, Dual) and _is_number(y):

            def apply(x, y):
                f = function(x.value, y)
                return chained(x, f, rule(x.value, y, f)[0])

        elif isinstance(y, Dual) and _is_number(x):

            def apply(x, y):
                f = function(x, y.value)
                return chained(y, f, rule(x, y.value, f)[1])

        else:
            return None

        return apply

    for name in (*_under_both_names(function), *also):
        overload(name)(of_duals)


IN_PLACE = {getattr(operator, name): (getattr(operator, f"i{name}"),) for name in ("add", "sub", "mul", "truediv")}
for _function, _rule in RULES.items():
    _teach(_function, _rule)
for _function, _rule in OF_TWO.items():
    _teach_two(_function, _rule, *IN_PLACE.get(_function, ()))


@overload(operator.neg)
def _neg(x):
    return (lambda x: dual(-x.value, -x.d1, -x.d2, -x.d3)) if isinstance(x, Dual) else None


@overload(operator.pos)
def _pos(x):
    return (lambda x: x) if isinstance(x, Dual) else None


@overload(operator.pow)
@overload(operator.ipow)
def _pow(x, y):
    kind = x if isinstance(x, Dual) else y
    if not isinstance(kind, Dual):
        return None
    chained, chained_two, chained_root = CHAINED[kind], CHAINED_TWO[kind], CHAINED_ROOT[kind]
    if isinstance(x, Dual) and _is_number(y):

        def apply(x, y):
            f, of_x = x.value**y, y * x.value ** (y - 1)
            return chained_root(x, f, of_x) if 0.5 <= y < 1.0 else chained(x, f, of_x)

    elif isinstance(x, Dual) and isinstance(y, Dual):

        def apply(x, y):
            f = x.value**y.value
            return chained_two(x, y, f, y.value * x.value ** (y.value - 1.0), f * math.log(x.value))

    elif _is_number(x) and isinstance(y, Dual):

        def apply(x, y):
            f = x**y.value
            return chained(y, f, f * math.log(x))

    else:
        return None

    return apply


def _teach_comparison(compare):
    """Let a comparison take dual numbers: it compares their values."""

    @overload(compare)
    def of_duals(x, y):
        if isinstance(x, Dual) or isinstance(y, Dual):
            return lambda x, y: compare(value_of(x), value_of(y))
        return None


for _compare in (operator.lt, operator.le, operator.gt, operator.ge, operator.eq, operator.ne):
    _teach_comparison(_compare)


@overload(select)
def _select(condition, a, b):
    if isinstance(a, Dual) or isinstance(b, Dual):
        return lambda condition, a, b: a if condition else b
    return None


@overload(min)
def _min(x, y):
    if isinstance(x, Dual) or isinstance(y, Dual):
        return lambda x, y: x if value_of(x) <= value_of(y) else y
    return None


@overload(max)
def _max(x, y):
    if isinstance(x, Dual) or isinstance(y, Dual):
        return lambda x, y: x if value_of(x) >= value_of(y) else y
    return None
