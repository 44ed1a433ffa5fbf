"""Test systems: small nets of every topology, and motions that carry their own closed form.

A `Motion` starts from ``q0, v0`` and moves every node by a sum of modes whose amplitudes obey x'' + d x' + omega^2 x = 0,
which `exact` evaluates; nothing in it comes from the code under test but the numbering of the nodes.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from anet_lumped import Cable, Driven, Fixed, Free, Scene, State
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.mechanics.jacobian import sparse_jacobian
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths

MU = 0.1  # [kg/m]


def loose_cable(EA=1e4, zeta=0.05, segments=20, **kwargs):
    """A metre of cable held at one end; "straight" has it lie level."""
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, zeta=zeta, segments=segments, **kwargs)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))], [cable], [Gravity()])


def four_cables(EA=1e4, zeta=0.05, segments=20, carried=False, **kwargs):
    """The net of the thesis: four cables from the corners of a square to a payload, held or carried along x."""
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    points = [
        Driven(f"s{i}", paths.line(at, (0.2, 0.0, 0.0), ramp=1.0)) if carried else Fixed(f"s{i}", at)
        for i, at in enumerate(corners)
    ]
    made = dict(length=1.0, mass_per_length=MU, EA=EA, zeta=zeta, segments=segments, **kwargs)
    return Scene([*points, Free("p0", mass=0.036)], [Cable(f"s{i}", "p0", **made) for i in range(4)], [Gravity()])


def _net(fixed, free, links, effects=None, **kwargs):
    made = dict(length=1.0, mass_per_length=MU, EA=1e3, zeta=0.1) | kwargs
    cables = [Cable(a, b, segments=n, name=f"{a}-{b}-{i}", **made) for i, (a, b, n) in enumerate(links)]
    return Scene([*(Fixed(x, (0, 0, 0)) for x in fixed), *(Free(x, 0.01) for x in free)], cables, effects or [Gravity()])


def mesh(rows, columns, segments):
    """A rectangular mesh of free points, held at its corners."""
    free = [f"{i},{j}" for i in range(rows) for j in range(columns)]
    links = [(f"{i},{j}", f"{i},{j + 1}", segments) for i in range(rows) for j in range(columns - 1)]
    links += [(f"{i},{j}", f"{i + 1},{j}", segments) for i in range(rows - 1) for j in range(columns)]
    corners = [(f"s{n}", f"{i},{j}", 1) for n, (i, j) in enumerate(itertools.product((0, rows - 1), (0, columns - 1)))]
    return _net([s for s, _, _ in corners], free, links + corners)


def nets(**kwargs):
    """Nets of every topology that the elimination must cope with, by name."""
    return {
        "between supports": _net("ab", "", [("a", "b", 6)], **kwargs),
        "loose end": _net("a", "x", [("a", "x", 7)], **kwargs),
        "loose end, reversed": _net("a", "x", [("x", "a", 7)], **kwargs),
        "one segment": _net("a", "x", [("a", "x", 1)], **kwargs),
        "two segments": _net("a", "x", [("x", "a", 2)], **kwargs),
        "string of cables": _net("a", "xyz", [("a", "x", 3), ("x", "y", 4), ("z", "y", 2)], **kwargs),
        "junction": _net("abcd", "x", [("a", "x", 3), ("x", "b", 5), ("c", "x", 1), ("d", "x", 2)], **kwargs),
        "parallel": _net("a", "xy", [("a", "x", 2), ("x", "y", 3), ("x", "y", 4), ("y", "x", 1)], **kwargs),
        "loop": _net("a", "xyz", [("a", "x", 2), ("x", "y", 3), ("y", "z", 1), ("z", "x", 4)], **kwargs),
        "flying": _net("", "xyz", [("x", "y", 3), ("y", "z", 4)], **kwargs),
        "wheel": _net(
            "", "hpqrs", [(a, b, n) for n, (a, b) in enumerate(["hp", "qh", "hr", "sh", "pq", "qr", "sr", "sp"], 1)], **kwargs
        ),
    }  # fmt: skip


def scatter(model, rng, size=1.0):
    """(n, 3) random places with segments between a third and twice `size` of their rest length [m]: slack and taut ones."""
    q = np.zeros((model.n, 3))
    for cable in model.scene.cables:
        nodes = model.nodes(cable.name)
        turn = rng.normal(size=(len(nodes), 3))
        turn *= cable.L0 * rng.uniform(1 / 3, 2.0, (len(nodes), 1)) / np.linalg.norm(turn, axis=1)[:, None]
        q[nodes] = q[nodes[0]] + size * np.cumsum(turn, axis=0)
    return q


@dataclass(frozen=True)
class Motion:
    """A scene, where it starts, and its motion along x in closed form; `axial` if segments stretch in it.

    Explicit schemes are stable with ``steps`` steps or more.
    """

    scene: Scene
    q0: np.ndarray
    v0: np.ndarray
    exact: Callable  # t -> x, v of the moving nodes, (n_free,) [m], [m/s]
    axial: bool
    t_end: float
    steps: int

    @property
    def start(self):
        """State to start from."""
        model = build(self.scene)
        return State(model, 0.0, self.q0, self.v0, np.zeros(model.n_segments))


def oscillator(t, omega, damping, x0, v0):
    """Solution of x'' + damping x' + omega^2 x = 0 and its derivative, arrays over modes; underdamped."""
    s = damping / 2
    w = np.sqrt(omega**2 - s**2)
    b = (v0 + s * x0) / w
    c, d, e = np.cos(w * t), np.sin(w * t), np.exp(-s * t)
    x = e * (x0 * c + b * d)
    return x, e * w * (b * c - x0 * d) - s * x


