"""A state as links take it on: their lengths given back, their tensions, and what speaks against that links go on from there."""

from typing import NamedTuple

import numpy as np

from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model import rest_lengths
from anet_lumped.model.tables import (
    AXIAL_L0,
    AXIAL_L0_ACCELERATION,
    AXIAL_L0_RATE,
    AXIAL_PUSH_SHARE,
    LINKS_FORCE,
    LINKS_REDUNDANT,
)
from anet_lumped.scene.scene import Driven

STRAIGHT = 1e-6  # of its length: a link that is nearer to it than that is straight
BLOW = 1e-6  # of the kinetic energy, that of a blow which pushes cables that cannot push, from which on they are slack
BLOW_RATE = 1e-3  # of the largest velocity between two nodes: slower changes of lengths are those that steps leave
COMMON = 1e-3  # of the largest velocity: smaller ones between nodes that fly together are roundings
ROUNDED = 1e-12  # of the largest force times the length of a link: less energy of a blow is of roundings
AHEAD = 1.0  # [s], of which the present accelerations make the velocities that show whether a motion can begin
AT_REST = 1e-6  # of the largest force over the largest mass: smaller accelerations between nodes are roundings
UNSOLVABLE = 1e-3  # of what is wanted, what no tensions bring about


class Caught(NamedTuple):
    """A state whose links have been given their lengths back, and how far it was from that.

    Parameters
    ----------
    q, v : (n, 3) float64 [m], [m/s]
    tension : (n_segments,) float64 [N]
    work : float [J], of driven nodes against the impulse
    lost : float [J], energy that the impulse took
    off : (n_segments,) float64, (l - L)/L before
    pushed : int, the segment that would be pushed most, by a tension or by the impulse; where one is farther from its length than
        `STRAIGHT`, the farthest; -1 for none
    redundant : bool, whether lengths follow from other lengths
    blocked : int, a segment that no tension keeps at its length, as where a cable is straight between two held points and is pushed
        sideways; -1 for none
    struck : bool, whether velocities changed by more than by roundings and what steps leave of the rates of lengths
    """

    q: np.ndarray
    v: np.ndarray
    tension: np.ndarray
    work: float
    lost: float
    off: np.ndarray
    pushed: int = -1
    redundant: bool = False
    blocked: int = -1
    struck: bool = False


def catch(model, t, q, v):
    """Give the links of a state at t [s] their lengths back and find their tensions.

    Parameters
    ----------
    model : Model, whose cables do not stretch
    t : float [s]
    q, v : (n, 3) float64 [m], [m/s], not changed

    Returns
    -------
    Caught
    """
    from anet_lumped.mechanics.bindings import system  # compiled on first use

    net, own = fresh_net(model, newton=False, links=True), system(model, newton=False, links=True)
    q, v, f, power = q.copy(), v.copy(), np.zeros_like(q), np.zeros(3)
    own.prescribe(t, net.address, q, v)
    L = net.axial[model.cable_of, AXIAL_L0]
    moves = model.ends.min(axis=1) < model.n_free
    off = np.where(moves, np.linalg.norm(np.diff(q[model.ends], axis=1)[:, 0], axis=1) / L - 1.0, 0.0)
    slack = model.axial[model.cable_of, AXIAL_PUSH_SHARE] == 0.0
    untaken = Caught(q, v, np.zeros(len(L)), 0.0, 0.0, off)
    if np.abs(off).max(initial=0.0) > STRAIGHT:
        return untaken._replace(pushed=int(np.abs(off).argmax()))
    before, v_before = _kinetic_energy(net, v), v.copy()
    work = own.project(t, net.address, q, v)
    if np.isnan(work):  # lengths that follow from others and contradict them, in the digits that `STRAIGHT` leaves
        return untaken._replace(pushed=int(np.abs(off).argmax()))
    after, impulse, d = _kinetic_energy(net, v), net.links.tau.copy(), np.diff(q[model.ends], axis=1)[:, 0]
    rate = (np.diff(v_before[model.ends], axis=1)[:, 0] * d).sum(axis=1) - L * net.axial[model.cable_of, AXIAL_L0_RATE]
    own.force(t, q, v, net.address, f, power)
    energy = np.abs(np.where(slack & (impulse < 0.0), 0.5 * impulse * rate, 0.0))  # given or taken by a blow that pushes
    considerable = BLOW * max(before, after) + ROUNDED * net.links.state[LINKS_FORCE] * L.max(initial=0.0)
    if energy.max(initial=0.0) > considerable:
        return untaken._replace(pushed=int(energy.argmax()))
    lost = before + work - after
    pushed = -1
    if own.margin(q, v, net.address) > 0.0 and slack.any():
        candidates = np.where(slack, net.tension, np.inf)
        pushed = int(candidates.argmin()) if candidates.min() < 0.0 else -1
    tension, redundant = net.tension.copy(), bool(net.links.state[LINKS_REDUNDANT] > 0.0)
    a, heaviest = net.links.acceleration, float(net.mass[: model.n_free].max(initial=0.0))
    apart = np.abs(np.diff(a[model.ends], axis=1)).max(initial=0.0)
    moves_off = redundant and apart * heaviest > AT_REST * net.links.state[LINKS_FORCE]
    blocked = _blocked(model, t, q, v + AHEAD * a, own, net) if moves_off else -1
    return Caught(q, v, tension, work, lost, off, pushed, redundant, blocked, _kinetic_energy(net, v - v_before) > considerable)


