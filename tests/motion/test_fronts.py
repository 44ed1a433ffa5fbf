"""Scenes whose free points are eliminated by fronts move and rest as they do by blocks one by one."""

import numpy as np
import pytest

from anet_lumped import Body, Cable, Fixed, Free, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity
from anet_lumped.model import fronts


def three_bodies(meeting):
    """Three bodies on cables that meet, one of them pinned at a point of its own: its shift is held in the system."""
    made = dict(mass=1.0, inertia=(0.02, 0.03, 0.04), attachments={"ring": (0.2, 0.0, 0.0)})
    bodies = [
        Body("arm", at=(0, 0, 0), pinned="", **made),
        Body("box", at=(0.7, 0, 0), **made),
        Body("bar", at=(0.3, 0.3, 0), **made),
    ]
    made = dict(length=0.3, mass_per_length=0.1, EA=1e3, zeta=0.1)
    cables = [Cable(f"{body.name}.ring", meeting, segments=segments, **made) for segments, body in enumerate(bodies, 1)]
    return Scene([Free(meeting, at=(0.45, 0.1, 0))], cables, [Gravity()], bodies=bodies)


def test_bodies_move_as_by_blocks(monkeypatch):
    runs = []
    for many, meeting in ((fronts.MANY, "p"), (1, "m")):  # of other names, so that the second is laid out anew
        monkeypatch.setattr(fronts, "MANY", many)
        scene = three_bodies(meeting)
        with pytest.warns(UserWarning, match="stretches cable"):
            runs.append(simulate(scene, 0.1, method="edmc", dt=0.004, start="straight"))
    assert len(runs[1].model.symbolic.fronts.front) > 0 and runs[1].status == "done"
    for body in ("arm", "box", "bar"):  # at rounding, which the motion of a stretched start multiplies little in 0.1 s
        np.testing.assert_allclose(runs[1].position(f"{body}.ring"), runs[0].position(f"{body}.ring"), atol=1e-10)


def test_a_net_of_many_points_rests_in_balance():
    """A net of as many knots as are eliminated by fronts without being asked to: its corners carry its weight."""
    n = int(np.ceil(fronts.MANY**0.5)) + 1
    at = {(i, j): (0.095 * i, 0.095 * j, 0.0) for i in range(n) for j in range(n)}
    corner = {0, n - 1}
    points = [
        Fixed(f"{i},{j}", place) if {i, j} <= corner else Free(f"{i},{j}", mass=0.002, at=place) for (i, j), place in at.items()
    ]
    pairs = [((i, j), (i + di, j + dj)) for i, j in at for di, dj in ((1, 0), (0, 1)) if (i + di, j + dj) in at]
    made = dict(length=0.1, mass_per_length=0.02, EA=1e3, segments=1)
    scene = Scene(points, [Cable(f"{a[0]},{a[1]}", f"{b[0]},{b[1]}", **made) for a, b in pairs], [Gravity()])
    rest = equilibrium(scene)
    weight = 9.81 * (0.002 * (n * n - 4) + 0.02 * 0.1 * len(pairs))
    pull = sum(np.asarray(rest.reaction(point.name)) for point in points if isinstance(point, Fixed))
    assert len(rest.model.symbolic.fronts.front) > 0
    np.testing.assert_allclose(pull, (0.0, 0.0, weight), atol=1e-6 * weight)
