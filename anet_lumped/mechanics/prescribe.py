"""The prescribed motion: positions and velocities of driven points, and rest lengths that change in time."""

from numba import float64, int64, types

from anet_lumped.compiled.jit import kernel
from anet_lumped.mechanics.optional import as_drive, as_set_lengths
from anet_lumped.model.net import view_net
from anet_lumped.model.tables import KERNEL_DRIVE, KERNEL_SET_LENGTHS

_f2 = float64[:, ::1]


@kernel(types.void(float64, int64, _f2, _f2))
def prescribe(t, net_address, q, v):
    """Write position and velocity of the driven nodes at time t, and set the rest lengths at that time.

    Rows of fixed nodes stay as they are.
    """
    net = view_net(net_address)
    if net.lengths.cable.shape[0] > 0:
        as_set_lengths(net.kernels[KERNEL_SET_LENGTHS])(net_address, t, t, t)
    if net.n_driven < q.shape[0]:
        as_drive(net.kernels[KERNEL_DRIVE])(t, net_address, q, v)


@kernel(types.float64(float64, int64, _f2, _f2))
def keep(t, net_address, q, v):
    """`System.project` of cables that stretch, of which no state has to be changed."""
    return 0.0
