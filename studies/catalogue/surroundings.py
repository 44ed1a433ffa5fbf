"""Cables in what surrounds them: through the surface of water, in a gust, in drag beyond their weight, stiff in bending, falling
onto the ground, broken under load, paid out until they are slack."""

import itertools
import math

import numpy as np

from anet_lumped import Cable, Driven, Fixed, Free, Scene, effects, equilibrium
from anet_lumped.prescribed import paths, signals
from studies.catalogue.case import ACCURACY, LOAD, MOMENTUM, REST, Case, Statement, at_time, largest_tension
from studies.catalogue.supports import at_positions

G, AIR, WATER = 9.81, 1.225, 1000.0  # [m/s^2], [kg/m^3]


def through_surface(v, height):
    """A net of 2 mm twine goes straight through the surface with its corners: no twine bears more than the whole net's drag."""
    points, cables, side, n = [], [], 0.25, 2
    made = dict(length=0.255, mass_per_length=0.004, EA=2e3, zeta=0.05, diameter=0.002, segments=4)
    for i, j in itertools.product(range(n + 1), repeat=2):
        at, corner = (side * i, side * j, height), i in (0, n) and j in (0, n)
        points.append(Driven(f"{i},{j}", paths.line(at, (0, 0, v), ramp=0.2)) if corner else Free(f"{i},{j}"))
        cables += [Cable(f"{i},{j}", f"{i + 1},{j}", **made)] if i < n else []
        cables += [Cable(f"{i},{j}", f"{i},{j + 1}", **made)] if j < n else []
    drag = 0.5 * WATER * len(cables) * 0.255 * 0.002 * 1.2 * v**2

    def judge(run):
        # its corners bear it at a slope of one in two or more, two twines each
        yield Statement(LOAD, "largest tension over the drag of the whole net", largest_tension(run) / drag, most=1.0)
        z = run.q[:, :, 2]
        below = run.position("0,0")[-1, 2] - run.position("1,1")[-1, 2]
        yield Statement(LOAD, "depth of the middle below the corners at the end", below, -0.51, 0.51, unit="m")
        yield Statement(ACCURACY, "way through the surface", np.ptp(z), least=0.6, unit="m")

    way = "into" if v < 0.0 else "out of"
    scene = Scene(points, cables, [effects.Gravity(G), effects.Water(WATER)])
    return Case(f"A net is carried {way} water at {abs(v):g} m/s: no tension beyond its drag.", scene, 0.9, judge,
                measure=lambda run: run.position("1,1")[-1], tolerance=0.05)  # fmt: skip


def gust():
    """A gust of 20 m/s blows on a slack cable and is over: it comes back to the sag that it had.

    No more pull than a snap at the speed of the wind, v sqrt(EA mu).
    """
    cable = Cable("a", "b", length=1.2, mass_per_length=0.05, EA=1e4, zeta=0.1, diameter=0.01, segments=20)
    from anet_lumped.effects.flow.wind import Gust

    winds = Gust((0.0, 20.0, 0.0), 0.1, 0.2)
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable], [effects.Gravity(G), effects.Air(AIR, wind=winds)])
    rest, snap = equilibrium(scene), 20.0 * math.sqrt(1e4 * 0.05)

    def judge(run):
        aside = run.shape("a-b")[:, 10, 1]
        yield Statement(LOAD, "largest tension over that of a snap at the speed of the wind", largest_tension(run) / snap, most=1.0)
        yield Statement(LOAD, "farthest the middle is blown aside", aside.max(), 0.15, 0.4, unit="m")  # its sag is 0.28 m
        above = run.shape("a-b")[run.t > 15.0, 10, 2].mean() - rest.shape("a-b")[10, 2]
        yield Statement(REST, "mean height of the middle in the end less that at rest", above, -0.01, 0.03, unit="m")

    return Case(
        "A gust of 20 m/s meets a slack cable: it is blown aside and comes back to its sag.",
        scene,
        20.0,
        judge,
        save_every=0.02,
        measure=at_time(0.3, lambda run: run.shape("a-b")[:, 10]),
        tolerance=0.01,
        energy_is_fed_in=True,
    )


