"""What the marches of other packages' solvers share: how tolerances are meant, and the Run that comes back."""

import numpy as np

from anet_lumped.results.run import STATUS, Run, Work
from integrators.system import DIVERGED, DONE


def scaled(model, q, tolerances):
    """Relative and absolute tolerance for a solver that scales with each component, not with the largest coordinate.

    Parameters
    ----------
    model : Model
    q : (n, 3) float64 [m]
    tolerances : (rtol, atol), of the largest coordinate and [m]

    Returns
    -------
    rtol, atol : float
    """
    rtol, atol = tolerances
    reach = np.abs(q).max() or max(cable.length for cable in model.scene.cables)
    return max(0.5 * rtol, 1e-13), atol + 0.5 * rtol * reach


def finished(model, choice, tolerances, out, q, v, energy, wall_time):
    """The Run of a march.

    Parameters
    ----------
    model : Model
    choice : Choice
    tolerances : (rtol, atol) as they were asked for
    out : outcome with status, reason, node, t and counts, as the adapters return it
    q, v, energy : (k, n, 3), (k, n, 3), (k, 5) float64 [m], [m/s], [J], at the times ``out.t``
    wall_time : float [s]

    Returns
    -------
    Run
    """
    message = ""
    if out.status != DONE:
        rtol, atol = tolerances
        at = f" at {model.where(out.node)}" if out.node >= 0 else ""
        how = "diverged" if out.status == DIVERGED else "gave up"
        message = (
            f"{choice.method} with rtol={rtol:.3g}, atol={atol:.3g} m {how} at t={out.t[-1]:.4g} s{at}: "
            f'{out.reason.strip().rstrip(".")}; try other tolerances or method="edmc".'
        )
    return Run(
        model, out.t, q, v, energy, choice.method, choice.dt, choice.reason,
        status=STATUS[out.status],
        message=message,
        work=Work(*map(int, out.counts)),
        wall_time=wall_time,
        warnings=choice.warnings,
    )  # fmt: skip
