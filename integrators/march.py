"""Marching a scheme: fixed steps with halving, or steps chosen by step doubling; saving, and stopping what goes wrong."""

import numpy as np
from numba import njit, types

from .system import (
    DISSIPATED,
    DIVERGED,
    DONE,
    EVENT,
    FORCES,
    HALVINGS,
    INTERRUPTED,
    NEVER,
    POWER_DISSIPATED,
    POWER_PUT_IN,
    PUT_IN,
    REJECTED,
    SCRATCH,
    STEP,
    STEPS,
    UNCONVERGED,
    compiled,
    system_at,
)

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1 = types.Array(types.int64, 1, "C")

CHECK_EVERY = 16  # explicit steps between two looks for a divergence
ABSURD = 1e6  # metres plus metres a second, for anything that hangs on a cable
SMALLEST = 2.0**-12  # of the step asked for, or of the first one: there Newton's method may fail no more
SAME = 1e-6  # of a step: times that are no farther apart are one; a velocity over less shows rounding
WITHIN = 1e-8  # margin of an event to which its time is found, or else to `SAME`
TRIALS = 60  # steps that finding it may take


@njit(cache=True, error_model="numpy")
def begin(system, net, t, q, v, memory, counts, balance):
    """Prescribed rows, the force at the start in ``memory[0]``, and its powers."""
    power = balance[SCRATCH:]
    system.prescribe(t, net, q, v)
    system.force(t, q, v, net, memory[0], power)
    counts[FORCES] += 1
    balance[POWER_DISSIPATED], balance[POWER_PUT_IN] = power[0], power[1]


@njit(cache=True, error_model="numpy")
def arrive(system, net, t, h, q, v, memory, counts, balance, share=0.5):
    """Force at the end of a step in ``memory[0]``; adds the step's work by the trapezoidal rule.

    Of the power dissipated, that at the end has the ``share`` that its forces have in the step.
    """
    power = balance[SCRATCH:]
    system.prescribe(t + h, net, q, v)
    system.force(t + h, q, v, net, memory[0], power)
    counts[FORCES] += 1
    dissipated, put_in = power[0], power[1]
    balance[DISSIPATED] += h * ((1.0 - share) * balance[POWER_DISSIPATED] + share * dissipated)
    balance[PUT_IN] += 0.5 * h * (balance[POWER_PUT_IN] + put_in)
    balance[POWER_DISSIPATED], balance[POWER_PUT_IN] = dissipated, put_in


@njit(cache=True, error_model="numpy")
def worst_node(q, v):
    """Node whose place or velocity is not finite or beyond any sense, or -1."""
    for i in range(q.shape[0]):
        size = 0.0
        for x in range(3):
            size += abs(q[i, x]) + abs(v[i, x])
        if not size < ABSURD:
            return i
    return -1


@njit(cache=True, error_model="numpy")
def copy(of, to):
    """Copy a flat array; an assignment of arrays would compile for seconds, for the errors that it may raise."""
    for i in range(of.shape[0]):
        to[i] = of[i]


@njit(cache=True, error_model="numpy")
def keep(q, v, carried, balance, q_to, v_to, carried_to, balance_to):
    """Copy a state and what a scheme carries with it."""
    copy(q.ravel(), q_to.ravel())
    copy(v.ravel(), v_to.ravel())
    copy(carried.ravel(), carried_to.ravel())
    copy(balance, balance_to)


@njit(cache=True, error_model="numpy")
def save(system, net, k, t, q, v, balance, out_t, out_q, out_v, out_balance, out_seen):
    """Write row k of what comes back."""
    system.observe(q, v, net, out_seen[k])
    system.energy(t, q, v, net, balance)
    out_t[k] = t
    copy(q.ravel(), out_q[k].ravel())
    copy(v.ravel(), out_v[k].ravel())
    copy(balance[:5], out_balance[k])


@njit(cache=True, error_model="numpy")
def advance(step, system, net, t, h, parts, q, v, memory, options, counts, balance):
    """Take h in equal parts."""
    for part in range(parts):
        status = step(system, net, t + part * h / parts, h / parts, q, v, memory, options, counts, balance)
        if status != DONE:
            return status
    return DONE


