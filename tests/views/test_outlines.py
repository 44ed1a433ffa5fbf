"""Obstacles as pages and films draw them: where they are, and lines on their surface."""

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Scene, shapes
from anet_lumped.effects import Gravity, Obstacles
from anet_lumped.effects.laws.solid import depth, numbers_of
from anet_lumped.views.outlines import outline
from anet_lumped.views.page import _solid
from anet_lumped.views.surroundings import surroundings

BOX = np.array([(-2.0, -2.0, -2.0), (2.0, 2.0, 2.0)])
SHAPES = {
    "sphere": shapes.Sphere((0.3, 0.0, -1.6), 0.5),
    "cylinder": shapes.Cylinder((9.0, 9.0, 0.1), 0.5, axis=(1.0, 1.0, 0.0)),
    "box": shapes.Box((0.0, 0.1, 0.0), (1.0, 0.6, 0.8), (0.3, 0.4, 1.0), edge=1e-9),
}


@pytest.mark.parametrize("kind", SHAPES)
def test_lines_lie_on_the_surface(kind):
    """Within the box of the picture, wherever its origin is."""
    shape, origin = SHAPES[kind], np.array([1.0, 2.0, 3.0])
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=4, diameter=0.01)
    scene = Scene([Fixed("a", (0, 0, 1)), Fixed("b", (1, 0, 1))], [cable], [Gravity(), Obstacles(shape)])
    (solid,) = surroundings(scene, origin).obstacles
    lines = np.vstack(outline(solid, BOX - origin)) + origin
    lines = lines[np.isfinite(lines).all(axis=1)]
    params = numbers_of(shape.at, shape.solid())
    assert len(lines) > 100 and (lines >= BOX[0] - 1e-12).all() and (lines <= BOX[1] + 1e-12).all()
    assert max(abs(depth(lines, i, params, 0)) for i in range(len(lines))) < 1e-8
    assert solid.kind == kind and _solid(solid)["at"] == pytest.approx(np.array(shape.at) - origin)


def test_a_page_turns_solids_as_they_lie():
    """By its quaternion the axis of a cylinder is that of its shape; without ends it has no width along it."""
    shape = SHAPES["cylinder"]
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=4, diameter=0.01)
    scene = Scene([Fixed("a", (0, 0, 1)), Fixed("b", (1, 0, 1))], [cable], [Gravity(), Obstacles(shape)])
    drawn = _solid(surroundings(scene, np.zeros(3)).obstacles[0])
    x, y, z, w = drawn["turn"]
    axis = np.array([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)])  # of (0, 0, 1)
    np.testing.assert_allclose(axis, np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0), atol=1e-14)
    assert drawn["widths"][:2] == pytest.approx([1.0, 1.0]) and drawn["widths"][2] is None
