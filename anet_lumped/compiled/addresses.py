"""Compiled functions by their address, so that what calls them is compiled once whatever they are."""

from functools import cache

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from integrators.system import compiled


@cache
def address(kernel):
    """Address of a compiled function with one signature [int]."""
    (compiled,) = kernel.overloads.values()
    return compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)


def address_of(function, signature):
    """Address of a function that is compiled for one signature, or loaded from the cache, when it is first asked for."""
    return address(compiled(function, signature))


def callable_at(signature):
    """An intrinsic that turns an address, which must not be 0, into a first-class function of a signature."""
    function_type = types.FunctionType(signature)

    @intrinsic
    def as_function(typing_context, address):
        def codegen(context, builder, signature, args):
            function = cgutils.create_struct_proxy(function_type)(context, builder)
            null = cgutils.voidptr_t(None)
            builder.assume(cgutils.is_not_null(builder, args[0]))  # else each call would hold what Numba does about it: raise
            function.c_addr = builder.inttoptr(args[0], cgutils.voidptr_t)
            function.py_addr, function.jit_addr = null, null
            return function._getvalue()

        return function_type(types.int64), codegen

    return as_function


def caller_of(signature):
    """An intrinsic that calls a function of a signature at an address with a tuple of arguments, ``call(address, arguments)``.

    A first-class function, as `callable_at` makes one, looks whether its address is null, and raises if it is. This one does not
    look, so that a kernel with such a call cannot raise.
    """

    @intrinsic
    def call(typing_context, address, arguments):
        def codegen(context, builder, own, args):
            kinds = [context.get_value_type(kind) for kind in signature.args]
            function = ir.FunctionType(context.get_value_type(signature.return_type), kinds)
            pointer = builder.inttoptr(args[0], function.as_pointer())
            return builder.call(pointer, cgutils.unpack_tuple(builder, args[1]))

        return signature.return_type(types.int64, types.Tuple(signature.args)), codegen

    return call
