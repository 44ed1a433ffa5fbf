"""Cables that fall and are caught: a folded chain, its tip, a climber's fall, a heap with all nodes on one spot."""

import math
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from anet_lumped import Cable, Fixed, Free, Scene, equilibrium
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.model.build import build
from studies.catalogue.case import ACCURACY, LOAD, MOMENTUM, REST, Case, Statement, at_time, largest_tension
from studies.catalogue.supports import at_positions

G = 9.81  # [m/s^2]


def folded(gap, *, segments=200, EA=1e6, mu=0.1, zeta=0.05):
    """A metre of chain from a support down and up again to its loose end beside the support, `gap` metres off."""
    cable = Cable("a", "b", length=1.0, mass_per_length=mu, EA=EA, zeta=zeta, segments=segments)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable], [Gravity(G)])
    s = np.linspace(0.0, 1.0, segments + 1)
    depth = 0.5 * (1.0 - gap)  # two legs and a bottom of the length of the gap
    x = np.clip(s - depth, 0.0, gap)
    z = -np.minimum(s, depth) + np.maximum(s - depth - gap, 0.0)
    positions = np.column_stack([x, 0 * x, z])
    return scene, at_positions(scene, {"a-b": positions})


def falling_fold():
    """The loose end of a folded chain falls faster than free, in 0.847213 of the time of free fall.

    The chain loses no energy, so that as the falling leg shortens its speed grows: v^2 = g x (2 - x/L)/(1 - x/L), x the fall.
    Source: Calkin & March, Am. J. Phys. 57 (1989) 154; Schagerl et al., Acta Mech. 125 (1997) 155.
    """
    scene, start = folded(0.02)
    free = math.sqrt(2.0 / G)

    def judge(run):
        z = run.position("b")[:, 2]
        lead = -0.5 * G * run.t**2 - z
        mid = run.t <= 0.8 * free
        expected = _fall_by(0.8 * free) - 0.64
        yield Statement(ACCURACY, "lead over free fall at 0.8 of its time", lead[mid][-1], expected - 0.02, expected + 0.02, "m")
        yield Statement(LOAD, "lag behind free fall, of the length", -lead[mid].min(), most=2e-3, unit="m")
        down = np.argmax(z <= -0.96) if (z <= -0.96).any() else -1
        expected = _fall_time(0.96) / free
        ratio = run.t[down] / free
        yield Statement(
            ACCURACY, "time of a fall by 0.96 m over that of free fall by 1 m", ratio, 0.985 * expected, 1.015 * expected
        )  # fmt: skip

    return Case(
        "A folded chain lets its loose end go: it falls ahead of free fall and arrives at 0.847213 of its time.",
        scene, 0.45, judge, start=lambda: start, dt=1e-3, save_every=1e-3,
        measure=at_time(0.8 * free, lambda run: run.position("b")), tolerance=5e-3,
    )  # fmt: skip


def _fall_time(fall):
    """Time that the end of a folded chain of a metre takes to fall by so much [s]: integral of dx/v, x = u^2 at its root."""
    u = math.sqrt(fall) * (np.arange(4000) + 0.5) / 4000
    return float(np.sum(2.0 * np.sqrt((1.0 - u**2) / (2.0 - u**2)))) * math.sqrt(fall) / 4000 / math.sqrt(G)


def _fall_by(time):
    """Fall of the end of a folded chain of a metre in so much time [m]."""
    return float(brentq(lambda fall: _fall_time(fall) - time, 1e-6, 1.0))


