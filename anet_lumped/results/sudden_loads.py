"""Loads that are put on at once: axial vibrations that they set off, and what the method took of those.

A cable that is let go unstretched, a payload that becomes heavier, a cable that has to hold what another one held: its tension is
T at first and would rest at J. It swings about J by dT = J - T instead, goes up to J + dT, and does so again at every later swing
of the motion, less what dampers take: exp(-zeta omega t) of the lowest axial vibration. All vibrations of a cable together hold

    E = sum of dT^2 L0/(2 EA) over its segments ,

the elastic energy of what is missing to their rest. An implicit method that has taken the energy E_m since then has left them

    sqrt(1 - E_m/E)

of their size. The rest of it is missing in the tensions of the run, where it has none that are larger.

A load that takes half of that vibration's period or longer to come, as that of a support which starts to move may do, is not put on
at once: where it acts, the tension has not come by dT/2 in the first quarter of the period.

J is the mean of a tension over a period of the lowest vibration, or over two saved states, which alternate where steps do not
resolve it. Tensions of a smooth motion change within a period, too: so the straight line through the means of two periods, as far
as it goes back, tells J where the load is put on, and J is no more than the first mean.

Source: an oscillator under a step of its load swings up to twice its static response, see Chopra, Dynamics of Structures, 4th ed.,
2012, section 4.3. So does a bar under its own weight: its modes are in phase again after half a period of the lowest, as the wave
comes back, see Graff, Wave Motion in Elastic Solids, 1975, section 2.3.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.results.energy_balance import BY_METHOD
from integrators import schemes

from .events import BREAK, PAYLOAD, RELEASE

LEAST = 1e-3  # of the largest tension: a change of less than that sets off nothing that is told
SAME = 1e-6  # of a step, by which times differ that are the same
AT_ONCE = 0.5  # of a change of tension, which a load has made in a quarter of a period if it took no longer than half of one
NEAREST = 0.5  # of the largest change of a cable's segments: one that has changed by more may be where the load acts
FORGOTTEN = 300.0  # exponent of decay over a run beyond which nothing is left


class _Put(NamedTuple):
    """A load that was put on at once.

    Parameters
    ----------
    before : int, the last saved state before that
    until : int, the first saved state at which another one was put on; the number of states if there is none
    """

    before: int
    until: int


def sudden_load_tension(run: Any, mode_of: Any) -> float:
    """Largest tension with the vibrations that loads have set off which were put on at once, as far as the method took them [N].

    Parameters
    ----------
    run : Run, of a method that books what it takes; of another one, 0
    mode_of : callable(Scene, Cable) -> Mode, the lowest axial vibration of a cable
    """
    if run.energy.shape[1] <= BY_METHOD or schemes.scheme(run.method).explicit:
        return 0.0
    return max((_with_vibrations(run, mode_of, put) for put in _times(run)), default=0.0)


def _times(run: Any) -> list[_Put]:
    """When loads may have been put on at once: at the start, and where something happened."""
    at = [event.t for event in run.events if event.kind in (PAYLOAD, BREAK, RELEASE)]
    rows = np.unique(np.maximum(np.searchsorted(run.t - SAME * run.dt, at) - 1, 0)).tolist()
    befores = rows if rows and rows[0] == 0 else [0, *rows]
    return [_Put(a, b) for a, b in zip(befores, [*(row + 1 for row in befores[1:]), len(run.t)], strict=True)]


def _with_vibrations(run: Any, mode_of: Any, put: _Put) -> float:
    """Largest tension until another load is put on, with what the method took of vibrations [N]."""
    T, t = run.segment_tension[put.before : put.until], run.t[put.before : put.until]
    taken = run.energy[put.before : put.until, BY_METHOD] - run.energy[put.before, BY_METHOD]
    if len(t) < 5 or taken.max() <= 0.0:
        return 0.0
    found, energy = [], 0.0
    for c, cable in enumerate(run.scene.cables):
        if cable.inextensible:
            continue
        first, count = run.model.segment_run(c)
        mode, own = mode_of(run.scene, cable), T[:, first : first + count]
        rows = min(max(2, round(2.0 * math.pi / mode.omega / (t[2] - t[1]))), (len(t) - 1) // 2)
        mean, later = own[1 : 1 + rows].mean(axis=0), own[1 + rows : 1 + 2 * rows].mean(axis=0)
        rest = np.minimum(1.5 * mean - 0.5 * later, mean)
        change = np.maximum(rest - np.maximum(own[0], 0.0), 0.0)
        if change.max() > LEAST * own.max() and _comes_at_once(own[: 1 + max(1, round(rows / 4))], change):
            energy += float((change**2).sum() * cable.L0 / (2.0 * cable.EA_fast))
            pushes = cable.compression == "linear"
            found.append((own, mode, rows, rest, change, len(own) if pushes else max(_first_loose(own, rows), 2)))
    if not found:
        return 0.0
    missing = 1.0 - np.sqrt(1.0 - np.minimum(np.maximum.accumulate(np.maximum(taken, 0.0)) / energy, 1.0))
    largest = 0.0
    for own, mode, rows, rest, change, until in found:
        since = t[: until - 1] - t[0]  # largest right after the saved state before: the first swing may be over at the next one
        left = mode.overshoot * np.exp(-np.minimum(mode.zeta * mode.omega * since, FORGOTTEN)) * missing[1:until]
        swings = change * left[:, None]
        swings[rows:] += own[1 + rows : until]
        swings[:rows] += np.minimum(own[1 : min(1 + rows, until)], rest)  # where the run shows the vibration itself
        largest = max(largest, float(swings.max()))
    return largest


def _first_loose(own: np.ndarray, rows: int) -> int:
    """First saved state from which a segment of a cable holds nothing for a period of ``rows`` states; their number if none does.

    What hangs loose vibrates no more. At the bottom of each swing about J, a tension that was none before is none again.
    """
    slack = own <= 0.0
    if not _in_a_row(np.any(slack, axis=1)[:, None], rows).any():  # in a fifth of the time that looking at each segment takes
        return len(own)
    loose = _in_a_row(slack, rows)[1:].any(axis=1)
    return 1 + int(loose.argmax()) if loose.any() else len(own)


def _in_a_row(found: np.ndarray, rows: int) -> np.ndarray:
    """Where something (k, n) was found so many times in a row from a row on, (k - rows + 1, n) bool."""
    counted = np.cumsum(np.vstack([np.zeros((1, found.shape[1]), int), found]), axis=0)
    return np.asarray(counted[rows:] - counted[:-rows] == rows)


def _comes_at_once(first: np.ndarray, change: np.ndarray) -> bool:
    """Whether a segment's tension has come by the better part of its change (segments,) [N] in a quarter of a period.

    ``first`` are tensions from before the load was put on until then, (rows, segments) [N]. One segment is enough: from where the
    load acts a wave runs to the others.
    """
    come = first[1:].max(axis=0) - first[0]
    return bool((come >= AT_ONCE * change)[change >= NEAREST * change.max()].any())
