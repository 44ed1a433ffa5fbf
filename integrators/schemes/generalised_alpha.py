"""The generalised-alpha method, with the force averaged.

    (1 - alpha_m) M a+ + alpha_m M a = (1 - alpha_f) f+ + alpha_f f ,
    q+ = q + h v + h^2 [(1/2 - beta) a + beta a+] ,    v+ = v + h [(1 - gamma) a + gamma a+] ,

alpha_m = (2 rho_inf - 1)/(rho_inf + 1), alpha_f = rho_inf/(rho_inf + 1), gamma = 1/2 - alpha_m + alpha_f and
beta = (1 - alpha_m + alpha_f)^2/4. Order 2, unconditionally stable for a linear system; rho_inf is the spectral radius at
infinite frequency. Source: Chung & Hulbert, J. Appl. Mech. 60 (1993) 371.
"""

from integrators.jit import scheme_step
from integrators.linear_stability import NoLimit
from integrators.newton import newton
from integrators.stage import LAW_AT_END, Stage
from integrators.step_ends import evaluate_end
from integrators.system import DONE, FIRST_OWN, UNCONVERGED, system_at

from .record import Family, own_scheme


@scheme_step
def step(system_address, data_address, t, h, state, parameters, counts):
    """One step; memory[0] is the force and memory[1] the scheme's acceleration a, ``parameters[FIRST_OWN]`` is rho_inf."""
    system, q, v, memory = system_at(system_address), state.q, state.v, state.memory
    f, a, base, target, q_hat = memory[0], memory[1], memory[2], memory[3], memory[4]
    balanced = target  # not needed any more when this is
    rho = parameters[FIRST_OWN]
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma, beta = 0.5 - alpha_m + alpha_f, 0.25 * (1.0 - alpha_m + alpha_f) ** 2
    has_acceleration = False
    for i in range(system.n_free):
        for x in range(3):
            has_acceleration |= a[i, x] != 0.0
    if not has_acceleration:  # at the start, or at rest, where the two accelerations agree
        for i in range(system.n_free):
            for x in range(3):
                a[i, x] = f[i, x] * system.per_mass[i, x]
    tau = beta * h / gamma
    W = (1.0 - alpha_m) / ((1.0 - alpha_f) * beta * h * h)
    for i in range(system.n_free):
        for x in range(3):
            q_hat[i, x] = q[i, x] + h * v[i, x] + h * h * (0.5 - beta) * a[i, x]
            base[i, x] = q_hat[i, x] - tau * (v[i, x] + h * (1.0 - gamma) * a[i, x])
            inertia_and_force = alpha_m * a[i, x] - alpha_f * f[i, x] * system.per_mass[i, x]
            target[i, x] = q_hat[i, x] - inertia_and_force / ((1.0 - alpha_f) * W)
            q[i, x] += h * v[i, x]
    system.prescribe(t + h, data_address, q, v)
    for i in range(system.n_free, q.shape[0]):
        for x in range(3):
            base[i, x] = q[i, x] - tau * v[i, x]
    stage = Stage(LAW_AT_END, t + h, W, 1.0, tau, 0.0)
    if not newton(system_address, data_address, stage, base, target, q, parameters, counts):
        return UNCONVERGED
    for i in range(system.n_free):
        for x in range(3):
            v[i, x] = (q[i, x] - base[i, x]) / tau
            a_next = (q[i, x] - q_hat[i, x]) / (beta * h * h)
            inertia = ((1.0 - alpha_m) * a_next + alpha_m * a[i, x]) / system.per_mass[i, x]
            balanced[i, x] = (inertia - alpha_f * f[i, x]) / (1.0 - alpha_f)
            a[i, x] = a_next
    evaluate_end(system_address, data_address, t, h, state, counts)
    for i in range(system.n_free):
        for x in range(3):
            # the force that the step balanced, whose damper saw the taut part of the whole step, is what goes on
            f[i, x] = balanced[i, x]
    return DONE


GENERALISED_ALPHA = own_scheme(
    name="generalised_alpha",
    label="generalised-α",
    family=Family.ALPHA,
    order=2,
    explicit=False,
    limit=NoLimit(),
    note="stable for small motion; energy may grow without bound in large motion or when slack",
    options={"rho_inf": 0.8},
    error_constant=1 / 12,
    step=step,
    memory_rows=5,
    carried_rows=2,
)
