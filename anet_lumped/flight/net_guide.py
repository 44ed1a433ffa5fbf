"""Pose and shape of a net that quadrotors carry: they are guided so that its point stays at a place, and the net keeps its shape.

The quadrotors stand at

    c_i = p + h + R(tilt) spread d_i + J^+ s ,      s' = rate (p_goal - p)

about the goal p of the carried point: d_i are the directions in which they start from their middle, and h is where this middle is
above the point at rest, from `equilibrium`. J is the derivative of the point's place at rest by the places of the quadrotors, from
differences of `equilibrium`. The sum s over the errors shifts the quadrotors until wind, loads and errors of the model are made up
for. J^+ is the pseudoinverse, so that they move as little as does it. The tensions that wind makes are fed forward by
`PositionControl`.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from anet_lumped.checks import InputError, Vector, check_number, check_vector, quoted
from anet_lumped.prescribed.path_in_numbers import constant, counted
from anet_lumped.prescribed.paths import Path
from anet_lumped.prescribed.turning import matrix_of
from anet_lumped.scene.scene import Free, Scene
from anet_lumped.statics.equilibrium import EquilibriumError, equilibrium
from anet_lumped.statics.held_bodies import with_bodies_held

from .compiled_law import CompiledLaw, Goal
from .hovering import hovering
from .laws import NET_NUMBERS, NET_POINT, NET_RATE, NET_REACH, guide_net
from .seen import Seen

DIFFERENCE = 1e-4  # of the spread, of the differences that J is made of
REACH = 0.5  # of the spread, by which errors may shift the quadrotors at most
TRIMS = 3  # of attitudes and spread in turn for a height; each leaves a hundredth of the error before
WIDEST = 0.999  # of the spread at which cables would be straight


class NetGuide:
    """Guide of the quadrotors that carry a net, for `PositionControl`.

    Parameters
    ----------
    scene : Scene
    at : Path or (3,) array_like [m]
        Where the point shall be, also as a path of `anet_lumped.paths`.
    point : name of the free point
    spread : float or None [m], distance of the quadrotors from the axis through their middle; None: as they start
    height : float or None [m], of their middle above the point at rest, in place of the spread, which then follows
    tilt : (3,) array_like [rad], rotation vector of the plane of the quadrotors
    rate : float [1/s], at which errors of the point are taken back; 0: not at all

    Raises
    ------
    InputError : no such free point; both spread and height; a height that no spread gives
    """

    def __init__(
        self, scene: Scene, at: Any, *, point: str = "p0", spread: float | None = None, height: float | None = None,
        tilt: Vector = (0.0, 0.0, 0.0), rate: float = 0.5,
    ) -> None:  # fmt: skip
        if not isinstance(scene.point(point), Free) or scene.point(point) not in scene.points:
            raise InputError(f"A net is guided by a free point, but {quoted(point)} is none.")
        if spread is not None and height is not None:
            raise InputError("Only one of `spread` and `height` may be given to a NetGuide, for the other follows, but both are.")
        self.scene, self.point = scene, point
        self._number = scene.free_points.index(scene.point(point))
        self.at = at if isinstance(at, Path) else check_vector("at", at, "m", "NetGuide")
        self.rate = check_number("rate", rate, "1/s", "NetGuide", sign="non-negative")
        self._names = [body.name for body in scene.bodies if not body.is_driven]
        starts = np.array([scene.body(name).at for name in self._names], float)
        arms = starts - starts.mean(axis=0)
        lengths = np.linalg.norm(arms, axis=1)
        self._turn, self._directions = matrix_of(check_vector("tilt", tilt, "rad", "NetGuide")), arms / lengths[:, None]
        if height is not None:
            height = check_number("height", height, "m", "NetGuide", sign="positive")
            spread = self._spread_of(height, float(lengths.mean()))
        self.spread = float(lengths.mean()) if spread is None else check_number("spread", spread, "m", "NetGuide", sign="positive")
        for _ in range(1 if height is None else TRIMS):  # hooks are where they are with the attitudes of hovering
            self.scene = hovering(self._placed(self._arms(self.spread))).scene
            if height is not None:
                self.spread = self._spread_of(height, self.spread)
        arms = self._arms(self.spread)
        rest = self._rest(arms)
        self.offsets = arms - rest  # (m, 3) [m] of the quadrotors from the point, at rest
        self.height = float(-rest[2])
        self.jacobian = self._derivative(arms)  # (3, 3 m)
        self._inverse = np.linalg.pinv(self.jacobian)
        self.reset()

    def reset(self) -> None:
        """Forget the errors."""
        self._memory = np.zeros(NET_NUMBERS)

    @property
    def law(self) -> CompiledLaw:
        """The same compiled, which begins with the errors that are known."""
        place = self.at if isinstance(self.at, Path) else constant(np.array(self.at))
        memory = self._memory.copy()
        memory[[NET_RATE, NET_REACH, NET_POINT]] = self.rate, REACH * self.spread, self._number
        numbers = np.concatenate([memory, self.offsets.ravel(), self._inverse.ravel(), counted(place)])
        return CompiledLaw(guide_net, numbers, gives="goal", quadrotors=len(self.offsets))

    def _arms(self, spread: float) -> np.ndarray:
        """(m, 3) places of the quadrotors about their middle [m]."""
        return spread * self._directions @ self._turn.T

    def _placed(self, places: np.ndarray) -> Scene:
        """The scene with the quadrotors at places (m, 3) [m]."""
        at = dict(zip(self._names, map(tuple, places.tolist()), strict=True))
        return replace(self.scene, bodies=[replace(b, at=at[b.name]) if b.name in at else b for b in self.scene.bodies])

    def _rest(self, places: np.ndarray) -> np.ndarray:
        """(3,) place of the point at rest [m] with the quadrotors at places (m, 3) [m]."""
        return equilibrium(with_bodies_held(self._placed(places))).position(self.point)

    def _spread_of(self, height: float, first: float) -> float:
        """The spread [m] with which the point hangs at a height [m] below the quadrotors, at most so wide as cables reach."""
        longest = self.scene.longest

        def above(spread: float) -> float:
            try:
                return height + float(self._rest(self._arms(spread))[2])
            except EquilibriumError:  # cables do not reach
                return height

        low, high = 1e-3 * first, WIDEST * longest
        if not above(low) < 0.0 < above(high):
            raise InputError(
                f"Argument `height` of a NetGuide must be one at which the net can hang, below {height - above(low):.4g} m, but it "
                f"is {height:g} m."
            )
        return float(brentq(above, low, high, xtol=1e-9))

    def _derivative(self, arms: np.ndarray) -> np.ndarray:
        """(3, 3 m) derivative of the point's place at rest by those of the quadrotors."""
        step, columns = DIFFERENCE * self.spread, []
        for k in range(arms.size):
            moved = np.zeros(arms.size)
            moved[k] = step
            ahead, behind = (self._rest(arms + sign * moved.reshape(arms.shape)) for sign in (1.0, -1.0))
            columns.append((ahead - behind) / (2.0 * step))
        return np.array(columns).T

    def __call__(self, seen: Seen) -> Goal:
        """Where the quadrotors shall be."""
        law = self.law
        goal: Goal = law(seen)
        self._memory = law.numbers[:NET_NUMBERS]
        return goal
