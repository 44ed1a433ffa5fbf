"""A leg of a run with a solver of another package: what all of them are given, and the Run that comes back."""

from typing import NamedTuple

import numpy as np

from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.net import Net
from anet_lumped.results.run import STATUS, Run, Work
from integrators.adapters.outcome import Outcome, Task
from integrators.system import DIVERGED, DONE, ENERGIES, SUMMED_UP, System

from .times import stops


class Prepared(NamedTuple):
    """A net and its compiled functions, and what a solver is asked to do."""

    net: Net
    system: System
    task: Task


def prepare(model, choice, leg, start, settings):
    """What a solver of another package is given.

    Its tolerances scale with each component, not with the largest coordinate: half of rtol remains theirs, and the other half,
    of the largest coordinate, goes into atol.

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
    Prepared
    """
    rtol, atol = settings.tolerances
    reach = np.abs(start.q).max() or model.scene.longest
    task = Task(
        choice.method, leg.begin, leg.end, stops(model.scene), start.q, start.v, leg.times(), choice.dt,
        rtol=max(0.5 * rtol, 1e-13), atol=atol + 0.5 * rtol * reach,
    )  # fmt: skip
    return Prepared(fresh_net(model, newton=False), system(model, newton=False), task)


def run_of(model, choice, settings, prepared: Prepared, out: Outcome):
    """The Run of what a solver leaves.

    Prescribed nodes and energies are those of the compiled system at the saved times.

    Parameters
    ----------
    model : Model
    choice : Choice
    settings : Settings
    prepared : Prepared
    out : Outcome

    Returns
    -------
    Run
    """
    k, free, address, bound = len(out.t), model.n_free, prepared.net.address, prepared.system
    q, v, energy = np.tile(prepared.task.q, (k, 1, 1)), np.zeros((k, model.n, 3)), np.zeros((k, ENERGIES))
    q[:, :free], v[:, :free] = out.q, out.v
    energy[:, SUMMED_UP] = out.work
    tensions = np.empty(model.n_segments)
    for row, t in enumerate(out.t):
        bound.prescribe(t, address, q[row], v[row])
        bound.observe(t, q[row], v[row], address, tensions, energy[row])
    message = ""
    if out.status != DONE:
        rtol, atol = settings.tolerances
        where = f" at {model.where(out.node)}" if out.node >= 0 else ""
        how = "diverged" if out.status == DIVERGED else "gave up"
        message = (
            f"{choice.method} with rtol={rtol:.3g}, atol={atol:.3g} m {how} at t={out.t[-1]:.4g} s{where}: "
            f'{out.reason.strip().rstrip(".")}; try other tolerances or method="edmc".'
        )
    return Run(
        model, out.t, q, v, energy, choice.method, choice.dt, choice.reason,
        status=STATUS[out.status],
        message=message,
        work=Work(*map(int, out.counts)),
        wall_time=out.wall_time,
        warnings=choice.warnings,
    )  # fmt: skip
