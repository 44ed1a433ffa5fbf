"""MuJoCo's flex: a net as one deformable object of vertices and edges, each edge a spring and a damper that pull and push.

An edge is as long at rest as between the places at which its vertices are declared. So a net is taken whose points are drawn where
its cables of one segment have their lengths, all of one stiffness and damper; its start is a displacement from there.
"""

import time

import numpy as np

from studies.peers.mujoco import RK4_LIMIT, version
from studies.peers.problem import explicit_limit, problem, raise_if_refused, unsupported

NAME = "MuJoCo, flex"
DESCRIPTION = (
    "A net is a one-dimensional flex of vertices and edges, whose springs and dampers pull and push. Its integrator `discrete` "
    "takes no such edges, and its implicit ones diverge with them at steps that they might gain by; so it runs semi-implicit Euler "
    "and Runge-Kutta 4 below their stability limits."
)
LIMITS = {"Euler": 2.0, "RK4": RK4_LIMIT}  # of omega·dt
BELOW = 0.8  # of a limit
ROUNDED = 1e-9  # of a length: by how much a cable may be longer than the distance of its points as they are drawn

__all__ = ["NAME", "refuses", "run", "settings", "version"]


def refuses(scene):
    """Why it cannot do a scene, in one sentence, or None."""
    drawn = {point.name: getattr(point, "at", None) for point in scene.points}
    for cable in scene.cables:
        a, b = drawn[cable.start], drawn[cable.end]
        if cable.segments > 1 or a is None or b is None or abs(np.linalg.norm(np.subtract(a, b)) / cable.length - 1.0) > ROUNDED:
            return f'{NAME} takes cables of one segment that are as long as they are drawn, but cable "{cable.name}" is not.'
    if len({(round(cable.stiffness, 6), round(cable.dashpot, 9)) for cable in scene.cables}) > 1:
        return f"{NAME} takes springs and dampers that are all alike, but those of this net are not."
    return unsupported(scene, NAME, compression=("none", "damped", "linear"))


def settings(scene):
    """Its explicit integrators below their limits."""
    return [{"dt": BELOW * explicit_limit(scene, reach), "integrator": name} for name, reach in LIMITS.items()]


def run(scene, t_end, save_every, start=None, *, dt, integrator):
    """March a net; arguments and what is returned as of `studies.peers.mujoco.run`."""
    raise_if_refused(refuses(scene))
    import mujoco

    began = time.perf_counter()
    task = problem(scene, t_end, save_every, start)
    n, n_free, times = task.model.n, task.model.n_free, task.t
    drawn = np.empty((n, 3))
    drawn[[task.model.node(point.name) for point in scene.points]] = [point.at for point in scene.points]
    steps = max(1, int(np.ceil((times[1] - times[0]) / dt - 1e-9)))
    engine = mujoco.MjModel.from_xml_string(_deck(task, drawn, float(times[1] - times[0]) / steps, integrator))
    bodies = engine.flex_vertbodyid[:n_free]
    engine.body_mass[bodies] = task.model.mass[:n_free]
    data = mujoco.MjData(engine)
    mujoco.mj_setConst(engine, data)
    of_nodes = engine.body_dofadr[bodies][:, None] + np.arange(3)
    data.qpos[of_nodes], data.qvel[of_nodes] = (task.q - drawn)[:n_free], task.v[:n_free]
    q, cpu = np.tile(task.q, (len(times), 1, 1)), time.process_time()
    ready = time.perf_counter()
    for k in range(1, len(times)):
        mujoco.mj_step(engine, data, steps)
        q[k, :n_free] = drawn[:n_free] + data.qpos[of_nodes]
    return task.outcome(q, time.perf_counter() - ready, ready - began, cpu_time=time.process_time() - cpu)


def _deck(task, drawn, h, integrator):
    """MuJoCo's input."""
    places = " ".join(f"{x:.17g}" for x in drawn.ravel())
    edges = " ".join(f"{a} {b}" for a, b, *_ in task.segments)
    held = " ".join(map(str, range(task.model.n_free, task.model.n)))
    gravity = " ".join(map(repr, task.model.scene.gravity.tolist()))
    _, _, _, k, c = task.segments[0]
    return (
        f'<mujoco><option timestep="{h!r}" integrator="{integrator}" gravity="{gravity}" jacobian="sparse">'
        '<flag contact="disable" constraint="disable" island="disable" autoreset="disable"/></option><worldbody>'
        f'<flexcomp name="net" type="direct" dim="1" mass="1" radius="0.001" point="{places}" element="{edges}">'
        f'<edge stiffness="{k!r}" damping="{c!r}"/><pin id="{held}"/></flexcomp></worldbody></mujoco>'
    )
