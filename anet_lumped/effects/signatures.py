"""What the compiled functions of every effect look like, so that any of them fits any slot.

force(t, q, v, index, params, f) -> power
    adds the force on each node to f (n, 3) [N] and returns the power [W] that it takes out of the mechanical energy (0 for a
    force that has an energy).
tangent(t, q, v, index, params, c_q, c_v, D)
    subtracts c_q df/dq + c_v df/dv from the diagonal blocks D (n_free, 3, 3) [N/m].
energy(t, q, index, params) -> energy
    potential energy [J], 0 where there is none.

``index`` (int64) and ``params`` (float64) are the effect's own numbers.
"""

from numba import types

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1 = types.Array(types.int64, 1, "C")

FORCE = types.float64(types.float64, _f2, _f2, _i1, _f1, _f2)
TANGENT = types.void(types.float64, _f2, _f2, _i1, _f1, types.float64, types.float64, _f3)
ENERGY = types.float64(types.float64, _f2, _i1, _f1)
