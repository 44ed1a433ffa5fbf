"""Statics: balance and law recomputed from what is shown, closed forms, catenaries, least energy, invariance, errors.

What double precision allows: a place is known to eps times its size x, and the last segment of a cable takes up what the
N before it have rounded. So the direction of a segment of length l, its strain and with them a balance of forces that is
computed from places are good to about N eps x/l.
"""

import math
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize, root

from anet_lumped import Cable, Driven, EquilibriumError, Fixed, Free, NoRestError, Scene, catenary, equilibrium
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.prescribed import paths
from anet_lumped.statics.catenary_net import catenary_net

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

    l = L0 (1 + T/EA) where a segment is taut, l <= L0 where it is slack. The search ends when a cable closes to 1e-12 of
    its length, which its last segment takes up, and when the force on each segment lies along it to 1e-12 of the load W, so
    that its strain is known to 1e-12 W/T; below T = 1e-7 W it counts as slack.
    """
    weight, reach, worst = weight_carried(state.scene), np.abs(state.q).max(), -np.inf
    for one in state.scene.cables:
        T = state.tension(one.name)
        l = np.linalg.norm(np.diff(state.shape(one.name), axis=0), axis=1)
        off = l / one.L0 - 1.0 - T / one.EA
        allowed = 2e-12 * one.segments + (4 + one.segments) * EPS * max(reach, one.length) / one.L0
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


@pytest.fixture
def iterations(monkeypatch):
    """Newton iterations of every search, as they come."""
    module, counts = sys.modules["anet_lumped.statics.equilibrium"], []

    def counted(*arguments, solve=module.solve):
        result = solve(*arguments)
        counts.append(result[3])
        return result

    monkeypatch.setattr(module, "solve", counted)
    return counts


# One cable -----------------------------------------------------------------------------------------------------------

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


@pytest.mark.parametrize("segments", [5, 6, 20, 2000])
@pytest.mark.parametrize("EA", STIFFNESSES)
@pytest.mark.parametrize("end", ENDS)
def test_one_cable(end, EA, segments):
    state = check(hung(ENDS[end], EA=EA, segments=segments))
    assert state.shape("a-b")[0] == pytest.approx([0, 0, 0], abs=0) and state.shape("a-b")[-1] == pytest.approx(ENDS[end])


@pytest.mark.parametrize("ratio", [0.0, 1.0, 100.0, 1e4])
@pytest.mark.parametrize("EA", STIFFNESSES)
def test_payload(EA, ratio):
    check(held_net(0.1 * ratio, EA=EA))


@pytest.mark.parametrize("direction", [(0, 0, 1), (1, 0, 0), (-0.3, 2.0, 0.7)])
@pytest.mark.parametrize("g", [1e-3, 9.81, 1e3])
def test_gravity_in_any_direction(direction, g):
    state = check(hung((0.3, 0.4, 0.2), gravity=direction, g=g))
    down = np.array(direction) / np.linalg.norm(direction)
    assert (state.shape("a-b") @ down).max() > max(0.0, np.array((0.3, 0.4, 0.2)) @ down) + 0.2


@pytest.mark.parametrize("EA", STIFFNESSES)
@pytest.mark.parametrize("name", assorted(1.0))
def test_nets(name, EA):
    check(assorted(EA)[name])


@pytest.mark.parametrize("compression", ["none", "damped", "linear"])
def test_taut_cables_rest_alike_under_every_compression_law(compression):
    state = check(held_net(compression=compression))
    assert state.position("p0") == pytest.approx(equilibrium(held_net()).position("p0"), abs=1e-14)


def test_dampers_do_not_act_at_rest():
    scene = held_net()
    damped = Scene(scene.points, scene.cables, [*scene.effects, ViscousDamping(3.0)])
    assert np.array_equal(equilibrium(damped).q, equilibrium(scene).q)


def test_driven_points_rest_where_they_start():
    points = [Driven(f"s{i}", paths.line(at, (0.2, 0.0, 0.0), ramp=1.0)) for i, at in enumerate(CORNERS)]
    scene = held_net()
    state = equilibrium(Scene([*points, Free("p0", 0.036)], scene.cables, scene.effects))
    assert np.array_equal(state.position("p0"), equilibrium(scene).position("p0"))


# Closed forms --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("segments", [1, 5, 20, 2000])
@pytest.mark.parametrize("EA", [1.0, 50.0, 1e6])
@pytest.mark.parametrize("payload", [0.0, 0.2, 1000.0])
def test_hanging_chain_stretches_by_the_exact_sum(payload, EA, segments):
    """Segment j from the top carries the payload, the nodes below and the half segment at the end."""
    state = equilibrium(three_supports([Free("p", payload)], [cable("a", "p", EA=EA, segments=segments)]))
    below = MU / segments * (segments - 0.5 - np.arange(segments))
    tension = (payload + below) * G
    assert state.tension("a-p") == pytest.approx(tension, rel=1e-12)
    stretched = 1.0 + (tension / EA).mean()
    assert state.position("p") == pytest.approx([0, 0, -stretched], abs=segments * EPS * stretched)
    assert state.length("a-p") == pytest.approx(stretched, rel=segments * EPS)


@pytest.mark.parametrize("segments", [6, 20, 2000])
@pytest.mark.parametrize("EA", [1.0, 1e4])
def test_hairpin_is_two_hanging_strands(EA, segments):
    state = equilibrium(hung((0, 0, 0), EA=EA, segments=segments))
    half = segments // 2
    tension = MU / segments * (half - 0.5 - np.arange(half)) * G
    assert state.tension("a-b") == pytest.approx(np.concatenate([tension, tension[::-1]]), rel=1e-12)
    depth = 0.5 + (tension / EA).sum() / segments
    assert state.shape("a-b")[half] == pytest.approx([0, 0, -depth], abs=segments * EPS)


@pytest.mark.parametrize("EA", STIFFNESSES)
@pytest.mark.parametrize("load", [1e-3, 1.0, 1e3])
def test_two_bars_with_a_load(load, EA):
    """2 T h/l = W with T = EA (l/L0 - 1) and l^2 = a^2 + h^2: one equation for the depth h."""
    a, L0 = 0.4, 0.5
    scene = Scene(
        [Fixed("a", (-a, 0, 0)), Fixed("b", (a, 0, 0)), Free("p", load)],
        [cable("a", "p", L0, EA, 1), cable("p", "b", L0, EA, 1)],
        [Gravity()],
    )
    weight = (load + MU * L0) * G

    def sink(tension):
        """What is left of the load's balance, by the tension, which decides the depth and not the other way about."""
        l = L0 * (1 + tension / EA)
        return 2 * tension * math.sqrt(l * l - a * a) - weight * l

    tension = brentq(sink, 0.0, weight + EA, xtol=1e-300, rtol=4 * EPS)
    depth = math.sqrt((L0 * (1 + tension / EA)) ** 2 - a * a)
    state = equilibrium(scene)
    assert state.tension("a-p") == pytest.approx(tension, rel=1e-12)
    assert state.position("p") == pytest.approx([0, 0, -depth], rel=1e-12, abs=1e-14)


