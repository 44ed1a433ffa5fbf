"""Accelerations and tensions of links against a dense solution, for every kind of net, of points, and of what masses are."""

import math
from dataclasses import replace

import dense_links as dense
import naive
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from systems import mesh, nets
from tried import tried

from anet_lumped import Cable, Driven, Fixed, Free, Scene
from anet_lumped.effects import Gravity, LineChange, ViscousDamping, Water
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths, signals

EFFECTS = [Gravity(), ViscousDamping(0.7)]
# Both solutions lose as many digits as the system is badly conditioned. Random nets have conditions of up to some 1e5, so that
# 1e-10 of the largest number would be an error in the equations, and 1e-12 rounding.
CLOSE = 1e-10


def rigid(made):
    """The scene with cables that do not stretch, of different masses."""
    cables = [
        replace(cable, EA=math.inf, zeta=0.0, mass_per_length=0.05 * (1 + c % 3), length=1.4 - 0.1 * (c % 4))
        for c, cable in enumerate(made.cables)
    ]
    return replace(made, cables=cables)


def at_random(model, rng, held=None, speed=1.0):
    """Places with all lengths kept, and velocities that keep them, of any size along all other directions."""
    q = rng.normal(size=(model.n, 3))
    v = np.zeros((model.n, 3))
    if held is not None:
        q[model.n_free :], v[model.n_free :] = held[0][model.n_free :], held[1][model.n_free :]
    q = dense.straight_lengths(model, rng, q)
    v[: model.n_free] = speed * rng.normal(size=(model.n_free, 3))
    return q, dense.keeping_lengths(model, q, v)


def agree(found, a, T):
    np.testing.assert_allclose(found.a, a, rtol=0.0, atol=CLOSE * np.abs(a).max())
    np.testing.assert_allclose(found.T, T, rtol=0.0, atol=CLOSE * np.abs(T).max())


def check_net(scene, seed, speed=1.0):
    model, rng = build(scene), np.random.default_rng(seed)
    q, v = at_random(model, rng, dense.prescribed(model, 0.0), speed)
    M, lengths = dense.mass_matrix(naive.masses(model)[: model.n_free]), dense.constant_lengths(model)
    found = dense.compiled(scene, 0.0, q, v)
    agree(found, *dense.solve(model, q, v, naive.external(model, q, v), M, lengths))
    return model, q, v, found


def apart(scene):
    """The scene with its fixed points a little apart, so that nothing is symmetric."""
    rng = np.random.default_rng(3)
    return replace(
        scene, points=[replace(p, at=tuple(0.2 * rng.normal(size=3))) if isinstance(p, Fixed) else p for p in scene.points]
    )


@pytest.mark.each_once
@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", nets())
def test_every_kind_of_net(name, seed):
    check_net(apart(rigid(nets(effects=EFFECTS)[name])), seed)


@pytest.mark.parametrize("rows, columns, segments", [(2, 2, 2), (3, 4, 1), (3, 3, 3)])
def test_meshes(rows, columns, segments):
    """Held at their corners by links of their own."""
    made = mesh(rows, columns, segments)
    cables = [replace(cable, EA=math.inf, zeta=0.0) for cable in made.cables]
    spread = {f"s{k}": (float(i), float(j), 0.3 * k) for k, (i, j) in enumerate([(0, 0), (0, 1), (1, 0), (1, 1)])}
    points = [Fixed(p.name, spread[p.name]) if isinstance(p, Fixed) else p for p in made.points]
    check_net(Scene(points, cables, EFFECTS), 5)


@pytest.mark.parametrize("segments", [1, 2, 3, 4])
@pytest.mark.parametrize("number", [1, 2, 3])
def test_cables_between_two_free_points(number, segments):
    """One cable, and two and three beside each other, of different numbers of segments, hung from one more and with a loose end."""
    made = dict(mass_per_length=0.1, EA=math.inf)
    cables = [
        Cable(*("xy" if c % 2 == 0 else "yx"), length=1.0 + 0.3 * c, segments=segments + c, name=f"c{c}", **made)
        for c in range(number)
    ]
    cables += [Cable("a", "x", length=0.7, segments=2, **made), Cable("z", "y", length=0.5, segments=segments, **made)]
    scene = Scene([Fixed("a", (0, 0, 0)), Free("x", 0.3), Free("y"), Free("z", 2.0)], cables, EFFECTS)
    check_net(scene, 10 * number + segments)