def _modal(rest, mass, K, damping, x0, v0):
    """Motion about `rest` of diag(mass) x'' + ... + K x = 0; ``damping(omega)`` [1/s] is that of a mode."""
    root = np.sqrt(mass)
    square, modes = np.linalg.eigh(K / np.outer(root, root))
    omega = np.sqrt(square)
    a, b, d = modes.T @ (root * x0), modes.T @ (root * v0), damping(omega)

    def exact(t):
        x, v = oscillator(t, omega, d, a, b)
        return rest + modes @ x / root, modes @ v / root

    return exact


def spring_mass(zeta=0.0, g=9.81):
    """A kilogram hung on one segment, bouncing along it (along x): omega = sqrt(k/m) about the stretch m g/k."""
    cable = Cable("a", "m", length=1.0, mass_per_length=0.02, EA=25.0, segments=1, zeta=zeta, compression="linear")
    effects = [Gravity(g, (1, 0, 0))] if g else []
    scene = Scene([Fixed("a", (0, 0, 0)), Free("m", mass=0.99)], [cable], effects)  # half a segment makes it one kilogram
    model, rest = build(scene), 1.0 + g / 25.0
    q0, v0 = np.zeros((2, 3)), np.zeros((2, 3))
    q0[model.node("m"), 0], v0[model.node("m"), 0] = rest + 0.2, 0.4
    exact = _modal(
        np.array([rest]), np.ones(1), np.array([[25.0]]), lambda w: np.full(1, cable.dashpot),
        np.array([0.2]), np.array([0.4]),
    )  # fmt: skip
    return Motion(scene, q0, v0, exact, True, 1.0, 40)


def shaken_mass(zeta=0.1):
    """The same, hung from a point driven as s = A sin(Omega t): x'' = g - omega^2 (x - s - L) - d (x' - s')."""
    still = spring_mass(zeta)
    cable, rest = still.scene.cables[0], still.q0[:, 0].max() - 0.2
    A, frequency = 0.1, 1.3
    W, w2, d = 2 * np.pi * frequency, 25.0, cable.dashpot
    driven = Driven("a", paths.harmonic((0, 0, 0), (A, 0, 0), frequency))
    scene = Scene([driven, still.scene.points[1]], [cable], still.scene.effects)
    model = build(scene)
    # complex amplitude of the forced part: x = rest + Im(X exp(i W t)), then the free part from what is left at t = 0
    X = A * (w2 + 1j * W * d) / (w2 - W**2 + 1j * W * d)

    def exact(t):
        e = X * np.exp(1j * W * t)
        x, v = oscillator(t, 5.0, d, 0.2 - X.imag, 0.4 - W * X.real)
        return np.array([rest + e.imag + x]), np.array([W * e.real + v])

    v0 = still.v0.copy()
    v0[model.node("a"), 0] = A * W
    return Motion(scene, still.q0, v0, exact, True, 1.0, 40)


def axial_bar(loose, zeta=0.0, segments=6):
    """Axial vibration of the straight chain: fixed ends and pre-tensioned, or one end loose and two-way springs.

    omega_j = 2 sqrt(k/m) sin(j pi/2N) or, with half a mass at the loose end, 2 sqrt(k/m) sin((2j - 1) pi/4N): the test of
    the systems compares. Motion of the first and the third mode.
    """
    end = Free("b") if loose else Fixed("b", (1.3, 0, 0))
    law = "linear" if loose else "none"
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=10.0, segments=segments, zeta=zeta, compression=law)
    scene = Scene([Fixed("a", (0, 0, 0)), end], [cable])
    model, N = build(scene), segments
    x = np.linspace(0.0, 1.0 if loose else 1.3, N + 1)
    moving = slice(1, N + 1 if loose else N)
    mass, K = bar_matrices(N, loose, cable)
    phase = x[moving] / x[-1] * np.pi * (0.5 if loose else 1.0)
    x0, v0 = 0.02 * np.sin(phase) + 0.005 * np.sin(3 * phase), 0.2 * np.sin(phase)
    nodes = model.nodes("a-b")
    q0, u0 = np.zeros((N + 1, 3)), np.zeros((N + 1, 3))
    q0[nodes, 0] = x
    q0[nodes[moving], 0] += x0
    u0[nodes[moving], 0] = v0
    exact = _modal(x[moving], mass, K, lambda w: cable.dashpot / cable.stiffness * w**2, x0, v0)
    return Motion(scene, q0, u0, _in_order(exact, nodes[moving], model.n_free), True, 0.15, 40)