def test_taut_without_gravity_is_straight():
    state = equilibrium(hung((1.2, 0.5, 0), g=0.0, segments=7))
    assert state.tension("a-b") == pytest.approx(1e4 * (1.3 - 1.0), rel=1e-13)
    assert state.shape("a-b") == pytest.approx(np.linspace(0, 1, 8)[:, None] * (1.2, 0.5, 0), abs=1e-14)


def test_symmetric_net_hangs_symmetrically():
    state = equilibrium(held_net())
    assert state.position("p0")[:2] == pytest.approx([0, 0], abs=1e-14)
    tensions = np.array([state.tension(f"s{i}-p0") for i in range(4)])
    assert tensions == pytest.approx(np.broadcast_to(tensions[0], tensions.shape), rel=1e-12)


@pytest.mark.parametrize("EA", [1.0, 1e4])
def test_symmetric_mesh_hangs_symmetrically(EA):
    state = equilibrium(mesh("corners", EA=EA, segments=3))
    z = np.array([[state.position(f"{i} {j}")[2] for j in range(10)] for i in range(10)])
    for mirrored in (z.T, z[::-1], z[:, ::-1]):
        assert z == pytest.approx(mirrored, abs=1e-13 * abs(z.min()))


# Catenaries ----------------------------------------------------------------------------------------------------------

REFINED = np.array([10, 20, 40, 80, 160])


def slope(errors):
    return np.polyfit(np.log(REFINED), np.log(errors), 1)[0]


@pytest.mark.parametrize("EA", [5.0, 100.0, 1e6])
@pytest.mark.parametrize("end", ["deep", "oblique", "taut"])
def test_converges_to_the_elastic_catenary_at_second_order(end, EA):
    """Places of the nodes and pull on the start; an error below 1e-11, round-off, has no order."""
    truth = catenary((0, 0, 0), ENDS[end], 1.0, EA=EA, mass_per_length=MU)
    shape, pull = [], []
    for n in REFINED:
        state = equilibrium(hung(ENDS[end], EA=EA, segments=int(n)))
        nodes = state.shape("a-b")
        shape.append(np.abs(nodes - truth.point(np.linspace(0, 1, n + 1))).max())
        direction = (nodes[1] - nodes[0]) / np.linalg.norm(nodes[1] - nodes[0])
        on_start = state.tension("a-b")[0] * direction + 0.5 * MU / n * G * np.array([0, 0, -1])
        pull.append(np.abs(on_start - truth.end_forces[0]).max() / np.abs(truth.end_forces[0]).max())
    for errors in (shape, pull):
        assert errors[-1] < 1e-11 or slope(errors) == pytest.approx(-2, abs=0.1)


