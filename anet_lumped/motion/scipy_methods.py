"""scipy's solvers on a Model: tolerances, the times that no step may cross, and the account of the run."""

import time

import numpy as np

from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.mechanics.jacobian import sparse_jacobian
from integrators import scipy_adapter

from .other_packages import finished, scaled
from .times import stops


def march(model, choice, leg, q, v, tension, adaptive, tolerances, rho_inf):
    """March with one of scipy's solvers.

    The error of a step is kept below atol + rtol times the largest coordinate for places [m], and for velocities [m/s]
    below atol/s + rtol times half of the component plus the largest coordinate/s: a coordinate of zero needs no atol.

    Parameters
    ----------
    model : Model
    choice : Choice
        ``dt`` is the first step.
    leg : Leg
    q, v : (n, 3) float64 [m], [m/s]
    tension, adaptive, rho_inf
        Not used; every scheme of `simulate` is marched with the same arguments.
    tolerances : (rtol, atol)

    Returns
    -------
    Run
    """

    net, compiled = fresh_net(model), system(model)
    motion = scipy_adapter.Motion(
        prescribe=lambda t, q, v: compiled.prescribe(t, net.address, q, v),
        force=lambda t, q, v, f, power: compiled.force(t, q, v, net.address, f, power),
        energy=lambda t, q, v, energy: compiled.energy(t, q, v, net.address, energy),
        jacobian=sparse_jacobian(model, net),
        mass=model.mass[: model.n_free],
        margin=(lambda q, v: compiled.margin(q, v, net.address)) if len(net.breaking_tension) else None,
    )
    times = leg.times()
    rtol, atol = scaled(model, q, tolerances)
    began = time.perf_counter()
    out = scipy_adapter.march(
        choice.method, motion, leg.begin, leg.end, stops(model.scene), q, v, times, choice.dt,
        rtol, np.full(6 * model.n_free, atol),
    )  # fmt: skip
    return finished(model, choice, tolerances, out, out.q, out.v, out.energy, time.perf_counter() - began)
