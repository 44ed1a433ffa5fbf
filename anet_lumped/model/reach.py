"""Whether cables that do not stretch reach from where they are held to where they are held.

Between two held points the cables of a net that do not stretch, and the bodies that they end at, leave no more room than the
shortest way along them. That is enough for a chain. Three supports may be too far from a point that each of them could reach: then
no shape has the lengths of all cables. `overlong` finds it in that which has been found, `meeting` without a shape.
"""

import heapq
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import quoted
from anet_lumped.model import rest_lengths
from anet_lumped.scene.scene import Driven, Free

ROUNDED = 1e-9  # of a length, what rounding may leave too short
LOOKS = 200  # at where points are driven, over a run
BISECTIONS = 50
OVERLONG = 1e-7  # of a length that must not change: more than the flattest cable stretches that statics take for one
OFF_LENGTH = 1e-4  # of its length, a segment at the start of a run: more than what `edmc` leaves at coarse steps


class Shortfall(NamedTuple):
    """Cables that do not reach.

    Parameters
    ----------
    cables : tuple of str, the way along them
    bodies : tuple of str, that the way goes across
    length : float [m], of the way
    distance : float [m], between its ends
    ends : tuple of two str, the points there
    t : float [s]
    """

    cables: tuple
    bodies: tuple
    length: float
    distance: float
    ends: tuple
    t: float

    @property
    def words(self):
        """A sentence with both numbers."""
        names = ", ".join(quoted(name) for name in self.cables)
        one = len(self.cables) == 1
        across = f" and {', '.join(f'body {quoted(name)}' for name in self.bodies)} between them" if self.bodies else ""
        return (
            f"{'A cable' if one else 'Cables'} with EA=inf must be longer than the distance between {'its' if one else 'their'} "
            f"ends, but cable{'' if one else 's'} {names}{across} {'is' if one else 'are'} {self.length:.9g} m long, and points "
            f"{quoted(self.ends[0])} and {quoted(self.ends[1])} are {self.distance:.9g} m apart at "
            f"t={self.t:.4g} s; give EA to let it stretch."
        )


def shortfall(scene, t, free=None, straight=False, driven=None, without=()):
    """The cables of a scene that do not reach at a time, or None.

    Parameters
    ----------
    scene : Scene
    t : float [s]
    free : dict of str and (3,) [m], or None
        Where free points are, if they count as held.
    straight : bool
        Whether cables may be straight between held points.
    driven : dict of str and (3,) [m], or None
        Where driven points are, in place of where their paths have them.
    without : container of str
        Cables that are broken, which hold nothing together.

    Returns
    -------
    Shortfall or None
    """
    rigid = [cable for cable in scene.cables if cable.inextensible and cable.name not in without]
    if not rigid:
        return None
    lengths, at = rest_lengths.at_time(scene, t), held_places(scene, t, free, driven)
    ways = {}
    for cable in rigid:
        for here, there in ((cable.start, cable.end), (cable.end, cable.start)):
            ways.setdefault(here, []).append((there, (cable.name,), (), lengths.get(cable.name, cable.length), cable.segments))
    for here, there, body, apart in across_bodies(scene, ways.keys()) if free is None else ():
        ways[here].append((there, (), (body,), apart, 1))
    places = np.array(list(at.values()))
    for begin in at:
        farthest = float(np.abs(places - at[begin]).sum(axis=1).max())
        for end, (length, segments, names, bodies) in _shortest_ways(ways, begin, at, farthest).items():
            distance = float(np.linalg.norm(at[end] - at[begin]))
            least = 1.0 + ROUNDED if segments == 1 or free is not None or straight else 1.0 - 1e-12
            if distance > length * least:
                return Shortfall(names, bodies, length, distance, (begin, end), t)
    return None


def held_places(scene, t, free=None, driven=None):
    """Places (3,) [m] of the points that are held at a time, by name; ``free`` and ``driven`` as in `shortfall`."""
    at = {}
    for point in scene.all_points:
        if isinstance(point, Free):
            if free is not None:
                at[point.name] = free[point.name]
        elif driven is not None and point.name in driven:
            at[point.name] = driven[point.name]
        else:
            at[point.name] = np.asarray(point.path.at(t)[0] if isinstance(point, Driven) else point.at, float)
    return at


