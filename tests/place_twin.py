"""The slow twin of passes over saved states: what a run tells of errors of its places, as `error_estimate` says."""

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from anet_lumped.results import saved_motion
from anet_lumped.results.break_errors import break_errors
from anet_lumped.results.energy_balance import (
    BY_DAMPERS,
    BY_EFFECTS,
    BY_METHOD,
    ELASTIC,
    KINETIC,
    POTENTIAL,
    SWINGS,
    WORK,
)
from anet_lumped.results.fading import FORGOTTEN
from anet_lumped.results.node_pass import A_TURN, LEAST_ROWS, OF_SECOND_DIFFERENCE, RESOLVED, SWAYS
from anet_lumped.results.tension_error import lowest_axial_mode
from anet_lumped.scene.scene import Driven
from integrators import schemes

MOST_PARTS = 32


def place_errors(run):
    """Largest error of a place up to each saved time, (k,) [m]."""
    flies = loose(run)
    left = faded(run.error_growth + flight_errors(run, flies), run.energy, stored(run), amplification(run, flies))
    left += break_errors(run, left)
    ways = moved_ways(run.q)
    told = run.error_factor * np.maximum.accumulate(left + lost_way(run, float(flies.any(axis=1).mean())))
    return np.minimum(told, max(float(ways.max()), float(run.error_growth[0])))


def lost_way(run, flying):
    """Part of the way of the motion that is missing with the energy that the method took, or gave, (k,) [m]."""
    books, ways, n_free = schemes.scheme(run.method).books_its_losses, moved_ways(run.q), run.model.n_free
    share = lost_share(run.energy) if books else np.maximum(lost_share(run.energy), moved_share(run.energy))
    if any(isinstance(point, Driven) for point in run.scene.all_points):
        ways = moved_ways(run.q - run.q[:, n_free:].mean(axis=1)[:, None])
    way = share * (0.5 + 1.5 * np.maximum(share, flying)) * 0.5 * np.maximum.accumulate(ways)
    weight = float(np.linalg.norm(run.scene.gravity)) * float(run.model.mass[:n_free].sum())
    if books and weight > 0.0:
        rate = min(mode.zeta * mode.omega for mode in (lowest_axial_mode(run.scene, cable) for cable in run.scene.cables))
        way = np.minimum(way, np.maximum.accumulate(vibration_lost(run.energy, rate * np.diff(run.t))) / weight)
    return way


def moved_ways(q):
    """Longest way along an axis by which a node of places (k, n, 3) is off its first one, (k,) [m]."""
    return np.abs(q - q[0]).max(axis=(1, 2))


def stored(run):
    """Energy beyond its least that springs hold, and of a scene with a ground what its effects hold besides gravity, (k,) [J]."""
    held = run.energy[:, ELASTIC]
    if any(effect.is_ground for effect in run.scene.effects):
        n_free = run.model.n_free
        held = held + run.energy[:, POTENTIAL] + (run.q[:, :n_free] @ run.scene.gravity) @ run.model.mass[:n_free]
    return held - held.min()


