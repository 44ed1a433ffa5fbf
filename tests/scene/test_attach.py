"""Points on a cable: the triangle that a weight or a float makes of a light cable."""

import numpy as np
import pytest
from hanging import G

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, attach, equilibrium, signals
from anet_lumped.effects import Bending, Gravity, LineChange, Load, Temperature, Water


def light(effects=None, **more):
    cable = Cable("a", "b", length=5.0, mass_per_length=1e-4, EA=1e7, segments=10, diameter=1e-4, **more)
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", (4, 0, 0))], [cable], [Gravity(G)] if effects is None else effects)


def corner(near, far, span):
    """Place of the corner of a triangle with two sides and the base."""
    x = (near**2 - far**2 + span**2) / (2.0 * span)
    return x, np.sqrt(near**2 - x**2)


def test_a_weight_and_a_float_make_triangles():
    """The weight of the cable is 1e-4 of the weight's, and so is the error of the place."""
    x, z = corner(2.0, 3.0, 4.0)
    scene = attach(light(), "a-b", {2.0: Free("clump", 5.0)})
    rest = equilibrium(scene)
    assert rest.position("clump") == pytest.approx((x, 0, -z), abs=1e-3)
    assert [one.name for one in scene.cables] == ["a-b[1]", "a-b[2]"] and [one.segments for one in scene.cables] == [4, 6]
    assert rest.reaction("a")[2] + rest.reaction("b")[2] == pytest.approx(G * (5.0 + 5.0e-4), rel=1e-9)
    wet = light([Gravity(G), Water(level=100.0, g=G)])
    afloat = equilibrium(attach(wet, "a-b", {2.0: Free("float", 1.0, volume=0.006)}))
    assert afloat.position("float") == pytest.approx((x, 0, z), abs=1e-3)


def test_several_in_any_order_and_what_acts_on_the_cable():
    effects = [Gravity(G), Load((0, 1, 0), ["a-b"]), Temperature({"a-b": 1e-5}, 3.0)]
    scene = attach(light(effects), "a-b", {4.0: Free("second"), 1.0: Free("first", 0.1)})
    assert [(one.start, one.end, one.length) for one in scene.cables] == [
        ("a", "first", 1),
        ("first", "second", 3),
        ("second", "b", 1),
    ]
    names = tuple(one.name for one in scene.cables)
    assert scene.effects[1].cables == names and [name for name, _ in scene.effects[2].expansion] == list(names)


@pytest.mark.parametrize(
    "scene, points, message",
    [
        (light(), {}, r'attached to cable "a-b" must be a dict of lengths to Free points, but is \{\}'),
        (light(), {1.0: 2.0}, r"must be a dict of lengths to Free points, but is \{1.0: 2.0\}"),
        (light(), {6.0: Free("c")}, r'cable "a-b" of 5 m would have a piece from 6 m to 5 m'),
        (light(), {1.0: Free("a")}, r'must be unique, but one attached to cable "a-b" is "a", too'),
        (light(), {"x": Free("c")}, r"Argument `points` must be a finite number \[m\]"),
        (light([Bending()], EI=1.0), {1.0: Free("c")}, r'passes no bending moment, but cable "a-b" bends with EI=1'),
        (light([LineChange({"a-b": signals.line(0, 0.1, 0)})]), {1.0: Free("c")}, r'cannot be paid out, but cable "a-b" is'),
    ],
)
def test_what_cannot_be_attached_is_refused(scene, points, message):
    with pytest.raises(SceneError, match=message):
        attach(scene, "a-b", points)
