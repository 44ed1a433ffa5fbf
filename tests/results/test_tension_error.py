"""What a run tells of the error of its largest tension: overshoot and memory against plain formulas, runs against finer ones."""

import itertools
import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from slow import slow
from tension_twin import counted_jumps, missing

from anet_lumped import Cable, Fixed, Free, PayloadChange, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity
from anet_lumped.results.energy_balance import BY_METHOD, lost_share
from anet_lumped.results.events import BREAK, Event
from anet_lumped.results.tension_error import Mode, look_at, lowest_axial_mode, snap_tension


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.5, 1.0, 3.0])
def test_the_overshoot_of_a_spring_and_a_damper(zeta):
    """y'' + 2 zeta y' + y = 2 zeta u' + u for a u that jumps from 0 to 1, by small steps of Heun's method."""
    h, y, v, largest = 1e-3, 0.0, 2.0 * zeta, 0.0  # the jump of u sets off y' = 2 zeta
    for _ in range(8000):
        a = 1.0 - y - 2.0 * zeta * v
        y_next, v_next = y + h * v, v + h * a
        y, v = y + 0.5 * h * (v + v_next), v + 0.5 * h * (a + 1.0 - y_next - 2.0 * zeta * v_next)
        largest = max(largest, y)
    assert Mode(1.0, zeta).overshoot == pytest.approx(largest - 1.0, abs=1e-5)  # h^2


def test_the_overshoot_has_no_gap_at_the_aperiodic_limit_and_ends():
    near = [Mode(1.0, 1.0 + x).overshoot for x in (-1e-5, -1e-8, 0.0, 1e-8, 1e-5)]
    assert np.ptp(near) < 1e-5 and near == sorted(near, reverse=True)
    assert Mode(1.0, 999.0).overshoot < 1e-6 and Mode(1.0, 1e200).overshoot == 0.0


def test_infinite_energies_of_a_run_that_diverged_are_no_warning():
    energy = np.zeros((3, 7))
    energy[:, 0] = np.inf
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert lost_share(energy) == 0.0


def jumps(T):
    """Half of the larger third difference beside each row, as a loop; what is before the first row is as it is there."""
    row = [T[0], T[0], *T, T[-1], T[-1]]
    third = [abs(row[i + 3] - 3.0 * row[i + 2] + 3.0 * row[i + 1] - row[i]) for i in range(len(T) + 1)]
    return 0.5 * np.array([max(pair) for pair in itertools.pairwise(third)])


def counted_over_jumps(T):
    """Of one segment, at each row."""
    jump = jumps(T)
    counted = counted_jumps(T[:, None], jump[:, None])[:, 0]
    return np.divide(counted, jump, out=np.ones(len(T)), where=jump > 0.0)


WIGGLE = np.sin(2.0 * math.pi * np.arange(200) / 10.0)


def test_an_alternating_tension_counts_a_quarter_of_its_third_differences():
    """Means of two rows in a row have no alternation: a quarter of 4 A is its amplitude. The first four rows count in full."""
    share = counted_over_jumps(2.0 + (-1.0) ** np.arange(50))
    np.testing.assert_allclose(share[4:], 0.25, rtol=1e-12)
    np.testing.assert_allclose(share[:4], 1.0, rtol=1e-12)


def test_a_wave_that_ten_steps_resolve_counts_less_than_a_jump():
    """Means of two rows have cos(pi/10) times the third differences of the rows, at phases between theirs."""
    T = 2.0 + WIGGLE
    counted = counted_jumps(T[:, None], jumps(T)[:, None])[10:-10]
    of_means = jumps(0.5 * (T[1:] + T[:-1]))[9:-9].max()
    assert counted.max() == pytest.approx(0.7 * of_means, rel=1e-12)
    assert 0.7 * of_means < 0.7 * jumps(T)[10:-10].max()


def test_a_jump_out_of_a_small_wave_counts_in_full():
    T = 2.0 + 0.01 * WIGGLE + (np.arange(200) >= 100)
    share = counted_over_jumps(T)
    assert share[99] == share[100] == 1.0 and share[90] < 0.75


