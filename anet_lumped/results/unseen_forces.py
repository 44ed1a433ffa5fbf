"""Forces that come and go between the times at which steps take them: a blow by a law of one's own, a gust shorter than a step.

A step takes a force once, at its middle, and nothing that is seen at the ends of steps tells of a blow beside that. So effects say
in which times their forces may come and go however little moves (`Effect.sudden`), and these are looked at several times in each
step, with places and velocities as they are at the saved state before it. What the impulse of a node is off by,

    J = sum of h (mean of f - f in the middle) ,

is off its velocity by J/m, and its place by that times the time since then, but not beyond that in which it is turned back: a
cable with its ends as a whole in sqrt(L/g), a node between its neighbours in sqrt(m l/T). J is summed up with its direction: a
force that steps do resolve, or one that goes to and fro evenly, leaves next to nothing.
"""

import math
from typing import Any

import numpy as np
from numba import float64, int64, types, void

from anet_lumped.compiled.jit import kernel
from anet_lumped.effects.signatures import as_force
from anet_lumped.model.tables import SLOT_FORCE

LOOKS = 2**16  # numbers of nodes and segments looked at in a run, some 3 ms; or, if that is more,
LEAST_PARTS, MOST_PARTS = 3, 256  # looks in a step
RESOLVED = 8.0  # steps in the shortest time of a force, which see it as a look between them would

_f1, _f2, _f3 = (types.Array(float64, d, "C") for d in (1, 2, 3))


def unseen_forces(run: Any) -> np.ndarray:
    """Largest error of a place up to each saved time, by forces that came and went within steps.

    Parameters
    ----------
    run : Run, of fixed steps

    Returns
    -------
    error : (k,) float64 [m]
    """
    model, duration = run.model, float(run.t[-1] - run.t[0])
    h, n_free = duration / max(run.work.steps, 1), model.n_free
    impulse = np.zeros((len(run.t), n_free, 3))
    for e, effect in enumerate(model.forces):
        index, params = model.effects.numbers(e)
        for begin, end, shortest in effect.sudden:
            steps = max(min(end, run.t[-1]) - max(begin, run.t[0]), 0.0) / max(h, 1e-300)
            if steps == 0.0 or h * RESOLVED <= shortest:
                continue
            parts = int(min(max(LOOKS / (math.ceil(steps) * len(index)), LEAST_PARTS), MOST_PARTS))
            f = np.zeros((2, model.n, 3))
            add_unseen(
                model.effects.address[e, SLOT_FORCE], index, params, run.t, run.q, run.v, h, begin, end, parts, f[0], f[1], impulse
            )
    if not impulse.any():
        return np.zeros(len(run.t))
    return _ways(run, np.cumsum(impulse, axis=0), duration)


def _ways(run: Any, impulse: np.ndarray, duration: float) -> np.ndarray:
    """Largest way up to each saved time that an ``impulse`` (k, n_free, 3) [N s] so far leads to, (k,) [m]."""
    model, n_free = run.model, run.model.n_free
    mass, (a, b) = model.mass[:n_free], model.ends.T
    elapsed = run.t - run.t[max(int(impulse.any(axis=(1, 2)).argmax()) - 1, 0)]
    g, stiffness = float(np.linalg.norm(run.scene.gravity)), np.zeros(model.n)
    turns = math.sqrt(run.scene.longest / g) if g > 0.0 else duration
    pulls = np.maximum(run.segment_tension, 0.0).mean(axis=0) / np.linalg.norm(run.q[0, b] - run.q[0, a], axis=1).clip(1e-300)
    for ends in (a, b):
        np.add.at(stiffness, ends, pulls)
    alone = np.minimum(np.sqrt(mass / stiffness[:n_free].clip(1e-300)), turns)  # turns a node, which its neighbours hold
    ways = (np.linalg.norm(impulse, axis=2) / mass * np.minimum(elapsed[:, None], alone)).max(axis=1)
    for cable in run.scene.cables:
        nodes = model.nodes(cable.name)
        nodes = nodes[nodes < n_free]
        if len(nodes):
            speed = np.linalg.norm(impulse[:, nodes].sum(axis=1), axis=1) / mass[nodes].sum()
            ways = np.maximum(ways, speed * np.minimum(elapsed, turns))
    return np.maximum.accumulate(ways)


@kernel(
    void(int64, types.Array(int64, 1, "C"), _f1, _f1, _f3, _f3, float64, float64, float64, int64, _f2, _f2, _f3)
)  # fmt: skip
def add_unseen(address, index, params, t, q, v, h, begin, end, parts, f, middle, impulse):  # type: ignore[no-untyped-def]
    """Add what steps of h [s] leave out of the impulse of a force, in ``parts`` looks each, to the rows at whose times they end.

    Between the times ``begin`` and ``end`` [s]. ``f`` and ``middle`` (n, 3) are scratch; ``impulse`` (k, n_free, 3) [N s].
    """
    force, n_free = as_force(address), impulse.shape[1]
    for r in range(t.shape[0] - 1):
        if t[r + 1] <= begin or t[r] >= end:
            continue
        steps = max(1, round((t[r + 1] - t[r]) / h))
        step = (t[r + 1] - t[r]) / steps
        for s in range(steps):
            at = t[r] + s * step
            if at + step <= begin or at >= end:
                continue
            middle[:] = 0.0
            force(at + 0.5 * step, q[r], v[r], index, params, middle)
            for p in range(parts):
                f[:] = 0.0
                force(at + (p + 0.5) * step / parts, q[r], v[r], index, params, f)
                for i in range(n_free):
                    for x in range(3):
                        impulse[r + 1, i, x] += (f[i, x] - middle[i, x]) * step / parts
