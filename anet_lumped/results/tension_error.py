"""What a run knows of the error of its largest tension: of peaks between states, jumps that ring, vibrations and snaps.

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
v sqrt(EA mu). Steps that do not resolve the vibration of a segment show next to nothing of that: past a whip, a hundredth. So do
nodes that are thrown along a taut cable at the start. Loads that are put on at once set off vibrations as well, see `sudden_loads`.

A jump is half of a third difference, which is nearly nothing of a smooth peak. Two others look like jumps and set off next to
nothing: the tension of a stiff cable alternates from step to step about its mean, and a transverse wave that a few steps resolve
changes it without a jump. So jumps of a cable that stays taut count 0.7 times as much as those of the means of two tensions in a
row, which do not alternate, but not less than a quarter of their own and not more than all of it. What stands out by twenty times
from what is saved four to seven rows before and after is a jump, and counts in full, and so do those of the first rows, and of
cables that were slack.

A largest tension that passes between two saved states is known (`Run.largest_tension`), but not how it came. Where the steps about
it have not been looked at (`Run.peak_at_most`), all by which it is above the saved states beside it counts as a jump.

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
from integrators.addresses import words_of

from .events import BREAK, RELEASE
from .free_flight import loose
from .peaks import Hidden, hidden_peak
from .rigid_blows import has_rigid_blows
from .sudden_loads import sudden_load_tension

OF_SEGMENT = 0.25  # of a jump, which the vibration of a segment that the steps do not resolve would add
OVERDAMPED = 1e3  # damping ratio beyond which a tension goes less than 1e-6 of a jump beyond its rest
FORGOTTEN = 300.0  # exponent of decay over a run beyond which nothing is left
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
    """Error of the largest tension of a run, over what that tension may be; 0 where none is taut, 1 where it has no value.

    It has none where cables that do not stretch were caught, see `rigid_blows`.

    Returns
    -------
    error : float
    """
    largest = run.peak_tension()
    if largest <= 0.0:
        return 0.0
    if has_rigid_blows(run):
        return 1.0
    more = run.peak_at_most
    if more is None:
        more, hidden = most_of_states(run), hidden_peak(run)
        if hidden is not None:
            more = max(more, hidden.tension + _after_jump(run, hidden))
    lost = lost_share(run.energy) if run.energy.shape[1] > BY_METHOD else 0.0
    return max(1.0 - largest / max(more, largest), LOST * lost)


def most_of_states(run: Any) -> float:
    """What the largest tension of saved states may be [N], as far as these tell."""
    if len(run.t) <= 2:
        return float(run.segment_tension.max(initial=0.0))
    sudden = sudden_load_tension(run, lowest_axial_mode)
    return max(float(look_at(run).most.max()), snap_tension(run), thrown_tension(run), sudden)


def _after_jump(run: Any, hidden: Hidden) -> float:
    """What a tension that has jumped to a hidden peak may add to it [N], as far as steps do not resolve it."""
    cable = run.scene.cables[hidden.cable]
    lowest, highest = lowest_axial_mode(run.scene, cable), highest_axial_mode(cable)
    return hidden.rise * max(lowest.overshoot * lowest.unresolved(run.dt), OF_SEGMENT * highest.unresolved(run.dt))


def snap_tension(run: Any) -> float:
    """Largest tension of the waves that caught nodes send off, v sqrt(EA mu), as far as the steps do not resolve it [N].

    Of a cable with dampers, and of one that does not stretch, 0. What hangs loose at the start only has not been caught.
    """
    undamped = [one for one in run.scene.cables if not one.inextensible and one.damping_ratio < UNDAMPED]
    if not undamped or not (run.segment_tension <= 0.0).any():  # else looking for loose nodes takes most of the time
        return 0.0
    largest, flies = 0.0, loose(run)
    for cable in undamped:
        if not (run.tension(cable.name) > 0.0).any():
            continue
        nodes = run.model.nodes(cable.name)
        nodes = nodes[nodes < run.model.n_free]
        row, node = np.nonzero(flies[1:-1, nodes] & ~flies[2:, nodes])
        if len(row):
            v = np.linalg.norm(run.v[row + 2, nodes[node]] - run.v[row + 1, nodes[node]], axis=1).max()
            wave = float(v) * math.sqrt(cable.EA_fast * cable.mass_per_length)
            largest = max(largest, wave * highest_axial_mode(cable).unresolved(run.dt))
    return largest


def thrown_tension(run: Any) -> float:
    """Largest tension at the start with the waves that nodes send off whose velocities differ along a segment [N].

    Two free nodes send off a wave of half the difference of their velocities, one at a prescribed node of all of it. Its share
    that steps do not show is squared, because what they do resolve of it is a jump of the tensions that they show. Of a cable with
    dampers, and of one that does not stretch, 0.
    """
    model, v, largest = run.model, run.v[0], 0.0
    a, b = model.ends.T
    along = run.q[0, b] - run.q[0, a]
    apart = np.abs(np.einsum("sx,sx->s", v[b] - v[a], along)) / np.linalg.norm(along, axis=1).clip(1e-300)
    apart *= np.where((a < model.n_free) & (b < model.n_free), 0.5, 1.0) * (run.segment_tension[0] > 0.0)
    if not apart.any():
        return 0.0
    for c, cable in enumerate(run.scene.cables):
        if cable.inextensible or cable.damping_ratio >= UNDAMPED:
            continue
        first, count = model.segment_run(c)
        own = slice(first, first + count)
        hidden = math.sqrt(cable.EA_fast * cable.mass_per_length) * highest_axial_mode(cable).unresolved(run.dt) ** 2
        largest = max(largest, float((run.segment_tension[0, own] + apart[own] * hidden).max()))
    return largest


def look_at(run: Any) -> Any:
    """What a pass over the tensions of a run finds, a `TensionRows`."""
    from .tension_pass import UNEVEN, TensionRows, look_at_tensions  # compiled on first use

    T, t, h = run.segment_tension, run.t, run.dt
    k, n = T.shape
    second = _second(T)
    for event in run.events:  # tensions of what breaks are lost in truth
        if event.kind in (BREAK, RELEASE):
            second[1:-1][_beside(t, event.t)] = 0.0
    damps = run.energy.shape[1] > BY_METHOD and not schemes.scheme(run.method).explicit
    taken = np.maximum.accumulate(np.maximum(run.energy[:, BY_METHOD] - run.energy[0, BY_METHOD], 0.0)) if damps else np.zeros(k)
    kinds: dict[tuple[Mode, Mode, int, float, float], int] = {}
    cables, shares = [], []
    for c, cable in enumerate(run.scene.cables):
        lowest, highest = lowest_axial_mode(run.scene, cable), highest_axial_mode(cable)
        unresolved, kind = lowest.unresolved(h), -1
        if taken[-1] > 0.0 and unresolved > 0.0:  # those of cables that are alike are one
            kind = kinds.setdefault((lowest, highest, cable.segments, cable.EA_fast, cable.length), len(kinds))
        cables.append((*run.model.segment_run(c), kind))
        per_unresolved = 1.0 / unresolved if kind >= 0 else 0.0
        of_jumps = lowest.overshoot * unresolved, OF_SEGMENT * highest.unresolved(h)
        shares.append((lowest.zeta * lowest.omega, *of_jumps, per_unresolved))
    modes = [_vibrations(*kind, h) / ((1.0,), (len(run.scene.cables),)) for kind in kinds]
    vibrations = np.zeros((len(kinds), 2, max((kind[2] for kind in kinds), default=0)))
    for of_kind, found in zip(vibrations, modes, strict=True):
        of_kind[:, : found.shape[1]] = found
    rows = TensionRows(
        t, np.ascontiguousarray(T), second, _last_jumps_of_means(T, UNEVEN), taken,
        np.array(cables, np.int64), np.array(shares), vibrations, np.zeros(vibrations.shape[1:]), np.zeros((len(kinds), k)),
        np.zeros((k, 2)), np.zeros(n), np.zeros(n),
    )  # fmt: skip
    words = np.array(words_of(rows), np.int64)
    look_at_tensions(words.ctypes.data)
    return rows


def _vibrations(lowest: Mode, highest: Mode, segments: int, EA: float, length: float, h: float) -> np.ndarray:
    """Vibrations of a cable (2, segments): the rate at which the energy of each fades [1/s], and 2k times its share of the energy
    that the method takes [N2/J].

    They are the lowest one and those of a chain of equal masses between two held ends, omega_max sin(pi j/(2 N)).
    """
    higher = np.arange(1, segments)
    omega = np.append(lowest.omega, highest.omega * np.sin(0.5 * np.pi * higher / segments))
    rate = np.append(lowest.zeta * lowest.omega, highest.zeta * omega[1:] ** 2 / highest.omega)
    share = 1.0 / (1.0 + (0.5 * omega * h) ** 2)
    return np.array([2.0 * rate, 2.0 * EA / length * share / share.sum()])


def _second(T: np.ndarray) -> np.ndarray:
    """Second differences of tensions (k, segments), from a row before the first to a row after the last, (k + 2, segments)."""
    first = np.zeros((len(T) + 3, T.shape[1]))
    np.subtract(T[1:], T[:-1], out=first[2:-2])
    return first[1:] - first[:-1]


def _last_jumps_of_means(T: np.ndarray, rows: int) -> np.ndarray:
    """Jumps of the means of two tensions in a row at the last ``rows`` saved times, (rows, segments) [N]; 0 of less than four."""
    jumps, last = np.zeros((rows, T.shape[1])), T[-rows - 5 :]
    third = np.abs(np.diff(_second(0.5 * (last[1:] + last[:-1])), axis=0))  # of means between two rows each
    for n in range(1, min(rows, len(third)) + 1):
        beside = third[max(len(third) - n - 1, 0) : len(third) - n + 2]
        jumps[-n] = 0.5 * beside.max(axis=0)
    return jumps


def _beside(t: np.ndarray, at: float) -> np.ndarray:
    """Which saved times (k,) have a time [s] between their neighbours."""
    before, after = np.concatenate([t[:1], t[:-1]]), np.concatenate([t[1:], t[-1:]])
    return (before <= at) & (after >= at)


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
