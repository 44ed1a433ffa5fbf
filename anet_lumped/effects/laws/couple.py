"""A torque on a rigid body as forces on its nodes.

The nodes of a body lie at arms p_k in its axes. With weights c^a_k such that

    sum_k c^a_k = 0 ,      sum_k c^a_k p_k = u_a

for three unit vectors u_a of the body across each other, e_a = sum_k c^a_k x_k is the direction of u_a in the world, linear in
places. The forces

    f_k = 1/2 sum_a c^a_k tau x e_a

have no sum and the moment 1/2 sum_a e_a x (tau x e_a) = tau. No weights give u_3 where all nodes lie in the plane of u_1 and u_2.
Then e_3 is e_1 x e_2, and the forces on the other two take over:

    f_k = sum_a c^a_k g_a ,
    g_1 = tau_3/2 e_2 - s tau_2 e_3 ,   g_2 = s tau_1 e_3 - tau_3/2 e_1 ,   g_3 = (1 - s) (tau_2 e_1 - tau_1 e_2)

with the components tau_a = tau . e_a, s = 1/2 above and s = 1 for such a body. Between the places of two times the e_a are shorter
by the cosine of half the angle that the body turns; the moment is then tau to second order.
"""

import numpy as np

from anet_lumped.compiled.jit import inlined

FLAT = 1e-3  # of the largest spread of the nodes: with less across the other two directions the body counts as flat


def direction_weights(arms):
    """Weights of the nodes of a body, and the directions that they give, those in which its nodes spread most.

    Parameters
    ----------
    arms : (n, 3) array_like [m], places of the nodes in the axes of the body, not all on one line

    Returns
    -------
    weights : (3, n) float64 [1/m], zero for the third direction of a flat body
    directions : (3, 3) float64, by rows u_1, u_2 and u_3 = u_1 x u_2 in the axes of the body
    share : float, s above
    """
    arms = np.asarray(arms, float)
    left, size, right = np.linalg.svd(arms - arms.mean(axis=0), full_matrices=False)
    if np.linalg.det(right) < 0.0:
        left[:, 2], right[2] = -left[:, 2], -right[2]
    flat = size[2] < FLAT * size[0]
    weights = left[:, :2] / size[:2]
    third = np.zeros(len(arms)) if flat else left[:, 2] / size[2]
    return np.ascontiguousarray(np.column_stack([weights, third]).T), right, 1.0 if flat else 0.5


@inlined
def cross_product(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def combined(e1, e2, e3, x):
    """The vector x_1 e_1 + x_2 e_2 + x_3 e_3."""
    return (
        x[0] * e1[0] + x[1] * e2[0] + x[2] * e3[0],
        x[0] * e1[1] + x[1] * e2[1] + x[2] * e3[1],
        x[0] * e1[2] + x[1] * e2[2] + x[2] * e3[2],
    )


@inlined
def along(e, x):
    """e . x."""
    return e[0] * x[0] + e[1] * x[1] + e[2] * x[2]


@inlined
def couple(e1, e2, e3, tau, share):
    """The vectors g_1, g_2, g_3 [N m] of a torque whose components along e_1, e_2, e_3 are tau (3,) [N m]."""
    half, a, b, rest = 0.5 * tau[2], share * tau[0], share * tau[1], 1.0 - share
    g1 = half * e2[0] - b * e3[0], half * e2[1] - b * e3[1], half * e2[2] - b * e3[2]
    g2 = a * e3[0] - half * e1[0], a * e3[1] - half * e1[1], a * e3[2] - half * e1[2]
    c, d = rest * tau[1], rest * tau[0]
    g3 = c * e1[0] - d * e2[0], c * e1[1] - d * e2[1], c * e1[2] - d * e2[2]
    return g1, g2, g3
