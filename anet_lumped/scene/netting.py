"""Netting: thousands of thin twines, of which one cable of a model stands for many.

A cable that stands for n twines beside each other has n times the mass, the stiffness and the drag of one, and their volume:

    mu = n mu_1 ,   EA = n EA_1 ,   d = sqrt(n) d_1 ,   Cdn = sqrt(n) Cdn_1 ,   Cdt = sqrt(n) Cdt_1 ,

so that d Cdn = n d_1 Cdn_1 and pi d^2/4 = n pi d_1^2/4: drag, weight, buoyancy and added mass of a coarse net are those of all of
its twines.

A net across a stream slows the water and drives it faster through its meshes. With the solidity Sn, the share of its outline that
its twines and knots cover, its drag on the area of the outline is

    C_D = c(Re) Sn (2 - Sn)/(2 (1 - Sn)^2) ,    Re = u d_1/(nu (1 - Sn)) ,

with the drag coefficient c of a circular cylinder. Cdn_1 shares that drag out among the twines, 2 d_1/bar on a unit of area.
To other angles the drag goes over by the cross-flow principle of the laws of drag; what lies in the wake of a net meets the same
water as it.

Source
------
Kristiansen & Faltinsen, J. Fluids Struct. 34 (2012) 218, section 2 (screen model; c(Re) is their fit of measurements in Goldstein,
Modern Developments in Fluid Dynamics (1965), for 10^1.5 < Re < 10^4).
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, check_number

CYLINDER = (-78.46675, 254.73873, -327.8864, 223.64577, -87.92234, 20.00769, -2.44894, 0.12479)  # c(Re), powers of log10 Re
LEAST_RE, LARGEST_RE = 10.0**1.5, 1e4
MOST_SOLID = 0.5  # share of the outline: above it meshes are jets in a wall, and no screen
ALONG = 0.01  # drag coefficient along a twine, that of `Cable`


@dataclass(frozen=True)
class Netting:
    """The meshes of a net: square or diamond ones of one twine.

    Parameters
    ----------
    diameter : float [m], of the twine
    bar : float [m], length of the side of a mesh, from knot to knot
    EA : float [N], axial stiffness of one twine
    speed : float [m/s], of the water or air across the net, for which drag coefficients are taken
    density : float [kg/m3], of the twine; 1140: nylon
    knot_diameter : float [m], of a sphere as large as a knot; 0 without knots
    viscosity : float [m2/s], kinematic; 1.19e-6: sea water at 15 °C

    Raises
    ------
    SceneError : a number that cannot be; more than half of the outline covered; a speed at which the fit does not hold
    """

    diameter: float = field(kw_only=True)
    bar: float = field(kw_only=True)
    EA: float = field(kw_only=True)
    speed: float = field(kw_only=True)
    density: float = field(default=1140.0, kw_only=True)
    knot_diameter: float = field(default=0.0, kw_only=True)
    viscosity: float = field(default=1.19e-6, kw_only=True)

    def __post_init__(self) -> None:
        units = {"diameter": "m", "bar": "m", "EA": "N", "speed": "m/s", "density": "kg/m3", "viscosity": "m2/s"}
        for key, unit in units.items():
            object.__setattr__(self, key, check_number(key, getattr(self, key), unit, "netting", sign="positive"))
        knot = check_number("knot_diameter", self.knot_diameter, "m", "netting", sign="non-negative")
        object.__setattr__(self, "knot_diameter", knot)
        if not self.solidity < MOST_SOLID:
            raise SceneError(
                f"Netting must cover less than {MOST_SOLID:g} of its outline, but twine of {self.diameter:g} m in meshes of "
                f"{self.bar:g} m covers {self.solidity:.3g}."
            )
        if not LEAST_RE <= self.reynolds <= LARGEST_RE:
            raise SceneError(
                f"The drag of netting is known from Re={LEAST_RE:.0f} to {LARGEST_RE:.0f}, but twine of {self.diameter:g} m at "
                f"speed={self.speed:g} m/s has Re={self.reynolds:.3g}."
            )

    @property
    def solidity(self) -> float:
        """Share Sn of the outline that twines and knots cover."""
        crossing = self.diameter**2
        knot = max(0.25 * math.pi * self.knot_diameter**2 - crossing, 0.0)
        return (2.0 * self.diameter * self.bar - crossing + knot) / self.bar**2

    @property
    def reynolds(self) -> float:
        """Reynolds number of a twine at the speed between the twines."""
        return self.speed * self.diameter / (self.viscosity * (1.0 - self.solidity))

    @property
    def outline_drag(self) -> float:
        """Drag coefficient C_D on the area of the outline, across the stream."""
        of_cylinder = sum(a * math.log10(self.reynolds) ** k for k, a in enumerate(CYLINDER))
        return of_cylinder * self.solidity * (2.0 - self.solidity) / (2.0 * (1.0 - self.solidity) ** 2)

    @property
    def knot_mass(self) -> float:
        """Mass of a knot beyond that of the two twines that pass through it [kg]."""
        d, D = self.diameter, self.knot_diameter
        return self.density * math.pi * max(D**3 / 6.0 - 0.5 * d * d * D, 0.0)

    def cable(self, twines: float) -> dict[str, Any]:
        """Arguments of a `Cable` that stands for so many twines beside each other."""
        beside = math.sqrt(twines)
        return {
            "mass_per_length": twines * self.density * 0.25 * math.pi * self.diameter**2,
            "EA": twines * self.EA,
            "diameter": beside * self.diameter,
            "Cdn": beside * self.outline_drag * self.bar / (2.0 * self.diameter),
            "Cdt": beside * ALONG,
        }

    def knots(self, count: float) -> dict[str, float]:
        """Mass [kg] and volume [m3] of a `Free` point that stands for so many knots; their drag is that of the twines."""
        return {"mass": count * self.knot_mass, "volume": count * self.knot_mass / self.density}


class Twines:
    """How many twines and knots of a netting the cables and points of a grid stand for.

    Parameters
    ----------
    netting : Netting
    corners : (4, 3) float64 [m], of the field
    counts : (2,) int, steps of the lattice along its sides
    diagonal : bool, whether bars run across the field
    """

    def __init__(self, netting: Netting, corners: np.ndarray, counts: tuple[int, int], diagonal: bool) -> None:
        a, b, c, d = corners
        steps = 0.5 * (b + c - a - d) / counts[0], 0.5 * (c + d - a - b) / counts[1]  # in the middle of the field
        self.netting, self.counts, self.diagonal = netting, counts, diagonal
        if diagonal:
            self.bars = tuple(float(np.linalg.norm(steps[1] + sign * steps[0])) / netting.bar for sign in (1.0, -1.0))
        else:
            self.bars = tuple(float(np.linalg.norm(step)) / netting.bar for step in steps)

    def _line(self, axis: int, k: int) -> float:
        """Twines that the k-th line of cables across an axis stands for: half of those up to the next line on either side."""
        return 0.5 * (self.bars[axis] + 1.0) if k in (0, self.counts[axis]) else self.bars[axis]

    def of_bar(self, i: int, j: int, towards: int) -> float:
        """Twines of the bar from the point (i, j) that goes on ``towards`` along the first side."""
        if self.diagonal:
            return self.bars[0 if towards > 0 else 1]
        return self._line(1, j) if towards else self._line(0, i)

    def knots(self, i: int, j: int) -> float:
        """Knots of the point (i, j); of diagonal meshes those of its field, which a side halves."""
        if not self.diagonal:
            return self._line(0, i) * self._line(1, j)
        return self.bars[0] * self.bars[1] * 0.5 ** ((i in (0, self.counts[0])) + (j in (0, self.counts[1])))
