"""The tangent of the forces with bodies: the nodes of each move as one piece, in six directions.

With the displacements B y of the nodes for the shifts and turns y, the tangent of the nodes becomes B^T K B. A force f at an arm b
turns no further with the body, which adds -[f][b] to the moments, where [x] is the matrix of the cross product. Its symmetric part
counts: the other is zero at a rest.
"""

import numpy as np
from scipy.sparse import block_diag, csc_array, eye_array, hstack, vstack


def _cross(x):
    """Matrix of the cross product."""
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def of_bodies(model, net, q, tension, K):
    """Tangent over the moving points and the bodies.

    Parameters
    ----------
    model : Model
    net : Net
    q : (n, 3) float64 [m]
    tension : (n_segments,) float64 [N]
    K : (3 n_free, 3 n_free) csc_array [N/m], over all nodes

    Returns
    -------
    K : csc_array, with turns in lengths of the radius of gyration
    motions : csc_array, displacements of all moving nodes by the unknowns of K
    """
    forces, bodies = _node_forces(model, net, q, tension), model.bodies
    below = 3 * bodies.first
    columns, turning = [], []
    for b, pivot in enumerate(bodies.pivot):
        nodes = bodies.node[bodies.node_at[b] : bodies.node_at[b + 1]]
        mass = model.mass[nodes]
        reference = q[pivot] if pivot >= 0 else mass @ q[nodes] / mass.sum()
        arms = q[nodes] - reference
        radius = np.sqrt(mass @ (arms * arms).sum(axis=1) / mass.sum())
        own = np.zeros((3 * model.n_free - below, 3 if pivot >= 0 else 6))
        stiffness = np.zeros((3, 3))
        for node, arm in zip(nodes, arms, strict=True):
            rows = slice(3 * node - below, 3 * node - below + 3)
            own[rows, -3:] = -_cross(arm) / radius
            if pivot < 0:
                own[rows, :3] = np.eye(3)
            stiffness -= _cross(forces[node]) @ _cross(arm) / radius**2
        columns.append(own)
        full = np.zeros((own.shape[1],) * 2)
        full[-3:, -3:] = 0.5 * (stiffness + stiffness.T)
        turning.append(full)
    size = 3 * model.n_free - below
    of_points = vstack([eye_array(below), csc_array((size, below))]) if below else csc_array((3 * model.n_free, 0))
    of_turns = vstack([csc_array((below, sum(own.shape[1] for own in columns))), csc_array(np.hstack(columns))])
    motions = csc_array(hstack([of_points, of_turns]))
    reduced = csc_array(motions.T @ K @ motions + block_diag([csc_array((below, below)), *turning]))
    diagonal = csc_array((np.zeros(reduced.shape[0]), (np.arange(reduced.shape[0]),) * 2), shape=reduced.shape)
    reduced = csc_array(reduced + diagonal)
    reduced = csc_array(0.5 * (reduced + reduced.T)) if abs(reduced - reduced.T).max() < 1e-9 * abs(reduced).max() else reduced
    reduced.sort_indices()
    return _with_whole_diagonal(reduced), motions


def _with_whole_diagonal(K):
    """The same matrix with a symmetric pattern whose diagonal is stored."""
    pattern = abs(K) + abs(K.T)
    pattern.data[:] = 1.0
    coo = (pattern + eye_array(K.shape[0])).tocoo()
    values = np.zeros(coo.nnz)
    both = csc_array((values, (coo.row, coo.col)), shape=K.shape)
    both.sum_duplicates()
    rows, columns = both.indices, np.repeat(np.arange(K.shape[0]), np.diff(both.indptr))
    both.data[:] = np.asarray(K.tocsr()[rows, columns]).ravel()
    return both


def _node_forces(model, net, q, tension):
    """Force on every node at rest (n, 3) [N]."""
    f, v = np.zeros_like(q), np.zeros_like(q)
    for e, effect in enumerate(model.forces):
        if not effect.no_force_at_rest:
            effect.kernels()["force"](0.0, q, v, *net.effects.numbers(e), f)
    a, b = model.ends.T
    d = q[b] - q[a]
    pull = tension[:, None] * d / np.maximum(np.linalg.norm(d, axis=1), 1e-300)[:, None]
    np.add.at(f, a, pull)
    np.add.at(f, b, -pull)
    return f
