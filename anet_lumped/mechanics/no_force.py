"""The force function of a `System` whose method needs no force at one time."""

from numba import float64, int64, types

from anet_lumped.compiled.jit import kernel

_f1, _f2 = float64[::1], float64[:, ::1]


@kernel(types.void(float64, _f2, _f2, int64, _f2, _f1))
def no_force(t, q, v, net_address, f, power):
    """Write no force, and a power (3,) [W] of zero. A march asks for the force at its start, which such a method does not read."""
    for k in range(power.shape[0]):
        power[k] = 0.0
