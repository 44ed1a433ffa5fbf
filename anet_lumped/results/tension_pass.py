"""Compiled: one pass over the tensions of saved states, for what the largest of them may lack; `tension_error` says what and why.

All arrays are at one address, so that the call costs little, and differences of tensions are taken before it: what is compiled
here is what NumPy would need many times as long for, recursions over the saved times r. They need an exponential only where the
time between two saved states changes.
"""

from typing import NamedTuple

import numpy as np
from numba import int64, types, void

from anet_lumped.compiled.jit import kernel
from integrators.addresses import view_at
from integrators.flat_view import flat, part

BETWEEN = 0.125  # of the second difference of a tension: what a parabola hides at most between its samples
MEET = 0.2  # of the sum of the tensions of vibrations: what they add to the largest tension, but no more than
OF_ONE = 0.5  # of the tension of one with all of their energy
STEADY = 0.7  # of a jump of the means of two tensions in a row: what sets off a vibration while a cable stays taut
LEAST = 0.25  # of a jump, that counts in any case
NEAREST, FARTHEST = 4, 7  # saved times before and after a jump, which neither it nor its own third differences reach
UNEVEN = 3  # last saved times, beside which there are not as many as before
ALONE = 20.0  # times the jumps beside it: one that is no wave
FORGOTTEN = 300.0  # exponent of decay between two saved times beyond which nothing is left
ALIKE = 1e-9  # of a time between two saved states, by which others differ that count as the same
# columns of the table of cables
FIRST, SEGMENTS, KIND = range(3)
DECAY, OF_JUMP, OF_SEGMENTS_JUMP, PER_UNRESOLVED = range(4)
# columns of the table of vibrations
RATE, WEIGHT = range(2)
# columns of `TensionRows.beside`
LARGEST, LOWEST = range(2)


class TensionRows(NamedTuple):
    """What the pass reads and writes.

    Parameters
    ----------
    t : (k,) float64 [s], saved times
    tension : (k, n_segments) float64 [N]
    second : (k + 2, n_segments) float64 [N], second differences of tensions, from a row before the first to a row after the last
    of_means : (UNEVEN, n_segments) float64 [N], jumps of the means of two tensions in a row at the last saved times
    taken : (k,) float64 [J], what the method took up to each saved time, not falling
    cables : (cables, 3) int64, first segment, number of segments and kind of each; -1 for a kind that has lost nothing
    shares : (cables, 4) float64, rate at which its lowest vibration fades [1/s], and the shares of a jump that count while that
        rings, and of a segment's; the inverse of the share of the lowest vibration that the steps do not resolve
    vibrations : (kinds, 2, modes) float64, rate at which the energy of each fades [1/s], and the square of its tension over the
        energy that the method took [N2/J]
    left : (2, modes) float64, scratch: what is left of each vibration, and the share that it keeps of it to the next saved time
    lost : (kinds, k) float64 [N], written: what vibrations that the method took add at most
    beside : (k, 2) float64 [N], scratch: the largest jump and the least tension of a cable at each saved time
    ringing : (n_segments,) float64 [N], scratch
    most : (n_segments,) float64 [N], written: the largest that the tension of each segment may be; 0 where it is never taut
    """

    t: np.ndarray
    tension: np.ndarray
    second: np.ndarray
    of_means: np.ndarray
    taken: np.ndarray
    cables: np.ndarray
    shares: np.ndarray
    vibrations: np.ndarray
    left: np.ndarray
    lost: np.ndarray
    beside: np.ndarray
    ringing: np.ndarray
    most: np.ndarray


_f1, _f2, _f3 = (types.Array(types.float64, n, "C") for n in (1, 2, 3))
_i2 = types.Array(types.int64, 2, "C")
_rows_at = view_at(types.NamedTuple((_f1, _f2, _f2, _f2, _f1, _i2, _f2, _f3, _f2, _f2, _f2, _f1, _f1), TensionRows))


