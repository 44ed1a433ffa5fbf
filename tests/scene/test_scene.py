"""Scenes: what they derive from what a user wrote, and every sentence that refuses one."""

import dataclasses
import pickle

import numpy as np
import pytest

from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.prescribed.paths import line
from anet_lumped.scene.scene import Cable, Driven, Fixed, Free, Scene, SceneError

CORD = dict(length=1.0, mass_per_length=0.1, EA=1e4, segments=20)
ENDS = (Fixed("s0", (0, 0, 0)), Free("p0"))


def cable(start="s0", end="p0", **changes):
    return Cable(start, end, **CORD | changes)


def scene(points=ENDS, cables=None, effects=()):
    return Scene(points, [cable()] if cables is None else cables, effects)


def test_segment_properties():
    cord = cable(zeta=0.05)
    assert cord.name == "s0-p0" and cord.L0 == 0.05 and cord.stiffness == pytest.approx(2e5)
    assert cord.axial_viscosity == pytest.approx(0.05 * 0.05 * np.sqrt(1e4 * 0.1))
    assert cord.dashpot == pytest.approx(cord.axial_viscosity / 0.05)
    assert cord.omega_max == pytest.approx(2 / 0.05 * np.sqrt(1e4 / 0.1))
    # The damping ratio is that of the highest mode: c·omega_max/(2k).
    assert cord.dashpot * cord.omega_max / (2 * cord.stiffness) == pytest.approx(0.05)


def test_viscosity_given_directly():
    cord = cable(BA=cable(zeta=0.3).axial_viscosity)
    assert cord.damping_ratio == pytest.approx(0.3) and cable(zeta=0.3).damping_ratio == 0.3


def test_numpy_and_lists_become_plain():
    point = Fixed("a", np.array([1, 2, 3]))
    assert point == Fixed("a", [1.0, 2.0, 3.0]) and point.at == (1.0, 2.0, 3.0) and type(point.at[0]) is float
    cord = cable(segments=np.int64(5), EA=np.float32(2))
    assert type(cord.segments) is int and type(cord.EA) is float


def test_frozen_hashable_picklable():
    net = scene((Fixed("s0", (0, 0, 0)), Driven("p0", line((0, 0, 0), (1, 0, 0), 1.0))), effects=[Gravity()])
    net.point("s0")
    assert pickle.loads(pickle.dumps(net)) == net and hash(net) == hash(pickle.loads(pickle.dumps(net)))
    with pytest.raises(dataclasses.FrozenInstanceError):
        net.points = ()


def test_look_up_by_name():
    net = scene(cables=[cable(name="left"), cable(name="right", length=2.0)])
    assert net.cable("right").length == 2.0 and net.point("p0") == Free("p0")


