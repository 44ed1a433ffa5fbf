"""Cases whose default run was once "done", without a word, and wrong: their right values are closed forms."""

import math

import numpy as np

from anet_lumped import Cable, Fixed, Free, PayloadChange, Scene
from anet_lumped.effects import Gravity
from studies.catalogue.case import ACCURACY, LOAD, Case, Statement, at_time, position_at_end

G = 9.81  # [m/s^2]


def plucked():
    """A string of 0.65 m at 70 N, pulled down by 1 mm in its middle: period 2 L sqrt(mu/T) = 3.5 ms, where sqrt(L/g) is 0.26 s."""
    L, T, mu, EA, t_end = 0.65, 70.0, 5e-4, 2e4, 0.02
    half = {"length": L / (1.0 + T / EA) / 2.0, "mass_per_length": mu, "EA": EA, "segments": 20}
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("p", mass=4.0 * T * 1e-3 / L / G), Fixed("b", (L, 0.0, 0.0))]
    events = [PayloadChange("p", t=0.0, mass=0.0)]
    scene = Scene(points, [Cable("a", "p", **half), Cable("p", "b", **half)], [Gravity(G)], events=events)
    crossings = math.floor(t_end * math.sqrt(T / (mu / (1.0 + T / EA))) / L + 0.5)

    def judge(run):
        z = run.position("p")[:, 2]
        found = float(np.sum(np.diff(np.sign(z)) != 0))
        yield Statement(ACCURACY, "number of times that the middle crosses zero", found, crossings - 1, crossings + 1)

    return Case("A plucked string swings at the frequency of its tension.", scene, t_end, judge, dt=1e-5, save_every=1e-4,
                measure=at_time(3e-3, lambda run: run.position("p")), tolerance=2e-4)  # fmt: skip


def slack_damper():
    """A weight stands on one slack segment whose damper acts: it sinks at W/c, whatever the stiffness of the spring."""
    mass, c, height = 13.0, 707.1, 0.6
    rod = Cable("a", "w", length=0.6, mass_per_length=1e-6, EA=2e6, BA=0.6 * c, segments=1, compression="damped")
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("w", mass=mass, at=(0.0, 0.0, height))], [rod], [Gravity(G)])
    t_end, sinks = 1.0, mass * G / c
    right = height - sinks * (t_end - mass / c)

    def judge(run):
        z = float(run.position("w")[-1, 2])
        yield Statement(ACCURACY, "height after a second", z, right - 2e-3, right + 2e-3, "m")

    return Case("A weight sinks on a slack segment as its damper lets it.", scene, t_end, judge, start="straight", dt=2e-3,
                measure=position_at_end("w"), tolerance=2e-3)  # fmt: skip


def climber():
    """A fall of 1.8 lengths into a rope without mass: m g + sqrt((m g)^2 + 2 m g h EA/L) at most."""
    mass, EA, L, factor = 80.0, 20e3, 10.0, 1.8
    rope = Cable("anchor", "climber", length=L, mass_per_length=1e-6, EA=EA, segments=1)
    faller = Free("climber", mass=mass, at=(0.1, 0.0, (factor - 1.0) * L))
    scene = Scene([Fixed("anchor", (0.0, 0.0, 0.0)), faller], [rope], [Gravity(G)])
    weight = mass * G
    peak = weight + math.sqrt(weight**2 + 2.0 * weight * factor * EA)

    def judge(run):
        found = float(run.tension("anchor-climber").max())
        yield Statement(LOAD, "largest tension", found, 0.975 * peak, 1.025 * peak, "N")

    return Case(
        "A climber falls into a rope: the first peak is that of his energy.", scene, 3.0, judge, start="straight", dt=1e-3,
        measure=at_time(2.4, lambda run: run.position("climber")), tolerance=0.05,
    )  # fmt: skip


CASES = {
    "plucked string": plucked,
    "weight on a slack damper": slack_damper,
    "climber's fall, massless rope": climber,
}
