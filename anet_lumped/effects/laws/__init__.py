"""Laws for one element that several effects share: axial elasticity, drag, the force of a moving fluid, submergence.

The laws are plain arithmetic on scalars: Numba compiles, NumPy runs on arrays, and JAX traces the same lines.
"""
