"""Water with a free surface: buoyancy, drag, and the inertia of the water that cables and payloads push aside.

The force on each end of a segment, and its added mass, are

    f = w (rho g V e_z + drag(u) + rho V ((1 + Can) a_n + (1 + Cat) a_t)) ,    A = w rho V (Can (I - t t^T) + Cat t t^T) ,

with the velocity u of the water minus that of the node and the acceleration a of the water (Morison, see `laws.morison` and
`laws.drag`). w is the share of the segment's volume that is under water and belongs to this end: 1/2 for a segment under water,
with a smooth change at the surface, see `laws.submergence`. V is the unstretched volume. A point with a volume counts as a sphere;
where points do not float, w is 1 for them at any height.
The tension is the effective one of mooring codes, which includes the pressure on a cross-section of the cable.

The velocity of the water is the sum of that of a current, whose acceleration is left out, and that of waves, whose surface limits
the water. In still water buoyancy has an energy, -rho g V times the depth; its work over a whole step is the change of this energy,
so that no step can raise the energy. Where added mass turns with a cable or goes through the surface, the energy 1/2 v.(dA/dt) v is
taken or given, because Morison's equation has no force for dA/dq; it counts as dissipated, with either sign. In a wave the work of
all these forces counts as given by the water. There is no slamming force, no shelter behind other cables, and the current does not
change the length of the wave.

Source
------
DNV-RP-C205 (2010), 6.2; Hall & Goupee, Ocean Eng. 104 (2015) 590, 2; Faltinsen, Sea Loads on Ships and Offshore Structures (1990),
ch. 8 (effective tension).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_flag, check_number, shown
from anet_lumped.effects.flow.waves.base import Wave, check_waves
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.wind import Wind
from anet_lumped.effects.flow.wind.base import as_winds, check_winds, same_at_each_height, steady
from anet_lumped.effects.flow.wind.kernel import pack
from anet_lumped.effects.laws.diameters import check_diameters
from anet_lumped.effects.laws.drag import point_coefficient, segment_coefficients
from anet_lumped.effects.laws.submergence import ALWAYS_UNDER, sphere_diameter

from .effect import Effect, height_under


@dataclass(frozen=True)
class Water(Effect):
    """Hydrostatics and Morison's equation on every cable, which needs a `diameter`, and on free points with a volume or a CdA.

    On rigid bodies it acts by their volume or hull, their `CdA` and on their rods, see `fluid_on_bodies`.

    Statics take the water at t = 0, when a wave with a `ramp` has not risen yet. The step of an explicit method must be short
    against the time in which drag stops a thin cable, (mu + rho Can pi d^2/4)/(rho d Cdn |u|): 1.5 ms for twine of 2 mm at 2 m/s.

    Parameters
    ----------
    density : float [kg/m3]; 1025: sea water
    level : float [m], z of the still surface
    current : None, a wind of `anet_lumped.wind`, or several, whose velocities add up
    wave : None, or a wave of `anet_lumped.waves`, for one alone
    g : float [m/s2], gravity of buoyancy and wave; None: that of the scene, which must then point along -z
    points_float : bool
        Whether a point comes out of the water at its surface; False: points are under water at any height, as MoorDyn has them.
    waves : None, a wave of `anet_lumped.waves`, or several, which add up
    """

    density: float = 1025.0
    level: float = 0.0
    current: Wind | Sequence[Wind] | None = None
    wave: Wave | None = None
    g: float | None = None
    points_float: bool = True
    waves: Wave | Sequence[Wave] | None = None

    coupled_neighbours: ClassVar[int] = 1
    stiff: ClassVar[bool] = True

    def check_parameters(self) -> None:
        owner = self._called
        self._set(
            density=check_number("density", self.density, "kg/m3", owner, sign="positive"),
            level=check_number("level", self.level, "m", owner),
            current=check_winds("current", self.current, owner),
            g=None if self.g is None else check_number("g", self.g, "m/s2", owner, sign="non-negative"),
            points_float=check_flag("points_float", self.points_float, owner),
        )
        if not (self.wave is None or isinstance(self.wave, Wave)):
            raise SceneError(
                f"Argument `wave` must be a wave of anet_lumped.waves or None, but {owner} has wave={shown(self.wave)}."
            )
        self._set(waves=check_waves("waves", self.waves, owner))
        if self.wave is not None and self.waves is not None:
            raise SceneError(f"One of the arguments `wave` and `waves` must be None, but {owner} has both.")

    @property
    def all_waves(self) -> tuple[Wave, ...]:
        """Its wave, or its waves."""
        given = self.wave if self.waves is None else self.waves
        return () if given is None else (given,) if isinstance(given, Wave) else tuple(given)

    @property
    def time_scales(self) -> tuple[float, ...]:
        """2/omega of the shortest wave, as for a point that is shaken."""
        highest = max((wave.highest_frequency for wave in self.all_waves), default=0.0)
        return (2.0 / highest,) if highest > 0.0 else ()

    @property
    def sudden(self) -> tuple[tuple[float, float, float], ...]:
        return tuple(times for current in as_winds(self.current) for times in current.sudden)

    def steady(self) -> Effect:
        left = steady(self.current)
        still = left is self.current and not self.all_waves
        return self if still else replace(self, current=left, wave=None, waves=None)

    def seen_from(self, origin: Vector, scene: Any) -> Effect | None:
        if origin[2] != 0.0 or not same_at_each_height(self.current):
            return None
        waves = tuple(wave.seen_from(origin, self.gravity(scene)) for wave in self.all_waves)
        return self if not waves else replace(self, wave=None, waves=waves)

    def gravity(self, scene: Any) -> float:
        """Acceleration of gravity of buoyancy and wave [m/s2]."""
        if self.g is not None:
            return self.g
        x, y, z = scene.gravity.tolist()
        if x or y or z > 0.0:
            raise SceneError(f"The effect Water needs Gravity along -z, or a `g` of its own, but gravity is {(x, y, z)} m/s2.")
        return -z

    @classmethod
    def example(cls, scene: Any) -> Self:
        return cls(level=height_under(scene))

    def table(self, model: Any) -> tuple[np.ndarray, np.ndarray]:
        """Index and parameters for the compiled functions below.

        Returns
        -------
        index : int64
            Number of segments; both nodes of each; nodes of the points with a volume or a CdA.
        params : float64
            Level [m]; how many numbers describe current and wave, and those numbers; of each segment L0 and d [m], the coefficients
            of drag normal and along [kg/m], buoyancy under water [N], displaced mass [kg], Can, Cat; of each point the diameter of
            its sphere [m], its coefficient of drag [kg/m], buoyancy [N], displaced mass [kg], Ca.

        Raises
        ------
        SceneError : a cable without a diameter, gravity that is not along -z, a wave that would break
        """
        scene = model.scene
        check_diameters(scene.cables, "effect Water")
        g = self.gravity(scene)
        current, wave = pack(self.current), pack_waves(self.all_waves, g, self.level)
        points = scene.loaded_points
        of_cable = np.array([self._of_cable(cable, g) for cable in scene.cables])
        of_point = np.array([self._of_point(point, g) for point in points])
        nodes = [model.node(point.name) for point in points]
        header = [self.level, len(current), len(wave)]
        return (
            np.concatenate([[model.n_segments], model.ends.ravel(), nodes]).astype(np.int64),
            np.concatenate([header, current, wave, of_cable[model.cable_of].ravel(), of_point.ravel()]),
        )

    def _of_cable(self, cable: Any, g: float) -> tuple[float, ...]:
        normal, along = segment_coefficients(self.density, cable)  # of half a segment
        mass = self.density * 0.25 * math.pi * cable.diameter**2 * cable.L0
        return cable.L0, cable.diameter, 2.0 * normal, 2.0 * along, g * mass, mass, cable.Can, cable.Cat

    def _of_point(self, point: Any, g: float) -> tuple[float, ...]:
        mass = self.density * point.volume
        diameter = sphere_diameter(point) if self.points_float else ALWAYS_UNDER
        return diameter, point_coefficient(self.density, point), g * mass, mass, point.Ca

    def on_bodies(self, scene: Any) -> Effect | None:
        if not any(body.displaced > 0.0 or body.has_drag or body.rods for body in scene.bodies if not body.is_driven):
            return None
        from .fluid_on_bodies import FluidOnBodies  # compiled for those scenes alone

        return FluidOnBodies(self.density, self.level, self.current, self.all_waves, self.gravity(scene), floats=self.points_float)

    def on_shedding(self, scene: Any) -> Effect | None:
        if not any(cable.Cl > 0.0 for cable in scene.cables):
            return None
        from .vortex_shedding import VortexShedding  # compiled for those scenes alone

        return VortexShedding(self.density, self.level, self.current, self.all_waves, self.gravity(scene))

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        from importlib import import_module  # water at rest is half of the work, and compiled for itself

        kernels = import_module(
            ".flow." + ("moving_water" if self.all_waves or as_winds(self.current) else "still_water"), __package__
        )
        return {slot: getattr(kernels, slot) for slot in ("force", "tangent", "energy", "whole_step", "inertia")}
