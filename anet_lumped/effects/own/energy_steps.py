"""Forces over a whole step as discrete gradients of a user's energy, so that no step raises it.

From positions a to b, each those of one node or of both nodes of a segment, with D = b - a,

    f = -(1 + gamma) G ,   G = (g_a + g_b)/2 + [V_b - V_a - (g_a + g_b)/2 . D] D/|D|^2 ,   g = dV/dq ,

so that G . D = V_b - V_a exactly, whatever V is: a contact that begins within the step, or one far stiffer than the step resolves.
The mean of both ends is of second order, as the gradient at the middle is, and has the right direction where the middle of the step
is not in touch, or is deeper than both ends, as on a chord of a circle. V is that of the middle of the step in time. Where the
gradients of both nodes of a segment cancel, as in a law of their difference alone, D is without their common part, so that linear
momentum is kept; angular momentum is to the second order of the step.

The bracket r has few digits where D is small. Of one that is not beyond its own rounding n only r^9/(r^8 + n^8) counts, which is
smooth: the energy is then kept to rounding, and the force has no noise of n/|D| where a body comes to rest.

gamma = 2 alpha (x_b - x_a)/(x_b + x_a) with the depth x = sqrt(max(V, 0)) is the numerical damper of
`anet_lumped.effects.laws.unresolved_contact`, for omega^2 = sum over the nodes of |g_a|^2/m over 2 V_a, which is k/m of a spring.
It takes gamma (V_b - V_a) >= 0, and the force stays along G. An energy that is not positive at the start of the step has none.
Source: Gonzalez, J. Nonlinear Sci. 6 (1996) 449, for discrete gradients.
"""

import math

from anet_lumped.compiled.dual import slope, value_of
from anet_lumped.compiled.jit import njit
from anet_lumped.effects.laws.unresolved_contact import numerical_share, settled_rate
from anet_lumped.effects.signatures import SETTLE_SIGNATURE, WHOLE_STEP_SIGNATURE

from .seeds import add, constant, position, seeded

ROUNDING = 512.0 * 2.220446049250313e-16
"""Of V and of g . q: what is less than this may be rounding. 512, since a few roundings are lost on the way to r, and of those
hardly anything is then left."""


@njit(error_model="numpy", cache=True)
def _gradient(E):
    """Gradient in the outer slopes of an energy."""
    return value_of(slope(E, 0)), value_of(slope(E, 1)), value_of(slope(E, 2))


@njit(error_model="numpy", cache=True)
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(error_model="numpy", cache=True)
def _minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(error_model="numpy", cache=True)
def _combined(x, a, y, b):
    return x * a[0] + y * b[0], x * a[1] + y * b[1], x * a[2] + y * b[2]


@njit(error_model="numpy", cache=True)
def _size(g, q):
    """Sum of |g_x q_x|: what rounding of a position leaves in an energy, over that of 1."""
    return abs(g[0] * q[0]) + abs(g[1] * q[1]) + abs(g[2] * q[2])


@njit(error_model="numpy", cache=True)
def _times(E, D):
    """Second derivatives of an energy times D by its outer slopes: a vector by the inner ones."""
    x, y, z = slope(E, 0), slope(E, 1), slope(E, 2)
    return (
        slope(x, 0) * D[0] + slope(y, 0) * D[1] + slope(z, 0) * D[2],
        slope(x, 1) * D[0] + slope(y, 1) * D[1] + slope(z, 1) * D[2],
        slope(x, 2) * D[0] + slope(y, 2) * D[1] + slope(z, 2) * D[2],
    )


@njit(error_model="numpy", cache=True)
def _transposed_times(E, D):
    """The same by the inner slopes: a vector by the outer ones."""
    x, y, z = slope(E, 0), slope(E, 1), slope(E, 2)
    return (
        slope(x, 0) * D[0] + slope(x, 1) * D[1] + slope(x, 2) * D[2],
        slope(y, 0) * D[0] + slope(y, 1) * D[1] + slope(y, 2) * D[2],
        slope(z, 0) * D[0] + slope(z, 1) * D[1] + slope(z, 2) * D[2],
    )


