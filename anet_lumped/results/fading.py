"""Compiled: what is left of errors of places as the motion fades, and the way that lost energy takes; `error_estimate` says why."""

import numpy as np
from numba import int64, void

from anet_lumped.compiled.jit import internal, kernel
from integrators.flat_view import flat

from .energy_balance import BY_DAMPERS, BY_EFFECTS, BY_METHOD, ELASTIC, KINETIC, POTENTIAL, SWINGS, WORK
from .place_rows import (
    BASE,
    DRIVEN,
    FIRST,
    FLIGHT,
    FLYING,
    GROWTH,
    LEFT,
    LOST,
    MOTION,
    MOVED,
    MULTIPLIED,
    RATE,
    SECOND,
    THIRD,
    TIME,
    WAYS,
    WEIGHT,
    place_rows_at,
)

FORGOTTEN = 300.0  # exponent of decay over a run beyond which nothing of an error is left
LARGEST = 1e100  # [m] that an error may grow to: it stays a number, and is told as no more than the way of a node
ALIKE = 1e-9  # of a time between two saved states, by which others differ that count as the same


@internal
def largest_around(x, half, forward, backward, largest):  # type: ignore[no-untyped-def]
    """Largest of x (k,) in a window of ``half`` numbers before and after each, written to ``largest`` (k,); the others are scratch.

    Source: van Herk, A fast algorithm for local minimum and maximum filters on rectangular and octagonal kernels, Pattern
    Recognition Letters 13 (1992), 517-521.
    """
    k, window = x.shape[0], 2 * half + 1
    for begin in range(0, k, window):
        end = min(begin + window, k) - 1
        forward[begin], backward[end] = x[begin], x[end]
        for r in range(begin + 1, end + 1):
            forward[r] = max(forward[r - 1], x[r])
        for r in range(end - 1, begin - 1, -1):
            backward[r] = max(backward[r + 1], x[r])
    last = (k - 1) // window * window
    for r in range(k):
        a, b = r - half, min(r + half, k - 1)
        if a <= 0:
            largest[r] = forward[b]
        elif a > last:  # of the last window there is only a part
            largest[r] = backward[a]
        else:
            largest[r] = max(backward[a], forward[b])


@internal
def _way(q, r, n, x, y, z):  # type: ignore[no-untyped-def]
    """Longest way along an axis of a node from the first row to the row r, less that of a base."""
    a, b, c = 0.0, 0.0, 0.0
    for i in range(n):
        j = 3 * (r * n + i)
        a = max(a, abs(q[j] - q[3 * i] - x))
        b = max(b, abs(q[j + 1] - q[3 * i + 1] - y))
        c = max(c, abs(q[j + 2] - q[3 * i + 2] - z))
    return max(a, max(b, c))


@kernel(void(int64))
def fade_errors(address):  # type: ignore[no-untyped-def]  # its signature is above
    """Write what is left of errors, ways and the way of lost energy, rows of `PlaceRows.columns`.

    Of errors, x(r) = x(r - 1) exp(multiplied(r) - multiplied(r - 1) - d) + added (1 - exp(-d))/d, with the decay d = D/(E + E) of
    what dampers and effects took of the motion between two saved times. The energy that a method took of vibrations fades at their
    rate.
    """
    rows = place_rows_at(address)
    E, columns, numbers, growth, t = flat(rows.energy), rows.columns, rows.numbers, rows.columns[GROWTH], rows.columns[TIME]
    motion, left, lost, k = columns[FIRST], columns[LEFT], columns[LOST], columns.shape[1]
    half = max(1, k // SWINGS)
    n, driven, q = rows.of_nodes.shape[1], numbers[DRIVEN] > 0.0, flat(rows.q)
    largest_around(columns[MOTION], half, columns[SECOND], columns[THIRD], columns[FIRST])
    x = columns[FLIGHT, 0] + growth[0]
    left[0] = x
    for r in range(1, k):
        e = 7 * r
        taken = max(E[e + BY_DAMPERS] + E[e + BY_EFFECTS] - (E[e - 7 + BY_DAMPERS] + E[e - 7 + BY_EFFECTS]), 0.0)
        decay = min(taken / max(motion[r] + motion[r - 1], 1e-300), FORGOTTEN)
        added = columns[FLIGHT, r] + growth[r] - (columns[FLIGHT, r - 1] + growth[r - 1])
        if decay > 0.0:
            gone = -np.expm1(-decay)
            x, added = x * (1.0 - gone), added * gone / decay
        grown = columns[MULTIPLIED, r] - columns[MULTIPLIED, r - 1]
        x = min(x * np.exp(grown), LARGEST) + added if grown > 0.0 else x + added
        left[r] = left[r - 1] if x <= left[r - 1] else x
    in_play, lowest, highest, amplitude, kept, most, taken = 0.0, E[POTENTIAL], E[POTENTIAL], 0.0, 0.0, 0.0, 0.0
    step_before, keep = -1.0, 1.0
    for r in range(k):
        e = 7 * r
        work, method = E[e + WORK] - E[WORK], E[e + BY_METHOD] - E[BY_METHOD]
        dissipated = (E[e + BY_DAMPERS] - E[BY_DAMPERS]) + (E[e + BY_EFFECTS] - E[BY_EFFECTS]) + method
        held = (E[e + KINETIC] - E[KINETIC]) + (E[e + ELASTIC] - E[ELASTIC]) + (E[e + POTENTIAL] - E[POTENTIAL])
        lowest, highest = min(lowest, E[e + POTENTIAL]), max(highest, E[e + POTENTIAL])
        in_play = max(max(in_play, highest - lowest), max(E[e + KINETIC], E[e + ELASTIC]))
        in_play = max(in_play, max(abs(work), abs(dissipated)))
        off = max(method, 0.0) + max(-(held - work + dissipated), 0.0)
        share = min(off / max(in_play, 1e-300), 1.0) if off > 0.0 else 0.0
        columns[WAYS, r] = beside = _way(q, r, n, 0.0, 0.0, 0.0)
        if driven:
            beside = _way(q, r, n, columns[BASE, r], columns[BASE + 1, r], columns[BASE + 2, r])
        amplitude, share = max(amplitude, 0.5 * beside), max(share, columns[MOVED, r])
        way = share * (0.5 + 1.5 * max(share, numbers[FLYING])) * amplitude
        if numbers[WEIGHT] > 0.0:
            if r > 0 and abs(t[r] - t[r - 1] - step_before) > ALIKE * step_before:
                step_before = t[r] - t[r - 1]
                keep = np.exp(-min(numbers[RATE] * step_before, FORGOTTEN))
            now = max(taken, method)
            kept, taken = (kept + now - taken) * keep, now
            most = max(most, kept)
            way = min(way, most / numbers[WEIGHT])
        lost[r] = way
