"""The default keeps an error, a step is chosen for the error that is asked for, and what cannot be kept is said."""

import math
from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, PayloadChange, Scene, State, equilibrium, paths, simulate
from anet_lumped.effects import Gravity
from anet_lumped.motion import accuracy, told_errors
from anet_lumped.motion import motion as motion_module
from anet_lumped.motion.accuracy import PILOT, Budget, cost, keep_error
from anet_lumped.motion.choice import EXPLICIT_COST, IMPLICIT_COST, SHARE_OF_TIME_SCALE, Choice, time_scale
from anet_lumped.motion.known_errors import ERROR_OF_LENGTH, TENSION_ERROR, Wanted, compared
from anet_lumped.results.distances import distances
from anet_lumped.results.energy_balance import BY_METHOD
from studies.catalogue.random_motions import random_motion
from studies.catalogue.random_trials import Random, draw


def string(T=70.0, mu=5e-4, L=0.65, EA=2e4, pull=1e-3):
    """A string whose middle is pulled down and let go: its place is a triangle wave of the frequency sqrt(T/mu)/2L."""
    half = dict(length=L / (1.0 + T / EA) / 2.0, mass_per_length=mu, EA=EA, segments=20)
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("p", mass=4.0 * T * pull / L / 9.81), Fixed("b", (L, 0.0, 0.0))]
    events = [PayloadChange("p", t=0.0, mass=0.0)]
    return Scene(points, [Cable("a", "p", **half), Cable("p", "b", **half)], [Gravity(9.81)], events=events)


def swing(EA=1e4, zeta=0.05, angle=0.6):
    end = Free("b", mass=0.05, at=(math.sin(angle), 0.0, -math.cos(angle)))
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=EA, zeta=zeta, segments=10)
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), end], [cable], [Gravity(9.81)])


def loose():
    """Without dampers, let go from horizontal: the tip whips, and the motion is chaotic then."""
    cable = Cable("a", "tip", length=1.0, mass_per_length=0.1, EA=1e4, segments=20)
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("tip", at=(1.0, 0.0, 0.0))], [cable], [Gravity(9.81)])


def climber(factor=1.8):
    """A climber of 80 kg falls ``factor`` lengths of a rope of 10 m whose EA is 20 kN, and whose mass is next to nothing."""
    rope = Cable("anchor", "climber", length=10.0, mass_per_length=1e-6, EA=20e3, segments=1)
    climber = Free("climber", mass=80.0, at=(0.1, 0.0, (factor - 1.0) * 10.0))
    return Scene([Fixed("anchor", (0.0, 0.0, 0.0)), climber], [rope], [Gravity(9.81)])


def test_a_plucked_string():
    """Its step was 1.6 of its periods once: it must cross zero 57 times in 0.1 s, and be a triangle but for its 40 segments."""
    run = simulate(string(), 0.1)
    z, f = run.position("p")[:, 2], math.sqrt(70.0 / (5e-4 * (1.0 - 0.0035))) / 1.3
    triangle = -1e-3 * (1.0 - 4.0 * np.abs(run.t * f - np.round(run.t * f)))
    assert np.sum(np.diff(np.sign(z)) != 0) in (57, 58)
    assert np.abs(z - triangle).max() < 0.2e-3
    assert run.dt < 1.0 / (20.0 * f) and run.kept and run.warnings == ()


def test_the_peak_of_a_climbers_fall():
    """m g + sqrt((m g)^2 + 2 m g h EA/L), within the 2 % that the default keeps; it was 10 % too small once."""
    run = simulate(climber(), 4.0, start="straight")
    weight = 80.0 * 9.81
    peak = weight + math.sqrt(weight**2 + 2.0 * weight * 1.8 * 20e3)
    assert run.tension("anchor-climber").max() == pytest.approx(peak, rel=0.02)


def test_a_chain_without_dampers_keeps_its_energy_or_says_what_it_lost():
    cable = Cable("a", "tip", length=1.0, mass_per_length=0.1, EA=100.0, segments=10)
    held = Scene([Fixed("a", (0.0, 0.0, 0.0)), Fixed("tip", (0.1, 0.0, 0.0))], [cable], [Gravity(9.81)])
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("tip", at=(0.1, 0.0, 0.0))], [cable], [Gravity(9.81)])
    run = simulate(scene, 2.0, start=equilibrium(held))
    balance = run.energy_balance
    lost = balance.lost_to_method / balance.in_play
    assert lost < 0.01 or any("its steps took" in text for text in run.warnings)
    coarse = simulate(scene, 2.0, start=equilibrium(held), method="edmc", dt=0.01)
    assert lost < 0.2 * coarse.energy_balance.lost_to_method / coarse.energy_balance.in_play


