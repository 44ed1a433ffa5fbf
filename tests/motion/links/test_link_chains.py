"""Chains of links: the folded chain that falls, Irvine's modes, free flight, and what is kept for a minute."""

import itertools
import math

import dense_links as dense
import naive
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from systems import four_cables, nets

from anet_lumped import Cable, Fixed, Free, Scene, State, equilibrium, simulate
from anet_lumped.effects import Gravity
from anet_lumped.model.build import build

G = 9.81


def hung(span, segments, length=1.0, mass_per_length=0.2, compression="none"):
    """A cable between two supports at the same height."""
    cable = Cable("a", "b", length=length, mass_per_length=mass_per_length, EA=math.inf, segments=segments, compression=compression)
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", (span, 0, 0))], [cable], [Gravity(G)])


def let_go(span, segments):
    """The chain that hung there, with its second end free."""
    held = hung(span, segments)
    rest = equilibrium(held)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", at=(span, 0, 0))], held.cables, held.effects)
    return scene, {"a-b": rest.shape("a-b")}


def time_to_fall(x):
    """Time in which the end of a folded chain of unit length falls by x, if energy is kept: x'^2 = g x (2 - x)/(1 - x).

    Source: Calkin & March, Am. J. Phys. 57 (1989) 154.
    """
    return quad(lambda s: 2.0 * s * math.sqrt((1 - s * s) / (G * s * s * (2 - s * s))), 0.0, math.sqrt(x))[0]  # x = s^2


@pytest.mark.slow
def test_a_folded_chain_falls_faster_than_free():
    """Ahead of free fall by far, and nearer to the motion of a thin fold the nearer its ends are: of second order in the span.

    The fold holds as many links each time. Tensions stay far below those of the whip at the end, and none pushes.
    """
    off = []
    for span, segments in ((0.32, 40), (0.16, 80), (0.08, 160)):
        scene, shape = let_go(span, segments)
        run = simulate(scene, 0.36, method="links", rtol=1e-9, start=shape, save_every=0.001)
        fallen = -run.position("b")[:, 2]
        assert run.ok and run.events == () and run.tension("a-b").min() > 0.0 and run.tension("a-b").max() < 6 * 0.2 * G
        assert fallen[-1] > 1.2 * 0.5 * G * 0.36**2
        off.append(np.interp(0.7, fallen, run.t) / time_to_fall(0.7) - 1.0)
    assert abs(off[-1]) < 2e-3
    np.testing.assert_allclose(np.divide(off[:-1], off[1:]), 4.0, rtol=0.2)


def test_the_support_of_a_falling_chain_feels_what_its_momentum_says():
    """Weight less the change of momentum, over the fall; T at the support is several times the weight in the end."""
    scene, shape = let_go(0.16, 40)
    run = simulate(scene, 0.36, method="links", rtol=1e-10, start=shape, save_every=2e-5)
    m = naive.masses(run.model)
    e = run.shape("a-b")[:, 1] * 40  # direction of the first link
    T = run.tension("a-b")[:, 0]
    support = np.trapezoid(T * -e[:, 2], run.t)
    momentum = run.v[-1, :, 2] @ m - run.v[0, :, 2] @ m
    weight = G * m[: run.model.n_free].sum()  # the half link at the support does not move
    assert support == pytest.approx(momentum + weight * 0.36, abs=1e-5 * weight)  # trapezoidal rule, over turns of 5 ms a link
    assert T.max() > 1.8 * weight and T.min() > 0.0 and run.events == ()


def modes(rest):
    """Angular frequencies and shapes (n_free, 3) of small motions about a rest: masses, geometric stiffness, lengths kept."""
    model, q = rest.model, rest.q
    n = 3 * model.n_free
    K = np.zeros((model.n, 3, model.n, 3))
    T = np.concatenate([rest.tension(cable.name) for cable in model.scene.cables])
    for (cable, a, b), pull in zip(naive.segments(model), T, strict=True):
        e = (q[b] - q[a]) / cable.L0
        k = pull / cable.L0 * (np.eye(3) - np.outer(e, e))
        for i, j in itertools.product((a, b), repeat=2):
            K[i, :, j] += k if i == j else -k
    K = K.reshape(3 * model.n, -1)[:n, :n]
    root = np.sqrt(np.repeat(naive.masses(model)[: model.n_free], 3))
    B = dense.constraints(model, q)[:, :n] / root
    basis = np.linalg.svd(B)[2][np.linalg.matrix_rank(B) :].T
    square, shapes = np.linalg.eigh(basis.T @ (K / np.outer(root, root)) @ basis)
    return np.sqrt(square), (basis @ shapes / root[:, None]).T.reshape(-1, model.n_free, 3)


def in_plane(shape):
    return np.abs(shape[:, 1]).max() < 1e-6 * np.abs(shape).max()


def irvine(rest, span):
    """Frequencies of the first antisymmetric and symmetric mode in the plane of a shallow cable that does not stretch.

    omega = W/span sqrt(H/mu): W = 2 pi, and the first root of tan(W/2) = W/2. Source: Irvine, Cable Structures (1981), 3.2.
    """
    H = abs(rest.tension("a-b")[0] * (rest.shape("a-b")[1] - rest.shape("a-b")[0])[0]) * 40
    of_string = math.sqrt(H / 0.2) / span
    return 2 * math.pi * of_string, brentq(
        lambda W: math.sin(W / 2) - W / 2 * math.cos(W / 2), 2.5 * math.pi, 2.95 * math.pi
    ) * of_string


