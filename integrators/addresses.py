"""Named tuples of arrays, numbers and functions that compiled code reads through their address.

An address is one integer: the place in memory at which the words of a named tuple begin (`words_of`). Compiled code makes a view of
it (`view_at`). The view costs no more than the integer, and reads a field only where the field is used. To pass some thirty arrays
and functions by value instead would cost as much as a step of eighty nodes.
"""

import ctypes
import hashlib

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model

WORD = 8  # bytes


def words_of(value):
    """The words by which Numba lays a value out in memory, as a list.

    Of an array: no owner, no parent, number of items, bytes of an item, address of the first, shape, strides. Of a first-class
    function: its address, and two zeros in place of Python's. Of a float: its bits. Of a tuple: the words of its fields, in turn.
    """
    if isinstance(value, np.ndarray):
        return [0, 0, value.size, value.itemsize, _address_of(value), *value.shape, *value.strides]
    if isinstance(value, types.WrapperAddressProtocol):
        return [value.__wrapper_address__(), 0, 0]
    if isinstance(value, float):
        return [int(np.float64(value).view(np.int64))]
    if isinstance(value, tuple):
        return [word for part in value for word in words_of(part)]
    return [value]


def _address_of(array):
    """Address of the first item of an array; 0 if it has none. A net has some eighty, and `ndarray.ctypes` takes 3 us for each."""
    if array.size == 0:
        return 0
    if array.flags.writeable and array.flags.c_contiguous:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))
    return array.ctypes.data


def count_words(kind):
    """Number of words that a value of a Numba type takes."""
    if isinstance(kind, types.Array):
        return 5 + 2 * kind.ndim
    if isinstance(kind, types.FunctionType):
        return 3
    return sum(map(count_words, kind)) if isinstance(kind, types.BaseTuple) else 1


class _View(types.Type):
    """A named tuple of Numba type ``kind`` at an address.

    Its name is part of the name of each compiled function that is given one. All fields of a net would make these names so long
    that they were half of what is kept of compiled code, and took a good part of the time to compile it.
    """

    def __init__(self, kind):
        self.kind = kind
        super().__init__(f"View({kind.instance_class.__name__} {hashlib.sha256(str(kind).encode()).hexdigest()[:16]})")


@register_model(_View)
class _ViewModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.IntType(64))


@infer_getattr
class _ViewAttributes(AttributeTemplate):
    key = _View

    def generic_resolve(self, view, name):
        if name in view.kind.fields:
            return view.kind.types[view.kind.fields.index(name)]
        return None


@lower_getattr_generic(_View)
def _load_field(context, builder, view, address, name):
    position = view.kind.fields.index(name)
    words_before = sum(map(count_words, view.kind.types[:position]))
    return _load(
        context, builder, view.kind.types[position], builder.add(address, ir.Constant(ir.IntType(64), WORD * words_before))
    )


def _load(context, builder, kind, address):
    """A value of a Numba type at an address; the words there never change while it is used, so that a loop loads them once."""
    if isinstance(kind, types.BaseTuple):
        parts = []
        for part in kind:
            parts.append(_load(context, builder, part, address))
            address = builder.add(address, ir.Constant(ir.IntType(64), WORD * count_words(part)))
        return context.make_tuple(builder, kind, parts)

    def word(k, kind_loaded=None):
        kind_loaded = kind_loaded or ir.IntType(64)
        loaded = builder.load(
            builder.inttoptr(builder.add(address, ir.Constant(ir.IntType(64), WORD * k)), kind_loaded.as_pointer())
        )
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
        return loaded

    if isinstance(kind, types.Array):
        array, n = context.make_array(kind)(context, builder), kind.ndim
        array.meminfo, array.parent = cgutils.get_null_value(array.meminfo.type), cgutils.get_null_value(array.parent.type)
        array.nitems, array.itemsize, array.data = word(2), word(3), word(4, array.data.type)
        array.shape = cgutils.pack_array(builder, [word(5 + x) for x in range(n)])
        array.strides = cgutils.pack_array(builder, [word(5 + n + x) for x in range(n)])
        return array._getvalue()
    return word(0, context.get_value_type(kind))


def view_at(kind):
    """A function for compiled code that turns an address into a view of the named tuple of a Numba type there.

    A field of the view is read where it is used; its arrays own nothing.
    """
    view = _View(kind)

    @intrinsic
    def at(typing_context, address):
        return view(types.int64), lambda context, builder, signature, args: args[0]

    return at
