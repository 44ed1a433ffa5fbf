"""Tuples of arrays, numbers and functions that compiled code looks at by their address.

Handing over some thirty arrays by value, or a function to be unpacked, would cost as much as a step of eighty nodes.
"""

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model


def words(value):
    """A tuple as Numba lays it out in memory, a word each: of an array no owner, no parent, then size, item size, address, shape
    and strides; of a first-class function its address, and none for Python."""
    if isinstance(value, np.ndarray):
        return [0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides]
    if isinstance(value, types.WrapperAddressProtocol):
        return [value.__wrapper_address__(), 0, 0]
    if isinstance(value, tuple):
        return [word for part in value for word in words(part)]
    return [value]


def size(kind):
    """Words that a value of a Numba type takes."""
    if isinstance(kind, types.Array):
        return 5 + 2 * kind.ndim
    if isinstance(kind, types.FunctionType):
        return 3
    return sum(map(size, kind)) if isinstance(kind, types.BaseTuple) else 1


class _At(types.Type):
    """A named tuple of Numba type ``kind`` at an address."""

    def __init__(self, kind):
        self.kind = kind
        super().__init__(f"At({kind})")


@register_model(_At)
class _AtModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.IntType(64))


@infer_getattr
class _AtAttributes(AttributeTemplate):
    key = _At

    def generic_resolve(self, at, name):
        if name in at.kind.fields:
            return at.kind.types[at.kind.fields.index(name)]
        return None


@lower_getattr_generic(_At)
def _load_field(context, builder, at, value, name):
    position = at.kind.fields.index(name)
    before = sum(map(size, at.kind.types[:position]))
    return _load(context, builder, at.kind.types[position], builder.add(value, ir.Constant(ir.IntType(64), 8 * before)))


def _load(context, builder, kind, place):
    """A value from an address; nothing there changes while anyone looks, so that a loop need not load it twice."""
    if isinstance(kind, types.BaseTuple):
        parts = []
        for part in kind:
            parts.append(_load(context, builder, part, place))
            place = builder.add(place, ir.Constant(ir.IntType(64), 8 * size(part)))
        return context.make_tuple(builder, kind, parts)

    def word(k, of=None):
        of = of or ir.IntType(64)
        loaded = builder.load(builder.inttoptr(builder.add(place, ir.Constant(ir.IntType(64), 8 * k)), of.as_pointer()))
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


def at_address(kind):
    """A function of an address for compiled code: a look at the named tuple of a Numba type there.

    It is as light as the address, whatever it is handed to; a field is read where it is used, and its arrays own nothing.
    """
    light = _At(kind)

    @intrinsic
    def at(typing_context, place):
        return light(types.int64), lambda context, builder, signature, args: args[0]

    return at


def value_at(kind):
    """A function of an address for compiled code: the tuple of a Numba type there, by value."""

    @intrinsic
    def at(typing_context, place):
        def codegen(context, builder, signature, args):
            model = context.data_model_manager[kind]
            return model.load_from_data_pointer(builder, builder.inttoptr(args[0], model.get_data_type().as_pointer()))

        return kind(types.int64), codegen

    return at
