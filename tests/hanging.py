"""Scenes that hang, and what must hold of their rest, recomputed from what is shown.

What double precision allows: a place is known to eps times its size x, and the last segment of a cable takes up what the
N before it have rounded. So the direction of a segment of length l, its strain and with them a balance of forces that is
computed from places are good to about N eps x/l.
"""

from functools import cache

import numpy as np

from anet_lumped import Cable, Fixed, Free, Scene, equilibrium
from anet_lumped.effects import Gravity

EPS = np.finfo(float).eps
G = 9.81
MU = 0.1
CORNERS = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
STIFFNESSES = [1.0, 1e2, 1e4, 1e6, 1e9]


def cable(start, end, length=1.0, EA=1e4, segments=20, mu=MU, **kwargs):
    return Cable(start, end, length=length, mass_per_length=mu, EA=EA, segments=segments, **kwargs)


def hung(end, *, gravity=(0, 0, -1), g=G, **kwargs):
    """One cable from the origin to ``end``."""
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", end)], [cable("a", "b", **kwargs)], [Gravity(g, gravity)])


def held_net(mass=0.036, lengths=(1.0, 1.0, 1.0, 1.0), **kwargs):
    points = [*(Fixed(f"s{i}", at) for i, at in enumerate(CORNERS)), Free("p0", mass)]
    return Scene(points, [cable(f"s{i}", "p0", lengths[i], **kwargs) for i in range(4)], [Gravity()])


def mesh(held, mass=0.0, **kwargs):
    """10 x 10 knots, held at the corners or all around, each cable longer than its place by a tenth."""
    rim = (0, 9)
    points = []
    for i in range(10):
        for j in range(10):
            fixed = (i in rim and j in rim) if held == "corners" else (i in rim or j in rim)
            points.append(Fixed(f"{i} {j}", (0.9 * i, 0.9 * j, 0)) if fixed else Free(f"{i} {j}", mass))
    links = [(f"{i} {j}", f"{i} {j + 1}") for i in range(10) for j in range(9)]
    links += [(f"{j} {i}", f"{j + 1} {i}") for i in range(10) for j in range(9)]
    return Scene(points, [cable(a, b, **kwargs) for a, b in links], [Gravity()])


def three_supports(free, cables, effects=None):
    """Three supports at different heights and whatever hangs between them."""
    fixed = [Fixed("a", (0, 0, 0)), Fixed("b", (1.0, 0.3, -0.4)), Fixed("c", (0.2, 1.1, 0.5))]
    used = {name for one in cables for name in (one.start, one.end)}
    return Scene([p for p in fixed if p.name in used] + free, cables, effects or [Gravity()])


@cache
def assorted(EA):
    """Nets of every kind, by name, all of one stiffness."""

    def c(start, end, length=1.0, segments=20, **kwargs):
        return cable(start, end, length, EA, segments, **kwargs)

    three = [c("a", "p"), c("b", "p"), c("c", "p")]
    return {
        "held net": held_net(EA=EA),
        "held net, no payload": held_net(0.0, EA=EA),
        "held net, 2000 segments": held_net(EA=EA, segments=2000),
        "one slack": held_net(4.0, (1.0, 1.0, 1.0, 3.0), EA=EA),
        "one slack, odd": held_net(4.0, (1.0, 1.0, 1.0, 3.0), EA=EA, segments=21),
        "two slack, heavy": held_net(1000.0, (1.0, 1.0, 2.0, 30.0), EA=EA),
        "loose end": three_supports([Free("p")], [c("a", "p")]),
        "loose end, backwards": three_supports([Free("p", 0.1)], [c("p", "a")]),
        "loose end, 2000 segments": three_supports([Free("p", 0.1)], [c("a", "p", segments=2000)]),
        "different heights": three_supports([Free("p", 0.05)], three),
        "tree": three_supports(
            [Free("p", 0.05), Free("x"), Free("y", 0.2), Free("z")],
            [*three, c("p", "x"), c("x", "y", 0.5), c("x", "z", 0.7)],
        ),
        "two junctions": three_supports(
            [Free("p", 0.05), Free("x", 0.1)], [c("a", "p"), c("b", "p"), c("p", "x", 0.4), c("x", "c", 1.5)]
        ),
        "loop": three_supports(
            [Free("p", 0.1), Free("x"), Free("y", 0.1)],
            [c("a", "p", 0.5), c("b", "x", 0.6), c("c", "y", 0.8), c("p", "x", 0.6), c("x", "y", 0.5), c("y", "p", 0.7)],
        ),
        "parallel, alike": three_supports([Free("p", 0.1)], [c("a", "p", name="1"), c("p", "a", name="2")]),
        "parallel, one longer": three_supports([Free("p", 0.1)], [c("a", "p", name="1"), c("a", "p", 1.5, name="2")]),
        "parallel between free points": three_supports(
            [Free("p", 0.1), Free("x")], [c("a", "p"), c("p", "x", name="1"), c("x", "p", 1.7, name="2")]
        ),
        "parallel between supports": three_supports([], [c("a", "b", 1.5, name="1"), c("b", "a", 1.2, name="2")]),
        "one segment each": three_supports([Free("p", 0.1)], [c("a", "p", segments=1), c("b", "p", segments=1)]),
        "one and many segments": three_supports([Free("p", 0.1)], [c("a", "p", segments=1), c("b", "p", segments=200)]),
        "mesh on its corners": mesh("corners", EA=EA, segments=3),
        "mesh on its rim": mesh("rim", EA=EA, segments=2),
        "mesh on its rim, heavy knots": mesh("rim", 10.0, EA=EA, segments=2),
        "mesh of single segments": mesh("corners", 0.1, EA=EA, segments=1),
    }


