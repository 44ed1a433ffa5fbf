"""Rest of cables that stretch little or not at all, from the rest of softer ones.

Rounding of a length leaves a force in the law of a stiff cable, and cables that do not stretch have no law. So here the tensions T
are unknowns of their own. Newton's method solves the balance of forces together with the law of each taut segment,

    f(q) - B^T T = 0 ,     l(q) - L0 - T/k = 0 ,

with the lengths' derivatives B, and with 1/k = 0 where a segment does not stretch. With the tangent K at fixed tensions a step is

    [ K     B^T ] [dq]   [ f - B^T T      ]
    [ B    -1/k ] [dT] = [ L0 + T/k - l   ] .

A small stiffness `SOFTEST` is added to K, and a small compliance 1/`STIFFEST` to 1/k. They change the steps and not their end.
Without them, nothing resists nodes that lie on a flat ground between slack segments, and the tensions of cables that are straight
between two supports are not unique. A stiff segment is taut while T + c (l - L0 - T/k) > 0, with a softer spring c. In place of
the places of a moving body's nodes, its shifts and turns are unknowns, see `body_tangent`.
Source: Hintermüller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865, for the sets of taut and slack segments.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array, eye_array
from scipy.sparse.linalg import splu

from anet_lumped.model.model import Model
from anet_lumped.model.tables import (
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    CABLE_CURVE,
    CABLE_CURVE_END,
)

from .body_tangent import of_bodies
from .forces_at_rest import node_forces
from .held_bodies import keep_shapes
from .stability import EPS, Segments, segments, tangent

SOFT = 1e5  # EA over the load, in place of a larger one and of one that is infinite: a strain of 1e-5 under the load
SOFTER = 1e3  # likewise, where no rest is found with that: of cables over solids
SOFTEST = 1e-9  # of the load over length: stiffness of all nodes together against moving
STIFFEST = 1e13  # of the load over length: stiffness of a segment that does not stretch
ITERATIONS = 30
BALANCED = 1e-12  # of the load: force out of balance that ends the iterations
NO_TENSION = 1e-9  # of the load: segments that touch their lengths without a tension would be taut and slack by turns at 0
ROUNDED_LENGTH = 8.0 * EPS  # of the largest coordinate or length: a smaller error of a length is rounding


class _Balance(NamedTuple):
    """What Newton's method solves, and its numbers of each segment.

    Parameters
    ----------
    force : (n_free, 3) float64 [N], out of balance
    gap : l - L0 - T/k [m]
    compliance : 1/k [m/N]
    taut : bool, whether the tension is an unknown
    tension : T [N], 0 where a stiff segment is slack
    pull : T [N], which is not negative where a segment cannot push
    here : Segments
    """

    force: np.ndarray
    gap: np.ndarray
    compliance: np.ndarray
    taut: np.ndarray
    tension: np.ndarray
    pull: np.ndarray
    here: Segments


def are_stiff(net: Any, load: float) -> np.ndarray:
    """(n_cables,) bool, whether a cable does not stretch or has an EA of more than `SOFT` times the load [N]."""
    return (net.axial[:, AXIAL_INEXTENSIBLE] > 0.0) | (net.axial[:, AXIAL_STIFFNESS] * net.axial[:, AXIAL_L0] > SOFT * load)


def softened(net: Any, load: float, EA: float = SOFT) -> Any:
    """The net with cables of an ``EA`` over the load [N] in place of stiff ones, and of those that do not stretch."""
    axial, stiff = net.axial.copy(), are_stiff(net, load)
    axial[stiff, AXIAL_STIFFNESS] = EA * load / axial[stiff, AXIAL_L0]
    axial[stiff, AXIAL_INEXTENSIBLE] = 0.0
    return net._replace(axial=axial)


def at_rest_as_stiff(model: Model, net: Any, q: np.ndarray, tension: np.ndarray, load: float) -> float:
    """Bring the rest of `softened` cables to that of the net's own, in place.

    Parameters
    ----------
    model : Model
    net : Net
    q : (n, 3) float64 [m]
    tension : (n_segments,) float64 [N]
    load : float [N]
        Load that tolerances are relative to.

    Returns
    -------
    residual : float
        Largest out-of-balance force over the load, with errors of lengths as forces of the soft cables.
    """
    n, (a, b), length = model.n_free, model.ends.T, model.scene.longest
    L0 = net.axial[model.cable_of, AXIAL_L0]
    rounded, balance_of = ROUNDED_LENGTH * max(float(np.abs(q).max()), length), _balance(model, net, load)
    best, residual = (q.copy(), tension.copy()), np.inf
    for _ in range(ITERATIONS):
        now = balance_of(q, tension)
        too_long = max(float(np.abs(now.gap[now.taut]).max(initial=0.0)) - rounded, 0.0)
        K = tangent(model, net, q, now.tension, slope=np.where(now.taut, 0.0, now.here.slope))
        K, motions = of_bodies(model, net, q, now.pull, K)
        force = motions.T @ now.force.ravel()
        left = max(float(np.abs(force).max()) / load, SOFT * too_long / length)
        if left < residual:
            best, residual = (q.copy(), now.pull), left
        if left <= BALANCED or not np.isfinite(left):
            break
        at = np.flatnonzero(now.taut)
        K = K + SOFTEST * load / (n * length) * eye_array(len(force))
        B = _length_derivatives(n, a[at], b[at], now.here.unit[at]) @ motions
        C = diags_array(now.compliance[at] + L0[at] / (STIFFEST * load))
        try:
            factors = splu(block_array([[K, B.T], [B, -C]], format="csc"))
        except RuntimeError:  # singular: no rest is near
            break
        step = factors.solve(np.concatenate([force, -now.gap[at]]))
        moved = motions @ step[: len(force)]
        share = min(1.0, float(L0.min(initial=length) / np.abs(moved).max(initial=1e-300)))  # no node by more than a segment
        q[:n] += share * moved.reshape(-1, 3)
        keep_shapes(model, q)
        tension[:] = now.tension
        tension[at] += share * step[len(force) :]
    q[:], tension[:] = best
    return residual


def _balance(model: Model, net: Any, load: float) -> Callable[[np.ndarray, np.ndarray], _Balance]:
    """`_Balance` as a function of q (n, 3) [m] and the tensions [N]."""
    axial, moves = net.axial[model.cable_of], (model.ends < model.n_free).any(axis=1)
    L0, rigid, pushes = axial[:, AXIAL_L0], axial[:, AXIAL_INEXTENSIBLE] > 0.0, axial[:, AXIAL_PUSH_SHARE] > 0.0
    has_curve = model.cable[:, CABLE_CURVE] < model.cable[:, CABLE_CURVE_END]
    switches = (are_stiff(net, load) & ~has_curve)[model.cable_of] & ~pushes
    own_compliance = np.where(rigid, 0.0, 1.0 / np.where(rigid, 1.0, axial[:, AXIAL_STIFFNESS]))

    def balance(q, tension):
        here = segments(model, net, q)
        by_law = np.divide(1.0, here.slope, out=np.zeros_like(L0), where=here.slope > 0.0)
        compliance = np.where(switches, own_compliance, by_law)
        gap = np.where(rigid | switches, here.length - L0 - compliance * tension, compliance * (here.tension - tension))
        stays = tension + SOFT * load / L0 * gap > -NO_TENSION * load
        taut = moves & np.where(switches, stays, rigid | (here.slope > 0.0))
        tension = np.where(taut, tension, np.where(switches, 0.0, here.tension))
        pull = np.where(switches, np.maximum(tension, 0.0), tension)
        force = node_forces(model, net, q, pull)[: model.n_free]
        return _Balance(force, gap, compliance, taut, tension, pull, here)

    return balance


def _length_derivatives(n: int, a: np.ndarray, b: np.ndarray, unit: np.ndarray) -> csc_array:
    """Derivatives of the lengths of segments from nodes a to b along unit vectors in the positions of n moving nodes."""
    row, axis = np.arange(len(a))[:, None], np.arange(3)
    rows = np.broadcast_to(np.concatenate([row, row]), (2 * len(a), 3)).ravel()
    columns = (3 * np.concatenate([a, b])[:, None] + axis).ravel()
    moving = columns < 3 * n
    values = np.concatenate([-unit, unit]).ravel()
    return csc_array((values[moving], (rows[moving], columns[moving])), shape=(len(a), 3 * n))
