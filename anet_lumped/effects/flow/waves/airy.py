"""A regular wave.

With the phase angle theta = k s - omega t + phase, the amplitude a times its growth r(t), and the stretched height Z of a place,
the elevation eta of the surface and the velocities u along the wave and w upwards are

    eta = r a cos(theta) ,
    u = r a omega cosh(k (Z + depth))/sinh(k depth) cos(theta) ,    w = r a omega sinh(k (Z + depth))/sinh(k depth) sin(theta) ,

see `kernel` for the stretching.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_number
from anet_lumped.compiled.jit import inlined, on_demand
from anet_lumped.prescribed.smoothstep_kernel import ramped

from .base import Wave, check_depth_and_ramp, check_level_direction, highest_wave


@dataclass(frozen=True)
class Airy(Wave):
    """A regular wave of small height: eta = height/2 cos(k s - omega t + phase), s along `direction`, omega^2 = g k tanh(k depth).

    Parameters
    ----------
    height : float [m], from trough to crest
    period : float [s]
    direction : (3,) array_like, level; where the wave goes; any length but zero
    depth : float [m], of the water below the still surface; inf for deep water
    phase : float [rad]; 0: a crest at the origin at t = 0
    ramp : float [s], over which the wave grows from nothing by the quintic smoothstep 6s⁵−15s⁴+10s³; 0: it is there at t = 0

    Source
    ------
    DNV-RP-C205 (2010), 3.3.2; Airy, Tides and Waves (1845); Miche, Ann. Ponts Chauss. 114 (1944), for the limit of the height.
    """

    height: float
    period: float
    direction: Vector = (1.0, 0.0, 0.0)
    depth: float = math.inf
    phase: float = 0.0
    ramp: float = 0.0

    def __post_init__(self) -> None:
        owner = "wave Airy"
        for key, unit, sign in (("height", "m", "non-negative"), ("period", "s", "positive"), ("phase", "rad", "")):
            object.__setattr__(self, key, check_number(key, getattr(self, key), unit, owner, sign=sign))
        check_depth_and_ramp(self, owner)
        object.__setattr__(self, "direction", check_level_direction(self.direction, owner))

    @property
    def frequency(self) -> float:
        """Circular frequency omega = 2 pi/period [rad/s]."""
        return 2.0 * math.pi / self.period

    @property
    def highest_frequency(self) -> float:
        """Circular frequency [rad/s]."""
        return self.frequency

    @property
    def usual_period(self) -> float:
        """Period [s]."""
        return self.period

    def rows(self, g: float) -> np.ndarray:
        """The wave itself, see `Wave`."""
        return np.array([[0.5 * self.height, self.frequency, self.phase, self.direction[0], self.direction[1]]])

    def seen_from(self, origin: Vector, g: float) -> "Airy":
        """The same wave in coordinates whose origin lies at ``origin`` (3,) [m] of today's, for gravity g [m/s2]."""
        along = sum(x * d for x, d in zip(origin, self.direction, strict=True))
        return replace(self, phase=math.remainder(self.wave_number(g) * along + self.phase, 2.0 * math.pi))

    def numbers(self, g: float, level: float) -> np.ndarray:
        """Numbers that its compiled function reads, (9,) float64, for gravity g [m/s2] and a still surface at z = level [m]."""
        if not g > 0.0:
            raise SceneError(f"A wave needs gravity, but wave Airy has g={g} m/s2.")
        k, (x, y, _) = self.wave_number(g), self.direction
        highest = highest_wave(k, self.depth)
        if self.height > highest:
            raise SceneError(
                f"Argument `height` must be below {highest:.4g} m, where a wave of this period breaks, but wave Airy has "
                f"height={self.height}."
            )
        return np.array([0.5 * self.height, k, self.frequency, self.phase, x, y, self.depth, self.ramp, level])

    def kernel(self) -> Callable[..., Any]:
        """Compiled function, see `kernel.wave_at`."""
        return _motion


@inlined
def _gradient(along_x, along_y, u_s, u_z, w_s, w_z):
    """Gradient (9,) of a velocity with the component u along the level unit vector (along_x, along_y) and w upwards.

    Its slopes are those along it, with suffix s, and those in z.
    """
    return (
        along_x * along_x * u_s, along_x * along_y * u_s, along_x * u_z,
        along_x * along_y * u_s, along_y * along_y * u_s, along_y * u_z,
        along_x * w_s, along_y * w_s, w_z,
    )  # fmt: skip


@on_demand
def _motion(t, x, y, z, wave):
    amplitude, k, omega, start_phase, along_x, along_y = wave[0], wave[1], wave[2], wave[3], wave[4], wave[5]
    depth, ramp, still_level = wave[6], wave[7], wave[8]
    theta = k * (along_x * x + along_y * y) - omega * t + start_phase
    cos, sin = math.cos(theta), math.sin(theta)
    growth, growth_rate, _ = ramped(t, ramp)
    height, height_rate = growth * amplitude, growth_rate * amplitude
    eta, eta_s = height * cos, -height * k * sin
    per_stretch = 1.0 / (1.0 + eta / depth)
    Z = (z - still_level - eta) * per_stretch
    Z_z, Z_eta = per_stretch, -per_stretch * (1.0 + Z / depth)
    if Z > 0.0:
        Z, Z_z, Z_eta = 0.0, 0.0, 0.0
    elif Z < -depth:
        Z, Z_z, Z_eta = -depth, 0.0, 0.0
    # cosh and sinh of k (Z + depth) over sinh(k depth), and their slopes; a suffix marks what a derivative is taken by
    up, down, bottom = math.exp(k * Z), math.exp(-k * (Z + 2.0 * depth)), 1.0 / (1.0 - math.exp(-2.0 * k * depth))
    cosh, sinh = (up + down) * bottom, (up - down) * bottom
    cosh_z, sinh_z, cosh_s, sinh_s = k * sinh * Z_z, k * cosh * Z_z, k * sinh * Z_eta * eta_s, k * cosh * Z_eta * eta_s
    # the velocity along the wave is swing_u cosh, that upwards swing_w sinh
    swing_u, swing_w = height * omega * cos, height * omega * sin
    swing_u_t = height * omega * omega * sin + height_rate * omega * cos
    swing_w_t = -height * omega * omega * cos + height_rate * omega * sin
    swing_u_s, swing_w_s = -k * swing_w, k * swing_u
    swing_u_ts = k * (height * omega * omega * cos - height_rate * omega * sin)
    swing_w_ts = k * (height * omega * omega * sin + height_rate * omega * cos)
    u, w, u_t, w_t = swing_u * cosh, swing_w * sinh, swing_u_t * cosh, swing_w_t * sinh
    return (
        (eta, height_rate * cos + height * omega * sin, along_x * eta_s, along_y * eta_s),
        (along_x * u, along_y * u, w),
        _gradient(
            along_x, along_y,
            swing_u_s * cosh + swing_u * cosh_s, swing_u * cosh_z, swing_w_s * sinh + swing_w * sinh_s, swing_w * sinh_z,
        ),
        (along_x * u_t, along_y * u_t, w_t),
        _gradient(
            along_x, along_y,
            swing_u_ts * cosh + swing_u_t * cosh_s, swing_u_t * cosh_z,
            swing_w_ts * sinh + swing_w_t * sinh_s, swing_w_t * sinh_z,
        ),
    )  # fmt: skip
