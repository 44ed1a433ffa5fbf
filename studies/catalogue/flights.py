"""Nets that nothing holds: momentum is kept, the centre of mass falls freely, quadrotors pull on what joins them."""

import itertools
import math

import numpy as np

from anet_lumped import Cable, Fixed, Free, Scene, State, equilibrium
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.model.build import build
from anet_lumped.motion.simulate import simulate
from anet_lumped.results.state import segment_tensions
from integrators import schemes
from integrators.schemes.record import Stepping
from studies.catalogue.case import ACCURACY, LOAD, MOMENTUM, REST, SPIN, Case, Statement, largest_tension, position_at_end, weight
from studies.catalogue.swings import ANGLE, centre_of_mass, pendulum, released

G, MU = 9.81, 0.1  # [m/s^2], [kg/m]


def momenta(run):
    """Momentum and angular momentum about the origin at the saved times, (k, 3) each [kg m/s], [kg m^2/s]."""
    model = run.model
    m = model.mass[: model.n_free, None]
    q, v = run.q[:, : model.n_free], run.v[:, : model.n_free]
    return (m * v).sum(axis=1), (m * np.cross(q, v)).sum(axis=1)


def momentum_statements(run, acceleration=(0.0, 0.0, 0.0)):
    """That momentum changes by the weight alone, and without weight that angular momentum is kept."""
    a = np.asarray(acceleration)
    model = run.model
    M = model.mass[: model.n_free].sum()
    P, L = momenta(run)
    speed = np.abs(run.v).max()
    scheme = schemes.scheme(run.method)
    off = np.abs(P - P[0] - M * (run.t - run.t[0])[:, None] * a).max() / (M * speed)
    # of Newton's tolerance, 1e-6 of the largest force on a node, some hundred steps leave this at most
    yield Statement(MOMENTUM, "drift of momentum over mass times largest speed", off, most=1e-5 if scheme.own else 1e-3)
    if not a.any():
        size = (np.abs(run.q).max() * M * speed) or 1.0
        most = 1e-5 if scheme.keeps_angular_momentum else 1e-2
        yield Statement(SPIN, "drift of angular momentum over its scale", np.abs(L - L[0]).max() / size, most=most)


def state(scene, q, v):
    model = build(scene)
    return State(model, 0.0, q, v, segment_tensions(model, q, v))


def falls_as_a_stone(run, nodes, G):
    """That the centre of mass of some nodes falls freely."""
    m, t = run.model.mass[nodes, None], run.t[:, None]
    middle = (m * run.q[:, nodes]).sum(axis=1) / m.sum()
    v0 = (m * run.v[0, nodes]).sum(axis=0) / m.sum()
    off = np.abs(middle - middle[0] - v0 * t - 0.5 * t**2 * (0, 0, -G)).max()
    most = 0.5 * G * run.dt * run.t[-1] + 1e-6  # symplectic and backward Euler: g h t/2 by themselves
    exact = schemes.scheme(run.method).order != 1
    yield Statement(MOMENTUM, "centre of mass off a stone's fall", off, most=1e-5 if exact else most, unit="m")


def loop():
    """A ring of four cables turns about its middle in no gravity: as a hoop it pulls itself with T = mu omega^2 R^2."""
    omega, n = 20.0, 10
    names = "pqrs"
    links = [(names[i], names[(i + 1) % 4]) for i in range(4)]
    length = 0.5 * math.pi / 2
    cables = [Cable(a, b, length=length, mass_per_length=MU, EA=1e4, zeta=0.05, segments=n) for a, b in links]
    scene = Scene([Free(name) for name in names], cables)
    N = 4 * n
    # a polygon whose segments carry T: the mass of a node times omega^2 R = 2 T sin(pi/N), their length 2 R sin(pi/N)
    s, m, L0, k = math.sin(math.pi / N), MU * length / n, length / n, 1e4 * n / length
    R = L0 / (2 * s - m * omega**2 / (2 * s * k))
    T = m * omega**2 * R / (2 * s)

    def start():
        model = build(scene)
        q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
        for c, cable in enumerate(cables):
            angle = 2 * math.pi * (c * n + np.arange(n + 1)) / N
            nodes = model.nodes(cable.name)
            q[nodes] = R * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
            v[nodes] = omega * R * np.column_stack([-np.sin(angle), np.cos(angle), 0 * angle])
        return state(scene, q, v)

    def judge(run):
        yield from momentum_statements(run)
        radius = np.linalg.norm(run.q, axis=2)
        yield Statement(LOAD, "largest change of the ring's radius over it", np.abs(radius / R - 1).max(), most=0.02)
        last = np.concatenate([run.final.tension(cable.name) for cable in cables])
        yield Statement(LOAD, "mean tension at the end over that of the turning polygon", last.mean() / T, most=1.1)
        yield Statement(ACCURACY, "mean tension at the end over that of the turning polygon", last.mean() / T, least=0.9)

    return Case("A ring of cables turns freely in no gravity: its hoop tension, momentum and spin are kept.", scene, 0.5, judge,
                start=start, dt=2e-3,
                measure=lambda run: np.linalg.norm(run.q, axis=2).mean() / R, tolerance=1e-3, unit="")  # fmt: skip


