"""The kernels of `Water` for currents and waves; see `water_on_cables`."""

from anet_lumped.compiled.jit import kernel
from anet_lumped.effects.signatures import (
    ENERGY_SIGNATURE,
    FORCE_SIGNATURE,
    INERTIA_SIGNATURE,
    TANGENT_SIGNATURE,
    WHOLE_STEP_SIGNATURE,
)

from .water_on_cables import (
    HEADER,
    add_masses,
    energy_of,
    force_of,
    force_over_step,
    segments_at,
    subtract_slopes,
    wave_at,
)


@kernel(FORCE_SIGNATURE)
def force(t, q, v, index, params, f):
    """Add the force on nodes; return the power that forces without an energy take [W]."""
    first, after = wave_at(params), segments_at(params)
    return force_of(t, q, v, index, params, f, (params[HEADER:first], params[first:after]))


@kernel(TANGENT_SIGNATURE)
def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    """Subtract the slopes of `force`."""
    first, after = wave_at(params), segments_at(params)
    subtract_slopes(t, q, v, index, params, c_q, c_v, D, near, (params[HEADER:first], params[first:after]))


@kernel(ENERGY_SIGNATURE)
def energy(t, q, index, params):
    """Energy of buoyancy [J]."""
    first, after = wave_at(params), segments_at(params)
    return energy_of(q, index, params, (params[HEADER:first], params[first:after]))


@kernel(WHOLE_STEP_SIGNATURE)
def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
    """Force over a whole step, and its derivative."""
    first, after = wave_at(params), segments_at(params)
    return force_over_step(t, h, base, q, index, params, f, D, near, (params[HEADER:first], params[first:after]))


@kernel(INERTIA_SIGNATURE)
def inertia(t, q, index, params, A):
    """Add the added masses."""
    first, after = wave_at(params), segments_at(params)
    add_masses(t, q, index, params, A, (params[HEADER:first], params[first:after]))
