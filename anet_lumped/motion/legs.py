"""A run in legs, from one event to the next: each leg marches what is left of the scene, and all legs are joined to one Run.

Rows saved at the time of an event show the state before it. The energy balance is carried through the events: energy lost in one is
dissipated (what a fluid was given included), and the kinetic energy that a payload brings or takes with it is work. The potential
energy does not jump where a payload changes, so that the balance does not depend on the height that is called zero.
"""

from dataclasses import astuple, replace
from typing import NamedTuple

import numpy as np

from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.model.meeting import too_far_to_meet
from anet_lumped.model.reach import first_shortfall
from anet_lumped.model.remainder import Remainder, remainder
from anet_lumped.model.tables import CABLE_FIRST_SEGMENT, CABLE_SEGMENTS
from anet_lumped.results.energy_balance import BY_EFFECTS, POTENTIAL, WORK
from anet_lumped.results.events import BLOW, BREAK, PAYLOAD, RELEASE, Event, broken, released
from anet_lumped.results.peaks import largest_so_far
from anet_lumped.results.run import STATUS, RunInterrupt, Work
from anet_lumped.scene.payload_change import carried_from
from integrators import schemes
from integrators.system import BALANCE, DONE, ENERGIES, EVENT, SAME_TIME, UNCONVERGED

from .inner_states import inner_at_start, inner_of, shedding_at_start, split_inner
from .joint_blow import blow_at_joints
from .link_catch import blow
from .link_legs import Handover
from .times import Leg

NEARLY_TAUT = 10.0  # steps before cables would not reach any more, within which that is why no step converges


class Start(NamedTuple):
    """State that a leg starts from: q, v (n, 3) [m], [m/s] and the tension of every segment (n_segments,) [N]; all its own.

    And of `inner_states` (2, n_segments), None where no cable creeps, and (n, 4), None where no cable sheds vortices.
    """

    q: np.ndarray
    v: np.ndarray
    tension: np.ndarray
    crept: np.ndarray | None = None
    shedding: np.ndarray | None = None


class Settings(NamedTuple):
    """How a run is marched.

    Parameters
    ----------
    adaptive : bool, whether its steps are chosen by a tolerance
    tolerances : (rtol, atol), of the largest coordinate and [m]
    rho_inf : float or None, see `simulate`
    """

    adaptive: bool
    tolerances: tuple[float, float]
    rho_inf: float | None


def march_legs(march, scene, choice, start, t_end, save_every, settings):
    """March a scene from a State to t_end, through its events and the breaks of its cables.

    Parameters
    ----------
    march : callable(model, choice, leg, start, settings) -> Run
        Its last row is the state that it reached; its status is that of `EVENT` if a segment is to break there.
    scene : Scene
    choice : Choice
    start : State of the scene
    t_end : float [s]
    save_every : float or None [s]
    settings : Settings

    Returns
    -------
    Run
    """
    made = Legs(scene, start, Leg(start.t, t_end, start.t, t_end, save_every), None if settings.adaptive else choice.dt)
    due = sorted({t for t in scene.event_times if start.t <= t < t_end})
    overloaded = made.overloaded()
    if overloaded or due[:1] == [start.t]:
        made.add_row()
        made.give_way(overloaded)
    handover = Handover(choice, settings.adaptive) if schemes.scheme(choice.method).keeps_constraints else None
    while True:
        if due and due[0] == made.t:
            made.take_events(due.pop(0))
        end, own = due[0] if due else t_end, made.left
        short = first_shortfall(own.model.scene, made.t, end)
        leg = made.leg._replace(begin=made.t, end=end if short is None else short.t)
        if handover is None:
            made.take_blow()
        inner = made.crept_of(own), made.shedding_of(own)
        begin, taken = Start(made.q[own.node], made.v[own.node], made.tension[own.segment], *inner), choice
        if handover is not None:
            taken, begin, until = handover.next_leg(made, own.model, begin, leg.end)
            leg = leg._replace(end=until)
        try:
            run = march(own.model, taken, leg, begin, settings)
        except RunInterrupt as stopped:
            made.add(stopped.run)
            raise RunInterrupt(joined(made, handover)) from None
        made.add(run if handover is None else handover.with_jump(run))
        nearly_taut = short is not None and run.status == STATUS[UNCONVERGED] and short.t - made.t <= NEARLY_TAUT * run.dt
        if nearly_taut or (short is not None and run.ok and leg.end >= short.t):
            return _stopped(made, handover, short.words)
        if short is None and run.status == STATUS[UNCONVERGED]:
            words = too_far_to_meet(own.model.scene, min(made.t + NEARLY_TAUT * run.dt, end))
            if words is not None:
                return _stopped(made, handover, words)
        if run.status == STATUS[EVENT]:
            made.give_way(made.overloaded(at_least=1 if handover is None or handover.slack else 0))
        if made.t >= t_end or run.status not in (STATUS[DONE], STATUS[EVENT]):
            return joined(made, handover)