def mesh(n):
    """Points, cables and positions of a square net of n by n meshes, half a metre wide."""
    names = {(i, j): f"{i},{j}" for i in range(n + 1) for j in range(n + 1)}
    side = 0.5 / n
    made = dict(length=side, mass_per_length=0.02, EA=1e3, zeta=0.1, segments=2)
    cables = [Cable(names[i, j], names[i, j + 1], **made) for i in range(n + 1) for j in range(n)]
    cables += [Cable(names[i, j], names[i + 1, j], **made) for i in range(n) for j in range(n + 1)]
    positions = {name: (side * i, side * j, 0.0) for (i, j), name in names.items()}
    return names, cables, positions


def held_net():
    """A net of 10 by 10 meshes held at its corners, let go level: it comes to rest in drag where statics puts it."""
    names, cables, positions = mesh(10)
    corners = {names[i, j] for i, j in itertools.product((0, 10), (0, 10))}
    points = [Fixed(n, positions[n]) if n in corners else Free(n, 0.001, at=positions[n]) for n in names.values()]
    scene = Scene(points, cables, [Gravity(G), ViscousDamping(5.0)])

    def judge(run):
        rest = equilibrium(scene)
        off = np.abs(run.q[-1] - rest.q).max()
        yield Statement(REST, "last position of any node off its rest", off, most=5e-3, unit="m")
        model = run.model
        up = 0.0
        for name in corners:  # what the supports carry is the weight
            for cable in cables:
                if name in (cable.start, cable.end):
                    shape, T = run.final.shape(cable.name), run.final.tension(cable.name)
                    d, pull = (shape[1] - shape[0], T[0]) if cable.start == name else (shape[-2] - shape[-1], T[-1])
                    up -= pull * d[2] / np.linalg.norm(d)
        carried = model.mass[: model.n_free].sum() * G
        yield Statement(REST, "last pull on the corners over the weight of what moves", up / carried, 0.97, 1.03)

    return Case("A net of 10 by 10 meshes held at its corners comes to rest where statics puts it.", scene, 4.0, judge,
                start="straight", dt=0.01, measure=lambda run: run.q[-1], tolerance=5e-3)  # fmt: skip


def flying_net():
    """A net of 10 by 10 meshes, thrown in a turn with a dent, in free fall: its centre of mass falls as a stone."""
    names, cables, positions = mesh(10)
    scene = Scene([Free(n, 0.001) for n in names.values()], cables, [Gravity(G)])

    def start():
        model = build(scene)
        q = np.zeros((model.n, 3))
        for cable in cables:
            a, b = np.array(positions[cable.start]), np.array(positions[cable.end])
            q[model.nodes(cable.name)] = a + np.linspace(0, 1, 3)[:, None] * (b - a)
        q -= (0.25, 0.25, 0.0)
        v = 6.0 * np.cross((0.0, 0.0, 1.0), q) + (1.0, 0.0, 3.0)
        v[:, 2] += 2.0 * np.exp(-((q[:, 0] / 0.1) ** 2 + (q[:, 1] / 0.1) ** 2))
        return state(scene, q, v)

    def judge(run):
        yield from momentum_statements(run, (0.0, 0.0, -G))
        yield from falls_as_a_stone(run, slice(0, run.model.n_free), G)

    return Case("A net of 10 by 10 meshes thrown in a turn, held by nothing: its centre of mass falls as a stone.", scene, 0.3,
                judge, start=start, measure=lambda run: centre_of_mass(run)[-1], tolerance=1e-3)  # fmt: skip


def free_cable():
    """A cable that nothing holds tumbles in no gravity, undamped and partly slack."""
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=1e4, segments=20)
    scene = Scene([Free("a"), Free("b")], [cable])

    def start():
        model = build(scene)
        s = np.linspace(0.0, 1.0, 21)
        q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
        q[model.nodes("a-b")] = np.column_stack([s, 0.05 * np.sin(9 * s), 0.03 * np.cos(7 * s)])
        v[model.nodes("a-b")] = np.column_stack([0.5 * np.sin(11 * s), 4 * s * (1 - s), 2 * np.cos(3 * s)])
        return state(scene, q, v)

    return Case(
        "A slack cable that nothing holds tumbles in no gravity: momentum and spin are kept.",
        scene,
        0.4,
        momentum_statements,
        start=start,
        measure=lambda run: centre_of_mass(run)[-1],
        tolerance=1e-5,
    )


