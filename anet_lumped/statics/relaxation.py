"""Statics under loads that depend on the shape: drag, buoyancy, bending, contact.

From a first shape, pseudo-steps lead to rest. Each is a step of backward Euler that starts without velocity, from q_k to the
minimum of the potential energy plus

    m |q - q_k|^2/(2 tau^2) .

tau grows from step to step, until inertia is negligible (pseudo-transient continuation; Kelley & Keyes, SIAM J. Numer. Anal. 35
(1998) 508). Newton's method solves each step with the residual and the tangent of the motion. A cable that lies or bends slides far
under little force: where a shape is balanced to the tolerance of a step, the next step has a finer one.
"""

import math
from typing import NamedTuple

import numpy as np

from anet_lumped.mechanics import newton_step, residual
from anet_lumped.model.tables import AXIAL_DAMPER, AXIAL_L0, AXIAL_L0_BEFORE, AXIAL_L0_RATE, AXIAL_PUSH_SHARE, AXIAL_TWO_WAY_DAMPER
from integrators.stage import LAW_BACKWARD, Stage

from .forces_at_rest import node_forces

SHORT = 0.1  # first tau over sqrt(L/g)
GROWTH, LARGE_GROWTH = 4.0, 30.0  # of tau from one pseudo-step to the next; and where nothing is in the way
LONGEST = 1e4  # last tau over the first one
ON_THE_WAY, AT_END = 1e-6, 1e-14  # of the load: out-of-balance force with which a pseudo-step ends, before tau is longest and then
SHORTER = 1 / 16  # of tau: a last step that Newton's method does not solve, as of slack cables that lie on a ground
FINER = 1e-2  # of `ON_THE_WAY`, after a step that this force did not move: soft cables lie far from rest by then
SEEN = 1e-8  # of the longest cable: a step that moves nodes by less is not judged by its work, which is rounding
AT_REST = 1e-10  # of the load: out-of-balance force from which longer pseudo-steps gain nothing
STEPS, ITERATIONS = 400, 20  # largest number of pseudo-steps, and of Newton iterations in each
# A pseudo-step is too long whose force out of balance, after so many Newton iterations, is so many times that before it, or the
# load of a node. Of nets in a current, steps that found their end had up to 20 times as much by then, others 100 times and more.
SETTLING, HOPELESS = 3, 65.0
# So is one where the line search cuts a Newton step to so much and it still leaves so much of the force out of balance: slack and
# taut segments take turns from there on.
CUT, GAINLESS = 1 / 8, 0.9
THROUGH = 0.5  # of half the smallest width of an obstacle: the farthest that a node goes in a pseudo-step, and not through it
STIFF = 1e-9  # of the load: force that rounding of lengths leaves, from which on a rest is ended with one Newton step more


class Pace(NamedTuple):
    """How pseudo-steps grow.

    Parameters
    ----------
    first : float [s], largest tau of the first step; every node has such a mass that all of them weigh the load at 1 m/s2
    growth : float, largest ratio of tau to tau of the step before
    """

    first: float = math.inf
    growth: float = GROWTH


QUICK, SLOW, UNHINDERED = Pace(), Pace(growth=1.3), Pace(growth=LARGE_GROWTH)


def net_at_rest(model, net, load, eased=False):
    """The net for pseudo-steps, with rest lengths as at t = 0 and masses of its own.

    Parameters
    ----------
    model : Model
    net : Net
    load : float [N]
    eased : bool
        Whether to solve an easier problem first: no cable pushes, whatever its law, and effects that join next-but-one neighbours,
        as bending does, are left out. Then no cable can come to rest in a fold: the energy of cables that cannot push is convex.

    Returns
    -------
    Net
    """
    axial = net.axial.copy()
    axial[:, AXIAL_L0_RATE], axial[:, AXIAL_L0_BEFORE], axial[:, AXIAL_DAMPER] = 0.0, axial[:, AXIAL_L0], 0.0
    if eased:
        axial[:, AXIAL_PUSH_SHARE] = axial[:, AXIAL_TWO_WAY_DAMPER] = 0.0
    mass = np.where(np.arange(model.n) < model.n_free, load / max(model.n_free, 1), 0.0)
    return net._replace(
        mass=mass,
        axial=axial,
        lengths=net.lengths._replace(cable=np.empty(0, np.int64)),
        effects=_without_bending(model, net.effects) if eased else net.effects,
        tension=net.tension.copy(),
    ).addressed()


def _without_bending(model, effects):
    """The effects of a model that do not join next-but-one neighbours."""
    chosen = [e for e, effect in enumerate(model.forces) if effect.coupled_neighbours < 2]
    index, params = zip(*(effects.numbers(e) for e in chosen), strict=True) if chosen else ((), ())
    return effects._replace(
        address=np.ascontiguousarray(effects.address[chosen]),
        index=np.concatenate([*index, np.empty(0, np.int64)]),
        index_at=np.cumsum([0, *map(len, index)], dtype=np.int64),
        params=np.concatenate([*params, np.empty(0)]),
        params_at=np.cumsum([0, *map(len, params)], dtype=np.int64),
    )


