"""A system without cables: two masses in a row on springs that stiffen, hung from a support that may shake.

The energy of a spring between two nodes whose difference is d is psi(s) = k s/2 + k3 s^2/4, s = d.d. A damper acts on each mass,
and a weight along z. Node 0 hangs on the support, node 2, and node 1 on node 0. All of it is written once in compiled code, for the
integrators, and once in numpy, for scipy, from the equations.
"""

from typing import NamedTuple

import numpy as np
from numba import types
from scipy.integrate import solve_ivp

from integrators.addresses import view_at, words_of
from integrators.compile_once import compile_for
from integrators.jit import njit
from integrators.schemes import scheme
from integrators.stage import LAW_BETWEEN, STAGE
from integrators.system import NO_EVENTS, System, first_class

MASS = np.array([0.7, 1.3])  # [kg]
START = (
    np.array([[0.3, 0.1, -0.2], [0.9, -0.2, 0.1], [0.0, 0.0, 0.0]]),
    np.array([[0.0, 0.8, 0.2], [0.5, 0.0, -0.6], [0.0, 0.0, 0.0]]),
)
EPS = 2.2e-16
UNKNOWN = 1e300  # force out of balance that a whole Newton step leaves


class Data(NamedTuple):
    """Numbers of the system, and what its functions leave to each other."""

    k: float  # [N/m]
    k3: float  # [N/m3]
    c: float  # [N s/m]
    g: float  # [m/s2]
    shake: float  # [m] amplitude of the support along x
    omega: float  # [rad/s] of it
    level: float  # [m] height of node 1 along x that is an event, infinite for none
    mass: np.ndarray  # (2,) [kg]
    force: np.ndarray  # (3, 3) [N] scratch
    right: np.ndarray  # (6,) [N] residual
    matrix: np.ndarray  # (6, 6) its derivative
    step: np.ndarray  # (2, 3) [m] Newton step
    shares: np.ndarray  # (1,) sum of the shares that stages had in the mean over a step


_f1, _f2 = (types.Array(types.float64, d, "C") for d in (1, 2))
_f8, _i8 = types.float64, types.int64
data_at = view_at(types.NamedTuple((_f8,) * 7 + (_f1, _f2, _f1, _f2, _f2, _f1), Data))


@njit(cache=True, error_model="numpy")
def pull(data, d_a, d_b, between, tangent):
    """Force (3,) along a spring on its second node at d_b, or between d_a and d_b; writes its derivative by d_b (3, 3)."""
    s_a, s_b = 0.0, 0.0
    for x in range(3):
        s_a, s_b = s_a + d_a[x] * d_a[x], s_b + d_b[x] * d_b[x]
    f = np.empty(3)
    for x in range(3):
        # (psi(s_b) - psi(s_a))/(s_b - s_a) times d_a + d_b, so that the work of the force is the change of energy
        secant = 0.5 * data.k + 0.25 * data.k3 * (s_a + s_b)
        f[x] = -secant * (d_a[x] + d_b[x]) if between else -(data.k + data.k3 * s_b) * d_b[x]
        for y in range(3):
            if between:
                tangent[x, y] = -0.5 * data.k3 * (d_a[x] + d_b[x]) * d_b[y] - (secant if x == y else 0.0)
            else:
                tangent[x, y] = -2.0 * data.k3 * d_b[x] * d_b[y] - (data.k + data.k3 * s_b if x == y else 0.0)
    return f


@njit(cache=True, error_model="numpy")
def prescribe(t, address, q, v):
    data = data_at(address)
    q[2, 0], v[2, 0] = data.shake * np.sin(data.omega * t), data.shake * data.omega * np.cos(data.omega * t)
    q[2, 1], q[2, 2], v[2, 1], v[2, 2] = 0.0, 0.0, 0.0, 0.0


@njit(cache=True, error_model="numpy")
def springs(data, base, q, between, f, matrix):
    """Adds the springs' forces to f (3, 3) and their derivatives to the matrix (6, 6)."""
    tangent, d_a, d_b = np.empty((3, 3)), np.empty(3), np.empty(3)
    for above, below in ((2, 0), (0, 1)):
        for x in range(3):
            d_a[x], d_b[x] = base[below, x] - base[above, x], q[below, x] - q[above, x]
        T = pull(data, d_a, d_b, between, tangent)
        for x in range(3):
            f[below, x] += T[x]
            f[above, x] -= T[x]
            for y in range(3):
                matrix[3 * below + x, 3 * below + y] += tangent[x, y]
                if above == 0:
                    matrix[x, y] += tangent[x, y]
                    matrix[x, 3 + y] -= tangent[x, y]
                    matrix[3 + x, y] -= tangent[x, y]


