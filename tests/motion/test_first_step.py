"""Starts deep inside stiff ground that the first step does not resolve: such a run tells no error, and says why."""

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, simulate
from anet_lumped.effects import Gravity, Ground
from anet_lumped.motion.first_step import OF_FASTEST, thrown, unresolved_start

DT, T_END, EVERY = 1e-3, 0.2, 1e-2
THROWING = ("tr_bdf2", "sdirk2", "midpoint", "generalised_alpha")


def inside():
    """A weight half a metre below the ground, on a cable that hangs loose, which the ground lifts out at some 4 m/s."""
    cable = Cable("a", "b", length=3.0, mass_per_length=1e-3, EA=1e3, segments=1, diameter=0.02)
    points = [Fixed("a", (0.0, 0.0, 1.0)), Free("b", mass=1.0, at=(0.0, 0.0, -0.5))]
    return Scene(points, [cable], [Gravity(9.81), Ground(height=0.0)])


def run_of(method, dt, **more):
    return simulate(inside(), T_END, method=method, dt=dt, save_every=EVERY, start="straight", **more)


def off(run):
    """From a run with a hundredth of the step [m]."""
    return float(np.linalg.norm(run.q - run_of("edmc", DT / 100.0).q, axis=2).max())


@pytest.mark.parametrize("method", THROWING)
def test_a_first_step_that_throws_a_node_off_tells_no_error(method):
    run = run_of(method, DT)
    assert run.ok and run.error_estimate is None and off(run) > 0.5  # of a way of less than that in truth
    assert thrown(run) > OF_FASTEST * np.abs(run.v).max()
    (said,) = [text for text in run.warnings if "throws a node off" in text]
    assert said.startswith(f"{method}: its first step") and said.endswith(
        f'Take a smaller step than dt={DT:.3g} s, or method="edmc".'
    )


@pytest.mark.parametrize("method", THROWING)
def test_a_first_step_that_is_resolved_is_no_throw(method):
    run = run_of(method, DT / 10.0)
    assert thrown(run) is None and run.error_estimate is not None and not run.warnings and off(run) < 1e-3


@pytest.mark.parametrize(("share", "told"), [(1.9, False), (0.9, True)])
def test_an_explicit_step_that_does_not_resolve_the_dampers_of_the_start_tells_no_error(share, told):
    """A light point that a ground presses out creeps with k s/c = 20 m/s; a step of h c/m = 1.9 let it fly with 38 m/s."""
    scene = Scene(
        [Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=1e-3, at=(0.0, 0.0, -1.0))],
        [Cable("a", "b", length=2.0, mass_per_length=1e-3, EA=1e3, segments=1, diameter=0.004)],
        [Ground(height=1.0)],
    )
    area, m = 0.004 * 1.0, 2e-3
    steps = {"t_end": 1e-3, "start": "straight", "method": "symplectic_euler"}
    run, fine = (simulate(scene, dt=part * m / (3e5 * area), **steps) for part in (share, 0.05))
    wrong = np.linalg.norm(run.final.q - fine.final.q, axis=1).max()
    assert fine.velocity("b")[-1, 2] == pytest.approx(20.0, rel=0.02)
    assert (run.error_estimate is not None) == told and bool(wrong < 1e-3) == told
    assert any("throws a node off with 38 m/s" in text for text in run.warnings) != told


@pytest.mark.parametrize("method", ["edmc", "backward_euler"])
def test_what_never_raises_the_energy_throws_nothing(method):
    """But the velocity of 5 m/s that it leaves the ground with is off by 0.08 m/s, and it flies with that, which the run says."""
    run = run_of(method, DT)
    assert thrown(run) is None and 0.2 * off(run) < run.error_estimate < 1.2 * off(run) < 0.03
    (said,) = [text for text in run.warnings if "does not resolve the forces at the start" in text]
    assert said.startswith(f"{method}: its first step gives a node") and said.endswith(f"take a smaller step than dt={DT:.3g} s.")
    assert unresolved_start(run) == pytest.approx(4.8, abs=0.1)  # after ten steps, with 0.1 m/s less by gravity


def test_what_the_ground_takes_of_its_own_lets_no_error_fade():
    """Of 11 kJ that the ground holds, 12 J become motion: what the first steps are off by is not forgotten as the rest is taken."""
    dt = DT / 20.0
    run, fine = run_of("edmc", dt), run_of("edmc", dt / 20.0)
    true = np.linalg.norm(run.q - fine.q, axis=2).max()
    assert not run.warnings and 0.25 * true < run.error_estimate < true  # told a 50th of it without the ground's energy


def test_an_error_that_is_asked_for_is_compared_with_another_run():
    run = simulate(inside(), T_END, method="tr_bdf2", error=0.05, start="straight")
    every = run.t[1] - run.t[0]
    fine = simulate(inside(), T_END, method="edmc", dt=every / 50.0, save_every=every, start="straight")
    kept = np.linalg.norm(run.q - fine.q, axis=2).max() < 0.05
    assert run.kept is bool(kept) and (kept or any("places are known to" in text for text in run.warnings))
