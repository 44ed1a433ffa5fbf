"""A leg of a run with a scheme of this package: the march, what it says of itself, and the Run that comes back."""

import numpy as np

from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.results.energy_balance import book_remainder
from anet_lumped.results.peaks import largest_so_far
from anet_lumped.results.run import STATUS, Run, RunInterrupt, Work
from integrators import schemes
from integrators.marching.adaptive_steps import AdaptiveSteps
from integrators.marching.fixed_steps import FixedSteps
from integrators.marching.march import march as march_system

from .failure_messages import stiff_for, why_it_stopped
from .inner_states import shedding_of_rows, split_inner
from .times import stops

SEVERAL, EXPLICIT_LOOKS = 8, 4  # segments of each cable from which on explicit steps are looked at so many apart, a radian each


def net_and_system(model, scheme, tension, crept=None, shedding=None):
    """What a march with a scheme of this package works on.

    Parameters
    ----------
    model : Model
    scheme : Scheme
    tension : (n_segments,) float64 [N], at the start
    crept : (2, n_segments) float64 [m], [N], of `inner_states`; None where no cable creeps
    shedding : (n, 4) float64, of `inner_states`; None where no cable sheds vortices

    Returns
    -------
    Net, System
    """
    from anet_lumped.mechanics.bindings import system  # compiled on first use: a scene or its equilibrium need none of it

    needs = {"force": scheme.evaluates_force, "newton": not scheme.explicit, "links": scheme.keeps_constraints}
    net, bound = (
        fresh_net(model, **needs, crept=crept, shedding=shedding),
        system(model, **needs, mean=scheme.observes_mean_over_stages),
    )
    net.tension[:] = tension
    return net, bound


def look_every(scene, scheme, stride):
    """Steps between two looks at the largest tensions of a run that saves every ``stride``-th state; 0 if none is left to look at.

    An implicit step knows the tensions that acted in it. An explicit one is short beside what moves a cable of several segments,
    and a look at it costs a sixth of a step.
    """
    if stride == 1:
        return 0
    several = all(cable.segments >= SEVERAL for cable in scene.cables)
    return EXPLICIT_LOOKS if scheme.explicit and several else 1


def march(model, choice, leg, start, settings):
    """March a leg with a scheme of this package.

    Parameters
    ----------
    model : Model
    choice : Choice
    leg : Leg
    start : Start
    settings : Settings

    Returns
    -------
    Run

    Raises
    ------
    RunInterrupt : Ctrl-C
    """
    scheme = schemes.scheme(choice.method)
    net, bound = net_and_system(model, scheme, start.tension, start.crept, start.shedding)
    if settings.adaptive:
        times = AdaptiveSteps(leg.begin, leg.end, choice.dt, *settings.tolerances, stops(model.scene))
        saves = leg.times()
    else:
        stride, saves = leg.stride(choice.dt)
        times = FixedSteps(leg.begin, leg.end, choice.dt, leg.run_begin, stride, look_every(model.scene, scheme, stride))
    parameters = scheme.parameters(rho_inf=settings.rho_inf)
    observed = (3 * model.n_segments if model.creeps else model.n_segments) + len(net.effects.inner)
    out = march_system(scheme, bound, net.address, times, start.q, start.v, (saves, observed), parameters)
    run = run_of(model, choice, out, settings)
    if out.interrupted:
        raise RunInterrupt(run)
    return run


def run_of(model, choice, out, settings):
    """The Run of a leg with a scheme of this package; its arrays are those of the `Outcome`.

    Parameters
    ----------
    model : Model
    choice : Choice
    out : Outcome
    settings : Settings

    Returns
    -------
    Run
    """
    scheme = schemes.scheme(choice.method)
    rows = out.saved.observed
    n, begin_shed = model.n_segments, rows.shape[1] - len(model.effects.inner)
    tensions, inner, shed = rows[:, :n], rows[:, n:begin_shed], rows[:, begin_shed:]
    tolerances = settings.tolerances if settings.adaptive and scheme.embedded else None
    stiff = stiff_for(choice, tolerances, out.counts, out.held, out.held_for) if tolerances else ()
    if not scheme.books_its_losses:
        book_remainder(out.saved.energy)
    return Run(
        model, out.saved.t, out.saved.q, out.saved.v, out.saved.energy, choice.method, choice.dt, choice.reason,
        status=STATUS[out.status],
        message=why_it_stopped(model, choice, out.status, out.t, out.node, tolerances, out.counts),
        work=Work(*map(int, out.counts)),
        error_growth=out.saved.error,
        wall_time=out.wall_time,
        warnings=(*choice.warnings, *stiff),
        segment_tension=tensions,
        largest_tension=largest_so_far(model, tensions, out.saved.noticed) if out.saved.noticed.shape[1] else None,
        **split_inner(model, np.stack(np.split(inner, 2, axis=1)) if model.creeps else None),
        shedding=shedding_of_rows(model, shed) if model.sheds else None,
    )  # fmt: skip
