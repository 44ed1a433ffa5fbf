"""Trails over the segments of nets: each segment on one of them, once, from node to node."""

import numpy as np
import pytest
from systems import mesh, nets

from anet_lumped import Cable, Fixed, Free, Scene, simulate
from anet_lumped import nets as net_makers
from anet_lumped.effects import Gravity, LineChange
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.model.tables import AXIAL_DAMPER, AXIAL_L0, AXIAL_STIFFNESS
from anet_lumped.model.trails import LONGEST, NO_CABLE
from anet_lumped.prescribed import signals

CORNERS = [(0, 0, 0), (3, 0, 0), (3, 3, 0), (0, 3, 0)]


def grid(meshes, **kwargs):
    parts = net_makers.grid(meshes, CORNERS, cable={"mass_per_length": 0.01, "EA": 1e3, "zeta": 0.05} | kwargs)
    return Scene(parts.points, parts.cables, [Gravity()])


def walked(model):
    """Pairs of nodes that trails join, each with its cable, and how many lanes wait."""
    trails, cables = model.trails
    pairs, waiting = [], 0
    for first, count in trails.run:
        for row in range(first + 1, first + 1 + count):
            for lane in range(4):
                behind, ahead = trails.position[row - 1 : row + 1, lane] // 3
                if cables[row, lane] == NO_CABLE:
                    assert behind == ahead
                    waiting += 1
                else:
                    pairs.append((min(behind, ahead), max(behind, ahead), cables[row, lane]))
    return sorted(pairs), waiting


def expected(model):
    """The same of all segments of cables that trails go along."""
    own = [c for c in model.single_cables if c not in model.trails[0].other_cables]
    return sorted((min(a, b), max(a, b), c) for (a, b), c in zip(model.ends, model.cable_of, strict=True) if c in own)


@pytest.mark.parametrize("name", [*nets(), "mesh", "grid"])
def test_each_segment_is_on_one_trail(name):
    scene = {**nets(), "mesh": mesh(3, 4, 3), "grid": grid((9, 7))}[name]
    model = build(scene)
    pairs, _ = walked(model)
    assert pairs == expected(model)
    assert (len(pairs) == 0) == (sum(model.segment_run(c)[1] for c in model.single_cables) < 8)


def test_few_lanes_of_a_large_net_wait():
    model = build(grid((29, 29)))
    pairs, waiting = walked(model)
    assert len(pairs) == 2 * 29 * 30 and waiting < 0.1 * len(pairs)
    assert model.trails[0].run[:, 1].max() <= LONGEST


def test_cables_with_curves_and_with_changing_lengths_are_on_none():
    points = [Fixed("a", (0, 0, 0)), Free("x"), Free("y"), Free("z")]
    common = {"length": 1.0, "mass_per_length": 0.1, "segments": 9}
    cables = [Cable("a", "x", EA=1e3, **common), Cable("x", "y", tension_strain=[(0.1, 100.0), (0.2, 300.0)], **common)]
    cables.append(Cable("y", "z", EA=1e3, **common))
    model = build(Scene(points, cables, [Gravity(), LineChange({"y-z": signals.line(0.0, 0.1, 0.0)})]))
    assert sorted(model.trails[0].other_cables) == [1, 2]
    assert {cable for *_, cable in walked(model)[0]} == {0}


def test_numbers_are_those_of_the_cables():
    model = build(mesh(3, 4, 3))
    net = fresh_net(model)
    cables, columns = model.trails[1], [AXIAL_L0, AXIAL_STIFFNESS, AXIAL_DAMPER]
    numbers = net.trails.number.reshape(-1, 3, 4)
    for row, lane in np.argwhere(cables != NO_CABLE):
        np.testing.assert_array_equal(numbers[row, :, lane], model.axial[cables[row, lane], columns])
    assert len(fresh_net(model, force=False).trails.run) == 0


def test_the_numbers_of_a_second_scene_of_one_topology_are_its_own():
    """Twice as stiff: the run of the second scene is that of the same scene when nothing is known of its topology."""
    one, two = grid((3, 3)), grid((3, 3), EA=2e3)
    of_one = simulate(one, 0.02, start="straight", method="verlet")
    of_two = simulate(two, 0.02, start="straight", method="verlet", dt=of_one.dt / 2)
    build.cache_clear()
    alone = simulate(grid((3, 3), EA=2e3), 0.02, start="straight", method="verlet", dt=of_one.dt / 2)
    np.testing.assert_array_equal(of_two.q[-1], alone.q[-1])
    assert np.abs(of_one.q[-1] - of_two.q[-1]).max() > 0.0
