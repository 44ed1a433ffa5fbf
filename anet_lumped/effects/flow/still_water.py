"""The kernels of `Water` for water at rest; see `water_on_cables`."""

from anet_lumped.compiled.jit import kernel
from anet_lumped.effects.signatures import (
    ENERGY_SIGNATURE,
    FORCE_SIGNATURE,
    INERTIA_SIGNATURE,
    TANGENT_SIGNATURE,
    WHOLE_STEP_SIGNATURE,
)

from .water_on_cables import add_masses, energy_of, force_of, force_over_step, subtract_slopes


@kernel(FORCE_SIGNATURE)
def force(t, q, v, index, params, f):
    """Add the force on nodes; return the power that forces without an energy take [W]."""
    return force_of(t, q, v, index, params, f, ())


@kernel(TANGENT_SIGNATURE)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the slopes of `force`."""
    subtract_slopes(t, q, v, index, params, c_q, c_v, D, near, ())


@kernel(ENERGY_SIGNATURE)
def energy(t, q, index, params):
    """Energy of buoyancy [J]."""
    return energy_of(q, index, params, ())


@kernel(WHOLE_STEP_SIGNATURE)
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Force over a whole step, and its derivative."""
    return force_over_step(t, h, base, q, index, params, f, D, near, ())


@kernel(INERTIA_SIGNATURE)
def inertia(t, q, index, params, A):
    """Add the added masses."""
    add_masses(t, q, index, params, A, ())
