"""What a run knows of its own errors: of places, as far as its steps, its method and its lost energy tell, and of peak tensions.

Places. What the steps leave out adds up in the march (`integrators.marching.error_growth`). It fades as the motion does: dampers
and drag that take the power D of a motion of the energy E let its amplitude, and the errors in it, fade at the rate D/2E. Besides,
energy that the method took is missing in the motion: of an amplitude A, which goes with the square root of the energy, a share
E_lost/2E. A swing that starts at rest goes 2A. Both together are not more than the longest way that a node goes.

Tensions. What a run shows of a tension is a number at every saved time. Between two of them a peak of a smooth tension is missed
by at most an eighth of its second difference; twice that is taken. Where the step does not resolve the lowest axial vibration of a
cable, omega h/2 > 1, a jump of its tension would in truth ring by as much as it jumps, until dampers take that: half of it is taken
for missing, and a quarter of the share of the energy that the method took. Where it does not resolve the highest one, of a segment,
half of the jump itself is taken for missing. At both ends of a run, a tension that is the mean over a step lags by half of one.

Of 200 random motions at four steps each the estimate of places is within a factor of four of the truth in nine of ten runs, and
below a tenth of it in one of a hundred. That of tensions is within it in four of five, and below a tenth in one of sixty (the study
`error_estimate`).
"""

import math
from typing import Any

import numpy as np

from anet_lumped.results.energy_balance import BY_DAMPERS, BY_EFFECTS, BY_METHOD, KINETIC, POTENTIAL, WORK, energy_in_play
from anet_lumped.scene.scene import Cable, Driven, Free, Scene

from .events import BREAK

MISSED = 0.25  # of the second difference of a tension: twice what a parabola hides between its samples
RINGS = 0.5  # of a jump of the tension, which an axial vibration that the steps do not resolve would add to it
LOST = 0.25  # of the share of the energy that the method took: what a peak tension lacks
SWINGS = 16  # parts of a run, in one of which a swing is taken to come to its largest kinetic energy at least once
FORGOTTEN = 300.0  # exponent of decay over a run beyond which nothing of a jump is left


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
    moved = run.q - run.q[0]
    if any(isinstance(point, Driven) for point in run.scene.points):
        moved = moved - moved[:, run.model.n_free :].mean(axis=1, keepdims=True)
    amplitude = 0.5 * np.maximum.accumulate(np.abs(moved).max(axis=(1, 2)))
    told = run.error_factor * (_faded(run.error_growth, run.energy) + 0.5 * _lost(run.energy) * amplitude)
    return np.minimum(told, max(float(np.abs(run.q - run.q[0]).max()), float(run.error_growth[0])))


def _faded(growth: np.ndarray, energy: np.ndarray) -> np.ndarray:
    """Largest of what is left of errors up to each saved time, (k,) [m], of what steps have left out in all and the energies."""
    from scipy.ndimage import maximum_filter1d  # a third of a second to import

    rows = len(growth)
    width = max(1, rows // SWINGS)
    motion = maximum_filter1d(energy[:, KINETIC], 2 * width + 1, mode="nearest")  # of a swing the kinetic energy comes and goes
    taken = np.maximum(np.diff(energy[:, BY_DAMPERS] + energy[:, BY_EFFECTS]), 0.0)
    decay = np.minimum(taken / np.maximum(motion[1:] + motion[:-1], 1e-300), FORGOTTEN)
    keeps = np.exp(-decay)
    adds = np.diff(growth) * np.where(decay > 1e-9, (1.0 - keeps) / np.maximum(decay, 1e-300), 1.0)
    left = [float(growth[0])]
    for keep, add in zip(keeps.tolist(), adds.tolist(), strict=True):
        left.append(keep * left[-1] + add)
    return np.maximum.accumulate(left)


def _lost(energy: np.ndarray) -> np.ndarray:
    """Share of the energy in play that the method took and that nothing accounts for, up to each saved time, (k,)."""
    change = energy - energy[0]
    taken = change[:, BY_DAMPERS:].sum(axis=1)
    unaccounted = change[:, : POTENTIAL + 1].sum(axis=1) - change[:, WORK] + taken
    lost = np.maximum(change[:, BY_METHOD], 0.0) + np.maximum(-unaccounted, 0.0)
    return np.where(lost > 0.0, np.minimum(lost / np.maximum(energy_in_play(energy), 1e-300), 1.0), 0.0)


def tension_error(run: Any) -> float:
    """Error of the largest tension of a run, over what that tension may be; 0 where none is taut.

    Returns
    -------
    error : float
    """
    largest, more = 0.0, 0.0
    for cable in run.scene.cables:
        T = run.tension(cable.name)
        peak = float(T.max(initial=0.0))
        largest = max(largest, peak)
        if len(T) < 3 or peak <= 0.0:
            continue
        jump = np.abs(np.diff(T, 2, axis=0))
        for event in run.events:
            if event.kind == BREAK:  # where a cable breaks, tensions are lost in truth
                jump[(run.t[:-2] <= event.t) & (run.t[2:] >= event.t)] = 0.0
        omega, zeta = lowest_axial_mode(run.scene, cable)
        unresolved = _unresolved(omega, run.dt)
        ringing = _forgetting(jump, zeta * omega * np.diff(run.t)[1:]) if unresolved > 1e-3 else jump
        hidden = MISSED * (1.0 - unresolved) * jump + RINGS * unresolved * ringing
        hidden = np.maximum(hidden, RINGS * _unresolved(highest_axial_frequency(cable), run.dt) * jump)
        lags = [T[0] + 0.5 * np.abs(T[1] - T[0]), T[-1] + 0.5 * np.abs(T[-1] - T[-2])]
        more = max(more, float((np.maximum(T[1:-1], T[2:]) + hidden).max()), float(np.max(lags)))
    if largest == 0.0:
        return 0.0
    lost = float(_lost(run.energy)[-1]) if run.energy.shape[1] > BY_METHOD else 0.0
    return max(1.0 - largest / max(more, largest), LOST * lost)


def _unresolved(omega: float, h: float) -> float:
    """Share of a vibration of a frequency [rad/s] that steps of h [s] do not resolve."""
    square = (0.5 * omega * h) ** 2
    return square / (1.0 + square)


def _forgetting(jump: np.ndarray, decay: np.ndarray) -> np.ndarray:
    """Largest of the jumps so far (k, segments), each less by exp(-sum of decay (k,)) since."""
    passed = np.cumsum(decay)
    if not passed[-1] < FORGOTTEN:
        return jump
    fading = np.exp(-passed)[:, None]
    return np.maximum.accumulate(jump / fading, axis=0) * fading


def highest_axial_frequency(cable: Cable) -> float:
    """That of a segment between two others [rad/s]; 0 of a cable that does not stretch."""
    return 0.0 if cable.inextensible else cable.omega_max


def lowest_axial_mode(scene: Scene, cable: Cable) -> tuple[float, float]:
    """Frequency [rad/s] and damping ratio of the lowest axial mode of a cable with what hangs on it, EA/(L (M + mu L/2.5)).

    A cable without a load has omega = pi/2 sqrt(EA/mu)/L, since 2.5 is about (pi/2)^2. One that does not stretch has no such mode.
    """
    if cable.inextensible:
        return 0.0, 0.0
    load = sum(point.mass for point in scene.points if isinstance(point, Free) and point.name in (cable.start, cable.end))
    omega = math.sqrt(cable.EA / (cable.length * (load + cable.mass_per_length * cable.length / 2.5)))
    return omega, 0.5 * cable.dashpot / cable.stiffness * omega
