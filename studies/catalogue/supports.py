"""Supports that are hard: a taut span and one taut to 1e-9, none at all, and supports that jump, stop, shake and race."""

import math
from dataclasses import replace

import numpy as np

from anet_lumped import Cable, Driven, Fixed, Free, Scene, State, equilibrium
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from anet_lumped.results.state import segment_tensions
from studies.catalogue.case import (
    ACCURACY,
    BOUNDED_RISE,
    ENERGY,
    LOAD,
    MOMENTUM,
    REST,
    Case,
    Statement,
    at_time,
    largest_tension,
    must_not_gain_energy,
)

G, MU = 9.81, 0.1  # [m/s^2], [kg/m]


def span(width, *, EA=1e6, rate=0.0, zeta=0.05, segments=20):
    """A metre of cable between two supports `width` metres apart."""
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, zeta=zeta, segments=segments)
    effects = [Gravity(G), ViscousDamping(rate)] if rate else [Gravity(G)]
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", (width, 0, 0))], [cable], effects)


def at_positions(scene, positions, speed=(0.0, 0.0, 0.0)):
    """State with the cables' nodes at positions (segments + 1, 3) by cable, all moving with one velocity but for fixed ones."""
    model = build(scene)
    q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    for cable in scene.cables:
        q[model.nodes(cable.name)] = positions[cable.name]
    v[: model.n_free] = speed
    return State(model, 0.0, q, v, segment_tensions(model, q, v))


def taut(excess):
    """A span let go from the straight line, `excess` longer than the cable: it swings about its rest as cubic springs do.

    Straight it has T0 = EA excess; sagging by y it pulls back with 8 T y/L in all, T = T0 + 8/3 EA (y/L)^2. Taut, it swings
    to twice its sag; near-taut (T0 = 0) the quartic energy turns it at 4^(1/3) times its sag, where T is 4^(2/3) times that
    at rest. Half as much again allows for the waves that run along the span.
    """
    scene = span(1.0 + excess)
    weight, EA = MU * G, scene.cables[0].EA
    roots = np.roots([64.0 / 3.0 * EA, 0.0, 8.0 * EA * excess, -weight])
    sag = float(roots[np.isreal(roots)].real.max())
    # the turn, where what the weight gives, (2/3) W y, is taken up: 8 T0 y^2/(2 L) + (16/3) EA y^4 (both 2/3 of the work)
    roots = np.roots([16.0 / 3.0 * EA, 0.0, 4.0 * EA * excess, -weight])
    turn = float(roots[np.isreal(roots)].real.max())
    tension = EA * max(excess, 0.0) + 8.0 / 3.0 * EA * turn**2

    def judge(run):
        lowest = -run.q[:, :, 2].min()
        yield Statement(LOAD, "deepest sag over that at the turn", lowest / turn, most=1.5)
        yield Statement(ACCURACY, "deepest sag over that at the turn", lowest / turn, least=0.8)
        yield Statement(LOAD, "largest tension over that at the turn", largest_tension(run) / tension, most=2.0)
        yield Statement(ACCURACY, "largest tension over that at the turn", largest_tension(run) / tension, least=0.8)
        rest = -equilibrium(scene).q[:, 2].min()
        yield Statement(REST, "sag at rest over that of the cubic spring", rest / sag, 0.98, 1.02)

    return Case(
        f"Supports {1.0 + excess:.10g} m apart for 1 m of cable at EA = 1e6 N, from the straight line: it turns where its "
        "energy says.",
        scene,
        0.3,
        judge,
        start="straight",
        save_every=0.002,
        measure=lambda run: run.q[:, :, 2].min() / turn,
        tolerance=0.05,
        unit="",
    )


def settle(description, width, start):
    """Comes to rest in drag: at the sag and the tension of the catenary that its supports ask for."""
    from anet_lumped.statics.catenary import catenary

    scene = span(width, EA=1e4, rate=6.0, zeta=1.0)
    if width:
        shape = catenary((0, 0, 0), (width, 0, 0), length=1.0, EA=1e4, mass_per_length=MU)
        tension = float(shape.tension(0.0))
        lowest = float(shape.lowest[2])
    else:
        tension, lowest = 0.5 * MU * G, -0.5 - 0.25 * 0.25 * MU * G / 1e4  # two halves, each stretched by its own weight

    def judge(run):
        end = run.final
        yield Statement(REST, "last tension at a support over the catenary's", end.tension("a-b")[0] / tension, 0.94, 1.01)
        yield Statement(REST, "last depth over the catenary's", end.q[:, 2].min() / lowest, 0.99, 1.01)
        speed = np.abs(end.v).max()
        yield Statement(REST, "last speed of any node", speed, most=5e-3, unit="m/s")

    return Case(description, scene, 4.0, judge, start=(lambda: start(scene)) if callable(start) else start,
                measure=lambda run: run.q[-1], tolerance=5e-3)  # fmt: skip