def weight_carried(scene):
    """Weight of the parts that move [N]: half a segment at each fixed end does not."""
    free = {p.name: p.mass for p in scene.points if isinstance(p, Free)}
    mass = sum(free.values())
    for one in scene.cables:
        ends = (one.start in free) + (one.end in free)
        mass += one.mass_per_length * one.L0 * (one.segments - 1 + 0.5 * ends)
    return mass * float(np.linalg.norm(scene.gravity))


def imbalance(state):
    """Largest out-of-balance force on a moving node and what places in double precision leave of it, over the weight."""
    scene, g = state.scene, state.scene.gravity
    on = {p.name: p.mass * g for p in scene.points if isinstance(p, Free)}
    reach, worst, noise = np.abs(state.q).max(), 0.0, 0.0
    for one in scene.cables:
        T, d = state.tension(one.name), np.diff(state.shape(one.name), axis=0)
        l = np.linalg.norm(d, axis=1)
        pull = (T / np.maximum(l, 1e-300))[:, None] * d
        half = 0.5 * one.mass_per_length * one.L0 * g
        worst = max(worst, np.abs(np.diff(pull, axis=0) + 2 * half).max(initial=0.0))
        noise = max(noise, np.max(np.where(T > 0, T / np.maximum(l, 1e-300), 0.0)) * (4 + one.segments) * EPS * reach)
        for end, force in ((one.start, pull[0]), (one.end, -pull[-1])):
            if end in on:
                on[end] = on[end] + force + half
    weight = weight_carried(scene) or max(np.max(state.tension(c.name)) for c in scene.cables)
    worst = max([worst, *(np.abs(force).max() for force in on.values())])
    return worst / weight, noise / weight


def strain_excess(state):
    """Largest departure of a segment's length from the law, over L0, beyond what the search and rounding leave.

    l = L0 (1 + T/EA) where a segment is taut, l <= L0 where it is slack. The search ends when a cable closes to 1e-12 of its
    length, or of the distance of its ends if that is longer, which its last segment takes up, and when the force on each
    segment lies along it to 1e-12 of the load W, so that its strain is known to 1e-12 W/T; below T = 1e-7 W it counts as slack.
    """
    weight, reach, worst = weight_carried(state.scene), np.abs(state.q).max(), -np.inf
    for one in state.scene.cables:
        T = state.tension(one.name)
        l = np.linalg.norm(np.diff(state.shape(one.name), axis=0), axis=1)
        off = l / one.L0 - 1.0 - T / one.EA
        allowed = 2e-12 * one.segments * (1.0 + T / one.EA) + (4 + one.segments) * EPS * max(reach, one.length) / one.L0
        slack = T <= 1e-7 * weight
        allowed = allowed + np.where(slack, 0.0, 2e-12 * weight / np.maximum(T, 1e-300))
        worst = max(worst, float((np.where(slack, np.maximum(off, 0.0), np.abs(off)) - allowed).max()))
        assert (T >= 0.0).all()
    return worst


def check(scene):
    state = equilibrium(scene)
    force, noise = imbalance(state)
    assert force <= 1e-10 + noise
    assert strain_excess(state) <= 0.0
    assert state.residual <= 1e-10
    assert np.array_equal(state.v, np.zeros_like(state.q)) and state.t == 0.0
    return state


ENDS = {
    "deep": (0.8, 0, 0),
    "oblique": (0.3, 0.4, 0.6),
    "near taut": (1 - 1e-9, 0, 0),
    "chord equal to length": (1.0, 0, 0),
    "taut": (0.6, 0.8, 0.5),
    "hairpin": (1e-9, 0, 0),
    "coincident": (0, 0, 0),
    "vertical": (0, 0, -0.5),
    "vertical, upward": (0, 0, 0.7),
    "vertical, taut": (0, 0, -1.2),
}


def potential_energy(scene, state):
    """Energy E(x) = sum k/2 max(0, l - L0)^2 - m g . x and its gradient, of the moving nodes' places.

    It is convex, so that a place of no force is one of least energy.
    """
    moving = np.ones(len(state.q), bool)
    moving[[state.model.node(p.name) for p in scene.points if not isinstance(p, Free)]] = False
    load = np.zeros_like(state.q)
    for point in scene.points:
        if isinstance(point, Free):
            load[state.model.node(point.name)] = point.mass * scene.gravity
    springs = []
    for one in scene.cables:
        nodes = state.model.nodes(one.name)
        weights = np.full(len(nodes), one.mass_per_length * one.L0)
        weights[[0, -1]] *= 0.5
        np.add.at(load, nodes, weights[:, None] * scene.gravity)
        springs.append((nodes[:-1], nodes[1:], one.L0, one.EA / one.L0))

    def energy(x):
        q = state.q.copy()
        q[moving] = x.reshape(-1, 3)
        total, slope = -np.sum(load * q), -load
        for a, b, L0, k in springs:
            d = q[b] - q[a]
            l = np.linalg.norm(d, axis=1)
            stretch = np.maximum(l - L0, 0.0)
            total += 0.5 * k * np.sum(stretch**2)
            pull = (k * stretch / np.maximum(l, 1e-300))[:, None] * d
            slope = slope.copy()
            np.add.at(slope, b, pull)
            np.add.at(slope, a, -pull)
        return total, slope[moving].ravel()

    return energy, state.q[moving].ravel()
