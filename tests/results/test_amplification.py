"""How many times a motion multiplies errors, beside the closed form of parametric resonance and beside finer runs."""

import math

import numpy as np
import place_twin
import pytest
from slow import slow

from anet_lumped import Cable, Driven, Fixed, Free, Scene, paths, simulate
from anet_lumped.effects import Gravity
from anet_lumped.results.amplification import amplification, multiply
from anet_lumped.results.free_flight import first_loose
from anet_lumped.results.node_pass import LEAST_ROWS
from anet_lumped.results.place_rows import FIRST, TOGETHER
from anet_lumped.results.saved_motion import look_at
from studies.catalogue.random_motions import random_motion

L, G = 1.0, 9.81
OMEGA = math.sqrt(G / L)


def shaken(share):
    """A weight that hangs from a support which goes up and down twice as fast as the weight would swing, by `share` of gravity."""
    way, frequency = share * G / (2.0 * OMEGA) ** 2, 2.0 * OMEGA / (2.0 * math.pi)
    path = paths.harmonic((0.0, 0.0, 0.0), (0.0, 0.0, way), frequency, ramp=1.0)
    cable = Cable("a", "b", length=L, mass_per_length=1e-3, EA=1e5, zeta=1.0, segments=1)
    return Scene([Driven("a", path), Free("b", mass=1.0)], [cable], [Gravity(G)])


def pendulum(angle):
    cable = Cable("a", "b", length=L, mass_per_length=0.1, EA=1e5, zeta=1.0, segments=4)
    at = (L * math.sin(angle), 0.0, -L * math.cos(angle))
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=1.0, at=at)], [cable], [Gravity(G)])


def test_a_swing_that_is_pumped():
    """A sway z with z'' = -omega^2 (1 + h cos(2 omega t)) z grows by exp(h omega t/4), to the first order of h."""
    h = 0.3
    run = simulate(shaken(h), 40.0, method="edmc", dt=0.02, save_every=0.02)
    grown, later = amplification(run), (run.t > 18.0) & (run.t < 36.0)  # the envelope looks ahead, and ends with the run
    slope = np.polyfit(run.t[later], grown[later], 1)[0]
    assert slope == pytest.approx(h * OMEGA / 4.0, rel=0.03)  # the next term of h, and steps of the envelope


def carried(run, together):
    """Logarithm of a displacement across the motion at each saved time, (k,); so many times between two count as one."""
    seen = look_at(run, grows=True)
    seen.rows.numbers[TOGETHER] = together
    multiply(seen)
    return seen.rows.columns[FIRST].copy()


def of_each_turn(size):
    """Largest of sizes, a hundredth of a second apart, in the turn of a sway that begins with each."""
    return np.lib.stride_tricks.sliding_window_view(size, int(2.0 * math.pi / OMEGA / 0.01)).max(axis=1)


def test_a_turn_of_the_tension_in_some_tens_of_steps_is_enough():
    run = simulate(shaken(0.3), 40.0, method="edmc", dt=0.01, save_every=0.01)
    each, some = (carried(run, together) for together in (1, 4))  # 100 and 25 a turn
    sizes = [of_each_turn(each), of_each_turn(some)]
    grown = [size[3400] - size[1400] for size in sizes]
    assert grown[0] > 4.0 and grown[1] == pytest.approx(grown[0], rel=0.01)


@pytest.mark.parametrize(("h", "t_end"), [(0.1, 30.0), (0.3, 12.0)])
def test_no_displacement_grows_by_more_than_its_tensions_allow(h, t_end):
    """The largest z of a turn is as the root of its energy, k z^2/2 + m v^2/2, but for what k changes by, 1 + h."""
    run = simulate(shaken(h), t_end, method="edmc", dt=0.01, save_every=0.01)
    size = of_each_turn(carried(run, 1))
    grown, most = size[-1] - size.min(), place_twin.pumped_at_most(run.segment_tension, 1)
    assert 0.2 < grown < most + 0.5 * math.log(1.0 + h)
    assert most < 1.1 * t_end * OMEGA * h / math.pi * math.log((1.0 + h) / (1.0 - h)) / (2.0 * h)  # ln(1 + h)/(1 - h) a half turn


def test_a_large_swing_multiplies_nothing():
    run = simulate(pendulum(0.8), 60.0, method="edmc", dt=0.02, save_every=0.02, start="straight")
    assert len(run.t) > LEAST_ROWS and run.error_growth[-1] > 1e-3
    assert not amplification(run).any()


def test_what_is_saved_too_seldom_shows_nothing():
    """Three states a turn of the tension."""
    run = simulate(shaken(0.3), 40.0, method="edmc", dt=0.02, save_every=0.3)
    assert len(run.t) > LEAST_ROWS and not amplification(run).any()


def test_nothing_grows_once_it_is_loose():
    """A cable that is let go level whips: `multiplies` says so, and no growth counts from there on."""
    run = simulate(pendulum(1.57), 3.0, method="edmc", dt=2e-3, save_every=2e-3, start="straight")
    grown, since = amplification(run), first_loose(run)
    assert 0.0 < since < 2.0 and run.multiplies > 1.0
    assert (grown[run.t >= since] == grown[np.searchsorted(run.t, since) - 1]).all()


def test_no_number_grows_too_large():
    """Of a sway that grows by e^290, and of all of that its errors are multiplied by."""
    run = simulate(shaken(0.9), 500.0, method="edmc", dt=0.02, save_every=0.02)
    grown = amplification(run)
    assert 250.0 < grown[-1] < 400.0 and np.isfinite(run.error).all()


@pytest.mark.parametrize(("seed", "number", "steps", "most"), [(11, 1, 580, 5.0), *slow((501, 4, 1446, 4.0))])
def test_nets_that_are_carried_fast(seed, number, steps, most):
    """Their swings beat against each other: what steps leave out is multiplied 10 and 5 times, and more is told."""
    motion = random_motion(number, seed)
    run, fine = (
        simulate(motion.scene, motion.t_end, method="edmc", dt=motion.t_end / (steps * n), save_every=motion.t_end / steps)
        for n in (1, 8)
    )  # fmt: skip
    off = np.linalg.norm(run.q - fine.q, axis=2).max()
    assert off > 4.0 * run.error_growth[-1]
    assert 1.0 < run.error_estimate / off < most
