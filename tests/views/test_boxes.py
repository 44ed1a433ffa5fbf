"""Bodies in pages and films: boxes that have the inertia of the body, where it is."""

import base64
import json
import re

import numpy as np
import pytest
from numpy.testing import assert_allclose

from anet_lumped import Body, Cable, Fixed, Scene, equilibrium, paths, simulate
from anet_lumped.effects import Gravity
from anet_lumped.views.boxes import EDGES, box_edges, box_of, poses
from anet_lumped.views.page import page_text


@pytest.fixture(scope="module")
def run():
    crate = Body("crate", mass=1.5, inertia=(0.02, 0.03, 0.045), at=(0.0, 0.0, -1.0), centre_of_mass=(0.1, 0.0, 0.0),
                 attachments={"eye": (0.0, 0.0, 0.1)})  # fmt: skip
    arm = Body(
        "arm", at=(0.0, 0.0, 0.0), turning=paths.line((0, 0, 0), (0, 0, 1.0), ramp=0.5), attachments={"tip": (0.5, 0.0, 0.0)}
    )
    cable = dict(length=1.0, mass_per_length=0.05, EA=1e4, zeta=0.1, segments=4)
    cables = [Cable("top", "crate.eye", **cable), Cable("arm.tip", "crate.eye", **cable)]
    scene = Scene([Fixed("top", (0.2, 0.0, 0.0))], cables, [Gravity()], bodies=[crate, arm])
    start = equilibrium(scene).moved("crate", angular_velocity=(0.0, 1.0, 2.0))
    return simulate(scene, 0.5, method="edmc", dt=0.01, start=start, save_every=0.1)


def test_a_box_has_the_inertia_of_its_body(run):
    body = run.scene.body("crate")
    box = box_of(body)
    x, y, z = box.sides
    inertia = body.mass / 12.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    assert_allclose(box.axes @ np.diag(inertia) @ box.axes.T, body.inertia_tensor, atol=1e-12)
    assert_allclose(box.middle, body.centre_of_mass)


def test_boxes_are_where_their_bodies_are(run):
    middles, axes = poses(run, run.t, run.q)
    assert_allclose(middles[:, 0], run.position("crate") + run.rotation("crate") @ (0.1, 0.0, 0.0), atol=1e-12)
    assert_allclose(np.linalg.det(axes), 1.0, atol=1e-12)
    edges = box_edges(run, run.t, run.q)
    assert edges.shape == (len(run.t), 24, 2, 3) and len(EDGES) == 12
    lengths = np.linalg.norm(edges[:, :12, 1] - edges[:, :12, 0], axis=2)
    assert_allclose(np.sort(lengths[-1]), np.sort(np.repeat(box_of(run.scene.body("crate")).sides, 4)), rtol=1e-9)
    assert_allclose(edges[:, 12:].mean(axis=(1, 2)), 0.5 * run.position("arm.tip"), atol=1e-12)


def test_the_page_holds_their_poses(run):
    page = page_text(run, "crate")
    content = json.loads(re.search(r'<script type="application/json" id="content">(.*?)</script>', page, re.S).group(1))
    assert [body["name"] for body in content["bodies"]] == ["crate", "arm"]
    found = np.frombuffer(base64.b64decode(content["states"]["bodies"]), "<f4").reshape(content["shown"], 2, 7)
    assert_allclose(np.linalg.norm(found[:, :, 3:], axis=2), 1.0, atol=1e-6)
    assert "as a box of its inertia" in page


def test_the_film_draws_them(run, tmp_path):
    run.view(tmp_path / "crate.gif")
    assert (tmp_path / "crate.gif").stat().st_size > 1000