@pytest.mark.parametrize("mass", [1e-6, 1.0, 1e4])
def test_masses_of_points(mass):
    """Payloads far lighter and far heavier than the cables at a junction of four."""
    made = dict(mass_per_length=0.1, EA=math.inf, length=1.0)
    cables = [Cable(name, "x", segments=n, **made) for n, name in enumerate("abcd", 1)]
    points = [Fixed("a", (0.1, 0, 0)), Fixed("b", (-0.3, 0.2, 0)), Free("c"), Free("d", mass), Free("x", mass)]
    model, _, _, found = check_net(Scene(points, cables, EFFECTS), 2, speed=0.1)
    assert found.a[model.node("x")] @ found.a[model.node("x")] > 0.0


def test_rows_of_prescribed_nodes_hold_the_pull_on_them():
    """Force on all nodes together: weight, drag and what supports feel, by the motion of the whole net's mass."""
    scene = apart(rigid(nets(effects=EFFECTS)["junction"]))
    points = [Driven(p.name, paths.line(p.at, (0.1, 0.0, 0.0), 1.0)) if isinstance(p, Fixed) else p for p in scene.points]
    model, q, v, found = check_net(replace(scene, points=points), 4)
    m = naive.masses(model)[: model.n_free]
    whole = m @ found.a - naive.external(model, q, v).sum(axis=0)
    np.testing.assert_allclose(-found.f[model.n_free :].sum(axis=0), whole, atol=1e-10 * np.abs(found.T).max())


@pytest.mark.parametrize("t", [0.0, 0.31, 0.8, 2.0])
def test_driven_points(t):
    """Their velocity and acceleration act on the net, along a line and to and fro; what they put in is their force times v."""
    made = dict(mass_per_length=0.1, EA=math.inf, length=1.0)
    points = [
        Driven("a", paths.line((0, 0, 0), (0.8, -0.3, 0.1), ramp=1.0)),
        Driven("b", paths.harmonic((0.4, 0.5, 0), (0.1, 0.05, -0.2), frequency=1.7)),
        Fixed("c", (-0.3, 0.2, 0.1)),
        Free("x", 0.3),
    ]
    cables = [Cable(name, "x", segments=n, **made) for n, name in ((3, "a"), (1, "b"), (4, "c"))]
    scene = Scene(points, cables, EFFECTS)
    model = build(scene)
    held = dense.prescribed(model, t)
    q, v = at_random(model, np.random.default_rng(7), held)
    M, lengths = dense.mass_matrix(naive.masses(model)[: model.n_free]), dense.constant_lengths(model)
    found = dense.compiled(scene, t, q, v)
    a, T = dense.solve(model, q, v, naive.external(model, q, v), M, lengths, held[2])
    agree(found, a, T)
    pull = (dense.constraints(model, q).T @ T).reshape(-1, 3)  # -B^T T acts on the nodes, B^T T on what drives them
    assert found.power[2] == pytest.approx(np.sum(pull[model.n_free :] * v[model.n_free :]), abs=1e-10 * np.abs(T).max())
    drag = naive.external(model, q, v) - naive.external(model, q, 0.0 * v)
    assert found.power[1] == pytest.approx(-np.sum(drag * v), rel=1e-12) and found.power[0] == 0.0


@pytest.mark.parametrize("name", ["loose end", "junction", "parallel", "flying"])
def test_added_mass_of_water(name):
    """Its mass is a matrix for each node, with a level that goes through the net."""
    made = apart(rigid(nets()[name]))
    cables = [replace(cable, diameter=0.02, Can=1.3, Cat=0.4) for cable in made.cables]
    points = [replace(p, volume=1e-4, Ca=0.5, CdA=1e-3) if isinstance(p, Free) else p for p in made.points]
    scene = Scene(points, cables, [Gravity(), Water(level=0.1)])
    model, rng = build(scene), np.random.default_rng(11)
    q, v = at_random(model, rng, dense.prescribed(model, 0.0))
    water = scene.effects[1]
    index, params = (np.asarray(x, kind) for x, kind in zip(water.table(model), (np.int64, float), strict=True))
    added, f = np.zeros((model.n_free, 3, 3)), np.zeros((model.n, 3))
    water.kernels()["inertia"](0.0, q, index, params, added)
    taken = water.kernels()["force"](0.0, q, v, index, params, f)
    M = dense.mass_matrix(naive.masses(model)[: model.n_free], added)
    a, T = dense.solve(model, q, v, f + naive.external(model, q, v), M, dense.constant_lengths(model))
    found = dense.compiled(scene, 0.0, q, v)
    agree(found, a, T)
    of_fluid = sum(v[i] @ added[i] @ a[i] for i in range(model.n_free))
    assert found.power[1] == pytest.approx(taken + of_fluid, abs=1e-9 * (abs(taken) + abs(of_fluid)))


