"""A peak between the states that a user saves is known and told, and what is asked for comes back."""

import math
from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, simulate
from anet_lumped.effects import Gravity
from anet_lumped.motion.choice import Choice
from anet_lumped.motion.judged_states import as_asked, judged_every


def caught(zeta=0.0):
    """A weight that falls a metre into a cable of 2 kN/m, which next to nothing damps."""
    cable = Cable("a", "b", length=1.0, mass_per_length=1e-6, EA=2e3, zeta=zeta, segments=1)
    return Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=1.0, at=(0.0, 0.0, 0.0))], [cable], [Gravity(9.81)])


def test_a_peak_between_saved_states_is_told():
    """m g + sqrt((m g)^2 + 2 m g h EA/L), between 0.45 and 0.53 s; the states that are saved have a tenth of it."""
    run = simulate(caught(), 0.6, start="straight", save_every=0.3)
    peak = 9.81 + math.sqrt(9.81**2 + 2.0 * 9.81 * 2e3)
    assert run.ok and run.kept and run.t == pytest.approx([0.0, 0.3, 0.6])
    assert run.q.shape[0] == run.v.shape[0] == len(run.energy) == len(run.error) == 3
    assert run.segment_tension.max() < 0.5 * peak and run.peak_tension() == pytest.approx(peak, rel=0.02)
    (said,) = [text for text in run.warnings if "in the states that are saved; a smaller save_every shows it" in text]
    assert f'is {run.peak_tension():.4g} N in cable "a-b" between t=0.3 s and t=0.6 s' in said


def test_what_saved_states_show_is_kept():
    every = simulate(caught(), 0.6, start="straight", save_every=0.005)
    assert every.kept and len(every.t) == 121 and not any("states that are saved" in text for text in every.warnings)


def test_a_run_that_saves_little_tells_the_error_that_was_judged():
    """By two states of a jerky swing alone it told 1.7 mm, beside a warning of 31 mm that all states tell."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=4)
    points = [Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=1.0, at=(0.7, 0.0, -0.7))]
    run = simulate(Scene(points, [cable], [Gravity(9.81)]), 0.3, start="straight")
    for every in (0.3, 0.1):
        fewer = as_asked(run, every)
        assert len(fewer.t) < 6 and fewer.error_estimate == pytest.approx(run.error_estimate)


@pytest.mark.parametrize(("steps", "judged"), [(7, 7), (21, 21), (41, 21), (1000, 20)])
def test_how_many_states_are_judged(steps, judged):
    """Of a run that saves twenty times: each step if those are few, else some four hundred, by steps that are hardly shorter."""
    choice = Choice("edmc", 0.05 / steps, "", math.inf, ())
    taken, every = judged_every(choice, 0.05, 1.0)
    assert every == pytest.approx(0.05 / judged)
    assert every / taken.dt == pytest.approx(round(every / taken.dt), rel=1e-12)
    assert 0.95 * choice.dt < taken.dt <= choice.dt * (1.0 + 1e-12)


def test_enough_states_are_judged_as_they_are():
    choice = Choice("edmc", 0.001, "", math.inf, ())
    assert judged_every(choice, 0.002, 1.0) == (choice, 0.002) and judged_every(choice, None, 1.0) == (choice, None)


def test_the_last_state_of_a_run_that_stopped_is_there():
    run = simulate(caught(), 0.1, start="straight", method="edmc", dt=0.01)
    stopped = replace(run, status="unconverged", message="It stopped.")
    assert as_asked(stopped, 0.04).t == pytest.approx([0.0, 0.04, 0.08, 0.1])
    assert np.array_equal(as_asked(stopped, 0.04).q[-1], run.q[-1])
