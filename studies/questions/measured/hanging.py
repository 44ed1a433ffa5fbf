"""A hanging cable for which other codes have published their tensions, under water between ends 100 m apart and 50 m in height.

Source
------
Documentation of FRyDoM, benchmark "hanging cable" (`docs/theory/src/benchmark/hanging_cable.rst` of srmainwaring/frydom), with the
numbers of OrcaFlex, DeepLines Wind and FRyDoM.
"""

import math

import numpy as np

from anet_lumped import Cable, Fixed, Scene, catenary, equilibrium
from anet_lumped.effects import Gravity

LENGTH, EA, MASS, DIAMETER = 170.0, 5e8, 165.0, 0.396  # [m], [N], [kg/m], [m]
BOTTOM, TOP = (0.0, 0.0, -55.0), (100.0, 0.0, -5.0)  # [m]
WATER, GRAVITY = 1000.0, 9.81  # [kg/m3], [m/s2]
WEIGHT = GRAVITY * (MASS - WATER * math.pi / 4.0 * DIAMETER**2)  # [N/m] in water
PUBLISHED = {  # tensions at the top and at the bottom, and the horizontal one [kN]
    "OrcaFlex": (47.11, 26.6, 11.4),
    "DeepLines Wind": (46.64, 26.63, 11.47),
    "FRyDoM": (47.14, 26.63, 11.47),
}
EXACT = "elastic catenary"
SEGMENTS = (20, 320)


def rows() -> list[dict]:
    """A line for each code: tensions at the top and at the bottom and the horizontal one [kN]."""
    curve = catenary(BOTTOM, TOP, LENGTH, EA=EA, mass_per_length=WEIGHT / GRAVITY, gravity=GRAVITY)
    bottom, top = curve.tension([0.0, LENGTH])
    found = {EXACT: (top, bottom, abs(curve.end_forces[0, 0]))}
    found |= {f"this library, {segments} segments": _lumped(segments) for segments in SEGMENTS}
    found = {code: tuple(float(one) / 1e3 for one in of_code) for code, of_code in found.items()} | PUBLISHED
    names = ("top_kN", "bottom_kN", "horizontal_kN")
    return [{"code": code} | dict(zip(names, of_code, strict=True)) for code, of_code in found.items()]


def _lumped(segments):
    """Forces of the lumped cable on its supports, those on the half segments at its ends included [N]."""
    from anet_lumped.effects import Water

    cable = Cable("bottom", "top", length=LENGTH, mass_per_length=MASS, EA=EA, segments=segments, diameter=DIAMETER)
    scene = Scene([Fixed("bottom", BOTTOM), Fixed("top", TOP)], [cable], [Gravity(GRAVITY), Water(density=WATER)])
    rest = equilibrium(scene)
    tension, shape = rest.tension(cable.name), rest.shape(cable.name)
    half = 0.5 * WEIGHT * LENGTH / segments
    ends = []
    for pull, along in ((tension[-1], shape[-2] - shape[-1]), (tension[0], shape[1] - shape[0])):
        ends.append(pull * along / np.linalg.norm(along) - (0.0, 0.0, half))
    return np.linalg.norm(ends[0]), np.linalg.norm(ends[1]), abs(ends[0][0])
