"""A scene marched from outside, step by step: under a controller, or coupled to another simulator."""

import math
import warnings
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, number, shown
from anet_lumped.effects.push import Push
from anet_lumped.model import rest_lengths
from anet_lumped.model.body_rotation import quaternions
from anet_lumped.model.build import build
from anet_lumped.model.remainder import lightest
from anet_lumped.model.tables import AXIAL_TWO_WAY_DAMPER, SEGMENT_DIRECTION
from anet_lumped.results.energy_balance import BY_EFFECTS, WORK, book_remainder
from anet_lumped.results.events import Event
from anet_lumped.results.run import STATUS, Work
from anet_lumped.results.state import State
from anet_lumped.scene.origin import near_origin
from anet_lumped.scene.scene import Scene, check_scene
from anet_lumped.statics.starts import Start
from integrators import schemes
from integrators.compile_once import compile_for
from integrators.marching import held_march
from integrators.schemes.record import Origin
from integrators.states import scratch_for
from integrators.system import BALANCE, COUNTS, DONE, ENERGIES, EVENT, SAME_TIME, STEP, StepState, entry_point, first_class
from integrators.system import words_in_memory as system_words

from .body_readings import Motions, body_table
from .cable_ends import CableEnds, check_tied_there
from .choice import check_method, choose
from .failure_messages import why_it_stopped
from .given_forces import GivenForces
from .given_motions import GivenMotions
from .inner_states import inner_of_net, shedding_of_net, split_inner
from .legs import Legs
from .own_methods import net_and_system
from .plan import check_lengths
from .readings import Sight, compiled_see, readings_of, sight_of, words_in_memory
from .session_mark import Mark, SessionError, arrays_of_legs, check_mark, own_arrays
from .session_start import start_near
from .simulate import StabilityWarning
from .stability import transverse_frequency
from .times import Leg

NOTHING = (0.0, 0.0, 0.0)


