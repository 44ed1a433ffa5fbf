"""MoorDyn, the open lumped-mass mooring code, put into air."""

import os
import sys
import tempfile
import time
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import numpy as np

from anet_lumped.files.moordyn_flow_writer import flow_files
from anet_lumped.files.moordyn_writer import moordyn_text
from studies.peers.problem import explicit_limit, problem, raise_if_refused, unsupported, version_of

NAME = "MoorDyn"
DESCRIPTION = (
    "Lines of the same nodes and masses in a fluid without density, so the same lumped model: springs only pull and dampers "
    'always act (our compression="damped"), and driven points move linearly between coupling steps of about 1 ms. Its best '
    "setting is Runge-Kutta 4 just below the stability limit, where its error is already small; its other schemes, explicit "
    "or iterated, diverge there or are decimetres wrong, and so does its default step."
)

RK4_LIMIT = 2.78  # of omega·dt on the imaginary axis
COUPLING = 1e-3  # [s] between two positions of a driven point


def version():
    """Version of the installed engine, or None."""
    return version_of("moordyn")


def refuses(scene):
    """Why it cannot do a scene, in one sentence, or None."""
    x, y, z = scene.gravity
    if x or y or z > 0:
        return "MoorDyn knows gravity along -z only, but the scene's points elsewhere."
    return unsupported(scene, NAME, compression=("none", "damped"))


def limit(scene):
    """Largest stable step of Runge-Kutta 4 by the bound of the axial frequencies [s]."""
    return explicit_limit(scene, RK4_LIMIT)


def settings(scene):
    """Steps from the stability limit down: coarser ones diverge."""
    return [{"dt": fraction * limit(scene)} for fraction in (0.95, 0.6, 0.3)]


def run(scene, t_end, save_every, start=None, *, dt, scheme="rk4", coupling=COUPLING):
    """March a scene.

    Parameters
    ----------
    scene, t_end, save_every, start : as in `studies.peers.problem.problem`
    dt : float [s], step, shortened to divide what is saved
    scheme : str, name of a MoorDyn time scheme
    coupling : float [s], largest time between two positions given of a driven point

    Returns
    -------
    Outcome
    """
    raise_if_refused(refuses(scene))
    import moordyn

    began = time.perf_counter()
    task = problem(scene, t_end, save_every, start)
    model, times = task.model, task.t
    with tempfile.TemporaryDirectory() as folder, silence():
        deck, state = Path(folder) / "scene.txt", Path(folder) / "state"
        deck.write_text(_deck(task, dt, scheme), encoding="utf-8")
        for name, text in flow_files(scene).items():
            deck.with_name(name).write_text(text, encoding="utf-8")
        engine = moordyn.Create(str(deck))
        if engine is None:
            raise RuntimeError("MoorDyn could not read the scene that was written for it.")
        try:
            moordyn.SetVerbosity(engine, 4)
            at = list(task.driven)
            moordyn.Init_NoIC(engine, task.q[at].ravel().tolist(), task.v[at].ravel().tolist())
            state.write_bytes(state_file(task))
            moordyn.LoadState(engine, str(state))
            lines = [moordyn.GetLine(engine, i + 1) for i in range(len(scene.cables))]
            points = [moordyn.GetPoint(engine, i + 1) for i in range(len(scene.points))]
            calls = _calls(task, dt, coupling)
            q, message = np.full((len(times), model.n, 3), np.nan), ""
            _read(moordyn, scene, model, lines, points, q[0])
            ready = time.perf_counter()
            try:
                for k, between in enumerate(calls, start=1):
                    for x, v, t, h in between:
                        moordyn.Step(engine, x, v, t, h)
                    _read(moordyn, scene, model, lines, points, q[k])
            except RuntimeError:
                message = f"MoorDyn stopped on numbers that are not finite before t={times[k]:.4g} s."
            ended = time.perf_counter()
        finally:
            moordyn.Close(engine)
    return task.outcome(q, ended - ready, ready - began, message)


def _deck(task, dt, scheme):
    """MoorDyn's input file, its points where the march starts."""
    scene, model = task.model.scene, task.model
    positions = {point.name: task.q[model.node(point.name)] for point in scene.points}
    quiet = {"writeLog": 0, "disableOutput": 1}
    return moordyn_text(scene, quiet | {"tScheme": scheme, "dtM": float(dt)}, positions)


def state_file(state):
    """Places and velocities of all nodes, of a State or a Problem, in MoorDyn's binary form, as MoorPy's exporter writes it."""
    scene, model = state.model.scene, state.model
    blocks = []
    for point in scene.points:
        node = model.node(point.name)
        free = node < model.n_free
        blocks.append(np.r_[state.q[node], state.v[node]][None] if free else np.zeros((1, 6)))
    for cable in scene.cables:
        inner = model.nodes(cable.name)[1:-1]
        blocks.append(np.hstack([state.q[inner], state.v[inner]]))
    data = b"".join(np.array(block.shape, "<u8").tobytes() + block.astype("<f8").tobytes() for block in blocks)
    return b"MoorDyn" + bytes([2, 4]) + np.array([len(data) // 8 + 1, len(blocks)], "<u8").tobytes() + data


def _calls(task, dt, coupling):
    """Arguments of MoorDyn's step for each saved interval: positions of driven points, their mean velocities, time, duration."""
    if not task.driven:
        return [[([], [], a, b - a)] for a, b in pairwise(task.t)]
    calls, between = [], dt * max(1, int(coupling / dt))
    for a, b in pairwise(task.t):
        t = np.linspace(a, b, int(np.ceil((b - a) / between - 1e-9)) + 1)
        x = task.prescribed(t)
        v = np.diff(x, axis=1) / (t[1] - t[0])
        calls.append([(x[:, i].ravel().tolist(), v[:, i].ravel().tolist(), t[i], t[1] - t[0]) for i in range(len(t) - 1)])
    return calls


def _read(moordyn, scene, model, lines, points, q):
    """Write the positions of all points, and of the nodes between, into ``q`` (n, 3)."""
    for cable, line in zip(scene.cables, lines, strict=True):
        for i, node in enumerate(model.nodes(cable.name)):
            q[node] = moordyn.GetLineNodePos(line, i)
    for point, handle in zip(scene.points, points, strict=True):
        q[model.node(point.name)] = moordyn.GetPointPos(handle)


@contextmanager
def silence():
    """Send what compiled code prints to nowhere."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = os.dup(1), os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept[0], 1)
        os.dup2(kept[1], 2)
        for handle in (*kept, nowhere):
            os.close(handle)
