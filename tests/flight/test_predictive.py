"""Model-predictive control: its model, its plan against Riccati's recursion, and loads that are brought to a place."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import InputError, load_scene
from anet_lumped.flight.fly import fly
from anet_lumped.flight.predictive import TUNED, UNTUNED, PlanError, PredictiveControl, predictive
from anet_lumped.flight.scenarios import PREDICTIVE, Scenario, controller_for
from anet_lumped.flight.slung_load import slung_load

casadi = pytest.importorskip("casadi")

HOVER = load_scene("quadrotor_hover")
CORD = replace(HOVER, cables=[replace(HOVER.cables[0], mass_per_length=0.001, segments=10)])
START = np.array([0.0, 0.0, -1.05])  # of the load
AHEAD = np.array([0.0, 1.0, 0.0])
G = 9.81


def hovering_state(model):
    """The state in which nothing moves, and its force."""
    return np.array([0.0] * 8 + [-1.0] + [0.0] * 9), np.array([0.0, 0.0, model.weight])


def slopes(function, x, u):
    """Derivatives of both results of a function (x, u) by x and by u, from central differences."""
    d, found = 1e-5, []
    for k in (0, 1):
        found.append([np.array(function(x + d * e, u)[k] - function(x - d * e, u)[k]).ravel() / (2 * d) for e in np.eye(18)])
        found.append([np.array(function(x, u + d * e)[k] - function(x, u - d * e)[k]).ravel() / (2 * d) for e in np.eye(3)])
    return [np.array(rows).T for rows in found]


def test_the_model_is_a_compound_pendulum_on_a_quadrotor():
    """At rest with no force missing; and its sway has omega^2 = g/l (m + b)/m, as two masses on a rod have it."""
    model = slung_load(HOVER, (15.0, 0.8))
    assert model.weight == pytest.approx((1.04 + 0.1 + 0.01) * G)
    first, second = (0.01 * 1.05**k + 0.1 * (1.05 ** (k + 1) - 0.05 ** (k + 1)) / (k + 1) for k in (1, 2))
    assert (model.swinging * model.arm, model.swinging * model.arm**2) == pytest.approx((first, second))
    x, u = casadi.SX.sym("x", 18), casadi.SX.sym("u", 3)
    rates = casadi.Function("rates", [x, u], list(model.rates(casadi, x, u)))
    at, force = hovering_state(model)
    assert np.array(rates(at, force)[0]).ravel() == pytest.approx(np.zeros(18), abs=1e-12)
    A = slopes(rates, at, force)[0]
    sway = np.sqrt(G / model.arm * (model.mass + model.swinging) / model.mass)
    assert np.abs(np.linalg.eigvals(A).imag - sway).min() < 1e-6
    assert np.array(rates(at, 1.1 * force)[1]).ravel()[12:15] == pytest.approx((0.0, 0.0, 0.1 * G))  # the load is lifted


@pytest.mark.parametrize("weights", [UNTUNED, TUNED], ids=["untuned", "tuned"])
def test_near_hovering_the_plan_is_that_of_the_riccati_recursion(weights):
    control = PredictiveControl(CORD, START, weights=weights, intervals=8)
    model, N = control.model, control.intervals
    at, force = hovering_state(model)
    A, B, C, D = slopes(model.step(casadi, control.interval), at, force)
    W = np.concatenate(weights) / np.max(weights)
    ends, starts = np.diag(W * (np.arange(18) < 12)), np.diag(W * (np.arange(18) >= 12))
    P = C.T @ ends @ C
    for k in range(N):  # from the last interval to the first, whose start is given
        S, R = C.T @ starts @ D, D.T @ starts @ D
        gain = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A + S.T)
        P = (C.T @ ends @ C if k < N - 1 else 0.0) + C.T @ starts @ C + A.T @ P @ A - gain.T @ (B.T @ P @ A + S.T)
    off = 1e-4 * np.random.default_rng(3).normal(size=18)
    off[8] = -0.5 * (off[6] ** 2 + off[7] ** 2)  # directions keep their length
    off[9:12] -= off[11] * np.array([0.0, 0.0, 1.0])
    _, forces = control.plan(0.0, at + off)
    expected = -gain @ off
    assert forces[:, 0] - force == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())  # squares of 1e-4 over it, some times


def test_a_factor_of_all_weights_changes_nothing():
    state = hovering_state(slung_load(CORD, (15.0, 0.8)))[0] + np.eye(18)[1] * 0.1
    plans = []
    for factor in (1.0, 1e6):
        weights = UNTUNED._make(tuple(factor * x for x in row) for row in UNTUNED)
        plans.append(PredictiveControl(CORD, START, weights=weights, intervals=4).plan(0.0, state)[1])
    assert plans[0] == pytest.approx(plans[1], abs=1e-9)


@pytest.mark.slow
def test_a_load_is_brought_to_its_place():
    """By 1 m, within 50 ms and by the name of the controller: the plan knows no more of the way than its end."""
    controller = controller_for(CORD, Scenario(PREDICTIVE, 3.0, [(0.0, (0, 0, 0)), (0.05, AHEAD)]))
    run = fly(CORD, controller, 3.0)
    load, solves = run.position("load"), controller.position.controller.solves
    assert run.ok and len(solves) == 30 and run.energy_balance.imbalance < 1e-6
    assert load[-1] == pytest.approx(START + AHEAD, abs=0.02)
    assert load[:, 1].max() < 1.02


@pytest.mark.slow
def test_tuned_weights_overshoot_more():
    """They hardly weigh velocities."""
    run = fly(CORD, predictive(CORD, START + AHEAD, weights=TUNED), 2.4)
    assert run.ok and 0.05 < run.position("load")[:, 1].max() - 1.0 < 0.10


def test_bounds_hold_and_a_plan_that_is_not_found_is_told():
    control = PredictiveControl(CORD, START + 50.0 * AHEAD, intervals=8)
    at, _ = hovering_state(control.model)
    _, forces = control.plan(0.0, at)
    assert (np.hypot(forces[0], forces[1]) <= np.tan(0.6) * forces[2] + 1e-6).all() and np.abs(forces[1]).max() > 3.0
    assert (np.linalg.norm(forces, axis=0) <= control._largest + 1e-6).all()
    control.reset()
    with pytest.raises(PlanError, match=r"No plan was found at t = 2 s: Ipopt says Invalid_Number_Detected"):
        control.plan(2.0, np.full(18, np.nan))


@pytest.mark.parametrize(
    "call, sentence",
    [
        (lambda: PredictiveControl(load_scene("quadrotors_net"), START), "has 4 quadrotors, 4 cables and 0 loads"),
        (lambda: PredictiveControl(HOVER, (0, 1)), "Argument `at` must be"),
        (lambda: PredictiveControl(HOVER, START, interval=0.0), "Argument `interval` must be positive"),
        (lambda: PredictiveControl(HOVER, START, intervals=0), "must be a whole number, 1 or more, but it is 0"),
        (
            lambda: PredictiveControl(HOVER, START, weights=1.0),
            "Argument `weights` must be Weights, such as UNTUNED, but it is 1.0",
        ),
        (lambda: PredictiveControl(HOVER, START, weights=UNTUNED._replace(velocity=(1, 1, -1))), "but `velocity` is (1, 1, -1)"),
        (lambda: PredictiveControl(HOVER, START, weights=UNTUNED._make([(0.0,) * 3] * 6)), "Some weight must be positive"),
    ],
)
def test_what_cannot_be_planned_is_refused(call, sentence):
    with pytest.raises(InputError) as refused:
        call()
    assert sentence in str(refused.value)


def test_without_casadi_one_sentence_says_what_brings_it(monkeypatch, capsys):
    from studies.command_line import main

    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(SystemExit) as ended:
        main(["fly", "quadrotor_hover", "--controller", "predictive"])
    assert ended.value.code == 1
    assert 'needs the package casadi; pip install "anet-lumped[mpc]" brings it.' in capsys.readouterr().err