@njit(cache=True, error_model="numpy")
def locate(
    step, system, net, t, h, parts, before, after, q_a, v_a, carried_a, balance_a, q, v, memory, options, counts, balance
):  # fmt: skip
    """Find the event within a step, at whose end the margin is positive: the step is taken again, from its start and shorter.

    Regula falsi on the length of the step with Illinois' rule; whatever the margin does, its sign changes between two lengths
    that close up on each other. Source: Dowell & Jarratt, BIT 11 (1971) 168.

    Parameters
    ----------
    t, h : float64 [s]
        Start of the step and its length, taken in ``parts`` equal ones.
    before, after : float64
        Margin at its start, or any number below zero, and at its end.
    q_a, v_a, carried_a, balance_a
        What `keep` copied at its start, where the system has been told to remember.

    Returns
    -------
    length : float64 [s]
        Shortest one found with a positive margin; the state is the one at its end.
    """
    carried = memory[: carried_a.shape[0]]
    low, high, g_low, g_high, margin, here, side = 0.0, h, min(before, -WITHIN), after, after, h, 0
    for _ in range(TRIALS):
        if margin <= WITHIN or high - low <= SAME * h:
            break
        trial = high - g_high * (high - low) / (g_high - g_low)
        nearest = 1e-3 * (high - low)
        trial = min(max(trial, low + nearest), high - nearest)
        keep(q_a, v_a, carried_a, balance_a, q, v, carried, balance)
        system.remember(net, 1)
        if advance(step, system, net, t, trial, parts, q, v, memory, options, counts, balance) != DONE:
            here = -1.0
            break
        here, found = trial, system.margin(q, v, net)
        if found > 0.0:
            high, g_high, margin = trial, found, found
            g_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, g_low = trial, min(found, -WITHIN * WITHIN)
            g_high *= 0.5 if side == -1 else 1.0
            side = -1
    if here != high:
        keep(q_a, v_a, carried_a, balance_a, q, v, carried, balance)
        system.remember(net, 1)
        advance(step, system, net, t, high, parts, q, v, memory, options, counts, balance)
    return high


