from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import load_scene, simulate
from anet_lumped.model.build import build


@pytest.mark.parametrize("zeta", [0.0, 0.3])
def test_a_curve_of_one_line_is_a_spring(zeta):
    """Four cables at once, half of whose segments are slack: by constants of the code, and by what the net says of the same law."""
    net = load_scene("net_carried")
    points = [replace(point, at=(0.1, 0.0, -0.2)) if point.name == "p0" else point for point in net.points]
    plain = [replace(cable, zeta=zeta, segments=8, EA=100.0) for cable in net.cables]
    curved = [replace(cable, EA=None, tension_strain=((0.5, 50.0),)) for cable in plain]
    scenes = [replace(net, points=points, cables=cables) for cables in (plain, curved)]
    assert [len(build(scene).cable_groups) for scene in scenes] == [1, 1]
    known, asked = (simulate(scene, 0.5, start="straight", method="edmc", dt=0.004, save_every=0.004) for scene in scenes)
    assert known.ok and asked.ok and 0.4 < (known.segment_tension == 0.0).mean() < 0.6
    # Newton's method takes other ways to both, and its tolerance on force leaves some 1e-8 m
    for name, tolerance in (("q", 1e-6), ("v", 1e-4), ("segment_tension", 1e-4), ("energy", 1e-6)):
        assert np.abs(getattr(known, name) - getattr(asked, name)).max() < tolerance
