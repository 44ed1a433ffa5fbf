"""What the compiled functions of every effect look like, so that any of them fits any slot.

force(t, q, v, index, params, f) -> power
    adds the force on each node to f (n, 3) [N] and returns the power [W] that it takes out of the mechanical energy (0 for a
    force that has an energy).
tangent(t, q, v, index, params, c_q, c_v, D)
    subtracts c_q df/dq + c_v df/dv from the diagonal blocks D (n_free, 3, 3) [N/m].
energy(t, q, index, params) -> energy
    potential energy [J], 0 where there is none.

``index`` (int64) and ``params`` (float64) are the effect's own numbers. A net holds the addresses of the functions of the
effects it has, as plain integers, so that its type is the same whatever they are: `as_force`, `as_tangent` and `as_energy`
make an address callable in compiled code.
"""

from functools import cache

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1 = types.Array(types.int64, 1, "C")

FORCE = types.float64(types.float64, _f2, _f2, _i1, _f1, _f2)
TANGENT = types.void(types.float64, _f2, _f2, _i1, _f1, types.float64, types.float64, _f3)
ENERGY = types.float64(types.float64, _f2, _i1, _f1)


def addresses(effect):
    """Addresses of an effect's compiled force, tangent and energy."""
    return [_address(kernel) for kernel in effect.kernels()]


@cache
def _address(kernel):
    (compiled,) = kernel.overloads.values()
    return compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)


def _callable(signature):
    """An intrinsic that turns an address into a first-class function of a signature."""
    function_type = types.FunctionType(signature)

    @intrinsic
    def as_function(typing_context, address):
        def codegen(context, builder, signature, args):
            function = cgutils.create_struct_proxy(function_type)(context, builder)
            null = cgutils.voidptr_t(None)
            function.c_addr = builder.inttoptr(args[0], cgutils.voidptr_t)
            function.py_addr, function.jit_addr = null, null
            return function._getvalue()

        return function_type(types.int64), codegen

    return as_function


as_force, as_tangent, as_energy = _callable(FORCE), _callable(TANGENT), _callable(ENERGY)
