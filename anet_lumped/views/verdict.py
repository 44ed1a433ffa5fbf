"""How a run ended, in words."""

from typing import Any

import numpy as np


def verdict(run: Any) -> str:
    """How a run ended, in words: its errors, as an audit or the run itself estimates them, its message if it is not "done".

    And that it swings between its saved states, where curves through these show another motion; that of a failure is none.
    """
    ended = _how_it_ended(run)
    if not ((run.ok or run.status == "interrupted") and run.hides_swings):
        return ended
    apart = float(np.diff(run.t).max())
    return f"{ended.rstrip('.')}; states are saved {apart:.3g} s apart and do not show its swings, a smaller save_every does"


def _how_it_ended(run: Any) -> str:
    ran = f"{run.method}, t = {run.t[0]:.4g} to {run.t[-1]:.4g} s"
    if not run.ok:
        return f"{run.status.upper()} ({ran}): {run.message.removeprefix('The audit failed: ')}"
    if run.audit is None:
        return f"finished ({ran}); {_estimated(run)}"
    audit = run.audit
    return (
        f"audit passed ({ran}): positions to {as_length(audit.error)} (estimate, at {audit.where}, t={audit.t:.3g} s; "
        f"{as_length(audit.allowed)} allowed), energy accounted for to {audit.imbalance:.1g}"
    )


def _estimated(run: Any) -> str:
    """What a run without an audit tells of its errors, and where it has that from."""
    if run.error_estimate is None:
        places = "not known (--audit tells)"
    else:
        places = as_length(run.error_estimate) + (f", perhaps {run.multiplies:.2g} times that" if run.multiplies > 1.0 else "")
    source = "two runs compared" if run.was_compared else "from its own steps, not audited"
    return (
        f"estimated errors: places {places}, largest tension {100.0 * run.tension_error:.2g} % "
        f"({source}{', more than wanted' if run.kept is False else ''})"
    )


def as_length(metres: float) -> str:
    """A length with the unit that suits it: "0.21 mm"."""
    unit, size = next(((u, s) for u, s in (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)) if metres >= s), ("nm", 1e-9))
    return f"{metres / size:.3g} {unit}"