@pytest.mark.parametrize("name", ["held net", "different heights", "tree", "two junctions", "loop"])
def test_nets_converge_to_nets_of_catenaries_at_second_order(name):
    scene = assorted(1e4)[name]
    free = [p.name for p in scene.points if isinstance(p, Free)]
    places = {p.name: p.at for p in scene.points if isinstance(p, Fixed)}
    near = equilibrium(scene)
    truth = catenary_net(scene, places | {p: near.position(p) for p in free}).points
    errors = []
    for n in REFINED:
        state = equilibrium(Scene(scene.points, [replace(c, segments=int(n)) for c in scene.cables], scene.effects))
        errors.append(max(np.abs(state.position(p) - truth[p]).max() for p in free))
    assert slope(errors) == pytest.approx(-2, abs=0.1)


# A second method -----------------------------------------------------------------------------------------------------


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


@pytest.mark.parametrize("name", ["different heights", "two junctions", "loop", "parallel, one longer", "tree"])
def test_minimising_the_energy_finds_the_same_shape(name):
    """From a disturbed start, by a method that knows nothing of forces along cables. Soft and coarse, so that it can."""
    scene = assorted(20.0)[name]
    scene = Scene(scene.points, [replace(c, segments=3) for c in scene.cables], scene.effects)
    state = equilibrium(scene)
    energy, x = potential_energy(scene, state)
    start = x + 0.3 * np.random.default_rng(5).normal(size=x.shape)
    near = minimize(energy, start, jac=True, method="BFGS", options={"gtol": 1e-8, "maxiter": 5000}).x
    found = root(lambda x: energy(x)[1], near, tol=1e-14)  # BFGS ends where differences of energy do, at 1e-7 N
    assert np.abs(found.fun).max() < 1e-11
    assert x == pytest.approx(found.x, abs=1e-9)


# Invariance ----------------------------------------------------------------------------------------------------------


def rotation(seed):
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q * np.linalg.det(q)


def transformed(scene, *, turn=None, shift=(0.0, 0.0, 0.0), flip=False, order=None):
    """The same net turned and moved, its cables' ends swapped, its points and cables in another order."""
    turn = np.eye(3) if turn is None else turn
    points = [replace(p, at=turn @ p.at + shift) if isinstance(p, Fixed) else p for p in scene.points]
    cables = [replace(c, start=c.end, end=c.start) if flip else c for c in scene.cables]
    if order is not None:
        rng = np.random.default_rng(order)
        points, cables = ([some[i] for i in rng.permutation(len(some))] for some in (points, cables))
    g = turn @ scene.gravity
    return Scene(points, cables, [Gravity(float(np.linalg.norm(g)), tuple(g))])


@pytest.mark.parametrize("EA", [10.0, 1e6])
@pytest.mark.parametrize("name", ["one slack, odd", "tree", "two junctions", "loop", "parallel between free points"])
@pytest.mark.parametrize(
    "change",
    [{"turn": rotation(1)}, {"flip": True}, {"order": 3}, {"shift": (3.0, -2.0, 5.0)}],
    ids=["turned", "flipped", "renumbered", "moved"],
)
def test_shape_does_not_depend_on_the_axes_or_the_numbering(name, EA, change):
    scene = assorted(EA)[name]
    here, there = equilibrium(scene), equilibrium(transformed(scene, **change))
    turn, shift = change.get("turn", np.eye(3)), change.get("shift", 0.0)
    # A slack segment's place is settled by a force that is 1e-12 of the load: places agree to about its square root.
    for one in scene.cables:
        step = -1 if "flip" in change else 1
        assert there.shape(one.name)[::step] == pytest.approx(here.shape(one.name) @ turn.T + shift, abs=1e-9)
        assert there.tension(one.name)[::step] == pytest.approx(here.tension(one.name), abs=1e-8 * weight_carried(scene))


# Any net -------------------------------------------------------------------------------------------------------------

SIZES = st.floats(-0.8, 0.8).map(lambda x: round(x, 3))


