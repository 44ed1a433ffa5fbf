"""Slow twins of the compiled kernels, written from the equations, node by node, from the scene and not from its tables."""

import itertools
from fractions import Fraction

import numpy as np

from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.model.tables import SEGMENT_DIRECTION, SEGMENT_GEOMETRIC, SEGMENT_GRADIENT, SEGMENT_STIFFNESS, SEGMENT_TENSION
from anet_lumped.scene.scene import Free
from integrators.stage import LAW_BACKWARD, LAW_BETWEEN


def masses(model):
    """(n,) half of the segments on either side of a node, and what a free point carries [kg]."""
    m = np.zeros(model.n)
    for cable in model.scene.cables:
        nodes = model.nodes(cable.name)
        for a, b in itertools.pairwise(nodes):
            m[a] += cable.mass_per_length * cable.L0 / 2
            m[b] += cable.mass_per_length * cable.L0 / 2
    for point in model.scene.all_points:
        if isinstance(point, Free):
            m[model.node(point.name)] += point.mass
    return m


def tension(cable, l, rate):
    """Tension of a segment of length l [m] that lengthens at a rate [m/s], by the words of the compression laws."""
    spring, damper = cable.EA * (l - cable.L0) / cable.L0, cable.axial_viscosity * rate / cable.L0
    if cable.compression == "linear":
        return spring + damper
    if cable.compression == "damped":
        return max(spring, 0.0) + damper
    return max(spring + damper, 0.0) if l > cable.L0 else 0.0


def stored(cable, l):
    """Spring energy of a segment [J], exact if l is a Fraction."""
    x = l - type(l)(cable.L0)
    if cable.compression != "linear":
        x = max(x, type(l)(0))
    return type(l)(cable.stiffness) * x * x / 2


def top_frequency(model, a, b, cable):
    """Frequency of a segment between the masses of its two nodes [1/s]; what is prescribed does not move."""
    m = masses(model)
    return np.sqrt(cable.stiffness * sum(1 / m[i] for i in (a, b) if i < model.n_free))


def tension_between(cable, l_a, l_b, h, alpha):
    """Tension of the energy-decaying step from l_a to l_b, in exact arithmetic but for its last rounding."""
    A, B, L0 = Fraction(l_a), Fraction(l_b), Fraction(cable.L0)
    k = Fraction(cable.stiffness)
    if A == B:
        secant = k * (A - L0) if cable.compression == "linear" or A > L0 else Fraction(0)
    else:
        secant = (stored(cable, B) - stored(cable, A)) / (B - A)
    damper, numerical, taut = Fraction(cable.dashpot) / Fraction(h), Fraction(alpha) * k, max(B, L0) - max(A, L0)
    if cable.compression == "none":
        return float(max(secant + (damper + numerical) * taut, 0)), float(secant)
    stretched = B - A if cable.compression == "linear" else taut  # the numerical damper acts where the spring does
    return float(secant + damper * (B - A) + numerical * stretched), float(secant)


def external(model, q, v):
    """(n, 3) forces of the effects [N]; none acts on a prescribed node."""
    f, m = np.zeros((model.n, 3)), masses(model)
    for effect in model.scene.effects:
        for i in range(model.n_free):
            if isinstance(effect, Gravity):
                f[i] += m[i] * effect.g * np.array(effect.direction) / np.linalg.norm(effect.direction)
            if isinstance(effect, ViscousDamping):
                f[i] -= effect.rate * m[i] * v[i]
    return f


def segments(model):
    """Every segment as (cable, node, next node), from each cable's start to its end."""
    for cable in model.scene.cables:
        nodes = model.nodes(cable.name)
        for a, b in itertools.pairwise(nodes):
            yield cable, a, b


def tensions(model, q, v):
    """Tension of every segment at one time, in the order of `segments` [N]."""
    T = []
    for cable, a, b in segments(model):
        d = q[b] - q[a]
        l = np.linalg.norm(d)
        T.append(tension(cable, l, d @ (v[b] - v[a]) / l))
    return np.array(T)


def force(model, q, v):
    """(n, 3) force on every node at one time [N]; powers [W] that dampers and effects take, and that prescribed nodes put in."""
    f, by_dampers, by_effects = external(model, q, v), 0.0, 0.0
    for effect in model.scene.effects:
        if isinstance(effect, ViscousDamping):
            by_effects += effect.rate * sum(m * u @ u for m, u in zip(masses(model), v[: model.n_free], strict=False))
    for (cable, a, b), T in zip(segments(model), tensions(model, q, v), strict=True):
        d = q[b] - q[a]
        l = np.linalg.norm(d)
        f[a] += T * d / l
        f[b] -= T * d / l
        by_dampers += (T - tension(cable, l, 0.0)) * (d @ (v[b] - v[a])) / l
    return f, by_dampers, by_effects, -np.sum(f[model.n_free :] * v[model.n_free :])


def energies(model, q, v):
    """Kinetic energy of the moving nodes, spring energy, and that of their weight [J]."""
    m = masses(model)[: model.n_free]
    kinetic = sum(0.5 * m[i] * v[i] @ v[i] for i in range(model.n_free))
    elastic = sum(stored(cable, np.linalg.norm(q[b] - q[a])) for cable, a, b in segments(model))
    return kinetic, elastic, -sum(m[i] * model.scene.gravity @ q[i] for i in range(model.n_free))