def test_jumps_of_a_cable_that_was_slack_count_in_full():
    """Two rows before and after are looked at. It is slack once in twenty, so that no row stands out."""
    T = np.maximum(0.5 + np.sin(2.0 * math.pi * np.arange(200) / 20.0), 0.0)
    row = np.arange(20, 180)
    near = np.min([T[row + n] for n in range(-2, 3)], axis=0) == 0.0
    share = counted_over_jumps(T)[row]
    assert (share[near] == 1.0).all() and share[~near].min() < 0.75


def test_few_rows_count_in_full():
    T = np.array([1.0, 2.0, 1.0, 2.0])
    assert counted_over_jumps(T).tolist() == [1.0] * 4


def hung(segments, EA, zeta, mass, stretched=False):
    """A pendulum of 1 m let go at 0.8 rad: unstretched, so that its tension jumps at once, or stretched by its tension."""
    length = 1.0 + (mass * 9.81 * math.cos(0.8) / EA if stretched else 0.0)
    cable = Cable("a", "b", length=1.0, mass_per_length=0.02, EA=EA, zeta=zeta, segments=segments)
    end = Free("b", mass=mass, at=(length * math.sin(0.8), 0.0, -length * math.cos(0.8)))
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), end], [cable], [Gravity(9.81)])


def told_and_true(scene, dt, fine, method="edmc", t_end=1.0, start="straight"):
    """Of a run with a step, and from one with a fine step and no numerical damper, which would take the vibration."""
    run = simulate(scene, t_end, method=method, dt=dt, save_every=dt, start=start)
    reference = simulate(scene, t_end, method="edmc", dt=fine, save_every=fine, start=start, rho_inf=1.0)
    assert run.ok and reference.ok
    largest, true = run.segment_tension.max(), reference.segment_tension.max()
    return run.tension_error, abs(true - largest) / max(true, largest)


@pytest.mark.parametrize("method", ["edmc", "sdirk2"])  # sdirk2 has no account of what it took from vibrations alone
@pytest.mark.parametrize("dt", [0.05, 0.02])  # omega h/2 = 7.9 and 3.2
def test_a_jump_that_the_steps_do_not_resolve_rings_through_the_swing(method, dt):
    told, true = told_and_true(hung(1, 1e5, 0.0, 1.0), dt, 1e-4, method)
    assert true > 0.1 and 0.25 < told / true < 4.0


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_a_transverse_wave_that_few_steps_resolve_is_no_jump(zeta):
    """A pendulum let go with the stretch of its tension: waves run to and fro, and its tension wiggles by a hundredth.

    Rest under gravity along the cable is the balance of all forces along it as it is let go.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=0.01, EA=1e4, zeta=zeta, segments=20)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=0.1)], [cable], [Gravity(9.81)])
    along = Gravity(9.81 * math.cos(math.pi / 6.0), (math.sin(math.pi / 6.0), 0.0, -math.cos(math.pi / 6.0)))
    told, true = told_and_true(scene, 0.032, 5e-4, t_end=0.8, start=equilibrium(replace(scene, effects=(along,))))
    assert 0.004 < true < 0.008 and 0.25 < told / true < 4.0


@pytest.mark.parametrize("dt", [0.015, 0.0075])  # omega h/2 = 7.4 and 3.7
def test_a_payload_that_is_picked_up_in_a_swing_makes_a_jump(dt):
    scene = hung(10, 1e6, 0.05, 1.0, stretched=True)
    scene = replace(scene, events=[PayloadChange("b", t=0.53, mass=2.0)])
    told, true = told_and_true(scene, dt, 1e-4, t_end=0.9)
    assert true > 0.2 and 0.5 < told / true < 2.0


def test_a_stiff_pendulum_that_does_not_jump_has_no_such_error():
    told, true = told_and_true(hung(1, 1e5, 0.0, 1.0, stretched=True), 0.02, 1e-4)
    assert true < 0.005 and told < 0.01


@pytest.mark.parametrize("dt", [0.004, *slow(0.002)])  # omega h/2 = 0.1 and 0.05 of the lowest vibration, 6 and 3 of a segment's
def test_vibrations_that_the_numerical_damper_took_are_missing(dt):
    """What jumps show is next to nothing here, as the lowest vibration is resolved; the account of energy knows more."""
    told, true = told_and_true(hung(20, 100.0, 0.0, 0.0), dt, 2e-5)
    assert true > 0.01 and 0.25 < told / true < 4.0


@pytest.mark.parametrize("dt", [0.03, 0.02, 0.0123])
def test_a_peak_between_two_saved_states(dt):
    """A weight on a spring, T = m g (1 - cos(omega t)): no more than an eighth of the second difference at the peak, and no less
    than the run misses, which has looked at its steps.

    The steps of Verlet are a tenth of what is saved, so that they make next to no error.
    """
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-6, EA=100.0, zeta=0.0, segments=1)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=1.0, at=(0.0, 0.0, -1.0))], [cable], [Gravity(9.81)])
    run = simulate(scene, 60 * dt, method="verlet", dt=0.1 * dt, save_every=dt, start="straight")
    hidden = 0.125 * 2.0 * 9.81 * (1.0 - math.cos(10.0 * dt)) / (2.0 * 9.81)  # the second difference of a cosine at its top
    missed = 1.0 - run.peak_tension() / (2.0 * 9.81)
    assert missed < run.tension_error < 1.05 * hidden


def test_a_jump_sets_off_the_vibration_of_a_segment():
    """The lowest vibration is resolved, omega h/2 = 0.1, so that a quarter of the share of a segment's is what counts."""
    scene, dt = hung(20, 100.0, 0.0, 0.0), 0.004
    run = simulate(scene, 20 * dt, method="edmc", dt=dt, save_every=dt, start="straight")
    tension = np.where(np.arange(21)[:, None] < 10, 1.0, 2.0) * np.ones(20)
    jumped = replace(run, segment_tension=tension, energy=np.zeros_like(run.energy))
    square = (0.5 * dt * scene.cables[0].omega_max) ** 2
    assert jumped.tension_error == pytest.approx(1.0 - 2.0 / (2.0 + 0.25 * square / (1.0 + square)), rel=1e-12)
    assert replace(jumped, segment_tension=np.full((21, 20), 2.0)).tension_error == 0.0


