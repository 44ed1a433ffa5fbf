"""Predicted stability: the step, damping and stretch that each scheme permits, known before any run.

Everything rests on the scalar test equation x'' + 2 zeta omega x' + omega^2 x = 0 with omega and zeta of the top axial
mode: in one cable with damping in proportion to its stiffness every lower mode is stable where the top one is. Swings
(transverse motion) are slower than the axial modes, but no axial damper acts on them. A rate [1/s] of mass-proportional
damping adds to 2 zeta omega for every mode. Limits are functions of arrays, so that borders can be drawn.

A scheme's limit is that of its record (`integrators.schemes`); implicit schemes have none, and the record's note says what this
linear statement leaves open.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from anet_lumped.checks import InputError, nearest, quoted
from anet_lumped.model.tables import AXIAL_L0
from anet_lumped.scene.scene import Cable, Scene, check_scene
from integrators.schemes import MODULES, names
from integrators.schemes import scheme as record_of

if TYPE_CHECKING:
    from anet_lumped.results.state import State


@dataclass(frozen=True)
class TopMode:
    """Fastest axial mode of a cable: `omega` [rad/s] and `zeta`, the damping ratio that its dampers give this mode."""

    cable: str
    omega: float
    zeta: float


@dataclass(frozen=True)
class SchemeLimit:
    """Largest stable step [s] of a scheme for a whole scene, with the cable that sets it ("" if none does).

    `step` is the smaller of `axial` (top axial modes) and `swing` (transverse modes, which no axial damper reaches).
    """

    step: float
    axial: float
    swing: float
    cable: str
    note: str


@dataclass(frozen=True)
class Prediction:
    """A scene's stability before any run: modes by cable, mass-proportional damping [1/s], limits by scheme."""

    modes: dict[str, TopMode]
    rate: float
    limits: dict[str, SchemeLimit]

    def stretch_floor(self, scheme: str, dt: float, cable: str, strain: float) -> float:
        """Smallest static stretch of a cable that a step dt [s] permits, `strain` being its T/EA now."""
        mode = self.modes[cable]
        return stretch_floor(scheme, dt, mode.omega, strain, mode.zeta, self.rate)

    def warning(self, scheme: str, dt: float) -> str:
        """Return a sentence with both numbers if a step dt [s] is beyond the limit of `scheme`, or ""."""
        limit = self.limits[scheme]
        if dt <= limit.step:
            return ""
        if limit.step == 0.0:
            return f'Method "{scheme}" is stable at no step here, and dt={dt:g} s was given: {limit.note}.'
        if not limit.cable:
            return (
                f'Step dt={dt:g} s is beyond the largest stable step of "{scheme}", {limit.step:.3g} s, set by the damping of '
                f'{self.rate:.3g} 1/s; take a smaller step or an implicit method such as "edmc".'
            )
        mode = self.modes[limit.cable]
        return (
            f'Step dt={dt:g} s is beyond the largest stable step of "{scheme}", {limit.step:.3g} s, set by cable '
            f"{quoted(limit.cable)} (top frequency {mode.omega:.4g} rad/s, damping ratio {mode.zeta:.3g}); "
            'take a smaller step or an implicit method such as "edmc".'
        )


def step_limit(scheme: str, omega: float | np.ndarray, zeta: float | np.ndarray = 0.0, rate: float | np.ndarray = 0.0) -> Any:
    """Largest step up to which a scheme is stable for one mode.

    Spectral radius of the amplification matrix <= 1, with d = 2 zeta omega + rate: explicit Euler h omega^2 <= d and
    h <= 4/(d + sqrt(d^2 - 4 omega^2)) if overdamped; symplectic Euler h^2 omega^2 + 2 d h <= 4; Verlet
    h^2 omega^2 + 4 d h <= 4, all three by Jury's criterion; Runge-Kutta |R(h lambda)| <= 1 by bisection.

    Parameters
    ----------
    scheme : name of the scheme; InputError if it does not exist
    omega, zeta, rate : float or array_like, frequency [rad/s], damping ratio and mass-proportional damping [1/s]

    Returns
    -------
    h : float or array [s]; 0 if no step is stable, inf if every step is
    """
    limit, omega, zeta, rate = _checked(scheme, omega=omega, zeta=zeta, rate=rate)
    with np.errstate(divide="ignore", invalid="ignore"):
        return limit.largest_step(omega, 2.0 * zeta * omega + rate)[()]


