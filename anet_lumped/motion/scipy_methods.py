"""A leg of a run with one of scipy's solvers."""

from anet_lumped.mechanics.jacobian import sparse_jacobian
from integrators.adapters import scipy_adapter

from .other_packages import prepare, run_of


def march(model, choice, leg, start, settings):
    """March a leg with one of scipy's solvers.

    The error of a step is kept below atol + rtol times the largest coordinate for places [m], and for velocities [m/s]
    below atol/s + rtol times half of the component plus the largest coordinate/s: a coordinate of zero needs no atol.

    Parameters
    ----------
    model : Model
    choice : Choice
        ``dt`` is the first step.
    leg : Leg
    start : Start
    settings : Settings

    Returns
    -------
    Run
    """
    prepared = prepare(model, choice, leg, start, settings)
    net, system, task = prepared
    motion = scipy_adapter.Motion(
        prescribe=lambda t, q, v: system.prescribe(t, net.address, q, v),
        force=lambda t, q, v, f, power: system.force(t, q, v, net.address, f, power),
        jacobian=sparse_jacobian(model, net),
        mass=model.mass[: model.n_free],
        margin=(lambda q, v: system.margin(q, v, net.address)) if len(net.breaking_tension) else None,
    )
    return run_of(model, choice, settings, prepared, scipy_adapter.march(motion, task))
