"""Statics under loads that depend on the shape: drag, buoyancy, bending, contact.

From the shape that `equilibrium` finds under the loads as they are there, backward Euler steps from rest, each of which starts
without velocity: the minimum of the energy plus m |q - q_k|^2/(2 tau^2), for tau that grows from step to step until inertia
counts for nothing (pseudo-transient continuation; Kelley & Keyes, SIAM J. Numer. Anal. 35 (1998) 508). Each is solved by
Newton's method on the very residual and tangent of the motion.
"""

import math
from typing import NamedTuple

import numpy as np

from anet_lumped.mechanics import newton_step, residual
from anet_lumped.model.tables import AXIAL_L0, AXIAL_L0_BEFORE, AXIAL_L0_RATE, AXIAL_PUSH_SHARE, AXIAL_TWO_WAY_DAMPER
from integrators.stage import LAW_BACKWARD, Stage

SHORT, GROWTH, LONGEST = 0.1, 4.0, 1e4  # of tau: the first one over sqrt(L/g), its growth, and the last one over the first
STEPS, ITERATIONS = 400, 20  # most pseudo-steps, and Newton iterations of one


class Pace(NamedTuple):
    """How pseudo-steps grow.

    Parameters
    ----------
    first : float [s], tau of the first step, at most; all nodes alike weigh the load at 1 m/s2
    growth : float, of tau from step to step, at most
    """

    first: float = math.inf
    growth: float = GROWTH


QUICK, SLOW = Pace(), Pace(growth=1.3)


def net_at_rest(model, net, load, eased=False):
    """A net whose rest is to be found: lengths that change in time are those of t = 0.

    Parameters
    ----------
    model : Model
    net : Net
    load : float [N]
    eased : bool
        Whether no cable pushes, whatever its law, and effects that join next-but-one neighbours, as bending does, are left out.
        What is left folds nothing: the energy of cables that cannot push is convex.

    Returns
    -------
    Net
    """
    axial = net.axial.copy()
    axial[:, AXIAL_L0_RATE], axial[:, AXIAL_L0_BEFORE] = 0.0, axial[:, AXIAL_L0]
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
    """Those of a model's effects that do not join next-but-one neighbours."""
    chosen = [e for e, effect in enumerate(model.forces) if effect.coupled_neighbours < 2]
    index, params = zip(*(effects.numbers(e) for e in chosen), strict=True) if chosen else ((), ())
    return effects._replace(
        address=np.ascontiguousarray(effects.address[chosen]),
        index=np.concatenate([*index, np.empty(0, np.int64)]),
        index_at=np.cumsum([0, *map(len, index)], dtype=np.int64),
        params=np.concatenate([*params, np.empty(0)]),
        params_at=np.cumsum([0, *map(len, params)], dtype=np.int64),
    )


def relaxed(model, net, q, load, pace=QUICK):
    """Bring places to rest, in place.

    Parameters
    ----------
    model : Model
    net : Net
        Of `net_at_rest`; its tensions belong to q.
    q : (n, 3) float64 [m]
        Rows of prescribed nodes hold their places.
    load : float [N]
        That tolerances are relative to.
    pace : Pace

    Returns
    -------
    residual : float
        Largest force out of balance over the load.
    """
    length, moving = max(cable.length for cable in model.scene.cables), max(model.n_free, 1)
    usual = SHORT * math.sqrt(length)
    first = tau = min(usual, pace.first)
    longest = LONGEST * usual
    best, growth = math.inf, pace.growth
    for _ in range(STEPS):
        before, tension = q.copy(), net.tension.copy()
        left, iterations = _step(net, q, tau, load)
        if left > 1e-9 * load or not np.isfinite(q).all():
            q[:], net.tension[:] = before, tension
            tau, growth = 0.25 * tau, 1.0 + 0.25 * (growth - 1.0)  # and more slowly from here on
            if tau < 1e-6 * first:
                break
            continue
        moved = float(np.abs(q - before).max())
        best = moved / (moving * tau**2)  # what inertia still takes
        if best <= 1e-13 or (tau >= longest and moved <= 1e-14 * length):
            break
        if tau < longest:
            tau *= growth if iterations < ITERATIONS // 2 else 1.0
            growth = min(pace.growth, 1.2 * growth)
    return best


def _step(net, q, tau, load):
    """One pseudo-step; returns the force out of balance at its end [N] and the Newton iterations that it took."""
    base = q.copy()
    stage = Stage(LAW_BACKWARD, 0.0, 1.0 / tau**2, 1.0, tau, 0.0)
    norm, _, noise, predicted = residual.residual(stage, base, base, q, net.address)
    for iteration in range(ITERATIONS):
        # tensions as predicted balance far better than those of stiff cables by their lengths, down to their own rounding
        if predicted <= 1e-14 * load or (iteration > 2 and norm <= noise):
            return min(predicted, max(norm - noise, 0.0)), iteration
        newton_step.direction(stage, net.address)
        newton_step.correct(net.address, 1.0, q)
        before, length = norm, 1.0
        norm, _, noise, predicted = residual.residual(stage, base, base, q, net.address)
        while iteration > 3 and norm > before and predicted > 1e-10 * load and length > 1e-3:
            length *= 0.5
            newton_step.correct(net.address, -length, q)
            norm, _, noise, predicted = residual.residual(stage, base, base, q, net.address)
    return min(predicted, max(norm - noise, 0.0)), ITERATIONS