def drag_beyond_weight():
    """A level cable thrown down at 5 m/s whose drag at 1 m/s is a thousand times its weight: it sinks at its terminal velocity.

    v^2 = 2 mu g/(rho Cd d).
    """
    mu, Cd, d = 0.1, 1600.0, 1.0
    cable = Cable("a", "b", length=1.0, mass_per_length=mu, EA=1e4, zeta=0.05, diameter=d, Cdn=Cd, Cdt=500.0, segments=20)
    scene = Scene([Free("a", at=(0, 0, 0)), Free("b", at=(1, 0, 0))], [cable], [effects.Gravity(G), effects.Air(AIR)])
    s = np.linspace(0.0, 1.0, 21)
    v = math.sqrt(2.0 * mu * G / (AIR * Cd * d))

    def judge(run):
        mass = run.model.mass[:, None]
        sinking = -(mass * run.v).sum(axis=1)[:, 2] / mass.sum()
        yield Statement(ACCURACY, "speed of sinking over the terminal one", sinking[-1] / v, 0.99, 1.01)
        later = run.t > 0.05  # a first step as long as 400 times what drag takes to stop it may throw it farther up than it fell
        yield Statement(LOAD, "largest speed after 0.05 s", np.abs(run.v[later]).max(), most=5.0, unit="m/s")
        yield Statement(MOMENTUM, "way to the side", np.abs(run.q[:, :, 1]).max(), most=1e-9, unit="m")

    return Case("Drag a thousand times the weight at 1 m/s: a cable thrown down sinks at its terminal velocity.", scene, 1.0, judge,
                start=lambda: at_positions(scene, {"a-b": np.column_stack([s, 0 * s, 0 * s])}, speed=(0, 0, -5.0)),
                measure=lambda run: run.q[-1], tolerance=0.01)  # fmt: skip


def bending_dominates():
    """A cantilever of EI = 1 kN m^2 is let go under its weight: it swings about mu g L^4/(8 EI), to twice that and no farther."""
    EI, mu = 1e3, 0.1
    cable = Cable("a", "b", length=1.0, mass_per_length=mu, EA=1e4, EI=EI, zeta=0.05, segments=20, compression="linear")
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))], [cable], [effects.Gravity(G), effects.Bending({"a": (1, 0, 0)})]
    )
    static = mu * G / (8.0 * EI)

    def judge(run):
        down = -run.position("b")[:, 2] / static
        yield Statement(LOAD, "greatest deflection over that at rest", down.max(), 1.0, 2.2)
        yield Statement(REST, "mean deflection over that at rest", down[run.t > 0.1].mean(), 0.9, 1.1)
        yield Statement(LOAD, "stretch of the end", abs(run.position("b")[-1, 0] - 1.0), most=1e-3, unit="m")

    return Case("Bending so stiff that it dominates: a cantilever is let go and swings about its static deflection.", scene, 0.5,
                judge, start="straight", measure=lambda run: -run.position("b")[run.t > 0.1, 2].mean() / static, tolerance=0.05,
                unit="")  # fmt: skip


def onto_the_ground():
    """While a chain falls straight onto the ground, that bears three times the weight that has landed.

    Its weight and the momentum that it takes, mu v^2 = 2 mu g s; the impulse given is mu g^2 t^3/2.
    """
    mu, segments, end = 0.1, 100, math.sqrt(2.0 / G)
    cable = Cable("a", "b", length=1.0, mass_per_length=mu, EA=1e3, zeta=0.5, diameter=1e-3, segments=segments)
    scene = Scene([Free("a"), Free("b")], [cable], [effects.Gravity(G), effects.Ground(0.0, 1e6, 3e4)])
    s = np.linspace(0.0, 1.0, segments + 1)

    def judge(run):
        impulse = (run.model.mass[:, None] * run.v).sum(axis=1)[:, 2] + mu * G * run.t
        late = run.t > 0.6 * end
        ratio = impulse[late] / (0.5 * mu * G**2 * run.t[late] ** 3)
        yield Statement(LOAD, "least impulse of the ground over that of three times what has landed", ratio.min(), 0.9, 1.1)
        yield Statement(LOAD, "largest of them", ratio.max(), 0.9, 1.1)

    return Case("A chain falls onto the ground: the force is three times the weight that has landed.", scene, 0.9 * end, judge,
                start=lambda: at_positions(scene, {"a-b": np.column_stack([0 * s, 0 * s, s])}), dt=5e-4, save_every=1e-3,
                measure=lambda run: run.position("b")[-1], tolerance=0.01)  # fmt: skip