@pytest.mark.parametrize("error", [1e-2, 1e-3, 1e-4])
def test_an_error_that_is_asked_for(error):
    """Kept within a factor of two, by which an estimate may be off in a plain swing."""
    scene = swing()
    run = simulate(scene, 4.0, start="straight", error=error, tension_error=1.0, save_every=0.1)
    fine = simulate(scene, 4.0, start="straight", method="edmc", dt=run.dt / 8, save_every=run.t[1] - run.t[0], extrapolate=True)
    assert np.linalg.norm(run.q - fine.q, axis=2).max() < 2.0 * error
    assert f"keeps places to {error:.2g} m" in run.reason
    assert run.t[1] - run.t[0] == pytest.approx(0.1)


def test_with_a_method_of_ones_own_choice():
    runs = [simulate(swing(), 2.0, start="straight", method=name, error=1e-2) for name in ("edmc", "sdirk2", "verlet", "rk4")]
    for run in runs[1:]:
        assert np.linalg.norm(run.q[-1] - runs[0].q[-1], axis=1).max() < 3e-2


def test_a_scene_that_is_right_at_its_first_step_costs_a_pilot_more():
    """Steps tell the cost: the pilot's are an eighth of the run's."""
    corners = ((-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0))
    points = [Driven(f"s{i}", paths.line(at, (0.2, 0.0, 0.0), ramp=1.0)) for i, at in enumerate(corners)] + [Free("p0", mass=0.036)]
    cables = [Cable(f"s{i}", "p0", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=10) for i in range(4)]
    scene, steps = Scene(points, cables, [Gravity(9.81)]), []

    whole = motion_module.march_legs

    def counted(*arguments, **more):
        run = whole(*arguments, **more)
        steps.append(run.work.steps)
        return run

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(motion_module, "march_legs", counted)
        run = simulate(scene, 6.0)
    assert run.dt == pytest.approx(SHARE_OF_TIME_SCALE * time_scale(scene), rel=0.01)
    assert len(steps) == 2 and steps[0] <= (PILOT + 0.01) * steps[1] and steps[1] == run.work.steps
    assert run.error_estimate < ERROR_OF_LENGTH


def test_a_run_that_is_gone_back_to_says_which_shorter_step_was_tried():
    """Where the shorter steps tell larger errors, of places and of tensions, the run before them is what comes back."""
    tried = []

    def march(choice, duration, save_every=None):
        run = simulate(swing(), duration, start="straight", method="edmc", dt=choice.dt, save_every=save_every)
        tried.append(choice.dt)
        if len(tried) == 1:
            return run
        energy = run.energy.copy()
        energy[:, BY_METHOD] += 10.0 * np.arange(len(run.t))  # [J], as if vibrations had lost it
        return replace(run, error_growth=1e6 * run.error_growth, energy=energy)

    choice = Choice("edmc", 0.02, "", math.inf, ())
    run = keep_error(march, choice, Wanted(1e-12, 1e-12), 1.0, 1.0)
    assert run.dt == tried[0] == 0.02 and len(tried) == 2 and not run.kept
    words = f"; dt={tried[1]:.3g} s was tried too, and told larger errors, of rounding or of vibrations that it shows"
    assert run.reason.endswith(words) and run.warnings[-1].endswith(words + ".")


def test_past_a_whip_no_step_keeps_an_error_and_the_run_says_so():
    run = simulate(loose(), 1.5, start="straight")
    (said,) = [text for text in run.warnings if "places are known" in text]
    assert run.kept is False
    assert "until t=" in said and "at the end" in said and said.split(" s: ", 1)[1].rstrip(".") in run.reason
    until = float(said.split("until t=")[1].split(" s")[0])
    assert 0.3 < until < 0.7  # the whip is at 0.57 s
    fine = simulate(loose(), until, start="straight", method="edmc", dt=1e-4)
    own = run.t <= until
    there = np.searchsorted(fine.t, run.t[own] - 1e-9).clip(max=len(fine.t) - 1)
    near = np.abs(fine.t[there] - run.t[own]) < 1e-9
    assert np.linalg.norm(run.q[own][near] - fine.q[there][near], axis=2).max() < 4e-3  # a millimetre, by an estimate


