"""Compiled functions by their address, so that what calls them is compiled once whatever they are."""

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from integrators.compile_once import compile_for, compiling, once


@once
def address(kernel):
    """Address of a compiled function with one signature [int]."""
    (compiled,) = kernel.overloads.values()
    with compiling():
        return compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)


def address_of(function, signature):
    """Address of a function that is compiled for one signature, or loaded from the cache, when it is first asked for."""
    return address(compile_for(function, signature))


def callable_at(signature):
    """An intrinsic that turns an address, which must not be 0, into a first-class function of a signature.

    A kernel that calls such a function cannot raise by that: nobody looks whether the address is null.
    """
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
