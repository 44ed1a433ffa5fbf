"""A scene as a world of Gazebo and other simulators that read SDFormat: its rigid-link twin, at rest.

The elements are those of SDFormat 1.9, http://sdformat.org/spec?ver=1.9.
"""

import xml.etree.ElementTree as ET
from os import PathLike
from typing import Any, Literal

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.regular_files import write_text
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene

from .rigid_twin import Link, check_choices, check_twin, twin_of

VERSION = "1.9"


def save_sdf(
    scene: Scene,
    path: str | PathLike[str],
    links: Literal["cylinder", "lumped"] = "cylinder",
    joints: Literal["ball", "revolute"] = "ball",
    dt: float = 0.002,
    damping: float = 0.0,
) -> None:
    """Write the rigid-link twin of a scene, at its equilibrium, as a world of SDFormat.

    Parameters
    ----------
    scene, links, joints, dt, damping
        As of `mjcf_writer.save_mjcf`; with revolute joints a link hangs on a `universal` joint. A ball of SDFormat has no damper.
    path : str or path, ends in .sdf

    Raises
    ------
    InputError : a word or a number that cannot be; a scene with bodies; damping of balls
    """
    write_text(path, sdf(scene, links, joints, dt, damping), "A world of SDFormat")


def sdf(scene: Scene, links: str = "cylinder", joints: str = "ball", dt: float = 0.002, damping: float = 0.0) -> str:
    """The world of `save_sdf` as text."""
    from anet_lumped.statics.equilibrium import equilibrium

    dt, damping = check_choices(scene, links, joints, dt, damping)
    if damping and joints == "ball":
        raise InputError(
            f'Joints of SDFormat with dampers must be "revolute", but damping is {damping:g} N m s and joints is "ball".'
        )
    check_twin(scene)
    root = _world(scene, equilibrium(scene), links == "lumped", joints == "ball", dt, damping)
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _world(scene: Scene, rest: State, lumped: bool, ball: bool, dt: float, damping: float) -> ET.Element:
    twin = twin_of(scene, rest, lumped)
    root = ET.Element("sdf", version=VERSION)
    world = ET.SubElement(root, "world", name="twin")
    physics = ET.SubElement(world, "physics", name="steps", type="ode")
    _text(physics, "max_step_size", dt)
    _text(physics, "real_time_factor", 1.0)
    _text(world, "gravity", *scene.gravity)
    model = ET.SubElement(world, "model", name="net")
    for link in twin.links:
        _link(model, link)
    for link in twin.links:
        parent = "world" if link.parent in twin.supports else link.parent
        _joint(model, link.name, parent, link.name, np.zeros(3), ball, damping)
    lengths = {link.name: link.length for link in twin.links}
    for one, other in twin.closed:
        end = np.array([lengths[one], 0.0, 0.0])
        _joint(model, f"{one} to {other}", "world" if other in twin.supports else other, one, end, True, 0.0)
    return root


def _link(model: ET.Element, link: Link) -> None:
    """A link in the axes of the world, with its mass, what it carries at its end, and its shape."""
    element = ET.SubElement(model, "link", name=link.name)
    _text(element, "pose", *link.begin, *_angles(link.turn))
    inertial = ET.SubElement(element, "inertial")
    _text(inertial, "pose", link.middle, 0.0, 0.0, 0.0, 0.0, 0.0)
    _text(inertial, "mass", link.whole_mass)
    inertia = ET.SubElement(inertial, "inertia")
    along, across, other = link.whole_inertia
    for name, value in dict(ixx=along, ixy=0.0, ixz=0.0, iyy=across, iyz=0.0, izz=other).items():
        _text(inertia, name, value)
    visual = ET.SubElement(element, "visual", name="shape")
    _text(visual, "pose", 0.5 * link.length, 0.0, 0.0, 0.0, 0.5 * np.pi, 0.0)  # a cylinder lies along z
    cylinder = ET.SubElement(ET.SubElement(visual, "geometry"), "cylinder")
    _text(cylinder, "radius", link.radius)
    _text(cylinder, "length", link.length)


def _joint(model: ET.Element, name: str, parent: str, child: str, at: np.ndarray, ball: bool, damping: float) -> None:
    """A joint at a place of its child."""
    element = ET.SubElement(model, "joint", name=f"{name} joint", type="ball" if ball else "universal")
    _text(element, "pose", *at, 0.0, 0.0, 0.0)
    ET.SubElement(element, "parent").text = parent
    ET.SubElement(element, "child").text = child
    for axis, direction in () if ball else (("axis", (0.0, 1.0, 0.0)), ("axis2", (0.0, 0.0, 1.0))):
        of = ET.SubElement(element, axis)
        _text(of, "xyz", *direction)
        if damping:
            _text(ET.SubElement(of, "dynamics"), "damping", damping)


def _text(parent: ET.Element, name: str, *numbers: Any) -> None:
    """An element with numbers."""
    ET.SubElement(parent, name).text = " ".join(repr(float(x)) for x in numbers)


def _angles(matrix: np.ndarray) -> np.ndarray:
    """Roll, pitch and yaw [rad], about the fixed axes x, y and z, of a rotation matrix."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(matrix).as_euler("xyz")
