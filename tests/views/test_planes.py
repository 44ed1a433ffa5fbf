"""What is drawn around a structure in a plane: obstacles, level grounds, water and bodies."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from anet_lumped import Body, Cable, Fixed, Free, Scene, shapes
from anet_lumped.effects import Gravity, Ground, Obstacles, Water
from anet_lumped.model.build import build
from anet_lumped.views.planes import draw_around, draw_bodies

ROPE = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=2, diameter=0.01)
POINTS = [Fixed("a", (0, 0, 0)), Free("b")]


def test_a_drum_is_a_circle_in_the_plane_across_it():
    scene = Scene(POINTS, [ROPE], [Gravity(), Obstacles(shapes.Cylinder(at=(0, 0, 1), radius=0.4, axis=(0, 1, 0)))])
    axes = Figure().subplots()
    draw_around(axes, scene, np.array([(-1.0, -1.0, -1.0), (1.0, 1.0, 2.0)]), (0, 2))
    circle = max((line.get_xydata() for line in axes.lines), key=lambda line: np.ptp(line[:, 0]))
    np.testing.assert_allclose(np.hypot(circle[:, 0], circle[:, 1] - 1.0), 0.4, rtol=1e-12)


@pytest.mark.parametrize(("plane", "heights"), [((0, 2), [-0.5, 0.5]), ((0, 1), [])])
def test_ground_and_water_are_lines_seen_from_the_side(plane, heights):
    scene = Scene(POINTS, [ROPE], [Gravity(), Ground(height=-0.5), Water(level=0.5)])
    axes = Figure().subplots()
    draw_around(axes, scene, np.array([(0.0, 0.0, -1.0), (1.0, 0.0, 1.0)]), plane)
    assert [line.get_ydata()[0] for line in axes.lines] == heights
    far = Figure().subplots()
    draw_around(far, scene, np.array([(0.0, 0.0, 5.0), (1.0, 0.0, 6.0)]), plane)
    assert not far.lines


def test_a_body_is_drawn_to_its_attachments():
    body = Body("box", mass=1.0, inertia=(0.1,) * 3, at=(0, 0, -1), attachments={"hook": (0.0, 0.0, 0.2)})
    rope = Cable("a", "box.hook", length=1.0, mass_per_length=0.1, EA=1e4, segments=2)
    model = build(Scene(POINTS[:1], [rope], [Gravity()], bodies=[body]))
    q = np.arange(3.0 * model.n).reshape(-1, 3)
    axes = Figure().subplots()
    draw_bodies(axes, model, q, (0, 2), "k")
    (lines,) = axes.collections
    np.testing.assert_array_equal(lines.get_segments(), [q[[model.node("box"), model.node("box.hook")]][:, [0, 2]]])
