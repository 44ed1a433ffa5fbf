"""Kernels that only some scenes need: compiled when a scene first needs them, and called by their address in `Net.kernels`.

A net of one cable needs none of the kernels for four cables at once, one without cables between free points none of theirs, an
explicit method no Newton step, `edmc` no force at a time, and most scenes no rest length that changes.
"""

from numba import float64, int64, types

from anet_lumped.compiled.addresses import callable_at
from integrators.stage import STAGE

_f1, _f2 = float64[::1], float64[:, ::1]

SIGNATURES = {
    "force": float64(int64, _f2, _f2, _f2),
    "residual": types.UniTuple(float64, 6)(STAGE, int64, _f2, _f2, float64, float64),
    "finish": float64(STAGE, int64),
    "settle": types.UniTuple(float64, 5)(STAGE, int64, _f2, _f2, _f2),
    "settle_effects": float64(STAGE, int64, _f2, _f2, _f2),
    "eliminate": types.void(int64),
    "substitute": float64(int64),
    "drive": types.void(float64, int64, _f2, _f2),
    "set_lengths": types.void(int64, float64, float64, float64),
    "power_of_lengths": float64(int64, float64, _f2, _f2, _f2),
    "work_of_lengths": float64(STAGE, int64, _f2, _f2, _f2),
    "energy_of_paid_out": float64(STAGE, int64, _f2, _f2),
}
as_cable_force, as_cable_residual, as_finish, as_cable_settle, as_settle_effects = (
    callable_at(SIGNATURES[name]) for name in ("force", "residual", "finish", "settle", "settle_effects")
)
as_eliminate, as_substitute, as_drive = (callable_at(SIGNATURES[name]) for name in ("eliminate", "substitute", "drive"))
as_set_lengths, as_power_of_lengths, as_work_of_lengths, as_energy_of_paid_out = (
    callable_at(SIGNATURES[name]) for name in ("set_lengths", "power_of_lengths", "work_of_lengths", "energy_of_paid_out")
)
