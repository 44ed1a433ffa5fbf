"""The functions of `smoothstep` for compiled code."""

from numba.extending import register_jitable

from .smoothstep import ramped, smoothstep

for _function in (smoothstep, ramped):
    register_jitable(error_model="numpy")(_function)

__all__ = ["ramped", "smoothstep"]
