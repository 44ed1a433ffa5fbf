"""Kernels that only some scenes need: compiled when a scene first needs them, and called by their address in ``Net.kernels``.

A net of one cable needs no kernel for four cables at once. A net without cables between free points needs no kernel for those. An
explicit method needs no Newton step, `edmc` needs no force at one time, and most scenes have no rest length that changes.
"""

from typing import NamedTuple

from numba import float64, int64, types

from anet_lumped.compiled.addresses import callable_at
from integrators.stage import STAGE

_f1, _f2 = float64[::1], float64[:, ::1]


class CableBalance(NamedTuple):
    """Balance of the forces in a stage over some cables; `residual.residual` says more of the first four numbers.

    Parameters
    ----------
    norm : [N], largest component of the out-of-balance force on an interior node
    scale : [N], largest inertial or external force on an interior node
    noise : [N], what rounding of the positions leaves in ``norm``
    predicted : [N], largest out-of-balance force with the predicted tensions, or weighted difference of tensions
    predicted_noise : [N], what rounding leaves in ``predicted``
    sum_of_forces : [N], not finite if any force is not finite
    """

    norm: float
    scale: float
    noise: float
    predicted: float
    predicted_noise: float
    sum_of_forces: float


class CableAccount(NamedTuple):
    """Energies of a step of edmc, summed over some cables [J].

    Parameters
    ----------
    by_dampers, by_method : dissipated by the dampers and by the numerical damper
    put_in : work of driven ends against the tensions
    by_impulses : work of prescribed ends and of changes of rest length against the impulses
    by_full_damper : what the numerical damper would dissipate if no share of it were left out
    """

    by_dampers: float
    by_method: float
    put_in: float
    by_impulses: float
    by_full_damper: float


SIGNATURES = {
    "force": float64(int64, _f2, _f2, _f2),
    "observe": float64(_f2, _f2, int64, _f1),
    "residual": types.NamedUniTuple(float64, 6, CableBalance)(STAGE, int64, _f2, _f2, float64, float64),
    "finish": float64(STAGE, int64),
    "settle": types.NamedUniTuple(float64, 5, CableAccount)(STAGE, int64, _f2, _f2, _f2),
    "relinearise_creep": int64(STAGE, int64),
    "settle_effects": float64(STAGE, int64, _f2, _f2, _f2),
    "eliminate": types.void(int64),
    "substitute": float64(int64),
    "solve_fronts": types.void(int64),
    "drive": types.void(float64, int64, _f2, _f2),
    "set_lengths": types.void(int64, float64, float64, float64),
    "power_of_lengths": float64(int64, float64, _f2, _f2, _f2),
    "work_of_lengths": float64(STAGE, int64, _f2, _f2, _f2),
    "energy_of_paid_out": float64(STAGE, int64, _f2, _f2),
    "place_bodies": types.void(STAGE, int64, _f2, _f2, _f2),
    "balance_bodies": types.NamedUniTuple(float64, 6, CableBalance)(STAGE, int64, float64, float64, float64),
    "reduce_bodies": types.void(int64),
    "spread_bodies": types.void(int64),
    "finish_bodies": float64(int64),
    "turn_bodies": types.void(STAGE, int64, _f2, _f2, _f2),
    "stiffen_bodies": float64(int64, _f2, _f2),
    "force_bodies": float64(int64, float64, _f2, _f2, _f2),
    "mobility_bodies": types.void(int64, _f2),
    "meet_bodies": types.void(int64),
    "pull_bodies": types.void(int64, _f2),
    "shape_bodies": types.void(int64, _f2),
    "settle_joints": types.UniTuple(float64, 2)(STAGE, int64, _f2, _f2, _f2),
}
as_cable_force, as_cable_residual, as_finish, as_cable_settle, as_settle_effects = (
    callable_at(SIGNATURES[name]) for name in ("force", "residual", "finish", "settle", "settle_effects")
)
as_relinearise_creep, as_solve_fronts = (callable_at(SIGNATURES[name]) for name in ("relinearise_creep", "solve_fronts"))
as_eliminate, as_substitute, as_drive = (callable_at(SIGNATURES[name]) for name in ("eliminate", "substitute", "drive"))
as_set_lengths, as_power_of_lengths, as_work_of_lengths, as_energy_of_paid_out = (
    callable_at(SIGNATURES[name]) for name in ("set_lengths", "power_of_lengths", "work_of_lengths", "energy_of_paid_out")
)
as_place_bodies, as_balance_bodies, as_reduce_bodies, as_spread_bodies, as_finish_bodies = (
    callable_at(SIGNATURES[f"{name}_bodies"]) for name in ("place", "balance", "reduce", "spread", "finish")
)
as_turn_bodies, as_stiffen_bodies, as_force_bodies = (
    callable_at(SIGNATURES[f"{name}_bodies"]) for name in ("turn", "stiffen", "force")
)
as_mobility_bodies, as_meet_bodies, as_pull_bodies, as_shape_bodies = (
    callable_at(SIGNATURES[f"{name}_bodies"]) for name in ("mobility", "meet", "pull", "shape")
)
as_settle_joints = callable_at(SIGNATURES["settle_joints"])
as_cable_observe = callable_at(SIGNATURES["observe"])