@njit(cache=True, error_model="numpy")
def force(t, q, v, address, f, power):
    data = data_at(address)
    for i in range(3):
        for x in range(3):
            f[i, x] = 0.0
    springs(data, q, q, False, f, data.matrix)
    power[0], power[1], power[2] = 0.0, 0.0, 0.0
    for x in range(3):
        power[2] -= f[2, x] * v[2, x]
        for i in range(2):
            f[i, x] -= data.c * v[i, x]
            power[1] += data.c * v[i, x] * v[i, x]
    for i in range(2):
        f[i, 2] -= data.mass[i] * data.g


@njit(cache=True, error_model="numpy")
def residual(stage, base, target, q, address):
    data = data_at(address)
    f, matrix, norm, scale, rounding = data.force, data.matrix, 0.0, 0.0, 0.0
    for i in range(3):
        for x in range(3):
            f[i, x] = 0.0
    for i in range(6):
        for j in range(6):
            matrix[i, j] = 0.0
    springs(data, base, q, stage.law == LAW_BETWEEN, f, matrix)
    for i in range(2):
        for x in range(3):
            inertia = data.mass[i] * stage.W
            matrix[3 * i + x, 3 * i + x] -= inertia + data.c / stage.tau
            r = inertia * (target[i, x] - q[i, x]) + f[i, x] - data.c * (q[i, x] - base[i, x]) / stage.tau
            data.right[3 * i + x] = r - (data.mass[i] * data.g if x == 2 else 0.0)
            norm, scale = max(norm, abs(data.right[3 * i + x])), max(scale, abs(f[i, x]))
            rounding = max(rounding, EPS * inertia * abs(q[i, x]))
    return norm, scale, 2.0 * (rounding + EPS * scale), norm


