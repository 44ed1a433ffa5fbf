"""The continuous net: every cable an exact catenary, every free point where the pulls of its cables balance.

The continuous net is the reference for a lumped net. Its only unknowns are the positions of the junctions. Newton's method takes
the stiffness of a catenary between its ends in closed form.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from anet_lumped.checks import InputError, quoted
from anet_lumped.scene.scene import Cable, Free, Scene

from .catenary import Catenary, catenary

INEXTENSIBLE = 1e8  # EA over all the weight carried: strains of 1e-8, and a chord may still reach the cable's length
TOLERANCE = 1e-11  # out-of-balance force over the weight carried; catenaries are exact to 1e-12
DIRECT = 15  # Newton steps with the given stiffness, before soft cables are tried
ROUNDS = 60  # Newton steps with each stiffness after that
HALVINGS = 30  # of a Newton step


class CatenaryNetError(RuntimeError):
    """A net of catenaries whose balance of forces was not found."""


@dataclass(frozen=True)
class Turned:
    """A catenary in the scene's frame, where gravity need not point along -z; `turn` (3, 3) takes the scene's axes to
    the catenary's."""

    curve: Catenary
    turn: np.ndarray

    def point(self, s: ArrayLike) -> np.ndarray:
        """Places (..., 3) [m] at unstretched arc lengths s [m] from the cable's start."""
        return self.curve.point(s) @ self.turn

    def tension(self, s: ArrayLike) -> np.ndarray:
        """Tensions (...) [N] at unstretched arc lengths s [m]."""
        return self.curve.tension(s)

    @property
    def length(self) -> float:
        """Stretched length [m]."""
        return self.curve.stretched_length

    @property
    def sag(self) -> float:
        """Largest distance below the chord, along gravity [m]."""
        return self.curve.sag

    @property
    def end_forces(self) -> np.ndarray:
        """Pulls (2, 3) [N] on the cable's start and end."""
        return self.curve.end_forces @ self.turn


@dataclass(frozen=True)
class CatenaryNet:
    """Places of the points {name: (3,) [m]} and the cables {name: Turned}; `rounds` Newton steps were taken."""

    points: dict[str, np.ndarray]
    cables: dict[str, Turned]
    rounds: int = 0


def catenary_net(scene: Scene, places: Mapping[str, ArrayLike], *, elastic: bool = True) -> CatenaryNet:
    """Rest of the continuous net whose supports are where `places` says.

    Sum over the cables of the pull on a free point + its mass times g = 0, for each free point. Cables that end loosely
    hang straight down and act on the net by their weight.

    Parameters
    ----------
    scene : Scene
    places : dict of (3,) [m]
        The place of each point by its name; for free points the start of the search.
    elastic : bool
        Each cable with its own EA; otherwise with EA = 1e8 times the weight carried.

    Returns
    -------
    CatenaryNet

    Raises
    ------
    InputError
        A scene without gravity, or a cable with a tension-strain curve that is to stretch.
    CatenaryNetError
        No balance within 1e-11 of the weight carried or what round-off allows.

    Source
    ------
    Irvine, Cable Structures, MIT Press 1981, sections 1.3 and 2.5 (stiffness from the flexibility of its end forces).
    """
    hung = _Hung(scene, places, elastic)
    x, rounds = hung.balance()
    return hung.net(x, rounds)


def catenaries_between_ends(scene: Scene, places: Mapping[str, ArrayLike], *, elastic: bool = True) -> CatenaryNet:
    """Each cable as the catenary between given ends, balanced or not; arguments and errors as for `catenary_net`."""
    hung = _Hung(scene, places, elastic)
    cables = {cable.name: hung.between(cable, hung.at[cable.start], hung.at[cable.end]) for cable in scene.cables}
    return CatenaryNet(
        {name: np.asarray(xyz) for name, xyz in places.items()}, {name: Turned(curve, hung.turn) for name, curve in cables.items()}
    )


