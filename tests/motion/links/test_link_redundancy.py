"""Lengths that follow from other lengths: the smallest tensions, the warning, and cables that no tension keeps straight."""

import math
import re

import dense_links as dense
import naive
import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, InputError, Scene, State, simulate
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.model.build import build
from anet_lumped.motion.link_legs import REDUNDANT
from anet_lumped.prescribed import paths

INF, G = math.inf, 9.81


def cable(a, b, length=1.0, segments=4, compression="linear", **kwargs):
    made = dict(mass_per_length=0.1, EA=INF) | kwargs
    return Cable(a, b, length=length, segments=segments, compression=compression, **made)


def upright(**kwargs):
    """A cable that is straight between two points, one above the other."""
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0, 0, -1))], [cable("a", "b", **kwargs)], [Gravity(G)])


def straight_parallel():
    """Two cables of different masses beside each other on the same line, and a load below."""
    cables = [cable("a", "x", name="c0"), cable("a", "x", name="c1", mass_per_length=0.3, segments=3), cable("x", "y", 0.5, 2)]
    return Scene([Fixed("a", (0, 0, 0)), Free("x", at=(0, 0, -1)), Free("y", 0.7, at=(0, 0, -1.5))], cables, [Gravity(G)])


def flat_ring(n=5):
    """A wheel with one link a spoke and a side: rigid in its plane, with one length that follows from the others; it falls flat."""
    turn = 2 * math.pi * np.arange(n) / n
    rim = [Free(f"r{i}", 0.1 * (1 + i), at=(math.cos(x), math.sin(x), 0.0)) for i, x in enumerate(turn)]
    cables = [cable("hub", p.name, segments=1) for p in rim]
    cables += [cable(rim[i].name, rim[(i + 1) % n].name, 2 * math.sin(math.pi / n), segments=1) for i in range(n)]
    return Scene([Free("hub", 0.2, at=(0, 0, 0)), *rim], cables, [Gravity(G)])


def at_places(scene):
    """Places of the nodes, evenly spaced between the points."""
    model = build(scene)
    at, q = {p.name: np.array(p.at, float) for p in scene.points}, np.zeros((model.n, 3))
    for one in scene.cables:
        q[model.nodes(one.name)] = np.linspace(at[one.start], at[one.end], one.segments + 1)
    return model, q


@pytest.mark.parametrize(
    "scene", [upright(), upright(segments=1), upright(segments=2), straight_parallel(), flat_ring()],
    ids=["upright", "one link", "two links", "parallel", "ring"],
)  # fmt: skip
@pytest.mark.parametrize("turning", [0.0, 2.0])
def test_smallest_tensions(scene, turning):
    """Against least squares, weighted as the system says; at rest, and where the whole net turns about the vertical."""
    model, q = at_places(scene)
    v = turning * np.cross([0.0, 0.0, 1.0], q)
    found = dense.compiled(scene, 0.0, q, v)
    if model.n_free == 0:
        assert not found.T.any()
        return
    M, lengths = dense.mass_matrix(naive.masses(model)[: model.n_free]), dense.constant_lengths(model)
    f = naive.external(model, q, v)
    T = dense.smallest_tensions(model, q, v, f, M, lengths)
    # two passes with a shift of 1e-9 leave 1e-18 of the tensions over the smallest eigenvalue of S that counts, and roundings over
    # the shift, 1e-16/1e-9
    np.testing.assert_allclose(found.T, T, atol=1e-6 * max(np.abs(T).max(), G * naive.masses(model).sum()))
    wanted = dense.wanted(model, q, v, lengths)
    a = np.zeros((model.n, 3))
    a[: model.n_free] = found.a
    moves = np.abs(dense.constraints(model, q)[:, : 3 * model.n_free]).sum(axis=1) > 0.0
    np.testing.assert_allclose((dense.constraints(model, q) @ a.ravel())[moves], wanted[moves], atol=1e-6 * (G + turning**2))


