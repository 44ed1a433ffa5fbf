"""Trails: walks over the segments of a net, of which the force at one time takes four at once.

A trail goes from segment to segment by the nodes that they share, whatever cables they belong to, and meets no segment twice. What
it knows of the node where one segment ends, it needs no second time where the next one begins: half of all positions, velocities
and forces are read and written. Four trails of about one length make a group, whose numbers are `lanes`; a trail that is shorter
than others of its group waits at its last node, as a segment without stiffness.
"""

import math

import numpy as np

from anet_lumped.compiled.lanes import WIDTH
from anet_lumped.model.net import Trails
from anet_lumped.model.tables import (
    AXIAL_DAMPER,
    AXIAL_L0,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    AXIAL_TWO_WAY_DAMPER,
    CABLE_CURVE,
    CABLE_CURVE_END,
)

FEWEST = 2 * WIDTH  # segments, below which trails gain nothing: two for each lane
LONGEST = 32  # segments of a trail; with longer ones more lanes wait
NO_CABLE = -1  # in place of a cable where a trail waits
WAITING = 1.0, 0.0, 0.0  # L0 [m], k [N/m], c [N s/m] there


def trail_tables(model):
    """`Trails` of the cables of a model that are taken one by one, and the cable of each number.

    Left to others are cables with a tension-strain curve, and those whose rest length changes or that creep.

    Returns
    -------
    trails : Trails, without numbers
    cable : (rows, 4) int64
        Cable of the segment that ends at each node of ``trails.position``, `NO_CABLE` for none.
    """
    laws, runs, nodes, cables, taken = [], [], [], [], set()
    for law, own in _alike(model).items():
        segments = [first + j for first, count in map(model.segment_run, own) for j in range(count)]
        if len(segments) < FEWEST:
            continue
        taken.update(own)
        for four in _fours(_trails(model.ends, segments), len(segments)):
            count = max(map(len, four))
            laws.append(law)
            runs.append((len(nodes), count - 1))
            lanes = [trail + [(trail[-1][0], None)] * (count - len(trail)) for trail in four]
            for row in zip(*lanes, strict=True):
                nodes.append([node for node, _ in row])
                cables.append([NO_CABLE if segment is None else model.cable_of[segment] for _, segment in row])
    rows = len(nodes)
    return Trails(
        law=np.array(laws, float).reshape(-1, 2),
        run=np.array(runs, np.int64).reshape(-1, 2),
        position=3 * np.array(nodes, np.int64).reshape(rows, WIDTH),
        number=np.zeros((rows, 3 * WIDTH)),
        other_cables=np.array([c for c in model.single_cables.tolist() if c not in taken], np.int64),
    ), np.array(cables, np.int64).reshape(rows, WIDTH)


def with_numbers(trails, cable, axial):
    """`Trails` with numbers of their own, those of ``axial`` of a `Net`; the first two arguments are from `trail_tables`."""
    of_cables = np.vstack([axial[:, [AXIAL_L0, AXIAL_STIFFNESS, AXIAL_DAMPER]], WAITING])  # the last row is that of `NO_CABLE`
    return trails._replace(number=np.ascontiguousarray(of_cables[cable].swapaxes(1, 2)).reshape(-1, 3 * WIDTH))


def _alike(model):
    """Cables that trails may go along, by their law: the share of the stiffness that pushes, and 1 for a two-way damper."""
    changing, alike = set(model.lengths.cable.tolist()), {}
    for c in [] if model.creeps else model.single_cables.tolist():
        if c not in changing and model.cable[c, CABLE_CURVE] == model.cable[c, CABLE_CURVE_END]:
            law = model.axial[c, AXIAL_PUSH_SHARE], model.axial[c, AXIAL_TWO_WAY_DAMPER]
            alike.setdefault(law, []).append(c)
    return alike


def _trails(ends, segments):
    """Trails over segments: lists of nodes, each with the segment that leads to it, None for the first."""
    at = {}
    for s in segments:
        for node in ends[s].tolist():
            at.setdefault(node, []).append(s)
    left, trails = set(segments), []
    for first in segments:
        if first not in left:
            continue
        node, s = int(ends[first, 0]), first
        trail = [(node, None)]
        while s is not None:
            left.remove(s)
            node = int(ends[s, 0] + ends[s, 1]) - node
            trail.append((node, s))
            s = next((other for other in at[node] if other in left), None)
        trails.append(trail)
    return trails


def _fours(trails, count):
    """Trails over ``count`` segments, cut into pieces of about one length, by fours."""
    groups = math.ceil(count / (WIDTH * LONGEST))
    longest, pieces = math.ceil(count / (WIDTH * groups)), []
    for trail in trails:
        for first in range(0, len(trail) - 1, longest):
            piece = trail[first : first + longest + 1]
            pieces.append([(piece[0][0], None), *piece[1:]])
    pieces.sort(key=len, reverse=True)
    pieces += [pieces[-1][:1]] * (-len(pieces) % WIDTH)
    return [pieces[i : i + WIDTH] for i in range(0, len(pieces), WIDTH)]