def wide_tip():
    """A chain in a U between a support and its end, 0.5 m apart: the tip, let go, runs ahead of free fall.

    Source: Tomaszewski, Pieranski & Geminard, Am. J. Phys. 74 (2006) 776.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e6, zeta=0.05, segments=100)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable], [Gravity(G)])
    held = replace(scene, points=(Fixed("a", (0, 0, 0)), Fixed("b", (0.5, 0, 0))))

    def start():
        rest = equilibrium(held)
        return at_positions(scene, {"a-b": rest.shape("a-b")})

    def judge(run):
        z, t = run.position("b")[:, 2], run.t
        lead = -0.5 * G * t**2 - z
        yield Statement(ACCURACY, "largest lead over free fall", lead[t < 0.45].max(), least=0.005, unit="m")
        yield Statement(LOAD, "depth of the tip", -z.min(), 0.8, 1.0 + 5e-3, unit="m")

    return Case("The tip of a chain in a U is let go: it runs ahead of free fall.", scene, 0.45, judge, start=start, dt=2e-3,
                save_every=2e-3, measure=at_time(0.3, lambda run: run.position("b")), tolerance=2e-3)  # fmt: skip


def climber(words, **elastic):
    """A climber of 80 kg falls 2.5 m into 2.5 m of rope whose nodes all lie at the support: the rope takes all of the energy.

    At the lowest position the rope has taken the fall, W (1 + eps) = int_0^eps T for fall factor 1; with a stiffness EA that is the
    standard equation, F = W (1 + sqrt(1 + 2 EA/W)). The dampers calm the rope's own 0.15 kg, and take 1e-4 of the climber's speed.
    Source: Wexler, The theory of belaying, Am. Alpine J. 7 (1950) 379.
    """
    length, W = 2.5, 80.0 * G
    cable = Cable("a", "b", length=length, mass_per_length=0.06, zeta=0.5, segments=20, **elastic)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=W / G)], [cable], [Gravity(G)])
    springs = [(at, cable.EA_first * share) for at, share in ((0.0, 1.0), *cable.springs[1:])]
    strain = brentq(lambda eps: sum(0.5 * k * max(eps - at, 0.0) ** 2 for at, k in springs) - W * (1.0 + eps), 0.0, 10.0)
    peak = sum(k * max(strain - at, 0.0) for at, k in springs)

    def judge(run):
        yield Statement(ACCURACY, "peak of the rope's pull over that of energy", largest_tension(run) / peak, 0.95, 1.05)
        lowest = -run.position("b")[:, 2].min()
        yield Statement(LOAD, "lowest position over that of energy", lowest / (length * (1 + strain)), 0.9, 1.01)
        yield Statement(MOMENTUM, "way to the side", np.abs(run.q[:, :, :2]).max(), most=1e-9, unit="m")

    return Case(f"A climber falls into a slack rope{words}, all nodes on one spot: the first peak is that of energy.",
                scene, 1.1, judge, start=lambda: at_positions(scene, {"a-b": np.zeros((21, 3))}),
                measure=lambda run: largest_tension(run) / peak, tolerance=0.05, unit="")  # fmt: skip


def heap(kind):
    """A cable under one support comes to hang straight in drag, from all nodes on one spot or from a crumple."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=20)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable], [Gravity(G), ViscousDamping(4.0)])
    walk = np.random.default_rng(2).normal(size=(20, 3))
    walk *= np.random.default_rng(3).uniform(0, 0.05, (20, 1)) / np.linalg.norm(walk, axis=1)[:, None]
    positions = np.zeros((21, 3))
    if kind == "crumple":
        positions[1:] = np.cumsum(walk, axis=0)

    def judge(run):
        end = run.final
        n = build(scene).node("b")
        stretched = 1.0 + 0.5 * 0.1 * G / 1e4
        yield Statement(REST, "last height of the end over its length", -end.q[n, 2] / stretched, 0.999, 1.001)
        yield Statement(REST, "last pull on the support over the weight", end.tension("a-b")[0] / (0.1 * G), 0.96, 0.99)
        yield Statement(REST, "last speed of any node", np.abs(end.v).max(), most=5e-3, unit="m/s")
        yield Statement(LOAD, "depth", -run.q[:, :, 2].min(), most=1.02, unit="m")

    return Case(f"A heap ({kind}) under a support comes to hang straight: the weight on the support.", scene, 8.0, judge,
                start=lambda: at_positions(scene, {"a-b": positions}), measure=lambda run: run.q[-1], tolerance=5e-3)  # fmt: skip


CASES = {
    "folded chain falls": falling_fold,
    "tip of a U falls": wide_tip,
    "climber's fall": lambda: climber("", EA=3e4),
    "climber's fall, stiffening rope": lambda: climber(" that stiffens", tension_strain=((0.1, 1e3), (0.2, 6e3), (0.3, 16e3))),
    "climber's fall, yielding rope": lambda: climber(" that yields", tension_strain=((0.2, 6e3), (1.0, 1e4))),
    "heap on one spot": lambda: heap("one spot"),
    "heap, crumple": lambda: heap("crumple"),
}