@pytest.mark.parametrize("t", [0.2, 0.5, 1.4])
def test_lengths_that_change(t):
    """Two cables at a junction are reeled in and paid out, with L' and L''; the mass of their nodes is that of now."""
    made = dict(mass_per_length=0.1, EA=math.inf, length=1.0)
    changing = {"a-x": signals.line(0.0, -0.4, 1.0), "x-y": signals.harmonic(0.1, 0.08, 1.3)}
    cables = [
        Cable("a", "x", segments=4, **made),
        Cable("b", "x", segments=2, **made),
        Cable("x", "y", segments=3, **made),
    ]
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (0.5, 0.3, 0)), Free("x", 0.2), Free("y", 0.1)]
    scene = Scene(points, cables, [Gravity(), LineChange(changing)])
    model, rng = build(scene), np.random.default_rng(13)
    now = {name: [float(part[0]) for part in signal.path.at(t)] for name, signal in changing.items()}
    lengthened = [replace(c, length=1.0 + now.get(c.name, [0.0])[0], segments=c.segments) for c in cables]
    then = build(Scene(points, lengthened, [Gravity()]))  # the same nodes and segments, at the lengths of this time
    q, v = at_random(then, rng, dense.prescribed(then, t))
    per = [(c, s) for c in cables for s in range(c.segments)]
    L, rate, change = (
        np.array([(1.0 if k == 0 else 0.0) / c.segments + now.get(c.name, [0.0] * 3)[k] / c.segments for c, _ in per])
        for k in range(3)
    )
    e_rate = np.linalg.lstsq(dense.constraints(then, q)[:, : 3 * then.n_free], rate, rcond=1e-12)[0]
    v[: then.n_free] += e_rate.reshape(-1, 3)
    assert np.abs(rate).max() > 0.01 and np.abs(change).max() > 0.01
    M = dense.mass_matrix(naive.masses(then)[: then.n_free])
    a, T = dense.solve(then, q, v, naive.external(then, q, v), M, dense.Lengths(L, rate, change))
    found = dense.compiled(scene, t, q, v)
    agree(found, a, T)
    # what a winch gives: -T L' on each link, and the kinetic and potential energy of the mass that comes
    more = dict(zip(cables, [now.get(c.name, [0.0, 0.0])[1] * c.mass_per_length / c.segments for c in cables], strict=True))
    power = -float(T @ rate)
    for cable, i, j in naive.segments(model):
        for node in (i, j):
            if node < model.n_free:
                power += 0.5 * more[cable] * (0.5 * v[node] @ v[node] + 9.81 * q[node, 2])
    assert found.power[2] == pytest.approx(power, abs=1e-9 * np.abs(T).max())


@st.composite
def random_nets(draw):
    """A tree of up to six points with some more cables, fixed and free points, each cable of one to five links."""
    n = draw(st.integers(2, 6))
    fixed = [draw(st.booleans()) for _ in range(n)]
    if all(fixed):
        fixed[-1] = False
    links = [(draw(st.integers(0, i - 1)), i) for i in range(1, n)]
    for _ in range(draw(st.integers(0, 2))):
        a = draw(st.integers(0, n - 1))
        links.append((a, (a + draw(st.integers(1, n - 1))) % n))
    rng = np.random.default_rng(draw(st.integers(0, 1000)))
    points = [
        Fixed(f"p{i}", tuple(0.2 * rng.normal(size=3))) if held else Free(f"p{i}", draw(st.sampled_from([0.0, 0.01, 1.0])))
        for i, held in enumerate(fixed)
    ]
    cables = [
        Cable(*((f"p{a}", f"p{b}") if draw(st.booleans()) else (f"p{b}", f"p{a}")), name=f"c{c}", EA=math.inf,
              length=draw(st.sampled_from([1.0, 1.2, 1.7])), segments=draw(st.integers(1, 5)), mass_per_length=0.1)
        for c, (a, b) in enumerate(links)
    ]  # fmt: skip
    return points, cables


@tried(40, derandomize=True)
@given(random_nets(), st.integers(0, 1000))
def test_random_nets(parts, seed):
    """Whose links can close, and whose lengths do not follow from each other, so that tensions are unique."""
    points, cables = parts
    reached = {name for cable in cables for name in (cable.start, cable.end)}
    scene = Scene([p for p in points if p.name in reached or isinstance(p, Fixed)], cables, EFFECTS)
    model, rng = build(scene), np.random.default_rng(seed)
    assume(model.n_free > 0)
    try:
        q, v = at_random(model, rng, dense.prescribed(model, 0.0))
    except AssertionError:
        assume(False)
    B = dense.constraints(model, q)[:, : 3 * model.n_free]
    assume(np.linalg.svd(B[np.abs(B).sum(axis=1) > 0.0], compute_uv=False)[-1] > 1e-2)
    M, lengths = dense.mass_matrix(naive.masses(model)[: model.n_free]), dense.constant_lengths(model)
    found = dense.compiled(scene, 0.0, q, v)
    agree(found, *dense.solve(model, q, v, naive.external(model, q, v), M, lengths))