@njit(error_model="numpy", cache=True)
def _correction(r, rounding, square):
    """Factor c of D in G, and c_r and c_D of its change dc = c_r dr + c_D D . dD; ``square`` is |D|^2."""
    if abs(r) <= 1e-30 * rounding or square == 0.0:
        return 0.0, 0.0, 0.0
    noise = (rounding / r) ** 8
    counts = 1.0 / (1.0 + noise)
    c = r * counts / square
    return c, counts * counts * (1.0 + 9.0 * noise) / square, -2.0 * c / square


@njit(error_model="numpy", cache=True)
def _damper(damper, square, V_a, V_b):
    """gamma of the module's docstring and its derivative in V_b, for ``square`` = (omega h/2)^2."""
    if V_a <= 0.0 or damper == 0.0:
        return 0.0, 0.0
    twice, x_a = 2.0 * numerical_share(damper, square), math.sqrt(V_a)
    if V_b <= 0.0:
        return -twice, 0.0
    x_b = math.sqrt(V_b)
    per = 1.0 / (x_a + x_b)
    return twice * (x_b - x_a) * per, twice * x_a * per * per / x_b


@njit(error_model="numpy", cache=True)
def _mobility(g, mass):
    """|g|^2/m, 0 for a node that does not move, whose mass is given as 0."""
    return _dot(g, g) / mass if mass > 0.0 else 0.0


@njit(error_model="numpy", cache=True)
def _add_block(block, weight, E, c, D, of_c, G, of_gamma):
    """Add weight (H/2 + c I + D of_c^T) + G of_gamma^T, H by the outer slopes of E in rows and the inner ones in columns."""
    for x in range(3):
        row = slope(E, x)
        for y in range(3):
            block[x, y] += weight * (0.5 * slope(row, y) + D[x] * of_c[y]) + G[x] * of_gamma[y]
        block[x, x] += weight * c


@njit(error_model="numpy", cache=True)
def _add_block_transposed(block, weight, E, c, D, of_c, G, of_gamma):
    """Add weight (H/2 + c I + D of_c^T) + G of_gamma^T, H by the inner slopes of E in rows and the outer ones in columns."""
    for y in range(3):
        column = slope(E, y)
        for x in range(3):
            block[x, y] += weight * (0.5 * slope(column, x) + D[x] * of_c[y]) + G[x] * of_gamma[y]
        block[y, y] += weight * c


@njit(error_model="numpy", cache=True)
def _cancel(g_i, g_j):
    """Whether the gradients of both nodes cancel to rounding."""
    both = _combined(1.0, g_i, 1.0, g_j)
    return _dot(both, both) <= ROUNDING * ROUNDING * _dot(g_i, g_i)


