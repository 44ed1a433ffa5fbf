"""The static curve of a polyester rope with working curves, and whether its curves and its fast spring go together."""

from collections.abc import Sequence
from itertools import pairwise

from anet_lumped.checks import SceneError

from .tension_strain import Curve
from .working_curves import WorkingCurve

BETWEEN_ROWS = 8  # largest tensions that are looked at for each piece of an original curve
ROUNDING = 1e-12  # of a work


def strain_of(curve: Curve, T: float) -> float:
    """Strain of a tension-strain curve at a tension [N], straight on beyond its last row."""
    for (eps_a, T_a), (eps_b, T_b) in pairwise(((0.0, 0.0), *curve)):
        if T <= T_b or (eps_b, T_b) == curve[-1]:
            return eps_a + (T - T_a) * (eps_b - eps_a) / (T_b - T_a)
    raise AssertionError("a curve has rows")


def _working(curve: Curve, working: WorkingCurve, T_max: float) -> list[tuple[float, float]]:
    """Rows (strain, tension [N]) of the working curve of T_max, from its strain without tension on."""
    eps_max = strain_of(curve, T_max)
    eps_0 = working.first_strain(eps_max, T_max)
    return [(eps_0, 0.0), *((eps_0 + (eps_max - eps_0) * xi, T_max * g) for xi, g in working.shape)]


def static_curve(curve: Curve, working: WorkingCurve) -> tuple[float, Curve]:
    """Strain that the rope has kept, and the curve of loads that are held, in strains of the length that it has with it."""
    T_max, kept = working.T_max, 0.0
    rows: Sequence[tuple[float, float]] = curve
    if T_max > 0.0:
        (kept, _), *below = _working(curve, working, T_max)
        above = [row for row in curve if row[1] > T_max]
        if not above:  # straight on beyond the last row
            above = [(strain_of(curve, 2.0 * T_max), 2.0 * T_max)]
        rows = (*below, *above)
    return kept, tuple(((strain - kept) / (1.0 + kept), T) for strain, T in rows)


def check_polyester(curve: Curve, working: WorkingCurve, fast: tuple[float, float], owner: str) -> None:
    """Check the curves of a rope, from the `T_max` that it has held to the last row of its original curve and to twice that.

    Parameters
    ----------
    curve : the original curve
    working : WorkingCurve
    fast : `EA_dynamic` [N] and `EA_dynamic_per_tension`
    owner : whose, for messages

    Raises
    ------
    SceneError : a curve that is as steep as the fast spring, a working curve that begins at a negative strain, or that gives back
        more work than was done
    """
    T_max, EA, per_tension = working.T_max, *fast
    for (eps_a, T_a), (eps_b, T_b) in pairwise(((0.0, 0.0), *curve)):
        _check_slope("tension_strain", (T_b - T_a) / (eps_b - eps_a), T_a, EA + per_tension * T_a, owner)
    ends = sorted({0.0, T_max, *(T for _, T in curve), 2.0 * max(T_max, curve[-1][1])})
    before: tuple[float, float, float] | None = None
    for lower, upper in pairwise(T for T in ends if T >= T_max):
        for k in range(0 if before is None else 1, BETWEEN_ROWS + 1):
            T = lower + (upper - lower) * k / BETWEEN_ROWS
            if T > 0.0:
                rows = _working(curve, working, T)
                _check_working(rows, T, EA, per_tension, owner)
                before = _check_work(rows, strain_of(curve, T), T, before, owner)


def _check_slope(what: str, slope: float, T: float, fast: float, owner: str, of: str = "") -> None:
    if not slope < fast:
        raise SceneError(
            f"The {what} of a polyester rope must be less steep than its fast spring, EA_dynamic + EA_dynamic_per_tension·T, "
            f"but that of {owner}{of} has the slope {slope:.4g} N at T={T:.4g} N, where the fast spring has {fast:.4g} N."
        )


def _check_working(rows: list[tuple[float, float]], T_max: float, EA: float, per_tension: float, owner: str) -> None:
    if rows[0][0] < 0.0:
        raise SceneError(
            f"A working curve must begin at no negative strain, but that of {owner} for T_max={T_max:.4g} N does "
            f"at {rows[0][0]:.4g}."
        )
    for (eps_a, T_a), (eps_b, T_b) in pairwise(rows):
        slope = (T_b - T_a) / (eps_b - eps_a)
        _check_slope("working curve", slope, T_a, EA + per_tension * T_a, owner, f" for T_max={T_max:.4g} N")


def _check_work(
    rows: list[tuple[float, float]], eps_max: float, T: float, before: tuple[float, float, float] | None, owner: str
) -> tuple[float, float, float]:
    """The strain, the tension, and the work that a working curve gives back [N]; it must grow by no more than the work done."""
    back = sum(0.5 * (T_a + T_b) * (eps_b - eps_a) for (eps_a, T_a), (eps_b, T_b) in pairwise(rows))
    if before is not None:
        done = 0.5 * (before[1] + T) * (eps_max - before[0])
        if back - before[2] > done + ROUNDING * back:
            raise SceneError(
                f"A working curve must give back no more work than the original curve takes, but that of {owner} does as T_max "
                f"grows from {before[1]:.4g} to {T:.4g} N; more `permanent` strain takes more."
            )
    return eps_max, T, back
