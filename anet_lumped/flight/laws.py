"""What each quadrotor needs in each step, compiled: the law of attitudes, and the thrusts of rotors."""

import math

from numba import float64, void

from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.mechanics.bodies.vectors import cross, dot, row, scaled

_f1, _f2, _f3, _f8 = float64[::1], float64[:, ::1], float64[:, :, ::1], float64


@inlined
def _applied(A, x):
    """A x of a 3x3 array and a tuple."""
    return dot(row(A, 0), x), dot(row(A, 1), x), dot(row(A, 2), x)


@inlined
def _applied_transposed(A, x):
    """A^T x."""
    return (
        A[0, 0] * x[0] + A[1, 0] * x[1] + A[2, 0] * x[2],
        A[0, 1] * x[0] + A[1, 1] * x[1] + A[2, 1] * x[2],
        A[0, 2] * x[0] + A[1, 2] * x[1] + A[2, 2] * x[2],
    )


@inlined
def axes_along(force, cosine, sine):
    """x, y and z axis of an attitude whose z axis lies along a force and whose x axis lies in the plane of z and the heading."""
    z = scaled(1.0 / math.sqrt(dot(force, force)), force)
    y = -sine * z[2], cosine * z[2], sine * z[0] - cosine * z[1]  # z x (c, s, 0)
    y = scaled(1.0 / math.sqrt(dot(y, y)), y)
    return cross(y, z), y, z


@kernel(void(_f2, _f8, _f8, _f3))
def attitudes_along(force, cosine, sine, rotation):
    """Write the rotations (m, 3, 3) of `axes_along` for forces (m, 3)."""
    for b in range(force.shape[0]):
        x, y, z = axes_along(row(force, b), cosine, sine)
        for i in range(3):
            rotation[b, i, 0], rotation[b, i, 1], rotation[b, i, 2] = x[i], y[i], z[i]


@kernel(void(_f2, _f3, _f2, _f2, _f3, _f1, _f1, _f2))
def turn_to(force, rotation, angular_velocity, moment, inertia, numbers, thrust, torque):
    """Thrusts and torques of the attitude control of `geometric`.

    Parameters
    ----------
    force : (m, 3) float64 [N], in the axes of the world
    rotation : (m, 3, 3) float64
    angular_velocity, moment : (m, 3) float64 [rad/s], [N m], in the axes of the world
    inertia : (m, 3, 3) float64 [kg m2]
    numbers : (5,) float64
        omega_R [rad/s], zeta, cosine and sine of the heading, and how much of the moment is fed forward.
    thrust, torque : (m,), (m, 3) float64 [N], [N m], written; torques in the axes of the bodies
    """
    stiffness, damping = -numbers[0] * numbers[0], -2.0 * numbers[1] * numbers[0]
    for b in range(force.shape[0]):
        R, J = rotation[b], inertia[b]
        F = row(force, b)
        x, y, z = axes_along(F, numbers[2], numbers[3])
        rx, ry, rz = (R[0, 0], R[1, 0], R[2, 0]), (R[0, 1], R[1, 1], R[2, 1]), (R[0, 2], R[1, 2], R[2, 2])
        off = 0.5 * (dot(z, ry) - dot(y, rz)), 0.5 * (dot(x, rz) - dot(z, rx)), 0.5 * (dot(y, rx) - dot(x, ry))
        W = _applied_transposed(R, row(angular_velocity, b))
        wanted = (
            stiffness * off[0] + damping * W[0],
            stiffness * off[1] + damping * W[1],
            stiffness * off[2] + damping * W[2],
        )
        tau, gyroscopic, M = _applied(J, wanted), cross(W, _applied(J, W)), _applied_transposed(R, row(moment, b))
        thrust[b] = dot(F, rz)
        for i in range(3):
            torque[b, i] = tau[i] + gyroscopic[i] - numbers[4] * M[i]


@kernel(void(_f1, _f2, _f3, _f2, _f2))
def command_rotors(thrust, torque, sharing, limits, speed):
    """Speeds (m, 4) [rad/s] that give thrusts (m,) [N] and torques (m, 3) [N m], as far as rotors can.

    Torques come first: where a rotor would have to push down, all give more; where one would have to give too much, all give less.

    Parameters
    ----------
    sharing : (m, 4, 4) float64, inverse of the mixing matrix
    limits : (m, 2) float64, largest thrust of a rotor [N], thrust coefficient [N s2]
    """
    for b in range(speed.shape[0]):
        least, most, shares = math.inf, -math.inf, speed[b]
        for r in range(4):
            shares[r] = sharing[b, r, 0] * thrust[b]
            for x in range(3):
                shares[r] += sharing[b, r, 1 + x] * torque[b, x]
            least, most = min(least, shares[r]), max(most, shares[r])
        shift = max(0.0, -least)
        shift -= max(0.0, most + shift - limits[b, 0])
        for r in range(4):
            shares[r] = math.sqrt(min(max(shares[r] + shift, 0.0), limits[b, 0]) / limits[b, 1])


@kernel(void(_f2, _f2, _f2, _f3, _f2, _f2, _f3, _f2, _f2))
def turn_rotors(command, speed, limits, mixing, lags, drag, rotation, velocity, acting):
    """Let rotors follow their commands over a step, and write the force and torque (m, 6) in the axes of the bodies.

    Parameters
    ----------
    command : (m, 4) float64 [rad/s]
    speed : (m, 4) float64 [rad/s], at the start of the step, and then at its end
    limits : (m, 2), as of `command_rotors`
    mixing : (m, 4, 4) float64
    lags : (m, 3) float64, exp(-dt/lag), and the means of exp(-t/lag) and of its square over the step
    drag : (m, 3) float64 [kg]
    rotation : (m, 3, 3) float64
    velocity : (m, 3) float64 [m/s], through the air, in the axes of the world
    acting : (m, 6) float64 [N], [N m], written
    """
    for b in range(speed.shape[0]):
        k, sum_of_speeds = limits[b, 1], 0.0
        total = acting[b]
        for x in range(6):
            total[x] = 0.0
        for r in range(4):
            c = command[b, r]
            off = speed[b, r] - c
            sum_of_speeds += c + lags[b, 1] * off
            thrust = k * (c * (c + 2.0 * lags[b, 1] * off) + lags[b, 2] * off * off)
            for x in range(4):
                total[2 + x] += mixing[b, x, r] * thrust
            speed[b, r] = c + lags[b, 0] * off
        v = _applied_transposed(rotation[b], row(velocity, b))
        for x in range(3):
            total[x] -= sum_of_speeds * drag[b, x] * v[x]
