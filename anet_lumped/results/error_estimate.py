"""What a run knows of the errors of its places, as far as its steps, its method and its lost energy tell.

What the steps leave out adds up in the march (`integrators.marching.error_growth`), and nodes that fly keep what their velocity is
off by (`free_flight`). A break comes too early or too late by what is off before it, and that goes on (`break_errors`).

Errors of steps and flights fade as the motion does: dampers and drag that take the power D of a motion of the energy E let its
amplitude, and the errors in it, fade at the rate D/2E. E is kinetic energy and what springs hold beyond their least, that of a
ground too: a net that is let go stretched many times, or a weight deep inside the ground, gives dampers far more than it moves
with, and forgets little of where it went meanwhile.

Where tensions that change pump what is across the motion, errors grow by more than what is added to them (`amplification`).

Besides, energy that the method took is missing in the motion, and what it gave is too much: of an amplitude A, which goes with the
square root of the energy, a share E_lost/2E. A swing that starts at rest goes 2A. Where all is lost the motion is off by its whole
way 2A, and so it is by its share of 2A where a weight flies as high as its energy takes it. What a method took of stretching alone,
as `edmc` does, lifts the weight W of all that moves by E_lost/W at most, less what the dampers of the cable would have taken, which
act half of the time if it goes slack in between.

All together is not more than the longest way that a node goes. How far this is from the truth, the study `error_estimate` shows.
"""

from typing import Any

import numpy as np

from anet_lumped.results.energy_balance import (
    BY_DAMPERS,
    BY_EFFECTS,
    BY_METHOD,
    ELASTIC,
    KINETIC,
    POTENTIAL,
    SWINGS,
    lost_share,
    moved_share,
)
from anet_lumped.scene.scene import Driven
from integrators import schemes

from .amplification import amplification
from .break_errors import break_errors
from .free_flight import flight_errors, loose
from .tension_error import lowest_axial_mode, vibration_lost

AT_ONCE = 256  # saved states that are looked at together: their places are at hand then
FORGOTTEN = 300.0  # exponent of decay over a run beyond which nothing of an error is left


def place_errors(run: Any) -> np.ndarray:
    """Largest error of a place up to each saved time, as far as it is known.

    Parameters
    ----------
    run : Run
        Of which `error_growth` is not None.

    Returns
    -------
    error : (k,) float64 [m]
    """
    if run.extrapolated or run.energy.shape[1] <= BY_METHOD:  # two runs have been compared; a file of version 0.1
        return run.error_growth
    flies = loose(run)
    left_out = _faded(run.error_growth + flight_errors(run, flies), run.energy, _stored(run), amplification(run, flies))
    left_out += break_errors(run, left_out)
    ways = moved_ways(run.q)
    told = run.error_factor * np.maximum.accumulate(left_out + _lost_way(run, float(flies.any(axis=1).mean()), ways))
    return np.minimum(told, max(float(ways.max()), float(run.error_growth[0])))


def _lost_way(run: Any, flying: float, ways: np.ndarray) -> np.ndarray:
    """Part of the way of the motion that is missing with the energy that the method took, or gave, (k,) [m].

    ``flying`` is the share of the saved times at which a node has no taut segment, and ``ways`` are of `moved_ways`.
    """
    books = schemes.scheme(run.method).books_its_losses
    share = lost_share(run.energy) if books else np.maximum(lost_share(run.energy), moved_share(run.energy))
    if any(isinstance(point, Driven) for point in run.scene.all_points):
        ways = moved_ways(run.q, run.q[:, run.model.n_free :].mean(axis=1))
    amplitude = 0.5 * np.maximum.accumulate(ways)
    way = share * (0.5 + 1.5 * np.maximum(share, flying)) * amplitude
    n_free = run.model.n_free
    weight = float(np.linalg.norm(run.scene.gravity)) * float(run.model.mass[:n_free].sum())
    if books and weight > 0.0:
        modes = [lowest_axial_mode(run.scene, cable) for cable in run.scene.cables]
        decay = np.minimum(min(mode.zeta * mode.omega for mode in modes) * np.diff(run.t), FORGOTTEN)
        way = np.minimum(way, np.maximum.accumulate(vibration_lost(run.energy, decay)) / weight)
    return way


def moved_ways(q: np.ndarray, base: np.ndarray | None = None) -> np.ndarray:
    """Longest way along an axis by which a node of places (k, n, 3) is off its first one, (k,) [m].

    Less the way of a ``base`` (k, 3), if one is given.
    """
    rows, ways = q.reshape(len(q), -1), np.zeros(len(q))
    for begin in range(0, len(q), AT_ONCE):
        some = rows[begin : begin + AT_ONCE] - rows[0]
        if base is not None:
            some -= np.tile(base[begin : begin + AT_ONCE] - base[0], q.shape[1])
        np.abs(some, out=some)
        some.max(axis=1, out=ways[begin : begin + AT_ONCE])
    return ways


def _stored(run: Any) -> np.ndarray:
    """Energy beyond its least that springs hold, and of a scene with a ground what its effects hold besides gravity, (k,) [J].

    Of moving nodes with the masses that they have at first.
    """
    stored = run.energy[:, ELASTIC]
    if any(effect.is_ground for effect in run.scene.effects):
        n_free = run.model.n_free
        stored = stored + run.energy[:, POTENTIAL] + (run.q[:, :n_free] @ run.scene.gravity) @ run.model.mass[:n_free]
    return stored - stored.min()


def _faded(growth: np.ndarray, energy: np.ndarray, stored: np.ndarray, multiplied: np.ndarray) -> np.ndarray:
    """Largest of what is left of errors up to each saved time, (k,) [m], of what steps have left out in all and the energies.

    ``stored`` (k,) is what springs hold [J], and ``multiplied`` (k,) the logarithm of `amplification`.
    """
    from scipy.ndimage import maximum_filter1d  # a third of a second to import

    rows = len(growth)
    width = max(1, rows // SWINGS)
    motion = maximum_filter1d(energy[:, KINETIC] + stored, 2 * width + 1, mode="nearest")  # of a swing it comes and goes
    taken = np.maximum(np.diff(energy[:, BY_DAMPERS] + energy[:, BY_EFFECTS]), 0.0)
    decay = np.minimum(taken / np.maximum(motion[1:] + motion[:-1], 1e-300), FORGOTTEN)
    adds = np.diff(growth) * np.where(decay > 1e-9, -np.expm1(-decay) / np.maximum(decay, 1e-300), 1.0)
    return np.maximum.accumulate(_summed(growth[0], adds, np.diff(multiplied) - decay))


def _summed(first: float, adds: np.ndarray, exponents: np.ndarray) -> np.ndarray:
    """x[0] = first, x[i + 1] = exp(exponents[i]) x[i] + adds[i]; adds and exponents (k - 1,), x (k,)."""
    passed = np.cumsum(exponents)
    if np.abs(passed).max(initial=0.0) < FORGOTTEN:  # then their exponentials are numbers, and one sum is enough
        factors = np.exp(np.append(0.0, passed))
        return np.cumsum(np.append(first, adds) / factors) * factors
    left = [float(first)]
    for keep, add in zip(np.exp(exponents).tolist(), adds.tolist(), strict=True):
        left.append(keep * left[-1] + add)
    return np.array(left)
