"""Messages of runs with the schemes of this package: one sentence with when, where, why and what to try."""

import math
from dataclasses import replace

import numpy as np

from anet_lumped.mechanics.finite_laws import name_law_that_is_not_finite
from integrators.system import DIVERGED, DONE, INTERRUPTED, OUT_OF_STEPS, REJECTED, STEPS

STIFF_SHARE = 0.1  # of the steps: where stability holds more of them, a motion is called stiff for an explicit method


def why_it_stopped(model, choice, status, t, node, tolerances, counts):
    """Message of a run that did not reach its end; empty for one that did.

    Parameters
    ----------
    model : Model
    choice : Choice
    status : int, see `integrators.system`
    t : float [s], time reached
    node : int, where it went wrong, or -1
    tolerances : (rtol, atol) of an embedded pair that chose its steps, else None
    counts : (6,) int64, work counts

    Returns
    -------
    str
    """
    if status == DONE:
        return ""
    if status == INTERRUPTED:
        return f"{choice.method} with dt={choice.dt:.3g} s was stopped by the user at t={t:.4g} s."
    if tolerances is not None:
        return _of_embedded_pair(model, choice, status, t, node, tolerances, int(counts[STEPS]), int(counts[REJECTED]))
    if status == DIVERGED:
        limit = f", whose predicted limit is {choice.limit:.3g} s" if math.isfinite(choice.limit) else ""
        return (
            f"{choice.method} with dt={choice.dt:.3g} s{limit}, diverged at t={t:.4g} s at {model.where(node)}; "
            f"try a smaller step{_or_edmc(choice.method)}."
        )
    pushes = any(cable.compression != "none" for cable in model.scene.cables)
    other = ["a smaller step", *['method="edmc"'] * (choice.method != "edmc"), *['compression="none"'] * pushes]
    return (
        f"{choice.method} with dt={choice.dt:.3g} s did not converge at t={t:.4g} s even with the step cut to "
        f"{choice.dt / 4096:.1e} s; try {' or '.join(other)}."
    )


def _or_edmc(method):
    """The default method as advice, but to itself."""
    return "" if method == "edmc" else ' or method="edmc"'


def _of_embedded_pair(model, choice, status, t, node, tolerances, steps, rejected):
    head = f"{choice.method} with {_in_words(tolerances)}"
    if status == OUT_OF_STEPS:
        return (
            f"{head} was at t={t:.4g} s when it had tried all {steps + rejected} steps that a run may take ({rejected} rejected; "
            f'the predicted limit is {choice.limit:.3g} s); try method="edmc", a larger tolerance or a shorter run.'
        )
    if status == DIVERGED:
        return f'{head} diverged at t={t:.4g} s at {model.where(node)}; try method="edmc".'
    return (
        f"{head} found no step at t={t:.4g} s whose error it allows ({rejected} of {steps + rejected} were rejected); try a larger "
        'tolerance or method="edmc".'
    )


def with_cause(run):
    """The run, with the effect that is not finite named first in its message, if there is one."""
    every = run.t[-1] - run.t[-2] if len(run.t) > 1 else run.dt
    rows = [*np.flatnonzero(~np.isfinite(run.energy).all(axis=1))[:1], *range(max(len(run.t) - 3, 0), len(run.t))]
    ahead = [(run.t[k] + h, run.q[k] + h * run.v[k], run.v[k]) for k in rows[-2:] for h in (0.5 * run.dt, run.dt, every)]
    law = name_law_that_is_not_finite(run.model, [(run.t[k], run.q[k], run.v[k]) for k in rows] + ahead)
    return replace(run, message=law + run.message) if law else run


def stiff_for(choice, tolerances, counts, held, held_for):
    """Warning in a tuple if stability held steps that the tolerance would let grow, else an empty tuple.

    Parameters
    ----------
    choice : Choice
    tolerances : (rtol, atol)
    counts : (6,) int64, work counts
    held, held_for : int, float [s]
        Steps that stability held, and their time.

    Returns
    -------
    tuple of str
    """
    if held <= STIFF_SHARE * counts[STEPS]:
        return ()
    return (
        f"The motion is stiff for {choice.method}: stability, whose predicted limit is {choice.limit:.3g} s, held at least {held} "
        f"of {counts[STEPS]} steps to {held_for / held:.3g} s, where {_in_words(tolerances)} allows longer ones; "
        'method="edmc" has no such limit.',
    )


def _in_words(tolerances):
    return ", ".join(f"{name}={x:.3g}{unit}" for name, x, unit in zip(("rtol", "atol"), tolerances, ("", " m"), strict=True) if x)
