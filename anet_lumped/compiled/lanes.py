"""Four numbers at once (SIMD): a function that is written for one cable is compiled for a group of four cables, too.

A node of a cable has to wait for the node before it, and the processor idles meanwhile. Four cables do not wait for each other.
Therefore the type `LANES` holds four numbers, one of each cable. A function works on numbers and on lanes, if it is written in
plain arithmetic, comparisons, ``abs``, ``max``, ``min``, `math.sqrt` and `select`. A comparison of lanes gives a `CHOICE` of four
answers. It has no truth value, so that `select` takes the place of ``if``.

An address is the position of a number in a flat array, or of a row in a table. It is one integer for a cable, and a tuple of four
integers for a group; `shifted` advances it. `load`, `load_three`, `load_four`, `store`, `store_four`, `add_three` and `column` read
and write at an address. `lane`, `max_of_lanes` and `sum_of_lanes` make one number of four, and `all_of` one answer.
"""

import math
import operator

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable

WIDTH = 4
_i32, _double = ir.IntType(32), ir.DoubleType()
_vector, _bits = ir.VectorType(_double, WIDTH), ir.VectorType(ir.IntType(1), WIDTH)


class _Lanes(types.Type):
    """Numba's type of `WIDTH` numbers."""


class _Choice(types.Type):
    """Numba's type of `WIDTH` answers, true or false, of a comparison of lanes."""


LANES, CHOICE = _Lanes("Lanes"), _Choice("Choice")


def _model(layout):
    class Model(models.PrimitiveModel):
        def __init__(self, manager, kind):
            super().__init__(manager, kind, layout)

    return Model


register_model(_Lanes)(_model(_vector))
register_model(_Choice)(_model(_bits))


def select(condition, a, b):
    """``a`` where the condition holds, else ``b``; both are evaluated."""
    return a if condition else b


def _spread(builder, value):
    """Lanes that all hold one number."""
    one = builder.insert_element(ir.Constant(_vector, ir.Undefined), value, _i32(0))
    return builder.shuffle_vector(one, ir.Constant(_vector, ir.Undefined), ir.Constant(ir.VectorType(_i32, WIDTH), [0] * WIDTH))


def _shuffle(builder, a, b, lanes):
    """Vector of chosen elements of two vectors; those of the second one are numbered from `WIDTH` on."""
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(_i32, len(lanes)), lanes))


def _as_lanes(context, builder, value, kind):
    """Lanes as they are, and a number spread to lanes."""
    return value if kind is LANES else _spread(builder, context.cast(builder, value, kind, types.float64))


def _numbers(*kinds):
    return all(kind is LANES or isinstance(kind, types.Float | types.Integer) for kind in kinds)


def _define(operation, instruction, answer=LANES):
    """Let an operation of two numbers take lanes, or lanes and a number."""

    @type_callable(operation)
    def resolve(context):
        return lambda a, b: answer if LANES in (a, b) and _numbers(a, b) else None

    def lower(context, builder, signature, args):
        a, b = (_as_lanes(context, builder, value, kind) for value, kind in zip(args, signature.args, strict=True))
        return instruction(builder, a, b)

    for kinds in ((_Lanes, _Lanes), (_Lanes, types.Float), (types.Float, _Lanes), (_Lanes, types.Integer), (types.Integer, _Lanes)):
        lower_builtin(operation, *kinds)(lower)


def _compare(sign):
    return lambda builder, a, b: builder.fcmp_ordered(sign, a, b)


for _operation, _instruction in (
    (operator.add, ir.IRBuilder.fadd),
    (operator.sub, ir.IRBuilder.fsub),
    (operator.mul, ir.IRBuilder.fmul),
    (operator.truediv, ir.IRBuilder.fdiv),
    (operator.iadd, ir.IRBuilder.fadd),
    (operator.isub, ir.IRBuilder.fsub),
    (operator.imul, ir.IRBuilder.fmul),
    (max, lambda builder, a, b: builder.select(builder.fcmp_ordered(">", a, b), a, b)),
    (min, lambda builder, a, b: builder.select(builder.fcmp_ordered("<", a, b), a, b)),
):
    _define(_operation, _instruction)
for _operation, _sign in (
    (operator.gt, ">"), (operator.lt, "<"), (operator.ge, ">="), (operator.le, "<="), (operator.eq, "=="), (operator.ne, "!=")
):  # fmt: skip
    _define(_operation, _compare(_sign), CHOICE)


def _define_of_one(operation, instruction):
    """Let an operation of one number take lanes."""

    @type_callable(operation)
    def resolve(context):
        return lambda a: LANES if a is LANES else None

    @lower_builtin(operation, _Lanes)
    def lower(context, builder, signature, args):
        return instruction(builder, args[0])