def _stopped(made, handover, why):
    """All legs so far as a Run that stopped where cables do not reach."""
    text = f"The run stopped at t={made.t:.4g} s. {why}"
    return replace(joined(made, handover), status=STATUS[UNCONVERGED], message=text)


def joined(made, handover):
    """All legs so far as one Run, by the method that was asked for."""
    return made.joined() if handover is None else handover.told(made.joined())


class _Rows(NamedTuple):
    """Rows that a leg has saved: what was left of the scene, times, places, velocities, energies and tensions of what was left.

    And what the steps had left out of places by then, and the largest tension of each cable of the whole scene so far, None if that
    is not known.
    """

    left: Remainder
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    energy: np.ndarray
    tension: np.ndarray
    error: np.ndarray | None
    largest: np.ndarray | None
    crept: np.ndarray | None
    shedding: np.ndarray | None


class Legs:
    """A run in the making: the state that it has reached, what is left of the scene, and the rows saved so far."""

    def __init__(self, scene, start, leg, dt):
        self.scene, self.model, self.leg, self.dt = scene, build(scene), leg, dt
        self.t, self.q, self.v, self.tension = start.t, start.q.copy(), start.v.copy(), start.segment_tension.copy()
        self.crept, self.shedding = inner_at_start(self.model, start), shedding_at_start(self.model, start)
        self.events, self.broken = list(start.events), broken(start.events)
        earlier = sorted((event for event in scene.payload_changes if event.t < start.t), key=lambda event: event.t)
        self.payloads = {}
        for change in earlier:
            self._carry(change)
        for cut in sorted((cut for cut in scene.cable_cuts if cut.t < start.t), key=lambda cut: cut.t):
            segment = cut.segment % scene.cable(cut.cable).segments
            if segment not in self.broken.get(cut.cable, ()):  # the start does not say so
                self.events.append(Event(cut.t, BREAK, cut.cable, 0.0, segment=segment, tension=0.0))
        for event in sorted(due_releases(scene, self.events, start.t), key=lambda event: event.t):
            self.events.append(Event(event.t, RELEASE, event.point, 0.0))
        self.broken = broken(self.events)
        self.runs, self.rows, self.carried, self.left_out = [], [], np.zeros(ENERGIES), 0.0
        self.peaks = np.zeros(len(scene.cables))
        self._reduce()

    def _carry(self, change):
        """Let a point carry what a `PayloadChange` says."""
        self.payloads[change.point] = self.payloads.get(change.point, {}) | carried_from(change)

    def _reduce(self):
        self.left = remainder(self.model, self.payloads, self.broken, released(self.events))
        for array in (self.q, self.v):
            self.left.follow(self.model, array)

    def add(self, run):
        """Add the rows that a leg has saved; its last state is where the next leg starts."""
        own, first, count, energy = self.left, 1 if self.rows else 0, len(run.t), run.energy + self.carried
        again = self.dt is not None and count > 1 and run.t[-1] - run.t[-2] <= SAME_TIME * self.dt
        if run.status in (STATUS[DONE], STATUS[EVENT]) and (again or not self.leg.saves(float(run.t[-1]), self.dt)):
            count -= 1
        new = slice(first, count)
        error = None if run.error_growth is None else self.left_out + run.error_growth
        saved = run.t[new], run.q[new], run.v[new], energy[new], run.segment_tension[new]
        inner, shed = inner_of(run), None if run.shedding is None else run.shedding[new]
        error_rows, largest = None if error is None else error[new], self._largest(run)
        largest = None if largest is None else largest[new]
        self.rows.append(_Rows(own, *saved, error_rows, largest, None if inner is None else inner[:, new], shed))
        self.left_out = 0.0 if error is None else float(error[-1])
        self.t = float(run.t[-1])
        self.q[own.node], self.v[own.node], self.tension[own.segment] = run.q[-1], run.v[-1], run.segment_tension[-1]
        for array in (self.q, self.v):
            own.follow(self.model, array)
        if self.crept is not None:
            self.crept[:, own.segment] = 0.0 if inner is None else inner[:, -1]  # what is left may not creep
        if self.shedding is not None:
            self.shedding[own.node] = 0.0 if run.shedding is None else run.shedding[-1]
        self.carried[WORK:] = energy[-1, WORK:]
        self.runs.append(run)

    def _largest(self, run):
        """Largest tension of each cable of the whole scene so far, at the rows of a leg (k, cables); None where it is not known."""
        if run.largest_tension is None:
            return None
        own = self.left
        cables = self.model.cable_of[own.segment[own.model.cable[:, CABLE_FIRST_SEGMENT]]]  # pieces of one cable count as that
        largest = np.tile(self.peaks, (len(run.t), 1))
        np.maximum.at(largest, (slice(None), cables), run.largest_tension)
        self.peaks = largest[-1]
        return largest

    def add_row(self):
        """Save the current state."""
        own = self.left
        row = self.t, self.q[own.node], self.v[own.node], self.energies(), self.tension[own.segment]
        crept, shed = self.crept_of(own), self.shedding_of(own)
        saved, shed = (np.array([part]) for part in row), None if shed is None else shed[None]
        self.rows.append(
            _Rows(own, *saved, np.array([self.left_out]), self.peaks[None], None if crept is None else crept[:, None], shed)
        )

    def crept_of(self, own):
        """`inner_states` of the segments of what is left, (2, n_segments); None where no cable creeps."""
        return self.crept[:, own.segment] if own.model.creeps else None

    def shedding_of(self, own):
        """`inner_states` of the nodes of what is left, (n, 4); None where no cable sheds vortices."""
        return self.shedding[own.node] if own.model.sheds else None

    def energies(self):
        """Kinetic, elastic and potential energy now, work and what was taken so far, (7,) [J]."""
        from anet_lumped.mechanics.bindings import system  # compiled on first use

        own, energy = self.left, np.zeros(BALANCE)
        net = fresh_net(own.model, force=False, newton=False, observed=True, crept=self.crept_of(own))
        row = np.empty(own.model.n_segments)
        bound = system(own.model, force=False, newton=False)
        bound.observe(self.t, self.q[own.node], self.v[own.node], net.address, row, energy)
        return energy[:ENERGIES] + self.carried

    def take_blow(self):
        """Give the velocities the impulse that joints of bodies need, or cables which do not stretch, see `link_catch.blow`."""
        own = self.left
        if len(own.model.bodies.joint):
            struck = blow_at_joints(own.model, self.t, self.q[own.node], self.v[own.node])
            if struck is not None:
                self.v[own.node] = struck[0]
                self.book(*struck[1:])
            return
        caught = blow(own.model, self.t, self.q[own.node], self.v[own.node])
        if caught is not None:
            self.v[own.node] = caught.v
            self.book(caught.work, caught.lost)
            self.tell(BLOW, "", caught.lost)

    def tell(self, kind, where, lost):
        """Tell an event of cables that do not stretch: they went slack, were taut again, or made velocities jump."""
        self.events.append(Event(self.t, kind, where, lost))

    def book(self, work, lost):
        """Add the work [J] of an impulse, and the energy that it took, to the account."""
        self.carried[WORK] += work
        self.carried[BY_EFFECTS] += lost

    def take_events(self, t):
        """Change the payloads and cut the cables whose events are at t."""
        self.change_payloads(t)
        cuts = [(cut, cut.segment % self.scene.cable(cut.cable).segments) for cut in self.scene.cable_cuts if cut.t == t]
        whole = [(cut.cable, segment) for cut, segment in cuts if segment not in self.broken.get(cut.cable, ())]
        segments = np.arange(self.model.n_segments)
        self.break_segments([int(segments[self.model.segments(cable)][segment]) for cable, segment in whole])
        for event in self.scene.releases:
            if event.t == t and event.point in self.left.held:
                self.release(event.point)

    def change_payloads(self, t):
        """Change the payloads whose events are at t, all together: what is left is cut once for them."""
        changes = [event for event in self.scene.payload_changes if event.t == t]
        if not changes:
            return
        known = [self.payloads.get(c.point, {}).get("mass", self.scene.point(c.point).mass) for c in changes]
        more = [change.mass - mass for change, mass in zip(changes, known, strict=True)]
        weighs = any(change.volume is not None for change in changes) or max(more) > 0.0  # if not, no velocity changes
        potential, before = self.energies()[POTENTIAL], self._inertias() if weighs else None
        for change in changes:
            self._carry(change)
        self._reduce()
        after = self._inertias() if weighs else None
        self.carried[POTENTIAL] += potential - self.energies()[POTENTIAL]
        for change, gained in zip(changes, more, strict=True):
            node = self.model.node_of[change.point]
            V, body, lost = self.v[node].copy(), np.array(change.velocity), 0.0
            if before is not None and after is not None and (gained > 0.0 or change.volume is not None):
                M, carried = before(node)
                more_fluid = 0.0 if change.volume is None else float((after(node)[1] - carried)[0, 0])  # that of a sphere
                if gained > 0.0 or more_fluid > 0.0:
                    kept, new, new_fluid = M + min(gained, 0.0), max(gained, 0.0), max(more_fluid, 0.0)
                    carried = carried + min(more_fluid, 0.0) * np.eye(3)
                    joint = np.linalg.solve(
                        (kept + new) * np.eye(3) + (carried + new_fluid * np.eye(3)),
                        (kept * np.eye(3) + carried) @ V + (new + new_fluid) * body,
                    )
                    lost = 0.5 * float(kept * (V @ V) + new * (body @ body) - (kept + new) * (joint @ joint))
                    self.v[node] = joint
            brought = body if gained > 0.0 else V
            self.carried[WORK] += 0.5 * gained * float(brought @ brought)
            self.carried[BY_EFFECTS] += lost
            self.events.append(Event(self.t, PAYLOAD, change.point, lost, **carried_from(change)))

    def _inertias(self):
        """Function of a moving node of the whole scene's model: its mass now [kg], and what it carries of a fluid, (3, 3) [kg]."""
        model, own = self.left.model, self.left.node
        added = np.zeros((model.n_free, 3, 3))
        for effect in model.scene.effects:
            if "inertia" in effect.kernels():
                index, params = (np.asarray(x, kind) for x, kind in zip(effect.table(model), (np.int64, float), strict=True))
                effect.kernels()["inertia"](self.t, self.q[own], index, params, added)

        def of_node(node):
            at = int(np.flatnonzero(own == node)[0])
            return float(model.mass[at]), added[at]

        return of_node

    def overloaded(self, at_least=0):
        """Segments that must fail: of each cable left the one farthest beyond its strength, if any is.

        The ``at_least`` segments that are nearest to failing, or farthest beyond, are among them in any case.

        Returns
        -------
        segments : list of int, of the whole scene's model
        """
        model, strength = self.left.model, self.left.model.breaking_tension
        if len(strength) == 0:
            return []
        over = self.tension[self.left.segment] / strength - 1.0
        worst = [first + int(np.argmax(over[first : first + count])) for first, count in model.cable[:, : CABLE_SEGMENTS + 1]]
        worst.sort(key=lambda s: -over[s])
        return [int(self.left.segment[s]) for k, s in enumerate(worst) if over[s] > 0.0 or k < at_least]

    def break_segments(self, segments):
        """Let segments fail: their masses stay with their nodes, the energy that they hold is lost."""
        for segment in segments:
            cable = self.scene.cables[self.model.cable_of[segment]]
            number = int(np.flatnonzero(np.arange(self.model.n_segments)[self.model.segments(cable.name)] == segment)[0])
            before = self.energies()
            self.broken[cable.name] = tuple(sorted((*self.broken.get(cable.name, ()), number)))
            self._reduce()
            lost = float(np.sum((before - self.energies())[: POTENTIAL + 1]))
            self.carried[BY_EFFECTS] += lost
            tension = float(self.tension[segment])
            self.tension[segment] = 0.0
            if self.crept is not None:
                self.crept[:, segment] = 0.0
            self.events.append(Event(self.t, BREAK, cable.name, lost, segment=number, tension=tension))

    def give_way(self, segments):
        """Let what is overloaded fail: a segment, or what holds the point at its end, if that takes no more than the segment."""
        holds = {event.point: event.tension for event in self.scene.releases if event.point in self.left.held and event.tension}
        for segment in segments:
            cable = self.scene.cables[self.model.cable_of[segment]]
            own = np.arange(self.model.n_segments)[self.model.segments(cable.name)]
            ends = [name for name, at in ((cable.start, 0), (cable.end, -1)) if own[at] == segment and name in holds]
            weakest = min(ends, key=lambda name: holds[name], default=None)
            if weakest is None or holds[weakest] > (cable.breaking_tension or np.inf):
                self.break_segments([segment])
            elif weakest in self.left.held:  # else another cable has parted it
                self.release(weakest, float(self.tension[segment]))

    def release(self, point, tension=None):
        """Let a point go that another one held: it keeps its velocity, and what was not in the account is from now on."""
        before = self.energies()
        self.events.append(Event(self.t, RELEASE, point, 0.0, tension=tension))
        self._reduce()
        change = self.energies() - before
        self.carried[POTENTIAL] -= change[POTENTIAL]
        self.carried[WORK] += change[0]  # what drives a holder has given it

    def _adds_nothing_to(self, run):
        """Whether the rows and the energies of a leg are those of the whole run."""
        whole = len(self.rows[0].t) == len(run.t) and not self.carried[:WORK].any()
        return whole and bool((self.carried[WORK:] == run.energy[-1, WORK:]).all())

    def joined(self):
        """All legs as one Run."""
        last = self.runs[-1]
        if len(self.rows) == 1 and not self.events and last.model is self.model and self._adds_nothing_to(last):
            return last
        t = np.concatenate([leg.t for leg in self.rows])
        q, v = np.empty((2, len(t), self.model.n, 3))
        tension, begin = np.zeros((len(t), self.model.n_segments)), 0
        inner = None if self.crept is None else np.zeros((2, *tension.shape))
        shedding = None if self.shedding is None else np.zeros((len(t), *self.shedding.shape))
        for leg in self.rows:
            rows = slice(begin, begin + len(leg.t))
            q[rows, leg.left.node], v[rows, leg.left.node], tension[rows, leg.left.segment] = leg.q, leg.v, leg.tension
            for array in (q, v):
                leg.left.follow(self.model, array[rows])
            if leg.crept is not None:
                inner[:, rows, leg.left.segment] = leg.crept
            if leg.shedding is not None:
                shedding[rows, leg.left.node] = leg.shedding
            begin = rows.stop
        return replace(
            last,
            model=self.model, t=t, q=q, v=v, segment_tension=tension, **split_inner(self.model, inner), shedding=shedding,
            energy=np.concatenate([leg.energy for leg in self.rows]),
            status=STATUS[DONE] if last.status == STATUS[EVENT] else last.status,
            work=Work(*np.sum([astuple(run.work) for run in self.runs], axis=0).tolist()),
            error_growth=None if any(leg.error is None for leg in self.rows) else np.concatenate([leg.error for leg in self.rows]),
            wall_time=sum(run.wall_time for run in self.runs),
            warnings=tuple(dict.fromkeys(text for run in self.runs for text in run.warnings)),
            events=tuple(self.events), largest_tension=self._all_largest(tension),
        )  # fmt: skip

    def _all_largest(self, tension):
        """Largest tension of each cable so far at all rows, whose tensions are given; None if no leg has looked between rows."""
        if all(run.largest_tension is None for run in self.runs):
            return None
        seen = [np.zeros((len(leg.t), len(self.peaks))) if leg.largest is None else leg.largest for leg in self.rows]
        return largest_so_far(self.model, tension, np.concatenate(seen))


def due_releases(scene, events, t):
    """The releases of a scene at times before t [s] of which events do not tell."""
    told = released(events)
    return [event for event in scene.releases if event.t is not None and event.t < t and event.point not in told]