def hairpin(scene):
    """Level, as a hairpin on its side: from the support to the middle and back."""
    n = scene.cables[0].segments
    x = 0.5 - np.abs(np.linspace(-0.5, 0.5, n + 1))
    width = scene.point("b").at[0]
    positions = np.column_stack([x + width * np.linspace(0, 1, n + 1), 0 * x, 0 * x])
    return at_positions(scene, {"a-b": positions})


def crumple(scene):
    """A random walk of segments, pinned at its ends."""
    n = scene.cables[0].segments
    steps = np.random.default_rng(1).normal(size=(n, 3))
    steps *= scene.cables[0].L0 / np.linalg.norm(steps, axis=1)[:, None]
    positions = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    positions += np.linspace(0, 1, n + 1)[:, None] * (np.array(scene.point("b").at) - positions[-1])
    return at_positions(scene, {"a-b": positions})


def shaken(EA):
    """A payload on an elastic cable whose support shakes at the very axial frequency: it grows with time, as it must.

    (M + m/3) x'' + k x = k a sin(omega t) from rest at resonance: x = (a/2)(sin(omega t) - omega t cos(omega t)).
    """
    M, length, cycles = 1.0, 1.0, 8
    a = 0.02 * M * G / (EA / length)  # grows to half of the stretch at rest: never slack
    cable = Cable("a", "b", length=length, mass_per_length=0.01, EA=EA, segments=10)
    k = EA / length
    omega = math.sqrt(k / (M + 0.01 * length / 3))
    path = paths.harmonic((0, 0, 0), (0, 0, a), omega / (2 * math.pi))
    scene = Scene([Driven("a", path), Free("b", mass=M)], [cable], [Gravity(G)])
    held = replace(scene, points=(Fixed("a", (0, 0, 0)), scene.points[1]))

    def judge(run):
        z = run.position("b")[:, 2] - equilibrium(held).position("b")[2]
        x = 0.5 * a * (np.sin(omega * run.t) - omega * run.t * np.cos(omega * run.t))
        off = np.abs(z - x).max() / np.abs(x).max()
        yield Statement(ACCURACY, "error of the growing swing over its size", off, most=0.1)
        yield Statement(LOAD, "reach over that of the closed form", np.abs(z).max() / np.abs(x).max(), most=1.1)

    return Case(
        f"A payload at EA = {EA:.0e} N whose support shakes at its axial frequency: it grows as the closed form.",
        scene, cycles * 2 * math.pi / omega, judge, start=lambda: equilibrium(held), unit="",
        measure=lambda run: np.ptp(run.position("b")[:, 2]) / (a * 2 * math.pi * cycles), tolerance=0.05,
    )  # fmt: skip


def yanked(speed):
    """A straight cable at rest, one end of which moves off at once: the wave's tension v sqrt(EA mu), and no more.

    Until the wave comes back from the loose end (2 L/c), the pull on the driven end is v sqrt(EA mu) = v EA/c.
    Source: d'Alembert's wave on a bar; Graff, Wave Motion in Elastic Solids, 1975, section 2.3.
    """
    EA, n = 1e4, 100
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, segments=n)
    scene = Scene([Driven("a", paths.line((0, 0, 0), (-speed, 0, 0), ramp=0.0)), Free("b", at=(1, 0, 0))], [cable])
    c = math.sqrt(EA / MU)
    return Case(
        f"One end of a straight cable starts at once with {speed:g} m/s: the wave's tension v sqrt(EA mu).",
        scene, 1.5 / c, lambda run: _wave(run, speed, EA, c), start="straight", dt=0.25 / n / c, save_every=1.0 / n / c,
        measure=lambda run: _behind(run, c).mean() / (speed * math.sqrt(EA * MU)), tolerance=0.01, unit="",
    )  # fmt: skip


