"""Warnings of a completed run: each against a run in which its number is known, and silence elsewhere."""

import math
from dataclasses import replace

import numpy as np
import pytest
from systems import four_cables, loose_cable

from anet_lumped import Cable, Fixed, Free, Scene, load_run, simulate, wind
from anet_lumped.effects import Air, Bending, Gravity, ViscousDamping, Water, node_energy, node_force
from anet_lumped.motion.run_warnings import Finding, findings, warnings_of
from anet_lumped.results.energy_balance import error_of_steps
from studies.catalogue.swings import ANGLE, pendulum, released


@pytest.fixture(scope="module")
def swing():
    """A swing at EA = 1e7 N, stretched by 1e-7 of its length: no step of a hundredth of a second resolves that."""
    scene = pendulum(EA=1e7)
    return scene, released(scene, ANGLE)


def test_backward_euler_says_what_it_lost(swing):
    """The share that is said is what the energies lack, most of a swing's fall after some of them."""
    scene, start = swing
    run = simulate(scene, 8.0, method="backward_euler", dt=0.01, start=start)
    fall = run.energy[0, 2] - run.energy[:, 2].min()
    lost = run.energy[0, :3].sum() - run.energy[-1, :3].sum()
    (text,) = run.warnings
    assert run.ok and lost > 0.3 * fall
    assert f"{error_of_steps(run):.2g} of the energy in play were lost in its steps, to neither dampers nor drag" in text
    assert "a smaller step than dt=0.01 s" in text and 'method="edmc"' in text
    assert simulate(scene, 8.0, method="edmc", dt=0.01, start=start).warnings == ()


def test_energy_of_driven_points_is_not_called_damping():
    run = simulate(four_cables(1e6, carried=True), 2.0, method="backward_euler", dt=0.02)
    assert run.ok and run.warnings
    assert "are not accounted for by dampers, drag and the work of driven points" in run.warnings[0]


def test_more_dissipated_than_there_was():
    run = simulate(loose_cable(1e4), 0.4, method="verlet", start="straight")
    rows = run.energy.copy()
    rows[-1, 4] += 0.3 * np.ptp(rows[:, 2])
    (text,) = warnings_of(replace(run, energy=rows))
    assert warnings_of(run) == () and "were dissipated beyond what was there" in text
    assert list(findings(replace(run, energy=rows))) == [Finding.UNACCOUNTED_ENERGY]
    assert "take a smaller tolerance" in warnings_of(replace(run, energy=rows), adaptive=True)[0]


@pytest.mark.parametrize(("method", "EA"), [("links", math.inf), ("verlet", 1e4), ("dop853", 1e4)])
def test_a_rest_that_only_rounding_moves_is_silent(method, EA):
    """A straight bar without gravity holds 1e-25 J of rounding, nearly all of which was called dissipated beyond what was there."""
    a, b = np.array((0.7, 0.6, 0.3)), np.array((1.01, 1.37, -0.11))
    bar = Cable(
        "a", "b", length=float(np.linalg.norm(b - a)), mass_per_length=0.2, EA=EA, segments=9, EI=13.0, compression="linear"
    )
    scene = Scene([Fixed("a", tuple(a)), Free("b", mass=0.1, at=tuple(b))], [bar], [Bending(), ViscousDamping(rate=1.0)])
    run = simulate(scene, 0.05, method=method, dt=2.5e-4, start="straight")
    assert run.ok and run.warnings == () and error_of_steps(run) > 0.5
    assert 0.0 < np.abs(run.q - run.q[0]).max() < 1e-14


def test_midpoint_leaves_a_swing_too_long(swing):
    """Places at the end of a step lie a step further on the tangent of the circle: longer by up to (omega h)^2/8 of the length.

    omega^2 = 2 g (1 - cos a)/L is what a mass on a rod has at its lowest place, within the cable's tenth of the payload.
    """
    scene, start = swing
    h, omega = 0.01, math.sqrt(2.0 * 9.81 * (1.0 - math.cos(ANGLE)))
    run = simulate(scene, 0.8, method="midpoint", dt=h, start=start)
    (text,) = [one for one in run.warnings if "longer" in one]
    longer = run.length("a-b").max() - 1.0
    # the ringing swings about the true length, and its waves may add up along the cable
    assert (omega * h) ** 2 / 16 < longer < (omega * h) ** 2 / 2
    held = run.tension("a-b").sum(axis=1).max() / scene.cables[0].stiffness
    assert f'cable "a-b" gets {longer:.2g} m longer than it is unstretched, where its tension stretches it by {held:.2g} m' in text
    for method in ("tr_bdf2", "edmc", "generalised_alpha"):
        assert not [one for one in simulate(scene, 0.8, method=method, dt=h, start=start).warnings if "longer" in one]


