"""MuJoCo, the engine of robotics: point masses on slide joints, held together by tendons."""

import time

import numpy as np

from anet_lumped.checks import InputError, shown
from studies.peers.problem import explicit_limit, problem, raise_if_refused, unsupported, version_of

NAME = "MuJoCo"
DESCRIPTION = (
    "Nodes are point masses on three slide joints and segments spatial tendons, springs that only pull and dampers that "
    'always act (our compression="damped"; with "linear" the springs push too), and driven points are heavy bodies set to '
    "their path at each step. Its best setting is the `discrete` integrator, one linearised step of first order, implicit in "
    "the stretch of the tendons and so at home at any stiffness, made to factorise by a constraint that never acts, because "
    "without one it iterates and is up to thousands of times less accurate; Runge-Kutta 4 below its stability limit follows, "
    "for errors that first order cannot reach."
)

RK4_LIMIT = 2.78  # of omega·dt on the imaginary axis
HEAVY = 1e4  # [kg] of a driven point: what pulls at it for one step does not move it
ITERATIONS = 2  # of its solver: the first solves a step that is linear, the second refines
STEPS = (8e-3, 4e-3, 2e-3, 1e-3, 2.5e-4, 6.25e-5)  # [s] of the implicit integrator; sway grows at longer ones
IMPLICIT = ("discrete", "implicitfast", "implicit", "Euler")


def version():
    """Version of the installed engine, or None."""
    return version_of("mujoco")


def refuses(scene):
    """Why it cannot do a scene, in one sentence, or None."""
    return unsupported(scene, NAME, compression=("none", "damped", "linear"))


def limit(scene):
    """Largest stable step of Runge-Kutta 4 by the bound of the axial frequencies [s]."""
    return explicit_limit(scene, RK4_LIMIT)


def settings(scene):
    """Steps of the implicit integrator, then the explicit one at its limit and below."""
    implicit = [{"dt": dt, "integrator": "discrete"} for dt in STEPS]
    return implicit + [{"dt": fraction * limit(scene), "integrator": "RK4"} for fraction in (0.95, 0.5)]


def run(scene, t_end, save_every, start=None, *, dt, integrator):
    """March a scene.

    Parameters
    ----------
    scene, t_end, save_every, start : as in `studies.peers.problem.problem`
    dt : float [s], step, shortened to divide what is saved
    integrator : "discrete", "RK4", "implicitfast", "implicit" or "Euler"

    Returns
    -------
    Outcome
    """
    raise_if_refused(refuses(scene))
    if integrator not in (*IMPLICIT, "RK4"):
        raise InputError(f"Argument `integrator` must be one of {', '.join((*IMPLICIT, 'RK4'))}, but it is {shown(integrator)}.")
    import mujoco

    began = time.perf_counter()
    task = problem(scene, t_end, save_every, start)
    n, times = task.model.n, task.t
    steps = max(1, int(np.ceil((times[1] - times[0]) / dt - 1e-9)))
    h = float(times[1] - times[0]) / steps
    engine = mujoco.MjModel.from_xml_string(_deck(task, h, integrator))
    data = mujoco.MjData(engine)
    moving = [i for i in range(n) if i < task.model.n_free or i in task.driven]
    data.qvel[: 3 * len(moving)] = task.v[moving].ravel()
    drive = _drive(task, h, steps * (len(times) - 1), integrator == "RK4")
    driven = slice(3 * task.model.n_free, 3 * len(moving))
    q = np.tile(task.q, (len(times), 1, 1))
    broken = [getattr(mujoco.mjtWarning, f"mjWARN_BAD{what}") for what in ("QPOS", "QVEL", "QACC")]
    message = ""
    mujoco.set_mju_user_warning(lambda text: None)  # the few iterations that are taken draw one at each step
    try:
        ready, cpu = time.perf_counter(), time.process_time()
        for k in range(1, len(times)):
            if drive is None:
                mujoco.mj_step(engine, data, steps)
            else:
                position, velocity, force = drive
                for i in range((k - 1) * steps, k * steps):
                    data.qpos[driven], data.qvel[driven], data.qfrc_applied[driven] = position[i], velocity[i], force[i]
                    mujoco.mj_step(engine, data)
            q[k, moving] = data.qpos[: 3 * len(moving)].reshape(-1, 3) + task.q[moving]
            if any(data.warning[kind].number for kind in broken):
                q[k], message = np.nan, f"MuJoCo met numbers that are huge or not finite before t={times[k]:.4g} s."
                break
        ended, cpu = time.perf_counter(), time.process_time() - cpu
    finally:
        mujoco.set_mju_user_warning(None)
    return task.outcome(q[: k + 1], ended - ready, ready - began, message, cpu)


def _deck(task, h, integrator):
    """MuJoCo's input: coordinates are displacements from the start."""
    model, scene = task.model, task.model.scene
    gravity = " ".join(repr(float(x)) for x in scene.gravity)
    rows = [
        f'<mujoco><option timestep="{h!r}" integrator="{integrator}" gravity="{gravity}" solver="Newton" jacobian="sparse" '
        f'tolerance="0" iterations="{ITERATIONS}"><flag contact="disable" autoreset="disable" island="disable"/></option>'
        "<worldbody>"
    ]
    for i, position in enumerate(task.q):
        site = f'<site name="n{i}"/>'
        moves, mass = i < model.n_free or i in task.driven, HEAVY if i in task.driven else float(model.mass[i])
        at = " ".join(repr(float(x)) for x in position)
        rows.append(f'<body pos="{at}" gravcomp="{int(i in task.driven)}">{site}')
        if moves:
            rows += [f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1")]
            rows.append(f'<inertial pos="0 0 0" mass="{mass!r}" diaginertia="1e-6 1e-6 1e-6"/>')
        rows.append("</body>")
    if integrator == "discrete":
        rows.append('<body><joint name="idle" type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>')
        rows.append("</body>")
    rows.append("</worldbody>")
    if integrator == "discrete":
        rows.append('<equality><joint joint1="idle"/></equality>')
    rows.append("<tendon>")
    pushes = [scene.cables[c].compression == "linear" for c in model.cable_of]
    for (a, b, L0, k, c), push in zip(task.segments, pushes, strict=True):
        rest = f"{L0!r}" if push else f"0 {L0!r}"
        rows.append(
            f'<spatial stiffness="{k!r}" damping="{c!r}" springlength="{rest}"><site site="n{a}"/><site site="n{b}"/></spatial>'
        )
    return "".join([*rows, "</tendon></mujoco>"])


def _drive(task, h, steps, explicit):
    """Displacements, velocities and forces of the driven points at each step (steps, 3·n_driven), or None."""
    if not task.driven:
        return None
    t = task.t[0] + h * np.arange(steps + 1)
    at = np.array([[path.at(time)[:2] for path in task.driven.values()] for time in t])  # (steps + 1, n_driven, 2, 3)
    q, v = at[:, :, 0].reshape(steps + 1, -1), at[:, :, 1].reshape(steps + 1, -1)
    reached = v[1:] if explicit else np.diff(q, axis=0) / h  # the velocity that takes it to its next position
    return q[:-1] - task.q[list(task.driven)].ravel(), v[:-1], HEAVY * (reached - v[:-1]) / h
