"""The steps about a largest tension that passes between two saved states: what it may be in truth.

A run tells what its largest tension lacks by how tensions change from state to state (`results.tension_error`). States that are
many steps apart do not show how one came that passes between them. So the steps about it are marched again from a saved state
before it, with some four hundred states of their own, or each step if they are fewer. It takes as long as a few saved intervals.
"""

from dataclasses import replace

from anet_lumped.results.peaks import hidden_peak
from anet_lumped.results.run import Run
from anet_lumped.results.tension_error import look_at, most_of_states, snap_tension

from .choice import Choice
from .motion import Motion

BEFORE = 2  # saved states before the peak, from which its steps are marched again


def with_peak_judged(run: Run, motion: Motion, choice: Choice) -> Run:
    """The run with `Run.peak_at_most`, where its largest tension passes between two of its states.

    Parameters
    ----------
    run : Run, from the marching of ``motion`` with fixed steps
    motion : Motion
    choice : Choice
    """
    hidden = hidden_peak(run)
    if hidden is None or not run.ok:
        return run
    first = max(hidden.row - BEFORE, 0)
    begin, last = run.state(first), min(hidden.row + 1, len(run.t) - 1)
    duration = float(run.t[last] - run.t[first])
    about = motion._replace(begin=begin, duration=duration, save_every=None).march(replace(choice, dt=run.dt))
    shown = float(about.segment_tension.max(initial=0.0))
    if not about.ok or len(about.t) <= 2 or shown <= 0.0:
        return run
    most = max(float(look_at(about).most.max()), snap_tension(about))
    return replace(run, peak_at_most=max(most_of_states(run), hidden.tension * max(most / shown, 1.0)))
