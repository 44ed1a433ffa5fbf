"""The slow twin of `results.tension_pass`: what tensions of saved states may lack, over whole cables, as `tension_error` says."""

import numpy as np

from anet_lumped.results.energy_balance import BY_METHOD
from anet_lumped.results.events import BREAK
from anet_lumped.results.tension_error import OF_SEGMENT, highest_axial_mode, lowest_axial_mode
from anet_lumped.results.tension_pass import ALONE, BETWEEN, FARTHEST, FORGOTTEN, LEAST, MEET, NEAREST, OF_ONE, STEADY
from integrators import schemes

BESIDE = range(NEAREST, FARTHEST + 1)


def missing(run, cable):
    """What the tensions of a cable may lack at each saved time, (k, segments) [N]."""
    T = run.tension(cable.name)
    second, jump = _differences(run, T)
    jump = counted_jumps(T, jump)
    lowest, decay = lowest_axial_mode(run.scene, cable), np.zeros(len(T) - 1)
    unresolved = lowest.unresolved(run.dt)
    if lowest.omega > 0.0:
        decay = np.minimum(lowest.zeta * lowest.omega * np.diff(run.t), FORGOTTEN)
    ringing = remembered(jump, decay)
    lacking = np.maximum(BETWEEN * second, lowest.overshoot * unresolved * ringing)
    lacking = np.maximum(lacking, OF_SEGMENT * highest_axial_mode(cable).unresolved(run.dt) * jump)
    if unresolved > 0.0 and run.energy.shape[1] > BY_METHOD and not schemes.scheme(run.method).explicit:
        lacking = np.maximum(lacking, np.minimum(lost_tension(run, cable, lowest)[:, None], ringing / unresolved))
    return lacking


def lost_tension(run, cable, lowest):
    """Tension of the vibrations of a cable whose energy the method took, at each saved time (k,) [N].

    They are the lowest one and those of a chain of equal masses between two held ends, omega_max sin(pi j/(2 N)).
    """
    highest, higher = highest_axial_mode(cable), np.arange(1, cable.segments)
    omega = np.append(lowest.omega, highest.omega * np.sin(0.5 * np.pi * higher / cable.segments))
    rate = np.append(lowest.zeta * lowest.omega, highest.zeta * omega[1:] ** 2 / highest.omega)
    share = 1.0 / (1.0 + (0.5 * omega * run.dt) ** 2)
    lost = np.column_stack([faded(run.energy, np.minimum(2.0 * one * np.diff(run.t), FORGOTTEN)) for one in rate])
    lost *= share / (share.sum() * len(run.scene.cables))
    squares = 2.0 * cable.EA_fast / cable.length * lost
    return np.minimum(MEET * np.sqrt(squares).sum(axis=1), OF_ONE * np.sqrt(squares.sum(axis=1)))


def _differences(run, T):
    """Sizes of second differences and of jumps of tensions (k, segments) [N] at each saved time.

    Before its first saved time, a tension is taken to have been as it was then, and after its last likewise. Where a cable breaks,
    tensions are lost in truth.
    """
    second = _second(T)
    for event in run.events:
        if event.kind == BREAK:
            second[1:-1][_beside(run.t, event.t)] = 0.0
    return np.abs(second[1:-1]), _jumps(second)


def _second(T):
    """Second differences of tensions (k, segments), from a row before the first to a row after the last, (k + 2, segments)."""
    return np.diff(np.concatenate([T[:1], T[:1], T, T[-1:], T[-1:]]), 2, axis=0)


def _jumps(second):
    """Half of the larger one of the third differences before and after each row, (k, segments) of `_second`."""
    third = np.abs(np.diff(second, axis=0))
    return 0.5 * np.maximum(third[1:], third[:-1])


def counted_jumps(T, jump):
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


def _stays(taut):
    """Whether a cable is taut at each saved time (k,) and at the two before and after."""
    padded = np.concatenate([[True, True], taut, [True, True]])
    return np.logical_and.reduce([padded[n : n + len(taut)] for n in range(5)])


def _beside_jumps(jump):
    """The less of the largest jumps (k,) at the times `BESIDE` before and after each, and at its end those before it."""
    before, after, least = np.zeros(len(jump)), np.zeros(len(jump)), BESIDE[0]
    for n in BESIDE:
        if n < len(jump):
            np.maximum(before[n:], jump[:-n], out=before[n:])
            np.maximum(after[:-n], jump[n:], out=after[:-n])
    after[-least:] = np.inf
    return np.minimum(before, after)


def _beside(t, at):
    """Which saved times (k,) have a time [s] between their neighbours."""
    before, after = np.concatenate([t[:1], t[:-1]]), np.concatenate([t[1:], t[-1:]])
    return (before <= at) & (after >= at)


def remembered(jump, decay):
    """Largest of the jumps so far (k, segments), each less by exp(-sum of decay (k - 1,)) since."""
    kept = [jump[0]]
    for now, one in zip(jump[1:], decay, strict=True):
        kept.append(np.maximum(now, kept[-1] * np.exp(-one)))
    return np.array(kept)


def faded(energy, decay):
    """Energy that the method took (k,), less by exp(-sum of decay (k - 1,)) since."""
    taken, left = np.maximum.accumulate(np.maximum(energy[:, BY_METHOD] - energy[0, BY_METHOD], 0.0)), [0.0]
    for new, one in zip(np.diff(taken), decay, strict=True):
        left.append((left[-1] + new) * np.exp(-one))
    return np.array(left)
