"""A model in JAX: forces, and the linear system of an implicit stage solved by the structure of the net.

The axial law and the effects are the lines that Numba compiles: the law with ``jax.numpy.where`` for its `select`, an effect's
kernel on arrays of Python objects, of which each holds one coordinate of all nodes. Blocks of the tangent are directional
derivatives of these forces, taken by JAX.

Cables are laid out side by side, the shorter ones filled up with nodes that are at rest and joined to nothing. In a cable each
segment ties its two nodes alone, so its interior is a block tridiagonal chain. It is eliminated with `jax_chain`, and leaves to
the free points at its ends

    [S_ss  S_se]   [G_first (I + X_s(first))   G_first X_e(first)     ]
    [S_es  S_ee] = [G_last X_s(last)           G_last (I + X_e(last)) ] ,

where G = tau^2 dP/dd + tau dP/du is the tangent of a segment's pull P and A X_s = -G_first at the first node, A X_e = -G_last at
the last, are the chain's answers to its ends. The system over the free points is dense. Cost: linear in the longest cable.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.linalg import lu_factor, lu_solve

from anet_lumped.checks import InputError
from anet_lumped.effects.laws.axial import tension_parts, with_select
from anet_lumped.model.tables import AXIAL_DAMPER, AXIAL_TWO_WAY_DAMPER, CABLE_END, CABLE_SEGMENTS, CABLE_START
from anet_lumped.scene.scene import Driven, Fixed

from .chain import factorised, solved, times
from .paths import Paths

_parts = with_select(tension_parts, jnp.where)


class JaxNet(eqx.Module):
    """A model as `integrators.diffrax_adapter.Motion`; make one with `jax_net`.

    C cables of S segments at most; P points, of which the first F are free. Numbers of nodes are those of the model.
    """

    mass: jax.Array  # (n_free,) [kg]
    node: jax.Array  # (C, S + 1) nodes of each cable, its end repeated after it
    real: jax.Array  # (C, S) whether there is such a segment
    count: jax.Array  # (C,) segments
    law: jax.Array  # (C, 5): L0 [m], k [N/m], c [N s/m], two-way spring, two-way damper
    springs: jax.Array  # (rows, 2, C), see `Model.springs_of_cables`
    start: jax.Array  # (C,) point at the start, and
    end: jax.Array  # (C,) at the end of each cable
    inner: jax.Array  # (n_interior,) where an interior node is among the C (S - 1) places of interior nodes
    fixed: jax.Array  # (fixed points, 3) [m]
    paths: Paths
    effects: tuple = eqx.field(static=True)

    @property
    def _free(self):
        return len(self.mass) - len(self.inner)

    def _all(self, t, stop, q, v):
        """Places and velocities of all nodes."""
        moved, moving = self.paths.at(t, stop)
        return jnp.concatenate([q, self.fixed, moved]), jnp.concatenate([v, jnp.zeros_like(self.fixed), moving])

    def _pull(self, d, u):
        """Pull (C, S, 3) [N] of each segment on the node before it, and the power (C, S) [W] that its damper takes.

        d, u (C, S, 3) are the differences of place and velocity between its nodes.
        """
        L0, k, c, two_spring, two_damper = self.law.T[:, :, None]
        l = jnp.sqrt(jnp.maximum(jnp.sum(d * d, axis=-1), (1e-12 * L0) ** 2))
        n = d / l[..., None]
        rate = jnp.sum(n * u, axis=-1)
        T, elastic = _parts(l - L0, rate, (k, two_spring, L0, self.springs[..., None], 0, len(self.springs)), c, two_damper)
        return jnp.where(self.real, T, 0.0)[..., None] * n, jnp.where(self.real, (T - elastic) * rate, 0.0)

    def _of_effects(self, t, q, v):
        """Force (n_free, 3) [N] of all effects, and the power [W] that they take."""
        f, power = jnp.zeros_like(q), 0.0
        for effect in self.effects:
            index, params = effect.table(_Nodes(_objects([self.mass]), 1))
            rows = np.zeros((1, 3), object)
            power += jnp.sum(effect.kernels()["force"].py_func(t, _objects(q.T)[None], _objects(v.T)[None], index, params, rows))
            f += jnp.stack([x + jnp.zeros(len(q)) for x in rows[0]], axis=-1)
        return f, power

    def _at_points(self, at_start, at_end):
        """Sums (P, 3) over the points of what cables bring them (C, 3)."""
        P = self._free + len(self.fixed) + len(self.paths.breaks)
        return jnp.zeros((P, 3)).at[self.start].add(at_start).at[self.end].add(at_end)

    def _interior(self, rows):
        """Rows (n_interior, ...) of interior nodes, in the model's order, from their places (C, S - 1, ...)."""
        return rows.reshape(-1, *rows.shape[2:])[self.inner]

    def _chains(self, rows, other):
        """Rows (n_free, ...) at the places of interior nodes, (S - 1, C, ...); ``other`` where there is no node."""
        at, there = self.node[:, 1:-1].T, self.real[:, 1:].T
        return jnp.where(there.reshape(*there.shape, *[1] * (rows.ndim - 1)), rows[jnp.where(there, at, 0)], other)

    def force(self, t, stop, q, v):
        """Force (n_free, 3) [N] on the moving nodes, and powers (3,) [W]: taken by dampers, by effects, put in by driven points."""
        whole_q, whole_v = self._all(t, stop, q, v)
        Q, V = whole_q[self.node], whole_v[self.node]
        pull, lost = self._pull(Q[:, 1:] - Q[:, :-1], V[:, 1:] - V[:, :-1])
        last = pull[jnp.arange(len(pull)), self.count - 1]
        points = self._at_points(pull[:, 0], -last)
        external, drained = self._of_effects(t, q, v)
        f = jnp.concatenate([self._interior(pull[:, 1:] - pull[:, :-1]), points[: self._free]]) + external
        driven = len(points) - len(self.paths.breaks)
        put_in = -jnp.sum(points[driven:] * whole_v[len(self.inner) + driven :])
        return f, jnp.stack([jnp.sum(lost), drained + 0.0, put_in])

    def factor(self, t, stop, q, v, tau):
        """Factors of M - tau df/dv - tau^2 df/dq for `solve`."""
        whole_q, whole_v = self._all(t, stop, q, v)
        Q, V = whole_q[self.node], whole_v[self.node]
        d, u = Q[:, 1:] - Q[:, :-1], V[:, 1:] - V[:, :-1]

        def along(axis, force, at):
            """Change of a force when all places move by tau^2 along an axis, and all velocities change by tau."""
            e = jnp.broadcast_to(axis, at[0].shape)
            return jax.jvp(force, at, (tau * tau * e, tau * e))[1]

        axes = jnp.eye(3)
        G = jnp.stack([along(axis, lambda d, u: self._pull(d, u)[0], (d, u)) for axis in axes], axis=-1)
        D = self.mass[:, None, None] * axes
        if self.effects:
            D -= jnp.stack([along(axis, lambda q, v: self._of_effects(t, q, v)[0], (q, v)) for axis in axes], axis=-1)
        first, last = G[:, 0], G[jnp.arange(len(G)), self.count - 1]
        at, alone = jnp.arange(G.shape[1] - 1)[:, None, None, None], (self.count == 1)[:, None, None]
        there, at_last = self.real[:, 1:].T[..., None, None], at == (self.count - 2)[:, None, None]
        behind, ahead = jnp.moveaxis(G[:, :-1], 1, 0), jnp.moveaxis(G[:, 1:], 1, 0)
        chain = factorised(
            jnp.where(there, -behind, 0.0),
            self._chains(D, axes) + jnp.where(there, behind + ahead, 0.0),
            jnp.where(there & ~at_last, -ahead, 0.0),
        )
        to_ends = jnp.where((at == 0) & ~alone, -first, 0.0), jnp.where(at_last, -last, 0.0)
        X = solved(chain, jnp.concatenate(to_ends, axis=-1))
        near, far, across = X[0], X[self.count - 2, jnp.arange(len(G))], jnp.where(alone, -first, 0.0)
        blocks = (
            (first + times(first, near[..., :3]), across + times(first, near[..., 3:])),
            (across + times(last, far[..., :3]), last + times(last, far[..., 3:])),
        )
        return chain, X, first, last, self._points(D[len(self.inner) :], blocks)

    def _points(self, own, blocks):
        """LU factors of the dense system over the free points: blocks of their own (F, 3, 3), and the cables' to the ends."""
        F, ends = self._free, (self.start, self.end)
        if F == 0:
            return None
        whole = jnp.zeros((F, F, 3, 3)).at[jnp.arange(F), jnp.arange(F)].add(own)
        for a, row in zip(ends, blocks, strict=True):
            for b, block in zip(ends, row, strict=True):
                whole = whole.at[a, b].add(block, mode="drop")  # of prescribed points, whose numbers are F and above
        return lu_factor(whole.transpose(0, 2, 1, 3).reshape(3 * F, 3 * F))

    def solve(self, factor, r):
        """Solution (n_free, 3) of the system that `factor` was given, for the right-hand side r (n_free, 3)."""
        chain, X, first, last, points = factor
        F, of_points = self._free, jnp.zeros((0, 3))
        x = solved(chain, self._chains(r, 0.0)[..., None])
        if F:
            near, far = times(first, x[0]), times(last, x[self.count - 2, jnp.arange(len(first))])
            b = r[len(self.inner) :] + self._at_points(near[..., 0], far[..., 0])[:F]
            of_points = lu_solve(points, b.ravel()).reshape(F, 3)
        moved = jnp.concatenate([of_points, jnp.zeros((1, 3))])  # prescribed points do not
        ends = jnp.concatenate([moved[jnp.minimum(p, F)] for p in (self.start, self.end)], axis=-1)
        x = x - times(X, ends[None, ..., None])
        return jnp.concatenate([self._interior(jnp.moveaxis(x[..., 0], 0, 1)), of_points])