@njit(cache=True, error_model="numpy", nogil=True)
def fixed_steps(
    step, place, net, t0, t_end, origin, dt, stride, kept, q, v, memory, options, counts, balance, out_t, out_q, out_v,
    out_balance, out_seen, stop
):  # fmt: skip
    """March from t0 to t_end with step dt; steps end on multiples of dt after ``origin`` <= t0, and the last one on t_end.

    A step whose Newton iteration fails is taken in halves, quarters and so on. Every ``stride``-th state after ``origin``, the
    first and the last one are saved; ``kept`` is how many rows of ``memory`` a scheme carries from step to step; ``stop`` (1,)
    ends the march when another thread sets it. The march ends at an event, see `locate`.

    Returns
    -------
    status, saved, t, node : int64, int64, float64, int64
        How it ended, rows written, time reached, and the node where it went wrong (or -1).
    """
    system = system_at(place)
    begin(system, net, t0, q, v, memory, counts, balance)
    save(system, net, 0, t0, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
    saved, t = 1, t0
    n_steps = max(1, int(np.ceil((t_end - origin) / dt - SAME)))
    implicit, watched, margin = kept >= 0, system.margin(q, v, net) > NEVER, -1.0
    kept = abs(kept)  # an explicit scheme has to go back only from an event
    carried = memory[:kept]
    q_a, v_a, kept_a, balance_a = q.copy(), v.copy(), carried.copy(), balance.copy()
    for s in range(min(int(np.floor((t0 - origin) / dt + SAME)), n_steps - 1), n_steps):
        target = t_end if s == n_steps - 1 else origin + (s + 1) * dt
        h = target - t
        if not implicit:
            if watched:
                keep(q, v, carried, balance, q_a, v_a, kept_a, balance_a)
                system.remember(net, 0)
            step(system, net, t, h, q, v, memory, options, counts, balance)
            counts[STEPS] += 1
            if watched:
                before, margin = margin, system.margin(q, v, net)
                if margin > 0.0 and worst_node(q, v) < 0:
                    t += locate(
                        step, system, net, t, h, 1, before, margin, q_a, v_a, kept_a, balance_a, q, v, memory, options, counts,
                        balance
                    )  # fmt: skip
                    save(system, net, saved, t, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
                    return EVENT, saved + 1, t, -1
            t = target
        else:
            whole, done, part = h, 0.0, 1.0
            while done < 1.0:
                keep(q, v, carried, balance, q_a, v_a, kept_a, balance_a)
                if watched:
                    system.remember(net, 0)
                if step(system, net, t + done * whole, part * whole, q, v, memory, options, counts, balance) == DONE:
                    counts[STEPS] += 1
                    if watched:
                        before, margin = margin, system.margin(q, v, net)
                        if margin > 0.0:
                            t += done * whole
                            t += locate(
                                step, system, net, t, part * whole, 1, before, margin, q_a, v_a, kept_a, balance_a, q, v, memory,
                                options, counts, balance
                            )  # fmt: skip
                            save(system, net, saved, t, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
                            return EVENT, saved + 1, t, -1
                    done += part
                    if done % (2.0 * part) == 0.0:
                        part = min(2.0 * part, 1.0)
                    continue
                keep(q_a, v_a, kept_a, balance_a, q, v, carried, balance)
                counts[HALVINGS] += 1
                part *= 0.5
                if part < SMALLEST:
                    save(system, net, saved, t + done * whole, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
                    return UNCONVERGED, saved + 1, t + done * whole, -1
            t = target
        last = s == n_steps - 1 or stop[0] != 0
        if (s + 1) % stride == 0 or last or s % CHECK_EVERY == 0:
            node = worst_node(q, v)
            if node >= 0:
                return DIVERGED, saved, t, node
            if (s + 1) % stride == 0 or last:
                save(system, net, saved, t, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
                saved += 1
        if stop[0] != 0:
            return INTERRUPTED, saved, t, -1
    return DONE, saved, t, -1


@njit(cache=True, error_model="numpy")
def interpolate(theta, h, q_a, v_a, q_b, v_b, q, v):
    """Cubic Hermite polynomial of a step at t_a + theta h, and its derivative."""
    u = 1.0 - theta
    for i in range(q.shape[0]):
        for x in range(3):
            rise = q_b[i, x] - q_a[i, x]
            curve_a, curve_b = h * v_a[i, x] - rise, rise - h * v_b[i, x]
            q[i, x] = u * q_a[i, x] + theta * q_b[i, x] + theta * u * (u * curve_a + theta * curve_b)
            slope = rise + (1.0 - 2.0 * theta) * (u * curve_a + theta * curve_b) + theta * u * (curve_b - curve_a)
            v[i, x] = slope / h


@njit(cache=True, error_model="numpy", nogil=True)
def adaptive_steps(
    step, place, net, t0, t_end, dt, order, rtol, atol, kept, corners, q, v, memory, options, counts, balance, out_t, out_q,
    out_v, out_balance, out_seen, stop
):  # fmt: skip
    """March with steps chosen by step doubling: one step of h beside two of h/2, of which the two are kept.

    The error of the two is |q_2 - q_1|/(2^order - 1) by Richardson's estimate; a step is taken when its largest component
    over the moving nodes is at most atol + rtol max|q|, and the next is chosen by a PI controller (Gustafsson). Steps end on
    the corners of the prescribed motions and on t_end; the times in out_t are interpolated.

    The march ends at an event, see `locate`; its last row is the state there.

    Returns
    -------
    status, saved, t, node, error : int64, int64, float64, int64, float64
        As `fixed_steps`, and the sum of the accepted errors [m].
    """
    system = system_at(place)
    begin(system, net, t0, q, v, memory, counts, balance)
    save(system, net, 0, t0, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
    seen_a, seen_b = out_seen[0].copy(), out_seen[0].copy()
    saved, t, h, total, before = 1, t0, dt, 0.0, 1.0
    kept = abs(kept)  # an explicit scheme carries the force at the end of its last step
    carried = memory[:kept]
    q_a, v_a, kept_a, balance_a = q.copy(), v.copy(), carried.copy(), balance.copy()
    q_1, shown = q.copy(), balance.copy()
    corner, rejections, watched, margin, status = 0, 0, system.margin(q, v, net) > NEVER, -1.0, DONE
    while t < t_end:
        if stop[0] != 0:
            return INTERRUPTED, saved, t, -1, total
        while corner < corners.shape[0] and corners[corner] <= t + 1e-12 * (t_end - t0):
            corner += 1
        goal = min(corners[corner], t_end) if corner < corners.shape[0] else t_end
        full = h
        if t + h > goal - 1e-9 * h:
            h = goal - t
        elif t + 2.0 * h > goal:
            h = 0.5 * (goal - t)
        keep(q, v, carried, balance, q_a, v_a, kept_a, balance_a)
        if watched:
            system.remember(net, 0)
        error = np.inf
        if step(system, net, t, h, q, v, memory, options, counts, balance) == DONE:
            copy(q.ravel(), q_1.ravel())
            keep(q_a, v_a, kept_a, balance_a, q, v, carried, balance)
            if step(system, net, t, 0.5 * h, q, v, memory, options, counts, balance) == DONE:
                if step(system, net, t + 0.5 * h, 0.5 * h, q, v, memory, options, counts, balance) == DONE:
                    error, size = 0.0, 0.0
                    for i in range(system.n_free):
                        for x in range(3):
                            error = max(error, abs(q[i, x] - q_1[i, x]))
                            size = max(size, abs(q[i, x]))
                    error /= 2.0**order - 1.0
                    error = error / (atol + rtol * size) if worst_node(q, v) < 0 else np.inf
        if error <= 1.0:
            counts[STEPS] += 1
            total += error * (atol + rtol * np.max(np.abs(q)))
            end = goal if t + h >= goal - 1e-9 * h else t + h
            if watched:
                last, margin = margin, system.margin(q, v, net)
                if margin > 0.0:
                    status = EVENT
                    end = t + locate(
                        step, system, net, t, h, 2, last, margin, q_a, v_a, kept_a, balance_a, q, v, memory, options, counts,
                        balance
                    )  # fmt: skip
            copy(seen_b, seen_a)
            system.observe(q, v, net, seen_b)
            while saved < out_t.shape[0] and out_t[saved] <= end:
                theta = (out_t[saved] - t) / (end - t)
                for i in range(seen_a.shape[0]):
                    out_seen[saved, i] = (1.0 - theta) * seen_a[i] + theta * seen_b[i]
                interpolate(theta, end - t, q_a, v_a, q, v, out_q[saved], out_v[saved])
                copy(balance, shown)
                system.energy(out_t[saved], out_q[saved], out_v[saved], net, shown)
                copy(shown[:5], out_balance[saved])
                saved += 1
            t = end
            if status == EVENT:
                if out_t[saved - 1] < t:
                    save(system, net, saved, t, q, v, balance, out_t, out_q, out_v, out_balance, out_seen)
                    saved += 1
                return EVENT, saved, t, -1, total
            grow = 0.9 * max(error, 1e-8) ** (-0.7 / (order + 1.0)) * max(before, 1e-8) ** (0.4 / (order + 1.0))
            h = max(h * min(4.0, max(0.2, grow)), full if h < full and error < 0.5 else 0.0)
            before, rejections = error, 0
        else:
            counts[REJECTED] += 1
            rejections += 1
            keep(q_a, v_a, kept_a, balance_a, q, v, carried, balance)
            h *= 0.25 if error == np.inf else max(0.2, 0.9 * error ** (-1.0 / (order + 1.0)))
            if rejections > 40 or (error == np.inf and h < SMALLEST * dt):
                return UNCONVERGED, saved, t, -1, total
    return DONE, saved, t, -1, total


def fixed_march():
    """`fixed_steps`, compiled (or loaded from the cache) when it is first asked for."""
    f, i = types.float64, types.int64
    return _compiled(fixed_steps, (f, f, f, f, i, i))


def adaptive_march():
    """`adaptive_steps`, compiled (or loaded from the cache) when it is first asked for."""
    f, i = types.float64, types.int64
    return _compiled(adaptive_steps, (f, f, f, i, f, f, i, _f1))


def _compiled(march, own):
    state, out = (_f2, _f2, _f3, _f1, _i1, _f1), (_f1, _f3, _f3, _f2, _f2, _i1)
    return compiled(march, (types.FunctionType(STEP), types.int64, types.int64, *own, *state, *out))
