"""What a run knows of the error of its largest tension: between saved states, of jumps that ring, of vibrations and of snaps.

Four parts of a tension may be missing in what a run shows of it. The largest of them counts, at each saved time:

* Between two saved states a peak of a smooth tension is missed by at most an eighth of its second difference.
* A tension that jumps by J sets off the lowest axial vibration of its cable. With the damping ratio zeta the tension of spring and
  damper goes beyond its rest by J exp(-2 zeta acos(zeta)/sqrt(1 - zeta^2)), and rings until the damper has taken that. The share of
  it that steps of h do not resolve, s^2/(1 + s^2) with s = omega h/2, is missing.
* Of the vibration of a segment, which is over sooner, a quarter of the jump itself counts in the same way.
* The numerical damper takes axial vibrations, and the account of the run has their energy E. A jump gives each vibration an energy
  that goes as 1/omega^2, and steps of h do not resolve s^2/(1 + s^2) of it, s = omega h/2: so each vibration of the cable has lost
  a part of E that goes as 1/(1 + s^2), less what the dampers of the cable would have taken of it since. Of a cable with the
  stiffness k = EA/L a vibration of the energy E_i has a tension of sqrt(2 k E_i). A fifth of the sum of these is missing, because
  they do not meet, but no more than half of the tension of one vibration with all of their energy, because many make a front. A
  stiff cable whose tension changes slowly loses energy, too, and has no vibration to lose: so no more counts than jumps have set
  off, J (1 + s^2)/s^2 as far as steps of h show them.

Besides, a loose node of a cable without dampers that is caught and changes its velocity by v sends off a wave of the tension
v sqrt(EA mu). Steps that do not resolve the vibration of a segment show next to nothing of that: past a whip, a hundredth.

A jump is half of a third difference, which is nearly nothing of a smooth peak. Two others look like jumps and set off next to
nothing: the tension of a stiff cable alternates from step to step about its mean, and a transverse wave that a few steps resolve
changes it without a jump. So jumps of a cable that stays taut count 0.7 times as much as those of the means of two tensions in a
row, which do not alternate, but not less than a quarter of their own and not more than all of it. What stands out by twenty times
from what is saved four to seven rows before and after is a jump, and counts in full, and so do those of the first rows, and of
cables that were slack.

Besides, a quarter of the share of the energy that the method took counts as an error of the largest tension.

The shares 0.7, a quarter, twenty, a fifth and a half are fitted to runs with a reference; the results hardly change with them.
How far all this is from the truth, the study `error_estimate` shows.

Source: the wave is d'Alembert's on a bar, see Graff, Wave Motion in Elastic Solids, 1975, section 2.3. The overshoot is that of a
spring and a damper in parallel whose end jumps, (2 zeta omega d/dt + omega^2) over (d^2/dt^2 + 2 zeta omega d/dt + omega^2).
"""

import math
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.results.energy_balance import BY_METHOD, lost_share
from anet_lumped.scene.scene import Cable, Free, OnBody, Scene
from integrators import schemes

from .events import BREAK
from .free_flight import loose

BETWEEN = 0.125  # of the second difference of a tension: what a parabola hides at most between its samples
OF_SEGMENT = 0.25  # of a jump, which the vibration of a segment that the steps do not resolve would add
MEET = 0.2  # of the sum of the tensions of vibrations: what they add to the largest tension, but no more than
OF_ONE = 0.5  # of the tension of one with all of their energy
STEADY = 0.7  # of a jump of the means of two tensions in a row: what sets off a vibration while a cable stays taut
LEAST = 0.25  # of a jump, that counts in any case
BESIDE = range(4, 8)  # saved times before and after a jump, which neither it nor its own third differences reach
ALONE = 20.0  # times the jumps beside it: one that is no wave
OVERDAMPED = 1e3  # damping ratio beyond which a tension goes less than 1e-6 of a jump beyond its rest
FORGOTTEN = 300.0  # exponent of decay between two saved times beyond which nothing is left
UNDAMPED = 0.01  # damping ratio of a segment from which on its damper takes a snap
LOST = 0.25  # of the share of the energy that the method took: what a peak tension lacks