def _intrinsic_of_one(name):
    def instruction(builder, value):
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(_vector, [_vector]), f"{name}.v{WIDTH}f64")
        return builder.call(function, [value])

    return instruction


_define_of_one(operator.neg, lambda builder, a: builder.fneg(a))
_define_of_one(abs, _intrinsic_of_one("llvm.fabs"))
_define_of_one(math.sqrt, _intrinsic_of_one("llvm.sqrt"))


def _define_of_choices(operation, instruction):
    """Let an operation of two truth values take choices, or a choice and a truth value."""

    @type_callable(operation)
    def resolve(context):
        return lambda a, b: CHOICE if {a, b} <= {CHOICE, types.boolean} and CHOICE in (a, b) else None

    def lower(context, builder, signature, args):
        a, b = (
            value if kind is CHOICE else _spread_choice(context, builder, value)
            for value, kind in zip(args, signature.args, strict=True)
        )
        return instruction(builder, a, b)

    for kinds in ((_Choice, _Choice), (_Choice, types.Boolean), (types.Boolean, _Choice)):
        lower_builtin(operation, *kinds)(lower)


def _spread_choice(context, builder, value):
    """Choice of one truth value for all lanes."""
    value = context.cast(builder, value, types.boolean, types.boolean)
    one = builder.insert_element(ir.Constant(_bits, ir.Undefined), builder.trunc(value, ir.IntType(1)), _i32(0))
    return builder.shuffle_vector(one, ir.Constant(_bits, ir.Undefined), ir.Constant(ir.VectorType(_i32, WIDTH), [0] * WIDTH))


_define_of_choices(operator.and_, ir.IRBuilder.and_)
_define_of_choices(operator.or_, ir.IRBuilder.or_)


@type_callable(select)
def _type_select(context):
    def resolve(condition, a, b):
        if condition is CHOICE and _numbers(a, b):
            return LANES
        if condition is types.boolean and _numbers(a, b):
            return LANES if LANES in (a, b) else types.float64

    return resolve


@lower_builtin(select, types.Any, types.Any, types.Any)
def _lower_select(context, builder, signature, args):
    condition, kinds = args[0], signature.args
    if signature.return_type is LANES:
        a, b = (_as_lanes(context, builder, value, kind) for value, kind in zip(args[1:], kinds[1:], strict=True))
    else:
        a, b = (context.cast(builder, value, kind, types.float64) for value, kind in zip(args[1:], kinds[1:], strict=True))
    return builder.select(condition, a, b)


_f1, _f2, _i2 = types.Array(types.float64, 1, "C"), types.Array(types.float64, 2, "C"), types.Array(types.int64, 2, "C")
FOUR = types.UniTuple(types.int64, WIDTH)


def _pack(builder, numbers):
    """Lanes of four numbers."""
    value = ir.Constant(_vector, ir.Undefined)
    for k, one in enumerate(numbers):
        value = builder.insert_element(value, one, _i32(k))
    return value


def _parts(builder, kind, value):
    """List of the integers of an address: one, or four."""
    return [builder.extract_value(value, k) for k in range(WIDTH)] if kind == FOUR else [value]


def _kind_of(kind):
    """Type of an address."""
    return FOUR if kind == FOUR else types.int64


@intrinsic
def shifted(typing_context, address, j, stride, offset):
    """The address (address + j) stride + offset, of each cable of a group for a group."""

    def codegen(context, builder, signature, args):
        found = [
            builder.add(builder.mul(builder.add(part, args[1]), args[2]), args[3])
            for part in _parts(builder, signature.args[0], args[0])
        ]
        return context.make_tuple(builder, FOUR, found) if signature.return_type == FOUR else found[0]

    kind = _kind_of(address)
    return kind(kind, *(types.int64,) * 3), codegen


def _address(context, builder, array, address):
    return builder.gep(context.make_array(_f1)(context, builder, array).data, [address])


@intrinsic
def load(typing_context, array, address):
    """Number, or lanes, at an address of a flat array. Whether the address lies in the array is not checked."""

    def codegen(context, builder, signature, args):
        numbers = [builder.load(_address(context, builder, args[0], part)) for part in _parts(builder, signature.args[1], args[1])]
        return _pack(builder, numbers) if signature.return_type is LANES else numbers[0]

    kind = _kind_of(address)
    return (LANES if kind == FOUR else types.float64)(_f1, kind), codegen


