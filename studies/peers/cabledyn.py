"""CableDyn, a mooring code with implicit finite elements, put into air."""

import tempfile
import time
from pathlib import Path

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.scene.scene import Driven, Fixed
from studies.peers.problem import problem, raise_if_refused, unsupported, version_of

NAME = "CableDyn"
DESCRIPTION = (
    'Lines are two-node elements of the same law (springs only pull, dampers always act: our compression="damped") with '
    "consistent instead of lumped masses, which differ by the square of a segment's length, in water of next to no density, "
    "and they start from its own static equilibrium, which is ours. Each line is marched by generalised-alpha (spectral "
    "radius 0.8), yet a free junction is advanced beside the lines before they are solved, so that its only choice, and its "
    "best setting, is as small a step as one can pay for."
)

RHO_INF = 0.8  # spectral radius at infinite frequency
STEPS = (1e-3, 5e-4, 2.5e-4, 1e-4)  # [s]
CLOSE = 1e-5  # [m] between its equilibrium and the start that is asked for


def version():
    """Version of the installed engine, or None."""
    return version_of("cabledyn")


def refuses(scene):
    """Why it cannot do a scene, in one sentence, or None."""
    if not any(isinstance(point, Driven) for point in scene.points):
        return (
            "CableDyn starts every scene from its own static equilibrium, but this one has no driven point to move it from there."
        )
    x, y, z = scene.gravity
    if x or y or z >= 0:
        return "CableDyn needs gravity along -z, but the scene's does not act there."
    return unsupported(scene, NAME, compression=("none", "damped"))


def settings(scene):
    """Steps from coarse to fine; at longer ones the junction is decimetres wrong."""
    return [{"dt": dt} for dt in STEPS]


def run(scene, t_end, save_every, start=None, *, dt):
    """March a scene.

    Parameters
    ----------
    scene, t_end, save_every : as in `studies.peers.problem.problem`
    start : State, an equilibrium
    dt : float [s], step, shortened to divide what is saved

    Returns
    -------
    Outcome
    """
    raise_if_refused(refuses(scene))
    import cabledyn

    began = time.perf_counter()
    task = problem(scene, t_end, save_every, start)
    model, times = task.model, task.t
    every = float(times[1] - times[0])
    steps = max(1, int(np.ceil(every / dt - 1e-9)))
    h, q, message = every / steps, np.tile(task.q, (len(times), 1, 1)), ""
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder) / "scene.dat"
        deck.write_text(_deck(task, h))
        engine = cabledyn.CableDyn(deck)
    with engine:
        motion = _motion(task, times[0] + h * np.arange(steps * (len(times) - 1) + 1))
        at = [point.id - 1 for point in engine.points]
        blocks, names = engine.coupled_layout(), [point.name for point in scene.points]
        driven = [block for name in _driven(scene) for block, (i, _) in enumerate(blocks) if names[i - 1] == name]
        positions = np.array([point.position() for point in engine.points])[np.argsort(at)]
        off = np.abs(positions - task.q[[model.node(name) for name in names]]).max()
        if off > CLOSE or np.abs(task.v[: model.n_free]).max() > 0:
            raise InputError("Argument `start` must be the equilibrium of the scene, because CableDyn starts there, but it is not.")
        ready = time.perf_counter()
        try:
            for k in range(1, len(times)):
                for i in range((k - 1) * steps, k * steps):
                    coupled = engine.get_coupled_motion()
                    for values, row in zip(coupled, motion[i + 1], strict=True):
                        values.reshape(-1, 3)[driven] = row
                    engine.step(h, *coupled)
                for number, point in zip(at, engine.points, strict=True):
                    q[k, model.node(names[number])] = point.position()
        except cabledyn.CableDynError:
            q[k:], message = np.nan, f"CableDyn did not converge before t={times[k]:.4g} s."
        ended = time.perf_counter()
    return task.outcome(q, ended - ready, ready - began, message)


def _driven(scene):
    """Names of the driven points, in the scene's order."""
    return [point.name for point in scene.points if isinstance(point, Driven)]


def _motion(task, t):
    """Places, velocities and accelerations of the driven points, (k, 3, n_driven, 3), at the times ``t``."""
    return np.array([[path.at(time) for path in task.driven.values()] for time in t]).swapaxes(1, 2)


def _deck(task, h):
    """CableDyn's input file."""
    scene, model = task.model.scene, task.model
    rows = ["--- LINE TYPES ---", "TypeName Diam MassDenInAir EA BA EI Cd_n Cd_t Ca_n Ca_t"]
    for i, cable in enumerate(scene.cables):
        rows.append(f"type{i} 1e-6 {cable.mass_per_length!r} {cable.EA!r} {cable.axial_viscosity!r} 0 0 0 0 0")
    rows += ["--- POINTS ---", "ID Type X Y Z Mass Vol CdA Ca"]
    for i, point in enumerate(scene.points):
        kind = "Fixed" if isinstance(point, Fixed) else "Coupled" if isinstance(point, Driven) else "Free"
        x, y, z = map(float, task.q[model.node(point.name)])
        rows.append(f"{i + 1} {kind} {x!r} {y!r} {z!r} {getattr(point, 'mass', 0.0)!r} 0 0 0")
    number = {point.name: i + 1 for i, point in enumerate(scene.points)}
    rows += ["--- LINES ---", "ID LineType NodeA NodeB UnstrLen NumSegs Outputs"]
    for i, cable in enumerate(scene.cables):
        rows.append(f"{i + 1} type{i} {number[cable.start]} {number[cable.end]} {cable.length!r} {cable.segments} -")
    rows += ["--- OPTIONS ---", f"{-float(scene.gravity[2])!r} g", "1e-6 rhoW", f"{h!r} dtM", f"{h!r} TMax", f"{RHO_INF} rhoInf"]
    return "\n".join(["--- CableDyn Input File ---", "scene", *rows, "--- need this line ---", ""])