def stopped_dead(speed):
    """A straight cable that flies along itself, one end of which stops dead: the same wave."""
    EA, n = 1e4, 100
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, segments=n)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable])
    c = math.sqrt(EA / MU)
    positions = np.linspace(0.0, 1.0, n + 1)[:, None] * (1.0, 0.0, 0.0)
    return Case(
        f"A straight cable flies along itself at {speed:g} m/s and one end stops dead: the wave's tension v sqrt(EA mu).",
        scene, 1.5 / c, lambda run: _wave(run, speed, EA, c), dt=0.25 / n / c, save_every=1.0 / n / c,
        start=lambda: at_positions(scene, {"a-b": positions}, speed=(speed, 0, 0)),
        measure=lambda run: _behind(run, c).mean() / (speed * math.sqrt(EA * MU)), tolerance=0.01, unit="",
    )  # fmt: skip


def snapped(speed):
    """The same flight with the first segment slack by half: nothing pulls until it is taut, and then the same wave starts."""
    EA, n = 1e4, 100
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=EA, segments=n)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable])
    c, slack = math.sqrt(EA / MU), 0.5 / n
    positions = np.linspace(0.0, 1.0, n + 1)[:, None] * (1.0, 0.0, 0.0)
    positions[1:, 0] -= slack
    snaps = slack / speed

    def judge(run):
        early = run.tension("a-b")[run.t < 0.95 * snaps]
        yield Statement(LOAD, "pull while it is slack, over v sqrt(EA mu)", early.max() / (speed * math.sqrt(EA * MU)), most=1e-6)
        yield from _wave(run, speed, EA, c, snaps)

    return Case(
        f"A cable flies along itself at {speed:g} m/s, slack at its support: its snap's first peak is v sqrt(EA mu).",
        scene, snaps + 1.5 / c, judge, dt=0.25 / n / c, save_every=1.0 / n / c,
        start=lambda: at_positions(scene, {"a-b": positions}, speed=(speed, 0, 0)),
        measure=lambda run: _behind(run, c, snaps).mean() / (speed * math.sqrt(EA * MU)), tolerance=0.01, unit="",
    )  # fmt: skip


def _behind(run, c, begins=0.0):
    """Pulls on the end that stops, behind the front."""
    t = run.t - begins
    return run.tension("a-b")[(t > 0.1 / c) & (t < 1.5 / c), 0]


def _wave(run, speed, EA, c, begins=0.0):
    pull = run.tension("a-b")[:, 0]
    expected = speed * math.sqrt(EA * MU)
    mean = _behind(run, c, begins).mean() / expected
    yield Statement(LOAD, "mean pull behind the front over v sqrt(EA mu)", mean, 0.98, 1.02)
    # a chain of masses overshoots behind a front: by up to the sum of |J_1| ripples, 1.5 bounds them
    yield Statement(LOAD, "peak pull over v sqrt(EA mu)", pull.max() / expected, 0.98, 1.5)
    yield Statement(MOMENTUM, "way across", np.abs(run.q[:, :, 1:]).max(), most=1e-9, unit="m")


def energy_seen_from(run, velocity):
    """Kinetic, elastic and potential energy at the saved times [J], as seen by who moves with a velocity [m/s] across the
    weight: none of it is put in by a support that moves so too."""
    model = run.model
    m = model.mass[: model.n_free, None]
    v = run.v[:, : model.n_free] - np.asarray(velocity)
    return 0.5 * (m * v**2).sum(axis=(1, 2)) + run.energy[:, 1] + run.energy[:, 2]


def _flight(run, seen, cable):
    """What energy, as seen from the support that moves steadily, allows."""
    lowest = float(run.energy[0, 2]) - 0.02  # [J]; the potential energy hanging, stretched a little more at most
    total = seen[0] - lowest
    most = 1e-5 if must_not_gain_energy(run) else BOUNDED_RISE
    rise = float((seen - np.minimum.accumulate(seen)).max() / total)
    yield Statement(ENERGY, "rise of energy as seen from the support, over all of it", rise, most=most)
    spring = cable.stiffness * np.maximum(_stretches(run), 0.0).max()
    pull = math.sqrt(2.0 * cable.stiffness * total)
    yield Statement(LOAD, "largest spring force over what all the energy in one segment gives", spring / pull, 0.0, 1.0)