@njit(cache=True, error_model="numpy")
def direction(stage, address):
    """Gauss's elimination with pivots."""
    data = data_at(address)
    A, b = data.matrix, data.right
    for j in range(6):
        p = j
        for i in range(j + 1, 6):
            p = i if abs(A[i, j]) > abs(A[p, j]) else p
        for k in range(6):
            A[j, k], A[p, k] = A[p, k], A[j, k]
        b[j], b[p] = b[p], b[j]
        for i in range(j + 1, 6):
            factor = A[i, j] / A[j, j]
            b[i] -= factor * b[j]
            for k in range(j, 6):
                A[i, k] -= factor * A[j, k]
    for j in range(5, -1, -1):
        for k in range(j + 1, 6):
            b[j] -= A[j, k] * b[k]
        b[j] /= A[j, j]
        data.step[j // 3, j % 3] = -b[j]
    return 1, UNKNOWN


@njit(cache=True, error_model="numpy")
def correct(address, length, q):
    data = data_at(address)
    for i in range(2):
        for x in range(3):
            q[i, x] += length * data.step[i, x]


@njit(cache=True, error_model="numpy")
def settle(stage, base, q, v, address, energy):
    """Work of the support, and what the dampers took, of the very forces that acted between base and q."""
    data = data_at(address)
    for i in range(3):
        for x in range(3):
            data.force[i, x] = 0.0
    springs(data, base, q, True, data.force, data.matrix)
    energy[0], energy[1], energy[2], energy[3] = 0.0, 0.0, 0.0, 0.0
    for x in range(3):
        energy[0] -= data.force[2, x] * (q[2, x] - base[2, x])
        for i in range(2):
            energy[2] += data.c * (q[i, x] - base[i, x]) ** 2 / stage.tau


@njit(cache=True)
def nothing(address):
    """What `adopt` and `forget` have to do here."""


@njit(cache=True)
def remember(address, back):
    """No step leaves anything to the next."""


@njit(cache=True)
def average(address, share, h):
    data = data_at(address)
    data.shares[0] = data.shares[0] + share if share > 0.0 else 0.0


@njit(cache=True, error_model="numpy")
def notice(t, q, v, address, row, noticed):
    """How far node 1 is from node 0 at most, along x; and how many states were looked at."""
    noticed[0] = max(noticed[0], q[1, 0] - q[0, 0])
    noticed[1] += 1.0


@njit(cache=True, error_model="numpy")
def observe(t, q, v, address, row, e):
    data = data_at(address)
    row[0], row[1] = q[1, 0] - q[0, 0], data.shares[0]
    if e.shape[0] == 0:
        return
    e[0], e[1], e[2] = 0.0, 0.0, 0.0
    for above, below in ((2, 0), (0, 1)):
        s = 0.0
        for x in range(3):
            s += (q[below, x] - q[above, x]) ** 2
            e[0] += 0.5 * data.mass[below] * v[below, x] ** 2
        e[1] += 0.5 * data.k * s + 0.25 * data.k3 * s * s
        e[2] += data.mass[below] * data.g * q[below, 2]


@njit(cache=True)
def margin(q, v, address):
    data = data_at(address)
    return q[1, 0] - data.level if data.level < 1e9 else NO_EVENTS


@njit(cache=True)
def project(t, address, q, v):
    return 0.0


_FUNCTIONS = {
    "prescribe": (prescribe, (_f8, _i8, _f2, _f2)),
    "force": (force, (_f8, _f2, _f2, _i8, _f2, _f1)),
    "residual": (residual, (STAGE, _f2, _f2, _f2, _i8)),
    "direction": (direction, (STAGE, _i8)),
    "correct": (correct, (_i8, _f8, _f2)),
    "settle": (settle, (STAGE, _f2, _f2, _f2, _i8, _f1)),
    "adopt": (nothing, (_i8,)),
    "forget": (nothing, (_i8,)),
    "remember": (remember, (_i8, _i8)),
    "average": (average, (_i8, _f8, _f8)),
    "observe": (observe, (_f8, _f2, _f2, _i8, _f1, _f1)),
    "notice": (notice, (_f8, _f2, _f2, _i8, _f1, _f1)),
    "margin": (margin, (_f2, _f2, _i8)),
    "project": (project, (_f8, _i8, _f2, _f2)),
}


class Duffing:
    """The system with its numbers; it must outlive the marches that are given its address."""

    def __init__(self, k=4.0, k3=6.0, c=0.0, g=0.0, shake=0.0, omega=3.0, level=np.inf):
        zeros = np.zeros((3, 3)), np.zeros(6), np.zeros((6, 6)), np.zeros((2, 3)), np.zeros(1)
        self.data = Data(k, k3, c, g, shake, omega, level, MASS.copy(), *zeros)
        self.words = np.empty(0)
        self.words = _in_memory(self.data)
        self.address = self.words.ctypes.data
        functions = {name: first_class(compile_for(*made)) for name, made in _FUNCTIONS.items()}
        per_mass = np.repeat([*1.0 / MASS, 0.0], 3).reshape(3, 3)
        self.system = System(**functions, per_mass=per_mass, notices=1, n_free=2, largest=1e6)

    def rates(self, t, y):
        """dy/dt in numpy, for y = (q, v, work put in, dissipated) of the moving nodes."""
        d = self.data
        q, v = y[:6].reshape(2, 3), y[6:12].reshape(2, 3)
        support = np.array([d.shake * np.sin(d.omega * t), 0.0, 0.0])
        upper, lower = q[0] - support, q[1] - q[0]
        first, second = (-(d.k + d.k3 * x @ x) * x for x in (upper, lower))
        f = np.array([first - second, second]) - d.c * v - np.outer(MASS * d.g, (0, 0, 1))
        put_in = first @ np.array([d.shake * d.omega * np.cos(d.omega * t), 0.0, 0.0])
        return np.concatenate([v.ravel(), (f / MASS[:, None]).ravel(), [put_in, d.c * np.sum(v * v)]])

    def exact(self, t_end, **options):
        """scipy's solution from `START`, to its rounding: what `solve_ivp` returns."""
        y0 = np.concatenate([START[0][:2].ravel(), START[1][:2].ravel(), [0.0, 0.0]])
        return solve_ivp(self.rates, (0.0, t_end), y0, "DOP853", rtol=3e-14, atol=1e-15, **options)


def _in_memory(data):
    words = np.empty(len(words_of(data)), np.int64)
    for i, word in enumerate(words_of(data)):  # a float is a word of its own bits
        words[i : i + 1] = np.array([word]).view(np.int64)
    return words


def parameters(name, tolerance=1e-13, **options):
    """Parameters of a scheme that solves to the last digits, so that only its own error is seen."""
    return scheme(name).parameters(tolerance=tolerance, **options)
