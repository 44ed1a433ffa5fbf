"""Descent to a minimum of the potential energy, from any shape, past any fold.

Steps d of (K + m I) d = f with the exact tangent K of the forces f, which is not positive definite where cables push or fold;
m grows until it is, and until the forces do the work over the step that the linearised ones promise. So the energy falls with
every step, and a rest that is not a minimum is not kept (Levenberg's and Marquardt's idea). Slow for stiff cables that move far,
so that it is for what pseudo-steps do not find; these bring the forces to balance at its end.
"""

from typing import Any

import numpy as np

from anet_lumped.model.model import Model
from anet_lumped.model.tables import AXIAL_INEXTENSIBLE, AXIAL_L0, AXIAL_STIFFNESS

from .stability import pivots_of, segments, symmetric_part, tangent

STEPS = 1000
NEAR = 1e-4  # of the load, a force from which pseudo-steps find the balance
ENOUGH, GOOD = 0.1, 0.7  # of the promised work, for a step to count and for a longer one
STIFFEST = 1e5  # of the load a strain of 1 may cost in a cable that does not stretch, which is one of 1e-5 under the load


def descended(model: Model, net: Any, q: np.ndarray, load: float, near: float = NEAR) -> tuple[np.ndarray, float]:
    """Let cables down to a shape of least energy, in place.

    Parameters
    ----------
    model : Model
    net : Net
    q : (n, 3) float64 [m]
    load : float [N]
    near : float
        Of the load over the number of nodes, the force on a node at which the descent ends.

    Returns
    -------
    tension : (n_segments,) float64 [N], by the law
    residual : float, largest force out of balance over the load
    """
    n, net = model.n_free, _stretching(net, load)
    L0 = min(cable.L0 for cable in model.scene.cables)
    force, tension = _forces(model, net, q)
    K, soft = None, 1e-3 * load / (n * L0)
    stiff = soft
    for _ in range(STEPS):
        if np.abs(force).max(initial=0.0) <= near * load / n:
            if K is None:
                K = tangent(model, net, q, tension)
            if not (pivots_of(symmetric_part(K), 1e-6 * soft)[0] < 0.0).any():
                break
        if K is None:
            K = tangent(model, net, q, tension)
        pivots, factors = pivots_of(symmetric_part(K), stiff)
        if (pivots < 0.0).any():
            stiff *= 4.0
            continue
        d = factors.solve(force.ravel())
        largest = float(np.abs(d).max())
        if largest > L0:
            d *= L0 / largest
        ahead = q.copy()
        ahead[:n] += d.reshape(-1, 3)
        there, pulled = _forces(model, net, ahead)
        promised = float(d @ force.ravel() - 0.5 * d @ (K @ d))
        done = 0.5 * float(d @ (force + there).ravel())
        if np.isfinite(done) and done >= ENOUGH * promised:
            q[:], force, tension, K = ahead, there, pulled, None
            stiff *= 0.25 if done >= GOOD * promised else 1.0
        else:
            stiff *= 4.0
        if not 0.0 < stiff < 1e30:
            break
    return tension, float(np.abs(force).max(initial=0.0)) / load


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
    f, v = np.zeros_like(q), np.zeros_like(q)
    for e, effect in enumerate(model.forces):
        if not effect.no_force_at_rest:
            effect.kernels()["force"](0.0, q, v, *net.effects.numbers(e), f)
    (a, b), here = model.ends.T, segments(model, net, q)
    pull = here.tension[:, None] * here.unit
    np.add.at(f, a, pull)
    np.add.at(f, b, -pull)
    return f[: model.n_free], here.tension
