"""Times of a run: those at which it saves, those of its legs, and those that no step may cross."""

import math
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.limits import BYTES, STEPS, check_most
from anet_lumped.model import rest_lengths
from integrators.system import ENERGIES, SAME_TIME

SAVES = 400  # states that come back when nothing else is asked for
RESTING = 1e-6  # of the length of a path: a driven point that moves by less within a piece is at rest there


class Leg(NamedTuple):
    """A part of a run between two events; its steps and saved times are those of the whole run.

    Parameters
    ----------
    begin, end : float [s], of the leg
    run_begin, run_end : float [s], of the whole run
    save_every : float or None [s]
        Time between saved states; None saves about `SAVES` of them.
    """

    begin: float
    end: float
    run_begin: float
    run_end: float
    save_every: float | None

    def stride(self, dt):
        """Number of steps dt [s] between two saved states, and the largest number of states that this leg may save.

        Raises
        ------
        InputError : ``save_every`` is no multiple of the step
        """
        steps = max(1, math.ceil((self.run_end - self.run_begin) / dt * (1 - 1e-12) - 1e-12))
        if self.save_every is None:
            stride = max(1, round(steps / SAVES))
        else:
            stride = max(1, round(self.save_every / dt))
            if abs(stride * dt - self.save_every) > 1e-6 * self.save_every:
                raise InputError(
                    f"Argument `save_every` must be a multiple of the step, but save_every={self.save_every:g} s and dt={dt:g} s."
                )
        return stride, math.ceil((self.end - self.begin) / (stride * dt)) + 4

    def times(self):
        """Times at which a leg saves that chooses its steps: its begin, the run's saved times within it, its end; (k,) [s]."""
        every = save_times(self.run_begin, self.run_end, self.save_every)
        return np.concatenate([[self.begin], every[(every > self.begin) & (every < self.end)], [self.end]])

    def saves(self, t, dt):
        """Whether the run saves a state at t [s]; dt [s] is its fixed step, None if it chooses its steps."""
        if t == self.run_end:
            return True
        if dt is None:
            return bool(np.any(save_times(self.run_begin, self.run_end, self.save_every) == t))
        rows = (t - self.run_begin) / (self.stride(dt)[0] * dt)
        return abs(rows - round(rows)) * self.stride(dt)[0] <= SAME_TIME


def check_counts(scene, t0, t_end, dt, save_every, adaptive):
    """Refuse a run of more steps, or of more memory for the states that it saves, than limits allow.

    Parameters
    ----------
    scene : Scene
    t0, t_end : float [s]
    dt : float or None [s]
        Fixed step, or the longest that chosen steps are likely to be; None if nothing is known of them.
    save_every : float or None [s]
    adaptive : bool

    Raises
    ------
    InputError : see `limits`
    """
    duration = t_end - t0
    if dt is not None:
        check_most(STEPS, duration / dt, f"A run of {duration:g} s with steps of {dt:.3g} s")
    if not t0 + (dt or 1e-12 * duration) > t0:
        raise InputError(f"Steps must change the time, but t={t0:g} s has no digits for one of {dt or duration:g} s.")
    saves = min(duration / save_every, duration / dt if dt is not None and not adaptive else math.inf) if save_every else SAVES
    segments = sum(cable.segments for cable in scene.cables)
    numbers = 6 * (segments + len(scene.all_points)) + segments + len(scene.cables) + ENERGIES + 2
    check_most(BYTES, 8.0 * numbers * saves, f"A run of {duration:g} s that saves {saves:.3g} states")


def save_times(t0, t_end, save_every):
    """Times at which a run saves that chooses its steps: every ``save_every`` [s], or `SAVES` times, and the end.

    Returns
    -------
    t : increasing (k,) float64 [s]
    """
    if save_every is None:
        return np.linspace(t0, t_end, SAVES + 1)
    times = np.minimum(t0 + np.arange(0.0, (t_end - t0) * (1 + 1e-12), save_every), t_end)
    return times if t_end - times[-1] < 1e-9 * (t_end - t0) else np.append(times, t_end)


def stops(scene):
    """Times that no step may cross: where the velocity of a driven point or the rate of a length jumps, and where one sets out.

    During a rest a chosen step grows without bound and could pass over a short motion; a solver that starts anew where
    the motion sets out cannot.

    Returns
    -------
    stops : increasing (k,) float64 [s]
    """
    found = [np.zeros(0)]
    for path in [*scene.motions, *rest_lengths.paths(scene)]:
        lasting = np.diff(path.breaks)[:, None] ** np.arange(1, path.coefficients.shape[1])
        way = np.einsum("kix,ki->k", np.abs(path.coefficients[:-1, 1:]), lasting)  # at least the way of each piece
        moves = np.append(way > RESTING * way.sum(), True)
        sets_out = moves & np.append(True, ~moves[:-1])
        found += [path.corners, path.breaks[sets_out]]
    return np.unique(np.concatenate(found))