def breaks():
    """One of the four cables of a net breaks under a load that grows to 5 N: at its limit, and the other three hold."""
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    made = dict(length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=20)
    cables = [Cable(f"s{i}", "p0", breaking_tension=None if i else 4.0, **made) for i in range(4)]
    points = [*(Fixed(f"s{i}", at) for i, at in enumerate(corners)), Free("p0", mass=0.036)]
    scene = Scene(points, cables, [effects.Gravity(G), effects.Load((0.0, 0.0, -5.0), ramp=1.0)])

    def judge(run):
        yield Statement(ACCURACY, "breaks of a cable", float(bool(run.events)), 1.0, 1.0)
        first = run.events[0] if run.events else None
        yield Statement(ACCURACY, "tension at which it breaks over its limit", first.tension / 4.0 if first else 0.0, 0.999, 1.05)
        aside = run.position("p0")[-1, :2].min()
        yield Statement(LOAD, "way of the middle from the corner that let go", aside, 0.02, 0.6, unit="m")

    return Case("A cable of a net breaks under load: at its limit, and the others take the net over.", scene, 0.75, judge,
                measure=at_time(0.5, lambda run: run.position("p0")), tolerance=0.02, energy_is_fed_in=True)  # fmt: skip


def paid_out(taut):
    """A line is paid out until it pulls no more: a span that sags, or a payload that falls freely beside it and is caught."""
    made = dict(length=2.0, mass_per_length=0.05, EA=1e4, segments=10)
    far = Fixed("b", (2.01, 0, 0)) if taut else Free("b", 1.0)
    by = signals.samples((0.0, 1.0), (0.0, 0.5)) if taut else signals.samples((0.0, 0.25), (0.0, 1.0))
    cable = Cable("a", "b", zeta=0.5 if taut else 0.2, **made)
    scene = Scene([Fixed("a", (0, 0, 0)), far], [cable], [effects.Gravity(G), effects.LineChange({"a-b": by})])

    def judge(run):
        if taut:
            yield Statement(LOAD, "least tension", run.tension("a-b").min(), most=1.0, unit="N")
            sag = -run.shape("a-b")[-1, 5, 2]
            yield Statement(LOAD, "sag", sag, 0.4, 0.9, unit="m")
        else:
            z, free = run.position("b")[:, 2], run.t <= 0.4
            lag = np.abs(z[free] - z[0] + 0.5 * G * run.t[free] ** 2).max()
            # when let go, the stretch of 2 mm throws it up at 2 mm sqrt(k/m) = 0.14 m/s at most
            yield Statement(ACCURACY, "way off free fall", lag, most=0.06, unit="m")
            yield Statement(LOAD, "depth", -z.min(), 2.9, 3.1, unit="m")

    what = "a taut span comes to sag" if taut else "a payload falls freely until it is caught"
    return Case(
        f"A line is paid out until it pulls no more: {what}.",
        scene,
        1.0,
        judge,
        measure=at_time(0.4, lambda run: run.shape("a-b")[:, -1 if not taut else 5]),
        tolerance=0.02,
        energy_is_fed_in=True,
    )


CASES = {
    "water, into at 2 m/s": lambda: through_surface(-2.0, 0.6),
    "water, out of at 2 m/s": lambda: through_surface(2.0, -0.8),
    "gust on a slack cable": gust,
    "drag beyond weight": drag_beyond_weight,
    "bending dominates": bending_dominates,
    "chain onto the ground": onto_the_ground,
    "a cable of a net breaks": breaks,
    "paid out, a taut span": lambda: paid_out(True),
    "paid out, a payload": lambda: paid_out(False),
}
