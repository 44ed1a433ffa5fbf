"""The compiled functions of an effect from its law for one element, with their derivatives by dual numbers (`dual`).

Each function ``of_...`` here returns compiled functions by their slot in `signatures`. Its arguments:

law : the law, compiled
numbers(params, begin) : compiled; the law's further arguments, with those of one element from ``params[begin]`` on
first : position in ``params`` of the numbers of the first element
each : how many numbers each element has

For a law of nodes ``index`` holds the node of each element. For a law of segments it holds four numbers of each: both nodes, the
segment, and which of the two blocks ``near[segment]`` has the row of the first node and the column of the second.
"""

from anet_lumped.compiled.dual import dual, slope
from anet_lumped.compiled.jit import njit
from anet_lumped.effects.signatures import ENERGY_SIGNATURE, FORCE_SIGNATURE, TANGENT_SIGNATURE

from . import energy_steps
from .seeds import add, constant, position, seeded


@njit(error_model="numpy", cache=True)
def _subtract(block, c, f):
    """Subtract c times the slopes of a force from a block."""
    fx, fy, fz = f
    for y in range(3):
        block[0, y] -= c * slope(fx, y)
        block[1, y] -= c * slope(fy, y)
        block[2, y] -= c * slope(fz, y)


@njit(error_model="numpy", cache=True)
def _add_second(block, c, E):
    """Add c times the second derivatives of an energy to a block: outer slopes give its rows, inner slopes its columns."""
    for x in range(3):
        for y in range(3):
            block[x, y] += c * slope(slope(E, x), y)


@njit(error_model="numpy", cache=True)
def _add_second_transposed(block, c, E):
    """The same with rows and columns exchanged."""
    for x in range(3):
        for y in range(3):
            block[y, x] += c * slope(slope(E, x), y)


@njit(ENERGY_SIGNATURE, cache=True)
def no_energy(t, q, index, params):
    """The energy of a law of forces, 0 [J]."""
    return 0.0


def of_node_force(law, numbers, first, each):
    """Compiled functions of a law(t, q, v, ...) -> force on a node [N]."""

    @njit(FORCE_SIGNATURE, error_model="numpy")
    def force(t, q, v, index, params, f):
        power = 0.0
        for n in range(index.shape[0]):
            i = index[n]
            fx, fy, fz = law(t, position(q, i), position(v, i), *numbers(params, first + each * n))
            add(f, i, fx, fy, fz)
            power -= fx * v[i, 0] + fy * v[i, 1] + fz * v[i, 2]
        return power

    @njit(TANGENT_SIGNATURE, error_model="numpy")
    def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
        for n in range(index.shape[0]):
            i, own = index[n], numbers(params, first + each * n)
            _subtract(D[i], c_q, law(t, seeded(position(q, i)), constant(position(v, i)), *own))
            _subtract(D[i], c_v, law(t, constant(position(q, i)), seeded(position(v, i)), *own))

    return {"force": force, "tangent": tangent, "energy": no_energy}


def of_dead_energy(law, numbers, first, each):
    """Compiled functions of a law(t, q, ...) -> energy of a node [J] whose force does not depend on the position."""

    @njit(FORCE_SIGNATURE, error_model="numpy")
    def force(t, q, v, index, params, f):
        power = 0.0
        for n in range(index.shape[0]):
            i, own = index[n], numbers(params, first + each * n)
            E = law(t, seeded(position(q, i)), *own)
            add(f, i, -slope(E, 0), -slope(E, 1), -slope(E, 2))
            power -= slope(law(dual(t, 1.0, 0.0, 0.0), position(q, i), *own), 0)
        return power

    @njit(ENERGY_SIGNATURE, error_model="numpy")
    def energy(t, q, index, params):
        total = 0.0
        for n in range(index.shape[0]):
            total += law(t, position(q, index[n]), *numbers(params, first + each * n))
        return total

    return {"force": force, "energy": energy}


def of_node_energy(law, numbers, first, each):
    """Compiled functions of a law(t, q, ...) -> energy of a node [J]; work from outside changes it where it depends on time."""

    @njit(TANGENT_SIGNATURE, error_model="numpy")
    def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
        for n in range(index.shape[0]):
            i = index[n]
            _add_second(D[i], c_q, law(t, seeded(seeded(position(q, i))), *numbers(params, first + each * n)))

    whole_step, settle = energy_steps.of_node_energy(law, numbers, first, each)
    dead = of_dead_energy(law, numbers, first, each)
    return dead | {"tangent": tangent, "whole_step": whole_step, "settle": settle}


