"""Nets of the study: the thesis's two and four cables, at rest, carried at 0.2 m/s and flown at 5 m/s."""

from typing import NamedTuple

import numpy as np

from anet_lumped.effects import Gravity
from anet_lumped.motion.simulate import simulate
from anet_lumped.prescribed import paths
from anet_lumped.scene.scene import Cable, Driven, Fixed, Free, Scene
from anet_lumped.statics.catenary_net import catenary_net
from studies.accuracy_cost.references import extrapolated

TWO, FOUR = "two cables", "four cables"
SUPPORTS = {
    TWO: ((0.0, 0.0, 1.0), (1.0, 0.0, 1.0)),
    FOUR: ((-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)),
}  # [m]; those of four cables are not stated in the thesis
LENGTH, MASS_PER_LENGTH, SEGMENTS = 1.0, 0.1, 20  # [m], [kg/m], of each cable
EA, ZETA = 1e4, 0.05  # [N]: 3 mm nylon; damping ratio of a segment
GRAVITY = 9.81  # [m/s2]
BOTTLE = 0.036  # [kg]
CARRIED, FLOWN = "carried at 0.2 m/s", "flown at 5 m/s"
SAVE_EVERY = 0.04  # [s]
REFERENCE_SEGMENTS, QUICK_SEGMENTS = (20, 40), (16, 32)  # of each cable: the reference is extrapolated from both
REFERENCE_RTOL = 1e-9


class Flight(NamedTuple):
    """How the supports set off together: velocity (3,) [m/s], time to reach it and time of the whole motion [s]."""

    velocity: tuple[float, float, float]
    ramp: float
    t_end: float


FLIGHTS = {CARRIED: Flight((0.2, 0.0, 0.0), 1.0, 4.0), FLOWN: Flight((0.0, 5.0, 0.0), 2.0, 3.0)}  # the latter is 10 m long


class Motion(NamedTuple):
    """A motion of a net.

    Parameters
    ----------
    name : of `FLIGHTS`
    net : of `SUPPORTS`
    load : [kg], mass of p0
    """

    name: str
    net: str
    load: float

    @property
    def flight(self):
        """`Flight` of the supports."""
        return FLIGHTS[self.name]

    def scene(self, segments=SEGMENTS):
        """Its Scene."""
        return net(self.net, self.load, self.flight, segments)

    def shift(self, t):
        """Places of the supports at times (k,) [s] less those at the start, (k, 3) [m]."""
        path = paths.line((0.0, 0.0, 0.0), self.flight.velocity, self.flight.ramp)
        return np.array([path.at(float(time))[0] for time in t])


MOTIONS = [
    *(Motion(CARRIED, name, load) for name in (TWO, FOUR) for load in (0.0, BOTTLE)),
    *(Motion(FLOWN, name, 0.01) for name in (TWO, FOUR)),
]
QUICK_MOTIONS = [MOTIONS[3], MOTIONS[5]]


def net(name, load=0.0, flight=None, segments=SEGMENTS):
    """A net as a scene: supports s0, s1, ..., fixed or driven, and cables from each to p0.

    Parameters
    ----------
    name : of `SUPPORTS`
    load : float [kg]
    flight : Flight, or None for fixed supports
    segments : int, of each cable

    Returns
    -------
    Scene
    """
    supports = SUPPORTS[name]
    held = [
        Fixed(f"s{i}", at) if flight is None else Driven(f"s{i}", paths.line(at, flight.velocity, flight.ramp))
        for i, at in enumerate(supports)
    ]
    cables = [
        Cable(f"s{i}", "p0", length=LENGTH, mass_per_length=MASS_PER_LENGTH, EA=EA, zeta=ZETA, segments=segments)
        for i in range(len(supports))
    ]
    return Scene([*held, Free("p0", load)], cables, [Gravity(GRAVITY)])


def first_guess(name):
    """A place of p0 half a metre below the middle of the supports, (3,) [m]."""
    return np.mean(SUPPORTS[name], axis=0) - (0.0, 0.0, 0.5)


def balanced(name, load, *, elastic=True, shift=(0.0, 0.0, 0.0)):
    """p0 of the net of catenaries by a balance of forces, (3,) [m].

    Parameters
    ----------
    name : of `SUPPORTS`
    load : float [kg]
    elastic : bool
        Whether the cables stretch.
    shift : (3,) [m], of the supports
    """
    places = {f"s{i}": np.add(at, shift) for i, at in enumerate(SUPPORTS[name])}
    places["p0"] = first_guess(name) + shift
    return catenary_net(net(name, load), places, elastic=elastic).points["p0"]


def reference(motion, segments=REFERENCE_SEGMENTS):
    """p0 at each saved time, (k, 3) [m], and the times (k,) [s].

    Two runs of dop853 at a tight tolerance, of cables of two numbers of ``segments``: the error of p0 falls as the square of that
    number, so that both give the place that it tends to. With 40 and 80 segments it is within 0.01 mm of that with 20 and 40.
    """
    coarse, fine = (
        simulate(motion.scene(number), motion.flight.t_end, method="dop853", rtol=REFERENCE_RTOL, save_every=SAVE_EVERY, check=True)
        for number in segments
    )
    p0 = fine.position("p0")
    return extrapolated(coarse.position("p0"), p0, (segments[1] / segments[0]) ** 2), fine.t