def residual(model, stage, base, target, q):
    """(n_free, 3) out-of-balance force of a stage [N]; see `integrators.stage` for the equation and the three laws."""
    m = masses(model)[:, None]
    r = m * stage.W * (target - q) + external(model, base + stage.theta * (q - base), (q - base) / stage.tau)
    for cable, a, b in segments(model):
        d, before, L0 = q[b] - q[a], base[b] - base[a], cable.L0
        l, l_a = np.linalg.norm(d), np.linalg.norm(before)
        e = d / l
        if stage.law == LAW_BETWEEN:
            e = (before + d) / (l_a + l)
            omega = max(top_frequency(model, *two, cable) for one, *two in segments(model) if one is cable)
            s = omega * stage.tau / 2
            lacking = stage.dissipation * s**2 / (1 + s**2) - cable.dashpot / stage.tau * L0 / cable.EA
            T, _ = tension_between(cable, l_a, l, stage.tau, max(lacking, 0.0))
        else:
            then = l_a if stage.law == LAW_BACKWARD else e @ before
            if cable.compression == "none":  # the damper acts on the change of the taut part of the length
                T = tension(cable, l, (max(l, L0) - max(then, L0)) / stage.tau)
            else:
                T = tension(cable, l, (l - then) / stage.tau)
        r[a] += T * e
        r[b] -= T * e
    return r[: model.n_free]


def segment_law(net, s):
    """Of segment s in the system of `mechanics.linear.chain`: e and g (3,), a, k [N/m] and T_0 [N]."""
    row = net.segment[s]
    return (
        row[SEGMENT_DIRECTION : SEGMENT_DIRECTION + 3],
        row[SEGMENT_GRADIENT : SEGMENT_GRADIENT + 3],
        row[SEGMENT_GEOMETRIC],
        row[SEGMENT_STIFFNESS],
        row[SEGMENT_TENSION],
    )


def operator(model, net):
    """(n_free, 3, n_free, 3) matrix of the displacements in the system of `mechanics.linear.chain`, tensions eliminated [N/m]."""
    K = np.zeros((model.n, 3, model.n, 3))
    for i in range(model.n_free):
        K[i, :, i] += net.diagonal[i]
    for s, (i, j) in enumerate(model.ends):
        e, g, a, k, _ = segment_law(net, s)
        G = a * np.eye(3) + k * np.outer(e, g)
        K[i, :, i] += G
        K[j, :, j] += G
        K[i, :, j] -= G
        K[j, :, i] -= G
    return K[: model.n_free, :, : model.n_free]


def couplings(model, net):
    """Blocks (2, 3, 3) both ways between the nodes (i, j) of each pair that effects join."""
    pairs = [(net.near_blocks[s], nodes) for s, nodes in enumerate(model.ends[: len(net.near_blocks)])]
    for s in range(len(net.far_blocks) - 1):
        if model.cable_of[s] == model.cable_of[s + 1]:
            pairs.append((net.far_blocks[s], (model.ends[s, 0], model.ends[s + 1, 1])))
    return pairs


def dense(model, net, right):
    """Solution of the system of `mechanics.linear.chain` with the tensions as unknowns: d (n, 3), T, and the condition number.

    Rows are scaled to 1, and the solution is refined with residuals in extended precision.
    """
    n, S = 3 * model.n, model.n_segments
    A, b = np.zeros((n + S, n + S)), np.append(right.ravel(), np.zeros(S))
    for i in range(model.n_free):
        A[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] += net.diagonal[i]
    for s, (i, j) in enumerate(model.ends):
        e, g, a, k, T_0 = segment_law(net, s)
        A[n + s, n + s], b[n + s] = -1.0, -T_0
        for p, sign in ((i, -1.0), (j, 1.0)):
            P, other = slice(3 * p, 3 * p + 3), slice(3 * (i + j - p), 3 * (i + j - p) + 3)
            A[P, P] += a * np.eye(3)
            A[P, other] -= a * np.eye(3)
            A[P, n + s] += sign * e
            A[n + s, P] += sign * k * g
    for s, (i, j) in couplings(model, net):
        for p, q, K in ((i, j, s[0]), (j, i, s[1])):
            A[3 * p : 3 * p + 3, 3 * q : 3 * q + 3] += K
    moves = np.append(np.arange(3 * model.n_free), np.arange(n, n + S))
    A, b = A[np.ix_(moves, moves)], b[moves]
    scale = 1.0 / np.abs(A).max(axis=1)
    A, b = A * scale[:, None], b * scale
    x = np.linalg.solve(A, b)
    for _ in range(3):
        x = x + np.linalg.solve(A, (b - A.astype(np.longdouble) @ x).astype(float))
    d = np.zeros((model.n, 3))
    d[: model.n_free] = x[: 3 * model.n_free].reshape(-1, 3)
    return d, x[3 * model.n_free :], np.linalg.cond(A)


def out_of_balance(model, net):
    """(n_free, 3) force that `residual` left in the arrays of a net [N]."""
    r = net.right_side.copy()
    for s, (i, j) in enumerate(model.ends):
        e, _, _, _, T = segment_law(net, s)
        r[i] += T * e
        r[j] -= T * e
    return r[: model.n_free]


def matrix_of_blocks(model, D, near):
    """(n_free, 3, n_free, 3) from the blocks that an effect writes: D (n_free, 3, 3), near (n_segments, 2, 3, 3)."""
    K = np.zeros((model.n, 3, model.n, 3))
    for i in range(model.n_free):
        K[i, :, i] -= D[i]
    for s, (i, j) in enumerate(model.ends):
        K[i, :, j] -= near[s, 0]
        K[j, :, i] -= near[s, 1]
    return K[: model.n_free, :, : model.n_free]