def of_node_energy(law, numbers, first, each):
    """``whole_step`` and ``settle`` of law(t, q, ...) -> energy of a node [J]; see the module.

    The masses of the nodes stand behind the numbers of all elements.
    """

    @njit(WHOLE_STEP_SIGNATURE, error_model="numpy")
    def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
        given, by_method, count, half = 0.0, 0.0, index.shape[0], 0.5 * h
        for n in range(count):
            i, of, mass = index[n], numbers(params, first + each * n), params[first + each * count + n]
            a, b = position(base, i), position(q, i)
            at_a, at_b = law(t, seeded(a), *of), law(t, seeded(seeded(b)), *of)
            V_a, g_a, V_b, g_b, d = value_of(at_a), _gradient(at_a), value_of(at_b), _gradient(at_b), _minus(b, a)
            mean, rise, square = _combined(0.5, g_a, 0.5, g_b), V_b - V_a, _dot(d, d)
            c, of_r, of_d = _correction(rise - _dot(mean, d), ROUNDING * (abs(V_a) + _size(g_a, a)), square)
            G = _combined(1.0, mean, c, d)
            gamma, of_V = _damper(damper, 0.125 * h * h * _mobility(g_a, mass) / V_a if V_a > 0.0 else 0.0, V_a, V_b)
            add(f, i, -(1.0 + gamma) * G[0], -(1.0 + gamma) * G[1], -(1.0 + gamma) * G[2])
            of_c = _combined(0.5 * of_r, _minus(_minus(g_b, g_a), _times(at_b, d)), of_d, d)
            _add_block(D[i], 1.0 + gamma, at_b, c, d, of_c, G, _combined(of_V, g_b, 0.0, g_b))
            by_method += (1.0 + gamma) * _dot(G, d) - rise
            given += (law(t + half, b, *of) - V_b) + (V_a - law(t - half, a, *of))
        return -given, by_method

    @njit(SETTLE_SIGNATURE, error_model="numpy")
    def settle(t, h, damper, base, q, v, index, params):
        taken, count = 0.0, index.shape[0]
        for n in range(count):
            i, of, mass = index[n], numbers(params, first + each * n), params[first + each * count + n]
            a, b = position(base, i), position(q, i)
            E = law(t, seeded(b), *of)
            V_b, g = value_of(E), _gradient(E)
            mobility = _mobility(g, mass)
            if V_b > 0.0 and mobility > 0.0 and law(t, a, *of) > 0.0:  # the square of a slope may be too small
                v_b, d = position(v, i), _minus(b, a)
                rate = _dot(g, v_b)
                p = (rate - settled_rate(damper, 0.125 * h * h * mobility / V_b, rate, _dot(g, d) / h)) / mobility
                add(v, i, -p / mass * g[0], -p / mass * g[1], -p / mass * g[2])
                taken += p * (rate - 0.5 * p * mobility)
        return taken

    return whole_step, settle


