"""The order in which the tensions of links are eliminated: along the cables first, then at the free points.

A link is a segment that does not stretch. The equations for the tensions join each link with those that share a moving node with
it. So the links of one cable form a chain. Links inside a cable, and those at a prescribed end of it, are eliminated along the
chain. What is left are the links at free points, the end links. All that meet at one point are joined with each other, and both end
links of a cable between two free points are joined by the chain between them. A rigid body counts as one point.
"""

import numpy as np

from anet_lumped.model.elimination_order import minimum_degree
from anet_lumped.model.net import Links
from anet_lumped.model.tables import (
    BODY_MEETING_COLUMNS,
    CABLE_END,
    CABLE_FIRST_SEGMENT,
    CABLE_SEGMENTS,
    CABLE_START,
    END_LINK_FIRST,
    END_LINK_LAST,
    END_LINKS_ENTRY,
    LINKED_BODY_COLUMNS,
    LINKS_COLUMNS,
)


def link_tables(model):
    """`Links` of a model.

    Parameters
    ----------
    model : Model

    Returns
    -------
    Links
    """
    body_of = _bodies_of(model.bodies)
    end_links, at_point, at_body = [], {}, {}
    for row in model.cable:
        first, count = row[CABLE_FIRST_SEGMENT], row[CABLE_SEGMENTS]
        for node, link, sign in ((row[CABLE_START], first, -1), (row[CABLE_END], first + count - 1, 1)):
            if node < model.n_free:
                if int(node) in body_of:
                    at, body = body_of[int(node)]
                    at_body.setdefault(body, []).append((int(link), sign, at))
                else:
                    at_point.setdefault(int(node), []).append((int(link), sign))
                if link not in end_links[-1:]:  # a cable of one link between two free points has one end link
                    end_links.append(int(link))
    meetings = [
        (node, a, b, sign_a * sign_b)
        for node, own in at_point.items()
        for i, (a, sign_a) in enumerate(own)
        for b, sign_b in own[:i]
    ]
    on_bodies = [
        (k, l, body, a, b, sign_a * sign_b)
        for body, own in at_body.items()
        for i, (a, sign_a, k) in enumerate(own)
        for b, sign_b, l in own[:i]
    ]
    chains = {
        (int(row[CABLE_FIRST_SEGMENT]), int(row[CABLE_FIRST_SEGMENT] + row[CABLE_SEGMENTS] - 1))
        for row in model.cable
        if row[CABLE_START] < model.n_free and row[CABLE_END] < model.n_free and row[CABLE_SEGMENTS] > 1
    }
    met_on_bodies = [(a, b) for _, _, _, a, b, _ in on_bodies if a != b]
    order, later = minimum_degree(end_links, [(a, b) for _, a, b, _ in meetings] + met_on_bodies + sorted(chains))
    rank = {link: i for i, link in enumerate(order)}
    ahead = [sorted(rank[link] for link in later[one]) for one in order]
    entry = {pair: k for k, pair in enumerate((p, q) for p, others in enumerate(ahead) for q in others)}

    def entry_of(a, b):  # of one link with both ends on one body, its own number
        return rank[a] if a == b else entry[min(rank[a], rank[b]), max(rank[a], rank[b])]

    unknown = np.full((len(model.cable), 3), -1, np.int64)  # columns in `tables`
    for c, row in enumerate(model.cable):
        first, last = row[CABLE_FIRST_SEGMENT], row[CABLE_FIRST_SEGMENT] + row[CABLE_SEGMENTS] - 1
        if row[CABLE_START] < model.n_free:
            unknown[c, END_LINK_FIRST] = rank[first]
        if row[CABLE_END] < model.n_free:
            unknown[c, END_LINK_LAST] = rank[last]
        if (first, last) in chains:
            unknown[c, END_LINKS_ENTRY] = entry_of(first, last)
    target = [[entry[i, j] for k, i in enumerate(others) for j in others[k + 1 :]] for others in ahead]
    segments = model.n_segments
    mobility = np.zeros(model.n)
    moving = np.flatnonzero(model.mass[: model.n_free] > 0.0)  # a point without a cable has no mass
    mobility[moving] = 1.0 / model.mass[moving]
    has_added_mass = any("inertia" in effect.kernels() for effect in model.forces)
    return Links(
        unknown=unknown,
        segment=np.array(order, np.int64),
        later_at=np.cumsum([0, *map(len, ahead)]).astype(np.int64),
        later=np.array([q for others in ahead for q in others], np.int64),
        target_at=np.cumsum([0, *map(len, target)]).astype(np.int64),
        target=np.array([e for own in target for e in own], np.int64),
        meeting=np.array([(node, a, b, sign, entry_of(a, b)) for node, a, b, sign in meetings], np.int64).reshape(-1, 5),
        body_meeting=np.array([(*pair, entry_of(pair[3], pair[4])) for pair in on_bodies], np.int64).reshape(
            -1, BODY_MEETING_COLUMNS
        ),
        mobility=mobility,
        matrix_mobility=np.zeros((model.n_free - (0 if has_added_mass else model.bodies.first), 3, 3)),
        vector=np.zeros((segments, 3)),
        diagonal=np.zeros(segments),
        pivot=np.zeros(segments),
        to_next=np.zeros(segments),
        to_start=np.zeros(segments),
        end_pivot=np.zeros(len(order)),
        entry=np.zeros(len(entry)),
        right_side=np.zeros(segments),
        tau=np.zeros(segments),
        acceleration=np.zeros((model.n, 3)),
        driven=np.zeros((3, model.n - model.n_driven, 3)),
        body=np.zeros((len(model.bodies.pivot), LINKED_BODY_COLUMNS)),
        body_pull=np.zeros((model.n_free - model.bodies.first, 3)),
        state=np.zeros(LINKS_COLUMNS),
    )


def _bodies_of(bodies):
    """Of each node that a body carries, its position in ``Bodies.node`` and the number of the body, by the node."""
    body = np.repeat(np.arange(len(bodies.pivot)), np.diff(bodies.node_at))
    return {int(node): (k, int(body[k])) for k, node in enumerate(bodies.node)}
