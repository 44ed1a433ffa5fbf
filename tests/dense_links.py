"""Slow twin of cables that do not stretch: accelerations and tensions of their links from one dense system.

The unknowns are the accelerations a of the moving nodes and the tensions T of the links, with the directions e = d/L:

    M a + B^T T = f ,      B a = (L L'' + L'^2 - |v_b - v_a|^2)/L - (what prescribed nodes put into it) .

It is written node by node, from the scene and not from its tables. Where lengths follow from other lengths the system is singular.
Then T is the limit of a positive shift that goes to zero: the tensions of which the sum of S_ll (T/L)^2 is smallest.
"""

from typing import NamedTuple

import naive
import numpy as np

from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.scene.scene import Driven


class Lengths(NamedTuple):
    """Length of every link [m], its rate [m/s] and the rate of that [m/s2], each (n_segments,)."""

    L: np.ndarray
    rate: np.ndarray
    change: np.ndarray


def constant_lengths(model):
    """`Lengths` of a scene whose cables keep theirs."""
    L = np.array([cable.L0 for cable, _, _ in naive.segments(model)])
    return Lengths(L, np.zeros_like(L), np.zeros_like(L))


def constraints(model, q):
    """(n_segments, 3 n) matrix B: B v is the rate at which each link lengthens."""
    B = np.zeros((model.n_segments, model.n, 3))
    for s, (_, a, b) in enumerate(naive.segments(model)):
        e = (q[b] - q[a]) / np.linalg.norm(q[b] - q[a])
        B[s, a], B[s, b] = -e, e
    return B.reshape(model.n_segments, -1)


def wanted(model, q, v, lengths):
    """(n_segments,) what B a must be [m/s2]."""
    out = np.empty(model.n_segments)
    for s, (_, a, b) in enumerate(naive.segments(model)):
        rate = v[b] - v[a]
        out[s] = (lengths.L[s] * lengths.change[s] + lengths.rate[s] ** 2 - rate @ rate) / np.linalg.norm(q[b] - q[a])
    return out


def mass_matrix(m, added=None):
    """(3 n_free, 3 n_free) of masses (n_free,) [kg] and what nodes carry along of a fluid, (n_free, 3, 3) [kg]."""
    M = np.zeros((len(m), 3, len(m), 3))
    for i, mass in enumerate(m):
        M[i, :, i] = mass * np.eye(3) + (0.0 if added is None else added[i])
    return M.reshape(3 * len(m), -1)


def solve(model, q, v, f, M, lengths, driven_acceleration=None):
    """Accelerations (n_free, 3) [m/s2] and tensions (n_segments,) [N].

    Parameters
    ----------
    model : Model
    q, v, f : (n, 3) [m], [m/s], [N]
    M : (3 n_free, 3 n_free), see `mass_matrix`
    lengths : Lengths
    driven_acceleration : (n, 3) [m/s2] or None, whose rows of prescribed nodes count
    """
    n = 3 * model.n_free
    B, r = constraints(model, q), wanted(model, q, v, lengths)
    if driven_acceleration is not None:
        r = r - B[:, n:] @ driven_acceleration.ravel()[n:]
    B = B[:, :n]
    moves = np.flatnonzero(np.abs(B).sum(axis=1) > 0.0)  # links between prescribed points carry nothing
    B, r = B[moves], r[moves]
    K = np.block([[M, B.T], [B, np.zeros((len(B), len(B)))]])
    right = np.concatenate([f.ravel()[:n], r])
    x = np.linalg.solve(K, right)
    x += np.linalg.solve(K, (right - K.astype(np.longdouble) @ x).astype(float))
    T = np.zeros(model.n_segments)
    T[moves] = x[n:]
    return x[:n].reshape(-1, 3), T


def smallest_tensions(model, q, v, f, M, lengths):
    """Tensions (n_segments,) [N] where constraints are redundant: of those that keep lengths, the smallest by S_ll (T/L)^2.

    S = B M^-1 B^T L^2 has the diagonal entries S_ll for tau = T/L. Substituting tau = y/sqrt(S_ll) makes that the least norm of y.
    """
    n = 3 * model.n_free
    B = constraints(model, q)
    r, B = wanted(model, q, v, lengths), B[:, :n]
    S = lengths.L[:, None] * (B @ np.linalg.solve(M, B.T)) * lengths.L
    weight = np.where(np.diag(S) > 0.0, np.sqrt(np.maximum(np.diag(S), 1e-300)), np.inf)
    right = lengths.L * (B @ np.linalg.solve(M, f.ravel()[:n]) - r)
    y = np.linalg.lstsq(S / np.outer(weight, weight), right / weight, rcond=1e-9)[0]
    return y / weight * lengths.L


def straight_lengths(model, rng, at=None):
    """(n, 3) places with every link at its length: a start from random directions, cable by cable, then Newton's least changes.

    Prescribed nodes stay where ``at`` (n, 3) has them.
    """
    q = rng.normal(size=(model.n, 3)) if at is None else at.copy()
    free = 3 * model.n_free
    L = constant_lengths(model).L
    for _ in range(500):
        d = np.array([q[b] - q[a] for _, a, b in naive.segments(model)])
        lack = L - np.linalg.norm(d, axis=1)
        if np.abs(lack).max() < 1e-15 * L.max():
            break
        step = np.linalg.lstsq(constraints(model, q)[:, :free], lack, rcond=1e-10)[0]
        step *= min(1.0, 0.3 * L.max() / max(np.abs(step).max(), 1e-300))
        q[: model.n_free] += step.reshape(-1, 3)
    assert np.abs(lack).max() < 1e-13 * L.max()
    return q


def keeping_lengths(model, q, v):
    """Velocities (n, 3) [m/s] of which the part that would change lengths is taken from the moving nodes."""
    B, n = constraints(model, q), 3 * model.n_free
    moved = v.ravel().copy()
    moved[:n] -= np.linalg.lstsq(B[:, :n], B @ moved, rcond=1e-12)[0]
    return moved.reshape(-1, 3)


class Compiled(NamedTuple):
    """What the compiled code says of a state: accelerations (n_free, 3), tensions (n_segments,), powers (3,), and force (n, 3)."""

    a: np.ndarray
    T: np.ndarray
    power: np.ndarray
    f: np.ndarray


def compiled(scene, t, q, v):
    """`Compiled` of a state at a time; what is prescribed is at the places and velocities of that time in it."""
    model = build(scene)
    net, own = fresh_net(model, newton=False, links=True), system(model, newton=False, links=True)
    q, v, f, power, T = q.copy(), v.copy(), np.full((model.n, 3), np.nan), np.full(3, np.nan), np.full(model.n_segments, np.nan)
    own.prescribe(t, net.address, q, v)
    own.force(t, q, v, net.address, f, power)
    own.observe(t, q, v, net.address, T, np.empty(0))
    in_order = np.concatenate([T[model.segments(cable.name)] for cable in scene.cables])
    return Compiled(own.per_mass[: model.n_free] * f[: model.n_free], in_order, power, f)


def prescribed(model, t):
    """(3, n, 3): places, velocities and accelerations of fixed and driven points at a time; free nodes are zero."""
    out = np.zeros((3, model.n, 3))
    for point in model.scene.all_points:
        if isinstance(point, Driven):
            out[:, model.node(point.name)] = point.path.at(t)
        elif hasattr(point, "at") and model.node(point.name) >= model.n_free:
            out[0, model.node(point.name)] = point.at
    return out
