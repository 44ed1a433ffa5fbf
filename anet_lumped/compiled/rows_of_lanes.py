"""Lanes of four numbers that follow each other in a flat array; `lanes` has what is done with them.

For dense matrices, and for what one kernel leaves to the next one for each node of four cables: as lanes it need not be sorted into
the rows of the cables.
"""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from anet_lumped.compiled.lanes import FOUR, LANES, WIDTH

_f1, _four = types.float64[::1], ir.VectorType(ir.DoubleType(), WIDTH)


def _row(context, builder, array, address):
    """Pointer to four numbers in a row."""
    return builder.bitcast(builder.gep(context.make_array(_f1)(context, builder, array).data, [address]), _four.as_pointer())


@intrinsic
def load_row(typing_context, array, address):
    """Lanes of the number at an address of a flat array and of the three numbers after it."""

    def codegen(context, builder, signature, args):
        found = builder.load(_row(context, builder, *args))
        found.align = 8
        return found

    return LANES(_f1, types.int64), codegen


@intrinsic
def store_row(typing_context, array, address, lanes):
    """Write lanes at an address of a flat array and behind it."""

    def codegen(context, builder, signature, args):
        builder.store(args[2], _row(context, builder, *args[:2])).align = 8
        return context.get_dummy_value()

    return types.void(_f1, types.int64, LANES), codegen


def _tile(context, builder, array, first, kind, k):
    """Pointer to the k-th number, or to the k-th lanes, from an address of a flat array on."""
    address = builder.add(first, ir.Constant(first.type, k * (WIDTH if kind is LANES else 1)))
    if kind is LANES:
        return _row(context, builder, array, address)
    return builder.gep(context.make_array(_f1)(context, builder, array).data, [address])


@intrinsic
def load_tile(typing_context, array, first, like):
    """Tuple of the four numbers from an address of a flat array on, or of four lanes, each in a row; as ``like`` is."""
    kind = LANES if like is LANES else types.float64

    def codegen(context, builder, signature, args):
        found = [builder.load(_tile(context, builder, *args[:2], kind, k)) for k in range(4)]
        for one in found:
            one.align = 8
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(kind, 4)(_f1, types.int64, kind), codegen


@intrinsic
def store_tile(typing_context, array, first, values):
    """Write a tuple of four numbers, or of four lanes, from an address of a flat array on; see `load_tile`."""
    kind = values[0]

    def codegen(context, builder, signature, args):
        for k in range(4):
            builder.store(builder.extract_value(args[2], k), _tile(context, builder, *args[:2], kind, k)).align = 8
        return context.get_dummy_value()

    return types.void(_f1, types.int64, types.UniTuple(kind, 4)), codegen


@intrinsic
def columns_apart(typing_context, address):
    """How far two columns of a tile are apart: `WIDTH` for the address of a group, else 1."""
    width = WIDTH if address == FOUR else 1

    def codegen(context, builder, signature, args):
        return context.get_constant(types.int64, width)

    return types.int64(address), codegen


@intrinsic
def spread(typing_context, number):
    """Lanes that all hold one number."""

    def codegen(context, builder, signature, args):
        one = builder.insert_element(ir.Constant(_four, ir.Undefined), args[0], ir.IntType(32)(0))
        first = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
        return builder.shuffle_vector(one, ir.Constant(_four, ir.Undefined), first)

    return LANES(types.float64), codegen


@intrinsic
def thrice(typing_context, lanes):
    """Lanes a, b, c, d as three lanes (a, a, a, b), (b, b, c, c), (c, d, d, d): numbers of four nodes, for their coordinates."""

    def codegen(context, builder, signature, args):
        index = ir.VectorType(ir.IntType(32), WIDTH)
        found = [
            builder.shuffle_vector(args[0], ir.Constant(_four, ir.Undefined), ir.Constant(index, nodes))
            for nodes in ([0, 0, 0, 1], [1, 1, 2, 2], [2, 3, 3, 3])
        ]
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(LANES, 3)(LANES), codegen