def test_the_default_stops_at_its_budget_and_an_error_that_is_asked_for_goes_on(monkeypatch):
    """All runs together cost no more than the budget; the last one says what it is worth, and how to go further."""
    marched, whole = [], motion_module.march_legs

    def counted(*arguments, **more):
        marched.append(whole(*arguments, **more))
        return marched[-1]

    monkeypatch.setattr(motion_module, "march_legs", counted)
    monkeypatch.setattr(accuracy, "BUDGET", 100e3)
    run = simulate(loose(), 1.0, start="straight")
    assert len(marched) > 1 and run is not marched[0] and sum(map(cost, marched)) <= 100e3
    assert run.ok and run.kept is False and run.dt == min(one.dt for one in marched)
    (said,) = [text for text in run.warnings if "places are known" in text]
    assert "beyond the budget of 1e+05 Newton iterations times nodes; error=0.001 has 10 times that" in said
    assert said.split(" s: ", 1)[1].rstrip(".") in run.reason
    monkeypatch.setattr(accuracy, "BUDGET", 10e3)
    monkeypatch.setattr(accuracy, "BUDGET_OF_FIRST", 1.0)
    marched.clear()
    asked = simulate(loose(), 1.0, start="straight", error=0.01)  # has ten times that
    assert 10e3 < sum(map(cost, marched)) <= 100e3 and asked.dt < marched[0].dt
    marched.clear()
    asked = simulate(loose(), 1.0, start="straight", error=1e-5)  # not even that is enough, so it is not spent
    assert len(marched) == 1 and "the budget of 1e+05 Newton iterations times nodes; dt=" in asked.reason
    needed = int(asked.reason.rsplit("about ", 1)[1].split(" times")[0])
    assert 0.5 < needed / math.sqrt(asked.error_estimate / (accuracy.AIM * 1e-5)) < 2.0  # steps of a method of order 2
    other = simulate(loose(), 1.0, start="straight", error=0.5)  # the largest tension has not, which was not asked for
    assert other.dt > run.dt and "the budget of 1e+04 Newton iterations times nodes; tension_error=0.02 has 10" in other.reason


def test_a_run_whose_first_steps_cost_much_may_cost_eight_times_as_much():
    coarse = simulate(swing(), 1.0, start="straight", method="edmc", dt=0.02)
    budget = Budget()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(accuracy, "BUDGET", 1.0)
        budget.spend(coarse, 0.5)  # with half the steps of the first choice: the budget is of that choice
    assert budget.parts(coarse, 50, 39.0, asked=True) == 39 and budget.parts(coarse, 50, 40.0, asked=True) == 3
    assert budget.most == 4.0 * cost(coarse) and budget.parts(coarse, 8, 8.0) == 3 and budget.parts(coarse, 2, 2.0) == 2
    verlet = simulate(swing(), 0.1, start="straight", method="verlet")
    assert cost(verlet) == pytest.approx(verlet.work.steps * verlet.model.n_free * EXPLICIT_COST / IMPLICIT_COST)


def test_a_tension_that_is_not_kept_between_saved_states_asks_for_more_of_them():
    """The damper of a cable that catches a weight is at its peak at once; steps are a tenth of what is saved."""
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-6, EA=2e3, BA=100.0, segments=1)
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=1.0, at=(0.0, 0.0, 0.0))]
    scene = Scene(points, [cable], [Gravity(9.81)])
    run = simulate(scene, 1.0, start="straight", save_every=0.01)
    assert run.kept is False
    assert "or its peak is between saved states, of which a smaller save_every has more" in run.reason
    assert told_errors._or_are_saved(simulate(loose(), 0.1, start="straight", dt=0.01)) == ""


