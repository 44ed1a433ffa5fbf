"""Cables that are laid down over solids on a ground lie on them, and are not caught under them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, EquilibriumError, Fixed, Scene, equilibrium, nets
from anet_lumped.effects import Bending, Gravity, Ground, Obstacles
from anet_lumped.effects.shapes import Cylinder, Sphere
from anet_lumped.statics import search

G, WEIGHT = 9.81, 5.0  # [m/s2], [kg/m]


def over_a_pipe(EA, sunk=0.0, height=0.0, length=26.0, radius=1.5):
    """A cable of 20 m from one support on the ground to the other, across a pipe whose axis is ``sunk`` radii under the ground."""
    cable = Cable("a", "b", length=length, mass_per_length=WEIGHT, EA=EA, segments=52, diameter=0.05)
    pipe = Cylinder((8.0, 0.0, -sunk * radius), radius, (0.0, 1.0, 0.0))
    ends = [Fixed("a", (0.0, 0.0, 0.0)), Fixed("b", (20.0, 0.0, height))]
    return Scene(ends, [cable], [Gravity(G), Ground(), Obstacles(pipe)])


def check_over(rest, axis_height, radius=1.5):
    """A node is above the pipe, no contact carries more than the load, and T - w z is constant: no surface rubs, by Bernoulli."""
    q, load = rest.shape("a-b"), WEIGHT * G * rest.scene.cables[0].length
    near = np.abs(q[:, 0] - 8.0) < 0.5 * radius
    assert near.any() and (q[near, 2] > axis_height).all()
    assert all(np.linalg.norm(effect.force_on(rest), axis=1).max() < load for effect in rest.scene.effects[1:])
    constant = rest.tension("a-b") - WEIGHT * G * 0.5 * (q[1:, 2] + q[:-1, 2])
    assert np.ptp(constant) < 0.02 * load  # what the turns between segments of half a metre leave


@pytest.mark.parametrize("EA", [1e7, math.inf])
@pytest.mark.parametrize(("sunk", "height"), [(0.0, 0.0), (0.5, 0.0), (-0.6, 3.0), (0.3, 6.0)])
def test_a_cable_lies_over_a_pipe_on_a_bed(EA, sunk, height):
    """It was under the pipe, between it and the bed, and carried up to 700 kN in place of 140 N."""
    rest = equilibrium(over_a_pipe(EA, sunk, height))
    assert rest.stable
    check_over(rest, -sunk * 1.5)


@pytest.mark.parametrize("EA", [1e6, 1e7])
def test_a_cable_that_bends_and_pushes_lies_over_a_pipe(EA):
    """It lies down aside of the plane of its supports: in the plane it came to rest in folds, or under the pipe."""
    scene = over_a_pipe(EA)
    cable = replace(scene.cables[0], EI=300.0, compression="linear")
    rest = equilibrium(replace(scene, cables=[cable], effects=[*scene.effects, Bending()]))
    q, load = rest.shape("a-b"), WEIGHT * G * cable.length
    near = np.abs(q[:, 0] - 8.0) < 0.75
    assert rest.stable and near.any() and (q[near, 2] > 0.0).all()
    assert all(np.linalg.norm(effect.force_on(rest), axis=1).max() < load for effect in rest.scene.effects[1:3])


@pytest.mark.parametrize(
    ("length", "weight", "segments", "span", "axis", "radius"),
    [(78.8, 1.19, 165, 61.4, (26.4, 0.44), 1.07), (74.6, 12.5, 187, 57.2, (17.6, 0.46), 0.89)],
)
def test_a_long_cable_that_bends_slides_to_its_rest(length, weight, segments, span, axis, radius):
    """A millionth of its load moves its loops on the bed by metres, and bends them out of the plane: such were refused."""
    cable = Cable(
        "a", "b", length=length, mass_per_length=weight, EA=1e6, EI=30.0, segments=segments, diameter=0.05, compression="linear"
    )  # fmt: skip
    pipe, bed = Obstacles(Cylinder((axis[0], 0.0, axis[1]), radius, (0.0, 1.0, 0.0))), Ground()
    rest = equilibrium(
        Scene([Fixed("a", (0.0, 0.0, 0.0)), Fixed("b", (span, 0.0, 0.0))], [cable], [Gravity(G), Bending(), bed, pipe])
    )
    q, load = rest.shape("a-b"), weight * G * length
    near = np.abs(q[:, 0] - axis[0]) < 0.5 * radius
    assert rest.stable and rest.residual < 1e-9
    assert near.any() and (q[near, 2] > axis[1]).all() and q[:, 2].min() > -0.01
    carried = sum(rest.reaction(name)[2] for name in "ab") - sum(one.force_on(rest)[:, 2].sum() for one in (bed, pipe))
    assert abs(carried) == pytest.approx(load, rel=1e-6)


def test_a_start_under_the_pipe_does_not_stay_there():
    scene = over_a_pipe(1e7)
    x = np.linspace(0.0, 20.0, 53)
    under = np.stack([x, 0.0 * x, -3.0 * np.sin(np.pi * x / 20.0)], axis=1)
    check_over(equilibrium(scene, start={"a-b": under}), 0.0)


def test_a_cable_that_hangs_free_under_a_pipe_stays_there():
    """No ground lifts it: the pipe above it is not met."""
    scene = over_a_pipe(1e7, sunk=2.0, height=0.0)
    hanging = equilibrium(Scene(scene.points, scene.cables, [Gravity(G)]))
    above = Obstacles(Cylinder((10.0, 0.0, -1.5), 1.0, (0.0, 1.0, 0.0)))
    rest = equilibrium(Scene(scene.points, scene.cables, [Gravity(G), above]))
    np.testing.assert_allclose(rest.q, hanging.q, atol=1e-9)


def test_a_rest_that_is_caught_is_refused(monkeypatch):
    """Where no other start is tried: with the place, and with how hard it is pressed."""
    monkeypatch.setattr(search, "_attempts", lambda model, net, hanging, *others: iter([search._Attempt(hanging)]))
    with pytest.raises(EquilibriumError, match=r"must not be caught .* node \d+ of 52 of cable \"a-b\" at \(.*pressed by \d"):
        equilibrium(over_a_pipe(1e7))


@pytest.mark.parametrize("EA", [1e5, math.inf])
def test_a_net_lies_over_a_pipe_on_a_bed(EA):
    """A node is above the pipe wherever it crosses it, and the ground, the pipe and the corners carry the whole weight."""
    own = {"mass_per_length": 0.3, "EA": EA, "segments": 3, "diameter": 0.02}
    corners = ((0.0, 0.0, 0.0), (6.0, 0.0, 0.0), (6.0, 6.0, 0.0), (0.0, 6.0, 0.0))
    parts = nets.grid((6, 6), corners, cable=own, slack=0.15, knot_mass=0.05)
    pipe = Cylinder((3.1, 3.0, 0.2), 0.6, (0.0, 1.0, 0.0))
    rest = equilibrium(Scene(parts.points, parts.cables, [Gravity(G), Ground(), Obstacles(pipe)]))
    load = G * (sum(cable.mass_per_length * cable.length for cable in parts.cables) + 0.05 * 45)
    near = np.abs(rest.q[:, 0] - 3.1) < 0.3
    assert rest.stable and near.any() and (rest.q[near, 2] > 0.6).all()
    carried = sum(effect.force_on(rest)[:, 2].sum() for effect in rest.scene.effects[1:])
    carried += sum(rest.reaction(point.name)[2] for point in parts.points if isinstance(point, Fixed))
    assert abs(carried) == pytest.approx(load, rel=0.05)


@pytest.mark.parametrize("EA", [1e4, math.inf])
def test_a_thread_over_a_stiff_pipe_is_balanced_to_rounding(EA):
    """Of the thread's 0.12 N, rounding of 5 m leaves 1e-8 in the springs of the pipe, 4e6 N/m; tolerated was 1e-9."""
    thread = Cable("a", "b", length=12.5, mass_per_length=1e-3, EA=EA, segments=60, diameter=0.01)
    pipe = Obstacles(Cylinder((0.0, 0.0, -5.0), 5.0))
    ends = [Fixed("a", (-5.5, 0.0, 0.0)), Fixed("b", (5.5, 0.0, 0.0))]
    rest = equilibrium(Scene(ends, [thread], [Gravity(G), pipe]))
    assert rest.stable and rest.residual < 1e-7
    q, load = rest.shape("a-b"), 1e-3 * G * 12.5
    assert q[30] == pytest.approx((0.0, 0.0, 0.0), abs=1e-7)
    constant = rest.tension("a-b") - 1e-3 * G * 0.5 * (q[1:, 2] + q[:-1, 2])
    assert np.ptp(constant) < 0.002 * load  # of segments that turn by 0.04
    carried = rest.reaction("a")[2] + rest.reaction("b")[2] - pipe.force_on(rest)[:, 2].sum()
    assert abs(carried) == pytest.approx(load, rel=1e-6)


