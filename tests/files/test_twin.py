"""The rigid-link twin of a net, for other engines."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from anet_lumped import Body, Cable, Fixed, Free, InputError, Scene, Session, equilibrium, load_scene
from anet_lumped.effects import Gravity
from anet_lumped.files.mjcf_writer import mjcf, save_mjcf
from anet_lumped.files.rigid_twin import twin_of
from anet_lumped.files.sdf_writer import save_sdf, sdf

CORNERS = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
NET = Scene(
    [*(Fixed(f"s{i}", at) for i, at in enumerate(CORNERS)), Free("p0", mass=0.036)],
    [Cable(f"s{i}", "p0", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=20) for i in range(4)],
    [Gravity(9.81)],
)
BETWEEN = Scene(  # a cable between two free points, whose loops close there
    [*NET.points[:2], Free("a"), Free("b", mass=0.1)],
    [
        Cable(*ends, length=length, mass_per_length=0.1, EA=1e4, segments=6)
        for *ends, length in (("s0", "a", 0.6), ("s1", "b", 0.7), ("a", "b", 0.5))
    ],
    [Gravity(9.81)],
)


@pytest.mark.parametrize("scene", [NET, BETWEEN], ids=["net", "between"])
@pytest.mark.parametrize("lumped", [False, True])
def test_links_are_segments_at_rest(scene, lumped):
    rest = equilibrium(scene)
    twin = twin_of(scene, rest, lumped)
    assert len(twin.links) == sum(cable.segments for cable in scene.cables)
    assert_allclose(sum(link.mass for link in twin.links), sum(c.mass_per_length * c.length for c in scene.cables))
    assert_allclose(sum(link.load for link in twin.links), sum(p.mass for p in scene.free_points))
    ends = {link.name: link.end for link in twin.links} | twin.supports
    seen = set(twin.supports)
    for link in twin.links:
        assert link.parent in seen  # parents come first
        seen.add(link.name)
        assert_allclose(link.begin, ends[link.parent], atol=1e-9)
        length = np.linalg.norm(link.end - link.begin)
        assert_allclose(link.turn @ (length, 0.0, 0.0), link.end - link.begin, atol=1e-12)
        assert link.inertia[2] <= link.inertia[0] + link.inertia[1]
    for one, other in twin.closed:
        assert_allclose(ends[one], ends[other], atol=1e-9)
    assert len(twin.closed) == {len(NET.cables): 3}.get(len(scene.cables), 1)


@pytest.fixture
def mujoco():
    return pytest.importorskip("mujoco")


@pytest.mark.parametrize("links", ["cylinder", pytest.param("lumped", marks=pytest.mark.slow)])
@pytest.mark.parametrize("joints", ["ball", pytest.param("revolute", marks=pytest.mark.slow)])
def test_mujoco_rests_where_we_do_and_swings_as_we_do(mujoco, links, joints):
    rest = equilibrium(NET)
    model = mujoco.MjModel.from_xml_string(mjcf(NET, links, joints))
    data = mujoco.MjData(model)
    last = [f"s{i}-p0 19 end" for i in range(4)]
    for _ in range(500):
        mujoco.mj_step(model, data)
    places = np.array([data.site(name).xpos for name in last])
    assert np.abs(places - rest.position("p0")).max() < 2e-3
    assert np.ptp(places, axis=0).max() < 1e-4  # loops are closed to a tenth of a millimetre
    mujoco.mj_resetData(model, data)
    theirs, ours, body = [], [], model.body("s0-p0 19").id
    with Session(NET, dt=0.002) as session:
        for k in range(2500):
            force = (0.05, 0.0, 0.0) if k < 100 else (0.0, 0.0, 0.0)
            data.xfrc_applied[body, :3] = force
            mujoco.mj_step(model, data)
            theirs.append(data.site(last[0]).xpos[0])
            session.push("p0", force)
            session.step()
            ours.append(session.position("p0")[0])
    assert_allclose(period(theirs), period(ours), rtol=0.02)


def period(x):
    """Mean steps between upward crossings of the mean."""
    x = np.array(x[200:]) - np.mean(x[200:])
    return np.diff(np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))).mean()


def test_mujoco_takes_dampers_and_the_step_that_are_asked_for(mujoco, tmp_path):
    save_mjcf(BETWEEN, tmp_path / "twin.xml", links="lumped", joints="revolute", dt=0.001, damping=1e-4)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "twin.xml"))
    assert model.opt.timestep == 0.001 and model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert_allclose(np.ravel(model.dof_damping)[: model.nv], 1e-4)
    assert_allclose(model.eq_solref[:, 0], 0.002)
    data = mujoco.MjData(model)
    for _ in range(300):
        mujoco.mj_step(model, data)
    assert np.isfinite(data.qpos).all()


# Children of each element that is written, of which those with "!" must be there: SDFormat 1.9
SDFORMAT = {
    "sdf": "world", "world": "physics! gravity model!", "physics": "max_step_size real_time_factor",
    "model": "link! joint", "link": "pose inertial visual", "inertial": "pose mass inertia",
    "inertia": "ixx! ixy! ixz! iyy! iyz! izz!",
    "visual": "pose geometry!", "geometry": "cylinder", "cylinder": "radius! length!", "joint": "pose parent! child! axis axis2",
    "axis": "xyz! dynamics", "axis2": "xyz! dynamics", "dynamics": "damping",
}  # fmt: skip
ATTRIBUTES = {
    "sdf": {"version"}, "world": {"name"}, "physics": {"name", "type"}, "model": {"name"}, "link": {"name"}, "visual": {"name"},
    "joint": {"name", "type"},
}  # fmt: skip


def check_sdformat(element):
    """Whether an element holds what it may and must hold."""
    names = [child.tag for child in element]
    words = SDFORMAT.get(element.tag, "").split()
    assert set(names) <= {word.rstrip("!") for word in words}, element.tag
    assert {word.rstrip("!") for word in words if word.endswith("!")} <= set(names), element.tag
    assert set(element.attrib) == ATTRIBUTES.get(element.tag, set()), element.tag
    for child in element:
        check_sdformat(child)


@pytest.mark.parametrize("joints", ["ball", "revolute"])
def test_sdf_is_a_world_whose_links_meet(joints):
    root = ET.fromstring(sdf(NET, joints=joints, damping=0.0 if joints == "ball" else 1e-4))
    check_sdformat(root)
    model, links = root.find("world/model"), {}
    for link in model.iter("link"):
        pose = np.array(link.findtext("pose").split(), float)
        links[link.get("name")] = pose[:3], Rotation.from_euler("xyz", pose[3:]).as_matrix(), float(link.findtext(".//length"))
        ixx, iyy, izz = (float(link.findtext(f".//{name}")) for name in ("ixx", "iyy", "izz"))
        assert 0.0 < izz <= ixx + iyy
    assert len(links) == 80
    kinds = [joint.get("type") for joint in model.iter("joint")]
    assert kinds.count("ball" if joints == "ball" else "universal") == (83 if joints == "ball" else 80)
    for joint in model.iter("joint"):
        at, turn, _ = links[joint.findtext("child")]
        place = at + turn @ np.array(joint.findtext("pose").split()[:3], float)
        parent = joint.findtext("parent")
        if parent != "world":
            start, axes, length = links[parent]
            assert_allclose(place, start + axes @ (length, 0.0, 0.0), atol=1e-8)


def test_both_files_hold_the_same_masses(mujoco, tmp_path):
    save_sdf(NET, tmp_path / "twin.sdf", links="lumped")
    theirs = sum(float(mass.text) for mass in ET.parse(tmp_path / "twin.sdf").iter("mass"))
    model = mujoco.MjModel.from_xml_string(mjcf(NET, "lumped"))
    assert_allclose(model.body_mass.sum(), theirs, rtol=1e-5)
    assert_allclose(theirs, 0.4 + 0.036, rtol=1e-12)


def test_what_has_no_twin_is_refused_in_a_sentence():
    body = Body("b", mass=1.0, inertia=(0.1, 0.1, 0.1), at=(0.0, 0.0, 1.0))
    with pytest.raises(InputError, match="must be of a scene without bodies"):
        sdf(replace(NET, bodies=[body]))
    with pytest.raises(InputError, match=r"Argument `links` must be one of cylinder, lumped, but it is 'lump'"):
        sdf(NET, links="lump")
    with pytest.raises(InputError, match='must be "revolute"'):
        sdf(NET, damping=0.1)


def test_the_bundled_net_has_a_twin():
    assert ET.fromstring(sdf(load_scene("net_held"))).tag == "sdf"
