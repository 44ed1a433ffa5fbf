"""Calls of compiled functions by their address, so that a kernel is compiled once whatever functions it will call."""

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
    """Address of a function; compiles it for one signature, or loads it from the cache, when it is asked for the first time."""
    return address(compile_for(function, signature))


def callable_at(signature):
    """An intrinsic that turns an address, which must not be 0, into a first-class function of a signature.

    The call does not check whether the address is null, so that a kernel with such a call cannot raise an exception by it.
    """
    function_type = types.FunctionType(signature)

    @intrinsic
    def as_function(typing_context, address):
        def codegen(context, builder, signature, args):
            function = cgutils.create_struct_proxy(function_type)(context, builder)
            null = cgutils.voidptr_t(None)
            builder.assume(cgutils.is_not_null(builder, args[0]))  # else Numba adds a branch that raises to each call
            function.c_addr = builder.inttoptr(args[0], cgutils.voidptr_t)
            function.py_addr, function.jit_addr = null, null
            return function._getvalue()

        return function_type(types.int64), codegen

    return as_function
