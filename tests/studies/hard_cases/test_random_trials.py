"""Random nets, starts, paths, methods and steps: each run ends well with its energy accounted for, or says why not."""

import numpy as np
import pytest
from drawn import Drawn
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from slow import slow
from tried import tried

from anet_lumped import Cable, Fixed, Free, InputError, Scene, SceneError, simulate
from anet_lumped.effects import Gravity
from anet_lumped.motion import accuracy
from anet_lumped.results.run import Run
from studies.catalogue import random_trials
from studies.catalogue.random_trials import FAILED, GAINED, HELD, REFUSED, Random, Trial, attempt, draw, try_many


@pytest.mark.slow
@tried(60, derandomize=True, suppress_health_check=list(HealthCheck), database=None)
@given(st.data())
def test_no_run_fails(monkeypatch, data):
    """No NaN called success, no error but the library's own, no energy out of nothing where a method promises none."""
    monkeypatch.setattr(random_trials, "MOST_COMPARED", 2000)  # one run in sixty takes more, and four times those beside it
    monkeypatch.setattr(accuracy, "BUDGET", 1e5)  # what is drawn depends on what else was imported: some runs would take minutes
    monkeypatch.setattr(accuracy, "BUDGET_OF_FIRST", 1.0)
    monkeypatch.setattr(random_trials, "_told", lambda trial, run: (HELD, ""))  # judged below, where trials are the same each time
    try:
        trial = draw(Drawn(data))
    except SceneError as error:
        assert len(str(error)) > 20
        return
    outcome, why = attempt(trial)
    assert outcome != FAILED, f"{why}: {trial}"


def test_random_trials_are_the_same_again_and_of_every_kind():
    assert draw(Random((7, 3))) == draw(Random((7, 3)))
    scenes = [draw(Random((7, number))).scene for number in (0, 2, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 15, 101, 523)]
    assert {"Bending", "Water", "Ground"} <= {type(effect).__name__ for scene in scenes for effect in scene.effects}
    assert any(cable.tension_strain for scene in scenes for cable in scene.cables)
    rigid = [trial for trial in (draw(Random((7, number))) for number in range(30, 60)) if trial.scene.cables[0].inextensible]
    assert {"links", "edmc"} <= {trial.method for trial in rigid}


@pytest.mark.parametrize("first, count", [(58, 12), *slow((50, 40))])
def test_random_trials_hold_or_are_refused(first, count):
    found = try_many(7, first, count)
    assert [one["number"] for one in found] == list(range(first, first + count))
    assert {HELD, REFUSED} <= {one["outcome"] for one in found}
    assert not [one for one in found if one["outcome"] == FAILED]


def test_a_net_let_go_stretched_many_times_forgets_little_of_its_errors():
    """Of 17 times its length, by dampers that take 1e5 times what it moves with: "kept 0.35 mm" was off by 6.5 mm."""
    assert attempt(draw(Random((7, 530)))) == (HELD, "")


def test_waves_that_lift_a_net_and_a_cut_at_rest_are_no_energy_out_of_nothing():
    """Waves gave all that was in play by `links`; after the cut `edmc` has other lengths, by 2e-11 m where 1e-10 are allowed."""
    assert attempt(draw(Random((51001, 140)))) == (HELD, "")
    assert attempt(draw(Random((51001, 118)))) == (HELD, "")


@pytest.mark.slow
def test_thousands_of_steps_may_miss_more_of_the_balance_than_ten():
    """6300 steps of a frame that does not stretch and bears 100 kg miss 3e-4 J by Newton's tolerance, 6e-6 J by a hundredth."""
    assert attempt(draw(Random((51004, 901)))) == (HELD, "")


def test_without_surroundings_scenes_have_gravity_and_viscous_damping_alone():
    scenes = [draw(Random((7, number)), surroundings=False).scene for number in (0, 2, 4, 5, 6, 7, 8, 9, 10)]
    assert {type(effect).__name__ for scene in scenes for effect in scene.effects} == {"Gravity", "ViscousDamping"}


# --- the audit itself ---------------------------------------------------------------------------------------------------


def trial(method="edmc", **changes):
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))],
        [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=10)],
        [Gravity()],
    )
    return Trial(**{"scene": scene, "t_end": 0.1, "method": method, "dt": 0.01, "rtol": None, "start": "straight"} | changes)


def tampered(monkeypatch, change):
    """Have `simulate` hand out runs that are changed."""

    def changed(*args, **kwargs):
        run = simulate(*args, **kwargs)
        change(run)
        return run

    monkeypatch.setattr(random_trials, "simulate", changed)


def test_a_good_run_holds():
    assert attempt(trial()) == (HELD, "")


def test_energy_out_of_nothing_fails(monkeypatch):
    def put_in(run):
        run.energy[-1, 0] += 1e-3 * np.ptp(run.energy[:, 2])

    def put_back(run):
        run.energy[-1] = run.energy[-2]
        put_in(run)

    tampered(monkeypatch, put_in)
    outcome, why = attempt(trial())
    assert outcome == FAILED and "balance of energy is off by" in why
    tampered(monkeypatch, put_back)
    outcome, why = attempt(trial("backward_euler"))
    assert outcome == FAILED and "backward Euler raises the energy" in why


def test_a_nan_called_done_fails(monkeypatch):
    tampered(monkeypatch, lambda run: run.q.__setitem__((-1, 0, 0), np.nan))
    assert attempt(trial()) == (FAILED, "done, yet not finite")


@pytest.mark.parametrize(("error", "outcome"), [
    (IndexError("index 7 is out of bounds"), FAILED),
    (ValueError("shapes must match"), FAILED),  # such as NumPy raises, whatever the words
    (InputError("the step is too long"), REFUSED),
    (InputError(""), FAILED),
])  # fmt: skip
def test_an_error_is_a_refusal_if_it_is_the_librarys_own_and_has_words(monkeypatch, error, outcome):
    def break_down(run):
        raise error

    tampered(monkeypatch, break_down)
    assert attempt(trial()) == (outcome, f"{type(error).__name__}: {error}")


@pytest.mark.parametrize(("changes", "words"), [
    ({"method": "verlet", "dt": 0.1}, "its step is beyond the largest stable one"),
    ({"start": "nowhere"}, "must be"),
    ({"method": "Radau", "dt": None, "t_end": 100.0}, "force evaluations were not enough"),
])  # fmt: skip
def test_a_refusal_has_words(changes, words):
    outcome, why = attempt(trial(**changes))
    assert outcome == REFUSED and words in why


def test_a_gain_is_counted_for_those_that_promise_nothing(monkeypatch):
    tampered(monkeypatch, lambda run: run.energy.__setitem__((-1, 0), 100.0))
    assert attempt(trial("midpoint"))[0] == GAINED


def test_an_error_told_far_too_small_fails(monkeypatch):
    """A swing that tells a thousandth of what it knows; a run that says that its motion multiplies errors is not judged."""
    swing = trial(t_end=0.4)
    assert attempt(swing) == (HELD, "")
    tampered(monkeypatch, lambda run: object.__setattr__(run, "error_factor", 1e-3))
    outcome, why = attempt(swing)
    assert outcome == FAILED and "edmc tells an error of" in why and "but an eighth of its step is" in why
    monkeypatch.setattr(Run, "multiplies", 50.0)
    assert attempt(swing) == (HELD, "")