def test_irvines_modes():
    """Modes of the lumped chain are within the error of 40 links and of a sag of 1/20: (sag/span)^2 and 1/N^2 times some 10."""
    span = 0.9935  # of a metre: a sag of about 1/20
    rest = equilibrium(hung(span, 40))
    omega, shapes = modes(rest)
    found = [w for w, shape in zip(omega, shapes, strict=True) if in_plane(shape)][:2]
    np.testing.assert_allclose(found, irvine(rest, span), rtol=0.03)


@pytest.mark.parametrize("which", [0, 1, 2, 5])
def test_small_motions_are_the_modes(which):
    """A sagging chain let go in a mode's shape: each node moves as the mode's cosine, for five of its periods."""
    rest = equilibrium(hung(0.8, 12))
    omega, shapes = modes(rest)
    amplitude = 1e-5
    shape = amplitude * shapes[which] / np.abs(shapes[which]).max()
    q = rest.q.copy()
    q[: rest.model.n_free] += shape
    L = dense.constant_lengths(rest.model).L
    for _ in range(3):  # lengths to second order in the amplitude, too
        d = np.array([q[b] - q[a] for _, a, b in naive.segments(rest.model)])
        step = np.linalg.lstsq(
            dense.constraints(rest.model, q)[:, : 3 * rest.model.n_free], L - np.linalg.norm(d, axis=1), rcond=None
        )
        q[: rest.model.n_free] += step[0].reshape(-1, 3)
    period = 2 * math.pi / omega[which]
    begin = State(rest.model, 0.0, q, np.zeros_like(q), rest.segment_tension)
    run = simulate(rest.scene, 5 * period, method="links", atol=1e-13, start=begin, save_every=period / 8)
    moved = (run.q - rest.q)[:, : rest.model.n_free]
    exact = np.cos(omega[which] * run.t)[:, None, None] * shape
    assert np.abs(moved - exact).max() < 1e-3 * amplitude  # of second order in the amplitude over L0 and the sag
    assert run.events == ()


@pytest.mark.parametrize("name", ["flying", "wheel"])
def test_free_flight(name):
    """Nets that fly and fall keep their momenta, energies and lengths; a weight adds m g t to the momentum."""
    made = nets(EA=math.inf, zeta=0.0, compression="linear", effects=[Gravity(G)])[name]
    model, rng = build(made), np.random.default_rng(5)
    q = dense.straight_lengths(model, rng)
    v = dense.keeping_lengths(model, q, rng.normal(size=q.shape))
    run = simulate(made, 2.0, method="links", rtol=1e-12, start=State(model, 0.0, q, v, np.zeros(model.n_segments)))
    m = naive.masses(model)
    momentum = np.einsum("i,kix->kx", m, run.v) - m.sum() * run.t[:, None] * [0, 0, -G]
    centre = np.einsum("i,kix->kx", m, run.q) / m.sum()
    about = np.einsum("i,kix->kx", m, np.cross(run.q - centre[:, None], run.v - (momentum / m.sum())[:, None]))
    size = m @ (v**2).sum(axis=1)
    assert run.ok and size > 0.1
    assert np.abs(momentum - momentum[0]).max() < 1e-10 * m.sum() * np.abs(v).max()
    assert np.abs(about - about[0]).max() < 1e-10 * size
    total = run.energy[:, :3].sum(axis=1)
    assert np.ptp(total) < 1e-10 * run.energy[:, 0].max()
    for cable in made.cables:
        assert np.abs(run.length(cable.name) - cable.length).max() < 1e-13


@pytest.mark.parametrize("method", ["links", "links5"])
def test_a_minute_of_the_carried_net(method):
    """Lengths to roundings, and the energy given by what carries it to the error of the steps."""
    options = dict(rtol=1e-8) if method == "links" else dict(dt=0.005)
    run = simulate(four_cables(math.inf, 0.0, carried=True, compression="linear"), 60.0, method=method, save_every=0.05, **options)
    assert run.ok
    for cable in run.scene.cables:
        links = np.linalg.norm(np.diff(run.shape(cable.name), axis=1), axis=2)
        assert np.abs(links - cable.L0).max() < 1e-14
    assert (
        np.abs(run.energy[:, :3].sum(axis=1) - run.energy[:, 3] - run.energy[0, :3].sum()).max() < 1e-6 * run.energy_balance.in_play
    )
    assert run.work.steps < (60_000 if method == "links" else 12_001)


def test_a_minute_of_a_chain_that_whips():
    """Ten two-way links, let go level: chaos, in which lengths are kept all the same, and the energy to the tolerance."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=math.inf, segments=10, compression="linear")
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))], [cable], [Gravity(G)])
    run = simulate(scene, 60.0, method="links", rtol=1e-9, start="straight", save_every=0.02)
    links = np.linalg.norm(np.diff(run.shape("a-b"), axis=1), axis=2)
    assert run.ok and np.abs(links - 0.1).max() < 1e-14
    total = run.energy[:, :3].sum(axis=1)
    assert np.abs(total - total[0]).max() < 1e-5 * run.energy_balance.in_play  # some 1e4 steps of 1e-9
