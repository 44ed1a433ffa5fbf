"""Other methods tend to links: edmc at EA = inf with its step, and cables that stretch with their stiffness."""

import math

import numpy as np
import pytest
from systems import four_cables, loose_cable

from anet_lumped import simulate

INF = math.inf


@pytest.fixture(scope="module")
def carried():
    return simulate(four_cables(INF, 0.0, segments=6, carried=True), 1.5, method="links", rtol=1e-12, save_every=0.1)


def test_edmc_tends_to_it_with_the_square_of_its_step(carried):
    off = []
    for dt in (0.02, 0.01, 0.005, 0.0025, 0.00125):
        run = simulate(carried.scene, 1.5, method="edmc", dt=dt, save_every=0.1)
        off.append([np.abs(run.q - carried.q).max(), np.abs(run.v - carried.v).max()])
    np.testing.assert_allclose(np.diff(np.log2(off), axis=0), -2.0, atol=0.15)


@pytest.mark.parametrize("method, options", [("dop853", dict(rtol=1e-10)), ("edmc", dict(dt=2e-4, rho_inf=1.0))])
def test_cables_that_stretch_tend_to_it_with_their_stiffness(carried, method, options):
    """1/EA of the smooth motion of a carried net, whose axial vibrations begin with the ramp's fourth derivative."""
    off = []
    for EA in (1e3, 1e4, 1e5):
        run = simulate(four_cables(EA, 0.0, segments=6, carried=True), 1.5, method=method, save_every=0.1, **options)
        off.append(np.abs(run.position("p0") - carried.position("p0")).max())
    np.testing.assert_allclose(np.diff(np.log10(off)), -1.0, atol=0.05)


@pytest.mark.parametrize("method", ["links", "links5"])
def test_tensions_are_those_at_one_time(carried, method):
    """Largest tension of stiff cables differs by what they stretch and by their axial vibrations: 1e-3 at EA = 1e5 N."""
    options = dict(rtol=1e-9) if method == "links" else dict(dt=0.002)
    run = simulate(carried.scene, 1.5, method=method, save_every=0.1, **options)
    stiff = simulate(four_cables(1e5, 0.05, segments=6, carried=True), 1.5, method="edmc", dt=5e-4, save_every=0.1)
    assert np.abs(run.segment_tension - carried.segment_tension).max() < 1e-6 * carried.segment_tension.max()
    assert np.abs(stiff.segment_tension - run.segment_tension)[1:].max() < 5e-3 * run.segment_tension.max()


def test_order_8_of_a_net():
    """With as many steps as the tolerance asks for: the error of places falls faster than their number to the seventh power."""
    scene, off, steps = four_cables(INF, 0.0, segments=3, carried=True), [], []
    known = simulate(scene, 2.0, method="links", rtol=1e-13, save_every=0.25)
    for tolerance in (1e-5, 1e-7, 1e-9):
        run = simulate(scene, 2.0, method="links", atol=tolerance, save_every=0.25)
        off.append(np.abs(run.q - known.q).max())
        steps.append(run.work.steps)
    slope = np.diff(np.log(off)) / np.diff(np.log(steps))
    assert np.all(slope < -7.0)


def test_order_5_of_a_net():
    """Over four halvings of a given step, in places and velocities."""
    scene, off = four_cables(INF, 0.0, segments=3, carried=True), []
    known = simulate(scene, 2.0, method="links", rtol=1e-13, save_every=1.0)
    for dt in (1 / 20, 1 / 40, 1 / 80, 1 / 160, 1 / 320):
        run = simulate(scene, 2.0, method="links5", dt=dt, save_every=1.0)
        off.append([np.abs(run.q - known.q).max(), np.abs(run.v - known.v).max()])
    slopes = np.diff(np.log2(off), axis=0)
    np.testing.assert_allclose(slopes[-2:], -5.0, atol=0.15)


@pytest.mark.parametrize("segments", [20, 80])
def test_a_loose_cable_before_its_whip(segments):
    """The level release to 0.4 s, refined in its tolerance: each run is as near to the finest as it says."""
    scene = loose_cable(INF, 0.0, segments=segments, compression="linear")
    runs = [
        simulate(scene, 0.4, method="links", atol=tolerance, start="straight", save_every=0.1) for tolerance in (1e-6, 1e-9, 1e-12)
    ]
    for run in runs[:-1]:
        assert np.abs(run.q - runs[-1].q).max() < 10.0 * run.error_estimate  # the free end multiplies what is left out
