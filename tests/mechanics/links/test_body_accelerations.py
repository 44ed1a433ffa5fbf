"""Accelerations and tensions of links at rigid bodies against a dense solution in the shifts and turns of the bodies.

With the velocities x' = P y of all nodes by those of the pieces y, and x'' = P y' + g with g = w x (w x d) on the nodes of bodies:

    P^T M P y' + (B P)^T T = P^T (f - M g) ,    B P y' = (wanted) - B g .
"""

import math
from dataclasses import replace

import dense_links as dense
import naive
import numpy as np
import pytest

from anet_lumped import Body, Cable, Fixed, Free, Scene
from anet_lumped.effects import Gravity, ViscousDamping, Water
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from anet_lumped.prescribed.turning import matrix_of

EFFECTS = [Gravity(), ViscousDamping(0.7)]
T_TEST = 0.3  # [s]
CLOSE = 1e-10  # of the largest number: conditions are up to some 1e4
HOOKS = {"a": (0.3, 0.2, 0.1), "b": (-0.3, 0.25, 0.1), "c": (-0.28, -0.2, 0.05), "d": (0.1, -0.2, 0.4)}
TENSOR = ((0.09, 0.01, -0.02), (0.01, 0.16, 0.005), (-0.02, 0.005, 0.2))


def body(name="box", at=(0.0, 0.0, -1.5), **more):
    own = dict(mass=4.0, inertia=TENSOR, attachments=HOOKS, centre_of_mass=(0.02, -0.01, -0.05), rotation=(0.2, 0.5, -0.1))
    return Body(name, at=at, **own, **more)


def cable(start, end, segments=1, length=1.3, **more):
    return Cable(start, end, length=length, mass_per_length=0.2, EA=math.inf, segments=segments, compression="linear", **more)


TOPS = [Fixed(f"f{k}", at) for k, at in enumerate([(1, 1, 0.2), (-1, 1, 0), (-1, -1, 0.1), (1, -1, 0)])]
M, N = Free("m", mass=0.7), Free("n", mass=1.1)
SLAB = body("slab", at=(0.5, -0.3, -3.0))
DECK = Body(
    "deck",
    attachments={"a": (1, 0, 0)},
    path=paths.harmonic((0, 0, 1), (0.1, 0, 0.2), frequency=1.0),
    turning=paths.harmonic((0, 0, 0), (0.3, 0, 0.1), frequency=0.7),
)
SCENES = {  # points, cables, bodies
    "hung on one": (TOPS[:1], [cable("f0", "box.a")], [body()]),
    "hung on four": (TOPS, [cable(f"f{k}", f"box.{hook}", 1 + k) for k, hook in enumerate("abcd")], [body()]),
    "two at one attachment": (TOPS[:2], [cable("f0", "box.a"), cable("f1", "box.a", 3)], [body()]),
    "at the origin too": (TOPS[:2], [cable("f0", "box"), cable("box.b", "f1", 2)], [body()]),
    "no cable of its own": ([TOPS[0], M], [cable("f0", "m", 3)], [body()]),
    "between free points": ([M, N], [cable("m", "box.a"), cable("box.b", "n", 4), cable("m", "n", 2)], [body()]),
    "two bodies": (
        TOPS[:1],
        [cable("f0", "box.a"), cable("box.b", "slab.c", 3), cable("slab.a", "box.d"), cable("slab.b", "box")],
        [body(), SLAB],
    ),
    "to itself": (TOPS[:1], [cable("f0", "box.a"), cable("box.b", "box.d", 3)], [body()]),
    "pinned": (TOPS[:2], [cable("f0", "box.a"), cable("box.b", "f1", 2)], [body(pinned="c")]),
    "at the pivot": ([TOPS[0], M], [cable("box.a", "m"), cable("f0", "box"), cable("box", "m", 2, 2.0)], [body(pinned="")]),
    "on a driven body": ([], [cable("deck.a", "box.a"), cable("box.b", "deck", 2)], [body(), DECK]),
}


def scene_of(name):
    points, cables, bodies = SCENES[name]
    return Scene(points, cables, EFFECTS, bodies=bodies)


def pieces(model, q):
    """P (3 n_free, unknowns) of the places q."""
    columns, taken = [], set()
    for one in model.scene.bodies:
        if one.is_driven:
            continue
        nodes = [model.node_of[point.name] for point in one.points]
        taken |= set(nodes)
        origin = q[nodes[0]]
        pivot = None if one.pinned is None else q[model.node_of[f"box.{one.pinned}" if one.pinned else "box"]]
        for x in np.eye(3):
            if pivot is None:
                columns.append(_column(model, nodes, np.tile(x, (len(nodes), 1))))
            columns.append(_column(model, nodes, np.cross(x, q[nodes] - (origin if pivot is None else pivot))))
    for i in sorted(set(range(model.n_free)) - taken):
        columns += [_column(model, [i], [x]) for x in np.eye(3)]
    return np.array(columns).T


def _column(model, nodes, rows):
    out = np.zeros((model.n_free, 3))
    out[nodes] = rows
    return out.ravel()