def test_a_rope_laid_across_a_ball_on_a_bed_slips_off_it():
    """On top of the ball it would slip to either side; leaving that rest on stiff contacts led to no other, and it was refused."""
    rope = Cable("a", "b", length=8.1, mass_per_length=0.18, EA=4.4e4, segments=95, diameter=0.0047)
    ends = [Fixed("a", (0.0, 0.0, 0.0)), Fixed("b", (4.7, 0.0, 0.4))]
    ball, bed = Obstacles(Sphere((3.2, 0.0, -0.66), 0.79)), Ground(height=-0.005)
    rest = equilibrium(Scene(ends, [rope], [Gravity(G), bed, ball]))
    assert rest.stable and rest.residual < 1e-9
    q, load = rest.shape("a-b"), 0.18 * G * 8.1
    assert np.linalg.norm(q - (3.2, 0.0, -0.66), axis=1).min() > 0.79 - 1e-4 and q[:, 2].min() > -0.006
    assert 0.42 < np.abs(q[:, 1]).max() < 0.79  # beside the circle of 0.44 m in which the ball comes out of the bed
    carried = sum(rest.reaction(name)[2] for name in "ab") - sum(one.force_on(rest)[:, 2].sum() for one in (bed, ball))
    assert abs(carried) == pytest.approx(load, rel=1e-6)
