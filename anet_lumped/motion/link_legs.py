"""Links that would have to push: when a run of `links` leaves a cable that cannot push to `edmc`, and when it takes it back.

A cable that cannot push has T >= 0 and l <= L on every segment, and T = 0 where l < L. As long as all tensions are positive, that
is what links do. Where one would turn negative the run goes on with `edmc` at EA = inf, which solves slack and taut together in
each step, and comes back when everything is straight and pulls. What is then left of the rates of lengths is taken out by impulses
without bounce; the energy that they take is told with the event.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from anet_lumped.checks import InputError, quoted
from anet_lumped.model.tables import AXIAL_PUSH_SHARE
from anet_lumped.results.events import BLOW, SLACK, TAUT

from .choice import FIRST_CHOSEN
from .link_catch import STRAIGHT, catch, first_jump

SLACK_METHOD = "edmc"
SHORTEST_SLACK = 8.0  # steps that it marches at least
SLACK_ALLOWED = 0.1  # of a run, in which cables may be slack for links to be chosen
JUST_BEFORE = 1e-12  # of a leg, by which it ends before velocities jump
REDUNDANT = (
    "The lengths of some segments follow from those of others, as in a cable that is straight between two points: of the tensions "
    "that are possible there, links take the smallest."
)


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
        self.span, self.since, self.jump = self.shortest, -np.inf, np.inf

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
        if not legs.runs:
            self._check_start(model, caught)
        if caught.pushed >= 0:
            where = model.scene.cables[model.cable_of[caught.pushed]]
            if not self.slack:
                self.span = 2.0 * self.span if legs.t - self.since < self.span else self.shortest
                legs.tell(SLACK, where.name, 0.0)
            else:
                self.span *= 2.0
            self.slack = True
            return self.without, begin, self._end(model.scene, legs.t, min(end, legs.t + self.span))
        if self.slack:
            legs.tell(TAUT, "", caught.lost)
            self.since = legs.t
        elif caught.struck:
            legs.tell(BLOW, "", caught.lost)
        self.slack = False
        legs.book(caught.work, caught.lost)
        if caught.redundant:
            self.warnings.add(REDUNDANT)
        return self.choice, type(begin)(caught.q, caught.v, caught.tension), self._end(model.scene, legs.t, end)

    def _end(self, scene, t, end):
        """End of a leg from t [s]: ``end``, or just before velocities jump, so that nothing in it knows of the jump."""
        self.jump = first_jump(scene, t, end)
        return (
            end
            if self.jump == end
            else self.jump - max(JUST_BEFORE * (self.jump - t), 8.0 * np.spacing(max(abs(t), abs(self.jump))))
        )

    def with_jump(self, run):
        """The leg's run, whose last state counts as that at the jump which it was to end before."""
        if run.ok and run.t[-1] < self.jump:
            run.t[-1] = self.jump
        return run

    def _check_start(self, model, caught):
        """Refuse a state at the start of a run from which links cannot go on."""
        pushes = model.axial[model.cable_of, AXIAL_PUSH_SHARE] > 0.0
        beyond, method = np.where(pushes, np.abs(caught.off), 0.0), self.choice.method
        cable_of = [model.scene.cables[c] for c in model.cable_of]
        if beyond.max(initial=0.0) > STRAIGHT:
            worst = int(beyond.argmax())
            off = caught.off[worst]
            raise InputError(
                f'Method "{method}" needs segments of their own length at the start, but one of cable '
                f"{quoted(cable_of[worst].name)}, which can push, is {abs(off):.2g} of its length too "
                f'{"long" if off > 0.0 else "short"}; start from a rest or take compression="none".'
            )
        if caught.blocked >= 0:
            raise InputError(
                f'Method "{method}" needs cables that can give way to what pushes them sideways, but cable '
                f"{quoted(cable_of[caught.blocked].name)} is as long as the distance between points that hold it, so that no "
                "tension is large enough; make it longer, or give EA to let it stretch."
            )

    def told(self, run):
        """The run, which is that of the method asked for, with what is to be said of it."""
        return replace(run, method=self.choice.method, reason=self.choice.reason, warnings=(*run.warnings, *sorted(self.warnings)))


def slack_time(run):
    """Time of a run of links in which a cable was slack [s]."""
    ends = [(event.t, event.kind) for event in run.events if event.kind in (SLACK, TAUT)] + [(float(run.t[-1]), TAUT)]
    return sum(b - a for (a, kind), (b, _) in pairwise(ends) if kind == SLACK)
