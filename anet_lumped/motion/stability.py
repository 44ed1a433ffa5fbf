"""Predicted stability: the step, damping and stretch that each scheme permits, known before any run.

Everything rests on the scalar test equation x'' + 2 zeta omega x' + omega^2 x = 0 with omega and zeta of the top axial
mode: in one cable with damping in proportion to its stiffness every lower mode is stable where the top one is. Swings
(transverse motion) are slower than the axial modes, but no axial damper acts on them. A rate [1/s] of mass-proportional
damping adds to 2 zeta omega for every mode. Limits are functions of arrays, so that borders can be drawn.

Implicit schemes have no limit of the step (`inf`); what this linear statement leaves open is in `NOTES`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from anet_lumped.checks import nearest

EXPLICIT = {
    "explicit_euler": "never stable for swings without mass-proportional damping: no axial damper acts on them",
    "symplectic_euler": "(h omega)^2 + 4 zeta h omega <= 4",
    "verlet": "(h omega)^2 + 8 zeta h omega <= 4; damping at the predicted velocity halves the dashpot it tolerates",
    "rk4": "undamped modes to h omega = 2.828, overdamped ones to 2.785",
    "dop853": "undamped modes to h omega = 5.960, overdamped ones to 6.394; error control is driven to it",
    "RK45": "adaptive: the step that error control is driven to; undamped modes only to h omega = 0.997",
    "DOP853": "adaptive: the step that error control is driven to; undamped modes to h omega = 5.960",
    "Tsit5": "adaptive: the step that error control is driven to; undamped modes only to h omega = 0.478",
}
IMPLICIT = {
    "edmc": "energy never rises at any step, slack or taut",
    "backward_euler": "energy never rises at any step; damps the motion itself strongly",
    "midpoint": "linear statement only: energy can grow without bound in nonlinear motion",
    "sdirk2": "linear statement (L-stable); a slackening cable may gain some energy",
    "tr_bdf2": "linear statement (L-stable); its explicit first stage pumps energy into a slackening cable",
    "generalised_alpha": "linear statement only: energy can grow without bound in nonlinear motion",
    "Radau": "linear statement (L-stable), adaptive",
    "BDF": "adaptive; orders 1 and 2 have no limit, orders 3 to 5 are unstable for weakly damped modes at some steps",
    "Kvaerno3": "linear statement (L-stable), adaptive; its explicit first stage pumps energy into a slackening cable",
    "Kvaerno5": "linear statement (L-stable), adaptive; its explicit first stage pumps energy into a slackening cable",
    "LSODA": "adaptive; its Adams half is limited like an explicit scheme, its BDF half as BDF is",
}
NOTES = EXPLICIT | IMPLICIT

_TSIT5 = 0.0014322113248073478  # coefficient of z^6 in its R(z), from its tableau; the lower ones are those of exp(z)
_DELAY = {"symplectic_euler": 1.0, "verlet": 2.0}  # half steps by which the damping force lags
_SCAN = np.arange(0.0, 10.0, 0.25)  # finer than any feature of the three Runge-Kutta regions, wider than all of them


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
        mode = self.modes[limit.cable]
        return (
            f'Step dt={dt:g} s is beyond the largest stable step of "{scheme}", {limit.step:.3g} s, set by cable '
            f'"{limit.cable}" (top frequency {mode.omega:.4g} rad/s, damping ratio {mode.zeta:.3g}); '
            'take a smaller step or an implicit method such as "edmc".'
        )


def step_limit(scheme: str, omega, zeta=0.0, rate=0.0):
    """Largest step up to which a scheme is stable for one mode.

    Spectral radius of the amplification matrix <= 1, with d = 2 zeta omega + rate: explicit Euler h omega^2 <= d and
    h <= 4/(d + sqrt(d^2 - 4 omega^2)) if overdamped; symplectic Euler h^2 omega^2 + 2 d h <= 4; Verlet
    h^2 omega^2 + 4 d h <= 4, from l^3 - (2 - W - 3D/2) l^2 + (1 - 2D) l + D/2 with W = h^2 omega^2 and D = h d, all
    three by Jury's criterion; Runge-Kutta |R(h lambda)| <= 1 by bisection.

    Parameters
    ----------
    scheme : name of the scheme, a key of `NOTES`; ValueError if it does not exist
    omega, zeta, rate : float or array_like, frequency [rad/s], damping ratio and mass-proportional damping [1/s]

    Returns
    -------
    h : float or array [s]; 0 if no step is stable, inf if every step is
    """
    omega, zeta, rate = _checked(scheme, omega=omega, zeta=zeta, rate=rate)
    d = 2.0 * zeta * omega + rate
    with np.errstate(divide="ignore", invalid="ignore"):
        if scheme in IMPLICIT:
            h = np.full(d.shape, np.inf)
        elif scheme == "explicit_euler":
            # fmin: a mode without spring and damper (0/0) is merely free
            h = np.fmin(d / omega**2, 4.0 / (d + np.sqrt(np.maximum(d**2 - 4.0 * omega**2, 0.0))))
        elif scheme in _DELAY:
            d = _DELAY[scheme] * d
            h = 4.0 / (d + np.sqrt(d**2 + 4.0 * omega**2))
        else:
            fastest = np.abs(d + np.sqrt((d**2 - 4.0 * omega**2).astype(complex))) / 2.0
            scale = np.where(fastest > 0.0, fastest, 1.0)
            h = np.where(fastest > 0.0, _first_edge(scheme, omega / scale, d / scale) / scale, np.inf)
    return h[()]


def damping_limit(scheme: str, omega, dt, rate=0.0):
    """Largest damping ratio that is stable at a step dt; in dampers BA = 2 zeta EA/omega, c = 2 zeta k/omega.

    With x = omega dt: symplectic Euler (4 - x^2)/(4x); Verlet (4 - x^2)/(8x); else (X/x + x/X)/2, where X ends the
    scheme's interval on the negative real axis (2 for explicit Euler, 2.785 for RK4). Less damping than this may be
    unstable too: explicit Euler needs zeta >= x/2, and Runge-Kutta regions have waists.

    Arguments in [rad/s], [s], [1/s], floats or arrays. Returns -inf if no damping is stable, inf if any is.
    """
    omega, dt, rate = _checked(scheme, omega=omega, dt=dt, rate=rate)
    x = omega * dt
    with np.errstate(divide="ignore", invalid="ignore"):
        if scheme in IMPLICIT:
            zeta = np.full(x.shape, np.inf)
        elif scheme in _DELAY:
            zeta = (4.0 - x**2) / (4.0 * _DELAY[scheme] * x)
        else:
            real = step_limit(scheme, 1.0, 1.0)
            zeta = np.where(x <= real, (real / x + x / real) / 2.0, -np.inf)
            if (x > real).any():  # beyond the real axis: the last stable zeta < 1, where the region is taller than wide
                beyond, grid = x[x > real], np.linspace(0.0, 1.0, 401)
                stable = step_limit(scheme, 1.0, grid)[:, None] >= beyond
                last = np.max(np.arange(401)[:, None] * stable, axis=0)
                edge = _bisect(lambda z: _stable(scheme, beyond, 2.0 * z * beyond), grid[last], grid[last + 1])
                zeta[x > real] = np.where(stable.any(axis=0), edge, -np.inf)
        zeta = zeta - np.where(rate > 0.0, rate / (2.0 * omega), 0.0)
    return np.where(zeta >= 0.0, zeta, -np.inf)[()]


def frequency_limit(scheme: str, dt, zeta=0.0, rate=0.0):
    """Highest frequency [rad/s] that is stable at a step dt [s]: the inverse of `step_limit`; inf if every one is."""
    dt, zeta, rate = _checked(scheme, dt=dt, zeta=zeta, rate=rate)
    with np.errstate(divide="ignore"):
        if scheme in IMPLICIT:
            return np.full(dt.shape, np.inf)[()]
        if scheme == "explicit_euler" or scheme in _DELAY:
            return _bisect(lambda x: step_limit(scheme, x, zeta, rate * dt) >= 1.0, 0.0 * dt, 10.0) / dt
        return _first_edge(scheme, 1.0, 2.0 * zeta, rate * dt) / dt


def stretch_floor(scheme: str, dt, omega, strain, zeta=0.0, rate=0.0):
    """Smallest static stretch that a step permits: EA lowered, or raised, to where the step is just stable.

    eps = (T/EA) (omega/omega_s)^2, omega_s the highest frequency stable at dt; since omega^2 grows as EA, EA drops
    out. It holds for a tension that does not depend on EA.

    `omega` [rad/s] and `strain` are the cable's top frequency and static stretch T/EA, both at the same EA. Returns
    inf if no stiffness is stable at the step, 0 if every one is.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(strain) * (omega / frequency_limit(scheme, dt, zeta, rate)) ** 2


