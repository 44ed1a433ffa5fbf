"""What the audit of a run found."""

from dataclasses import dataclass

IMBALANCE = 1e-2  # of the energy in play: more than this is not accounted for
TENSION_ALLOWED = 5e-2  # of the largest tension


@dataclass(frozen=True, repr=False)
class Audit:
    """What the audit of a run found; ``str`` has all of it, ``repr`` a short line.

    Parameters
    ----------
    error : float [m]
        Largest error of a place, estimated from the same run with half the step (by its order) or a tenth of the tolerance, and
        a third one with a quarter of the step where the first two disagree with `Run.error_estimate`; infinite if those come no
        nearer.
    where, t : str, float [s]
        The node and the time of it.
    allowed : float [m]
    imbalance : float
        Energy that is not accounted for by work and forces, relative to what was in play.
    wall_time : float [s]
        That the finer run took.
    reason : str
        Why the run did not pass, one sentence; empty if it did.
    tension_error : float
        Of the largest tension, over it; estimated likewise.
    """

    error: float
    where: str
    t: float
    allowed: float
    imbalance: float
    wall_time: float
    reason: str = ""
    tension_error: float = 0.0

    def __repr__(self) -> str:
        how = "passed" if self.passed else "failed"
        return f"<Audit {how}: places to {self.error:.3g} m, peak tension to {self.tension_error:.2g} of it>"

    def __str__(self) -> str:
        lines = [self.reason or "The audit passed."]
        lines += [
            f"places: off by {self.error:.3g} m, {self.where} at t={self.t:.4g} s; {self.allowed:.3g} m are allowed",
            f"largest tension: off by {self.tension_error:.2g} of it; {TENSION_ALLOWED:g} are allowed",
            f"energy: {self.imbalance:.2g} of what was in play not accounted for; {IMBALANCE:g} are allowed",
            f"the finer run took {self.wall_time:.3g} s",
        ]
        return "\n".join(lines)

    @property
    def passed(self) -> bool:
        """Whether nothing was found."""
        return not self.reason
