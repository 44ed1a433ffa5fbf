"""What quadrotors need in each step, compiled: laws of guides, positions and attitudes, and the thrusts of rotors."""

import math

from numba import float64, void

from anet_lumped.compiled.jit import inlined, kernel
from anet_lumped.mechanics.bodies.vectors import cross, dot, row, scaled, three
from anet_lumped.prescribed.path_in_numbers import motion_at

from .compiled_law import LAW

G = 9.81  # [m/s2], which controllers expect
# Numbers of a NetGuide: rate [1/s], largest sum [m], number of its point among the free ones, whether it has been called, when last
# [s], the sum of errors (3,) [m]; then the offsets (3 m,) [m], the pseudoinverse (3 m, 3), and the path of the point, `counted`.
NET_RATE, NET_REACH, NET_POINT, NET_CALLED, NET_TIME, NET_SUM, NET_NUMBERS = 0, 1, 2, 3, 4, 5, 8

_f1, _f2, _f3, _f8 = float64[::1], float64[:, ::1], float64[:, :, ::1], float64


@inlined
def _applied(A, x):
    """A x of a matrix, its three rows as tuples."""
    return dot(A[0], x), dot(A[1], x), dot(A[2], x)


@inlined
def _applied_transposed(A, x):
    """A^T x of a 3x3 array and a tuple."""
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


@kernel(LAW)
def stay(seen, given, numbers, told):
    """A goal that stays: ``numbers`` are the positions of the quadrotors (3 m,) [m]; see `compiled_law`."""
    m = told.shape[0] // 3
    for b in range(m):
        for x in range(3):
            told[b, x], told[m + b, x], told[2 * m + b, x] = numbers[3 * b + x], 0.0, 0.0


@kernel(LAW)
def go_along(seen, given, numbers, told):
    """The goal of `follow`, whose ``numbers`` are the paths of the quadrotors, each `counted`."""
    m, at = told.shape[0] // 3, 0
    for b in range(m):
        place, rate, second, at = motion_at(seen.t, numbers, at + 2, int(numbers[at]), numbers[at + 1] != 0.0)
        for x in range(3):
            told[b, x], told[m + b, x], told[2 * m + b, x] = place[x], rate[x], second[x]


@kernel(LAW)
def guide_net(seen, given, numbers, told):
    """The goal of `NetGuide`, whose ``numbers`` are named in `NET_NUMBERS`."""
    m, sum_of = told.shape[0] // 3, numbers[NET_SUM : NET_SUM + 3]
    pieces, has_sine = int(numbers[NET_NUMBERS + 12 * m]), numbers[NET_NUMBERS + 12 * m + 1] != 0.0
    place, velocity, acceleration, _ = motion_at(seen.t, numbers, NET_NUMBERS + 12 * m + 2, pieces, has_sine)
    if numbers[NET_CALLED] != 0.0:
        square, point, weight = 0.0, int(numbers[NET_POINT]), numbers[NET_RATE] * (seen.t - numbers[NET_TIME])
        for x in range(3):
            sum_of[x] += weight * (place[x] - seen.point[point, x])
            square += sum_of[x] * sum_of[x]
        if square > numbers[NET_REACH] * numbers[NET_REACH]:
            for x in range(3):
                sum_of[x] *= numbers[NET_REACH] / math.sqrt(square)
    numbers[NET_TIME], numbers[NET_CALLED] = seen.t, 1.0
    offsets, inverse = NET_NUMBERS, NET_NUMBERS + 3 * m
    for b in range(m):
        for x in range(3):
            k = 3 * b + x
            row = inverse + 3 * k
            shift = numbers[row] * sum_of[0] + numbers[row + 1] * sum_of[1] + numbers[row + 2] * sum_of[2]
            told[b, x] = place[x] + numbers[offsets + k] + shift
            told[m + b, x], told[2 * m + b, x] = velocity[x], acceleration[x]


@kernel(LAW)
def exert(seen, given, numbers, told):
    """The forces of `PositionControl`: frequency [rad/s], damping ratio, how much of the pull is fed forward, masses (m,) [kg]."""
    m, w = told.shape[0], numbers[0]
    stiffness, damping, share = w * w, 2.0 * numbers[1] * w, numbers[2]
    for b in range(m):
        for x in range(3):
            a = given[2 * m + b, x] + stiffness * (given[b, x] - seen.position[b, x])
            a += damping * (given[m + b, x] - seen.velocity[b, x])
            if x == 2:
                a += G
            told[b, x] = numbers[3 + b] * a - share * seen.pull[b, x]


@kernel(LAW)
def turn_to(seen, given, numbers, told):
    """Thrusts and torques of `AttitudeControl`, which turn quadrotors to forces ``given``.

    The ``numbers`` are omega_R [rad/s], zeta, cosine and sine of the heading, how much of the moment is fed forward, and the
    inertia of each quadrotor (9 m,) [kg m2].
    """
    stiffness, damping = -numbers[0] * numbers[0], -2.0 * numbers[1] * numbers[0]
    for b in range(given.shape[0]):
        R, at = seen.rotation[b], 5 + 9 * b
        J = three(numbers, at), three(numbers, at + 3), three(numbers, at + 6)
        F = row(given, b)
        x, y, z = axes_along(F, numbers[2], numbers[3])
        rx, ry, rz = (R[0, 0], R[1, 0], R[2, 0]), (R[0, 1], R[1, 1], R[2, 1]), (R[0, 2], R[1, 2], R[2, 2])
        off = 0.5 * (dot(z, ry) - dot(y, rz)), 0.5 * (dot(x, rz) - dot(z, rx)), 0.5 * (dot(y, rx) - dot(x, ry))
        W = _applied_transposed(R, row(seen.angular_velocity, b))
        wanted = (
            stiffness * off[0] + damping * W[0],
            stiffness * off[1] + damping * W[1],
            stiffness * off[2] + damping * W[2],
        )
        tau, gyroscopic, M = _applied(J, wanted), cross(W, _applied(J, W)), _applied_transposed(R, row(seen.moment, b))
        told[b, 0] = dot(F, rz)
        for i in range(3):
            told[b, 1 + i] = tau[i] + gyroscopic[i] - numbers[4] * M[i]


@kernel(void(_f2, _f3, _f2, _f2))
def command_rotors(told, sharing, limits, speed):
    """Speeds (m, 4) [rad/s] that give thrusts [N] and torques [N m], rows of ``told`` (m, 4), as far as rotors can.

    Torques come first: where a rotor would have to push down, all give more; where one would have to give too much, all give less.

    Parameters
    ----------
    sharing : (m, 4, 4) float64, inverse of the mixing matrix
    limits : (m, 2) float64, largest thrust of a rotor [N], thrust coefficient [N s2]
    """
    for b in range(speed.shape[0]):
        least, most, shares = math.inf, -math.inf, speed[b]
        for r in range(4):
            shares[r] = sharing[b, r, 0] * told[b, 0]
            for x in range(1, 4):
                shares[r] += sharing[b, r, x] * told[b, x]
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