def hanging_stretch_floor(scheme: str, dt, length, segments, gravity=9.81, zeta=0.0, rate=0.0):
    """Smallest mean stretch that a step permits for a cable hung from one end, whatever its mass and material.

    eps = 2 g N^2 dt^2/(S^2 L), S = omega_s dt: `stretch_floor` with T = mu g L/2 and omega = (2N/L) sqrt(EA/mu), which
    is above the exact top frequency by 1/cos(pi/4N). In [s], [m], 1, [m/s^2], 1, [1/s]; floats or arrays.
    """
    length = np.asarray(length, float)
    return stretch_floor(scheme, dt, 2.0 * np.asarray(segments) / length, gravity * length / 2.0, zeta, rate)


def top_mode(cable, start_mass: float = np.inf, end_mass: float = np.inf) -> TopMode:
    """Exact top axial mode of a cable drawn straight.

    omega_j = (2/L0) sqrt(EA/mu) sin(j pi/2N), j = 1 .. N-1, between fixed ends (the default), sin((2j-1) pi/4N),
    j = 1 .. N, with one loose end of half a segment's mass; the tridiagonal eigenvalue for any mass at the ends.
    Then zeta = c omega/2k, which is the segment's damping ratio times the sine. A crooked cable is slower than a
    straight one, and so is its transverse motion: the stiffness T/l of a segment is below k. `start_mass` and
    `end_mass` [kg] are all that the end nodes carry, inf if they are fixed or driven.
    """
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