class Mode(NamedTuple):
    """An axial vibration.

    Parameters
    ----------
    omega : float [rad/s]
    zeta : float, damping ratio
    """

    omega: float
    zeta: float

    @property
    def overshoot(self) -> float:
        """How far the tension goes beyond its rest after a jump, over the jump."""
        if self.zeta > OVERDAMPED:
            return 0.0
        square = 1.0 - self.zeta**2
        if abs(square) < 1e-6:  # acos(zeta)/sqrt(1 - zeta^2) tends to 1
            return math.exp(-2.0)
        angle = math.acos(self.zeta) if square > 0.0 else math.acosh(self.zeta)
        return math.exp(-2.0 * self.zeta * angle / math.sqrt(abs(square)))

    def unresolved(self, h: float) -> float:
        """Share of the vibration that steps of h [s] do not resolve."""
        square = (0.5 * self.omega * h) ** 2
        return square / (1.0 + square)


def tension_error(run: Any) -> float:
    """Error of the largest tension of a run, over what that tension may be; 0 where none is taut.

    Returns
    -------
    error : float
    """
    largest, more, flies = 0.0, 0.0, loose(run)
    lost_of: dict[Any, np.ndarray] = {}
    for cable in run.scene.cables:
        T = run.tension(cable.name)
        peak = float(T.max(initial=0.0))
        largest = max(largest, peak)
        if len(T) > 2 and peak > 0.0:
            taut = T > 0.0
            more = max(more, float((T + _missing(run, cable, T, lost_of))[taut].max()), snap_tension(run, cable, flies))
    if largest == 0.0:
        return 0.0
    lost = float(lost_share(run.energy)[-1]) if run.energy.shape[1] > BY_METHOD else 0.0
    return max(1.0 - largest / max(more, largest), LOST * lost)


def snap_tension(run: Any, cable: Cable, flies: np.ndarray) -> float:
    """Largest tension of the waves that caught nodes send off, v sqrt(EA mu), as far as the steps do not resolve it [N].

    Of a cable with dampers, and of one that does not stretch, 0. ``flies`` (k, n_free) bool is of `loose`; what hangs loose at the
    start only has not been caught.
    """
    if cable.inextensible or cable.damping_ratio >= UNDAMPED:
        return 0.0
    nodes = run.model.nodes(cable.name)
    nodes = nodes[nodes < run.model.n_free]
    caught = flies[1:-1, nodes] & ~flies[2:, nodes]
    if not caught.any():
        return 0.0
    v = np.linalg.norm(np.diff(run.v[1:, nodes], axis=0), axis=2)[caught].max()
    return float(v) * math.sqrt(cable.EA_fast * cable.mass_per_length) * highest_axial_mode(cable).unresolved(run.dt)


def _missing(run: Any, cable: Cable, T: np.ndarray, lost_of: dict[Any, np.ndarray]) -> np.ndarray:
    """What the tensions of a cable (k, segments) may lack at each saved time [N], of the same shape.

    ``lost_of`` keeps `_lost_tension` of cables that are alike, as those of a net are.
    """
    second, jump = _differences(run, T)
    jump = counted_jumps(T, jump)
    lowest, decay = lowest_axial_mode(run.scene, cable), np.zeros(len(T) - 1)
    unresolved = lowest.unresolved(run.dt)
    if lowest.omega > 0.0:
        decay = np.minimum(lowest.zeta * lowest.omega * np.diff(run.t), FORGOTTEN)
    ringing = _remembered(jump, decay)
    missing = np.maximum(BETWEEN * second, lowest.overshoot * unresolved * ringing)
    missing = np.maximum(missing, OF_SEGMENT * highest_axial_mode(cable).unresolved(run.dt) * jump)
    if unresolved > 0.0 and run.energy.shape[1] > BY_METHOD and schemes.scheme(run.method).books_its_losses:
        alike = lowest, highest_axial_mode(cable), cable.segments, cable.EA_fast, cable.length
        if alike not in lost_of:
            lost_of[alike] = _lost_tension(run, cable, lowest)
        missing = np.maximum(missing, np.minimum(lost_of[alike][:, None], ringing / unresolved))
    return missing