@intrinsic
def store(typing_context, array, address, value):
    """Write a number, or lanes, at an address of a flat array."""

    def codegen(context, builder, signature, args):
        parts = _parts(builder, signature.args[1], args[1])
        for k, part in enumerate(parts):
            number = builder.extract_element(args[2], _i32(k)) if len(parts) > 1 else args[2]
            builder.store(number, _address(context, builder, args[0], part))
        return context.get_dummy_value()

    kind = _kind_of(address)
    return types.void(_f1, kind, LANES if kind == FOUR else types.float64), codegen


_pair = ir.VectorType(_double, 2)


def _pair_at(builder, first):
    """Address of two numbers, of that of the first."""
    return builder.bitcast(first, _pair.as_pointer())


def _load_pair(builder, first):
    two = builder.load(_pair_at(builder, first))
    two.align = 8
    return two


@intrinsic
def load_three(typing_context, array, address):
    """Tuple of the number at an address of a flat array and of the two numbers after it; each is lanes for a group."""

    def codegen(context, builder, signature, args):
        firsts = [_address(context, builder, args[0], part) for part in _parts(builder, signature.args[1], args[1])]
        thirds = [builder.load(builder.gep(first, [_i32(2)])) for first in firsts]
        if len(firsts) == 1:
            found = [builder.load(firsts[0]), builder.load(builder.gep(firsts[0], [_i32(1)])), *thirds]
        else:
            a, b, c, d = (_load_pair(builder, first) for first in firsts)
            even, odd = _shuffle(builder, a, c, [0, 1, 2, 3]), _shuffle(builder, b, d, [0, 1, 2, 3])
            found = [_shuffle(builder, even, odd, [0, 4, 2, 6]), _shuffle(builder, even, odd, [1, 5, 3, 7]), _pack(builder, thirds)]
        return context.make_tuple(builder, signature.return_type, found)

    kind = _kind_of(address)
    return types.UniTuple(LANES if kind == FOUR else types.float64, 3)(_f1, kind), codegen


@intrinsic
def add_three(typing_context, array, address, values):
    """Add a tuple of three lanes to the numbers at an address of a flat array and behind it, for one member after the other."""

    def codegen(context, builder, signature, args):
        x, y, z = (builder.extract_value(args[2], k) for k in range(3))
        even, odd = _shuffle(builder, x, y, [0, 4, 2, 6]), _shuffle(builder, x, y, [1, 5, 3, 7])
        pairs = [_shuffle(builder, both, both, half) for half in ([0, 1], [2, 3]) for both in (even, odd)]
        for k, (pair, part) in enumerate(zip(pairs, _parts(builder, FOUR, args[1]), strict=True)):
            first = _address(context, builder, args[0], part)
            builder.store(builder.fadd(_load_pair(builder, first), pair), _pair_at(builder, first)).align = 8
            third = builder.gep(first, [_i32(2)])
            builder.store(builder.fadd(builder.load(third), builder.extract_element(z, _i32(k))), third)
        return context.get_dummy_value()

    return types.void(_f1, FOUR, types.UniTuple(LANES, 3)), codegen


def _transposed(builder, a, b, c, d):
    """The four columns of four rows: rows of one cable each become lanes of one column each, and the other way round."""
    low, high = _shuffle(builder, a, b, [0, 4, 2, 6]), _shuffle(builder, a, b, [1, 5, 3, 7])
    low_2, high_2 = _shuffle(builder, c, d, [0, 4, 2, 6]), _shuffle(builder, c, d, [1, 5, 3, 7])
    return (
        _shuffle(builder, low, low_2, [0, 1, 4, 5]), _shuffle(builder, high, high_2, [0, 1, 4, 5]),
        _shuffle(builder, low, low_2, [2, 3, 6, 7]), _shuffle(builder, high, high_2, [2, 3, 6, 7]),
    )  # fmt: skip


def _row(context, builder, array, address):
    return builder.bitcast(_address(context, builder, array, address), _vector.as_pointer())


@intrinsic
def load_four(typing_context, array, address):
    """Tuple of the number at an address of a flat array and of the three numbers after it; each is lanes for a group."""

    def codegen(context, builder, signature, args):
        rows = []
        for part in _parts(builder, signature.args[1], args[1]):
            rows.append(builder.load(_row(context, builder, args[0], part)))
            rows[-1].align = 8
        found = _transposed(builder, *rows) if len(rows) > 1 else [builder.extract_element(rows[0], _i32(k)) for k in range(WIDTH)]
        return context.make_tuple(builder, signature.return_type, found)

    kind = _kind_of(address)
    return types.UniTuple(LANES if kind == FOUR else types.float64, 4)(_f1, kind), codegen