def of_segment_force(law, numbers, first, each):
    """Compiled functions of a law(t, q0, q1, v0, v1, ...) -> forces on both nodes of a segment [N]."""

    @njit(FORCE_SIGNATURE, error_model="numpy")
    def force(t, q, v, index, params, f):
        power = 0.0
        for n in range(index.shape[0] // 4):
            i, j = index[4 * n], index[4 * n + 1]
            on_i, on_j = law(t, position(q, i), position(q, j), position(v, i), position(v, j), *numbers(params, first + each * n))
            fx, fy, fz = on_i
            add(f, i, fx, fy, fz)
            power -= fx * v[i, 0] + fy * v[i, 1] + fz * v[i, 2]
            fx, fy, fz = on_j
            add(f, j, fx, fy, fz)
            power -= fx * v[j, 0] + fy * v[j, 1] + fz * v[j, 2]
        return power

    @njit(TANGENT_SIGNATURE, error_model="numpy")
    def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
        for n in range(index.shape[0] // 4):
            i, j, s, side = index[4 * n], index[4 * n + 1], index[4 * n + 2], index[4 * n + 3]
            own, qi, qj, vi, vj = numbers(params, first + each * n), position(q, i), position(q, j), position(v, i), position(v, j)
            near_ij, near_ji = near[s, side], near[s, 1 - side]
            if i < D.shape[0]:
                on_i, on_j = law(t, seeded(qi), constant(qj), constant(vi), constant(vj), *own)
                _subtract(D[i], c_q, on_i)
                _subtract(near_ji, c_q, on_j)
                on_i, on_j = law(t, constant(qi), constant(qj), seeded(vi), constant(vj), *own)
                _subtract(D[i], c_v, on_i)
                _subtract(near_ji, c_v, on_j)
            if j < D.shape[0]:
                on_i, on_j = law(t, constant(qi), seeded(qj), constant(vi), constant(vj), *own)
                _subtract(D[j], c_q, on_j)
                _subtract(near_ij, c_q, on_i)
                on_i, on_j = law(t, constant(qi), constant(qj), constant(vi), seeded(vj), *own)
                _subtract(D[j], c_v, on_j)
                _subtract(near_ij, c_v, on_i)

    return {"force": force, "tangent": tangent, "energy": no_energy}


def of_segment_energy(law, numbers, first, each):
    """Compiled functions of a law(t, q0, q1, ...) -> energy of a segment [J]; time in it acts as in `of_node_energy`."""

    @njit(FORCE_SIGNATURE, error_model="numpy")
    def force(t, q, v, index, params, f):
        power = 0.0
        for n in range(index.shape[0] // 4):
            i, j, own = index[4 * n], index[4 * n + 1], numbers(params, first + each * n)
            qi, qj = position(q, i), position(q, j)
            E = law(t, seeded(qi), constant(qj), *own)
            add(f, i, -slope(E, 0), -slope(E, 1), -slope(E, 2))
            E = law(t, constant(qi), seeded(qj), *own)
            add(f, j, -slope(E, 0), -slope(E, 1), -slope(E, 2))
            power -= slope(law(dual(t, 1.0, 0.0, 0.0), qi, qj, *own), 0)
        return power

    @njit(TANGENT_SIGNATURE, error_model="numpy")
    def tangent(t, q, v, index, params, c_q, c_v, D, near, far):
        for n in range(index.shape[0] // 4):
            i, j, s, side = index[4 * n], index[4 * n + 1], index[4 * n + 2], index[4 * n + 3]
            own, qi, qj = numbers(params, first + each * n), position(q, i), position(q, j)
            if i < D.shape[0]:
                _add_second(D[i], c_q, law(t, seeded(seeded(qi)), constant(constant(qj)), *own))
            if j < D.shape[0]:
                _add_second(D[j], c_q, law(t, constant(constant(qi)), seeded(seeded(qj)), *own))
            if i < D.shape[0] and j < D.shape[0]:
                E = law(t, seeded(constant(qi)), constant(seeded(qj)), *own)
                _add_second(near[s, side], c_q, E)
                _add_second_transposed(near[s, 1 - side], c_q, E)

    @njit(ENERGY_SIGNATURE, error_model="numpy")
    def energy(t, q, index, params):
        total = 0.0
        for n in range(index.shape[0] // 4):
            total += law(t, position(q, index[4 * n]), position(q, index[4 * n + 1]), *numbers(params, first + each * n))
        return total

    whole_step, settle = energy_steps.of_segment_energy(law, numbers, first, each)
    return {"force": force, "tangent": tangent, "energy": energy, "whole_step": whole_step, "settle": settle}