class _Hung:
    """A scene turned so that gravity points along -z. Cables with a loose end are replaced by their weight."""

    def __init__(self, scene: Scene, places: Mapping[str, ArrayLike], elastic: bool) -> None:
        self.g = float(np.linalg.norm(scene.gravity))
        if self.g == 0:
            raise InputError("A catenary needs gravity, but the scene has no Gravity effect or g = 0.")
        self.turn = _turn_down(scene.gravity / self.g)
        self.at = {name: self.turn @ np.asarray(xyz, dtype=float) for name, xyz in places.items()}
        self.load = {point.name: point.mass * self.g for point in scene.points if isinstance(point, Free)}
        self.weight = sum(self.load.values()) + self.g * sum(c.mass_per_length * c.length for c in scene.cables)
        curved = next((c.name for c in scene.cables if c.tension_strain is not None), None)
        if elastic and curved is not None:
            raise InputError(
                f"A cable with a tension-strain curve, such as {quoted(curved)}, has no catenary in closed form; "
                "take elastic=False."
            )
        self.EA = {c.name: c.EA if elastic else INEXTENSIBLE * self.weight for c in scene.cables}
        self.cables = list(scene.cables)
        self.loose: list[tuple[Cable, str, str]] = []
        while cut := next(((c, end) for c in self.cables if (end := self._loose_end(c))), None):
            self._cut(*cut)
        self.free = [name for name in self.load if any(name in (c.start, c.end) for c in self.cables)]

    def _loose_end(self, cable: Cable) -> str | None:
        """The end of a cable that hangs on nothing else, or None."""
        for end in (cable.start, cable.end):
            if end in self.load and sum(end in (c.start, c.end) for c in self.cables) == 1:
                return end
        return None

    def _cut(self, cable: Cable, end: str) -> None:
        held = cable.end if end == cable.start else cable.start
        self.cables.remove(cable)
        self.loose.append((cable, held, end))
        if held in self.load:
            self.load[held] += self.load[end] + self.g * cable.mass_per_length * cable.length

    def between(self, cable: Cable, p1: np.ndarray, p2: np.ndarray, stiffest: float = math.inf) -> Catenary:
        EA = min(self.EA[cable.name], stiffest)
        return catenary(p1, p2, cable.length, EA=EA, mass_per_length=cable.mass_per_length, gravity=self.g)

    def curves(self, x: np.ndarray, stiffest: float) -> list[Catenary]:
        at = {**self.at, **dict(zip(self.free, x, strict=True))}
        return [self.between(cable, at[cable.start], at[cable.end], stiffest) for cable in self.cables]

    def residual(self, curves: Sequence[Catenary]) -> np.ndarray:
        """Force on each free point, (n, 3) [N]."""
        force = np.zeros((len(self.free), 3))
        force[:, 2] = [-self.load[name] for name in self.free]
        for cable, curve in zip(self.cables, curves, strict=True):
            for name, pull in zip((cable.start, cable.end), curve.end_forces, strict=True):
                if name in self.load:
                    force[self.free.index(name)] += pull
        return force

    def stiffness(self, curves: Sequence[Catenary]) -> np.ndarray:
        """Minus the derivative of `residual` in the free points' places, (3n, 3n) [N/m]."""
        K = np.zeros((len(self.free), 3, len(self.free), 3))
        for cable, curve in zip(self.cables, curves, strict=True):
            S = _end_stiffness(curve)
            ends = [self.free.index(name) if name in self.load else None for name in (cable.start, cable.end)]
            for i in ends:
                for j in ends:
                    if i is not None and j is not None:
                        K[i, :, j, :] += S if i == j else -S
        return K.reshape(3 * len(self.free), -1)

    def balance(self) -> tuple[np.ndarray, int]:
        """Places of the free points, (n, 3) [m], and the number of Newton steps that it took."""
        start = np.array([self.at[name] for name in self.free]).reshape(-1, 3)
        x, rounds, left = self._newton(start, math.inf, DIRECT)
        if left:  # a start that stretches stiff cables: let soft ones find the way
            x, softness = start, 10.0
            while softness * self.weight < max(self.EA.values()):
                x, more, _ = self._newton(x, softness * self.weight, ROUNDS)
                softness, rounds = 100 * softness, rounds + more
            x, more, left = self._newton(x, math.inf, ROUNDS)
            rounds += more
        if left:
            raise CatenaryNetError(
                f"The pulls on the free points must balance, but after {rounds} Newton steps {left:.3g} N of the "
                f"{self.weight:.3g} N carried are left."
            )
        return x, rounds

    def _newton(self, x: np.ndarray, stiffest: float, most: int) -> tuple[np.ndarray, int, float]:
        """At most `most` Newton steps, with no EA above `stiffest` [N].

        Returns positions, the number of steps, and the out-of-balance force (0 if balanced). The energy is convex in the positions,
        so that a step is halved until it does not overshoot the least energy along it.
        """
        curves = self.curves(x, stiffest)
        force = self.residual(curves)
        reach = max((cable.length * (1 + self.weight / self.EA[cable.name]) for cable in self.cables), default=0.0)
        for rounds in range(most + 1):
            size = float(np.linalg.norm(force))
            if size <= TOLERANCE * self.weight:
                return x, rounds, 0.0
            K = self.stiffness(curves)
            if size <= 8 * np.finfo(float).eps * np.abs(K).max() * np.abs(x).max():
                return x, rounds, 0.0  # places hold no more digits than that
            step = np.linalg.lstsq(K, force.ravel(), rcond=1e-14)[0].reshape(x.shape)
            step *= min(1.0, 0.5 * reach / np.abs(step).max())
            downhill = float(np.sum(force * step))
            for _ in range(HALVINGS):
                curves = self.curves(x + step, stiffest)
                force = self.residual(curves)
                if np.sum(force * step) > -0.5 * downhill:
                    break
                step *= 0.5
                downhill *= 0.5
            x = x + step
        return x, most, size

    def net(self, x: np.ndarray, rounds: int) -> CatenaryNet:
        at = {**self.at, **dict(zip(self.free, x, strict=True))}
        found = {cable.name: self.between(cable, at[cable.start], at[cable.end]) for cable in self.cables}
        for cable, held, end in reversed(self.loose):
            found[cable.name], at[end] = self._hang(cable, at[held], self.load[end], upwards=held == cable.end)
        cables = {name: Turned(curve, self.turn) for name, curve in found.items()}
        return CatenaryNet({name: self.turn.T @ xyz for name, xyz in at.items()}, cables, rounds)

    def _hang(self, cable: Cable, top: np.ndarray, load: float, upwards: bool) -> tuple[Catenary, np.ndarray]:
        """A loose cable straight down from `top`, and where its lower end is; `upwards` if it starts there."""
        weight = self.g * cable.mass_per_length * cable.length
        drop = cable.length * (1 + (load + weight / 2) / self.EA[cable.name])
        end = top - [0.0, 0.0, drop]
        start, pull = (end, load) if upwards else (top, -load - weight)
        curve = Catenary.from_end_force(
            start, (0.0, 0.0, pull), cable.length,
            EA=self.EA[cable.name], mass_per_length=cable.mass_per_length, gravity=self.g,
        )  # fmt: skip
        return curve, end