def top_modes(scene) -> dict[str, TopMode]:
    """Top mode of each cable of a scene, by name; the highest is a rigorous bound of the scene's frequencies.

    Cables that meet share the mass of their point in proportion to their stiffness. With M and K sums over the
    cables, max x'Kx/x'Mx is at most the largest of the cables' own quotients (Irons and Treharne, "A bound theorem in
    eigenvalues and its practical applications", 1971); a single cable's is exact.
    """
    mass = {point.name: np.inf for point in scene.points} | {point.name: point.mass for point in scene.free_points}
    stiffness = dict.fromkeys(mass, 0.0)
    elastic = [cable for cable in scene.cables if not cable.inextensible]
    for cable in scene.cables:
        for point in (cable.start, cable.end):
            mass[point] += cable.mass_per_length * cable.L0 / 2.0
            stiffness[point] += 0.0 if cable.inextensible else cable.stiffness

    share = {name: mass[name] / stiffness[name] for name in mass if stiffness[name]}
    modes = {c.name: TopMode(c.name, np.inf, 0.0) for c in scene.cables}  # of those that do not stretch
    return modes | {c.name: top_mode(c, c.stiffness * share[c.start], c.stiffness * share[c.end]) for c in elastic}


def predict(scene, strain: float = 0.1, schemes: tuple[str, ...] = tuple(NOTES)) -> Prediction:
    """Predict the stability of every scheme, or of some, for a scene, without a run.

    `strain` is the largest stretch expected in the motion: swings stay below omega sqrt(strain/(1 + strain)).
    """
    rate = float(sum(effect.mass_damping_rate for effect in scene.effects))
    modes, limits = top_modes(scene), {}
    rigid = next((mode.cable for mode in modes.values() if mode.omega == np.inf), None)
    if rigid is not None:
        note = f'only edmc takes a cable that does not stretch, such as "{rigid}" with EA=inf'
        none, any_step = SchemeLimit(0.0, 0.0, 0.0, rigid, note), SchemeLimit(np.inf, np.inf, np.inf, "", NOTES["edmc"])
        return Prediction(modes, rate, {scheme: any_step if scheme == "edmc" else none for scheme in schemes})
    omega, zeta = np.array([(mode.omega, mode.zeta) for mode in modes.values()]).T
    for scheme in schemes:
        axial = step_limit(scheme, omega, zeta, rate)
        swing = step_limit(scheme, omega * np.sqrt(strain / (1.0 + strain)), 0.0, rate)
        step = np.minimum(axial, swing)
        cable = list(modes)[step.argmin()] if np.isfinite(step.min()) else ""
        limits[scheme] = SchemeLimit(*(float(x.min()) for x in (step, axial, swing)), cable, NOTES[scheme])
    return Prediction(modes, rate, limits)


