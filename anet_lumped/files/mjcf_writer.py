"""A scene as a model of MuJoCo (MJCF): its rigid-link twin, at rest."""

from os import PathLike
from typing import Any, Literal

import numpy as np

from anet_lumped.regular_files import write_text
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene

from .rigid_twin import Link, check_choices, check_twin, twin_of

IMPEDANCE = 0.99, 0.999  # of a loop's closure, from its middle to its edge; the default of 0.9 to 0.95 leaves twice the gap


def save_mjcf(
    scene: Scene,
    path: str | PathLike[str],
    links: Literal["cylinder", "lumped"] = "cylinder",
    joints: Literal["ball", "revolute"] = "ball",
    dt: float = 0.002,
    damping: float = 0.0,
) -> None:
    """Write the rigid-link twin of a scene, at its equilibrium, as a model of MuJoCo.

    Every segment is a rigid link as long as it is at rest. The places of the model are those of the equilibrium, so that it starts
    at rest. Loops are closed by `connect`, with the time constant 2 dt: the default of 0.02 s lets a net of four cables sag by
    a millimetre. The integrator is `implicitfast`; Runge-Kutta is not stable with dampers at the joints of light links.

    Supports are mocap bodies, which the engine holds for bodies at rest wherever they are set to: links do not feel that a support
    accelerates. Where all supports move alike, the acceleration of the supports taken off gravity is exact.

    Parameters
    ----------
    scene : Scene
    path : str or path, ends in .xml
    links : "cylinder", with the mass in a cylinder, or "lumped", with it at the ends, as in the model
    joints : "ball", or "revolute", two hinges across the link and each other, as in the thesis
    dt : float [s], step of the engine
    damping : float [N m s], damper of each joint

    Raises
    ------
    InputError : a word or a number that cannot be; a scene with bodies
    ModuleNotFoundError : MuJoCo is not installed
    """
    write_text(path, mjcf(scene, links, joints, dt, damping), "A model of MuJoCo")


def mjcf(scene: Scene, links: str = "cylinder", joints: str = "ball", dt: float = 0.002, damping: float = 0.0) -> str:
    """The model of `save_mjcf` as text."""
    from anet_lumped.statics.equilibrium import equilibrium

    dt, damping = check_choices(scene, links, joints, dt, damping)
    check_twin(scene)
    return _spec(scene, equilibrium(scene), links == "lumped", joints == "ball", dt, damping).to_xml()


def _spec(scene: Scene, rest: State, lumped: bool, ball: bool, dt: float, damping: float) -> Any:
    """The `mujoco.MjSpec`."""
    try:
        import mujoco
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            'A model of MuJoCo needs the package mujoco, but it is not installed; pip install "anet-lumped[mujoco]" brings it.'
        ) from None
    twin, spec = twin_of(scene, rest, lumped), mujoco.MjSpec()
    spec.modelname = "rigid-link twin"
    spec.comment = f"rigid links as long as segments at rest; joint damping {damping:g} N m s"
    spec.option.timestep, spec.option.gravity = dt, scene.gravity
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    bodies: dict[str, Any] = {}
    ends: dict[str, np.ndarray] = {}
    axes: dict[str, np.ndarray] = {}
    for name, at in twin.supports.items():
        bodies[name] = spec.worldbody.add_body(name=name, pos=at, mocap=True)
        bodies[name].add_site(name=f"{name} end")
        ends[name], axes[name] = np.zeros(3), np.eye(3)
    for link in twin.links:
        turn = axes[link.parent].T @ link.turn
        body = bodies[link.parent].add_body(name=link.name, pos=ends[link.parent], quat=_quaternion(turn))
        _add_joints(mujoco, body, link, ball, damping)
        _add_mass(mujoco, body, link)
        bodies[link.name], axes[link.name] = body, link.turn
        ends[link.name] = np.array([link.length, 0.0, 0.0])
        body.add_site(name=f"{link.name} end", pos=ends[link.name])
    for one, other in twin.closed:
        equality = spec.add_equality(
            name=f"{one} to {other}", type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_SITE,
            name1=f"{one} end", name2=f"{other} end",
        )  # fmt: skip
        equality.solref = [2.0 * dt, 1.0]
        equality.solimp[:2] = IMPEDANCE
    spec.compile()
    return spec


def _add_joints(mujoco: Any, body: Any, link: Link, ball: bool, damping: float) -> None:
    kind = mujoco.mjtJoint.mjJNT_BALL if ball else mujoco.mjtJoint.mjJNT_HINGE
    for axis in ((1.0, 0.0, 0.0),) if ball else ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        joint = body.add_joint(name=f"{link.name} {'xyz'[axis.index(1.0)]}", type=kind, axis=axis)
        joint.damping = (
            damping if np.ndim(joint.damping) == 0 else np.full_like(joint.damping, damping)
        )  # an array from version 4 on


def _add_mass(mujoco: Any, body: Any, link: Link) -> None:
    """The mass of a link and of what it carries; and its shape, which touches nothing."""
    body.explicitinertial, body.mass = True, link.whole_mass
    body.ipos, body.inertia = (link.middle, 0.0, 0.0), link.whole_inertia
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER, fromto=[0.0, 0.0, 0.0, link.length, 0.0, 0.0], size=[link.radius, 0.0, 0.0],
        mass=0.0, contype=0, conaffinity=0,
    )  # fmt: skip


def _quaternion(matrix: np.ndarray) -> np.ndarray:
    """(4,) unit quaternion (w, x, y, z) of a rotation matrix."""
    from scipy.spatial.transform import Rotation

    return np.roll(Rotation.from_matrix(matrix).as_quat(), 1)