def test_gravity_vector():
    np.testing.assert_array_equal(scene().gravity, np.zeros(3))
    np.testing.assert_array_equal(scene(effects=[ViscousDamping(0.1)]).gravity, np.zeros(3))
    np.testing.assert_array_equal(scene(effects=[ViscousDamping(0.1), Gravity()]).gravity, [0, 0, -9.81])
    np.testing.assert_allclose(scene(effects=[Gravity(2.0, (3, 0, 4))]).gravity, [1.2, 0, 1.6], rtol=1e-15)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cable(EA=-2.0), r'Argument `EA` must be positive and finite \[N\], but cable "s0-p0" has EA=-2.0.'),
        (lambda: cable(EA=-np.inf), r"`EA` must be positive and finite \[N\].*EA=-inf"),
        (lambda: cable(EA="stiff"), r"`EA` must be positive and finite \[N\].*EA='stiff'"),
        (lambda: cable(EA=True), r"`EA` must be positive.*EA=True"),
        (lambda: cable(length=0.0), r"`length` must be positive and finite \[m\].*length=0.0"),
        (lambda: cable(mass_per_length=np.nan), r"`mass_per_length` must be positive and finite \[kg/m\].*=nan"),
        (lambda: cable(segments=0), r'`segments` must be an integer of at least 1, but cable "s0-p0" has segments=0'),
        (lambda: cable(segments=20.0), r"`segments` must be an integer of at least 1.*segments=20.0"),
        (lambda: cable(zeta=-0.1), r"`zeta` must be non-negative and finite, but .*zeta=-0.1"),
        (lambda: cable(BA=-0.1), r"`BA` must be non-negative and finite \[N·s\], but .*BA=-0.1"),
        (lambda: cable(zeta=0.1, BA=0.2), r'Only one of `zeta` and `BA` .* cable "s0-p0" has zeta=0.1 and BA=0.2'),
        (lambda: cable(compression="liner"), r"`compression` must be \"none\".*'liner', did you mean \"linear\"\?"),
        (lambda: cable(compression=3), r"`compression` must be .* has compression=3\."),
        (lambda: cable(end="s0"), r'must join two different points, but cable "s0-s0" runs from "s0" to itself'),
        (lambda: cable(start=""), r"name of a point must be a non-empty string, but is ''"),
        (lambda: cable(name=" "), r"name of a cable must be a non-empty string, but is ' '"),
        (lambda: Fixed(3, (0, 0, 0)), r"name of a point must be a non-empty string, but is 3"),
        (lambda: Fixed("a", (0, 0)), r'`at` must be three finite numbers \(x, y, z\) \[m\], but fixed point "a" has'),
        (lambda: Fixed("a", (0, 0, np.nan)), r"`at` must be three finite numbers .* has at=\(0, 0, nan\)"),
        (lambda: Fixed("a", "xyz"), r"`at` must be three finite numbers .* at='xyz'"),
        (lambda: Free("a", mass=-1), r'`mass` must be non-negative and finite \[kg\], but free point "a" has mass=-1'),
        (lambda: Free("a", at=(0, 0)), r'`at` must be three finite numbers .* free point "a" has at=\(0, 0\)'),
        (
            lambda: Driven("a", (0, 0, 0)),
            r'`path` must be made by a function of anet_lumped.paths.* driven point "a" has path=\(0, 0, 0\)',
        ),
        (lambda: scene(points=[]), r"`points` of a scene must hold Fixed, Driven or Free points, but is empty"),
        (lambda: scene(cables=[]), r"`cables` of a scene must hold at least one Cable, but is empty"),
        (lambda: scene(points=["s0"]), r"must hold Fixed, Driven or Free points, but points\[0\] is 's0'"),
        (lambda: scene(points="s0"), r"`points` of a scene must be a sequence, but is 's0'"),
        (lambda: scene(cables=cable()), r"`cables` of a scene must be a sequence, but is Cable"),
        (lambda: scene(points=[*ENDS, Free("s0")]), r'points must be unique, but two points are named "s0"'),
        (lambda: scene(cables=[cable(), cable()]), r'unique, but two cables are named "s0-p0"; give .* a `name` each'),
        (
            lambda: scene(cables=[cable(end="p1")]),
            r'`end` must name a point of the scene, but cable "s0-p1" has end="p1", did you mean "p0"\?',
        ),
        (lambda: scene(cables=[cable(start="bottle")]), r'`start` must name a point .* has start="bottle"\.'),
        (lambda: scene(points=[*ENDS, Free("p1")]), r'must hold at least one cable, but no cable ends at "p1"'),
        (lambda: scene(effects=[Gravity]), r"hold effects, such as Gravity\(\.\.\.\), but holds the class Gravity"),
        (lambda: scene(effects=[Gravity(1.0), Gravity(2.0)]), r"one effect of a type, but Gravity is given twice"),
        (lambda: scene(effects=Gravity()), r"`effects` of a scene must be a sequence"),
        (lambda: scene().point("p1"), r'The scene has no point "p1", did you mean "p0"\?'),
        (lambda: scene().cable("rope"), r'The scene has no cable "rope"; known: "s0-p0"\.'),
        (lambda: scene().point("P0"), r'The scene has no point "P0", did you mean "p0"\?'),
        (lambda: scene().point(["p0"]), r"The scene has no point \['p0'\]; known: \"s0\", \"p0\"\."),
    ],
)
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()
