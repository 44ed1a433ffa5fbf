"""Model-predictive control of a quadrotor that brings a load on a cable to a place.

From the state that is seen, the forces u_0, ..., u_(N-1) of the next N intervals h are found that minimise

    sum_k |p_k - p_goal|^2 + |phi_k|^2 + |v_k - v_goal|^2 + |phi'_k|^2 + |a_k - a_goal|^2 + |phi''_k|^2 ,

each square with weights of its own: of the place p, velocity v and acceleration a of the load, and of roll, pitch and yaw phi of
the quadrotor and their rates. Places, attitudes and velocities count at the ends of the intervals, accelerations at their starts.
The model is that of `SlungLoad`; forces are bounded in size and tilt. The first force acts, and the plan is made anew.

The cable bends and the model's does not: a plan that chased what the load does in its bending would excite it. So the direction of
the cable and its rate are, but for a fifth, those that the last plan predicted.

The states and weights are those of the appendix of the thesis (7.2, 7.3), which tells neither model nor horizon: the model, the
horizon of N h = 2 s and the bounds are of this project. With 1 s the linearised loop is all but undamped. A common factor of all
weights changes nothing: divided by 1e8, the tuned ones leave place and accelerations as they were, divide the weights of all
velocities by a thousand and more, and take that of roll by 2.5.

It needs the package casadi, which ``pip install "anet-lumped[mpc]"`` brings; the problem is solved by Ipopt.
Source: Andersson et al., CasADi, Math. Program. Comput. 11 (2019) 1, for the software.
"""

import time
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import InputError, check_number, check_vector, shown
from anet_lumped.prescribed.paths import Path
from anet_lumped.scene.scene import Scene

from .geometric import AttitudeControl, Cascade
from .quadrotor import THESIS_QUADROTOR, Quadrotor
from .seen import Seen
from .slung_load import INPUTS, STATES, slung_load

CABLE, TRUST = slice(6, 12), 0.2  # states of the cable, and how far what is seen of them is trusted
TILT = 0.6  # [rad], of the commanded force
LARGEST, LEAST = 0.9, 0.2  # largest commanded force over that of the rotors, and least lift over the weight


class Weights(NamedTuple):
    """Weights of the squares, (3,) each: x, y and z, or roll, pitch and yaw; of [m], [rad], [m/s], [rad/s], [m/s2], [rad/s2]."""

    position: tuple[float, float, float]
    attitude: tuple[float, float, float]
    velocity: tuple[float, float, float]
    angular_velocity: tuple[float, float, float]
    acceleration: tuple[float, float, float]
    angular_acceleration: tuple[float, float, float]


UNTUNED = Weights((10.0,) * 3, (10.0,) * 3, (1.0,) * 3, (1.0,) * 3, (119e-4,) * 3, (1e-4,) * 3)
TUNED = Weights((10e8,) * 3, (25e8, 10e8, 10e8), (10e4, 10e4, 10e2), (10e4,) * 3, (119e4,) * 3, (1e4,) * 3)
"""Those of the thesis before and after its tuning, figure 7.2."""


class Solve(NamedTuple):
    """A plan that was made: when [s], in what time [s], and in how many iterations."""

    t: float
    wall_time: float
    iterations: int


class PlanError(RuntimeError):
    """A plan that was not found."""


