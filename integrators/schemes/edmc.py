"""The energy-decaying, momentum-conserving step for springs that may not push.

    v_b = 2 (q_b - q_a)/h - v_a ,      (2 M/h^2)(q_b - q_a - h v_a) = F((q_a + q_b)/2, (q_b - q_a)/h) - B^T (T e)

The tension T acts between the two times along the mean direction e: the secant of the spring energy, the damper over the
step and a numerical axial damper alpha k. Then the energy changes by -sum (T - secant)(l_b - l_a) <= 0 and the work of the
prescribed nodes, at any step, stiffness and damping; linear and angular momentum are kept. Order 2: the numerical damper is at
most alpha = (1 - rho_inf)/(1 + rho_inf)/2 s^2/(1 + s^2), s = omega h/2, with the highest frequency omega that a segment has
between the masses at its ends. Where it would take a noticeable share of the energy, it acts only as far as the length of a segment
swings to and fro from step to step. A constant alpha would be an error of order 1 in stretching. Velocities may still ring for ever
while positions are at rest; this ringing is damped after the step (`System.settle`).

Apart from the numerical damper, the error is a series in even powers of the step, so that two runs extrapolate to order 4.
Source: Simo & Tarnow, Z. angew. Math. Phys. 43 (1992) 757; Armero & Romero, Comput. Methods Appl. Mech. Engrg. 190 (2001) 6783.
"""

from integrators.flat_view import flat
from integrators.jit import scheme_step
from integrators.linear_stability import NoLimit
from integrators.newton import newton
from integrators.stage import LAW_BETWEEN, Stage
from integrators.states import copy
from integrators.system import DONE, FIRST_OWN, PUT_IN, UNCONVERGED, system_at

from .record import EnergyPromise, Family, own_scheme


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; ``parameters[FIRST_OWN]`` is rho_inf.

    memory[1] and memory[2] are the mean accelerations of the last two steps. The first guess of the positions is extrapolated from
    them, so that Newton's method needs one iteration where the motion is smooth.
    """
    system, q, v, memory, rho = system_at(system_address), state.q, state.v, state.memory, parameters[FIRST_OWN]
    base, target, energy = memory[3], memory[4], flat(memory[5])
    flat_q, flat_v, a_last, a_second_last, flat_base = flat(q), flat(v), flat(memory[1]), flat(memory[2]), flat(base)
    flat_target = flat(target)
    free, half = 3 * system.n_free, 0.5 * h * h
    for i in range(free):
        flat_base[i] = flat_q[i]
        flat_target[i] = flat_q[i] + h * flat_v[i]
        flat_q[i] = flat_target[i] + half * (2.0 * a_last[i] - a_second_last[i])
    for i in range(free, flat_q.shape[0]):
        flat_base[i] = flat_q[i]
        flat_target[i] = flat_q[i] + h * flat_v[i]
    system.prescribe(t + h, data_address, q, v)
    stage = Stage(LAW_BETWEEN, t + 0.5 * h, 2.0 / (h * h), 0.5, h, 0.5 * (1.0 - rho) / (1.0 + rho))
    if not newton(system_address, data_address, stage, base, target, q, parameters, counts):
        system.prescribe(t, data_address, q, v)
        copy(flat_base, flat_q)
        return UNCONVERGED
    per_h = 1.0 / h
    for i in range(free):
        change = 2.0 * ((flat_q[i] - flat_base[i]) * per_h - flat_v[i])
        flat_v[i] += change
        a_second_last[i] = a_last[i]
        a_last[i] = change * per_h
    system.settle(stage, base, q, v, data_address, energy)
    for k in range(4):
        state.balance[PUT_IN + k] += energy[k]  # put in; taken inside, outside and by the method
    return DONE


EDMC = own_scheme(
    name="edmc",
    label="edmc",
    family=Family.ENERGY_MOMENTUM,
    order=2,
    explicit=False,
    limit=NoLimit(),
    note="energy never rises at any step, slack or taut",
    energy=EnergyPromise.NEVER_RISES,
    keeps_angular_momentum=True,
    extrapolated_order=4,
    options={"rho_inf": 0.0},
    books_its_losses=True,
    takes_rigid_springs=True,
    evaluates_force=False,
    undoes_failed_steps=True,
    error_constant=1 / 12,
    takes_rigid_bodies=True,
    takes_inner_states=True,
    step=step,
    memory_rows=6,
    carried_rows=3,
)
