"""The functions of `turning` for compiled code."""

from numba.extending import register_jitable

from .turning import coefficients, cross, spin, turned

for _function in (coefficients, cross, spin, turned):
    register_jitable(error_model="numpy")(_function)

__all__ = ["cross", "spin", "turned"]