@intrinsic
def store_four(typing_context, array, address, values):
    """Write a tuple of four numbers, or of four lanes, at an address of a flat array and behind it."""

    def codegen(context, builder, signature, args):
        values, parts = [builder.extract_value(args[2], k) for k in range(4)], _parts(builder, signature.args[1], args[1])
        for row, part in zip(_transposed(builder, *values) if len(parts) > 1 else [_pack(builder, values)], parts, strict=True):
            builder.store(row, _row(context, builder, args[0], part)).align = 8
        return context.get_dummy_value()

    kind = _kind_of(address)
    return types.void(_f1, kind, types.UniTuple(LANES if kind == FOUR else types.float64, 4)), codegen


@intrinsic
def column(typing_context, table, address, column):
    """Entry of a table in a column and in the row at an address: a number or lanes; an address if the table holds integers."""

    def codegen(context, builder, signature, args):
        found = []
        array = context.make_array(signature.args[0])(context, builder, args[0])
        width = builder.extract_value(array.shape, 1)
        for part in _parts(builder, signature.args[1], args[1]):
            found.append(builder.load(builder.gep(array.data, [builder.add(builder.mul(part, width), args[2])])))
        if len(found) == 1:
            return found[0]
        return _pack(builder, found) if signature.return_type is LANES else context.make_tuple(builder, FOUR, found)

    kind = _kind_of(address)
    answer = {(types.float64, True): LANES, (types.int64, True): FOUR}.get((table.dtype, kind == FOUR), table.dtype)
    return answer(types.Array(table.dtype, 2, "C"), kind, types.int64), codegen


@intrinsic
def group_members(typing_context, group, g):
    """Address of the four cables of a row of ``Net.cable_groups``."""

    def codegen(context, builder, signature, args):
        array = context.make_array(_i2)(context, builder, args[0])
        first = builder.mul(args[1], builder.extract_value(array.shape, 1))
        found = [builder.load(builder.gep(array.data, [builder.add(first, ir.Constant(first.type, k))])) for k in range(WIDTH)]
        return context.make_tuple(builder, FOUR, found)

    return FOUR(_i2, types.int64), codegen


@intrinsic
def is_below(typing_context, address, n):
    """Whether an address is less than n: a truth value, or a choice for a group."""

    def codegen(context, builder, signature, args):
        found = [builder.icmp_signed("<", part, args[1]) for part in _parts(builder, signature.args[0], args[0])]
        if len(found) == 1:
            return found[0]
        value = ir.Constant(_bits, ir.Undefined)
        for k, one in enumerate(found):
            value = builder.insert_element(value, one, _i32(k))
        return value

    kind = _kind_of(address)
    return (CHOICE if kind == FOUR else types.boolean)(kind, types.int64), codegen


@intrinsic
def all_of(typing_context, choice):
    """Whether all answers of a choice are true; a truth value as it is."""

    def codegen(context, builder, signature, args):
        if signature.args[0] is not CHOICE:
            return args[0]
        mask = ir.IntType(WIDTH)
        return builder.icmp_unsigned("==", builder.bitcast(args[0], mask), ir.Constant(mask, 2**WIDTH - 1))

    return types.boolean(CHOICE if choice is CHOICE else types.boolean), codegen


@intrinsic
def lane(typing_context, value, k):
    """Number ``k`` of lanes, or integer ``k`` of an address of a group; one number or integer is returned as it is."""

    def codegen(context, builder, signature, args):
        kind, value = signature.args[0], args[0]
        if kind is LANES:
            return builder.extract_element(value, builder.trunc(args[1], _i32))
        if kind == FOUR:
            parts = [builder.extract_value(value, i) for i in range(WIDTH)]
            found = parts[-1]
            for i in range(WIDTH - 2, -1, -1):
                found = builder.select(builder.icmp_signed("==", args[1], ir.Constant(args[1].type, i)), parts[i], found)
            return found
        return value

    kind = value if value in (LANES, FOUR) else types.int64 if isinstance(value, types.Integer) else types.float64
    return {LANES: types.float64, FOUR: types.int64}.get(kind, kind)(kind, types.int64), codegen


def _reduce(instruction):
    def typed(typing_context, value):
        def codegen(context, builder, signature, args):
            if signature.args[0] is not LANES:
                return args[0]
            parts = [builder.extract_element(args[0], _i32(k)) for k in range(WIDTH)]
            found = parts[0]
            for one in parts[1:]:
                found = instruction(builder, found, one)
            return found

        return types.float64(LANES if value is LANES else types.float64), codegen

    return typed


def _larger(builder, a, b):
    return builder.select(builder.fcmp_ordered(">", b, a), b, a)


max_of_lanes, sum_of_lanes = intrinsic(_reduce(_larger)), intrinsic(_reduce(ir.IRBuilder.fadd))