class Session:
    """A scene marched from outside in steps of equal length.

    Positions and velocities given are those at the end of the step, forces given act throughout it, tensions returned are those
    that acted in it.

    Parameters
    ----------
    scene : Scene
        Points that are driven from outside are `Driven` with a path `paths.external`, bodies have it as `path` and, if they are
        to be turned, as `turning`; other paths move their points as ever.
    dt : float [s]
    method : str or None
        A method of this package with fixed steps; None picks one, as `simulate` does with a step.
    start : "equilibrium", "calm", "straight", State or dict
        As `simulate` takes it.
    rho_inf : float or None
        As `simulate` takes it.

    Raises
    ------
    InputError : an argument out of its range

    Notes
    -----
    Without `drive` and `push`, the states are those of ``simulate(scene, t_end, method=method, dt=dt)``, bit for bit. A session is
    used by one thread at a time; several sessions do not disturb each other.
    """

    def __init__(
        self, scene: Scene, dt: float, *, method: str | None = None, start: Start = "equilibrium", rho_inf: float | None = None
    ) -> None:
        check_scene(scene)
        if not 0 < number(dt) < math.inf:
            raise InputError(f"Argument `dt` must be positive and finite [s], but it is {shown(dt)}.")
        check_method(method, rho_inf)
        if method is not None and schemes.scheme(method).origin is not Origin.OWN:
            raise InputError(f"A session needs a method of this package, but the method is {method}.")
        self.scene, self.dt, self.model = scene, number(dt), build(scene)
        near = near_origin(scene)
        self._origin = np.array(near.origin, float)
        pushed = replace(near.scene, effects=(*near.scene.effects, Push()))
        begin = start_near(near, start)
        check_lengths(near.scene, begin)
        choice = choose(lightest(near.scene), method, self.dt, False, begin.least_tension, transverse_frequency(begin))
        self.method, self.reason, self._choice = choice.method, choice.reason, choice
        self._scheme = schemes.scheme(choice.method)
        for text in choice.warnings:
            warnings.warn(text, StabilityWarning, stacklevel=2)
        if self._scheme.keeps_constraints and any(cable.compression != "linear" for cable in scene.cables):
            raise InputError(f'Links in a session need cables with compression="linear", but the method is {self.method}.')
        self._parameters = self._scheme.parameters(rho_inf=rho_inf)
        self._begin, self._step_to = map(entry_point, held_march.compiled())
        self._step = first_class(compile_for(self._scheme.step, STEP))
        self._motions = GivenMotions(scene, begin, self._origin, self.dt)
        self._forces = GivenForces(scene)
        self._counts, self._first_t, self._steps = np.zeros(COUNTS, np.int64), begin.t, 0
        state = State(build(pushed), begin.t, begin.q, begin.v, begin.segment_tension, events=begin.events)
        state = replace(state, crept=begin.crept, T_max=begin.T_max, shedding=begin.shedding)
        self._legs = Legs(pushed, state, Leg(begin.t, math.inf, begin.t, math.inf, None), self.dt)
        self._due = sorted({t for t in pushed.event_times if t >= begin.t})
        self._new_march()
        self._first_energy = np.zeros(ENERGIES)  # for the next line
        self._first_energy = self.energy
        self._first = self.save()

    def _new_march(self) -> None:
        """Make what the next steps work on, from the state that the legs hold."""
        legs, scheme = self._legs, self._scheme
        if not scheme.keeps_constraints:
            legs.take_blow()
        own, model = legs.left, legs.left.model
        inner = legs.crept_of(own), legs.shedding_of(own)
        self._net, self._system = net_and_system(model, scheme, legs.tension[own.segment], *inner)
        q, v = (np.array(x[own.node], float, order="C") for x in (legs.q, legs.v))
        self._state = StepState(q, v, np.zeros((scheme.memory_rows, model.n, 3)), np.zeros(BALANCE))
        start = scratch_for(self._state, scheme.carried_rows, 0).start
        self._words = system_words(self._system)
        self._numbers = np.array([legs.t, 0.0])
        addresses = self._words.ctypes.data, self._net.address
        self._march = held_march.HeldMarch(
            self._step,
            *addresses,
            int(scheme.needs_copied_start),
            self._parameters,
            self._counts,
            self._state,
            start,
            self._numbers,
        )
        self._march_words = held_march.words_in_memory(self._march)
        self._address = self._march_words.ctypes.data
        self._observed = np.zeros(model.n_segments)
        self._motions.attach(model.scene, self._net.paths)
        self._forces.attach(model, self._net.effects.params, self._net.effects.params_at[len(model.forces) - 1])
        self._forces.write(q, v, self.dt)
        if self._motions.tracks:
            self._lead()
        self._table = body_table(model, self._forces.bodies)
        two_way = model.axial[model.cable_of, AXIAL_TWO_WAY_DAMPER] > 0.0
        self._least_tension = np.where(two_way, -math.inf, 0.0)
        self._cable_ends = CableEnds(model, self._table)
        self._begin(self._address)
        self.readings = readings_of(self, model)
        self._readable = words_in_memory(self.readings)
        self.readable = self._readable.ctypes.data  # address of the readings

    @property
    def _as_observed(self) -> bool:
        """Whether no step has told other tensions than those at the time reached."""
        return self._scheme.explicit or self._steps == 0

    def _lead(self) -> None:
        """Write the paths of what is driven from outside through the next step."""
        self._motions.lead(self._first_t + self._steps * self.dt, self._goal)

    @property
    def _goal(self) -> float:
        return self._first_t + (self._steps + 1) * self.dt

    def drive(
        self, name: str, position: Any = None, velocity: Any = NOTHING, rotation: Any = None, angular_velocity: Any = None
    ) -> None:
        """Give the position [m] and velocity [m/s] of a driven point, or of a driven body's origin, at the end of the next step.

        Within the step it moves along the cubic that has both positions and both velocities. What is not driven anew goes on with
        the velocity that was given last.

        Parameters
        ----------
        name : name of a point, or of a body, whose path is `paths.external`
        position, velocity : (3,) array_like [m], [m/s]; without a position it goes on
        rotation : (3,) array_like or None [rad]
            Of a body whose `turning` is `paths.external`: rotation vector from its axes at the start, less than a whole turn.
            Within the step it is the cubic likewise, so that it has to go on from the last one. None: it goes on.
        angular_velocity : (3,) array_like or None [rad/s], in the axes of the world; None with a rotation: zero

        Raises
        ------
        InputError : not a point or body whose path is `paths.external`, or not three finite numbers
        """
        self._motions.drive(name, position, velocity, rotation, angular_velocity)

    def push(self, name: str, force: Any, torque: Any = None, axes: str = "world") -> None:
        """Give the force on a point or body, and the torque on a body, that act in the next step and until others are given.

        Parameters
        ----------
        name : name of a free point, of a body that moves freely (at its origin) or of an attachment, "quad1.hook"
        force : (3,) array_like [N]
        torque : (3,) array_like or None [N m], on a body; None: none
        axes : "world" or "body", whose axes turn with the body
            What turns, and any torque, is taken with the axes in the middle of the step, as the angular velocity now predicts them.

        Raises
        ------
        InputError : neither a free point nor on a body that moves freely, a torque on a point, or not three finite numbers
        """
        self._forces.push(name, force, torque, axes)

    def push_bodies(self, force: np.ndarray, torque: np.ndarray, axes: str = "world") -> None:
        """`push` of all bodies that move freely at their origins, in the order of the scene: (bodies, 3) [N] and [N m]."""
        self._forces.push_bodies(force, torque, axes)

    # Steps ---------------------------------------------------------------------------------------------------------------

    def step(self) -> None:
        """March one step.

        Raises
        ------
        SessionError : the step failed; its message says when, where, why and what to try
        SceneError : a cable that would be reeled in by more than it has
        """
        goal = self._goal
        if len(self._net.lengths.cable):
            rest_lengths.shortest(self._legs.scene, goal, goal)
        if self._motions.tracks:
            self._lead()
        forces = self._forces
        if forces.write(self._state.q, self._state.v, self.dt) and self._scheme.evaluates_force:
            self._begin(self._address)  # such a step takes over the force at the end of the last one
        self._finish_step()

    def _finish_step(self) -> None:
        """March on to the end of the step, from event to event."""
        goal, same, forces = self._goal, SAME_TIME * self.dt, self._forces
        while True:
            while self._due and self._due[0] <= self._numbers[0]:
                self._change(self._due.pop(0))
            end = self._due[0] if self._due and self._due[0] <= goal + same else goal
            before = forces.places(self._state.q) if forces.acts else None
            status, node = self._step_to(self._address, end)
            if before is not None:
                work = forces.work(before, self._state.q)
                self._legs.carried[WORK] += work
                self._legs.carried[BY_EFFECTS] += work
            if status != DONE:
                self._after(status, node)
            elif end >= goal - same:
                break
        self._count_steps(1)

    def _after(self, status: int, node: int) -> None:
        """After an event: make what the rest of the step works on; else the step has failed."""
        if status != EVENT:
            why = why_it_stopped(self._legs.left.model, self._choice, status, self.t, node, None, self._counts)
            raise SessionError(STATUS[status], why + self._motions.too_far(self._goal))
        self._sync()
        self._legs.give_way(self._legs.overloaded(at_least=1))
        self._new_march()

    def _count_steps(self, count: int) -> None:
        """After so many steps."""
        self._steps += count
        self.readings.at_end[0] = self._as_observed
        if self._motions.tracks:
            self._motions.go_on()

    def _change(self, t: float) -> None:
        """Change the payloads and cut the cables whose events are at t."""
        self._sync()
        self._legs.take_events(t)
        self._new_march()

    def _sync(self) -> None:
        """Give the legs the state that was reached, and what was taken so far."""
        legs, own = self._legs, self._legs.left
        legs.t = float(self._numbers[0])
        legs.q[own.node], legs.v[own.node] = self._state.q, self._state.v
        legs.tension[own.segment] = self._end_tension()
        if own.model.creeps:
            legs.crept[:, own.segment] = inner_of_net(self._net)
        if own.model.sheds:
            legs.shedding[own.node] = shedding_of_net(own.model, self._net)
        legs.carried[WORK:] += self._state.balance[WORK:ENERGIES]

    # What is read --------------------------------------------------------------------------------------------------------

    @property
    def t(self) -> float:
        """Time reached [s]."""
        return float(self._numbers[0])

    @property
    def events(self) -> tuple[Event, ...]:
        """What has happened so far."""
        return tuple(self._legs.events)

    @property
    def work(self) -> Work:
        """What the steps did so far."""
        return Work(*map(int, self._counts))

    @property
    def energy(self) -> np.ndarray:
        """Kinetic, elastic, potential energy, work and what was taken so far (7,) [J], as a row of ``Run.energy``."""
        balance = self._state.balance
        self._system.observe(self.t, self._state.q, self._state.v, self._net.address, self._observed, balance)
        row = balance[:ENERGIES] + self._legs.carried
        if self._scheme.books_its_losses:
            return row
        rows = np.array([self._first_energy, row])
        book_remainder(rows)
        return rows[1]

    @property
    def state(self) -> State:
        """State at the time reached, from which `simulate` and another session go on."""
        own = self._legs.left
        q, v, tension = self._legs.q.copy(), self._legs.v.copy(), self._legs.tension.copy()
        q[own.node], v[own.node], tension[own.segment] = self._state.q, self._state.v, self._end_tension()
        q, v = (own.follow(self.model, array) for array in (q, v))
        crept = None if self._legs.crept is None else self._legs.crept.copy()
        if crept is not None and own.model.creeps:
            crept[:, own.segment] = inner_of_net(self._net)
        shed = None if self._legs.shedding is None else self._legs.shedding.copy()
        if shed is not None and own.model.sheds:
            shed[own.node] = shedding_of_net(own.model, self._net)
        inner = split_inner(self.model, crept) | {"shedding": shed}
        return State(self.model, self.t, q + self._origin, v, tension, events=self.events, pushed=self._forces.acts, **inner)

    def position(self, point: str) -> np.ndarray:
        """(3,) place of a point [m]."""
        return self._state.q[self._node(point)] + self._origin

    def velocity(self, point: str) -> np.ndarray:
        """(3,) velocity of a point [m/s]."""
        return self._state.v[self._node(point)].copy()

    def shape(self, cable: str) -> np.ndarray:
        """(segments + 1, 3) places of a cable's nodes from its start to its end [m]."""
        return self.state.shape(cable)

    def tension(self, cable: str) -> np.ndarray:
        """(segments,) tension of a cable's segments from its start to its end that acted in the last step [N]."""
        whole = self._legs.model
        acted = np.zeros(whole.n_segments)
        acted[self._legs.left.segment] = self._acted()
        return acted[whole.segments(cable)]

    def rotation(self, body: str) -> np.ndarray:
        """(3, 3) rotation matrix of a body; its columns are the body's axes."""
        free = self._forces.body.get(body)
        return self.state.rotation(body) if free is None else self.motions().rotation[free].copy()

    def quaternion(self, body: str) -> np.ndarray:
        """(4,) rotation of a body as a unit quaternion (w, x, y, z) with w >= 0."""
        return quaternions(self.rotation(body))

    def angular_velocity(self, body: str) -> np.ndarray:
        """(3,) angular velocity of a body in the axes of the world [rad/s]."""
        free = self._forces.body.get(body)
        return self.state.angular_velocity(body) if free is None else self.motions().angular_velocity[free].copy()

    def look(self) -> Sight:
        """All bodies that move freely and all free points, in the order of the scene, seen at once."""
        sight = sight_of(len(self._forces.bodies), len(self._forces.free_nodes))
        compiled_see()(self.readable, sight)
        return sight

    def motions(self) -> Motions:
        """Places and motions of all bodies that move freely, in the order of the scene: see `Motions`."""
        return Motions(*self.look()[:4])

    def pull(self, point: str) -> np.ndarray:
        """(3,) force of the cables on a point, an attachment or the origin of a body that acted in the last step [N].

        Raises
        ------
        InputError : a body whose cables end at attachments alone, `pulls` has the force and the moment on it; an unknown point
        """
        rows, column = self._directions()
        pull = self._cable_ends.pull(self._node(point), rows[:, column : column + 3], self._acted())
        if not pull.any():
            check_tied_there(self.scene, point)
        return pull

    def pulls(self) -> tuple[np.ndarray, np.ndarray]:
        """(bodies, 3) forces of the cables on all bodies that move freely [N], and moments about their origins [N m].

        Half segments that end at a body count with their weight, as of a cable whose mass is spread over its length.
        """
        seen = self.look()
        return seen.pull, seen.moment

    def _directions(self) -> tuple[np.ndarray, int]:
        """Rows of the segments left, and the first of the three columns of the direction in which each pulled in the last step."""
        if self._as_observed:
            return self._cable_ends.directions(self._state.q), 0
        return self._net.segment, SEGMENT_DIRECTION

    def free_points(self) -> tuple[np.ndarray, np.ndarray]:
        """(k, 3) places [m] and velocities [m/s] of all free points, in the order of the scene."""
        seen = self.look()
        return seen.point, seen.point_velocity

    def _node(self, point: str) -> int:
        try:
            return self._legs.left.model.node_of[self._legs.left.held.get(point, point)]
        except (KeyError, TypeError):
            self.scene.point(point)
            raise

    def _acted(self) -> np.ndarray:
        """Tension of every segment that acted in the last step, of what is left of the scene."""
        if self._as_observed:
            return self._end_tension()
        return np.maximum(self._net.tension, self._least_tension)

    def _end_tension(self) -> np.ndarray:
        """Tension of every segment at the time reached, as a run saves it."""
        self._system.observe(self.t, self._state.q, self._state.v, self._net.address, self._observed, np.empty(0))
        return self._observed

    def _arrays(self) -> Iterator[np.ndarray]:
        """Everything that a step changes, besides what the legs hold."""
        net = self._net._replace(words=np.empty(0, np.int64), kernels=np.empty(0, np.int64))
        yield from (self._numbers, self._counts, self._motions.given, *self._state, *own_arrays(net, self._legs.left.model))

    def save(self) -> Mark:
        """Keep the whole state of the session, to go back to."""
        legs, kept = self._legs, arrays_of_legs(self._legs)
        structure = dict(legs.payloads), dict(legs.broken), dict(legs.left.held)
        return Mark(
            id(self), self.t, self._steps, structure, tuple(x.copy() for x in kept),
            self._forces.saved(), tuple(x.copy() for x in self._arrays()), self.events, tuple(self._due),
        )  # fmt: skip

    def restore(self, mark: Mark) -> None:
        """Go back to what was saved; what follows is what followed then, bit for bit.

        Raises
        ------
        InputError : not a mark of this session
        """
        check_mark(mark, self)
        legs, (payloads, broken, held) = self._legs, mark.structure
        other = (payloads, broken, held) != (legs.payloads, legs.broken, legs.left.held)
        legs.payloads, legs.broken, legs.events, self._due = dict(payloads), dict(broken), list(mark.events), list(mark.due)
        legs.t, self._steps = mark.t, mark.steps
        for own, saved in zip(arrays_of_legs(legs), mark.legs, strict=True):
            own[:] = saved
        self._forces.restore(mark.forces)
        if other:
            legs._reduce()
            self._new_march()
        for own, saved in zip(self._arrays(), mark.arrays, strict=True):
            own[...] = saved
        self.readings.at_end[0] = self._as_observed

    def reset(self) -> None:
        """Go back to the start."""
        self.restore(self._first)

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *raised: Any) -> None:
        """Nothing has to be closed; a session holds memory alone."""

    def __repr__(self) -> str:
        return f"<Session at t={self.t:g} s: {self.method} with dt={self.dt:g} s, {self._legs.model.n} nodes>"
