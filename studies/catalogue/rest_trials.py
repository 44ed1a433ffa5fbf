"""Random cables that lie partly on the ground: each must come to a stable rest, that of the catenary on the bed, or say why not.

Run as `python -m studies.fuzz rests`.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import fsolve

from anet_lumped import Cable, EquilibriumError, Fixed, Scene, equilibrium
from anet_lumped.effects import Bending, Gravity, Ground, Water
from studies.catalogue.outcome import FAILED, HELD, REFUSED
from studies.catalogue.random_trials import Pick, Random

G, RHO = 9.81, 1025.0
RESOLVED = 0.5  # of the length a = H/w over which a catenary turns at its vertex, that segments and bending may reach to resolve it
NEAR = 0.01  # of H, beside what segments and bending change of it: the squares of their reach over a
FOLD = 90.0  # degrees between next segments, which nothing but a fold makes where the vertex is resolved


@dataclass(frozen=True)
class RestTrial:
    """A cable from an anchor on the bed to a point above it.

    Parameters
    ----------
    scene : Scene
    H : float [N], horizontal tension of the catenary on the bed
    a : float [m], H over the weight per length
    """

    scene: Scene
    H: float
    a: float

    @property
    def resolved(self) -> bool:
        """Whether segments and bending are fine enough for the catenary to be near the truth."""
        return max(self._reaches) < RESOLVED

    @property
    def tolerance(self) -> float:
        """Of H, what the catenary may be off."""
        return NEAR + sum(reach**2 for reach in self._reaches)

    @property
    def _reaches(self) -> tuple[float, float]:
        """A segment, and sqrt(EI/H) from the touchdown that bending acts over; over a."""
        cable = self.scene.cables[0]
        return cable.L0 / self.a, math.sqrt(cable.EI / self.H) / self.a


def draw(pick: Pick) -> RestTrial | None:
    """A random cable of 50 to 500 m, EA of 1e6 to 1e9 N, EI of up to 2e4 N m2, of 30 to 130 segments; None if it hangs freely."""
    length, EA = pick.number(50.0, 500.0), 10.0 ** pick.number(6.0, 9.0)
    height = length * pick.number(0.1, 0.6)
    shortest, longest = length - height, math.sqrt(length**2 - height**2)  # that leave a part of it lying, and all of it hanging
    span = shortest + (longest - shortest) * pick.number(0.05, 0.6)
    diameter = 10.0 ** pick.number(-1.7, -0.6)
    mass = math.pi / 4 * diameter**2 * RHO * pick.number(1.5, 5.0)
    EI, wet = pick.one_of((0.0, 10.0 ** pick.number(0.0, 4.3))), pick.one_of((True, False))
    cable = Cable(
        "anchor", "top", length=length, mass_per_length=mass, EA=EA, EI=EI, segments=pick.integer(30, 130), diameter=diameter,
        compression=pick.one_of(("none", "linear")),
    )  # fmt: skip
    effects = [Gravity(G), Ground(height=0.0), *([Water(density=RHO, level=1e3)] if wet else []), *([Bending()] if EI else [])]
    w = (mass - wet * RHO * math.pi * diameter**2 / 4) * G
    H = _horizontal_tension(length, span, height, EA, w)
    if H is None:
        return None
    return RestTrial(Scene([Fixed("anchor", (-span, 0, 0)), Fixed("top", (0, 0, height))], [cable], effects), H, H / w)


def _horizontal_tension(length, span, height, EA, w):
    """H [N] of an elastic catenary on a bed without friction, or None where all of it hangs.

    Source: Jonkman, NREL/TP-500-41958 (2007), equations 2-37 and 2-38.
    """

    def gaps(logarithms):
        H, V = np.exp(logarithms)
        x = length - V / w + H / w * np.arcsinh(V / H) + H * length / EA
        z = H / w * (np.hypot(1.0, V / H) - 1.0) + V * V / (2.0 * EA * w)
        return (x - span) / length, (z - height) / length

    root, _, found, _ = fsolve(gaps, np.log((0.2 * w * length, 0.7 * w * length)), full_output=True)
    H, V = np.exp(root)
    return float(H) if found == 1 and V < w * length else None


def attempt(trial: RestTrial) -> tuple[str, str]:
    """HELD, FAILED, or REFUSED where segments are too coarse for the shape; and why."""
    try:
        rest = equilibrium(trial.scene)
    except EquilibriumError as error:
        return FAILED if trial.resolved else REFUSED, str(error)
    if not rest.stable:
        return FAILED, "a rest that is not stable came back without a guess"
    d = np.diff(rest.shape("anchor-top"), axis=0)
    unit = d / np.linalg.norm(d, axis=1)[:, None]
    turn = float(np.degrees(np.arccos(np.clip((unit[1:] * unit[:-1]).sum(axis=1), -1.0, 1.0))).max())
    tension = float(rest.tension("anchor-top")[1])
    if trial.resolved and turn > FOLD:
        return FAILED, f"folded by {turn:.0f} degrees"
    if trial.resolved and abs(tension / trial.H - 1.0) > trial.tolerance:
        return FAILED, f"H is {tension:.4g} N where {trial.H:.4g} N is right"
    return HELD, ""


def each(seed: int, first: int, count: int) -> Iterator[dict]:
    """Trials by number as they end, as dicts: number, outcome, why; without those that have no rest on the ground."""
    for number in range(first, first + count):
        trial = draw(Random((seed, number)))
        if trial is not None:
            outcome, why = attempt(trial)
            yield {"number": number, "outcome": outcome, "why": why}