@kernel(void(int64))
def look_at_tensions(address):  # type: ignore[no-untyped-def]  # its signature is above
    """Write `TensionRows.lost` and `TensionRows.most` of the rows at an address.

    With e(r) = exp(-rate (t[r] - t[r - 1])), what was taken fades as left(r) = (left(r - 1) + taken(r) - taken(r - 1)) e(r), and
    a jump rings on as ringing(r) = max(jump(r), ringing(r - 1) e(r)).
    """
    rows = _rows_at(address)
    t, lost, left, modes, beside, ringing = rows.t, rows.lost, rows.left, rows.vibrations, rows.beside, rows.ringing
    tension, second, of_means = flat(rows.tension), flat(rows.second), flat(rows.of_means)
    k, n, most = t.shape[0], rows.ringing.shape[0], rows.most
    for kind in range(lost.shape[0]):
        step_before = -1.0
        for r in range(1, k):
            step, new, together, total = t[r] - t[r - 1], rows.taken[r] - rows.taken[r - 1], 0.0, 0.0
            if abs(step - step_before) > ALIKE * step:
                step_before = step
                for i in range(left.shape[1]):
                    left[1, i] = np.exp(-min(modes[kind, RATE, i] * step, FORGOTTEN))
            for i in range(left.shape[1]):
                left[0, i] = (left[0, i] * (r > 1) + new * modes[kind, WEIGHT, i]) * left[1, i]
                together += np.sqrt(left[0, i])
                total += left[0, i]
            lost[kind, r] = min(MEET * together, OF_ONE * np.sqrt(total))
    for c in range(rows.cables.shape[0]):
        first, count, kind = rows.cables[c, FIRST], rows.cables[c, SEGMENTS], rows.cables[c, KIND]
        for r in range(k):
            i, largest, lowest = r * n + first, 0.0, np.inf
            T, B, C, D = part(tension, i, count), part(second, i, count), part(second, i + n, count), part(second, i + 2 * n, count)
            for s in range(count):
                largest, lowest = max(largest, max(abs(C[s] - B[s]), abs(D[s] - C[s]))), min(lowest, T[s])
            beside[r, LARGEST], beside[r, LOWEST] = largest, lowest
        step_before, keep, shares = -1.0, 1.0, rows.shares[c]
        for s in range(count):
            ringing[s] = 0.0
        for r in range(k):
            before, after, in_full = 0.0, 0.0, k <= NEAREST
            for x in range(NEAREST, FARTHEST + 1):
                if x <= r:
                    before = max(before, beside[r - x, LARGEST])
                if r + x < k:
                    after = max(after, beside[r + x, LARGEST])
            for x in range(-2, 3):
                if 0 <= r + x < k and not beside[r + x, LOWEST] > 0.0:
                    in_full = True
            if in_full or beside[r, LARGEST] >= ALONE * (before if r >= k - NEAREST else min(before, after)):
                steady = 1e300
            else:
                steady = STEADY
            if r > 0 and abs(t[r] - t[r - 1] - step_before) > ALIKE * step_before:
                step_before = t[r] - t[r - 1]
                keep = np.exp(-min(shares[DECAY] * step_before, FORGOTTEN))
            cap = lost[kind, r] if kind >= 0 else 0.0
            i, at_end = r * n + first, r >= k - UNEVEN
            T, M = part(tension, i, count), part(most, first, count)
            A, B, C = part(second, i - n if r > 0 else i, count), part(second, i, count), part(second, i + n, count)
            D, E = part(second, i + 2 * n, count), part(second, i + n if at_end else i + 3 * n, count)
            F = part(of_means, (r - k + UNEVEN) * n + first if at_end else first, count)
            for s in range(count):
                third, later = C[s] - B[s], D[s] - C[s]
                own = 0.5 * max(abs(third), abs(later))
                means = 0.25 * max(abs(C[s] - A[s]), max(abs(D[s] - B[s]), abs(E[s] - C[s])))
                means = F[s] if at_end else means
                jump = min(own, max(LEAST * own, steady * means))
                ring = max(jump, keep * ringing[s])
                ringing[s] = ring
                missing = max(BETWEEN * abs(C[s]), max(shares[OF_JUMP] * ring, shares[OF_SEGMENTS_JUMP] * jump))
                missing = max(missing, min(cap, ring * shares[PER_UNRESOLVED]))
                M[s] = max(M[s], T[s] + missing if T[s] > 0.0 else 0.0)