def bar_matrices(N, loose, cable):
    """Masses and stiffness of the straight chain of a cable, one end loose or both fixed."""
    B = np.eye(N, N + 1, 1) - np.eye(N, N + 1)
    B = B[:, 1:] if loose else B[:, 1:-1]
    mass = np.full(B.shape[1], cable.mass_per_length * cable.L0)
    if loose:
        mass[-1] /= 2
    return mass, cable.stiffness * B.T @ B


def hanging_matrices(cable, g, payload):
    """Masses, transverse stiffness and rest lengths of a hanging chain: T_j/l_j of each segment, stretched by what it carries."""
    N = cable.segments
    mass = np.full(N, cable.mass_per_length * cable.L0)
    mass[-1] = mass[-1] / 2 + payload
    T = g * np.cumsum(mass[::-1])[::-1]
    l = cable.L0 * (1.0 + T / cable.EA)
    B = np.eye(N, N + 1, 1) - np.eye(N, N + 1)
    B = B[:, 1:]
    return mass, B.T @ np.diag(T / l) @ B, l


def hanging_chain(rate=0.0, segments=5, payload=0.0, EA=40.0, zeta=0.3, amplitude=1e-4):
    """Small swings of a hanging chain in its first two modes, damped by the environment at a rate [1/s].

    The stretch at rest is the exact one; axial dampers do not act on small swings and keep axial noise down. What the
    motion has of third order in the amplitude is neglected: some 1e-7 of it at 1e-4 m, less than rounding at 1e-6 m.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, segments=segments, zeta=zeta)
    effects = [Gravity(), ViscousDamping(rate)] if rate else [Gravity()]
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=payload)], [cable], effects)
    model, N = build(scene), segments
    mass, K, l = hanging_matrices(cable, 9.81, payload)
    s = np.arange(1, N + 1) / N
    x0, v0 = amplitude * (s + np.sin(4 * s)), 4 * amplitude * s**2
    nodes = model.nodes("a-b")
    q0, u0 = np.zeros((N + 1, 3)), np.zeros((N + 1, 3))
    q0[nodes[1:], 2], q0[nodes[1:], 0], u0[nodes[1:], 0] = -np.cumsum(l), x0, v0
    exact = _modal(np.zeros(N), mass, K, lambda w: np.full(N, rate), x0, v0)
    return Motion(scene, q0, u0, _in_order(exact, nodes[1:], model.n_free), False, 0.4, 80)


def _in_order(exact, nodes, n_free):
    """`exact` with its entries in the order of the model's nodes."""

    def ordered(t):
        x, v = np.empty(n_free), np.empty(n_free)
        x[nodes], v[nodes] = exact(t)
        return x, v

    return ordered


MOTIONS = {
    "spring-mass": lambda amplitude: spring_mass(),
    "spring-mass, damped": lambda amplitude: spring_mass(0.1),
    "shaken mass": lambda amplitude: shaken_mass(),
    "axial bar, pre-tensioned": lambda amplitude: axial_bar(False),
    "axial bar, loose end": lambda amplitude: axial_bar(True),
    "axial bar, damped": lambda amplitude: axial_bar(True, 0.2),
    "hanging chain": lambda amplitude: hanging_chain(amplitude=amplitude),
    "hanging chain with payload, in drag": lambda amplitude: hanging_chain(2.0, payload=0.05, amplitude=amplitude),
}


def order_of_the_jacobian(model, q, v):
    """Order of what the Jacobian that stiff solvers of other packages get leaves of the accelerations, by Taylor: 2."""
    compiled, net, rng = system(model), fresh_net(model), np.random.default_rng(0)
    moves = [np.zeros((model.n, 3)) for _ in range(2)]
    for move in moves:
        move[: model.n_free] = rng.normal(size=(model.n_free, 3))
    slope = sparse_jacobian(model, net)(0.3, q, v) @ np.concatenate([move[: model.n_free].ravel() for move in moves])

    def acceleration(h):
        f = np.zeros((model.n, 3))
        compiled.force(0.3, q + h * moves[0], v + h * moves[1], net.address, f, np.zeros(2))
        return (f[: model.n_free] / model.mass[: model.n_free, None]).ravel()

    steps = 2.0 ** -np.arange(12, 19)
    left = [np.linalg.norm(acceleration(h) - acceleration(0.0) - h * slope[3 * model.n_free :]) for h in steps]
    return np.polyfit(np.log(steps), np.log(left), 1)[0]