def _end_stiffness(curve: Catenary) -> np.ndarray:
    """Stiffness of a catenary between its ends, (3, 3) [N/m]: force at one end per displacement of the other end."""
    w, L = curve.weight_per_length, curve.length
    V1, V2 = curve.V1, curve.V1 + w * L
    H = max(curve.H, 1e-12 * max(abs(V1), abs(V2)))  # a hairpin's sideways stiffness vanishes as 1/log(1/H)
    T1, T2 = math.hypot(H, V1), math.hypot(H, V2)
    sine = (V2 / T2 - V1 / T1) / w
    across = (math.asinh(V2 / H) - math.asinh(V1 / H)) / w + L / curve.EA  # horizontal chord over H
    mixed = (H / w) * (1 / T2 - 1 / T1)
    flexibility = np.array([[across - sine, mixed], [mixed, sine + L / curve.EA]])
    out, up = np.array([*curve.direction, 0.0]), np.array([0.0, 0.0, 1.0])
    plane = np.array([out, up])
    aside = np.array([out[1], -out[0], 0.0])
    return plane.T @ np.linalg.inv(flexibility) @ plane + np.outer(aside, aside) / across


def _turn_down(down: np.ndarray) -> np.ndarray:
    """A rotation, (3, 3), that takes the unit vector `down` to -z; the identity if it is that already."""
    axis, cosine = np.cross(down, (0.0, 0.0, -1.0)), -down[2]
    if cosine < -1 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + cross + cross @ cross / (1 + cosine)
