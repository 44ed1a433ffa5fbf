"""The continuous net: single catenaries cut in two, balance of forces, loose ends, turned gravity, far starts."""

import numpy as np
import pytest
from slow import slow

from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.catenary import catenary
from anet_lumped.statics.catenary_net import CatenaryNetError, catenaries_between_ends, catenary_net

CORNERS = np.array([(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.2), (-0.5, 0.5, 0.0)])


def net(EA=1e4, mass=0.036, gravity=(0.0, 0.0, -1.0), turn=None, g=9.81):
    turn = np.eye(3) if turn is None else turn
    corners = [Fixed(f"s{i}", turn @ at) for i, at in enumerate(CORNERS)]
    return Scene(
        points=[*corners, Free("p0", mass, turn @ (0.1, 0.0, -0.5))],
        cables=[Cable(f"s{i}", "p0", length=1.0, mass_per_length=0.1, EA=EA, segments=5) for i in range(4)],
        effects=[Gravity(g, tuple(turn @ gravity))],
    )


def places(scene, **other):
    return {point.name: other.get(point.name, point.at) for point in scene.points}


def pull_on(scene, found, point):
    """Sum of the cables' pulls on a point and its weight [N]."""
    total = scene.point(point).mass * scene.gravity
    for cable in scene.cables:
        for name, pull in zip((cable.start, cable.end), found.cables[cable.name].end_forces, strict=True):
            if name == point:
                total = total + pull
    return total


@pytest.mark.each_once
@pytest.mark.parametrize("EA", [1.0, 1e2, 1e4, 1e9])
@pytest.mark.parametrize("mass", [0.0, 0.036, 10.0])
def test_pulls_balance(EA, mass):
    scene = net(EA, mass)
    found = catenary_net(scene, places(scene))
    weight = (mass + 0.4) * 9.81
    # 1e-9 of the weight is what round-off leaves when a stiff net is nearly taut.
    assert np.abs(pull_on(scene, found, "p0")).max() < 1e-9 * weight
    for cable in scene.cables:
        assert found.cables[cable.name].point([0.0, cable.length]) == pytest.approx(
            np.array([found.points[cable.start], found.points[cable.end]]), abs=1e-9 * (1 + weight / EA)
        )


@pytest.mark.parametrize("elastic", [True, False])
def test_two_cables_are_one_catenary(elastic):
    scene = Scene(
        points=[Fixed("a", (0, 0, 1)), Fixed("b", (1, 0, 1)), Free("p0", at=(0.4, 0.1, 0.3))],
        cables=[
            Cable("a", "p0", length=1.0, mass_per_length=0.1, EA=20.0, segments=5),
            Cable("p0", "b", length=1.0, mass_per_length=0.1, EA=20.0, segments=5),
        ],
        effects=[Gravity()],
    )
    found = catenary_net(scene, places(scene), elastic=elastic)
    whole = catenary((0, 0, 1), (1, 0, 1), 2.0, EA=20.0 if elastic else None, mass_per_length=0.1)
    # The inextensible net stretches by 1e-8.
    assert found.points["p0"] == pytest.approx(whole.point(1.0), abs=1e-10 if elastic else 1e-7)
    if not elastic:
        assert found.points["p0"][2] == pytest.approx(0.2036116441, abs=1e-7)  # THESIS, Table 5.1


def test_chain_of_two_junctions():
    """Cutting a catenary at two places changes nothing."""
    whole = catenary((0, 0, 0), (1, 0.5, 0.3), 1.8, EA=50.0, mass_per_length=0.1)
    free = [Free("p", at=(0.2, 0, -0.2)), Free("q", at=(0.5, 0.5, -0.2))]
    scene = Scene(
        points=[Fixed("a", (0, 0, 0)), *free, Fixed("b", (1, 0.5, 0.3))],
        cables=[
            Cable(start, end, length=0.6, mass_per_length=0.1, EA=50.0, segments=3)
            for start, end in (("a", "p"), ("q", "p"), ("q", "b"))
        ],
        effects=[Gravity()],
    )
    found = catenary_net(scene, places(scene))
    assert found.points["p"] == pytest.approx(whole.point(0.6), abs=1e-10)
    assert found.points["q"] == pytest.approx(whole.point(1.2), abs=1e-10)


@pytest.mark.each_once
@pytest.mark.parametrize("far", [(3.0, -2.0, 1.0), (-0.5, -0.5, 0.0), (0.0, 0.0, 2.0)])
@pytest.mark.parametrize("EA", [1e2, 1e9])
def test_far_start(far, EA):
    scene = net(EA)
    near = catenary_net(scene, places(scene)).points["p0"]
    assert catenary_net(scene, places(scene, p0=far)).points["p0"] == pytest.approx(near, abs=1e-8)


