"""Views of contiguous arrays in compiled code, without references: an array must outlive its views; and how one is fetched."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


def _view(context, builder, array, whole, data, count):
    """A row of ``count`` numbers from the address ``data`` on."""
    view = context.make_array(types.Array(array.dtype, 1, "C"))(context, builder)
    view.meminfo, view.parent = cgutils.get_null_value(view.meminfo.type), cgutils.get_null_value(view.parent.type)
    view.nitems, view.itemsize, view.data = count, whole.itemsize, data
    view.shape, view.strides = cgutils.pack_array(builder, [count]), cgutils.pack_array(builder, [whole.itemsize])
    return view._getvalue()


@intrinsic
def flat(typing_context, array):
    """The numbers of a C-contiguous array in one row, as ``array.ravel()``."""

    def codegen(context, builder, signature, args):
        whole = context.make_array(array)(context, builder, args[0])
        return _view(context, builder, array, whole, whole.data, whole.nitems)

    return types.Array(array.dtype, 1, "C")(array), codegen


@intrinsic
def part(typing_context, row, begin, count):
    """``count`` numbers of a contiguous row from ``begin`` on, as ``row[begin : begin + count]``, which a function may return."""

    def codegen(context, builder, signature, args):
        whole = context.make_array(row)(context, builder, args[0])
        return _view(context, builder, row, whole, builder.gep(whole.data, [args[1]]), args[2])

    return types.Array(row.dtype, 1, "C")(row, types.int64, types.int64), codegen


@intrinsic
def fetch_line(typing_context, row, i):
    """Let a processor fetch the line of its cache that holds number ``i`` of a contiguous row, to be written; nothing changes."""

    def codegen(context, builder, signature, args):
        byte, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        at = builder.bitcast(builder.gep(context.make_array(row)(context, builder, args[0]).data, [args[1]]), byte)
        kind = ir.FunctionType(ir.VoidType(), [byte, number, number, number])
        fetch = builder.module.declare_intrinsic("llvm.prefetch", [byte], kind)
        builder.call(fetch, [at, number(1), number(3), number(1)])  # to write, into all levels, data
        return context.get_dummy_value()

    return types.void(row, types.int64), codegen
