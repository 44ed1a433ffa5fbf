"""How a run ended, in words."""

from typing import Any


def verdict(run: Any) -> str:
    """How a run ended, in words: its estimated error and its energy if an audit passed, its message if it is not "done"."""
    ran = f"{run.method}, t = {run.t[0]:.4g} to {run.t[-1]:.4g} s"
    if not run.ok:
        return f"{run.status.upper()} ({ran}): {run.message.removeprefix('The audit failed: ')}"
    if run.audit is None:
        return f"finished ({ran}); accuracy not checked (--audit)"
    audit = run.audit
    return (
        f"audit passed ({ran}): positions to {as_length(audit.error)} (estimate, at {audit.where}, t={audit.t:.3g} s; "
        f"{as_length(audit.allowed)} allowed), energy accounted for to {audit.imbalance:.1g}"
    )


def as_length(metres: float) -> str:
    """A length with the unit that suits it: "0.21 mm"."""
    unit, size = next(((u, s) for u, s in (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)) if metres >= s), ("nm", 1e-9))
    return f"{metres / size:.3g} {unit}"