def relaxed(model, net, q, load, pace=QUICK, steps=STEPS):
    """Bring a shape to rest; overwrites q and the tensions of the net.

    Parameters
    ----------
    model : Model
    net : Net
        From `net_at_rest`, with the tensions that belong to q.
    q : (n, 3) float64 [m]
        Rows of prescribed nodes hold their positions.
    load : float [N]
        Load that tolerances are relative to.
    pace : Pace
    steps : int, largest number of pseudo-steps

    Returns
    -------
    residual : float
        Largest out-of-balance force over the load.
    """
    length, moving = model.scene.longest, max(model.n_free, 1)
    farthest = THROUGH * min((effect.narrowest for effect in model.forces), default=math.inf)
    usual = SHORT * math.sqrt(length)
    first = tau = min(usual, pace.first)
    longest = LONGEST * usual
    best, unbalanced, growth, at_end, enough = math.inf, math.inf, pace.growth, False, ON_THE_WAY
    for _ in range(steps):
        before, tension = q.copy(), net.tension.copy()
        at_end = at_end or tau >= longest
        left, iterations = _step(net, q, tau, load, AT_END if at_end else enough)
        moved = float(np.abs(q - before).max())
        solved = left <= (ON_THE_WAY if at_end else enough) * load and np.isfinite(moved)
        if not solved or moved > farthest or (moved > SEEN * length and _uphill(model, net, before, tension, q, tau)):
            q[:], net.tension[:] = before, tension
            tau, growth = 0.25 * tau, 1.0 + 0.25 * (growth - 1.0)  # a shorter step, and slower growth after it
            at_end, unbalanced = False, math.inf
            if tau < 1e-6 * first:
                break
            continue
        if iterations == 0:
            enough = max(FINER * enough, AT_REST)
        best = moved / (moving * tau**2)  # inertial force of the last step, which its forces balance, over the load
        # a step without an iteration moved nothing, and one with a finer tolerance may
        still = (best <= 1e-13 and iterations > 0) or (at_end and moved <= 1e-14 * length)
        if still or at_end:
            now = max(_unbalanced(net, q), best * load)  # dampers of contacts may hold it, and not inertia
            if (still and now <= AT_REST * load) or (at_end and now > 0.9 * unbalanced):
                break
            unbalanced = now if at_end else math.inf
        if at_end and iterations == ITERATIONS:
            tau *= SHORTER
        elif tau < longest:
            tau *= growth if iterations < ITERATIONS // 2 else 1.0
            growth = min(pace.growth, 1.2 * growth)
    _polish(net, q, min(tau, longest), load)
    return max(best, _unbalanced(net, q) / load)


def _uphill(model, net, before, tension, q, tau):
    """Whether a pseudo-step ended at a saddle in place of the minimum that it was to find: the forces have worked against it.

    Of cables that push, Newton's method finds either. A shorter step has no saddle.

    Parameters
    ----------
    before, q : (n, 3) float64 [m], shapes before and after the step
    tension : (n_segments,) float64 [N], before the step
    tau : float [s]
    """
    if not (net.axial[:, AXIAL_PUSH_SHARE] > 0.0).any():
        return False
    d = (q - before)[: model.n_free]
    force = node_forces(model, net, before, tension)[: model.n_free]  # that after the step is inertia, m d/tau^2
    return float((force * d).sum() + (net.mass[: model.n_free, None] * d * d).sum() / tau**2) < 0.0


def _polish(net, q, tau, load):
    """Take one Newton step more where cables are so stiff that rounded lengths hide a force of `STIFF`; overwrites q and tensions.

    Such a rest counts as balanced as soon as its tensions are off by no more than what rounding leaves in them by the law. The
    tensions that a Newton step predicts have no such rounding, and of a shape that is next to the rest they are off by a square.
    It is left out where it does not lower what those tensions leave out of balance.
    """
    before, tension = q.copy(), net.tension.copy()
    stage = Stage(LAW_BACKWARD, 0.0, 1.0 / tau**2, 1.0, tau, 0.0)
    _, _, noise, predicted = residual.residual(stage, before, before, q, net.address)
    if noise <= STIFF * load:
        return
    newton_step.direction(stage, net.address)
    newton_step.correct(net.address, 1.0, q)
    left = residual.residual(stage, before, before, q, net.address)[-1]
    if not left <= predicted:
        q[:], net.tension[:] = before, tension


def _unbalanced(net, q):
    """Out-of-balance force of a shape without velocity [N].

    What resists velocities may hold a pseudo-step that has not come to rest.
    """
    stage = Stage(LAW_BACKWARD, 0.0, 1.0, 1.0, 1.0, 0.0)
    norm, _, noise, predicted = residual.residual(stage, q.copy(), q.copy(), q, net.address)
    return min(predicted, max(norm - noise, 0.0))


def _step(net, q, tau, load, tolerance):
    """Take a pseudo-step, to a tolerance over the load; return the force out of balance then [N] and its Newton iterations."""
    base = q.copy()
    stage = Stage(LAW_BACKWARD, 0.0, 1.0 / tau**2, 1.0, tau, 0.0)
    norm, _, noise, predicted = residual.residual(stage, base, base, q, net.address)
    hopeless = HOPELESS * max(predicted, load / max(net.n_free, 1))
    for iteration in range(ITERATIONS):
        # predicted tensions balance better than the law does for stiff cables, whose lengths are rounded
        if predicted <= tolerance * load or (iteration > 2 and norm <= noise):
            return min(predicted, max(norm - noise, 0.0)), iteration
        if iteration >= SETTLING and predicted > hopeless:
            break
        newton_step.direction(stage, net.address)
        newton_step.correct(net.address, 1.0, q)
        before, length = norm, 1.0
        norm, _, noise, predicted = residual.residual(stage, base, base, q, net.address)
        while iteration > 3 and norm > before and predicted > 1e-10 * load and length > 1e-3:
            length *= 0.5
            newton_step.correct(net.address, -length, q)
            norm, _, noise, predicted = residual.residual(stage, base, base, q, net.address)
        if length <= CUT and norm > GAINLESS * before:
            break
    return min(predicted, max(norm - noise, 0.0)), ITERATIONS
