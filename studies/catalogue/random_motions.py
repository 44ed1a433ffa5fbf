"""Random motions as users set them up: pendulums, nets that are carried, plucked strings, weights that fall into a cable and more.

Unlike `random_trials`, which looks for what breaks, these are scenes whose motion a fine step can be compared with.
"""

import math
from dataclasses import dataclass

import numpy as np

from anet_lumped import Cable, Driven, Fixed, Free, PayloadChange, Scene, effects
from anet_lumped.prescribed import paths

KINDS = ("pendulum", "chain", "net", "driven", "string", "fall", "sway")
G = 9.81  # [m/s^2]


@dataclass(frozen=True)
class Motion:
    """A scene, how it starts, how long it moves [s], and what kind of motion it is."""

    kind: str
    scene: Scene
    t_end: float
    start: str


def random_motion(number: int, seed: int = 11) -> Motion:
    """The motion of a number; the same for the same seed."""
    rng = np.random.default_rng((seed, number))

    def one_of(*choices):
        return choices[int(rng.integers(len(choices)))]

    kind, L, mu = one_of(*KINDS), one_of(0.5, 1.0, 2.0, 10.0), float(10.0 ** rng.uniform(-2.0, 0.3))
    like = {
        "length": L, "mass_per_length": mu, "EA": float(10.0 ** rng.uniform(2.5, 7.0)), "zeta": one_of(0.0, 0.02, 0.1, 1.0),
        "segments": one_of(1, 4, 10, 20), "compression": one_of("none", "none", "damped", "linear"), "diameter": 0.01,
    }  # fmt: skip
    around = one_of(*(["vacuum"] * 5), "resistance", "air", "water")
    acting = [effects.Gravity(G)]
    if around == "resistance":
        acting.append(effects.ViscousDamping(one_of(0.3, 3.0)))
    elif around != "vacuum":
        acting.append(effects.Air() if around == "air" else effects.Water(level=50.0, g=G))
    payload, turn = one_of(0.0, 0.05, 0.5, 5.0) * mu * L, math.sqrt(L / G)
    points, cables, events, start, turn = _KIND[kind](rng, one_of, like, L, payload, turn)
    return Motion(kind, Scene(points, cables, acting, events=events), one_of(3.0, 8.0, 20.0) * turn, start)


def _pendulum(rng, one_of, like, L, payload, turn):
    angle = rng.uniform(0.1, 1.6)
    end = Free("b", mass=payload, at=(L * math.sin(angle), 0.0, -L * math.cos(angle)))
    return [Fixed("a", (0.0, 0.0, 0.0)), end], [Cable("a", "b", **like)], [], "straight", turn


def _chain(rng, one_of, like, L, payload, turn):
    return _pendulum(rng, one_of, like, L, 0.0, turn)


def _net(rng, one_of, like, L, payload, turn):
    path = {"velocity": (one_of(0.2, 1.0, 3.0), 0.0, 0.0), "ramp": one_of(0.1, 1.0)}
    corners = [(x * L / 2, y * L / 2, 0.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    points = [Driven(f"s{i}", paths.line(at, **path)) for i, at in enumerate(corners)]
    cables = [Cable(f"s{i}", "p0", **like) for i in range(4)]
    return [*points, Free("p0", mass=0.036)], cables, [], "equilibrium", turn


def _driven(rng, one_of, like, L, payload, turn):
    frequency, way = 0.3 * float(10.0 ** rng.uniform(-1.0, 0.8)) / turn, float(rng.uniform(0.01, 0.2)) * L
    path = paths.harmonic((0.0, 0.0, 0.0), (way, 0.0, 0.5 * way), frequency, ramp=2.0 * turn)
    return [Driven("a", path), Free("b", mass=payload)], [Cable("a", "b", **like)], [], "equilibrium", turn


def _string(rng, one_of, like, L, payload, turn):
    """Plucked: pulled down by a hundredth of its length, and let go."""
    strain = one_of(1e-3, 1e-2)
    T, half = like["EA"] * strain, like | {"length": L / 2.0 / (1.0 + strain)}
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("p", mass=4.0 * T * 0.01 / G), Fixed("b", (L, 0.0, 0.0))]
    left = one_of(0.0, 0.1) * like["mass_per_length"] * L
    events = [PayloadChange("p", t=0.0, mass=left)]
    return (
        points,
        [Cable("a", "p", **half), Cable("p", "b", **half)],
        events,
        "equilibrium",
        L / 3.0 * math.sqrt(like["mass_per_length"] / T),
    )


def _fall(rng, one_of, like, L, payload, turn):
    mass, height = float(rng.uniform(1.0, 50.0)) * like["mass_per_length"] * L, float(rng.uniform(0.0, 1.0)) * L
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=mass, at=(0.01 * L, 0.0, height - L))]
    return points, [Cable("a", "b", **like)], [], "straight", turn


def _sway(rng, one_of, like, L, payload, turn):
    points = [
        Fixed("a", (0.0, 0.0, 0.0)),
        Free("m", mass=payload, at=(0.4 * L, 0.1 * L, -0.5 * L)),
        Fixed("b", (1.2 * L, 0.0, 0.0)),
    ]
    return points, [Cable("a", "m", **like), Cable("m", "b", **like)], [], "straight", turn


_KIND = {"pendulum": _pendulum, "chain": _chain, "net": _net, "driven": _driven, "string": _string, "fall": _fall, "sway": _sway}
