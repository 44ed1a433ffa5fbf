"""Drake, the toolbox of robotics: a chain of rigid links, the inextensible limit."""

import time

import numpy as np

from anet_lumped.checks import InputError, shown
from anet_lumped.scene.scene import Fixed, Free
from studies.peers.problem import problem, raise_if_refused, unsupported, version_of

NAME = "Drake"
DESCRIPTION = (
    "The hanging cable is a chain of rigid links, a segment long each, that hinge in one plane, with a node's mass at the end "
    "of each: the limit of infinite EA in the fewest coordinates, whose links push as they pull. Its best settings are its "
    "error-controlled Runge-Kutta schemes, for which such a chain is not stiff, 3 at loose accuracies and 5 at tight ones; "
    "the accuracy stands in for the step."
)

SCHEMES = ("runge_kutta3", "runge_kutta5")
ACCURACIES = ((1e-2, SCHEMES[0]), (1e-3, SCHEMES[0]), (1e-5, SCHEMES[1]), (1e-6, SCHEMES[1]), (1e-7, SCHEMES[1]))


def version():
    """Version of the installed engine, or None."""
    return version_of("drake")


def refuses(scene):
    """Why it cannot do a scene, in one sentence, or None."""
    if len(scene.cables) != 1:
        return "Drake closes no loops and moves no points in its accurate continuous mode, so it takes one cable, not a net."
    (cable,) = scene.cables
    ends = [scene.point(name) for name in (cable.start, cable.end)]
    if not (isinstance(ends[0], Fixed) and isinstance(ends[1], Free)) or len(scene.points) != 2:
        return f'Drake takes a cable that starts at a fixed point and ends at a free one, but "{cable.name}" does not.'
    return unsupported(scene, NAME, compression=("none", "damped", "linear"))


def settings(scene):
    """Accuracies asked of the integrator."""
    return [{"accuracy": accuracy, "scheme": scheme} for accuracy, scheme in ACCURACIES]


def run(scene, t_end, save_every, start=None, *, accuracy, scheme):
    """March a scene.

    Parameters
    ----------
    scene, t_end, save_every, start : as in `studies.peers.problem.problem`; in one plane with gravity, velocities are left out
    accuracy : float, relative, asked of each step
    scheme : "runge_kutta3" or "runge_kutta5"

    Returns
    -------
    Outcome
    """
    raise_if_refused(refuses(scene))
    if scheme not in SCHEMES:
        raise InputError(f"Argument `scheme` must be one of {', '.join(SCHEMES)}, but it is {shown(scheme)}.")
    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator

    began = time.perf_counter()
    task = problem(scene, t_end, save_every, start)
    nodes = task.model.nodes(scene.cables[0].name)
    along, across, angles = _plane(task.q[nodes], scene.gravity)
    plant = _chain(task, nodes, along, across)
    simulator = Simulator(plant)
    integrator = ResetIntegratorFromFlags(simulator, scheme, 0.1)
    integrator.set_target_accuracy(accuracy)
    context = simulator.get_mutable_context()
    plant.SetPositions(context, np.diff(angles, prepend=0.0))
    simulator.Initialize()
    q = np.tile(task.q, (len(task.t), 1, 1))
    length, message = scene.cables[0].L0, ""
    ready = time.perf_counter()
    for k, t in enumerate(task.t[1:] - task.t[0], start=1):
        try:
            simulator.AdvanceTo(t)
        except RuntimeError:
            q[k:], message = np.nan, f"Drake could not take a step small enough before t={task.t[k]:.4g} s."
            break
        angle = np.cumsum(plant.GetPositions(context))[:, None]
        links = length * (np.cos(angle) * along + np.sin(angle) * across)
        q[k, nodes[1:]] = task.q[nodes[0]] + np.cumsum(links, axis=0)
    ended = time.perf_counter()
    return task.outcome(q, ended - ready, ready - began, message)


def _plane(positions, gravity):
    """Unit vectors of the plane of a chain and gravity, and the angles of its links in it [rad]."""
    links = np.diff(positions, axis=0)
    directions = links / np.linalg.norm(links, axis=1)[:, None]
    along = directions[0]
    normal = np.cross(along, gravity)
    if np.linalg.norm(normal) < 1e-12 * (1.0 + np.linalg.norm(gravity)):
        normal = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    normal /= np.linalg.norm(normal)
    if np.abs(directions @ normal).max() > 1e-9:
        raise InputError("Drake's chain hinges in one plane, but the cable starts outside that of its first segment and gravity.")
    across = np.cross(normal, along)
    return along, across, np.unwrap(np.arctan2(directions @ across, directions @ along))


def _chain(task, nodes, along, across):
    """Drake's plant: links along x in a plane whose axes are x and y."""
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint, SpatialInertia, UnitInertia

    scene = task.model.scene
    length, gravity = scene.cables[0].L0, scene.gravity
    plant = MultibodyPlant(time_step=0.0)
    plant.mutable_gravity_field().set_gravity_vector([gravity @ along, gravity @ across, 0.0])
    end = np.array([length, 0.0, 0.0])
    parent, at = plant.world_frame(), np.zeros(3)
    for i, node in enumerate(nodes[1:]):
        inertia = SpatialInertia(float(task.model.mass[node]), end, UnitInertia.PointMass(end))
        body = plant.AddRigidBody(f"link{i}", inertia)
        frame = plant.AddFrame(FixedOffsetFrame(f"hinge{i}", parent, RigidTransform(at)))
        plant.AddJoint(RevoluteJoint(f"joint{i}", frame, body.body_frame(), [0.0, 0.0, 1.0]))
        parent, at = body.body_frame(), end
    plant.Finalize()
    return plant
