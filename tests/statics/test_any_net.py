"""Rests of any net: whatever the axes and the numbering, and nets that are drawn."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hanging import assorted, cable, check, imbalance, potential_energy, strain_excess, three_supports, weight_carried
from hypothesis import Phase, given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import Fixed, Free, Scene, equilibrium
from anet_lumped.effects import Gravity


def rotation(seed):
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q * np.linalg.det(q)


def transformed(scene, *, turn=None, shift=(0.0, 0.0, 0.0), flip=False, order=None):
    """The same net turned and moved, its cables' ends swapped, its points and cables in another order."""
    turn = np.eye(3) if turn is None else turn
    points = [replace(p, at=turn @ p.at + shift) if isinstance(p, Fixed) else p for p in scene.points]
    cables = [replace(c, start=c.end, end=c.start) if flip else c for c in scene.cables]
    if order is not None:
        rng = np.random.default_rng(order)
        points, cables = ([some[i] for i in rng.permutation(len(some))] for some in (points, cables))
    g = turn @ scene.gravity
    return Scene(points, cables, [Gravity(float(np.linalg.norm(g)), tuple(g))])


@pytest.mark.each_once
@pytest.mark.parametrize("EA", [10.0, 1e6])
@pytest.mark.parametrize("name", ["one slack, odd", "tree", "two junctions", "loop", "parallel between free points"])
@pytest.mark.parametrize(
    "change",
    [{"turn": rotation(1)}, {"flip": True}, {"order": 3}, {"shift": (3.0, -2.0, 5.0)}],
    ids=["turned", "flipped", "renumbered", "moved"],
)
def test_shape_does_not_depend_on_the_axes_or_the_numbering(name, EA, change):
    scene = assorted(EA)[name]
    here, there = equilibrium(scene), equilibrium(transformed(scene, **change))
    turn, shift = change.get("turn", np.eye(3)), change.get("shift", 0.0)
    # A slack segment's place is settled by a force that is 1e-12 of the load: places agree to about its square root.
    for one in scene.cables:
        step = -1 if "flip" in change else 1
        assert there.shape(one.name)[::step] == pytest.approx(here.shape(one.name) @ turn.T + shift, abs=1e-9)
        assert there.tension(one.name)[::step] == pytest.approx(here.tension(one.name), abs=1e-8 * weight_carried(scene))


SIZES = st.floats(-0.8, 0.8).map(lambda x: round(x, 3))


@st.composite
def any_net(draw, EA, length):
    """A connected net of up to five free points: tree first, then more cables, slack or carrying."""
    supports = draw(st.lists(st.tuples(SIZES, SIZES, SIZES), min_size=1, max_size=4))
    masses = draw(st.lists(st.sampled_from([0.0, 0.01, 1.0, 100.0]), min_size=1, max_size=5))
    points = [*(Fixed(f"s{i}", at) for i, at in enumerate(supports)), *(Free(f"f{i}", m) for i, m in enumerate(masses))]
    names = [p.name for p in points]
    fixed = len(supports)
    links = [(names[draw(st.integers(0, fixed + i - 1))], names[fixed + i]) for i in range(len(masses))]
    for _ in range(draw(st.integers(0, 4))):
        a = draw(st.integers(0, len(names) - 2))
        links.append((names[a], names[draw(st.integers(a + 1, len(names) - 1))]))
    cables = [
        cable(
            *(pair if draw(st.booleans()) else pair[::-1]),
            length=draw(st.floats(*length)),
            EA=10 ** draw(st.floats(*np.log10(EA))),
            segments=draw(st.sampled_from([1, 2, 3, 5, 20, 51])),
            mu=draw(st.sampled_from([0.01, 0.1, 2.0])),
            name=f"c{i}",
        )
        for i, pair in enumerate(links)
    ]
    direction = draw(st.tuples(SIZES, SIZES, SIZES).filter(lambda d: math.hypot(*d) > 0.1))
    return Scene(points, cables, [Gravity(9.81, direction)])


@tried(150, phases=[Phase.generate])
@given(any_net(EA=(1.0, 1e9), length=(3.0, 8.0)))
def test_any_net_that_its_load_alone_stretches(scene):
    """Every cable is longer than any two supports are apart."""
    check(scene)


@tried(150, phases=[Phase.generate])
@given(any_net(EA=(1.0, 1e2), length=(0.5, 5.0)), st.integers(0, 2**32 - 1))
def test_any_soft_net_has_the_least_energy(scene, seed):
    state = check(scene)
    energy, x = potential_energy(scene, state)
    least = energy(x)[0]
    rng = np.random.default_rng(seed)
    for size in (1e-3, 1e-1, 10.0):
        other = energy(x + size * rng.normal(size=x.shape))[0]
        assert other >= least - 1e-12 * (abs(least) + abs(other))


def test_two_soft_cables_hanging_side_by_side():
    rng = np.random.default_rng(0)
    for _ in range(200):
        long = cable("p", "a", rng.uniform(1, 10), 10 ** rng.uniform(0, 1), 3)
        check(three_supports([Free("x"), Free("p", 0.01)], [cable("x", "a", EA=1.0, segments=1, mu=0.01), long]))


@pytest.mark.parametrize("EA", [1e7, 1e8, 1e9])
def test_prestressed_net(EA):
    """Three cables stretched by half and more: tensions of 1e6 to 1e9 times the load."""
    scene = three_supports([Free("p", 0.05)], [cable(a, "p", 0.4, EA) for a in "abc"])
    state = equilibrium(scene)
    force, noise = imbalance(state)
    assert force <= 1e-10 + noise
    assert strain_excess(state) <= 0.0