def test_a_loose_node_that_is_caught_sends_off_a_wave():
    """v sqrt(EA mu), here of 3 m/s, 1e4 N and 0.02 kg/m, as far as steps of 4 ms do not resolve a segment's vibration."""
    scene = hung(4, 1e4, 0.0, 1.0)
    run = simulate(scene, 0.08, method="edmc", dt=0.004, save_every=0.004, start="straight")
    tension, v, row = np.ones((21, 4)), np.zeros_like(run.v), np.arange(21)
    tension[5:11, 1:3] = 0.0
    v[:, run.model.nodes("a-b")[2], 0] = np.where(row < 11, 3.0, 0.0)
    caught = replace(run, segment_tension=tension, v=v, energy=np.zeros_like(run.energy))
    square = (0.5 * 0.004 * scene.cables[0].omega_max) ** 2
    wave = 3.0 * math.sqrt(1e4 * 0.02) * square / (1.0 + square)
    assert caught.tension_error == pytest.approx(1.0 - 1.0 / wave, rel=1e-12)
    tension[1:5, 1:3] = tension[0, 1:3] = 0.0  # slack from the start, and caught at the second saved time
    tension[1:, 1:3] = 1.0
    assert snap_tension(replace(caught, segment_tension=tension)) == 0.0
    assert replace(caught, segment_tension=tension).tension_error < 0.7


@pytest.mark.parametrize("dt", [0.02, 0.01, 0.005])
def test_past_a_whip_of_a_stiff_cable_the_tension_is_not_known(dt):
    """Its tip is caught with a thousand newtons where no step shows ten."""
    cable = Cable("a", "tip", length=1.0, mass_per_length=0.1, EA=1e7, segments=20)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("tip", at=(1.0, 0.0, 0.0))], [cable], [Gravity(9.81)])
    run = simulate(scene, 1.2, method="edmc", dt=dt, save_every=dt, start="straight")
    assert run.segment_tension.max() < 10.0 and run.tension_error > 0.95


