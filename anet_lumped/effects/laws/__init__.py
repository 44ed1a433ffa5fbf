"""Laws for one element that several effects share: axial elasticity, drag, the force of a moving fluid, submergence.

Plain arithmetic on scalars: the same lines are compiled by Numba, run on arrays by NumPy and traced by JAX.
"""
