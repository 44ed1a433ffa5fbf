"""The thesis's third model: rigid links in a physics engine, here MuJoCo.

Roots of the links are mocap bodies. The engine holds such a body for one that stands still, wherever it is set to: links that are
joined to it are shifted along and do not feel that it accelerates. The study shows that as a row of its own (MOCAP). In the other
way (FRAME) the links move in the frame of their supports, where the acceleration of the supports is taken off gravity. That is
exact, because all supports move alike.
"""

import copy
import time
from typing import NamedTuple

import numpy as np

from anet_lumped.files.mjcf_writer import mjcf
from anet_lumped.prescribed import paths
from studies.peers.mujoco import version
from studies.questions.three_models.cases import GRAVITY, SEGMENTS

FRAME, MOCAP = "gravity less the supports' acceleration", "supports as mocap bodies"
STEP = 0.002  # [s], the exporter's own
LAST_STEP = 1.0  # [s] of the search for the largest one
LOST = 0.1  # [m]: a run whose p0 departs more than that from the reference is not stable


class TwinRun(NamedTuple):
    """A run of the engine.

    Parameters
    ----------
    t : (k,) [s], of each step's start and of the end
    p0 : (k, 3) [m], mean of the links' ends that meet there
    energy : (3,) [J], at the start, after the ramp and at the end, in the frame of the supports; (2,) of a run within the ramp
    setup_s, run_s : float [s]
    status : "done" or "failed"
    """

    t: np.ndarray
    p0: np.ndarray
    energy: np.ndarray
    setup_s: float
    run_s: float
    status: str


def installed():
    """Whether MuJoCo is there."""
    return version() is not None


def run_twin(scene, t_end, *, flight=None, way=FRAME, dt=STEP):
    """March the rigid-link twin of a net from its rest.

    Parameters
    ----------
    scene : Scene
    t_end : float [s]
    flight : Flight of the supports, or None where they stand still
    way : FRAME or MOCAP
    dt : float [s]

    Returns
    -------
    TwinRun
    """
    import mujoco

    mujoco.set_mju_user_warning(lambda text: None)  # of a run that fails, which its status says
    try:
        return _march(mujoco, scene, t_end, flight, way, dt)
    finally:
        mujoco.set_mju_user_warning(None)


def _march(mujoco, scene, t_end, flight, way, dt):
    """`run_twin` with the engine."""
    began = time.perf_counter()
    model = mujoco.MjModel.from_xml_string(mjcf(scene, dt=dt))
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    ends = [model.site(f"{cable.name} {SEGMENTS - 1} end").id for cable in scene.cables]
    steps = int(np.ceil(t_end / dt - 1e-9))
    t = dt * np.arange(steps + 1)
    shifts, accelerations = _drive(flight, t, dt)
    held, gravity = data.mocap_pos.copy(), np.array((0.0, 0.0, -GRAVITY))
    p0, energies = np.empty((steps + 1, 3)), [_energy(mujoco, model, data)]
    after_ramp = round(flight.ramp / dt) if flight else 0
    setup = time.perf_counter() - began
    began, taken_off = time.perf_counter(), 0.0
    for k in range(steps):
        if way == FRAME:
            model.opt.gravity[:] = gravity - accelerations[k]
        else:
            data.mocap_pos[:] = held + shifts[k]
        if k == after_ramp:
            paused = time.perf_counter()
            energies.append(_energy(mujoco, model, data))
            taken_off = time.perf_counter() - paused
        mujoco.mj_step(model, data)
        p0[k] = data.site_xpos[ends].mean(axis=0)  # of the start of the step
    data.mocap_pos[:] = held + shifts[-1] * (way == MOCAP)
    mujoco.mj_kinematics(model, data)
    p0[-1] = data.site_xpos[ends].mean(axis=0)
    taken = time.perf_counter() - began - taken_off
    energies.append(_energy(mujoco, model, data))
    if way == FRAME:
        p0 += shifts
    bad = any(data.warning[getattr(mujoco.mjtWarning, f"mjWARN_BAD{what}")].number for what in ("QPOS", "QVEL", "QACC"))
    return TwinRun(t, p0, np.array(energies), setup, taken, "failed" if bad or not np.isfinite(p0).all() else "done")


def largest_step(motion, times, reference, good):
    """Largest of the steps good, twice that, ... up to which each one's run stays within LOST of the reference [s].

    Parameters
    ----------
    motion : Motion
    good : float [s], a step whose run is known to
    times, reference : (k,) [s], (k, 3) [m], of p0
    """
    dt = 2.0 * good
    while dt <= LAST_STEP:
        run = run_twin(motion.scene(), motion.flight.t_end, flight=motion.flight, dt=dt)
        until = run.t <= times[-1]
        there = np.stack([np.interp(run.t[until], times, reference[:, x]) for x in range(3)], axis=1)
        apart = np.linalg.norm(run.p0[until] - there, axis=1)
        if run.status != "done" or not apart.max() < LOST:
            break
        dt, good = 2.0 * dt, dt
    return good


def _drive(flight, t, dt):
    """Shifts [m] at times (k,) [s], and accelerations [m/s2] in the middle of the steps after them, (k, 3) each."""
    if flight is None:
        return np.zeros((len(t), 3)), np.zeros((len(t), 3))
    path = paths.line((0.0, 0.0, 0.0), flight.velocity, flight.ramp)
    return np.array([path.at(time)[0] for time in t]), np.array([path.at(time + 0.5 * dt)[2] for time in t])


def _energy(mujoco, model, data):
    """Potential and kinetic energy of the links relative to their supports, with gravity alone [J]."""
    data, gravity = copy.copy(data), model.opt.gravity.copy()
    model.opt.gravity[:] = (0.0, 0.0, -GRAVITY)
    mujoco.mj_forward(model, data)
    model.opt.gravity[:] = gravity
    return float(data.energy.sum())
