"""Stability of a rest: along how many directions the potential energy falls, and one of these directions.

With the tensions T along the unit vectors n of segments of length l and slope k, the tangent of the forces is

    K = B^T [k n n^T + (T/l)(I - n n^T)] B - df/dq ,

with a negative T where a segment is shortened, and with df/dq of the effects' forces f. Where the effects have an energy, K is the
Hessian of the potential energy. By Sylvester's law of inertia K has as many negative eigenvalues as K = L D L^T has negative
pivots. Where forces have no energy, K is not symmetric. Then a rest is stable if the symmetric part of K has no negative pivot
(Bendixson), or else if no eigenvalue of K has a negative real part.
"""

from inspect import signature
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import ArpackError, eigs, eigsh, splu, spsolve_triangular

from anet_lumped.effects.laws.axial import tension_slopes, with_select
from anet_lumped.model.model import Model
from anet_lumped.model.tables import AXIAL_INEXTENSIBLE, AXIAL_L0, AXIAL_STIFFNESS

from .body_tangent import of_bodies

EPS = 2.220446049250313e-16
FLAT = 1e-7  # of load over length: a smaller stiffness counts as zero, as that of a cable that turns about its ends
PRESTRESSED = 1e-11  # of the largest T/l: stiffness that rounding leaves of tensions that balance
RIGID = 1e9  # of the largest other stiffness: slope of a segment that does not stretch
ROUNDED = 20  # shifts of the diagonal that are tried where a pivot is zero
DENSE = 200  # coordinates, up to which all eigenvalues of K are computed
SEEDED = {"rng": 0} if "rng" in signature(eigs).parameters else {}  # else SciPy 1.17 goes on at random where a shape is symmetric
SYMMETRIC = 1e-9  # of the largest stiffness: a smaller difference of K and K^T is rounding

_slopes = with_select(tension_slopes, np.where)


class Curvature(NamedTuple):
    """The tangent K at a rest, as far as its stability goes.

    Parameters
    ----------
    directions_down : int
        Number of negative eigenvalues: along so many directions the forces lead away from the rest.
    direction : (n_free, 3) float64 or None
        One of these directions, scaled so that the largest displacement of a node is 1.
    stiffness : float [N/m]
        Negative stiffness along it; 0 for a stable rest.
    """

    directions_down: int
    direction: np.ndarray | None = None
    stiffness: float = 0.0


def curvature(model: Model, net: Any, q: np.ndarray, tension: np.ndarray, load: float) -> Curvature:
    """`Curvature` of the potential energy at a rest.

    Parameters
    ----------
    model : Model
    net : Net
        Rest lengths and the numbers of effects at t = 0.
    q : (n, 3) float64 [m]
    tension : (n_segments,) float64 [N]
    load : float [N]
        Load that tolerances are relative to.

    Returns
    -------
    Curvature
    """
    if model.n_free == 0:
        return Curvature(0)
    effects = of_effects(model, net, q)
    if not model.has_bodies and _plainly_stable(model, tension, effects):
        return Curvature(0)
    K, motions = of_bodies(model, net, q, tension, tangent(model, net, q, tension, effects))
    largest = float(np.abs(K.data).max(initial=0.0))
    length = model.scene.longest
    across = float(
        np.abs(tension / np.linalg.norm(q[model.ends[:, 1]] - q[model.ends[:, 0]], axis=1).clip(1e-12 * length)).max(initial=0.0)
    )
    flat = FLAT * load / (length * model.n_free) + 64.0 * EPS * largest + PRESTRESSED * across
    symmetric = symmetric_part(K)
    pivots, factors = pivots_of(symmetric, flat)
    down = int((pivots < 0.0).sum())
    if down == 0:
        return Curvature(0)
    slope, direction = _steepest(symmetric, pivots, factors)
    if abs(K - K.T).max() > SYMMETRIC * largest:
        down, direction = _unsymmetric(K, slope, direction)
        if down == 0:
            return Curvature(0)
    direction = (motions @ direction).reshape(-1, 3)
    return Curvature(down, direction / np.linalg.norm(direction, axis=1).max(), min(slope, -flat))


