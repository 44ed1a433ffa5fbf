"""The static curve of a polyester rope with working curves, and whether its curves and its fast spring go together."""

from collections.abc import Sequence
from functools import lru_cache
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
    if (fault := _fault(curve, working, fast)) is not None:
        raise SceneError(fault.format(owner=owner))


@lru_cache(maxsize=64)  # cables of one rope are many
def _fault(curve: Curve, working: WorkingCurve, fast: tuple[float, float]) -> str | None:
    """What is wrong with the curves of an ``{owner}``, or None."""
    for (eps_a, T_a), (eps_b, T_b) in pairwise(((0.0, 0.0), *curve)):
        if fault := _too_steep("tension_strain", (T_b - T_a) / (eps_b - eps_a), T_a, fast):
            return fault
    ends = sorted({0.0, working.T_max, *(T for _, T in curve), 2.0 * max(working.T_max, curve[-1][1])})
    before: tuple[float, float, float] | None = None
    for lower, upper in pairwise(T for T in ends if T >= working.T_max):
        for k in range(0 if before is None else 1, BETWEEN_ROWS + 1):
            T = lower + (upper - lower) * k / BETWEEN_ROWS
            if T == 0.0:
                continue
            rows = _working(curve, working, T)
            reached = strain_of(curve, T), T, _area(rows)
            if fault := _fault_of_working(rows, T, fast) or _too_much_work(before, reached):
                return fault
            before = reached
    return None


def _too_steep(what: str, slope: float, T: float, fast: tuple[float, float], of: str = "") -> str | None:
    stiffness = fast[0] + fast[1] * T
    if slope < stiffness:
        return None
    return (
        f"The {what} of a polyester rope must be less steep than its fast spring, EA_dynamic + EA_dynamic_per_tension·T, "
        f"but that of {{owner}}{of} has the slope {slope:.4g} N at T={T:.4g} N, where the fast spring has {stiffness:.4g} N."
    )


def _fault_of_working(rows: list[tuple[float, float]], T_max: float, fast: tuple[float, float]) -> str | None:
    if rows[0][0] < 0.0:
        return (
            f"A working curve must begin at no negative strain, but that of {{owner}} for T_max={T_max:.4g} N does "
            f"at {rows[0][0]:.4g}."
        )
    slopes = (((T_b - T_a) / (eps_b - eps_a), T_a) for (eps_a, T_a), (eps_b, T_b) in pairwise(rows))
    faults = (_too_steep("working curve", slope, T, fast, f" for T_max={T_max:.4g} N") for slope, T in slopes)
    return next(filter(None, faults), None)


def _area(rows: list[tuple[float, float]]) -> float:
    """Work that a working curve gives back, over the length [N]."""
    return sum(0.5 * (T_a + T_b) * (eps_b - eps_a) for (eps_a, T_a), (eps_b, T_b) in pairwise(rows))


def _too_much_work(before: tuple[float, float, float] | None, now: tuple[float, float, float]) -> str | None:
    """Of two strains, largest tensions and areas: the area must grow by no more than the work along the original curve."""
    if before is None:
        return None
    done = 0.5 * (before[1] + now[1]) * (now[0] - before[0])
    if now[2] - before[2] <= done + ROUNDING * now[2]:
        return None
    return (
        "A working curve must give back no more work than the original curve takes, but that of {owner} does as T_max "
        f"grows from {before[1]:.4g} to {now[1]:.4g} N; more `permanent` strain takes more."
    )
