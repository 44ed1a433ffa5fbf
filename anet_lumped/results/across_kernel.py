"""Compiled: small displacements across the motion of a net, carried along by the tensions of its saved states."""

import numpy as np
from numba import int64, void

from anet_lumped.compiled.jit import internal, kernel
from integrators.flat_view import flat

from .energy_balance import SWINGS
from .fading import largest_around
from .node_pass import SWAYS
from .place_rows import (
    ASIDE,
    FIRST,
    LENGTH,
    MASS,
    MOTION,
    MULTIPLIED,
    OFF,
    SECOND,
    SPEED,
    STIFFNESS,
    THIRD,
    TIME,
    TOGETHER,
    UNTIL,
    place_rows_at,
)

MOST_PARTS = 32  # of the time between two saved states; nodes too light for so many count as heavier
LARGEST = 1e100  # displacement at which all are scaled down


@internal
def _length(q, ends, s, row):  # type: ignore[no-untyped-def]
    """Length of a segment [m] of the places from a number on."""
    a, b, total = row + 3 * ends[s, 0], row + 3 * ends[s, 1], 0.0
    for x in range(3):
        total += (q[b + x] - q[a + x]) * (q[b + x] - q[a + x])
    return np.sqrt(total)


@internal
def carry_across(rows, logarithm):  # type: ignore[no-untyped-def]
    """Carry a displacement z across the motion along, and write the logarithm of its largest |z| at each saved time (k,).

        m_i d2z_i/dt2 = sum of (T/l) (z_j - z_i) over the segments between i and j .

    Between some saved times, ``numbers[TOGETHER]``, T/l is the same: the mean of the tensions there over the mean of the lengths at
    both ends. Leapfrog steps of h, with h^2 times the largest sum of T/(l m) at a node at most 1/2. No frequency^2 is more than
    twice that sum, and the limit of stability is h^2 frequency^2 = 4.

    Source: Hairer, Lubich & Wanner, Geometric Numerical Integration, 2006, I.1.4 (leapfrog) and I.5.2 (its limit).
    """
    tension, q, ends, mass = flat(rows.tension), flat(rows.q), rows.segments, rows.of_nodes[MASS]
    z, speed = rows.of_nodes[ASIDE], rows.of_nodes[SPEED]
    length, stiffness, scratch, t = rows.of_segments[LENGTH], rows.of_segments[STIFFNESS], rows.of_nodes[OFF], rows.columns[TIME]
    n, count, together, scaled, last = mass.shape[0], ends.shape[0], int64(rows.numbers[TOGETHER]), 0.0, 0
    for s in range(count):
        length[s] = _length(q, ends, s, 0)
    logarithm[0] = 0.0
    for r in range(0, logarithm.shape[0] - together, together):
        last, step = r + together, t[r + together] - t[r]
        for s in range(count):
            before, length[s] = length[s], _length(q, ends, s, 3 * n * last)
            sum_of_tensions = 0.5 * (tension[r * count + s] + tension[last * count + s])
            for x in range(r + 1, last):
                sum_of_tensions += tension[x * count + s]
            stiffness[s] = 2.0 * sum_of_tensions / (together * max(before + length[s], 1e-300))
        fastest, largest = 0.0, 0.0
        for i in range(n):
            scratch[i] = 0.0
        for s in range(count):
            scratch[ends[s, 0]] += abs(stiffness[s])
            scratch[ends[s, 1]] += abs(stiffness[s])
        for i in range(n):
            if mass[i] > 0.0:
                fastest = max(fastest, scratch[i] / mass[i])
        parts = min(np.ceil(step * np.sqrt(2.0 * fastest)) + 1.0, float(MOST_PARTS * together))
        h = step / parts
        for i in range(n):  # h/m of a node
            scratch[i] = h / max(mass[i], 2.0 * h * h * scratch[i]) if mass[i] > 0.0 else 0.0
        for _ in range(int64(parts)):
            for i in range(n):
                z[i] += h * speed[i]
            for s in range(count):
                a, b = ends[s, 0], ends[s, 1]
                f = stiffness[s] * (z[b] - z[a])
                speed[a] += scratch[a] * f
                speed[b] -= scratch[b] * f
        for i in range(n):
            largest = max(largest, abs(z[i]))
        for x in range(r + 1, last + 1):
            logarithm[x] = scaled + np.log(max(largest, 1e-300))
        if largest > LARGEST:
            scaled += np.log(largest)
            for i in range(n):
                z[i] /= largest
                speed[i] /= largest
    for x in range(last + 1, logarithm.shape[0]):
        logarithm[x] = logarithm[last]


@kernel(void(int64))
def multiply_errors(address):  # type: ignore[no-untyped-def]  # its signature is above
    """Write the logarithm of what the motion has multiplied errors by, a row of `PlaceRows.columns`.

    It is what the largest displacement across the motion of a part of the run has grown by since its least, beyond `SWAYS` times.
    """
    rows = place_rows_at(address)
    columns, k = rows.columns, int64(rows.numbers[UNTIL])
    size, largest, grown = columns[FIRST][:k], columns[MOTION][:k], columns[MULTIPLIED]
    carry_across(rows, size)
    largest_around(size, max(1, k // SWINGS), columns[SECOND], columns[THIRD], largest)
    least, most = largest[0], 0.0
    for r in range(grown.shape[0]):
        if r < k:
            least = min(least, largest[r])
            most = max(most, largest[r] - least - np.log(SWAYS))
        grown[r] = most
