"""A State: places and velocities at one time, and the tensions that they make."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, quoted
from anet_lumped.effects.laws.axial import tension_parts, with_select
from anet_lumped.model import body_rotation
from anet_lumped.model.model import Model
from anet_lumped.model.tables import AXIAL_DAMPER, AXIAL_TWO_WAY_DAMPER
from anet_lumped.scene.scene import Scene

from . import end_forces, own_state, touchdown
from .events import Event, broken
from .moved_body import moved
from .stretch import stretch_of_state


def segment_tensions(model: Model, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Tension of every segment by its law.

    Parameters
    ----------
    model : Model
    q, v : (..., n, 3) float64 [m], [m/s]

    Returns
    -------
    T : (..., n_segments) float64 [N]

    Raises
    ------
    InputError : a cable that creeps, whose tension depends on how far it has crept
    """
    creeping = next((cable.name for cable in model.scene.cables if cable.creeps), None)
    if creeping is not None:
        raise InputError(
            f"Tensions of a cable that creeps must be given, which no place tells, but those of {quoted(creeping)} are not."
        )
    a, b = model.ends.T
    c, two_damper = model.axial[model.cable_of, AXIAL_DAMPER], model.axial[model.cable_of, AXIAL_TWO_WAY_DAMPER]
    k, pushes, L0, rows, *ends = (x if np.ndim(x) == 0 else x[..., model.cable_of] for x in model.springs_of_cables)
    d = q[..., b, :] - q[..., a, :]
    l = np.linalg.norm(d, axis=-1)
    rate = np.sum(d * (v[..., b, :] - v[..., a, :]), axis=-1) / np.maximum(l, 1e-300)
    law = with_select(tension_parts, np.where)
    return law(l - L0, rate, (k, pushes, L0, rows, *ends), c, two_damper)[0]