def damping_limit(scheme: str, omega: float | np.ndarray, dt: float | np.ndarray, rate: float | np.ndarray = 0.0) -> Any:
    """Largest damping ratio that is stable at a step dt; in dampers BA = 2 zeta EA/omega, c = 2 zeta k/omega.

    With x = omega dt: symplectic Euler (4 - x^2)/(4x); Verlet (4 - x^2)/(8x); else (X/x + x/X)/2, where X ends the
    scheme's interval on the negative real axis (2 for explicit Euler, 2.785 for RK4). Less damping than this may be
    unstable too: explicit Euler needs zeta >= x/2, and Runge-Kutta regions have waists.

    Arguments in [rad/s], [s], [1/s], floats or arrays. Returns -inf if no damping is stable, inf if any is.
    """
    limit, omega, dt, rate = _checked(scheme, omega=omega, dt=dt, rate=rate)
    with np.errstate(divide="ignore", invalid="ignore"):
        zeta = limit.largest_damping_ratio(omega * dt) - np.where(rate > 0.0, rate / (2.0 * omega), 0.0)
    return np.where(zeta >= 0.0, zeta, -np.inf)[()]


def frequency_limit(scheme: str, dt: float | np.ndarray, zeta: float | np.ndarray = 0.0, rate: float | np.ndarray = 0.0) -> Any:
    """Highest frequency [rad/s] that is stable at a step dt [s]: the inverse of `step_limit`; inf if every one is."""
    limit, dt, zeta, rate = _checked(scheme, dt=dt, zeta=zeta, rate=rate)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (limit.highest_frequency(zeta, rate * dt) / dt)[()]