@cache
def _polynomial(scheme: str) -> np.ndarray:
    """Coefficients of R(z) = 1 + sum b'A^(j-1)1 z^j, lowest first: those of the solution that the pair propagates."""
    if scheme in ("explicit_euler", "rk4"):
        return np.array([1.0, 1.0, 1 / 2, 1 / 6, 1 / 24][: 2 if scheme == "explicit_euler" else 5])
    if scheme == "Tsit5":
        return np.array([1.0, 1.0, 1 / 2, 1 / 6, 1 / 24, 1 / 120, _TSIT5])
    import scipy.integrate

    pair = getattr(scipy.integrate, "DOP853" if scheme == "dop853" else scheme)
    A = np.pad(pair.A, ((0, 0), (0, len(pair.B) - pair.A.shape[1])))
    powers = (np.linalg.matrix_power(A, j).sum(axis=1) for j in range(len(pair.B)))
    return np.array([1.0, *(pair.B @ power for power in powers)])


def _stable(scheme: str, x, damping) -> np.ndarray:
    """Whether |R(z)| <= 1, round-off allowed for, at both roots of z^2 + damping z + x^2."""
    root = np.sqrt(np.asarray(damping**2 - 4.0 * x**2, complex))
    z = np.stack([-damping - root, -damping + root]) / 2.0
    return (np.abs(np.polyval(_polynomial(scheme)[::-1], z)) <= 1.0 + 1e-13).all(axis=0)


def _first_edge(scheme: str, omega, d, d0=0.0) -> np.ndarray:
    """Smallest x beyond which a Runge-Kutta scheme is unstable at frequency x omega and damping x d + d0."""

    def stable(x):
        return _stable(scheme, x * omega, x * d + d0)

    first = np.argmin([stable(x) for x in _SCAN], axis=0)
    return _bisect(stable, _SCAN[np.maximum(first - 1, 0)], _SCAN[first])


def _bisect(stable: Callable, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Last stable value between a stable `low` and an unstable `high`, element by element, to round-off."""
    for _ in range(54):
        middle = 0.5 * (low + high)
        good = stable(middle)
        low, high = np.where(good, middle, low), np.where(good, high, middle)
    return low


def _checked(scheme: str, **values) -> list[np.ndarray]:
    """Return `values` as float arrays of one shape; raise ValueError for an unknown scheme or a negative value."""
    if scheme not in NOTES:
        hint = nearest(str(scheme), NOTES) or ", known are " + ", ".join(NOTES) + "."
        raise ValueError(f'Argument `scheme` must name a scheme, but is "{scheme}"{hint}')
    for name, value in values.items():
        if not np.all(np.asarray(value) >= 0.0):
            raise ValueError(f"Argument `{name}` must not be negative or NaN, but is {value}.")
    return np.broadcast_arrays(*(np.asarray(value, float) for value in values.values()))