def test_newton_is_quadratic():
    """A wrong stiffness would still converge, but not in six steps."""
    scene = net()
    assert catenary_net(scene, places(scene)).rounds <= 6


@pytest.mark.parametrize("down", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.3, -0.5, -0.8)])
def test_turned_gravity(down):
    """The net turned with its gravity rests in the same shape, turned."""
    down = np.array(down) / np.linalg.norm(down)
    axis = np.cross((0.0, 0.0, -1.0), down)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.diag([1.0, -1.0, -1.0]) if down[2] == 1 else np.eye(3) + cross + cross @ cross / (1 - down[2])
    upright, turned = net(), net(turn=turn)
    expected = catenary_net(upright, places(upright)).points["p0"]
    found = catenary_net(turned, places(turned))
    assert found.points["p0"] == pytest.approx(turn @ expected, abs=1e-10)
    assert np.abs(pull_on(turned, found, "p0")).max() < 1e-9


def test_loose_ends_hang_straight_down():
    scene = Scene(
        points=[Fixed("a", (0, 0, 1)), Free("m", at=(0.3, 0, 0.5)), Free("e", mass=0.1, at=(0, 0, 0))],
        cables=[
            Cable("a", "m", length=1.0, mass_per_length=0.1, EA=1e3, segments=5),
            Cable("e", "m", length=0.5, mass_per_length=0.1, EA=1e3, segments=5),
        ],
        effects=[Gravity()],
    )
    found = catenary_net(scene, places(scene))
    top, bottom = found.cables["a-m"], found.cables["e-m"]
    assert bottom.tension(0.0) == pytest.approx(0.1 * 9.81)
    assert top.tension(0.0) == pytest.approx(0.25 * 9.81)
    assert found.points["e"] == pytest.approx((0, 0, 1 - top.length - bottom.length), abs=1e-14)
    assert bottom.length == pytest.approx(0.5 * (1 + 0.125 * 9.81 / 1e3))
    assert bottom.point(0.5) == pytest.approx(found.points["m"], abs=1e-14)
    assert np.abs(pull_on(scene, found, "m")).max() < 1e-12


def test_between_ends_takes_them_as_given():
    scene = net()
    found = catenaries_between_ends(scene, places(scene))
    assert found.cables["s1-p0"].point([0.0, 1.0]) == pytest.approx(np.array([CORNERS[1], (0.1, 0.0, -0.5)]), abs=1e-12)


def test_no_gravity():
    scene = net(g=0.0)
    with pytest.raises(ValueError, match="A catenary needs gravity, but the scene has no Gravity effect or g = 0"):
        catenary_net(scene, places(scene))


def test_no_balance():
    """Cables that hold on to nothing fall for ever."""
    scene = Scene(
        points=[Free("a", at=(0, 0, 0)), Free("b", at=(1, 0, 0)), Free("c", at=(0, 1, 0))],
        cables=[
            Cable(start, end, length=1.5, mass_per_length=0.1, EA=1e3, segments=5)
            for start, end in (("a", "b"), ("b", "c"), ("c", "a"))
        ],
        effects=[Gravity()],
    )
    with pytest.raises(CatenaryNetError, match="The pulls on the free points must balance, but after"):
        catenary_net(scene, places(scene))


@pytest.mark.parametrize("seed", [*range(6), *slow(*range(6, 20))])
def test_random_nets_from_random_starts(seed):
    """One to three junctions, EA from 1 N to 1e9 N, loads to 100 kg: any start must arrive."""
    rng = np.random.default_rng(seed)
    free = [f"p{i}" for i in range(rng.integers(1, 4))]
    fixed = [f"s{i}" for i in range(rng.integers(2, 5))]
    ends = [(a, b) for i, a in enumerate(free) for b in free[:i]] + [(s, rng.choice(free)) for s in fixed]
    EA = 10 ** rng.uniform(0, 9)
    scene = Scene(
        points=[Fixed(s, rng.uniform(-1, 1, 3)) for s in fixed]
        + [Free(p, rng.choice([0.0, 0.01, 1.0, 100.0]), rng.uniform(-1, 1, 3)) for p in free],
        cables=[Cable(str(a), str(b), length=rng.uniform(0.2, 3), mass_per_length=0.1, EA=EA, segments=3) for a, b in ends],
        effects=[Gravity()],
    )
    found = catenary_net(scene, places(scene))
    weight = 9.81 * (sum(scene.point(p).mass for p in free) + sum(0.1 * cable.length for cable in scene.cables))
    for p in free:
        # Stiff cables feel the last digit of a place, 1e-16 m, as EA/L times that.
        assert np.linalg.norm(pull_on(scene, found, p)) < 1e-10 * weight + 1e-14 * EA