def test_at_rest_nothing_is_refined():
    """A net at rest moves by Newton's tolerance only, of which no error is to be kept."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=10)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=0.1)], [cable], [Gravity(9.81)])
    run = simulate(scene, 1.0)
    assert run.dt == pytest.approx(SHARE_OF_TIME_SCALE * time_scale(scene), rel=0.02) and run.warnings == ()


def test_a_run_that_ends_after_a_step_of_the_first_choice_takes_as_many_as_an_error_is_seen_in():
    """A weight that is hit at rest, on a rope with strong dampers: of one step "kept 1 mm" came out, where 17 mm were wrong."""
    end = 0.006
    rope = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=100.0, segments=5)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=0.1, at=(0.0, 0.0, -1.0))], [rope], [Gravity(9.81)])
    start = State.of(scene, velocities={"b": (40.0, 0.0, 0.0)})
    run, one, fine = (simulate(scene, end, start=start, **steps) for steps in ({"error": 1e-3}, {"dt": end}, {"dt": end / 4096}))
    assert run.kept and np.linalg.norm(run.final.q - fine.final.q, axis=1).max() < 1e-3
    assert one.error is None and np.linalg.norm(one.final.q - fine.final.q, axis=1).max() > 0.01


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"error": 0.0}, r"Argument `error` must be positive and finite \[m\], but it is 0.0"),
        ({"error": math.nan}, "Argument `error` must be positive and finite"),
        ({"tension_error": -1.0}, "Argument `tension_error` must be positive and finite, but it is -1.0"),
        ({"error": 1e-3, "dt": 0.01}, "choose the step of one run with a method of this package, but `dt` is given"),
        ({"error": 1e-3, "rtol": 1e-4}, "but `rtol` or `atol` is given"),
        ({"error": 1e-3, "extrapolate": True}, "but `extrapolate` is given"),
        ({"error": 1e-3, "method": "RK45"}, "but `rtol` or `atol` is given|but the method is RK45"),
    ],
)
def test_messages(options, message):
    with pytest.raises(ValueError, match=message):
        simulate(swing(), 0.1, start="straight", **options)


def test_two_runs_show_until_when_places_are_known():
    """From the first time on at which what they differ by, as far as it is left of the finer one, is more than is allowed."""
    coarse, fine = (simulate(swing(), 1.0, start="straight", method="edmc", dt=dt, save_every=0.02) for dt in (0.02, 0.01))
    error = compared(fine, coarse, Wanted(1.0, 0.02), 0.0).error
    off = fine.q.copy()
    off[30:, 0, 1] += 1.0  # what neither tells of itself
    other = replace(fine, q=off)
    known = compared(other, coarse, Wanted(2.0 * error, 0.02), 0.0)
    assert known.error > 10.0 * error
    assert known.until == pytest.approx(fine.t[30])
    assert compared(other, coarse, Wanted(2.0 * known.error, 0.02), 0.0).until == math.inf


@pytest.mark.parametrize("factor", [3.0, 1.0])
def test_two_runs_correct_what_the_finer_one_tells_of_its_largest_tension(factor):
    """By what their largest tensions differ over what the coarser one told; where they agree, both may lack the same vibration."""
    coarse, fine = (simulate(swing(), 1.0, start="straight", method="edmc", dt=dt, save_every=0.02) for dt in (0.02, 0.01))
    alike = replace(fine, segment_tension=factor * coarse.segment_tension)  # tells as much of itself, but for lost energy
    times = (1.0 - 1.0 / factor) / coarse.tension_error
    known = compared(alike, coarse, Wanted(None, 0.02), math.inf)
    assert known.tension_error == pytest.approx(min(alike.tension_error * max(times, 1.0), 1.0), rel=1e-12)
    assert (times > 1.0) == (factor > 1.0)


def test_a_vibration_that_two_runs_have_lost_is_not_kept_because_they_agree():
    """A chain that is let go at an angle: both runs lacked the same 9 % of the largest tension, and half of 3 % was told."""
    motion = random_motion(35)
    run = simulate(motion.scene, motion.t_end, start=motion.start)
    fine = simulate(motion.scene, motion.t_end, start=motion.start, method="edmc", dt=run.dt / 8.0)
    assert abs(run.peak_tension() / fine.peak_tension() - 1.0) < TENSION_ERROR


def test_the_word_of_one_run_is_not_enough_for_a_motion_that_goes_loose():
    """A net that is let go stretched up to 27 times: its pilot asked for an eighth of the step, and the run told 1.8 of 60 mm."""
    trial = draw(Random((90433, 182)))
    run = simulate(trial.scene, trial.t_end, start="straight")
    finer = simulate(trial.scene, trial.t_end, start="straight", method=run.method, dt=run.dt / 4.0, save_every=run.t[1] - run.t[0])
    off = np.linalg.norm(run.q - finer.q, axis=2).max()
    assert off > 10.0 * Wanted(None, TENSION_ERROR).of_places(run)
    assert run.kept is False and 0.25 < run.error_estimate / off < 4.0


def test_a_net_that_swings_far_is_judged_beside_a_coarser_run():
    """Its tensions pump what lies across the motion, five times a state that is saved: one run told 5.2 of 61 mm, and was kept."""
    corners = [(-5.0, -5.0, 0.0), (5.0, -5.0, 0.0), (5.0, 5.0, 0.0), (-5.0, 5.0, 0.0)]
    points = [Driven(f"s{i}", paths.line(at, velocity=(3.0, 0.0, 0.0), ramp=0.1)) for i, at in enumerate(corners)]
    cables = [Cable(f"s{i}", "p0", length=10.0, mass_per_length=0.337, EA=7.8e6, zeta=0.1, segments=12) for i in range(4)]
    scene = Scene([*points, Free("p0", mass=0.036)], cables, [Gravity(9.81)])
    run = simulate(scene, 20.0, error=0.02, tension_error=1.0)
    finer = simulate(scene, 20.0, method="edmc", dt=run.dt / 8.0, save_every=run.t[1] - run.t[0])
    off = np.linalg.norm(run.q - finer.q, axis=2).max()
    assert run.kept and off < 0.02 and run.error_estimate > off / 4.0


def test_a_correction_of_a_node_that_is_caught_is_asked_of_a_third_run():
    """A weight on one segment is caught and flies off: eight times as long a step told so much too much that 2.5 mm became 0.3."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.13060211217440765, EA=19748.419930827313, zeta=0.02, segments=1)
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=0.9898811791345818, at=(0.10477099566965434, 0.0, -0.31431298700896304))]
    run = simulate(Scene(points, [cable], [Gravity(9.81)]), 3.0 * math.sqrt(1.0 / 9.81), start="straight")
    fine = simulate(run.scene, run.t[-1], start="straight", method=run.method, dt=run.dt / 32.0, save_every=run.t[1] - run.t[0])
    assert run.kept and np.linalg.norm(run.q - fine.q, axis=2).max() < 1e-3


