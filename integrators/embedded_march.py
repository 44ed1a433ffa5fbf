"""Marching an embedded explicit pair: steps chosen by its own error estimate, saves by its own dense output."""

import numpy as np
from numba import njit, types

from . import embedded_pair as pair
from .march import begin, copy, keep, locate, save, worst_node
from .system import (
    DISSIPATED,
    DIVERGED,
    DONE,
    EVENT,
    INTERRUPTED,
    NEVER,
    OUT_OF_STEPS,
    PUT_IN,
    REJECTED,
    STEP,
    STEPS,
    UNCONVERGED,
    compiled,
    system_at,
)

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1 = types.Array(types.int64, 1, "C")

MOST = 1_000_000  # steps tried in a run; a bound on what is otherwise unbounded
IN_A_ROW = 40  # rejected steps, after which an error is called one that no step keeps small
SUSTAINED, RELIEVED = 15, 6  # steps in a row (Hairer & Wanner): held by stability from so many on, and free again


@njit(cache=True, error_model="numpy", nogil=True)
def embedded_steps(
    step, place, net, t0, t_end, dt, order, rtol, atol, stiff, most, corners, q, v, memory, options, counts, balance, out_t,
    out_q, out_v, out_balance, out_seen, stop
):  # fmt: skip
    """March with steps chosen by the error that an embedded pair estimates.

    A step is taken when its error (see `pair.judge`) is at most atol + rtol max|q|, and the next is chosen by a PI controller
    (Gustafsson). Steps end on the corners of the prescribed motions, whose velocities are limits from the left up to there,
    and on t_end; states at the times in out_t come from the dense output. The march ends at an event, see `march.locate`.

    Parameters
    ----------
    stiff : float64
        h |lambda| of the last two stages above which a step is held by stability.
    most : int64
        Steps that may be tried.

    Returns
    -------
    status, saved, t, node, error, held, held_for : int64, int64, float64, int64, float64, int64, float64
        As `fixed_steps`, the last row being the state reached; the sum of the estimated errors of places [m]; how many steps
        stability held, and their time [s].
        They count where at least `SUSTAINED` were held with no `RELIEVED` free ones in a row between them.
    """
    system = system_at(place)
    begin(system, net, t0, q, v, memory, counts, balance)
    save(system, net, 0, t0, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
    saved, t, h, total, before = 1, t0, dt, 0.0, 1.0
    carried = memory[:1]
    q_a, v_a, force_a, balance_a, shown = q.copy(), v.copy(), carried.copy(), balance.copy(), balance.copy()
    corner, rejections, tried = 0, 0, 0
    held, held_for, in_row, free_row, row_for = 0, 0.0, 0, 0, 0.0
    while corner < corners.shape[0] and corners[corner] <= t + 1e-12 * (t_end - t0):
        corner += 1
    status, node, watched, margin = DONE, -1, system.margin(q, v, net) > NEVER, -1.0
    while t < t_end:
        if stop[0] != 0 or tried == most:
            status = INTERRUPTED if stop[0] != 0 else OUT_OF_STEPS
            break
        tried += 1
        at_corner = corner < corners.shape[0] and corners[corner] < t_end
        goal = corners[corner] if at_corner else t_end
        full, lands = h, False
        if t + h > goal - 1e-9 * h:
            # the last stages look back from a corner: some roundings of the time before it
            h, lands = goal - t - (1e-15 * (abs(goal) + abs(t)) if at_corner else 0.0), True
        elif t + 2.0 * h > goal:
            h = 0.5 * (goal - t)
        keep(q, v, carried, balance, q_a, v_a, force_a, balance_a)
        if watched:
            system.remember(net, 0)
        step(system, net, t, h, q, v, memory, options, counts, balance)
        error, of_places, size, fastest = pair.judge(system, h, q, v, memory, options)
        allowed = atol + rtol * size
        error = error / allowed if allowed > 0.0 or error == np.inf else (0.0 if error == 0.0 else np.inf)
        if not error <= 1.0:
            counts[REJECTED] += 1
            rejections += 1
            node = worst_node(q, v)
            keep(q_a, v_a, force_a, balance_a, q, v, carried, balance)
            smaller = h * (0.25 if not error < np.inf else max(0.2, 0.9 * error ** (-1.0 / order)))
            if rejections > IN_A_ROW or t + 0.1 * smaller <= t:
                status = UNCONVERGED if error < np.inf else DIVERGED
                break
            h = smaller
            continue
        counts[STEPS] += 1
        total += of_places
        in_row, free_row = (in_row + 1, 0) if fastest > stiff else (in_row, free_row + 1)
        row_for += h if fastest > stiff else 0.0
        if free_row == RELIEVED:
            in_row, row_for = 0, 0.0
        if in_row >= SUSTAINED and fastest > stiff:
            held += SUSTAINED if in_row == SUSTAINED else 1
            held_for += row_for
            row_for = 0.0
        end, ready = goal if lands else t + h, False
        if watched:
            last, margin = margin, system.margin(q, v, net)
            if margin > 0.0:
                h = locate(
                    step, system, net, t, h, 1, last, margin, q_a, v_a, force_a, balance_a, q, v, memory, options, counts, balance
                )  # fmt: skip
                end, status = t + h, EVENT
        while saved < out_t.shape[0] and out_t[saved] <= end:
            at = out_t[saved]
            keep(q, v, carried, balance, out_q[saved], out_v[saved], force_a, shown)
            if at < end:
                if not ready:
                    pair.prepare(system, net, t, h, q_a, v_a, memory, options, counts)
                    ready = True
                shown[DISSIPATED], shown[PUT_IN] = balance_a[DISSIPATED], balance_a[PUT_IN]
                pair.between((at - t) / h, h, q_a, v_a, memory, options, system.n_free, out_q[saved], out_v[saved], shown)
            system.prescribe(at, net, out_q[saved], out_v[saved])
            system.observe(out_q[saved], out_v[saved], net, out_seen[saved])
            system.energy(at, out_q[saved], out_v[saved], net, shown)
            copy(shown[:5], out_balance[saved])
            saved += 1
        t = end
        if status == EVENT:
            break
        if lands and at_corner:
            corner += 1
            begin(system, net, t, q, v, memory, counts, balance)
        grow = 0.9 * max(error, 1e-8) ** (-0.7 / order) * max(before, 1e-8) ** (0.4 / order)
        if rejections > 0:
            grow = min(grow, 1.0)
        h = max(h * min(5.0, max(0.2, grow)), full if h < full and error < 0.5 else 0.0)
        before, rejections = error, 0
    if status != DONE and out_t[saved - 1] < t and saved < out_t.shape[0]:  # the state that was reached
        save(system, net, saved, t, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
        saved += 1
    return status, saved, t, node if status == DIVERGED else -1, total, held, held_for


def embedded_march():
    """`embedded_steps`, compiled (or loaded from the cache) when it is first asked for."""
    f, i = types.float64, types.int64
    own = (types.int64, f, f, f, i, f, f, f, i, _f1)
    state, out = (_f2, _f2, _f3, _f1, _i1, _f1), (_f1, _f3, _f3, _f2, _f2, _i1)
    return compiled(embedded_steps, (types.FunctionType(STEP), types.int64, *own, *state, *out))