def quadrotors(EA):
    """Two quadrotors of 1 kg, free, fly apart at 1 m/s each in no gravity: the cable between them snaps taut and returns.

    Two masses on a spring: the peak is v sqrt(k m_red), v = 2 m/s, m_red = 1/2 kg, the cable's 10 g aside.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=0.01, EA=EA, segments=10)
    scene = Scene([Free("a", mass=1.0), Free("b", mass=1.0)], [cable])
    peak = 2.0 * math.sqrt(EA * 0.5)
    half_period = math.pi / math.sqrt(EA / 0.5)
    slack = 0.05  # of the length, to be taken up first

    def start():
        model = build(scene)
        q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
        s = np.linspace(-0.5, 0.5, 11)
        q[model.nodes("a-b"), 0] = (1 - slack) * s
        v[model.nodes("a-b"), 0] = 2.0 * s
        return state(scene, q, v)

    def judge(run):
        yield from momentum_statements(run)
        yield Statement(ACCURACY, "peak tension over v sqrt(k m)", largest_tension(run) / peak, 0.95, 1.1)
        back = run.velocity("a")[-1, 0]
        yield Statement(ACCURACY, "speed of return over that of approach", back / 1.0, 0.9, 1.01)

    t_end = slack / 2.0 + 1.5 * half_period
    return Case(f"Two quadrotors of 1 kg fly apart, EA = {EA:.0e} N: the snap of two masses on a spring, and back.", scene, t_end,
                judge, start=start, dt=half_period / 40,
                measure=lambda run: run.velocity("a")[-1], tolerance=0.03, unit="m/s")  # fmt: skip


def lifted_by_masses():
    """Four free quadrotors of 1 kg on the corners of a net of cables with a payload, all dropped: nobody feels a weight."""
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    points = [Free(f"s{i}", mass=1.0) for i in range(4)]
    cables = [Cable(f"s{i}", "p0", length=1.0, mass_per_length=MU, EA=1e4, zeta=0.05, segments=20) for i in range(4)]
    scene = Scene([*points, Free("p0", mass=0.036)], cables, [Gravity(G)])
    held = Scene([*(Fixed(f"s{i}", at) for i, at in enumerate(corners)), Free("p0", mass=0.036)], cables, [Gravity(G)])

    def start():
        rest = equilibrium(held)
        model = build(scene)
        q = np.zeros((model.n, 3))
        for cable in cables:
            q[model.nodes(cable.name)] = rest.shape(cable.name)
        return state(scene, q, np.zeros_like(q))

    def judge(run):
        yield from momentum_statements(run, (0.0, 0.0, -G))
        still = max(equilibrium(held).tension(cable.name).max() for cable in cables)
        yield Statement(LOAD, "largest tension over that held", largest_tension(run) / still, 0.5, 3.0)
        yield Statement(LOAD, "largest tension at the end over the weight", _last(run) / weight(scene), most=0.1)

    return Case("Four free quadrotors of 1 kg with a net and its payload are dropped: all fall together.", scene, 0.4, judge,
                start=start, measure=position_at_end("p0"), tolerance=0.02)  # fmt: skip


def apart():
    """A swing, and a cable joined to nothing that flies beside it: neither knows of the other."""
    swing = pendulum()
    other = Cable("c", "d", length=1.0, mass_per_length=MU, EA=1e4, zeta=0.05, segments=10)
    scene = Scene([*swing.points, Free("c"), Free("d", mass=0.01)], [*swing.cables, other], [Gravity(G)])
    alone = released(swing, ANGLE)

    def start():
        model = build(scene)
        q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
        q[model.nodes("a-b")] = alone.shape("a-b")
        q[model.nodes("c-d")] = np.linspace(0.0, 1.0, 11)[:, None] * (0.6, 0.0, 0.8) + (0.0, 2.0, 0.0)
        v[model.nodes("c-d")] = (1.0, -2.0, 3.0)
        return state(scene, q, v)

    def judge(run):
        nodes = run.model.nodes("c-d")
        yield from falls_as_a_stone(run, nodes, G)
        yield Statement(LOAD, "largest tension in what flies, over its weight", run.tension("c-d").max() / 1.1, most=1e-2)
        step_choosing = schemes.scheme(run.method).stepping is not Stepping.FIXED
        own = {} if step_choosing else {"dt": run.dt, "extrapolate": run.extrapolated}
        by_itself = simulate(swing, run.t[-1], method=run.method, start=alone, **own)
        off = np.abs(run.position("b")[-1] - by_itself.position("b")[-1]).max()
        # Newton's tolerance, 1e-6 of the force on a node in every step, or that of the solver that chooses its steps
        yield Statement(
            MOMENTUM, "position of the swing off that of the swing alone", off, most=1e-4 if step_choosing else 1e-5, unit="m"
        )

    return Case("A swing, and a cable joined to nothing that flies beside it: each as if it were alone.", scene, 0.4, judge,
                start=start, dt=5e-3, measure=position_at_end("b"), tolerance=5e-3)  # fmt: skip


def _last(run):
    return max(run.final.tension(cable.name).max() for cable in run.scene.cables)


CASES = {
    "ring in free turn": loop,
    "net 10 x 10, held": held_net,
    "net 10 x 10, thrown": flying_net,
    "cable in free flight": free_cable,
    "quadrotors apart, 1e3 N": lambda: quadrotors(1e3),
    "quadrotors apart, 1e6 N": lambda: quadrotors(1e6),
    "quadrotors drop a net": lifted_by_masses,
    "swing and a cable apart": apart,
}
