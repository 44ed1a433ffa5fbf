"""Functions of time that a user prescribes: the paths of driven points and the signals of one number.

Each is made of polynomials and a sine, so that compiled code (`path_kernel`) and JAX evaluate all of them by one formula.
"""