class PredictiveControl:
    """The force that a quadrotor shall exert so that its load goes to a place, for a `Cascade` in place of `PositionControl`.

    Parameters
    ----------
    scene : Scene, of one quadrotor, one cable and a load
    at : Path or (3,) array_like [m], where the load shall be
    quadrotor : Quadrotor
    weights : Weights
    interval : float [s], h
    intervals : int, N
    attitude : AttitudeControl, the loop that follows

    Attributes
    ----------
    solves : list of Solve, since the last `reset`

    Raises
    ------
    InputError : another scene, or a number out of its range
    ModuleNotFoundError : casadi is missing
    """

    def __init__(
        self, scene: Scene, at: Any, *, quadrotor: Quadrotor = THESIS_QUADROTOR, weights: Weights = UNTUNED, interval: float = 0.1,
        intervals: int = 20, attitude: AttitudeControl | None = None,
    ) -> None:  # fmt: skip
        loop = attitude or AttitudeControl([quadrotor])
        self.model = slung_load(scene, (loop.frequency, loop.damping))
        (self._load,) = (
            k for k, point in enumerate(scene.free_points) if point.name in (scene.cables[0].start, scene.cables[0].end)
        )
        self.at = at if isinstance(at, Path) else check_vector("at", at, "m", "PredictiveControl")
        self.interval = check_number("interval", interval, "s", "PredictiveControl", sign="positive")
        if not isinstance(intervals, int) or intervals < 1:
            raise InputError(
                f"Argument `intervals` of PredictiveControl must be a whole number, 1 or more, but it is {shown(intervals)}."
            )
        self.intervals, self.weights = intervals, _checked(weights)
        self._largest = LARGEST * 4.0 * quadrotor.largest_thrust
        self._solver, self._bounds = self._problem(_casadi())
        self.reset()

    def reset(self) -> None:
        """Begin anew."""
        self.solves: list[Solve] = []
        self._plan: tuple[np.ndarray, np.ndarray] | None = None

    def _problem(self, casadi: Any) -> tuple[Any, dict[str, np.ndarray]]:
        """The solver, of x_1, ..., x_N and u_0, ..., u_(N-1), one after the other; and bounds of its constraints."""
        N, step = self.intervals, self.model.step(casadi, self.interval)
        X, U = casadi.MX.sym("X", STATES, N), casadi.MX.sym("U", INPUTS, N)
        first, goals = casadi.MX.sym("x0", STATES), casadi.MX.sym("goals", 9, N + 1)
        scale = max(max(row) for row in self.weights)
        at_ends = casadi.DM(np.concatenate(self.weights[:4]) / scale)
        at_starts = casadi.DM(np.concatenate(self.weights[4:]) / scale)
        begins = casadi.horzcat(first, X[:, :-1])
        ahead, outputs = step.map(N)(begins, U)
        _, last = step(X[:, -1], U[:, -1])
        y = casadi.horzcat(outputs[:, 1:], last)
        still = casadi.DM.zeros(3, N)
        off_ends = y[:12, :] - casadi.vertcat(goals[:3, 1:], still, goals[3:6, 1:], still)
        off_starts = outputs[12:, :] - casadi.vertcat(goals[6:9, :-1], still)
        cost = casadi.sum2(at_ends.T @ off_ends**2) + casadi.sum2(at_starts.T @ off_starts**2)
        slope = np.tan(TILT) / np.sqrt(2.0)  # of either coordinate, so that both together keep to it
        tilt = [sign * U[i, :] - slope * U[2, :] for i in (0, 1) for sign in (1.0, -1.0)]
        rows = casadi.vertcat(casadi.vec(X - ahead), casadi.vec(casadi.vertcat(*tilt, casadi.sum1(U**2), U[2, :])))
        low = np.concatenate([np.zeros(STATES * N), np.tile([-np.inf] * 5 + [LEAST * self.model.weight], N)])
        high = np.concatenate([np.zeros(STATES * N), np.tile([0.0] * 4 + [self._largest**2, np.inf], N)])
        options = {
            "expand": True, "print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-8,
            "ipopt.warm_start_init_point": "yes", "ipopt.mu_init": 1e-4, "ipopt.max_iter": 200,
        }  # fmt: skip
        both = {"x": casadi.vertcat(casadi.vec(X), casadi.vec(U)), "p": casadi.vertcat(first, casadi.vec(goals))}
        return casadi.nlpsol("plan", "ipopt", both | {"f": cost, "g": rows}, options), {"lbg": low, "ubg": high}

    def _goals(self, t: float) -> np.ndarray:
        """(9, N + 1) place, velocity and acceleration of the goal at the ends of the intervals."""
        if not isinstance(self.at, Path):
            return np.tile(np.concatenate([self.at, np.zeros(6)])[:, None], self.intervals + 1)
        return np.array([np.concatenate(self.at.at(t + k * self.interval)) for k in range(self.intervals + 1)]).T

    def plan(self, t: float, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """States (18, N) at the ends of the intervals and forces (3, N) [N], from a state (18,) at t [s].

        Raises
        ------
        PlanError : the solver found none
        """
        N = self.intervals
        if self._plan is None:
            X, U = np.tile(state[:, None], N), np.tile([[0.0], [0.0], [self.model.weight]], N)
        else:
            X, U = (np.hstack([rows[:, 1:], rows[:, -1:]]) for rows in self._plan)
        begin = time.perf_counter()
        given = np.concatenate([state, self._goals(t).ravel(order="F")])
        found = self._solver(x0=np.concatenate([X.ravel(order="F"), U.ravel(order="F")]), p=given, **self._bounds)
        stats = self._solver.stats()
        if not stats["success"]:
            raise PlanError(
                f"No plan was found at t = {t:g} s: Ipopt says {stats['return_status']} after {stats['iter_count']} iterations."
            )
        self.solves.append(Solve(t, time.perf_counter() - begin, int(stats["iter_count"])))
        numbers = np.array(found["x"]).ravel()
        self._plan = numbers[: STATES * N].reshape(N, STATES).T, numbers[STATES * N :].reshape(N, INPUTS).T
        return self._plan

    def __call__(self, seen: Seen) -> np.ndarray:
        """(1, 3) force in the axes of the world [N]."""
        state = self.model.state(seen, self._load)
        if self._plan is not None:
            predicted = self._plan[0][CABLE, 0]
            state[CABLE] = predicted + TRUST * (state[CABLE] - predicted)
            state[CABLE][:3] /= np.linalg.norm(state[CABLE][:3])
        _, forces = self.plan(seen.t, state)
        return forces[:, 0][None].copy()


def predictive(scene: Scene, at: Any, *, quadrotor: Quadrotor = THESIS_QUADROTOR, weights: Weights = UNTUNED) -> Cascade:
    """`PredictiveControl` at the rate of its intervals, and `AttitudeControl` at 500 Hz, in a `Cascade`."""
    loop = AttitudeControl([quadrotor])
    position = PredictiveControl(scene, at, quadrotor=quadrotor, weights=weights, attitude=loop)
    return Cascade(position, loop, (1.0 / position.interval, 500.0))


def _casadi() -> Any:
    """The package, or one sentence on what brings it."""
    try:
        import casadi
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(
            'Predictive control needs the package casadi; pip install "anet-lumped[mpc]" brings it.'
        ) from missing
    return casadi


def _checked(weights: Weights) -> Weights:
    """Weights, each positive or zero, and some positive."""
    if not isinstance(weights, Weights):
        raise InputError(f"Argument `weights` must be Weights, such as UNTUNED, but it is {shown(weights)}.")
    for name, row in weights._asdict().items():
        if np.shape(row) != (3,) or not np.all(np.isfinite(row)) or min(row) < 0.0:
            raise InputError(f"Weights must be three finite numbers of which none is negative, but `{name}` is {shown(row)}.")
    if not any(map(any, weights)):
        raise InputError("Some weight must be positive, but all are zero.")
    return weights