def test_midpoint_is_silent_where_its_step_resolves_the_stretching():
    scene = pendulum(EA=1e4)
    start = released(scene, ANGLE)
    assert simulate(scene, 0.2, method="midpoint", dt=1e-4, start=start).warnings == ()


def test_an_extrapolation_far_from_its_limit_says_so(tmp_path):
    """An undamped whip: the runs part after 0.5 s; before that they do not."""
    scene = loose_cable(1e4, 0.0)
    early = simulate(scene, 0.4, method="edmc", dt=2e-3, start="straight", extrapolate=True)
    late = simulate(scene, 1.5, method="edmc", dt=1e-2, start="straight", extrapolate=True)
    assert early.ok and not [text for text in early.warnings if "far from a limit" in text]
    (text,) = [text for text in late.warnings if "far from a limit" in text]
    assert f"are {3.0 * late.error_estimate:.2g} m apart" in text and "no extrapolation" in text
    late.save(tmp_path / "run.nc")
    back = load_run(tmp_path / "run.nc")
    assert back.warnings == late.warnings and back.extrapolated


def test_an_extrapolation_of_places_is_no_length(swing):
    """A stiff cable's end goes round and the extrapolation straight on."""
    scene, start = swing
    run = simulate(scene, 0.8, method="edmc", dt=0.01, start=start, extrapolate=True)
    assert run.ok and [text for text in run.warnings if "edmc, extrapolated" in text and "or no extrapolation" in text]


def test_steps_that_are_taken_in_many_parts_say_so():
    """A stiff cable that bends, let go stretched four times: steps of 50 ms are taken in some forty parts each."""
    cable = Cable("a", "b", length=0.5, mass_per_length=0.1, EA=1e8, segments=8, EI=100.0, diameter=0.004)
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=0.01, at=(2.0, 0.0, 0.0))]
    scene = Scene(points, [cable], [Gravity(9.81), Bending()])
    run = simulate(scene, 0.2, method="edmc", dt=0.05, start="straight")
    said = findings(run)[Finding.TAKEN_IN_PARTS]
    assert (
        run.work.steps > 16 and f"in parts only, {run.work.steps} in place of 4, and {run.work.halvings} times not at all" in said
    )
    assert said.endswith(f"take dt={0.2 / run.work.steps:.2g} s or less.") and said in run.warnings
    fine = simulate(scene, 0.002, method="edmc", dt=2e-5, start="straight")
    assert Finding.TAKEN_IN_PARTS not in findings(fine)


def test_wind_that_blows_under_water_is_told():
    """A cord of which the lower half is under water; with a surface, or still air, or all of it above, there is nothing to tell."""
    cord = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, zeta=0.1, segments=4, diameter=0.01)
    points, blowing = [Fixed("a", (0, 0, 0)), Free("b", mass=0.1)], Air(wind=wind.Uniform((10.0, 0.0, 0.0)))

    def told(*effects):
        run = simulate(Scene(points, [cord], [Gravity(9.81), *effects]), 0.02, method="edmc", dt=0.01)
        return findings(run).get(Finding.WIND_UNDER_WATER, "")

    water = Water(level=-0.5)
    assert "Air has no `surface` beside Water; surface=-0.5 lets it end there" in told(blowing, water)
    assert (
        "" == told(replace(blowing, surface=-0.5), water) == told(Air(), water) == told(blowing) == told(blowing, Water(level=-2.0))
    )


@node_force
def stiff_contact(t, q, v, k, height):
    return 0.0, 0.0, k * max(height - q[2], 0.0)


@node_energy
def contact_energy(t, q, k, height):
    return 0.5 * k * max(height - q[2], 0.0) ** 2


@node_force
def weight(t, q, v, g):
    return 0.0, 0.0, -0.02 * g


def test_energy_that_a_stiff_force_gave_is_called_gained():
    """A cable falls on a contact that takes nothing: as a force it throws nodes higher than they fell, as an energy it cannot."""

    def found(*effects):
        cable = Cable("a", "b", length=1.2, mass_per_length=0.1, EA=1e4, segments=10)
        scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=0.5, at=(1, 0, 0))], [cable], [Gravity(9.81), *effects])
        run = simulate(scene, 1.0, method="edmc", dt=2e-3, start="straight")
        assert run.ok
        return run, findings(run).get(Finding.GIVEN_BY_FORCE, "")

    run, said = found(stiff_contact(k=1e8, height=-0.5))
    given = -run.energy_balance.by_effects
    assert given > 2.0 * 3.0  # the weight of 0.62 kg, 0.5 m above the contact, is worth 3.0 J
    assert f"gained {given:.3g} J from effects" in said and "the force of stiff_contact changes faster" in said
    assert said in run.warnings and "smaller step than dt=0.002 s, or write its energy" in said
    assert found(contact_energy(k=1e8, height=-0.5))[1] == ""
    falling, said = found(weight(g=9.81))  # it gives energy as it should
    assert said == "" and falling.energy_balance.by_effects < -0.1
