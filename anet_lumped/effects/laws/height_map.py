"""A height map: heights over a grid in x and y, bilinear in each cell, and beyond the grid those of its nearest edge.

At the edges of cells the map is rounded, so that its slope does not jump: there it is the mean of the bilinear map over the width
d = `ROUNDED` times the smaller of the two intervals beside the edge. Along one coordinate, with the slopes L and R on either side
of a grid point of height f and the distance t from it,

    H = f + t (L + R)/2 + (R - L)/2 (t^2/d + d/4) ,    |t| < d/2 ,

and the bilinear map elsewhere. Without that, a node that comes to rest in an edge would have a force that jumps.

``params`` holds, from ``first`` on, the numbers m and n of grid points, m places x, n places y, and m n heights, row by row of x.
"""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any, NamedTuple

from anet_lumped.checks import SceneError, check_number, shown
from anet_lumped.compiled.jit import inlined_law, law

ROUNDED = 0.02  # of the smaller interval beside a grid point: the width over which the map is rounded there


def checked_map(x: Any, y: Any, heights: Any, owner: str) -> dict[str, Any]:
    """The places ``x`` and ``y`` and the ``heights`` of a map that an effect is given, as tuples of numbers [m], by these names.

    Raises
    ------
    SceneError : places that do not grow, or heights that are no row for each of them
    """
    found: dict[str, Any] = {}
    for key, given in (("x", x), ("y", y)):
        places = found[key] = _numbers(key, given, owner)
        if len(places) < 2 or any(after <= before for before, after in pairwise(places)):
            raise SceneError(f"Argument `{key}` must be two or more places [m] that grow, but {owner} has {shown(given)}.")
    try:
        rows = tuple(_numbers("heights", row, owner) for row in heights)
    except TypeError:
        rows = ()
    if len(rows) != len(found["x"]) or any(len(row) != len(found["y"]) for row in rows):
        raise SceneError(
            f"Argument `heights` must have a row for each of the {len(found['x'])} places x, with a number [m] for each of the "
            f"{len(found['y'])} places y, but {owner} has {shown(heights)}."
        )
    return found | {"heights": rows}


def _numbers(key: str, values: Any, owner: str) -> tuple[float, ...]:
    if isinstance(values, str | bytes | Mapping):
        values = ()
    try:
        return tuple(check_number(key, value, "m", owner) for value in values)
    except TypeError:
        return ()


class Spot(NamedTuple):
    """The map at a place: height [m], slopes, second derivatives [1/m], and the number of its cell, -1 where it is rounded."""

    height: Any
    slope_x: Any
    slope_y: Any
    xx: Any
    xy: Any
    yy: Any
    cell: Any


class _Along(NamedTuple):
    """Shares of three grid points from ``start`` on along one coordinate, their first and second derivatives, and the interval.

    The interval counts from 0 before the first grid point; it is -1 where the map is rounded.
    """

    start: Any
    share: Any
    slope: Any
    bend: Any
    interval: Any