def across_bodies(scene, ends):
    """Every attachment, each other one of its body, the body's name and how far they are apart [m], of those in ``ends`` alone."""
    for body in scene.bodies:
        places = {f"{body.name}.{name}": np.asarray(place, float) for name, place in dict(body.attachments).items()}
        for here in places.keys() & ends:
            for there in places.keys() & ends - {here}:
                yield here, there, body.name, float(np.linalg.norm(places[there] - places[here]))


def _shortest_ways(ways, begin, held, longest):
    """Length, segments, cables and bodies of the shortest way from a held point to each other one, through free points alone.

    Ways above a length do not count.
    """
    found, queue = {}, [(0.0, begin, 0, (), ())]
    while queue:
        length, here, segments, names, bodies = heapq.heappop(queue)
        if here in found:
            continue
        if length > longest:
            break
        found[here] = length, segments, names, bodies
        if here == begin or here not in held:
            for there, name, across, more, count in ways.get(here, ()):
                if there not in found:
                    heapq.heappush(queue, (length + more, there, segments + count, names + name, bodies + across))
    return {name: way for name, way in found.items() if name in held and name != begin}


def first_shortfall(scene, t0, t_end):
    """The first time in a run at which cables do not reach any more, or None.

    Returns
    -------
    Shortfall or None
    """
    moves = any(isinstance(point, Driven) for point in scene.all_points) or bool(rest_lengths.changes(scene))
    if not moves or not any(cable.inextensible for cable in scene.cables):
        return None
    before = t0
    for t in np.linspace(t0, t_end, LOOKS)[1:]:
        found = shortfall(scene, float(t))
        if found is not None:
            for _ in range(BISECTIONS):
                middle = 0.5 * (before + found.t)
                earlier = shortfall(scene, middle)
                before, found = (middle, found) if earlier is None else (before, earlier)
            return found
        before = float(t)
    return None


def off_length(model, q, t, broken):
    """Words for the segment at the start of a run that is farthest from a length which must not change, or None.

    A segment that cannot push may be shorter than its length: then it is slack.

    Parameters
    ----------
    model : Model
    q : (n, 3) float64 [m]
    t : float [s]
    broken : dict of str and tuple of int, the segments of each cable that are broken, counted from its start

    Returns
    -------
    str or None
    """
    lengths, worst, found = rest_lengths.at_time(model.scene, t), OFF_LENGTH, None
    for cable in model.scene.cables:
        if not cable.inextensible:
            continue
        L, nodes = lengths.get(cable.name, cable.length) / cable.segments, model.nodes(cable.name)
        apart = np.linalg.norm(np.diff(q[nodes], axis=0), axis=1)
        off = np.where(np.minimum(nodes[1:], nodes[:-1]) < model.n_free, apart / L - 1.0, 0.0)
        off[list(broken.get(cable.name, ()))] = 0.0
        k = int(np.abs(off).argmax() if cable.compression == "linear" else off.argmax())
        if abs(off[k]) > worst and (off[k] > 0.0 or cable.compression == "linear"):
            worst, found = abs(off[k]), (cable.name, k, L, apart[k])
    if found is None:
        return None
    name, k, L, apart = found
    less = "" if apart > L else ' or take compression="none"'
    return (
        f"Segments of cables with EA=inf must have their length at the start, but segment {k} of cable {quoted(name)} is {L:.9g} m "
        f"long, and its nodes are {apart:.9g} m apart at t={t:.4g} s; start from a rest, give EA to let it stretch{less}."
    )


def overlong(model, q):
    """Words for the cable that does not stretch and is longest in a shape for its length, or None where all keep theirs.

    Parameters
    ----------
    model : Model
    q : (n, 3) float64 [m]

    Returns
    -------
    str or None
    """
    scene, worst, found = model.scene, OVERLONG, None
    lengths = rest_lengths.at_time(scene, 0.0)
    for cable in scene.cables:
        if not cable.inextensible:
            continue
        length = lengths.get(cable.name, cable.length)
        reached = float(np.linalg.norm(np.diff(q[model.nodes(cable.name)], axis=0), axis=1).sum())
        if reached > length * (1.0 + worst):
            worst, found = reached / length - 1.0, (cable.name, length, reached)
    if found is None:
        return None
    name, length, reached = found
    return (
        f"Cables with EA=inf must keep their lengths, but in no shape of this net all of them do: cable {quoted(name)} is "
        f"{length:.9g} m long, and {reached:.9g} m in the shape that comes nearest; give EA to let it stretch."
    )