def test_links_that_are_caught_at_a_blow_are_not_known_better_because_two_runs_agree():
    """When a blow falls no step tells better than itself: two runs agreed, and 0.8 mm were told of 12 mm that were kept to 2.4."""
    cable = Cable("a", "b", length=2.375718059310452, mass_per_length=0.17938448658410353, EA=math.inf, segments=3)
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("b", at=(2.3119958469718878, 0.0, 0.5465450584522418))]
    run = simulate(Scene(points, [cable], [Gravity(9.81)]), 1.1966323584059153, start="straight")
    finer = simulate(
        run.scene, 1.1966323584059153, start="straight", method="edmc", dt=run.dt / 16.0, save_every=run.t[1] - run.t[0]
    )
    off = np.linalg.norm(run.q - finer.q, axis=2).max()
    assert off < 1.3 * Wanted(None, TENSION_ERROR).of_places(run) or (run.kept is False and run.error_estimate > off / 4.0)


@pytest.mark.parametrize(("steps", "parts"), [(50, 8), (1041, 4), (5003, 3), (1041, 7)])
def test_runs_that_are_compared_have_all_states_of_the_coarser_one(steps, parts):
    """Each with some 400 states in its own rhythm, runs had two states in common, where they agreed to 6 of 600 mm."""
    duration = 0.5
    coarse = simulate(swing(), duration, start="straight", method="edmc", dt=duration / steps)
    finer = Choice("edmc", coarse.dt / parts, "", math.inf, ())
    apart = accuracy._within(coarse, finer, duration)
    run = simulate(swing(), duration, start="straight", method="edmc", dt=finer.dt, save_every=apart)
    assert len(distances(run, coarse).rows) == len(coarse.t) and 150 < len(run.t) < 850
    longer = replace(finer, dt=4.0 * finer.dt)
    beside = simulate(swing(), duration, start="straight", method="edmc", dt=longer.dt, save_every=accuracy._beyond(run, longer))
    assert len(distances(run, beside).rows) >= len(beside.t) - 1


def test_a_motion_that_goes_loose_at_its_first_step_is_judged_beside_a_coarser_run(monkeypatch):
    """Nothing compared it where the first choice seemed to be enough; an explicit run is compared only where that is stable."""
    assert accuracy._longer(Choice("edmc", 0.01, "", math.inf, ()), 1.0, 10).dt == 0.04
    assert accuracy._longer(Choice("verlet", 0.01, "", 0.03, ()), 1.0, 10).dt == 0.02
    assert accuracy._longer(Choice("verlet", 0.01, "", 0.02, ()), 1.0, 10) is None
    marched, whole = [], motion_module.march_legs

    def counted(*arguments, **more):
        marched.append(whole(*arguments, **more))
        return marched[-1]

    monkeypatch.setattr(motion_module, "march_legs", counted)
    monkeypatch.setattr(accuracy, "AIM", 1.0)  # so that any tension is good enough
    run = simulate(loose(), 1.0, start="straight", error=1.0, tension_error=1.0)
    assert run.kept and run.multiplies == 1.0 and any(one.dt == pytest.approx(4.0 * run.dt) for one in marched)
