"""The tangent of the forces with bodies: the nodes of each move as one piece, in six directions.

With the displacements B y of the nodes for the shifts and turns y, the tangent of the nodes becomes B^T K B. A force f at an arm b
turns no further with the body, which adds -[f][b] to the moments, where [x] is the matrix of the cross product. Its symmetric part
counts: the other is zero at a rest.

A body that is pinned to another one shifts with that body's point at the joint, and only its turn is an unknown of its own. What
pulls at it pulls at that point too.
"""

import numpy as np
from scipy.sparse import block_diag, csc_array, eye_array, hstack, vstack

from anet_lumped.model.tables import JOINT_BODY, JOINT_OTHER, JOINT_OTHER_NODE, JOINT_POSITION

from .forces_at_rest import node_forces


def _cross(x):
    """Matrix of the cross product."""
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def of_bodies(model, net, q, tension, K):
    """Tangent over the moving points and the bodies; K itself where no body moves.

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
    if not model.has_bodies:
        return K, eye_array(3 * model.n_free, format="csc")
    forces, bodies = node_forces(model, net, q, tension), model.bodies
    below = 3 * bodies.first
    joints = {row[JOINT_BODY]: row for row in bodies.joint}
    nodes_of = [bodies.node[bodies.node_at[b] : bodies.node_at[b + 1]] for b in range(len(bodies.pivot))]
    for row in bodies.joint[::-1]:
        forces[row[JOINT_OTHER_NODE]] += forces[nodes_of[row[JOINT_BODY]]].sum(axis=0)
    turns_alone = [b in joints or pivot >= 0 for b, pivot in enumerate(bodies.pivot)]
    at = np.cumsum([0, *(3 if alone else 6 for alone in turns_alone)])
    moves, turning = np.zeros((3 * model.n_free - below, at[-1])), []
    for b, nodes in enumerate(nodes_of):
        mass, joint = model.mass[nodes], joints.get(b)
        pivot = bodies.pivot[b] if joint is None else bodies.node[joint[JOINT_POSITION]]
        reference = q[pivot] if turns_alone[b] else mass @ q[nodes] / mass.sum()
        arms = q[nodes] - reference
        radius = np.sqrt(mass @ (arms * arms).sum(axis=1) / mass.sum())
        stiffness = np.zeros((3, 3))
        for node, arm in zip(nodes, arms, strict=True):
            rows = slice(3 * node - below, 3 * node - below + 3)
            if joint is not None and joint[JOINT_OTHER] >= 0:
                other = 3 * joint[JOINT_OTHER_NODE] - below
                moves[rows] = moves[other : other + 3]
            moves[rows, at[b + 1] - 3 : at[b + 1]] = -_cross(arm) / radius
            if not turns_alone[b]:
                moves[rows, at[b] : at[b] + 3] = np.eye(3)
            stiffness -= _cross(forces[node]) @ _cross(arm) / radius**2
        full = np.zeros((at[b + 1] - at[b],) * 2)
        full[-3:, -3:] = 0.5 * (stiffness + stiffness.T)
        turning.append(full)
    size = 3 * model.n_free - below
    of_points = vstack([eye_array(below), csc_array((size, below))]) if below else csc_array((3 * model.n_free, 0))
    of_turns = vstack([csc_array((below, at[-1])), csc_array(moves)])
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
