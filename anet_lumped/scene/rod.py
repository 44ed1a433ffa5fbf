"""A slender rod, part of a rigid body: a spar, a leg, a frame's member; or, alone, the whole body."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_count, check_name, check_number, check_vector, quoted

from .body_mass import Mass


@dataclass(frozen=True)
class Rod:
    """A straight cylinder on a body, cut into segments whose nodes air, water and ground act on as on those of a cable.

    It adds its mass and the inertia of a solid cylinder to those of its body. Water lifts its submerged length, acts across and
    along its segments by the coefficients of a cable, and on its end caps. The caps are taken flat, and small against the length.

    Parameters
    ----------
    name : name of the rod, unique in its body
    start, end : (3,) array_like [m], centres of its end caps in the axes of the body
    diameter : float [m]
    mass_per_length : float [kg/m]; 0 for a rod whose mass the body counts already
    segments : int
    Cdn, Cdt : drag coefficients across and along it, on d L and on pi d L
    Can, Cat : added-mass coefficients across and along it
    Cd_end : drag coefficient of each end cap along the rod, on pi d^2/4
    Ca_end : added mass of each end cap along the rod, over that of the fluid in a half sphere; 2/pi: a flat disc

    Source
    ------
    Hall, MoorDyn V2: new capabilities in mooring system components and load cases, ASME IOWTC (2020), for the law of a rod;
    Lamb, Hydrodynamics (1932), art. 102, for the disc, whose one side has the added mass rho d^3/6.
    """

    name: str
    start: Vector
    end: Vector
    diameter: float = field(kw_only=True)
    mass_per_length: float = field(default=0.0, kw_only=True)
    segments: int = field(default=10, kw_only=True)
    Cdn: float = field(default=1.2, kw_only=True)
    Cdt: float = field(default=0.01, kw_only=True)
    Can: float = field(default=1.0, kw_only=True)
    Cat: float = field(default=0.0, kw_only=True)
    Cd_end: float = field(default=1.0, kw_only=True)
    Ca_end: float = field(default=2.0 / math.pi, kw_only=True)

    def __post_init__(self) -> None:
        owner = f"rod {quoted(check_name(self.name, 'rod'))}"
        checked: dict[str, Any] = {key: check_vector(key, getattr(self, key), "m", owner) for key in ("start", "end")}
        checked["diameter"] = check_number("diameter", self.diameter, "m", owner, sign="positive")
        checked["segments"] = check_count("segments", self.segments, owner)
        for key in ("mass_per_length", "Cdn", "Cdt", "Can", "Cat", "Cd_end", "Ca_end"):
            unit = "kg/m" if key == "mass_per_length" else ""
            checked[key] = check_number(key, getattr(self, key), unit, owner, sign="non-negative")
        for key, value in checked.items():
            object.__setattr__(self, key, value)
        if not self.length > 0.0:
            raise SceneError(f"A rod must have a length, but {owner} starts and ends at {self.start} m.")

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(np.linalg.norm(np.subtract(self.end, self.start)))

    @property
    def L0(self) -> float:
        """Length of a segment [m]."""
        return self.length / self.segments

    @property
    def nodes(self) -> list[Vector]:
        """Places of the nodes from start to end in the axes of the body (segments + 1) of (3,) [m]."""
        start, end = np.array(self.start), np.array(self.end)
        return [tuple((start + s * (end - start)).tolist()) for s in np.linspace(0.0, 1.0, self.segments + 1)]

    @property
    def mass(self) -> Mass:
        """`Mass` of a solid cylinder."""
        m, d, l = self.mass_per_length * self.length, self.diameter, self.length
        axis = np.subtract(self.end, self.start) / l
        across, along = m * (3.0 * (0.5 * d) ** 2 + l * l) / 12.0, 0.5 * m * (0.5 * d) ** 2
        inertia = across * np.eye(3) + (along - across) * np.outer(axis, axis)
        return Mass(m, 0.5 * np.add(self.start, self.end), inertia)
