"""What a break that comes too early or too late makes of places: beside closed forms, and nothing where the time is given."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, CableCut, Fixed, Free, Scene, simulate
from anet_lumped.effects import Gravity
from anet_lumped.results.break_errors import break_errors

G, MASS, EA, LENGTH, T_END = 9.81, 10.0, 1e4, 5.0, 1.2
K = EA / LENGTH


def let_go(breaking_tension=None, events=()):
    """A weight let go where its cable of one segment, which weighs next to nothing, is straight and not stretched."""
    cable = Cable("a", "b", length=LENGTH, mass_per_length=1e-6, EA=EA, segments=1, breaking_tension=breaking_tension)
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=MASS, at=(0.0, 0.0, -LENGTH))]
    return Scene(points, [cable], [Gravity(G)], events=events)


def height_at_end(breaking_tension):
    """It swings about m g/k with omega until k x is the breaking tension, and then falls freely."""
    omega, x = math.sqrt(K / MASS), breaking_tension / K
    breaks = math.acos(1.0 - x * K / (MASS * G)) / omega
    left = T_END - breaks
    return -LENGTH - x - G / omega * math.sin(omega * breaks) * left - 0.5 * G * left**2


@pytest.mark.each_once
@pytest.mark.parametrize("breaking_tension", [150.0, 190.0])
@pytest.mark.parametrize("dt", [0.02, 0.01, 0.005])
def test_beside_a_closed_form(breaking_tension, dt):
    """Without what the break makes, the run tells a sixteenth to a quarter of its error."""
    run = simulate(let_go(breaking_tension), T_END, start="straight", method="edmc", dt=dt)
    off = abs(float(run.position("b")[-1, 2]) - height_at_end(breaking_tension))
    assert len(run.events) == 1 and 0.25 < run.error_estimate / off < 4.0


def test_by_hand():
    """A weight that falls by g t after it broke at 150 N is off by g t e/u, of places off by e where the segment lengthens at u."""
    run = simulate(let_go(150.0), T_END, start="straight", method="edmc", dt=0.01)
    row = np.searchsorted(run.t, run.events[0].t) - 1
    errors = break_errors(run, np.full(len(run.t), 1e-4))
    assert not errors[: row + 1].any()
    speed = -float(run.v[row, 0, 2])
    fallen = np.abs(run.v[-1, 0, 2] - run.v[row, 0, 2])
    assert errors[-1] == pytest.approx(1e-4 / speed * fallen, rel=1e-12)


def test_a_cut_is_off_by_nothing():
    run = simulate(let_go(events=[CableCut("a-b", 0.2, 0)]), T_END, start="straight", method="edmc", dt=0.01)
    assert len(run.events) == 1 and not break_errors(run, np.ones(len(run.t))).any()
