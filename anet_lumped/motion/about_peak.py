"""The steps about a largest tension that passes between two saved states: what it may be in truth.

A run tells what its largest tension lacks by how tensions change from state to state (`results.tension_error`). States that are
many steps apart do not show how one came that passes between them. So the steps about it are marched again from a saved state
before it, with some four hundred states of their own, or each step if they are fewer. It takes as long as a few saved intervals.
Adaptive steps may be longer than the peak, and states between two of them show more than their ends; these are marched from the
start again, since not every saved state is one from which links can go on.
"""

from dataclasses import replace

import numpy as np

from anet_lumped.results.peaks import hidden_peak, largest_of_cables
from anet_lumped.results.run import Run
from anet_lumped.results.tension_error import look_at, most_of_states, snap_tension

from .choice import Choice
from .motion import Motion

BEFORE = 2  # saved states before the peak, from which its steps are marched again
BETWEEN = 10  # states in one saved interval of adaptive steps


def with_peak_judged(run: Run, motion: Motion, choice: Choice) -> Run:
    """The run with `Run.peak_at_most`, where its largest tension passes between two of its states.

    Parameters
    ----------
    run : Run, from the marching of ``motion``
    motion : Motion
    choice : Choice
    """
    hidden = hidden_peak(run)
    if hidden is None or not run.ok:
        return run
    adaptive, last = motion.settings.adaptive, min(hidden.row + 1, len(run.t) - 1)
    first = 0 if adaptive else max(hidden.row - BEFORE, 0)
    begin, duration = motion.begin if adaptive else run.state(first), float(run.t[last] - run.t[first])
    every = float(np.median(np.diff(run.t))) / BETWEEN if adaptive else None
    about = motion._replace(begin=begin, duration=duration, save_every=every).march(replace(choice, dt=run.dt))
    shown = float(about.segment_tension.max(initial=0.0))
    if not about.ok or len(about.t) <= 2 or shown <= 0.0:
        return run
    most = max(float(look_at(about).most.max()), snap_tension(about))
    largest = run.largest_tension
    if shown > hidden.tension:
        largest, found = largest.copy(), largest_of_cables(about.model, about.segment_tension).max(axis=0)
        np.maximum(largest[hidden.row :], found, out=largest[hidden.row :])
    peak = max(shown, hidden.tension)
    return replace(run, largest_tension=largest, peak_at_most=max(most_of_states(run), peak * max(most / shown, 1.0)))
