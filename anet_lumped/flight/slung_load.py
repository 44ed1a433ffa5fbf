"""A quadrotor from which a load hangs on a cable, as the model-predictive controller expects it: 18 states.

The cable is a straight rod with the load at its end. About the quadrotor's centre it has the mass M, the first moment S and the
second moment I; it pulls and swings as a point of mass b = S^2/I at the distance l = I/S and the rest M - b in the quadrotor, whose
mass is then m. With the direction q of the cable, its angular velocity w and the force F of the rotors,

    q' = w x q ,    m l w' = -q x F ,    (m + b)(r'' + l q'' + g e_3) = (q.F - m l |w|^2) q ,

and the load is at r + L q. The rotors give the force that was commanded, F_c, as far as it lies along the axis z of the quadrotor:
F = (F_c.z) z. Roll, pitch and yaw phi follow those of the commanded force as the loop of `AttitudeControl` does,

    phi'' = -omega_R^2 (phi - phi_c) - 2 zeta omega_R phi' ,

each for itself, which is right for small angles. Left out: the cable's bending, air, the lag of the rotors.

Source: Sreenath, Lee and Kumar, Geometric Control and Differential Flatness of a Quadrotor UAV with a Cable-Suspended Load,
52nd IEEE CDC (2013) 2269.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.scene.scene import Free, Scene

from .laws import G
from .seen import Seen

STATES, INPUTS, OUTPUTS = 18, 3, 18
SUBSTEPS = 2  # of Runge and Kutta's method in an interval of the plan


@dataclass(frozen=True)
class SlungLoad:
    """Numbers of the model.

    Parameters
    ----------
    mass : float [kg], m
    swinging : float [kg], b
    arm : float [m], l
    reach : float [m], L
    attitude : (2,) float, omega_R [rad/s] and zeta of the loop of attitudes
    """

    mass: float
    swinging: float
    arm: float
    reach: float
    attitude: tuple[float, float]

    @property
    def weight(self) -> float:
        """Force in hover [N]."""
        return (self.mass + self.swinging) * G

    def rates(self, casadi: Any, x: Any, u: Any) -> tuple[Any, Any]:
        """x' and the outputs, as expressions of CasADi.

        Parameters
        ----------
        casadi : the package
        x : (18,), r, r', q, w, phi and phi'
        u : (3,) [N], F_c

        Returns
        -------
        rates, outputs : (18,), (18,)
            Outputs: place of the load, attitude, velocity of the load, phi', acceleration of the load, phi''.
        """
        v, q, w, angle, turning = x[3:6], x[6:9], x[9:12], x[12:15], x[15:18]
        (omega, zeta), cross, dot = self.attitude, casadi.cross, casadi.dot
        cosine, sine = casadi.cos(angle), casadi.sin(angle)
        z = casadi.vertcat(
            cosine[2] * sine[1] * cosine[0] + sine[2] * sine[0],
            sine[2] * sine[1] * cosine[0] - cosine[2] * sine[0],
            cosine[1] * cosine[0],
        )
        F = dot(u, z) * z
        commanded = casadi.vertcat(casadi.asin(-u[1] / casadi.norm_2(u)), casadi.atan2(u[0], u[2]), 0.0)
        dw = -cross(q, F) / (self.mass * self.arm)
        bending = cross(dw, q) - dot(w, w) * q  # q''
        bob = (dot(q, F) - self.mass * self.arm * dot(w, w)) / (self.mass + self.swinging) * q
        a = bob - self.arm * bending - casadi.vertcat(0.0, 0.0, G)
        turned = -(omega**2) * (angle - commanded) - 2.0 * zeta * omega * turning
        dq = cross(w, q)
        outputs = casadi.vertcat(x[0:3] + self.reach * q, angle, v + self.reach * dq, turning, a + self.reach * bending, turned)
        return casadi.vertcat(v, a, dq, dw, turning, turned), outputs

    def step(self, casadi: Any, h: float) -> Any:
        """The CasADi function (x, u) -> (x after h [s], outputs before), by the classical method of Runge and Kutta."""
        x, u = casadi.SX.sym("x", STATES), casadi.SX.sym("u", INPUTS)
        _, outputs = self.rates(casadi, x, u)
        ahead, dt = x, h / SUBSTEPS
        for _ in range(SUBSTEPS):
            k1, _ = self.rates(casadi, ahead, u)
            k2, _ = self.rates(casadi, ahead + 0.5 * dt * k1, u)
            k3, _ = self.rates(casadi, ahead + 0.5 * dt * k2, u)
            k4, _ = self.rates(casadi, ahead + dt * k3, u)
            ahead = ahead + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        return casadi.Function("step", [x, u], [ahead, outputs])

    def state(self, seen: Seen, load: int) -> np.ndarray:
        """(18,) state of what is seen, with the number of the load among the free points."""
        r, v, R = seen.position[0], seen.velocity[0], seen.rotation[0]
        d = seen.point[load] - r
        length = float(np.linalg.norm(d))
        q, dq = d / length, (seen.point_velocity[load] - v) / length
        roll, pitch, yaw = np.arctan2(R[2, 1], R[2, 2]), -np.arcsin(np.clip(R[2, 0], -1.0, 1.0)), np.arctan2(R[1, 0], R[0, 0])
        W = R.T @ seen.angular_velocity[0]
        across = W[1] * np.sin(roll) + W[2] * np.cos(roll)
        turning = W[0] + across * np.tan(pitch), W[1] * np.cos(roll) - W[2] * np.sin(roll), across / np.cos(pitch)
        return np.concatenate([r, v, q, np.cross(q, dq), (roll, pitch, yaw), turning])


def slung_load(scene: Scene, attitude: tuple[float, float]) -> SlungLoad:
    """The model of a scene: one quadrotor, one cable and a free point at its end.

    Parameters
    ----------
    scene : Scene
    attitude : (2,) float, omega_R [rad/s] and zeta

    Raises
    ------
    InputError : another scene
    """
    free = [body for body in scene.bodies if not body.is_driven]
    cable = scene.cables[0] if len(scene.cables) == 1 else None
    ends = {cable.start, cable.end} if cable else set()
    loads = [point for point in scene.points if isinstance(point, Free) and point.name in ends]
    hooks: list[Any] = [point for body in free for point in body.points if point.name in ends]
    if len(free) != 1 or len(loads) != 1 or len(hooks) != 1 or cable is None:
        raise InputError(
            "Predictive control needs one quadrotor, one cable and a load at its end, but the scene has "
            f"{len(free)} quadrotors, {len(scene.cables)} cables and {len(loads)} loads that hang on one of them."
        )
    hook, L0 = float(np.linalg.norm(np.array(hooks[0].at, float) - np.array(free[0].at, float))), cable.length
    reach, per_length = hook + L0, cable.mass_per_length
    total = loads[0].mass + per_length * L0
    first = loads[0].mass * reach + per_length * L0 * (hook + 0.5 * L0)
    second = loads[0].mass * reach**2 + per_length * (reach**3 - hook**3) / 3.0
    swinging = first**2 / second
    return SlungLoad(free[0].whole.total + total - swinging, swinging, second / first, reach, attitude)
