"""What stands in a `System` for the force at one time where a method never asks for it."""

from numba import float64, int64, types

from anet_lumped.compiled.jit import kernel

_f1, _f2 = float64[::1], float64[:, ::1]


@kernel(types.void(float64, _f2, _f2, int64, _f2, _f1))
def no_force(t, q, v, net_address, f, power):
    """No force, and no power (3,) [W]: a march evaluates the force at its start, which such a method does not use."""
    for k in range(power.shape[0]):
        power[k] = 0.0