def _blocked(model, t, q, v, own, net):
    """The segment that no tension keeps at its length with the velocities v, which are to come; -1 for none.

    Accelerations keep lengths if d . (a_b - a_a) = -|v_b - v_a|^2 + ... has a solution. Where the lengths of links follow from
    others it has none for velocities that keep lengths to first order alone.
    """
    q, v = q.copy(), v.copy()
    own.prescribe(t, net.address, q, v)
    if np.isnan(own.project(t, net.address, q, v)):
        return -1
    own.force(t, q, v, net.address, np.zeros_like(q), np.zeros(3))
    L, rate, change = net.axial[model.cable_of][:, [AXIAL_L0, AXIAL_L0_RATE, AXIAL_L0_ACCELERATION]].T
    d, dv, da = (np.diff(x[model.ends], axis=1)[:, 0] for x in (q, v, net.links.acceleration))
    wanted = rate**2 + L * change - (dv**2).sum(axis=1)
    off = np.where(model.ends.min(axis=1) < model.n_free, np.abs((d * da).sum(axis=1) - wanted), 0.0)
    return int(off.argmax()) if off.max() > UNSOLVABLE * np.abs(wanted).max() else -1


def _kinetic_energy(of, v):
    """Kinetic energy of the nodes of a net or of a model that move [J], without that of a fluid."""
    return 0.5 * float(of.mass[: of.n_free] @ (v[: of.n_free] ** 2).sum(axis=1))


def blow(model, t, q, v):
    """The impulse that a start needs at which velocities would change the lengths of cables that do not stretch.

    An implicit step would carry such velocities on, from one sign to the other at each step, with tensions as large as the step is
    short. Nothing is done where an impulse would have to push cables that cannot push.

    Returns
    -------
    Caught or None
    """
    if not model.n_segments or not all(cable.inextensible for cable in model.scene.cables):
        return None
    v = v.copy()
    for point in model.scene.all_points:
        if isinstance(point, Driven):
            v[model.node_of[point.name]] = point.path.at(t)[1]
    d, dv = (np.diff(x[model.ends], axis=1)[:, 0] for x in (q, v))
    rate = np.abs((d * dv).sum(axis=1)) / model.axial[model.cable_of, AXIAL_L0]
    moves = model.ends.min(axis=1) < model.n_free
    scale = max(np.abs(dv).max(), COMMON * np.abs(v).max())
    if rest_lengths.changes(model.scene) or not rate[moves].max(initial=0.0) > BLOW_RATE * scale:
        return None
    caught = catch(model, t, q, v)
    before, after = _kinetic_energy(model, v), _kinetic_energy(model, caught.v)
    small = abs(after - before) <= BLOW * max(before, after) and abs(caught.lost) <= BLOW * max(before, after)
    return caught if caught.pushed < 0 and caught.blocked < 0 and not small else None


def first_jump(scene, begin, end):
    """The first time after ``begin`` and before ``end`` [s] at which the velocity of a driven point or the rate of a length jumps.

    Returns
    -------
    float [s] : ``end`` if there is none
    """
    paths = [*scene.motions, *rest_lengths.paths(scene)]
    times = sorted({float(t) for path in paths for t in path.corners if begin < t < end})

    def jumps(path, t):
        before, after = path.at(np.nextafter(t, -np.inf))[1], path.at(t)[1]
        return not np.allclose(before, after, rtol=1e-9, atol=1e-12)

    return next((t for t in times if any(jumps(path, t) for path in paths)), end)