def _stretches(run):
    (cable,) = run.scene.cables
    return np.linalg.norm(np.diff(run.shape(cable.name), axis=1), axis=2) - cable.L0


def raced():
    """A hanging cable whose support starts at 5 m/s at once: for the support, it was the cable that started."""
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=1e5, zeta=0.05, segments=20)
    scene = Scene([Driven("a", paths.line((0, 0, 0), (5.0, 0, 0), ramp=0.0)), Free("b", mass=0.1)], [cable], [Gravity(G)])
    held = replace(scene, points=(Fixed("a", (0, 0, 0)), scene.points[1]))

    def judge(run):
        yield from _flight(run, energy_seen_from(run, (5.0, 0, 0)), cable)
        off = np.abs(run.position("a") - run.t[:, None] * (5.0, 0, 0)).max()
        yield Statement(LOAD, "position of the support off its path", off, most=1e-12, unit="m")
        # on the circle, 5 m/s carry the payload 5^2/(2 g) = 1.27 m up where the cable is taut: above the support's height
        top = (run.position("b")[:, 2] - run.position("a")[:, 2]).max()
        yield Statement(LOAD, "height of the payload above its support", top, 0.0, 1.0 + 1e-3, unit="m")

    return Case("The support of a hanging cable starts at 5 m/s at once: seen from it, no energy is gained.",
                scene, 0.6, judge, start=lambda: equilibrium(held), save_every=0.002,
                measure=at_time(0.1, lambda run: run.position("b")), tolerance=5e-3)  # fmt: skip


def stops_midway():
    """Samples that run at 2 m/s and come to rest within 10 ms: the cable swings on, with the energy that it has."""
    t = np.concatenate([np.linspace(0.0, 0.5, 51), [0.51, 0.6]])
    x = np.where(t < 0.1, 10.0 * t**2, 0.1 + 2.0 * (t - 0.1))
    x[-2:] = x[-3]
    path = paths.samples(t, np.column_stack([x, 0 * x, 0 * x]))
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=1e5, zeta=0.05, segments=20)
    scene = Scene([Driven("a", path), Free("b", mass=0.1)], [cable], [Gravity(G)])

    def judge(run):
        after = run.t > 0.6 + 1e-9
        seen = run.energy[after, :3].sum(axis=1)
        total = seen[0] - (run.energy[0, 2] - 0.02)
        yield Statement(LOAD, "energy above rest after the stop", total, 0.0, 0.5 * 0.2 * 4.0**2, "J")  # at most at twice 2 m/s
        most = 1e-5 if must_not_gain_energy(run) else BOUNDED_RISE
        rise = float((seen - np.minimum.accumulate(seen)).max() / total)
        yield Statement(ENERGY, "rise of energy after the stop, over all of it", rise, most=most)
        off = np.abs(run.position("a")[after] - path.at(1.0)[0]).max()
        yield Statement(LOAD, "position of the support off its last sample", off, most=1e-12, unit="m")

    return Case(
        "A support at 2 m/s stops within 10 ms: the cable swings on with what it has, and gains nothing.",
        scene,
        2.0,
        judge,
        save_every=0.01,
        measure=at_time(0.5, lambda run: run.position("b")),
        tolerance=5e-3,
    )


CASES = {
    "span, taut by 1e-3": lambda: taut(1e-3),
    "span, near-taut by 1e-9": lambda: taut(-1e-9),
    "settles as a catenary": lambda: settle("A slack span from the straight line settles as the catenary.", 0.8, "straight"),
    "hairpin settles": lambda: settle("A hairpin laid on its side settles, 5 mm wide.", 0.005, hairpin),
    "coincident supports": lambda: settle("Both ends at one place: all nodes on one spot, then a hairpin.", 0.0, "straight"),
    "crumple settles": lambda: settle("A random crumple between supports settles as the catenary.", 0.3, crumple),
    "shaken at resonance, 1e3 N": lambda: shaken(1e3),
    "shaken at resonance, 1e6 N": lambda: shaken(1e6),
    "yanked at 1 m/s": lambda: yanked(1.0),
    "stops dead at 10 m/s": lambda: stopped_dead(10.0),
    "slack snaps at 10 m/s": lambda: snapped(10.0),
    "starts at 5 m/s": raced,
    "support stops midway": stops_midway,
}