class Segments(NamedTuple):
    """Segments in a shape: length l [m], unit vector (., 3), tension by the law [N] and its slope in l [N/m]."""

    length: np.ndarray
    unit: np.ndarray
    tension: np.ndarray
    slope: np.ndarray


def segments(model: Model, net: Any, q: np.ndarray) -> Segments:
    """`Segments` of a model in a shape q (n, 3) [m], at rest; in a cable that does not stretch, tension and slope are 0."""
    (a, b), axial = model.ends.T, net.axial[model.cable_of]
    d = q[b] - q[a]
    l = np.maximum(np.linalg.norm(d, axis=1), 1e-12 * axial[:, AXIAL_L0])
    share = model.shares_of_first_springs[model.cable_of]
    _, pushes, _, springs, first, last = model.springs_of_cables
    spring = (
        share * axial[:, AXIAL_STIFFNESS],
        pushes[model.cable_of],
        axial[:, AXIAL_L0],
        springs[..., model.cable_of],
        first,
        last,
    )
    tension, slope, _ = _slopes(l - axial[:, AXIAL_L0], 0.0, spring, 0.0, 1.0)
    return Segments(l, d / l[:, None], tension, slope)


def tangent(
    model: Model, net: Any, q: np.ndarray, tension: np.ndarray, effects: Any = None, slope: np.ndarray | None = None
) -> csc_array:
    """Sparse K of the module for the moving nodes, (3 n_free, 3 n_free) [N/m].

    ``effects`` are what `of_effects` gives, and ``slope`` (n_segments,) [N/m] is taken in place of that of the law.
    """
    n, (a, b) = model.n_free, model.ends.T
    rows, columns, blocks = of_effects(model, net, q) if effects is None else effects
    l, unit, _, slope_by_law = segments(model, net, q)
    across, rigid = tension / l, net.axial[model.cable_of, AXIAL_INEXTENSIBLE] > 0.0
    if slope is None:
        slope = slope_by_law
        if rigid.any():
            others = max(np.abs(across).max(), np.abs(slope).max(), np.abs(blocks).max(initial=0.0))
            slope = np.where(rigid, np.where(tension != 0.0, RIGID * others, 0.0), slope)
    G = (slope - across)[:, None, None] * unit[:, :, None] * unit[:, None, :] + across[:, None, None] * np.eye(3)
    rows, columns = np.concatenate([rows, a, b, a, b]), np.concatenate([columns, a, b, b, a])
    blocks = np.concatenate([blocks, G, G, -G, -G])
    moving = (rows < n) & (columns < n)
    i, j, axis = 3 * rows[moving][:, None, None], 3 * columns[moving][:, None, None], np.arange(3)
    at = (np.broadcast_to(i + axis[:, None], (len(i), 3, 3)).ravel(), np.broadcast_to(j + axis, (len(j), 3, 3)).ravel())
    K = csc_array((blocks[moving].ravel(), at), shape=(3 * n, 3 * n))
    K.sum_duplicates()  # and sorted: the pattern is symmetric, so that K^T has the same
    return K


def symmetric_part(K: csc_array) -> csc_array:
    """(K + K^T)/2, which is K itself where that is symmetric."""
    other = K.T.tocsc()
    other.sort_indices()
    return csc_array((0.5 * (K.data + other.data), K.indices, K.indptr), shape=K.shape)


def _plainly_stable(model, tension, effects):
    """Whether K is plainly positive: no segment is shortened, and effects add a positive block to each node alone."""
    rows, columns, blocks = effects
    if (tension < 0.0).any() or np.any(blocks[rows != columns]):
        return False
    own = blocks[rows == columns]
    if np.any(own != own.transpose(0, 2, 1)):
        return False
    return not np.any(own) or bool(np.linalg.eigvalsh(own).min() >= 0.0)


