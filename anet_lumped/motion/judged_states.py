"""States by which a run judges its errors where a user saves few of them: a peak of a tension must not be lost between two.

Frames of a film are a 25th of a second apart, and a snap is over in a hundredth. So a run that keeps an error is marched with some
`times.SAVES` states, and those that were asked for are returned, with the largest tension of all steps (`Run.largest_tension`).
"""

import math
from dataclasses import replace

import numpy as np

from anet_lumped.results.peaks import largest_so_far
from anet_lumped.results.run import Run, with_states

from .choice import Choice
from .times import SAVES


def judged_every(choice: Choice, save_every: float | None, duration: float) -> tuple[Choice, float | None]:
    """Time between states that are judged, and the choice with steps that meet them.

    Parameters
    ----------
    choice : Choice, with a whole number of steps between saved states
    save_every : float or None [s], between states that are asked for
    duration : float [s]

    Returns
    -------
    choice : Choice
        Its step is shorter by less than one in twenty, or the same.
    every : float or None [s], a part of ``save_every``, or that itself if it saves enough states
    """
    if save_every is None or duration / save_every >= SAVES:
        return choice, save_every
    steps = round(save_every / choice.dt)
    stride = max(1, math.floor(steps * duration / save_every / SAVES))
    parts = math.ceil(steps / stride)
    return replace(choice, dt=save_every / (parts * stride)), save_every / parts


def as_asked(run: Run, save_every: float) -> Run:
    """The states of a run that were asked for, ``save_every`` [s] apart; its error is told as those that were judged tell it."""
    if run.largest_tension is None:  # it has saved every step
        run = replace(run, largest_tension=largest_so_far(run.model, run.segment_tension))
    run = replace(run, peak_at_most=run.peak_tension() / max(1.0 - run.tension_error, 1e-6))
    apart = (run.t - run.t[0]) / save_every
    rows = np.abs(apart - np.round(apart)) < 1e-6
    rows[-1] = True
    fewer = with_states(run, rows)
    told = fewer.error_estimate
    return replace(fewer, error_factor=fewer.error_factor * run.error_estimate / told) if told and run.error_estimate else fewer
