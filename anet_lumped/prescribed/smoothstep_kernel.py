"""`smoothstep` for compiled code: the same functions, which Numba compiles into whatever calls them."""

from numba.extending import register_jitable

from . import smoothstep as plain

smoothstep = register_jitable(error_model="numpy")(plain.smoothstep)
ramped = register_jitable(error_model="numpy")(plain.ramped)