def of_effects(model: Model, net: Any, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and blocks (., 3, 3) [N/m] that the effects' forces add to K."""
    n, segments, reach = model.n_free, model.n_segments, model.coupled_neighbours
    own, v = np.zeros((n, 3, 3)), np.zeros_like(q)
    near, far = np.zeros((model.near_rows if reach > 0 else 0, 2, 3, 3)), np.zeros((segments if reach > 1 else 0, 2, 3, 3))
    for e, effect in enumerate(model.forces):
        kernels = effect.kernels()
        if "tangent" in kernels and not effect.no_force_at_rest:
            kernels["tangent"](0.0, q, v, *net.effects.numbers(e), 1.0, 0.0, own, near, far)
    i, (a, b) = np.arange(n), model.ends.T
    rows, columns, blocks = [i], [i], [own]
    if reach > 0:
        pairs = model.bodies.node[model.bodies.pairs[:, 1:]]
        first, second = np.concatenate([a, pairs[:, 0]]), np.concatenate([b, pairs[:, 1]])
        rows, columns, blocks = [*rows, first, second], [*columns, second, first], [*blocks, near[:, 0], near[:, 1]]
    if reach > 1:
        two = np.flatnonzero(model.cable_of[:-1] == model.cable_of[1:])
        rows, columns = [*rows, a[two], b[two + 1]], [*columns, b[two + 1], a[two]]
        blocks += [far[two, 0], far[two, 1]]
    return np.concatenate(rows), np.concatenate(columns), np.concatenate(blocks)


def pivots_of(K: csc_array, shift: float) -> tuple[np.ndarray, Any]:
    """Pivots of K + shift I, and its factors; K is symmetric, and its diagonal is stored."""
    options, factors, data = {"SymmetricMode": True, "Equil": False}, None, K.data.copy()
    shifted = csc_array((data, K.indices, K.indptr), shape=K.shape)
    diagonal = np.flatnonzero(K.indices == np.repeat(np.arange(K.shape[0]), np.diff(K.indptr)))
    for _ in range(ROUNDED):
        try:
            data[diagonal] = K.data[diagonal] + shift
            factors = splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
            if (factors.perm_r == factors.perm_c).all():
                break
            shift *= 1.1  # a pivot was zero to rounding, and another row was taken
        except RuntimeError:  # a pivot is zero
            shift *= 10.0
    if factors is None:
        raise RuntimeError(
            f"A tangent must have finite numbers to be judged, but a pivot is zero at every shift up to {shift:g} N/m."
        )
    return factors.U.diagonal(), factors


def _direction(pivots, factors):
    """A direction y with y^T K y = d < 0, for the most negative pivot d: L^T y is the unit vector of d's row."""
    worst = int(np.argmin(pivots))
    one = np.zeros(len(pivots))
    one[worst] = 1.0
    y = spsolve_triangular(factors.L.T.tocsr(), one, lower=False, unit_diagonal=True)
    y = y[factors.perm_c]
    return y / np.linalg.norm(y)


def _steepest(K, pivots, factors):
    """The lowest eigenvalue of K and its eigenvector, of a large K from its pivots and factors.

    Once K + shift I has no negative pivot, no eigenvalue of K is below -shift, and the one next to -shift is the lowest.
    """
    if K.shape[0] <= DENSE:
        values, vectors = np.linalg.eigh(K.toarray())
        return float(values[0]), vectors[:, 0]
    y = _direction(pivots, factors)
    slope = float(y @ (K @ y))
    shift = 2.0 * abs(slope)
    while (pivots_of(K, shift)[0] < 0.0).any():
        shift *= 4.0
    try:
        values, vectors = eigsh(K, k=1, sigma=-shift, v0=y, tol=1e-3, **SEEDED)
    except (ArpackError, RuntimeError):
        return slope, y
    return float(values[0]), vectors[:, 0]


def _unsymmetric(K, slope, direction):
    """Eigenvalues of an unsymmetric K with a negative real part among those next to ``slope``, and a direction of one."""
    size = K.shape[0]
    if size <= DENSE:
        values, vectors = np.linalg.eig(K.toarray())
    else:
        try:
            values, vectors = eigs(K, k=6, sigma=slope, v0=direction, **SEEDED)
        except (ArpackError, RuntimeError):
            return 1, direction
    negative = np.flatnonzero(values.real < -1e-9 * abs(slope))
    if len(negative) == 0:
        return 0, direction
    y = vectors[:, negative[np.argmin(values[negative].real)]].real
    return len(negative), y / np.linalg.norm(y)