@st.composite
def any_net(draw, EA, length):
    """A connected net of up to five free points: tree first, then more cables, slack or carrying."""
    supports = draw(st.lists(st.tuples(SIZES, SIZES, SIZES), min_size=1, max_size=4))
    masses = draw(st.lists(st.sampled_from([0.0, 0.01, 1.0, 100.0]), min_size=1, max_size=5))
    points = [*(Fixed(f"s{i}", at) for i, at in enumerate(supports)), *(Free(f"f{i}", m) for i, m in enumerate(masses))]
    names = [p.name for p in points]
    fixed = len(supports)
    links = [(names[draw(st.integers(0, fixed + i - 1))], names[fixed + i]) for i in range(len(masses))]
    for _ in range(draw(st.integers(0, 4))):
        a = draw(st.integers(0, len(names) - 2))
        links.append((names[a], names[draw(st.integers(a + 1, len(names) - 1))]))
    cables = [
        cable(
            *(pair if draw(st.booleans()) else pair[::-1]),
            length=draw(st.floats(*length)),
            EA=10 ** draw(st.floats(*np.log10(EA))),
            segments=draw(st.sampled_from([1, 2, 3, 5, 20, 51])),
            mu=draw(st.sampled_from([0.01, 0.1, 2.0])),
            name=f"c{i}",
        )
        for i, pair in enumerate(links)
    ]
    direction = draw(st.tuples(SIZES, SIZES, SIZES).filter(lambda d: math.hypot(*d) > 0.1))
    return Scene(points, cables, [Gravity(9.81, direction)])


@settings(deadline=None, max_examples=150, phases=[Phase.generate])
@given(any_net(EA=(1.0, 1e9), length=(3.0, 8.0)))
def test_any_net_that_its_load_alone_stretches(scene):
    """Every cable is longer than any two supports are apart."""
    check(scene)


@settings(deadline=None, max_examples=150, phases=[Phase.generate])
@given(any_net(EA=(1.0, 1e2), length=(0.5, 5.0)), st.integers(0, 2**32 - 1))
def test_any_soft_net_has_the_least_energy(scene, seed):
    state = check(scene)
    energy, x = potential_energy(scene, state)
    least = energy(x)[0]
    rng = np.random.default_rng(seed)
    for size in (1e-3, 1e-1, 10.0):
        other = energy(x + size * rng.normal(size=x.shape))[0]
        assert other >= least - 1e-12 * (abs(least) + abs(other))


def test_two_soft_cables_hanging_side_by_side():
    rng = np.random.default_rng(0)
    for _ in range(200):
        long = cable("p", "a", rng.uniform(1, 10), 10 ** rng.uniform(0, 1), 3)
        check(three_supports([Free("x"), Free("p", 0.01)], [cable("x", "a", EA=1.0, segments=1, mu=0.01), long]))


# Taut far above the load ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("EA", [1e7, 1e8, 1e9])
def test_prestressed_net(EA):
    """Three cables stretched by half and more: tensions of 1e6 to 1e9 times the load."""
    scene = three_supports([Free("p", 0.05)], [cable(a, "p", 0.4, EA) for a in "abc"])
    state = equilibrium(scene)
    force, noise = imbalance(state)
    assert force <= 1e-10 + noise
    assert strain_excess(state) <= 0.0


# Work ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("EA", [1.0, 1e4, 1e9])
@pytest.mark.parametrize("segments", [5, 20, 200, 2000])
def test_iterations_do_not_grow_with_segments_or_stiffness(iterations, EA, segments):
    equilibrium(held_net(EA=EA, segments=segments))
    assert iterations[0] <= 10


@pytest.mark.parametrize("EA", STIFFNESSES)
@pytest.mark.parametrize("name", assorted(1.0))
def test_iterations_of_nets(iterations, name, EA):
    """A slack cable costs a few for each rounding of its kink."""
    equilibrium(assorted(EA)[name])
    assert iterations[0] <= 40


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("EA", STIFFNESSES)
def test_iterations_of_one_cable(iterations, end, EA):
    equilibrium(hung(ENDS[end], EA=EA, segments=20))
    assert iterations[0] <= 40


# Errors --------------------------------------------------------------------------------------------------------------


def test_nothing_holds_it():
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("p"), Free("x"), Free("y"), Free("z")],
        [cable("a", "p"), cable("x", "y"), cable("y", "z")],
        [Gravity()],
    )
    with pytest.raises(
        NoRestError,
        match=r'nothing holds free point "x" and the 2 others it is tied to; `simulate` moves it from start="straight"',
    ):
        equilibrium(scene)


def test_slack_without_a_load_is_a_mechanism():
    with pytest.raises(NoRestError, match=r'cable "a-b" is slack and nothing loads it: a mechanism'):
        equilibrium(hung((0.8, 0, 0), g=0.0))


def test_two_way_springs_that_would_push():
    scene = hung((0, 0, 0), segments=5, compression="linear")
    with pytest.raises(NoRestError, match=r'cable "a-b" with compression="linear" has a slack segment that would push'):
        equilibrium(scene)


def test_a_tolerance_below_rounding_is_not_reached():
    with pytest.raises(EquilibriumError, match=r"No equilibrium was found in \d+ iterations: .* which should be 1e-30") as caught:
        equilibrium(hung((0.8, 0.1, 0)), tolerance=1e-30)
    assert caught.type is EquilibriumError  # a search that failed speaks of no wrong input