class _Nodes(NamedTuple):
    """What an effect that JAX can trace reads of a model."""

    mass: np.ndarray
    n_free: int


def _objects(rows):
    """(k,) array of Python objects, each one of the rows."""
    out = np.empty(len(rows), object)
    for i, row in enumerate(rows):
        out[i] = row
    return out


def jax_net(model):
    """A model as arrays for JAX.

    Returns
    -------
    JaxNet

    Raises
    ------
    InputError : an effect that JAX cannot trace
    """
    for effect in model.scene.effects:
        if not effect.jax_traceable:
            raise InputError(
                "Methods of diffrax need effects that JAX can trace, such as Gravity and ViscousDamping, but "
                f"{type(effect).__name__} is none (`Effect.jax_traceable`); take a method of this package or of scipy."
            )
    count, C = model.cable[:, CABLE_SEGMENTS], len(model.cable)
    S, offset = max(2, int(count.max())), model.n_interior  # with one place at least for an interior node
    node, inner = np.empty((C, S + 1), int), np.empty(model.n_interior, int)
    for c, (_, n, first, start, end) in enumerate(model.cable[:, : CABLE_END + 1]):
        node[c] = end
        node[c, :n] = np.r_[start, first : first + n - 1]
        inner[first : first + n - 1] = c * (S - 1) + np.arange(n - 1)
    points = model.scene.points
    k, pushes, L0, rows, *_ = model.springs_of_cables
    return JaxNet(
        mass=jnp.asarray(model.mass[: model.n_free]),
        node=jnp.asarray(node),
        real=jnp.asarray(np.arange(S) < count[:, None]),
        count=jnp.asarray(count),
        law=jnp.asarray(np.column_stack([L0, k, model.axial[:, AXIAL_DAMPER], pushes, model.axial[:, AXIAL_TWO_WAY_DAMPER]])),
        springs=jnp.asarray(rows),
        start=jnp.asarray(model.cable[:, CABLE_START] - offset),
        end=jnp.asarray(model.cable[:, CABLE_END] - offset),
        inner=jnp.asarray(inner),
        fixed=jnp.asarray(np.array([point.at for point in points if isinstance(point, Fixed)], float).reshape(-1, 3)),
        paths=Paths.of([point.path for point in points if isinstance(point, Driven)]),
        effects=tuple(model.scene.effects),
    )