@inlined_law
def _along(at, params, first, count):
    """`_Along` at a coordinate [m], of a grid of ``count`` places from ``first`` on."""
    low, high = 0, count - 1
    while high - low > 1:  # the interval that holds it, or the nearest one
        middle = (low + high) // 2
        if params[first + middle] <= at:
            low = middle
        else:
            high = middle
    width = params[first + low + 1] - params[first + low]
    near = low if at - params[first + low] < 0.5 * width else low + 1  # the nearest grid point
    before = params[first + near] - params[first + near - 1] if near > 0 else 0.0
    after = params[first + near + 1] - params[first + near] if near < count - 1 else 0.0
    smaller = min(before, after) if before > 0.0 and after > 0.0 else max(before, after)
    d, t = ROUNDED * smaller, at - params[first + near]
    per_before, per_after = 1.0 / before if before > 0.0 else 0.0, 1.0 / after if after > 0.0 else 0.0
    if abs(t) < 0.5 * d:
        # of L and of R, and their derivatives
        left, right = 0.5 * t - 0.5 * (t * t / d + 0.25 * d), 0.5 * t + 0.5 * (t * t / d + 0.25 * d)
        left_slope, right_slope, bend = 0.5 - t / d, 0.5 + t / d, 1.0 / d
        share = (-left * per_before, 1.0 + left * per_before - right * per_after, right * per_after)
        slope = (-left_slope * per_before, left_slope * per_before - right_slope * per_after, right_slope * per_after)
        bends = (bend * per_before, -bend * per_before - bend * per_after, bend * per_after)
        return _Along(near - 1, share, slope, bends, -1)
    if at <= params[first]:
        return _Along(-1, (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0)
    if at >= params[first + count - 1]:
        return _Along(count - 2, (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), count)
    u = (at - params[first + low]) / width
    return _Along(low - 1, (0.0, 1.0 - u, u), (0.0, -1.0 / width, 1.0 / width), (0.0, 0.0, 0.0), low + 1)


@law
def spot(x, y, params, first):
    """`Spot` of the map at a place [m]."""
    m, n = int(params[first]), int(params[first + 1])
    by_x, by_y = _along(x, params, first + 2, m), _along(y, params, first + 2 + m, n)
    heights = first + 2 + m + n
    height, slope_x, slope_y, xx, xy, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for a in range(3):
        for b in range(3):
            i, j = min(max(by_x.start + a, 0), m - 1), min(max(by_y.start + b, 0), n - 1)  # of no share where there is none
            h = params[heights + i * n + j]
            height += h * by_x.share[a] * by_y.share[b]
            slope_x += h * by_x.slope[a] * by_y.share[b]
            slope_y += h * by_x.share[a] * by_y.slope[b]
            xx += h * by_x.bend[a] * by_y.share[b]
            xy += h * by_x.slope[a] * by_y.slope[b]
            yy += h * by_x.share[a] * by_y.bend[b]
    rounded = by_x.interval < 0 or by_y.interval < 0
    return Spot(height, slope_x, slope_y, xx, xy, yy, -1 if rounded else by_x.interval * (n + 1) + by_y.interval)


@inlined_law
def in_one_cell(before, after):
    """Whether two places are in one cell, where the map is bilinear."""
    return before.cell == after.cell and before.cell >= 0


class MeanSlope(NamedTuple):
    """Slopes of a map over a step, (H_b - H_a) = slope . (q_b - q_a), and their derivatives in q_b: xx, xy, yx, yy [1/m]."""

    x: Any
    y: Any
    xx: Any
    xy: Any
    yx: Any
    yy: Any


@inlined_law
def mean_slope(before, after, dx, dy):
    """`MeanSlope` of a step (dx, dy) [m] from the `Spot` ``before`` to ``after``.

    In one cell H is of second order, and the mean m of the slopes at both ends does it. Otherwise what lacks,
    c = H_b - H_a - m . D, is added along the step D: m + c D/|D|^2 (Gonzalez).
    """
    mx, my = 0.5 * (before.slope_x + after.slope_x), 0.5 * (before.slope_y + after.slope_y)
    xx, xy, yy, square = 0.5 * after.xx, 0.5 * after.xy, 0.5 * after.yy, dx * dx + dy * dy
    if in_one_cell(before, after) or square == 0.0:
        return MeanSlope(mx, my, xx, xy, xy, yy)
    share = (after.height - before.height - mx * dx - my * dy) / square
    cx, cy = after.slope_x - mx - xx * dx - xy * dy, after.slope_y - my - xy * dx - yy * dy  # derivative of what lacks
    ax, ay = (cx - 2.0 * share * dx) / square, (cy - 2.0 * share * dy) / square
    return MeanSlope(mx + share * dx, my + share * dy, xx + share + dx * ax, xy + dx * ay, xy + dy * ax, yy + share + dy * ay)
