"""Runs of more steps or saved states than one can mean are refused before anything is computed, with the number."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, InputError, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity
from anet_lumped.limits import BYTES, STEPS

HUNG = Scene(
    [Fixed("a", (0.0, 0.0, 0.0)), Free("b", 0.1)],
    [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=10)],
    [Gravity(9.81)],
)


@pytest.mark.parametrize(
    ("t_end", "asked", "number"),
    [
        (1.0, {"dt": 1e-300}, "1e\\+300 steps"),
        (1.0, {"dt": 5e-324}, r"1e\+308 steps"),
        (1.0, {"save_every": 1e-9}, "1e\\+09 steps"),
        (1e18, {}, r"\S+e\+\d+ steps"),
        (1e308, {}, r"1e\+308 steps"),
        (1e18, {"method": "verlet"}, r"\S+e\+\d+ steps"),
        (1e18, {"extrapolate": True}, r"\S+e\+\d+ steps"),
        (1e18, {"rtol": 1e-3}, r"\S+e\+\d+ steps"),
        (1e18, {"method": "dop853"}, r"\S+e\+\d+ steps"),
        (1e18, {"method": "Radau"}, r"\S+e\+\d+ steps"),
        (1.0, {"method": "dop853", "save_every": 1e-9}, r"\S+e\+\d+ bytes of memory"),
        (1.0, {"method": "RK45", "save_every": 1e-9}, r"\S+e\+\d+ bytes of memory"),
        (10.0, {"dt": 1e-6, "save_every": 1e-6}, r"\S+e\+\d+ bytes of memory"),
    ],
)
def test_what_a_run_would_take_is_said(t_end, asked, number):
    with pytest.raises(InputError, match=f"would take {number}, but must not take more than 1e"):
        simulate(HUNG, t_end, **asked)


def test_a_stiffness_that_no_explicit_step_resolves():
    stiff = replace(HUNG, cables=[replace(HUNG.cables[0], EA=1e28)])
    with pytest.raises(InputError, match=r"steps of \S+ s would take \S+ steps"):
        simulate(stiff, 1.0, method="verlet", start=equilibrium(HUNG))


def test_a_scene_too_large_for_the_memory():
    with pytest.raises(InputError, match=r"A scene of 1000000000000 segments would take 1e\+15 bytes of memory"):
        equilibrium(replace(HUNG, cables=[replace(HUNG.cables[0], segments=10**12)]))


def test_the_limits_can_be_moved(monkeypatch):
    monkeypatch.setenv(STEPS.variable, "5")
    with pytest.raises(InputError, match="would take 10 steps, but must not take more than 5"):
        simulate(HUNG, 0.1, dt=0.01)
    monkeypatch.setenv(STEPS.variable, "10")
    assert simulate(HUNG, 0.1, dt=0.01).status == "done"
    monkeypatch.setenv(BYTES.variable, "1e5")
    with pytest.raises(InputError, match=r"saves 401 states|saves 400 states"):
        simulate(HUNG, 0.1, method="dop853")


def test_an_error_that_would_take_too_many_steps_is_not_kept(monkeypatch):
    """The run that there is comes back, and says that the error is not kept."""
    monkeypatch.setenv(STEPS.variable, "200")
    falls = replace(HUNG, points=[HUNG.points[0], Free("b", 0.1, at=(1.0, 0.0, 0.0))])
    run = simulate(falls, 0.4, start="straight", error=1e-9)
    assert run.status == "done" and run.work.steps <= 200 and run.kept is False


def test_a_time_without_digits_for_a_step():
    with pytest.raises(InputError, match=r"t=1e\+18 s has no digits for one of 0\.01 s"):
        simulate(HUNG, 1.0, dt=0.01, start=replace(equilibrium(HUNG), t=1e18))


STILL = Scene(
    [Fixed("a", (0.0, 0.0, 0.0)), Fixed("b", (1.1, 0.0, 0.0))],
    [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=1)],
    [Gravity(9.81)],
)


@pytest.mark.parametrize("asked", [{}, {"rtol": 1e-4}, {"method": "dop853"}, {"method": "verlet"}, {"dt": 0.01}, {"audit": True}])
def test_a_scene_without_a_moving_node_runs(asked):
    run = simulate(STILL, 0.1, **asked)
    assert run.status == "done"
    np.testing.assert_allclose(run.tension("a-b"), 100.0, rtol=1e-12)


def test_solvers_of_other_packages_need_a_moving_node():
    with pytest.raises(InputError, match="need a node that moves freely, but the scene has none and the method is RK45"):
        simulate(STILL, 0.1, method="RK45")