def stretch_floor(
    scheme: str,
    dt: float | np.ndarray,
    omega: float | np.ndarray,
    strain: float | np.ndarray,
    zeta: float | np.ndarray = 0.0,
    rate: float | np.ndarray = 0.0,
) -> Any:
    """Smallest static stretch that a step permits: EA lowered, or raised, to where the step is just stable.

    eps = (T/EA) (omega/omega_s)^2, omega_s the highest frequency stable at dt; since omega^2 grows as EA, EA drops
    out. It holds for a tension that does not depend on EA.

    `omega` [rad/s] and `strain` are the cable's top frequency and static stretch T/EA, both at the same EA. Returns
    inf if no stiffness is stable at the step, 0 if every one is.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(strain) * (omega / frequency_limit(scheme, dt, zeta, rate)) ** 2


def hanging_stretch_floor(
    scheme: str,
    dt: float | np.ndarray,
    length: float | np.ndarray,
    segments: float | np.ndarray,
    gravity: float = 9.81,
    zeta: float | np.ndarray = 0.0,
    rate: float | np.ndarray = 0.0,
) -> Any:
    """Smallest mean stretch that a step permits for a cable hung from one end, whatever its mass and material.

    eps = 2 g N^2 dt^2/(S^2 L), S = omega_s dt: `stretch_floor` with T = mu g L/2 and omega = (2N/L) sqrt(EA/mu), which
    is above the exact top frequency by 1/cos(pi/4N). In [s], [m], 1, [m/s^2], 1, [1/s]; floats or arrays.
    """
    length = np.asarray(length, float)
    return stretch_floor(scheme, dt, 2.0 * np.asarray(segments) / length, gravity * length / 2.0, zeta, rate)


def top_mode(cable: Cable, start_mass: float = np.inf, end_mass: float = np.inf) -> TopMode:
    """Exact top axial mode of a cable drawn straight.

    omega_j = (2/L0) sqrt(EA/mu) sin(j pi/2N), j = 1 .. N-1, between fixed ends (the default), sin((2j-1) pi/4N),
    j = 1 .. N, with one loose end of half a segment's mass; the tridiagonal eigenvalue for any mass at the ends.
    Then zeta = c omega/2k, which is the segment's damping ratio times the sine. A crooked cable is slower than a
    straight one, and so is its transverse motion: the stiffness T/l of a segment is below k. `start_mass` and
    `end_mass` [kg] are all that the end nodes carry, inf if they are fixed or driven.
    """
    if cable.segments == 1:  # of a net there may be thousands
        omega = math.sqrt(cable.stiffness * (1.0 / start_mass + 1.0 / end_mass))
        return TopMode(cable.name, omega, cable.dashpot / cable.stiffness * omega / 2.0)
    from scipy.linalg import eigh_tridiagonal

    mass = np.full(cable.segments + 1, cable.mass_per_length * cable.L0)
    mass[0], mass[-1] = start_mass, end_mass
    springs = np.r_[1.0, np.full(cable.segments - 1, 2.0), 1.0]
    moves = np.isfinite(mass)
    mass, springs, omega = mass[moves], springs[moves], 0.0
    if len(mass):
        beside, last = -1.0 / np.sqrt(mass[:-1] * mass[1:]), (len(mass) - 1,) * 2
        top = eigh_tridiagonal(springs / mass, beside, eigvals_only=True, select="i", select_range=last)
        omega = float(np.sqrt(cable.stiffness * top[0]))
    return TopMode(cable.name, omega, cable.dashpot / cable.stiffness * omega / 2.0)


def top_modes(scene: Scene) -> dict[str, TopMode]:
    """Top mode of each cable of a scene, by name; the highest is a rigorous bound of the scene's frequencies.

    Cables that meet share the mass of their point in proportion to their stiffness. With M and K sums over the
    cables, max x'Kx/x'Mx is at most the largest of the cables' own quotients (Irons and Treharne, "A bound theorem in
    eigenvalues and its practical applications", 1971); a single cable's is exact.
    """
    mass = {point.name: np.inf for point in scene.all_points} | {point.name: point.mass for point in scene.free_points}
    for body in scene.bodies:
        mass |= {} if body.is_driven else body.least_masses
    stiffness = dict.fromkeys(mass, 0.0)
    elastic = [cable for cable in scene.cables if not cable.inextensible]
    for cable in scene.cables:
        for point in (cable.start, cable.end):
            mass[point] += cable.half_segment_mass
            stiffness[point] += 0.0 if cable.inextensible else cable.stiffness

    share = {name: mass[name] / stiffness[name] for name in mass if stiffness[name]}
    modes = {c.name: TopMode(c.name, np.inf, 0.0) for c in scene.cables}  # of those that do not stretch
    return modes | {c.name: top_mode(c, c.stiffness * share[c.start], c.stiffness * share[c.end]) for c in elastic}


def transverse_frequency(state: "State") -> float:
    """Bound of the frequencies of transverse vibrations under the tensions of a state [rad/s], by Gershgorin's circles.

    omega^2 <= max 2 W_i sum T/l over the segments at node i, with the mobility W_i; in a uniform cable it is the highest frequency
    of a chain, 2 sqrt(T/(m l)). The nodes of a body move together: W_i sum T/l is summed over them, with the largest W_i of each.
    """
    model = state.model
    pull = np.maximum(state.segment_tension, 0.0) / model.axial[model.cable_of, AXIAL_L0]
    at_node = np.bincount(model.ends[:, 0], pull, model.n) + np.bincount(model.ends[:, 1], pull, model.n)
    mass, alone = model.mass[: model.n_free], model.bodies.first  # nodes that no body carries come first
    moves = np.flatnonzero(mass[:alone] > 0.0)
    squares = [np.max(at_node[moves] / mass[moves], initial=0.0)]
    for body in model.scene.bodies:
        if not body.is_driven:
            squares.append(sum(at_node[model.node_of[name]] / least for name, least in body.least_masses.items()))
    return float(np.sqrt(2.0 * max(squares)))


def predict(scene: Scene, strain: float = 0.1, schemes: tuple[str, ...] | None = None) -> Prediction:
    """Predict the stability of some schemes for a scene, without a run; None: of all of them, explicit ones first.

    `strain` is the largest stretch expected in the motion: swings stay below omega sqrt(strain/(1 + strain)).
    """
    check_scene(scene)
    wanted = names(explicit=True) + names(explicit=False) if schemes is None else schemes
    rate = float(sum(effect.mass_damping_rate for effect in scene.effects))
    modes, limits = top_modes(scene), {}
    rigid = next((mode.cable for mode in modes.values() if mode.omega == np.inf), None)
    if rigid is not None:
        able = " and ".join(names(takes_rigid_springs=True) + names(keeps_constraints=True))
        note = f"only {able} take a cable that does not stretch, such as {quoted(rigid)} with EA=inf"
        none = SchemeLimit(0.0, 0.0, 0.0, rigid, note)
        for one in map(record_of, wanted):
            limits[one.name] = SchemeLimit(np.inf, np.inf, np.inf, "", one.note) if one.takes_rigid_springs else none
        return Prediction(modes, rate, limits)
    kinds: dict[str, TopMode] = {}  # the first of each: nets have thousands that rounding tells apart
    for mode in modes.values():
        kinds.setdefault(f"{mode.omega:.7g} {mode.zeta:.7g}", mode)
    unlike = list(kinds.values()) or [TopMode("", 0.0, 0.0)]  # without cables nothing vibrates
    omega, zeta = np.array([(mode.omega, mode.zeta) for mode in unlike]).T
    for one in map(record_of, wanted):
        axial = step_limit(one.name, omega, zeta, rate)
        swing = step_limit(one.name, omega * np.sqrt(strain / (1.0 + strain)), 0.0, rate)
        step = np.minimum(axial, swing)
        cable = unlike[step.argmin()].cable if np.isfinite(step.min()) else ""
        limits[one.name] = SchemeLimit(float(step.min()), float(axial.min()), float(swing.min()), cable, one.note)
    return Prediction(modes, rate, limits)


def _checked(scheme: str, **values: float | np.ndarray) -> list:
    """The limit of a scheme, and values as float arrays of one shape; InputError for an unknown scheme or a negative value."""
    if not isinstance(scheme, str) or scheme not in MODULES:
        hint = nearest(scheme, MODULES) or ", known are " + ", ".join(MODULES) + "."
        raise InputError(f"Argument `scheme` must name a scheme, but is {quoted(scheme)}{hint}")
    for name, value in values.items():
        if not np.all(np.asarray(value) >= 0.0):
            raise InputError(f"Argument `{name}` must not be negative or NaN, but is {value}.")
    return [record_of(scheme).limit, *np.broadcast_arrays(*(np.asarray(value, float) for value in values.values()))]
