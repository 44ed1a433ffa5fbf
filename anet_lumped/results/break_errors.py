"""What a break that comes too early or too late does to places from then on.

Where a segment breaks at a tension, a run finds the time within the step, but the places that make the tension are off by some e
there. If the segment gets longer at the rate u, it breaks e/u too early or too late. From then on every node is off by what it has
changed its velocity by since, times that: a weight that falls freely after 1 s of its own by 10 m/s times e/u.

Cuts are at times of their own, and off by nothing.
"""

from typing import Any

import numpy as np

from anet_lumped.scene.cable_cut import CableCut

from .events import BREAK, RELEASE


def break_errors(run: Any, left_out: np.ndarray) -> np.ndarray:
    """Largest error of a place up to each saved time that breaks at a tension have led to.

    Parameters
    ----------
    run : Run
    left_out : (k,) float64 [m], errors of places by what steps have left out

    Returns
    -------
    error : (k,) float64 [m]
    """
    errors, n_free = np.zeros(len(run.t)), run.model.n_free
    cuts = {(event.t, event.cable) for event in run.scene.events if isinstance(event, CableCut)}
    for event in run.events:
        row = int(np.searchsorted(run.t, event.t)) - 1  # the last one before it
        if row < 0 or event.tension is None or event.kind not in (BREAK, RELEASE) or (event.t, event.where) in cuts:
            continue
        a, b = _ends(run, event, row)
        along, apart = run.q[row, b] - run.q[row, a], run.v[row, b] - run.v[row, a]
        rate = abs(float(along @ apart)) / max(float(np.linalg.norm(along)), 1e-300)
        late = float(left_out[row]) / max(rate, 1e-300)
        changed = np.linalg.norm(run.v[row + 1 :, :n_free] - run.v[row, :n_free], axis=2).max(axis=1, initial=0.0)
        errors[row + 1 :] += np.minimum(late, run.t[row + 1 :] - run.t[0]) * np.maximum.accumulate(changed)
    return errors


def _ends(run: Any, event: Any, row: int) -> tuple[int, int]:
    """Nodes of the segment that broke, or whose tension made a point part."""
    if event.kind == BREAK:
        a, b = run.model.nodes(event.where)[[event.segment, event.segment + 1]]
        return int(a), int(b)
    found = []
    for cable in run.scene.cables:
        nodes, tension = run.model.nodes(cable.name), run.segment_tension[row][run.model.segments(cable.name)]
        found += [(tension[0], nodes[0], nodes[1])] if cable.start == event.where else []
        found += [(tension[-1], nodes[-2], nodes[-1])] if cable.end == event.where else []
    _, a, b = max(found)
    return int(a), int(b)