@dataclass(frozen=True, eq=False)
class State:
    """Places and velocities of all nodes at one time, with the tension of every segment.

    Parameters
    ----------
    model : Model
    t : float [s]
    q, v : (n, 3) float64 [m], [m/s]
    segment_tension : (n_segments,) float64 [N]
    residual : float or None
        Largest out-of-balance force over the weight carried, of an equilibrium.
    events : tuple of Event, what has happened up to then
    stable : bool or None
        Of an equilibrium, whether no direction leads down from it; None where it was not judged, as in a run.
    q_near : (n, 3) float64 [m] or None
        Of a scene far from its origin the places about an origin near it, which are not rounded to the digits of ``q``.
    pushed : bool
        Whether forces from outside act, as `Session.push` gives them, which its scene does not have.
    crept : (n_segments,) float64 [m] or None
        How far each segment has crept, see `effects.laws.creep`; None is that of lengths that have been held for long.
    T_max : (n_segments,) float64 [N] or None
        Largest tension that each segment has held for long, of scenes with a `working_curve`; comes with ``crept``.
    shedding : (n, 4) float64 or None
        Of nodes whose cable sheds vortices: the phase of the lift [rad], which grows by 2 pi a pair of vortices, its frequency
        f d/U, the mean squares of the velocity [m2/s2] and of the acceleration [m2/s4] across the flow; zeros of other nodes. None
        is that of a flow that begins.
    """

    model: Model
    t: float
    q: np.ndarray
    v: np.ndarray
    segment_tension: np.ndarray
    residual: float | None = None
    events: tuple[Event, ...] = ()
    stable: bool | None = None
    q_near: np.ndarray | None = None
    pushed: bool = False
    crept: np.ndarray | None = None
    T_max: np.ndarray | None = None
    shedding: np.ndarray | None = None

    @classmethod
    def of(cls, scene: Scene, shapes: Any = None, velocities: Any = None, points: Any = None, t: float = 0.0) -> "State":
        """State of one's own, to start from.

        A shape is resampled to the nodes of its cable at equal arc lengths, unless it has a place for each node. Its order is that
        of the cable or the opposite one, whichever is nearer to the cable's points. Cables without a shape are straight.
        Fixed and driven points, and those of bodies, are where the scene has them at the time t.

        Parameters
        ----------
        scene : Scene
        shapes : dict of cable to (k, 3) array_like [m] or None, places along it, k >= 2
        velocities : dict of cable or free point to (k, 3) or (3,) array_like [m/s] or None
            Of each place of a cable's shape, of a whole cable, or of a point; at rest where nothing is given.
        points : dict of free point to (3,) array_like [m] or None, where the shapes do not say
        t : float [s]

        Raises
        ------
        InputError : a name that the scene lacks, no array of places, a shape that misses its points, velocities that disagree
        """
        model, q, v = own_state.places_and_velocities(scene, shapes, velocities, points, t)
        return cls(model, float(t), q, v, segment_tensions(model, q, v))

    def __repr__(self) -> str:
        return f"<State at t={self.t:g} s of {len(self.q)} nodes>"

    def _repr_html_(self) -> str:
        from anet_lumped.views.notebook import state_html

        return state_html(self)

    @property
    def scene(self) -> Scene:
        """The scene it is a state of."""
        return self.model.scene

    def position(self, point: str) -> np.ndarray:
        """(3,) place of a point [m]."""
        return self.q[self.model.node(point)]

    def velocity(self, point: str) -> np.ndarray:
        """(3,) velocity of a point [m/s]."""
        return self.v[self.model.node(point)]

    def rotation(self, body: str) -> np.ndarray:
        """(3, 3) rotation matrix of a body; its columns are the body's axes."""
        return body_rotation.rotations(self.model, body, self.t, self.q)

    def quaternion(self, body: str) -> np.ndarray:
        """(4,) rotation of a body as a unit quaternion (w, x, y, z) with w >= 0."""
        return body_rotation.quaternions(self.rotation(body))

    def angular_velocity(self, body: str) -> np.ndarray:
        """(3,) angular velocity of a body in the axes of the world [rad/s]."""
        return body_rotation.angular_velocities(self.model, body, self.t, self.q, self.v)

    def moved(self, body: str, **motion: Any) -> "State":
        """The same state with a body elsewhere, or moving otherwise: see `moved_body.moved` for ``at`` and the like."""
        return moved(self, body, **motion)

    def shape(self, cable: str) -> np.ndarray:
        """(segments + 1, 3) places of a cable's nodes from its start to its end [m]."""
        return self.q[self.model.nodes(cable)]

    def tension(self, cable: str) -> np.ndarray:
        """(segments,) tension of a cable's segments from its start to its end [N]."""
        return self.segment_tension[self.model.segments(cable)]

    def end_tension(self, cable: str, point: str) -> float:
        """Force with which a cable pulls at a point where it ends [N]: its last half segment included, see `end_forces`."""
        return float(np.linalg.norm(end_forces.end_force(end_forces.rows_of_state(self), self.scene, cable, point)))

    def reaction(self, name: str) -> np.ndarray:
        """(3,) force of a fixed or driven point, of what drives or pins a body or of the "ground" [N], see `end_forces`."""
        return end_forces.reaction(end_forces.rows_of_state(self), self.scene, name)[0]

    @property
    def least_tension(self) -> float:
        """Mean tension of the cable whose mean tension is the least [N]; 0 without cables."""
        return min((float(self.tension(cable.name).mean()) for cable in self.scene.cables), default=0.0)

    def plot(self) -> Any:
        """A figure of matplotlib: the shape in one or two planes, coloured by tension; see `views.state_figure`."""
        from anet_lumped.views.state_figure import plot_state

        return plot_state(self)

    def touchdown_length(self, cable: str) -> float:
        """Unstretched length of a cable that lies on the ground [m], known to half a segment; see `results.touchdown`."""
        return float(touchdown.touchdown_lengths(self.model, [end_forces.rows_of_state(self)], cable, self.holds(cable)[None])[0])

    def length(self, cable: str) -> float:
        """Stretched length of a cable [m], without segments that broke."""
        return float(np.linalg.norm(np.diff(self.shape(cable), axis=0), axis=1)[self.holds(cable)].sum())

    def stretch(self, cable: str) -> float:
        """Stretched length of a cable over its length at rest at this time, less 1, without segments that broke."""
        return stretch_of_state(self, cable)

    def holds(self, cable: str) -> np.ndarray:
        """(segments,) bool: whether each segment of a cable, from its start to its end, has not broken."""
        whole = np.ones(self.scene.cable(cable).segments, bool)
        whole[list(broken(self.events).get(cable, ()))] = False
        return whole
