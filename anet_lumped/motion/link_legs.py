"""Links that would have to push: when a run of `links` leaves a cable that cannot push to `edmc`, and when it takes it back.

A cable that cannot push has T >= 0 and l <= L on every segment, and T = 0 where l < L. As long as all tensions are positive, that
is what links do. Where one would turn negative the run goes on with `edmc` at EA = inf, which solves slack and taut together in
each step, and comes back when everything is straight and pulls. What is then left of the rates of lengths is taken out by impulses
without bounce; the energy that they take is told with the event.
"""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import InputError, quoted
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.tables import AXIAL_PUSH_SHARE, LINKS_REDUNDANT
from anet_lumped.results.events import SLACK, TAUT

from .choice import FIRST_CHOSEN

SLACK_METHOD = "edmc"
SHORTEST_SLACK = 8.0  # steps that it marches at least
SLACK_ALLOWED = 0.1  # of a run, in which cables may be slack for links to be chosen
STRAIGHT = 1e-6  # of its length: a link that is nearer to it than that is straight
REDUNDANT = (
    "The lengths of some segments follow from those of others, as in a cable that is straight between two points: of the tensions "
    "that are possible there, links take the smallest."
)


class Caught(NamedTuple):
    """A state whose links have been given their lengths back, and how far it was from that.

    Parameters
    ----------
    q, v : (n, 3) float64 [m], [m/s]
    tension : (n_segments,) float64 [N]
    work : float [J], of driven nodes against the impulse
    lost : float [J], energy that the impulse took
    pushed : int, the segment that would be pushed most or that is the farthest from straight; -1 for none
    off : float, the largest (l - L)/L before, by its size
    redundant : bool, whether lengths follow from other lengths
    """

    q: np.ndarray
    v: np.ndarray
    tension: np.ndarray
    work: float
    lost: float
    pushed: int
    off: float
    redundant: bool


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
    L = net.axial[model.cable_of, 0]
    moves = model.ends.min(axis=1) < model.n_free
    off = np.where(moves, np.linalg.norm(np.diff(q[model.ends], axis=1)[:, 0], axis=1) / L - 1.0, 0.0)
    slack = model.axial[model.cable_of, AXIAL_PUSH_SHARE] == 0.0
    if np.abs(off).max(initial=0.0) > STRAIGHT:
        return Caught(q, v, np.zeros(len(L)), 0.0, 0.0, int(np.abs(off).argmax()), float(off[np.abs(off).argmax()]), False)
    before = 0.5 * float(net.mass[: model.n_free] @ (v[: model.n_free] ** 2).sum(axis=1))
    work = own.project(t, net.address, q, v)
    lost = before + work - 0.5 * float(net.mass[: model.n_free] @ (v[: model.n_free] ** 2).sum(axis=1))
    own.force(t, q, v, net.address, f, power)
    pushed = -1
    if own.margin(q, v, net.address) > 0.0 and slack.any():
        candidates = np.where(slack, net.tension, np.inf)
        pushed = int(candidates.argmin()) if candidates.min() < 0.0 else -1
    return Caught(q, v, net.tension.copy(), work, lost, pushed, 0.0, bool(net.links.state[LINKS_REDUNDANT] > 0.0))


class Handover:
    """Who marches the next leg of a run of `links`, and for how long at most.

    Parameters
    ----------
    choice : Choice, of a scheme that keeps lengths
    adaptive : bool, whether its steps are chosen by a tolerance
    """

    def __init__(self, choice, adaptive):
        self.choice, self.slack, self.warnings = choice, False, set()
        self.without = replace(choice, method=SLACK_METHOD, warnings=())
        self.shortest = SHORTEST_SLACK * choice.dt * (FIRST_CHOSEN if adaptive else 1.0)
        self.span, self.since = self.shortest, -np.inf

    def next_leg(self, legs, model, begin, end):
        """Method, start and latest end [s] of the leg that begins at the time that the legs have reached.

        Parameters
        ----------
        legs : what is called with events and energies, see `legs`
        model : Model of what is left of the scene
        begin : legs.Start
        end : float [s]

        Returns
        -------
        choice, begin, end
        """
        caught = catch(model, legs.t, begin.q, begin.v)
        if caught.off != 0.0 or caught.pushed >= 0:
            where = model.scene.cables[model.cable_of[caught.pushed]]
            if caught.off != 0.0 and where.compression == "linear":
                raise InputError(
                    f'Method "{self.choice.method}" needs segments of their own length at the start, but one of cable '
                    f"{quoted(where.name)}, which can push, is {abs(caught.off):.2g} of its length too "
                    f'{"long" if caught.off > 0.0 else "short"}; start from a rest or take compression="none".'
                )
            if not self.slack:
                self.span = 2.0 * self.span if legs.t - self.since < self.span else self.shortest
                legs.tell(SLACK, where.name, 0.0)
            else:
                self.span *= 2.0
            self.slack = True
            return self.without, begin, min(end, legs.t + self.span)
        if self.slack:
            legs.tell(TAUT, "", caught.lost)
            self.since = legs.t
        self.slack = False
        legs.book(caught.work, caught.lost)
        if caught.redundant:
            self.warnings.add(REDUNDANT)
        return self.choice, type(begin)(caught.q, caught.v, caught.tension), end

    def told(self, run):
        """The run, which is that of the method asked for, with what is to be said of it."""
        return replace(run, method=self.choice.method, reason=self.choice.reason, warnings=(*run.warnings, *sorted(self.warnings)))


def slack_time(run):
    """Time of a run of links in which a cable was slack [s]."""
    ends = [(event.t, event.kind) for event in run.events if event.kind in (SLACK, TAUT)] + [(float(run.t[-1]), TAUT)]
    return sum(b - a for (a, kind), (b, _) in pairwise(ends) if kind == SLACK)