def of_segment_energy(law, numbers, first, each):
    """``whole_step`` and ``settle`` of law(t, q0, q1, ...) -> energy of a segment [J]; see the module.

    The masses of both nodes of each element stand behind the numbers of all of them, 0 for one that does not move.
    """

    @njit(WHOLE_STEP_SIGNATURE, error_model="numpy")
    def whole_step(t, h, damper, base, q, index, params, f, D, near, far):
        given, by_method, count, half = 0.0, 0.0, index.shape[0] // 4, 0.5 * h
        for n in range(count):
            i, j, s, side = index[4 * n], index[4 * n + 1], index[4 * n + 2], index[4 * n + 3]
            of, masses = numbers(params, first + each * n), first + each * count + 2 * n
            a_i, a_j, b_i, b_j = position(base, i), position(base, j), position(q, i), position(q, j)
            E = law(t, seeded(a_i), constant(a_j), *of)
            V_a, g_ai, g_aj = value_of(E), _gradient(E), _gradient(law(t, constant(a_i), seeded(a_j), *of))
            of_i = law(t, seeded(seeded(b_i)), constant(constant(b_j)), *of)
            of_j = law(t, constant(constant(b_i)), seeded(seeded(b_j)), *of)
            mixed = law(t, seeded(constant(b_i)), constant(seeded(b_j)), *of)
            V_b, g_bi, g_bj, d_i, d_j = value_of(of_i), _gradient(of_i), _gradient(of_j), _minus(b_i, a_i), _minus(b_j, a_j)
            mean_i, mean_j, rise = _combined(0.5, g_ai, 0.5, g_bi), _combined(0.5, g_aj, 0.5, g_bj), V_b - V_a
            inner = 0.0
            if _cancel(g_ai, g_aj) and _cancel(g_bi, g_bj):
                inner, d_i = 0.5, _combined(0.5, d_i, -0.5, d_j)
                d_j = _combined(-1.0, d_i, 0.0, d_i)
            rounding = ROUNDING * (abs(V_a) + _size(g_ai, a_i) + _size(g_aj, a_j))
            c, of_r, of_d = _correction(rise - _dot(mean_i, d_i) - _dot(mean_j, d_j), rounding, _dot(d_i, d_i) + _dot(d_j, d_j))
            G_i, G_j = _combined(1.0, mean_i, c, d_i), _combined(1.0, mean_j, c, d_j)
            mobility = _mobility(g_ai, params[masses]) + _mobility(g_aj, params[masses + 1])
            gamma, of_V = _damper(damper, 0.125 * h * h * mobility / V_a if V_a > 0.0 else 0.0, V_a, V_b)
            weight = 1.0 + gamma
            add(f, i, -weight * G_i[0], -weight * G_i[1], -weight * G_i[2])
            add(f, j, -weight * G_j[0], -weight * G_j[1], -weight * G_j[2])
            turned_i = _combined(1.0, _times(of_i, d_i), 1.0, _transposed_times(mixed, d_j))
            turned_j = _combined(1.0, _times(of_j, d_j), 1.0, _times(mixed, d_i))
            c_i = _combined(0.5 * of_r, _minus(_minus(g_bi, g_ai), turned_i), of_d, d_i)
            c_j = _combined(0.5 * of_r, _minus(_minus(g_bj, g_aj), turned_j), of_d, d_j)
            gamma_i, gamma_j = _combined(of_V, g_bi, 0.0, g_bi), _combined(of_V, g_bj, 0.0, g_bj)
            if i < D.shape[0]:
                _add_block(D[i], weight, of_i, (1.0 - inner) * c, d_i, c_i, G_i, gamma_i)
            if j < D.shape[0]:
                _add_block(D[j], weight, of_j, (1.0 - inner) * c, d_j, c_j, G_j, gamma_j)
            if i < D.shape[0] and j < D.shape[0]:
                _add_block(near[s, side], weight, mixed, -inner * c, d_i, c_j, G_i, gamma_j)
                _add_block_transposed(near[s, 1 - side], weight, mixed, -inner * c, d_j, c_i, G_j, gamma_i)
            by_method += weight * (_dot(G_i, d_i) + _dot(G_j, d_j)) - rise
            given += (law(t + half, b_i, b_j, *of) - V_b) + (V_a - law(t - half, a_i, a_j, *of))
        return -given, by_method

    @njit(SETTLE_SIGNATURE, error_model="numpy")
    def settle(t, h, damper, base, q, v, index, params):
        taken, count = 0.0, index.shape[0] // 4
        for n in range(count):
            i, j, of, masses = index[4 * n], index[4 * n + 1], numbers(params, first + each * n), first + each * count + 2 * n
            m_i, m_j, b_i, b_j = params[masses], params[masses + 1], position(q, i), position(q, j)
            a_i, a_j = position(base, i), position(base, j)
            E = law(t, seeded(b_i), constant(b_j), *of)
            V_b, g_i = value_of(E), _gradient(E)
            g_j = _gradient(law(t, constant(b_i), seeded(b_j), *of))
            mobility = _mobility(g_i, m_i) + _mobility(g_j, m_j)
            if V_b > 0.0 and mobility > 0.0 and law(t, a_i, a_j, *of) > 0.0:
                v_i, v_j = position(v, i), position(v, j)
                rate = _dot(g_i, v_i) + _dot(g_j, v_j)
                mean = (_dot(g_i, _minus(b_i, a_i)) + _dot(g_j, _minus(b_j, a_j))) / h
                p = (rate - settled_rate(damper, 0.125 * h * h * mobility / V_b, rate, mean)) / mobility
                moving = 0.0
                if m_i > 0.0:
                    add(v, i, -p / m_i * g_i[0], -p / m_i * g_i[1], -p / m_i * g_i[2])
                    moving += _dot(g_i, v_i)
                if m_j > 0.0:
                    add(v, j, -p / m_j * g_j[0], -p / m_j * g_j[1], -p / m_j * g_j[2])
                    moving += _dot(g_j, v_j)
                taken += p * (moving - 0.5 * p * mobility)
        return taken

    return whole_step, settle