def _lost_tension(run: Any, cable: Cable, lowest: Mode) -> np.ndarray:
    """Tension of the vibrations of a cable whose energy the method took, at each saved time (k,) [N].

    They are the lowest one and those of a chain of equal masses between two held ends, omega_max sin(pi j/(2 N)).
    """
    highest, higher = highest_axial_mode(cable), np.arange(1, cable.segments)
    omega = np.append(lowest.omega, highest.omega * np.sin(0.5 * np.pi * higher / cable.segments))
    rate = np.append(lowest.zeta * lowest.omega, highest.zeta * omega[1:] ** 2 / highest.omega)
    share = 1.0 / (1.0 + (0.5 * omega * run.dt) ** 2)
    lost = vibration_lost(run.energy, np.minimum(2.0 * rate * np.diff(run.t)[:, None], FORGOTTEN))
    lost *= share / (share.sum() * len(run.scene.cables))
    squares = 2.0 * cable.EA_fast / cable.length * lost
    return np.minimum(MEET * np.sqrt(squares).sum(axis=1), OF_ONE * np.sqrt(squares.sum(axis=1)))


def _differences(run: Any, T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sizes of second differences and of jumps of tensions (k, segments) [N] at each saved time.

    Before its first saved time, a tension is taken to have been as it was then, and after its last likewise. Where a cable breaks,
    tensions are lost in truth.
    """
    second = _second(T)
    for event in run.events:
        if event.kind == BREAK:
            second[1:-1][_beside(run.t, event.t)] = 0.0
    return np.abs(second[1:-1]), _jumps(second)


def _second(T: np.ndarray) -> np.ndarray:
    """Second differences of tensions (k, segments), from a row before the first to a row after the last, (k + 2, segments)."""
    return np.diff(np.concatenate([T[:1], T[:1], T, T[-1:], T[-1:]]), 2, axis=0)


def _jumps(second: np.ndarray) -> np.ndarray:
    """Half of the larger one of the third differences before and after each row, (k, segments) of `_second`."""
    third = np.abs(np.diff(second, axis=0))
    return 0.5 * np.maximum(third[1:], third[:-1])


def counted_jumps(T: np.ndarray, jump: np.ndarray) -> np.ndarray:
    """Jumps of tensions as far as they set off vibrations.

    Parameters
    ----------
    T : (k, segments) float64 [N], of a cable
    jump : (k, segments) float64 [N], half of the third differences of T

    Returns
    -------
    counted : (k, segments) float64 [N], between `LEAST` times the jumps and all of them
    """
    if len(T) <= BESIDE[0]:
        return jump
    of_means = _jumps(_second(0.5 * (T[1:] + T[:-1])))  # between two rows each
    counted = np.concatenate([of_means[:1], of_means])
    np.maximum(counted[:-1], of_means, out=counted[:-1])
    counted *= STEADY
    np.maximum(counted, LEAST * jump, out=counted)
    np.minimum(counted, jump, out=counted)
    largest = jump.max(axis=1)
    in_full = ~_stays(T.min(axis=1) > 0.0) | (largest >= ALONE * _beside_jumps(largest))
    counted[in_full] = jump[in_full]
    return counted


def _stays(taut: np.ndarray) -> np.ndarray:
    """Whether a cable is taut at each saved time (k,) and at the two before and after."""
    padded = np.concatenate([[True, True], taut, [True, True]])
    return np.logical_and.reduce([padded[n : n + len(taut)] for n in range(5)])


def _beside_jumps(jump: np.ndarray) -> np.ndarray:
    """The less of the largest jumps (k,) at the times `BESIDE` before and after each, and at its end those before it."""
    before, after, least = np.zeros(len(jump)), np.zeros(len(jump)), BESIDE[0]
    for n in BESIDE:
        if n < len(jump):
            np.maximum(before[n:], jump[:-n], out=before[n:])
            np.maximum(after[:-n], jump[n:], out=after[:-n])
    after[-least:] = np.inf
    return np.minimum(before, after)


def _beside(t: np.ndarray, at: float) -> np.ndarray:
    """Which saved times (k,) have a time [s] between their neighbours."""
    before, after = np.concatenate([t[:1], t[:-1]]), np.concatenate([t[1:], t[-1:]])
    return (before <= at) & (after >= at)


def _remembered(jump: np.ndarray, decay: np.ndarray) -> np.ndarray:
    """Largest of the jumps so far (k, segments), each less by exp(-sum of decay (k - 1,)) since."""
    passed = np.concatenate([[0.0], np.cumsum(decay)])[:, None]
    if passed[-1] < FORGOTTEN:  # its exponential is a number, and takes a small part of the time of all logarithms
        return np.maximum.accumulate(jump * np.exp(passed), axis=0) * np.exp(-passed)
    with np.errstate(divide="ignore"):
        return np.exp(np.maximum.accumulate(np.log(jump) + passed, axis=0) - passed)


def vibration_lost(energy: np.ndarray, decay: np.ndarray) -> np.ndarray:
    """Energy that the method took, less by exp(-sum of decay) since, at each saved time [J].

    ``decay`` (k - 1,) gives (k,), and that of several vibrations (k - 1, n) gives (k, n), as if each had all of the energy.
    """
    taken = np.maximum.accumulate(np.maximum(energy[:, BY_METHOD] - energy[0, BY_METHOD], 0.0))
    lost = np.zeros((len(energy), *decay.shape[1:]))
    if not len(decay):
        return lost
    passed, taken = np.cumsum(decay, axis=0), np.diff(taken).reshape(-1, *[1] * (decay.ndim - 1))
    short = passed[-1] < FORGOTTEN  # then its exponential is a number, and one sum is enough
    if decay.ndim == 1 and not short:
        lost[1:] = _lost_in_powers_of_two(taken, decay)
    elif decay.ndim == 1 or short.all():
        lost[1:] = np.cumsum(np.exp(passed - decay) * taken, axis=0) * np.exp(-passed)
    else:
        lost[1:, short] = np.cumsum(np.exp(passed[:, short] - decay[:, short]) * taken, axis=0) * np.exp(-passed[:, short])
        lost[1:, ~short] = _lost_in_powers_of_two(taken, decay[:, ~short])
    return lost


def _lost_in_powers_of_two(taken: np.ndarray, decay: np.ndarray) -> np.ndarray:
    """As `vibration_lost` of energies that were taken between two rows each, of vibrations that soon lose all."""
    keep, reach = np.exp(-decay), 1
    left = keep * taken  # of what was taken in one row; then in two, four and so on
    while reach < len(left) and keep[reach:].any():
        left[reach:] += keep[reach:] * left[:-reach]
        keep[reach:] *= keep[:-reach]
        reach *= 2
    return left


def highest_axial_mode(cable: Cable) -> Mode:
    """That of a segment between two others; omega is 0 of a cable that does not stretch."""
    return Mode(0.0, 0.0) if cable.inextensible else Mode(cable.omega_max, cable.damping_ratio)


def lowest_axial_mode(scene: Scene, cable: Cable) -> Mode:
    """The lowest axial vibration of a cable with what hangs on it, omega^2 = EA/(L (M + mu L/2.5)).

    A cable without a load has omega = pi/2 sqrt(EA/mu)/L, since 2.5 is about (pi/2)^2. One that does not stretch has no such mode.
    """
    if cable.inextensible:
        return Mode(0.0, 0.0)
    ends = scene.point(cable.start), scene.point(cable.end)
    load = sum(point.mass for point in ends if isinstance(point, Free) and not isinstance(point, OnBody))
    omega = math.sqrt(cable.EA_fast / (cable.length * (load + cable.mass_per_length * cable.length / 2.5)))
    return Mode(omega, 0.5 * cable.dashpot / cable.stiffness * omega)
