"""diffrax's solvers on a net: the same laws in JAX, with linear systems solved by the structure of the net."""