@pytest.mark.parametrize(("segments", "dt"), [(1, 1e-3), (4, 2e-3), (20, 1e-4)])
def test_vibrations_share_what_the_method_took(segments, dt):
    """One joule: each vibration has the share 1/(1 + s^2) of it, and all of them no more than half of one with all of it."""
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=1.0, at=(1, 0, 0))],
                  [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=segments)], [Gravity(9.81)])  # fmt: skip
    run = simulate(scene, 20 * dt, method="edmc", dt=dt, start="straight")
    energy = run.energy.copy()
    energy[:, BY_METHOD] = np.arange(len(run.t)) > 0
    (cable,), lowest = scene.cables, lowest_axial_mode(scene, scene.cables[0])
    omega = [lowest.omega] + [cable.omega_max * math.sin(math.pi * j / (2 * segments)) for j in range(1, segments)]
    share = [1.0 / (1.0 + (0.5 * one * dt) ** 2) for one in omega]
    whole = math.sqrt(2.0 * 1e4)
    summed = 0.2 * sum(whole * math.sqrt(one / sum(share)) for one in share)
    jumped = np.where(np.arange(21)[:, None] < 3, 1.0, 2.0) * np.ones(segments)
    (lost,) = look_at(replace(run, energy=energy, segment_tension=jumped)).lost
    assert lost[0] == 0.0 and lost[1:] == pytest.approx(min(summed, 0.5 * whole), rel=1e-12)
    assert (summed > 0.5 * whole) == (segments == 20)


def tied(zeta):
    """Two cables that are alike and a third one that pushes, on one weight."""
    names = ("a", "b", "c")
    points = [Fixed(name, (x, y, 1.0)) for name, x, y in zip(names, (0.0, 1.0, 0.5), (0.0, 0.0, 1.0), strict=True)]
    cables = [Cable(name, "m", length=1.3, mass_per_length=0.1, EA=1e3, zeta=zeta, segments=n) for name, n in (("a", 5), ("b", 5))]
    cables.append(Cable("c", "m", length=1.2, mass_per_length=0.05, EA=2e3, zeta=zeta, segments=3, compression="linear"))
    return Scene([*points, Free("m", mass=1.0, at=(0.5, 0.3, 0.0))], cables, [Gravity(9.81)])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("method", ["edmc", "sdirk2"])  # sdirk2 has no account of what it took from vibrations alone
def test_the_pass_over_all_tensions_beside_its_slow_twin(seed, method):
    """Tensions at random, some of them waves and some slack; saved times that are not as far from each other; a break."""
    rng, dt = np.random.default_rng(seed), (2e-3, 3e-2)[seed % 2]
    rows = (3, 5, 8, 60, 60, 60)[seed]
    run = simulate(tied((0.0, 0.02, 5.0)[seed % 3]), (rows - 1) * dt, method=method, dt=dt, save_every=dt)
    row, energy = np.arange(rows)[:, None], run.energy.copy()
    energy[:, BY_METHOD] = np.cumsum(rng.random(rows)) * (0.0 if seed == 4 else 1e-3)
    tension = 2.0 + np.sin(0.3 * row + rng.random(13)) + 0.01 * rng.random((rows, 13)) + 5.0 * (row > 40) * rng.random(13)
    tension[:, :5] -= (seed == 3) * 1.5
    tension[:, 5:10] = np.maximum(tension[:, 5:10] - (seed == 5) * 1.5, 0.0)
    t = run.t + 0.3 * dt * rng.random(rows) * (seed == 5)
    events = (Event(float(t[30]) + 0.1 * dt, BREAK, "a-m", 0.0, segment=1, tension=2.0),) if seed == 4 else ()
    run = replace(run, t=t, energy=energy, segment_tension=tension, events=events)
    expected = [
        np.where(run.tension(cable.name) > 0.0, run.tension(cable.name) + missing(run, cable), 0.0).max(axis=0, initial=0.0)
        for cable in run.scene.cables
    ]  # fmt: skip
    found = look_at(run).most
    for cable, most in zip(run.scene.cables, expected, strict=True):
        np.testing.assert_allclose(found[run.model.segments(cable.name)], most, rtol=1e-12)
