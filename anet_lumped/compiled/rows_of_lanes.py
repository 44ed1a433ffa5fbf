"""Lanes of four numbers that follow each other in a flat array, for dense matrices; `lanes` has what is done with them."""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from anet_lumped.compiled.lanes import LANES, WIDTH

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
