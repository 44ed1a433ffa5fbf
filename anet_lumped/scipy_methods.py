"""scipy's solvers on a Model: tolerances, the times that no step may cross, and the account of the run."""

import time

import numpy as np

from integrators import scipy_adapter
from integrators.system import DIVERGED, DONE

from .bindings import system
from .jacobian import sparse_jacobian
from .run import Run, Work
from .times import save_times, stops


def march(model, choice, t0, t_end, q, v, save_every, adaptive, tolerances, rho_inf):
    """March with one of scipy's solvers.

    The error of a step is kept below atol + rtol times the largest coordinate for places [m], and for velocities [m/s]
    below atol/s + rtol times half of the component plus the largest coordinate/s: a coordinate of zero needs no atol.

    Parameters
    ----------
    model : Model
    choice : Choice
        ``dt`` is the first step.
    t0, t_end : float [s]
    q, v : (n, 3) float64 [m], [m/s]
    save_every : float or None [s]
    adaptive, rho_inf
        Not used; every scheme of `simulate` is marched with the same arguments.
    tolerances : (rtol, atol)

    Returns
    -------
    Run
    """

    net, compiled = model.net(), system(model)
    motion = scipy_adapter.Motion(
        prescribe=lambda t, q, v: compiled.prescribe(t, net.place, q, v),
        force=lambda t, q, v, f, power: compiled.force(t, q, v, net.place, f, power),
        energy=lambda t, q, v, energy: compiled.energy(t, q, v, net.place, energy),
        jacobian=sparse_jacobian(model, net),
        mass=model.mass[: model.n_free],
    )
    times = save_times(t0, t_end, save_every)
    rtol, atol = tolerances
    reach = np.abs(q).max() or max(cable.length for cable in model.scene.cables)
    began = time.perf_counter()
    out = scipy_adapter.march(
        choice.method, motion, t0, t_end, stops(model.scene), q, v, times, choice.dt,
        max(0.5 * rtol, 1e-13), np.full(6 * model.n_free, atol + 0.5 * rtol * reach),
    )  # fmt: skip
    message = ""
    if out.status != DONE:
        at = f" at {model.where(out.node)}" if out.node >= 0 else ""
        how = "diverged" if out.status == DIVERGED else "gave up"
        message = (
            f"{choice.method} with rtol={rtol:.3g}, atol={atol:.3g} m {how} at t={out.t[-1]:.4g} s{at}: "
            f'{out.reason.strip().rstrip(".")}; try other tolerances or method="edmc".'
        )
    return Run(
        model, out.t, out.q, out.v, out.energy, choice.method, choice.dt, choice.reason,
        status={DONE: "done", DIVERGED: "diverged"}.get(out.status, "unconverged"),
        message=message,
        work=Work(*map(int, out.counts)),
        wall_time=time.perf_counter() - began,
        warnings=choice.warnings,
    )  # fmt: skip