def faded(growth, energy, held, multiplied):
    """Largest of what is left of errors up to each saved time, (k,) [m]."""
    motion = maximum_filter1d(energy[:, KINETIC] + held, 2 * max(1, len(growth) // SWINGS) + 1, mode="nearest")
    left = [growth[0]]
    for r in range(1, len(growth)):
        taken = max(np.diff(energy[r - 1 : r + 1, BY_DAMPERS] + energy[r - 1 : r + 1, BY_EFFECTS])[0], 0.0)
        decay = min(taken / max(motion[r] + motion[r - 1], 1e-300), FORGOTTEN)
        adds = (growth[r] - growth[r - 1]) * (-np.expm1(-decay) / decay if decay > 0.0 else 1.0)
        left.append(left[-1] * np.exp(multiplied[r] - multiplied[r - 1] - decay) + adds)
    return np.maximum.accumulate(left)


def vibration_lost(energy, decay):
    """Energy that the method took, less by exp(-sum of decay (k - 1,)) since, at each saved time (k,) [J]."""
    taken, lost = np.maximum.accumulate(np.maximum(energy[:, BY_METHOD] - energy[0, BY_METHOD], 0.0)), [0.0]
    for r in range(1, len(energy)):
        lost.append((lost[-1] + taken[r] - taken[r - 1]) * np.exp(-min(decay[r - 1], FORGOTTEN)))
    return np.array(lost)


def energy_in_play(energy):
    """The largest energy that was moved between its forms, put in or dissipated up to each saved time, (k,) [J]."""
    change, potential = energy - energy[0], energy[:, POTENTIAL]
    swing = np.maximum.accumulate(potential) - np.minimum.accumulate(potential)
    parts = energy[:, KINETIC], energy[:, ELASTIC], swing, np.abs(change[:, WORK]), np.abs(change[:, BY_DAMPERS:].sum(axis=1))
    return np.maximum.accumulate(np.max(parts, axis=0))


def lost_share(energy):
    """Share of the energy in play that the method took and that nothing accounts for, up to each saved time, (k,)."""
    change = energy - energy[0]
    unaccounted = change[:, : POTENTIAL + 1].sum(axis=1) - change[:, WORK] + change[:, BY_DAMPERS:].sum(axis=1)
    lost = np.maximum(change[:, BY_METHOD], 0.0) + np.maximum(-unaccounted, 0.0)
    return np.where(lost > 0.0, np.minimum(lost / np.maximum(energy_in_play(energy), 1e-300), 1.0), 0.0)


def moved_share(energy):
    """Largest share of the energy in play that steps took or gave, and did not give back soon, up to each saved time, (k,)."""
    change = energy - energy[0]
    gained = change[:, : POTENTIAL + 1].sum(axis=1) - change[:, WORK] + change[:, BY_DAMPERS : BY_EFFECTS + 1].sum(axis=1)
    width = 2 * max(1, len(energy) // SWINGS) + 1
    moved = np.maximum(minimum_filter1d(gained, width, mode="nearest"), minimum_filter1d(-gained, width, mode="nearest"))
    share = np.where(moved > 0.0, np.minimum(moved / np.maximum(energy_in_play(energy), 1e-300), 1.0), 0.0)
    return np.maximum.accumulate(share)


def loose(run):
    """Which free nodes have no taut segment, (k, n_free) bool; none where no segment that cannot push is slack."""
    held, taut, slack = np.zeros((len(run.t), run.model.n), bool), run.segment_tension > 0.0, False
    for cable in run.scene.cables:
        T = run.tension(cable.name)
        if cable.compression == "linear":
            taut[:, run.model.segments(cable.name)] = True
        else:
            slack = slack or (T <= 0.0).any()
    for s, (a, b) in enumerate(run.model.ends):
        held[:, a] |= taut[:, s]
        held[:, b] |= taut[:, s]
    return ~held[:, : run.model.n_free] & slack


def of_several_segments(run):
    """Which free nodes belong to a cable of several segments, (n_free,) bool."""
    several = np.zeros(run.model.n, bool)
    for cable in run.scene.cables:
        several[run.model.nodes(cable.name)] |= cable.segments > 1
    return several[: run.model.n_free]


def first_loose_row(run, flies):
    """First row after the start at which a node between several segments, or of a cable of several, flies; None: never."""
    between = np.bincount(run.model.ends.ravel(), minlength=run.model.n)[: run.model.n_free] > 1
    found = np.flatnonzero((flies & (between | of_several_segments(run)))[1:].any(axis=1))
    return 1 + int(found[0]) if len(found) else None


def flight_errors(run, flies):
    """Largest error that a flight has led to up to each saved time, where nothing but gravity acts, (k,) [m]."""
    errors, v = np.zeros(len(run.t)), run.v
    if not all(effect.dead_load and any(effect.uniform_acceleration) for effect in run.scene.effects):
        return errors
    rows = lambda *numbers: [min(max(r, 0), len(v) - 1) for r in numbers]  # noqa: E731
    for i in np.flatnonzero(of_several_segments(run)):
        off = grown = 0.0
        for r in range(1, len(run.t)):
            if flies[r, i] and not flies[r - 1, i]:
                a, b, c, d = (v[row, i] for row in rows(r - 2, r - 1, r, r + 1))
                off = OF_SECOND_DIFFERENCE * max(np.linalg.norm(d - 2.0 * c + b), np.linalg.norm(c - 2.0 * b + a))
                grown = 0.0
            if flies[r, i]:
                grown += min(off, np.linalg.norm(v[r, i])) * (run.t[r] - run.t[r - 1])
                errors[r] = max(errors[r], grown)
    return np.maximum.accumulate(errors)


def amplification(run, flies):
    """Logarithm of the times by which the motion has multiplied its first errors up to each saved time, (k,)."""
    grown, loose_row = np.zeros(len(run.t)), first_loose_row(run, flies)
    rows = len(run.t) if loose_row is None else loose_row
    if rows < LEAST_ROWS or not saved_motion._is_seen(run):
        return grown
    tension = run.segment_tension[:rows]
    bent = bends(tension)
    together = max(1, int(2.0 * np.pi / np.sqrt(max(bent, 1e-12)) / A_TURN))
    if bent > RESOLVED:
        together = 1
    if (bent > RESOLVED and (tension[1:] + tension[:-1]).min() >= 0.0) or pumped_at_most(tension, together) <= np.log(SWAYS):
        return grown
    size = maximum_filter1d(carried(run, tension, together), 2 * max(1, rows // SWINGS) + 1, mode="nearest")
    grown[:rows] = np.maximum.accumulate(np.maximum(size - np.minimum.accumulate(size) - np.log(SWAYS), 0.0))
    grown[rows:] = grown[rows - 1]
    return grown


def bends(tension):
    """Sum of second differences of the tension (k, n_segments) of all segments over that of its distances from its mean."""
    T = tension.sum(axis=1)
    T = T[1:] + T[:-1]
    apart = float(np.abs(T - T.mean()).sum())
    return float(np.abs(np.diff(T, 2)).sum()) / apart if apart > 0.0 else 0.0


def pumped_at_most(tension, together):
    """Logarithm of the times by which the size of a displacement grows at most, as tensions (k, n_segments) change."""
    T = tension[1::together] + tension[:-1:together]
    return np.inf if T.min() <= 0.0 else 0.5 * float(np.log((T[1:] / T[:-1]).max(axis=1, initial=1.0)).sum())


def carried(run, tension, together):
    """Logarithm of a displacement across the motion, the largest of a node at each saved time (k,); it begins at random."""
    model, n_free, times = run.model, run.model.n_free, (len(tension) - 1) // together
    z, speed, mass = np.zeros(model.n), np.zeros(model.n), np.zeros(model.n)
    mass[:n_free], z[:n_free] = model.mass[:n_free], np.random.default_rng(0).uniform(-1.0, 1.0, n_free)
    a, b = model.ends.T
    logarithm = np.zeros(len(tension))
    for n in range(times):
        first, last = n * together, (n + 1) * together
        lengths = [np.linalg.norm(run.q[row, b] - run.q[row, a], axis=1) for row in (first, last)]
        stiffness = np.trapezoid(tension[first : last + 1], axis=0) / together / (0.5 * (lengths[0] + lengths[1]))
        sums = np.bincount(a, np.abs(stiffness), model.n) + np.bincount(b, np.abs(stiffness), model.n)
        step, moves = run.t[last] - run.t[first], mass > 0.0
        parts = min(int(np.ceil(step * np.sqrt(2.0 * (sums[moves] / mass[moves]).max()))) + 1, MOST_PARTS * together)
        h = step / parts
        per_mass = np.where(moves, h / np.maximum(np.maximum(mass, 2.0 * h * h * sums), 1e-300), 0.0)
        for _ in range(parts):
            z += h * speed
            f = stiffness * (z[b] - z[a])
            speed += per_mass * (np.bincount(a, f, model.n) - np.bincount(b, f, model.n))
        logarithm[first + 1 : last + 1] = np.log(np.abs(z).max())
    logarithm[times * together + 1 :] = logarithm[times * together]
    return logarithm
