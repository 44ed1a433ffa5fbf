"""A flat view of a contiguous array in compiled code."""

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic
def flat(typing_context, array):
    """The numbers of a C-contiguous array in one row, as ``array.ravel()`` but without a reference: the array must outlive it."""
    row = types.Array(array.dtype, 1, "C")

    def codegen(context, builder, signature, args):
        whole, view = context.make_array(array)(context, builder, args[0]), context.make_array(row)(context, builder)
        view.meminfo, view.parent = cgutils.get_null_value(view.meminfo.type), cgutils.get_null_value(view.parent.type)
        view.nitems, view.itemsize, view.data = whole.nitems, whole.itemsize, whole.data
        view.shape = cgutils.pack_array(builder, [whole.nitems])
        view.strides = cgutils.pack_array(builder, [whole.itemsize])
        return view._getvalue()

    return row(array), codegen