def at_random(model, seed):
    """Places and velocities in which each body is one piece, with its spins; lengths are those that come."""
    rng = np.random.default_rng(seed)
    (q, v), spins = dense.prescribed(model, T_TEST)[:2], {}
    q[: model.n_free], v[: model.n_free] = rng.normal(size=(2, model.n_free, 3))
    for one in model.scene.bodies:
        if one.is_driven:
            continue
        nodes, arms = [model.node_of[point.name] for point in one.points], np.array([point.arm for point in one.points])
        spins[one.name] = rng.normal(size=3)
        q[nodes] = rng.normal(size=3) + arms @ matrix_of(tuple(rng.normal(size=3))).T
        pivot = None if one.pinned is None else model.node_of[f"box.{one.pinned}" if one.pinned else "box"]
        drift = rng.normal(size=3) if pivot is None else np.cross(spins[one.name], q[nodes[0]] - q[pivot])
        v[nodes] = drift + np.cross(spins[one.name], q[nodes] - q[nodes[0]])
    return q, v, spins


def turning_accelerations(model, q, spins):
    """g (n, 3) of the nodes of bodies: w x (w x d), of a free body relative to its origin, which y' then takes up."""
    g = np.zeros((model.n, 3))
    for one in model.scene.bodies:
        if not one.is_driven:
            nodes, w = [model.node_of[point.name] for point in one.points], spins[one.name]
            about = q[nodes[0]] if one.pinned is None else q[model.node_of[f"box.{one.pinned}" if one.pinned else "box"]]
            g[nodes] = np.cross(w, np.cross(w, q[nodes] - about))
    return g


def dense_solution(model, q, v, spins, forces=0.0, added=None):
    """Accelerations of the moving nodes (n_free, 3) and tensions (n_segments,).

    Effects of a fluid add ``forces`` (n, 3) and what nodes carry along, ``added`` (n_free, 3, 3).
    """
    n, lengths = 3 * model.n_free, dense.constant_lengths(model)
    P, g, B = pieces(model, q), turning_accelerations(model, q, spins).ravel()[:n], dense.constraints(model, q)
    M = dense.mass_matrix(naive.masses(model)[: model.n_free], added)
    r = dense.wanted(model, q, v, lengths) - B[:, n:] @ dense.prescribed(model, T_TEST)[2].ravel()[n:] - B[:, :n] @ g
    f = (naive.external(model, q, v) + forces).ravel()[:n] - M @ g
    BP = B[:, :n] @ P
    moves = np.flatnonzero(np.abs(BP).max(axis=1) > 1e-12)  # a link between two held points carries nothing
    K = np.block([[P.T @ M @ P, BP[moves].T], [BP[moves], np.zeros((len(moves),) * 2)]])
    x = np.linalg.solve(K, np.concatenate([P.T @ f, r[moves]]))
    T = np.zeros(model.n_segments)
    T[moves] = x[P.shape[1] :]
    return (P @ x[: P.shape[1]] + g).reshape(-1, 3), T


def agree(found, a, T):
    np.testing.assert_allclose(found.a, a, rtol=0.0, atol=CLOSE * np.abs(a).max())
    np.testing.assert_allclose(found.T, T, rtol=0.0, atol=CLOSE * np.abs(T).max())


@pytest.mark.each_once
@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", SCENES)
def test_every_kind_of_net_with_bodies(name, seed):
    scene = scene_of(name)
    model = build(scene)
    q, v, spins = at_random(model, seed)
    agree(dense.compiled(scene, T_TEST, q, v), *dense_solution(model, q, v, spins))


@pytest.mark.parametrize("name", ["hung on four", "two bodies", "pinned", "on a driven body"])
def test_bodies_in_water(name):
    """Halves of segments at its attachments give a body an inertia that differs by direction; the power to the fluid is told."""
    points, cables, bodies = SCENES[name]
    water = Water(level=20.0)
    scene = Scene(points, [replace(one, diameter=0.2) for one in cables], [*EFFECTS, water], bodies=bodies)
    model = build(scene)
    q, v, spins = at_random(model, 2)
    index, params = (np.asarray(x, kind) for x, kind in zip(water.table(model), (np.int64, float), strict=True))
    added, forces = np.zeros((model.n_free, 3, 3)), np.zeros((model.n, 3))
    water.kernels()["inertia"](T_TEST, q, index, params, added)
    taken = water.kernels()["force"](T_TEST, q, v, index, params, forces)
    of_bodies = np.concatenate([added[model.node_of[p.name]].ravel() for one in bodies if not one.is_driven for p in one.points])
    assert np.abs(of_bodies).max() > 1.0  # a quarter of the mass of a body, and more
    a, T = dense_solution(model, q, v, spins, forces, added)
    found = dense.compiled(scene, T_TEST, q, v)
    agree(found, a, T)
    of_fluid = sum(v[i] @ added[i] @ a[i] for i in range(model.n_free))
    by_damping = -sum(v[i] @ naive.external(replace_effects(model, EFFECTS[1:]), q, v)[i] for i in range(model.n_free))
    assert found.power[1] == pytest.approx(taken + by_damping + of_fluid, rel=1e-9)


def replace_effects(model, effects):
    """The model of the same scene with other effects."""
    return build(replace(model.scene, effects=effects))
