"""Loops that are timed inside compiled code, so that calls from Python do not count.

Importing this file compiles Newton's kernels, or reads them from the disk.
"""

from anet_lumped.compiled.jit import njit
from anet_lumped.mechanics import newton_step, residual, settle


@njit(cache=True)
def newton_iterations(stage, base, target, q, address, times):
    """What Newton's method does in an iteration, repeated at one state."""
    for _ in range(times):
        residual.residual(stage, base, target, q, address)
        newton_step.direction(stage, address)
        newton_step.correct(address, 0.0, q)


@njit(cache=True)
def accounts(stage, base, q, v, address, energy, times):
    """What the energy balance adds to a step of edmc, and what calms its velocities."""
    for _ in range(times):
        settle.settle(stage, base, q, v, address, energy)