@pytest.mark.parametrize("method", ["links", "links5"])
@pytest.mark.parametrize("scene", [upright(), straight_parallel(), flat_ring()], ids=["upright", "parallel", "ring"])
def test_a_run_says_so(scene, method):
    """It is done, finite, keeps its lengths and its energy, and warns."""
    options = dict(dt=0.002) if method == "links5" else {}
    run = simulate(scene, 0.5, method=method, start="straight", **options)
    assert run.ok and REDUNDANT in run.warnings and run.events == ()
    for array in (run.q, run.v, run.energy, run.segment_tension):
        assert np.isfinite(array).all()
    for one in scene.cables:
        assert np.abs(run.length(one.name) - one.length).max() < 1e-10
    total = run.energy[:, :3].sum(axis=1)
    assert np.ptp(total) < 1e-8 * max(run.energy_balance.in_play, 1e-3)


def test_a_ring_that_turns_as_it_falls():
    """A rigid plane net: its points stay on circles about its centre of mass, which falls freely."""
    scene, omega = flat_ring(), 5.0
    model, q = at_places(scene)
    m = naive.masses(model)
    centre = m @ q / m.sum()
    v = omega * np.cross([0.0, 0.0, 1.0], q - centre)
    run = simulate(scene, 1.0, method="links", rtol=1e-10, start=State(model, 0.0, q, v, np.zeros(model.n_segments)))
    x, c, s = (q - centre), np.cos(omega * run.t), np.sin(omega * run.t)
    exact = np.stack([np.outer(c, x[:, 0]) - np.outer(s, x[:, 1]), np.outer(s, x[:, 0]) + np.outer(c, x[:, 1])], axis=2)
    fallen = -0.5 * G * run.t**2
    # the tolerance of a step adds up over a run, and stray tensions of 1e-7 act across
    np.testing.assert_allclose(run.q[:, :, :2] - centre[:2], exact, atol=1e-6)
    np.testing.assert_allclose(run.q[:, :, 2], np.tile(fallen[:, None], (1, model.n)), atol=1e-6)
    assert REDUNDANT in run.warnings


def test_a_cable_that_cannot_push_is_left_to_edmc():
    """Of smallest tensions the lower half pushes: a cable that cannot push hangs from its upper point."""
    run = simulate(upright(compression="none"), 0.3, method="links", start="straight")
    assert run.ok and run.events[0].t == 0.0 and np.abs(run.q - run.q[0]).max() < 1e-8
    assert run.tension("a-b").min() > -1e-9 and np.isfinite(run.segment_tension).all()


@pytest.mark.parametrize("compression", ["none", "linear"])
def test_a_cable_across_gravity_is_refused(compression):
    """No tension keeps a cable straight that its weight bends, at any method."""
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable("a", "b", compression=compression)], [Gravity(G)])
    words = "needs cables that can give way to what pushes them sideways, but cable .a-b. is as long as the distance between points"
    with pytest.raises(InputError, match=words):
        simulate(scene, 0.1, method="links", start="straight")


def test_a_string_across_nothing_stays():
    """Without a load the same cable stays where it is, and one that is plucked is refused: it cannot move."""
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable("a", "b")], [ViscousDamping(1.0)])
    run = simulate(scene, 0.5, method="links", start="straight")
    assert run.ok and np.abs(run.q - run.q[0]).max() < 1e-12 and not np.abs(run.segment_tension).max() > 1e-12
    plucked = run.final
    plucked.v[plucked.model.nodes("a-b")[1:-1], 2] = 1.0
    with pytest.raises(InputError, match="needs cables that can give way to what pushes them sideways"):
        simulate(scene, 0.5, method="links", start=plucked)


@pytest.mark.parametrize("ramp", [pytest.param(0.0, marks=pytest.mark.slow), 0.5])
@pytest.mark.parametrize("method, options", [("links", {}), ("links5", {"dt": 0.001})])
def test_a_cable_that_is_pulled_straight(ramp, method, options):
    """It ends before it is straight, finite, with the lengths and the distance in a sentence."""
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Driven("b", paths.line((0.8, 0, 0), (0.2, 0, 0), ramp))],
        [cable("a", "b", segments=10, compression="none")], [Gravity(G)],
    )  # fmt: skip
    run = simulate(scene, 3.0, method=method, **options)
    straight_at = 1.0 + ramp / 2
    words = 'A cable with EA=inf must be longer than the distance between its ends, but cable "a-b" is 1 m long, and points "a" and'
    assert run.status == "unconverged" and run.method == method
    assert re.search(words, run.message) and straight_at - 0.02 < run.t[-1] <= straight_at + 1e-9
    for array in (run.q, run.v, run.energy, run.segment_tension):
        assert np.isfinite(array).all()
