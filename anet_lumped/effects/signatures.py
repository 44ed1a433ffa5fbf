"""The compiled functions of effects: one signature for each slot, so that a function of any effect fits it.

``index`` (k,) int64 and ``params`` (l,) float64 are the effect's own numbers, from `Effect.table`; t is a time [s], q and v are the
positions [m] and velocities [m/s] of all nodes (n, 3). None of the functions may raise. Every effect that exerts forces has

force(t, q, v, index, params, f) -> power
    Add the force on each node to f (n, 3) [N]. ``power`` [W] is what the force takes out of the mechanical energy, of which
    `energy` is a part: 0 for a force that is the slope of `energy`.
energy(t, q, index, params) -> energy
    Potential energy [J]; 0 where there is none.

and, unless it is a dead load (`Effect.dead_load`),

tangent(t, q, v, index, params, c_q, c_v, D, near, far)
    Subtract c_q df/dq + c_v df/dv [N/m] from the blocks of the moving nodes: D (n_free, 3, 3) of each with itself; near
    (n_segments, 2, 3, 3) of the two ends of each segment, row of the first node and column of the second, and back; far
    (n_segments, 2, 3, 3) of the first end of each segment and the second end of the next one of its cable, likewise. near is
    there for an effect with ``coupled_neighbours`` of 1 or 2, far with 2. Blocks of nodes that do not move are not asked for.

It may have besides

whole_step(t, h, damper, base, q, index, params, f, D, near, far) -> dissipated, by_method
    Add the force that acts over a whole step of h [s] from positions ``base`` to ``q``, t being the middle of the step, and
    subtract its derivative in q from the blocks. ``dissipated`` [J] is what the step takes; where it is never negative, no step can
    raise the energy. ``by_method`` [J] is what a numerical damper takes besides, which damps what the step does not resolve; it may
    be as large as ``damper``, 0 to 1/2, times a stiffness. The force of an effect without this function is taken at the middle of
    the step.
settle(t, h, damper, base, q, v, index, params) -> by_method
    After a step of h [s] from ``base`` to ``q``, which ends at t: take out of the velocities v at its end what rings and the step
    cannot resolve, for ``damper`` as in `whole_step`. ``by_method`` [J], never negative, is the kinetic energy that it takes.
    Advance the inner states in ``params``, of an effect that has some.
inertia(t, q, index, params, A)
    Add to the added masses A (n_free, 3, 3) [kg] of the moving nodes.

A net holds the addresses of these functions, as plain integers and 0 for none, so that its type is the same whatever its effects
are; `as_force` and its like make an address callable in compiled code.
"""

from typing import Any

from numba import types

from anet_lumped.compiled.addresses import address, callable_at

_f1, _f2, _f3, _f4 = (types.Array(types.float64, d, "C") for d in (1, 2, 3, 4))
_i1, _f8 = types.Array(types.int64, 1, "C"), types.float64

FORCE_SIGNATURE = _f8(_f8, _f2, _f2, _i1, _f1, _f2)
TANGENT_SIGNATURE = types.void(_f8, _f2, _f2, _i1, _f1, _f8, _f8, _f3, _f4, _f4)
ENERGY_SIGNATURE = _f8(_f8, _f2, _i1, _f1)
WHOLE_STEP_SIGNATURE = types.UniTuple(_f8, 2)(_f8, _f8, _f8, _f2, _f2, _i1, _f1, _f2, _f3, _f4, _f4)
INERTIA_SIGNATURE = types.void(_f8, _f2, _i1, _f1, _f3)
SETTLE_SIGNATURE = _f8(_f8, _f8, _f8, _f2, _f2, _f2, _i1, _f1)

SIGNATURES = {
    "force": FORCE_SIGNATURE,
    "tangent": TANGENT_SIGNATURE,
    "energy": ENERGY_SIGNATURE,
    "whole_step": WHOLE_STEP_SIGNATURE,
    "inertia": INERTIA_SIGNATURE,
    "settle": SETTLE_SIGNATURE,
}
SLOTS = tuple(SIGNATURES)  # in the order of the SLOT_ columns in `model.tables`


def addresses(effect: Any) -> list[int]:
    """Addresses of an effect's compiled functions in the order of `SLOTS`; 0 for those that it does not have."""
    kernels = effect.kernels()
    return [address(kernels[slot]) if slot in kernels else 0 for slot in SLOTS]


as_force, as_tangent, as_energy = callable_at(FORCE_SIGNATURE), callable_at(TANGENT_SIGNATURE), callable_at(ENERGY_SIGNATURE)
as_whole_step, as_inertia, as_settle = (
    callable_at(signature) for signature in (WHOLE_STEP_SIGNATURE, INERTIA_SIGNATURE, SETTLE_SIGNATURE)
)
