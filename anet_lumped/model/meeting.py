"""Whether cables that do not stretch meet, where each two of their supports are near enough to each other.

A net whose cables keep their lengths L has a shape only if its free points have places x with

    |x_a - x_b| <= (1 + s) L   of every such cable

for an s of 0 or less. The least s is that of a convex problem, a second-order cone program, and so the only one there is. A body
counts as links between its attachments, which may come nearer to each other than they can in truth: where s is above 0 all the
same, no shape has the lengths.

Source: Boyd & Vandenberghe, Convex Optimization, 2004, section 4.4.2 (second-order cone programs).
"""

import numpy as np
from scipy.optimize import minimize

from anet_lumped.checks import quoted
from anet_lumped.model import rest_lengths

from .reach import across_bodies, held_places

MOST_POINTS = 60  # free ones, beyond which the search would take seconds
LEAST_STRETCH = 1e-8  # of a length: less is the search's own rounding
BINDING = 1e-6  # of a length: what the cables that keep s from being less have left at most


def too_far_to_meet(scene, t, driven=None):
    """Words for cables that do not stretch and meet nowhere at a time, or None where they do or that is not known.

    Parameters
    ----------
    scene : Scene
    t : float [s]
    driven : dict of str and (3,) [m], or None
        Where driven points are, in place of where their paths have them.

    Returns
    -------
    str or None
    """
    held, lengths = held_places(scene, t, driven=driven), rest_lengths.at_time(scene, t)
    cables = [cable for cable in scene.cables if cable.inextensible]
    links = [(cable.start, cable.end, lengths.get(cable.name, cable.length)) for cable in cables]
    links += [(a, b, apart) for a, b, _, apart in across_bodies(scene, {end for a, b, _ in links for end in (a, b)}) if a < b]
    free = sorted({end for a, b, _ in links for end in (a, b)} - held.keys())
    if not held or not 0 < len(free) <= MOST_POINTS:
        return None
    place = {name: k for k, name in enumerate([*free, *held])}
    starts, ends = ([place[link[k]] for link in links] for k in (0, 1))
    L, fixed = np.array([length for *_, length in links]), np.array(list(held.values()))

    def across(x):
        places = np.concatenate([x[:-1].reshape(-1, 3), fixed])
        return places[ends] - places[starts]

    def room(x):
        return (L * (1.0 + x[-1])) ** 2 - (across(x) ** 2).sum(axis=1)

    def slopes(x):
        rows, out = across(x), np.zeros((len(L), len(place) + 1, 3))
        every = np.arange(len(L))
        out[every, ends] -= 2.0 * rows
        out[every, starts] += 2.0 * rows
        flat = out[:, : len(free)].reshape(len(L), -1)
        return np.column_stack([flat, 2.0 * L**2 * (1.0 + x[-1])])

    x = np.concatenate([np.tile(fixed.mean(axis=0), len(free)), [0.0]])
    x[-1] = float((np.linalg.norm(across(x), axis=1) / L).max()) - 1.0
    last = np.eye(len(x))[-1]
    found = minimize(
        lambda x: x[-1],
        x,
        jac=lambda x: last,
        bounds=[(None, None)] * (len(x) - 1) + [(-1.0, None)],  # below it lengths grow again
        constraints={"type": "ineq", "fun": room, "jac": slopes},
        method="SLSQP",
        options={"ftol": 1e-13, "maxiter": 500},
    )
    stretch = np.linalg.norm(across(found.x), axis=1) / L - 1.0
    if not found.success or not stretch.max() >= LEAST_STRETCH:
        return None
    short = [k for k in np.flatnonzero(stretch > stretch.max() - BINDING) if k < len(cables)]
    names = ", ".join(quoted(cables[k].name) for k in short)
    worst = max(short, key=lambda k: L[k])
    return (
        f"Cables with EA=inf must be long enough to meet, but cables {names} are not at t={t:.4g} s: cable "
        f"{quoted(cables[worst].name)} is {L[worst]:.9g} m long, and lengthened alike they meet where it is "
        f"{L[worst] * (1.0 + stretch.max()):.9g} m; give EA to let it stretch."
    )
