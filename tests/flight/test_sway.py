"""The sway of a net in hover, and its lag on a way, by steps of different lengths."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import load_scene, paths
from anet_lumped.effects import AppliedForces
from anet_lumped.flight.fly import fly
from anet_lumped.flight.geometric import geometric, hold
from anet_lumped.flight.net_guide import NetGuide
from anet_lumped.flight.quadrotor import THESIS_QUADROTOR

CREW = [THESIS_QUADROTOR] * 4
NET = load_scene("quadrotors_net")
STARTS = [body.at for body in NET.bodies]
STEPS = (0.02, 0.01, 0.004, 0.001)
AWAY = np.array([1.0, 0.3, 0.0])


def middle(run):
    return np.mean([run.position(body.name) for body in NET.bodies], axis=0)


def peak(run):
    return max(run.tension(cable.name).max() for cable in NET.cables)


def sway(dt):
    """Period of p0 about the middle of the quadrotors [s], from its crossings, and largest tension [N], after a push."""
    push = AppliedForces({"p0": paths.samples((0.0, 0.1, 0.2), ((0, 0, 0), 0.5 * AWAY, (0, 0, 0)))})
    scene = replace(NET, effects=[*NET.effects, push])
    run = fly(scene, geometric(CREW, hold(STARTS)), 4.0, dt=dt, save_every=0.02)
    off = (run.position("p0") - middle(run)) @ AWAY
    before = np.flatnonzero((off[:-1] > 0.0) != (off[1:] > 0.0))
    crossings = run.t[before] + 0.02 * off[before] / (off[before] - off[before + 1])
    crossings = crossings[crossings > 0.3]
    assert run.ok and run.work.halvings == 0 and len(crossings) >= 6 and np.abs(off).max() > 0.02
    return 2.0 * (crossings[5] - crossings[0]) / 5.0, peak(run)


def test_the_sway_in_hover_is_the_same_by_any_step():
    """Controllers at 100 and 500 Hz, or once a step where that is seldomer: period and largest tension.

    (omega h)^2/24 of the period are 5e-4 at 20 ms; the rest is what controllers do later.
    """
    found = np.array([sway(dt) for dt in STEPS])
    assert found == pytest.approx(np.tile(found[-1], (4, 1)), rel=4e-3)
    assert found[-1, 0] == pytest.approx(1.11, rel=0.02)  # of a damped sine that was fitted


def test_the_lag_behind_a_guide_is_that_of_the_controllers():
    """On a way: the same within 0.2 % by any step, if the controllers act as often."""
    t = np.linspace(0.0, 4.0, 81)
    along = 10.0 * (t / 4.0) ** 3 * (10.0 - 15.0 * t / 4.0 + 6.0 * (t / 4.0) ** 2)
    way = paths.samples(t, np.add(np.outer(along, (0.0, 1.0, 0.0)), (0.0, 0.0, -0.629)))
    guide, lags = NetGuide(NET, way), []
    for dt in STEPS:
        run = fly(NET, geometric(CREW, guide, rates=(50.0, 50.0)), 3.0, dt=dt, save_every=0.02)
        lags.append(max(way.at(float(t))[0][1] - y for t, y in zip(run.t, run.position("p0")[:, 1], strict=True)))
    assert lags == pytest.approx(np.full(4, lags[-1]), rel=2e-3) and lags[-1] > 0.2
