"""The input and the output of every peer: flat arrays, and nothing of any engine."""

from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity
from anet_lumped.model.build import build
from anet_lumped.model.model import Model
from anet_lumped.motion.simulate import straight
from anet_lumped.motion.times import save_times
from anet_lumped.scene.scene import Driven


@dataclass(frozen=True, eq=False)
class Outcome:
    """The motion that a peer computed.

    Parameters
    ----------
    t : (k,) float64 [s], the saved times that it reached
    position : dict of point name to (k, 3) float64 [m]
    wall_time : float [s], of the march alone
    setup_time : float [s], of what came before it
    status : "done" or "failed"
    message : str, one sentence that says why it failed
    cpu_time : float [s], the processor's, of the march; NaN where it was not taken
    """

    t: np.ndarray
    position: dict
    wall_time: float
    setup_time: float
    status: str = "done"
    message: str = ""
    cpu_time: float = float("nan")


@dataclass(frozen=True, eq=False)
class Problem:
    """A scene as nodes and segments, their start, and the times to save.

    Parameters
    ----------
    model : Model
    q, v : (n, 3) float64 [m], [m/s], at the start
    t : (k,) float64 [s], times to save, the start first
    """

    model: Model
    q: np.ndarray
    v: np.ndarray
    t: np.ndarray
    driven: dict = field(init=False)

    def __post_init__(self):
        points = self.model.scene.points
        driven = {self.model.node(point.name): point.path for point in points if isinstance(point, Driven)}
        object.__setattr__(self, "driven", driven)

    @cached_property
    def segments(self):
        """Segments as rows (node, node, L0 [m], k [N/m], c [N·s/m])."""
        model = self.model
        law = model.axial[model.cable_of, :3]
        return [(int(a), int(b), *map(float, row)) for (a, b), row in zip(model.ends, law, strict=True)]

    def prescribed(self, t):
        """Positions of the driven points, (n_driven, k, 3) float64 [m], at the times ``t``."""
        return np.array([[path.at(time)[0] for time in t] for path in self.driven.values()]).reshape(len(self.driven), len(t), 3)

    def outcome(self, q, wall_time, setup_time, message="", cpu_time=float("nan")):
        """Outcome of the rows (k, n, 3) saved, of which those before the first that is not finite count."""
        good = np.isfinite(q).all(axis=(1, 2)) & (np.abs(q).max(axis=(1, 2)) < 1e3 * (1.0 + np.abs(self.q).max()))
        rows = len(q) if good.all() else int(np.argmin(good))
        whole = rows == len(self.t)
        if not whole and not message:
            message = f"The motion diverged before t={self.t[rows]:.4g} s."
        position = {point.name: q[:rows, self.model.node(point.name)] for point in self.model.scene.points}
        return Outcome(self.t[:rows], position, wall_time, setup_time, "done" if whole else "failed", message, cpu_time)


def problem(scene, t_end, save_every, start=None):
    """A scene ready to be handed to a peer.

    Parameters
    ----------
    scene : Scene
    t_end : float [s]
    save_every : float [s]
    start : State of a scene with the same points and cables, or None for straight cables at rest

    Returns
    -------
    Problem
    """
    model = build(scene)
    if start is None:
        q, v, t0 = straight(model), np.zeros((model.n, 3)), 0.0
    else:
        if [cable.segments for cable in start.scene.cables] != [cable.segments for cable in scene.cables]:
            raise InputError("Argument `start` must be a State of a scene with the same cables and segments, but it has others.")
        q, v, t0 = np.zeros((model.n, 3)), np.zeros((model.n, 3)), float(start.t)
        for cable in scene.cables:
            mine, theirs = model.nodes(cable.name), start.model.nodes(cable.name)
            q[mine], v[mine] = start.q[theirs], start.v[theirs]
    for point in scene.points:
        node = model.node(point.name)
        if isinstance(point, Driven):
            q[node], v[node] = point.path.at(t0)[:2]
        elif node >= model.n_free:
            q[node], v[node] = point.at, 0.0
    return Problem(model, q, v, save_times(t0, t0 + t_end, save_every))


def unsupported(scene, name, *, compression):
    """What a scene has beside gravity and the laws of compression given, in one sentence, or None."""
    for effect in scene.effects:
        if not isinstance(effect, Gravity):
            return f"{name} is given gravity alone, but the scene has {type(effect).__name__}."
    for cable in scene.cables:
        if cable.EA_compression:
            return f'{name} has no springs that push less than they pull, but cable "{cable.name}" has.'
        if cable.compression not in compression:
            known = " or ".join(f'"{law}"' for law in compression)
            return f'{name} does compression={known} only, but cable "{cable.name}" has "{cable.compression}".'
    return None


def explicit_limit(scene, reach):
    """Largest stable step of an explicit scheme [s], by the bound of the axial frequencies.

    Parameters
    ----------
    reach : float, omega·dt that the scheme takes undamped; damping of ratio zeta takes off a factor zeta + √(1 + zeta²)
    """
    return min(float(reach / c.omega_max / (c.damping_ratio + np.hypot(1.0, c.damping_ratio))) for c in scene.cables)


def raise_if_refused(reason):
    """Raise InputError if there is a reason to refuse a scene."""
    if reason is not None:
        raise InputError(reason)


def version_of(package):
    """Version of an installed package, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None
