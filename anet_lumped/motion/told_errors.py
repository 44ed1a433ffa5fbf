"""A run that says which errors it keeps, and what it does not keep."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from anet_lumped.results.rigid_blows import has_rigid_blows
from anet_lumped.results.run import Run

from .known_errors import Known, Wanted, is_kept

ASKED = 10.0  # times the budget of runs that keep an error by default, for one that is asked for


class Beyond(NamedTuple):
    """Steps that the budget does not allow: the ``parts`` in which they take those of the last run, and the ``budget``.

    ``asked`` tells whether the error that is not kept was asked for.
    """

    parts: int
    budget: float
    asked: bool


def told(
    run: Run, known: Known, wanted: Wanted, how: str = "", too_short: float | None = None, beyond: Beyond | None = None
) -> Run:
    """The run with what was kept in its reason, and what was not in its warnings.

    ``how`` says with which step or tolerance. Steps of ``too_short`` [s] have told larger errors than those of the run. What it
    does not keep may take steps ``beyond`` the budget.
    """
    how = how or f"dt={run.dt:.3g} s"
    allowed = wanted.of_places(run)
    if run.error is not None:
        run = replace(run, error_factor=run.error_factor * known.of_told)
    reason = (
        f"{run.reason}; {how} keeps places to {allowed:.2g} m (estimated {known.error:.2g} m) "
        f"and peak tensions to {wanted.tension_error:.2g} (estimated {known.tension_error:.2g})"
    )
    if is_kept(run, known, wanted):
        return replace(run, reason=reason, kept=True)
    found = []
    if known.error > allowed:
        of_known = run.error[-1] / known.error if known.error < math.inf else 1.0  # no more than a node's way
        until = min(float(run.t[np.argmax(run.error > allowed * of_known)]), known.until)
        why = f", because the motion multiplies errors {known.of_told:.2g} times from t={known.since:.4g} s on"
        found.append(
            f"places are known to {allowed:.2g} m until t={until:.4g} s, to {known.error:.2g} m at the end"
            f"{why if known.since < math.inf else ''}"
        )
    if has_rigid_blows(run):
        found.append("the largest tension has no value, because cables that do not stretch were caught in blows")
    elif known.tension_error > wanted.tension_error:
        found.append(
            f"the largest tension is known to {known.tension_error:.1%} where {wanted.tension_error:.1%} are wanted: "
            f"it jumps faster than the steps resolve{_or_are_saved(run)}"
        )
    if too_short is not None:
        found.append(f"dt={too_short:.3g} s was tried too, and told larger errors, of rounding or of vibrations that it shows")
    if beyond is not None:
        wish = f"error={allowed:.2g}" if known.error > allowed else f"tension_error={wanted.tension_error:.2g}"
        more = "" if beyond.asked else f"{wish} has {ASKED:g} times that, and "
        found.append(
            f"shorter steps may keep it, beyond the budget of {beyond.budget:.2g} Newton iterations times nodes; {more}"
            f"dt={run.dt / beyond.parts:.2g} s is next, which takes about {beyond.parts} times this run's time"
        )
    said = "; ".join(found)
    text = f"{run.method} with {how}: {said}."
    return replace(run, reason=f"{run.reason}; with {how} {said}", warnings=(*run.warnings, text), kept=False)


def _or_are_saved(run: Run) -> str:
    """What hides jumps of a tension besides the steps: saved states that are farther apart than those."""
    farther = float(np.diff(run.t).max(initial=0.0)) > 1.5 * run.dt
    return ", or its peak is between saved states, of which a smaller save_every has more" if farther else ""
