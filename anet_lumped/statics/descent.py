"""Descent to a minimum of the potential energy, from any shape, past any fold.

Each step d solves (K + m I) d = f, with the forces f and their exact tangent K. Where cables push or fold, K is not positive
definite. The number m grows until K + m I is positive definite, and until the forces do the work over the step that the linearised
forces predict. So the energy falls with every step, and the descent does not end at a rest that is not a minimum (the idea of
Levenberg and Marquardt). Bodies shift and turn, see `body_tangent`. The descent is slow for stiff cables that move far. It is used
where pseudo-steps find no rest, and pseudo-steps bring the forces to balance after it.
"""

from typing import Any

import numpy as np

from anet_lumped.model.model import Model
from anet_lumped.model.tables import AXIAL_INEXTENSIBLE, AXIAL_L0, AXIAL_STIFFNESS

from .body_tangent import of_bodies
from .forces_at_rest import force_of_effects
from .held_bodies import keep_shapes
from .stability import pivots_of, segments, symmetric_part, tangent

STEPS, FEWEST_STEPS = 1000, 100  # and those of the largest nets
MANY_POINTS = 120  # free points, from which on a descent has fewer steps, so that one of a large net takes seconds
NEAR = 1e-4  # of the load: pseudo-steps find the balance from an out-of-balance force of this size
ENOUGH = 0.1  # of the predicted work: a step that does less is not taken
GOOD = 0.7  # of the predicted work: after a step that does more, m becomes smaller
SOFTEST = 1e-9  # of the first m, the least: nodes that nothing holds, as of a heap on the ground, have no other stiffness
STIFFEST = 1e5  # EA over the load, in place of a cable that does not stretch: a strain of 1e-5 under the load


def descended(model: Model, net: Any, q: np.ndarray, load: float, near: float = NEAR) -> tuple[np.ndarray, float]:
    """Let cables down to a shape of least energy, in place.

    Parameters
    ----------
    model : Model
    net : Net
    q : (n, 3) float64 [m]
    load : float [N]
    near : float
        The descent ends where the force on each node is at most this times the load over the number of nodes.

    Returns
    -------
    tension : (n_segments,) float64 [N], by the law
    residual : float, largest force out of balance over the load
    """
    n, net = model.n_free, _stretching(net, load)
    L0 = min((cable.L0 for cable in model.scene.cables), default=model.scene.longest)
    force, tension = _forces(model, net, q)
    K, soft = None, 1e-3 * load / (n * L0)
    shift = soft
    for _ in range(max(FEWEST_STEPS, STEPS * MANY_POINTS // max(n - model.n_interior, MANY_POINTS))):
        if K is None:
            K, motions = of_bodies(model, net, q, tension, tangent(model, net, q, tension))
            pull = motions.T @ force.ravel()
        near_rest = np.abs(pull).max(initial=0.0) <= near * load / n
        if near_rest and not (pivots_of(symmetric_part(K), 1e-6 * soft)[0] < 0.0).any():
            break
        pivots, factors = pivots_of(symmetric_part(K), shift)
        if (pivots < 0.0).any():
            shift *= 4.0
            continue
        d = factors.solve(pull)
        moved = motions @ d
        largest = float(np.abs(moved).max())
        if largest > L0:
            d, moved = d * (L0 / largest), moved * (L0 / largest)
        q_trial = q.copy()
        q_trial[:n] += moved.reshape(-1, 3)
        keep_shapes(model, q_trial)
        trial_force, trial_tension = _forces(model, net, q_trial)
        predicted_work = float(d @ pull - 0.5 * d @ (K @ d))
        work = 0.5 * float((q_trial - q)[:n].ravel() @ (force + trial_force).ravel())
        if np.isfinite(work) and work >= ENOUGH * predicted_work:
            q[:], force, tension, K = q_trial, trial_force, trial_tension, None
            shift = max(0.25 * shift, SOFTEST * soft) if work >= GOOD * predicted_work else shift
        else:
            shift *= 4.0
        if not 0.0 < shift < 1e30:
            break
    _, motions = of_bodies(model, net, q, tension, tangent(model, net, q, tension))
    return tension, float(np.abs(motions.T @ force.ravel()).max(initial=0.0)) / load


def _stretching(net, load):
    """The net with stiff springs for cables that do not stretch."""
    rigid = net.axial[:, AXIAL_INEXTENSIBLE] > 0.0
    if not rigid.any():
        return net
    axial = net.axial.copy()
    axial[rigid, AXIAL_STIFFNESS] = STIFFEST * load / axial[rigid, AXIAL_L0]
    axial[rigid, AXIAL_INEXTENSIBLE] = 0.0
    return net._replace(axial=axial)


def _forces(model, net, q):
    """Force on every moving node at rest (n_free, 3) [N], and the tensions by the law."""
    f, (a, b), here = force_of_effects(model, net, q), model.ends.T, segments(model, net, q)
    pull = here.tension[:, None] * here.unit
    np.add.at(f, a, pull)
    np.add.at(f, b, -pull)
    return f[: model.n_free], here.tension
