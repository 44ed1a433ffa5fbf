"""Every hard case: the physical statement holds, or the library says why the method does not serve.

Each case is tried with the default method, with those that promise most, and with one of the explicit methods with a given step, in
turn; `anet-lumped study hard_cases` tries each of `studies.catalogue` with every method.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from anet_lumped.results.run import Run
from integrators import schemes
from integrators.adapters import scipy_adapter
from studies.catalogue import outcome
from studies.catalogue.case import ACCURACY, ENERGY, LOAD, REST, Case, Statement, energy_rise, energy_statement
from studies.catalogue.cases import CASES, REQUIRED
from studies.catalogue.falls import _fall_time
from studies.catalogue.outcome import DEFAULT, EXTRAPOLATED, FAILED, HELD, REFUSED, bounded_work, methods_tried, try_case
from studies.catalogue.swings import ANGLE, pendulum, released, rod_tension

ALWAYS = (DEFAULT, "dop853", "edmc", EXTRAPOLATED, "backward_euler")
IN_TURN = ("symplectic_euler", "verlet", "rk4")  # one of them a case: they differ in what they do with a force, not with a case
PUMPS = ("midpoint", "sdirk2", "tr_bdf2", "generalised_alpha")  # linear theory is all that they promise
DEAR = ("swing, 10000 segments", "hour of swing", "net 10 x 10, held")  # the default only, which is edmc
LONG = (
    "cable in free flight",
    "crumple settles",
    "hairpin settles",
    "heap on one spot",
    "heap, crumple",
    "net 10 x 10, thrown",
    "payload dropped",
    "payload dropped in mid-swing",
)
HALVED_BY_ITSELF = (
    "crumple settles",
    "payload dropped",
)  # by the default, 32 times to keep its error: twice as many steps again are millions
DEAR_TO_DOP853 = ("folded chain falls", "water, into at 2 m/s", "net 10 x 10, thrown")  # beside which it is tried in quicker ones
TRIED = [
    (case, method)
    for i, case in enumerate(CASES)
    if case not in DEAR
    for method in (*ALWAYS, IN_TURN[i % len(IN_TURN)])
    if method != "dop853" or case not in DEAR_TO_DOP853
]


def is_slow(case, method):
    """The default where it shortens its steps often; of all others each case is left with one, in turn."""
    if method == DEFAULT:
        return case in LONG
    number, others = list(CASES).index(case), ("edmc", "backward_euler", "dop853", IN_TURN, EXTRAPOLATED)
    kept = others[number % len(others)]
    return method not in kept if kept is IN_TURN else method != kept


@pytest.mark.slow
@pytest.mark.parametrize("case", DEAR)
def test_statement_of_a_long_case_holds(case):
    found = try_case(CASES[case](), DEFAULT)
    assert found.outcome == HELD and found.method == "edmc", found.reason


@pytest.mark.parametrize(
    ("case", "method"), [pytest.param(*pair, marks=pytest.mark.slow if is_slow(*pair) else ()) for pair in TRIED]
)
def test_statement_holds(case, method):
    """The default holds all; a method asked for by name holds, or refuses with a reason."""
    tried = CASES[case]()
    if case in HALVED_BY_ITSELF and method == DEFAULT:
        tried = replace(tried, measure=None)
    found = try_case(tried, method)
    assert found.outcome != FAILED, found.reason
    if found.outcome == REFUSED:
        assert method != DEFAULT and len(found.reason) > 20
    if method == "edmc" or (method == "backward_euler" and "EA inf" not in case):
        assert found.outcome == HELD, found.reason


@pytest.mark.parametrize("case", [case for case in CASES if case not in DEAR])
def test_explicit_euler_never_claims_a_swing(case):
    """No step is stable without drag, and the library says so; with drag it may hold."""
    found = try_case(CASES[case](), "explicit_euler")
    assert found.outcome != FAILED, found.reason
    if found.outcome == REFUSED:
        assert any(words in found.reason for words in ("stable at no step", "steps of", "diverged", "EA=inf")), found.reason


@pytest.mark.each_once
@pytest.mark.parametrize("method", PUMPS)
@pytest.mark.parametrize("case", ["span, taut by 1e-3", "yanked at 1 m/s", "stops dead at 10 m/s", "quadrotors apart, 1e6 N"])
def test_linear_theory_holds_where_a_cable_stays_taut(case, method):
    assert try_case(CASES[case](), method).outcome == HELD


@pytest.mark.each_once
@pytest.mark.parametrize("method", PUMPS)
@pytest.mark.parametrize("case", ["whip, EA 1e+02 N", "cable in free flight", "payload dropped", "climber's fall"])
def test_whatever_pumps_is_found_out(case, method):
    """A scheme without an energy statement holds, or the library says with numbers why not; NaN is never measured."""
    found = try_case(CASES[case](), method)
    assert not any(math.isnan(statement.value) for statement in found.statements)  # inf: half the step did not reach its end
    assert found.outcome in (HELD, REFUSED) and (found.outcome == HELD) == (not found.reason)


@pytest.mark.parametrize(("case", "method", "words"), [
    ("swing, EA 1e+04 N", "midpoint", "longer than it is unstretched, where its tension stretches it by"),
    ("swing, EA 1e+07 N", EXTRAPOLATED, "longer than it is unstretched, where its tension stretches it by"),
    ("folded chain falls", "sdirk2", "were dissipated beyond what was there"),
    ("span, taut by 1e-3", EXTRAPOLATED, "which is far from a limit"),
])  # fmt: skip
def test_a_run_that_says_what_is_wrong_with_it_is_refused(case, method, words):
    """What was measured is kept beside the reason: a statement of the kinds that a caveat excuses is broken."""
    found = try_case(CASES[case](), method)
    assert found.outcome == REFUSED and words in found.reason
    assert {statement.kind for statement in found.statements if not statement.holds} <= {ACCURACY, REST, LOAD}


def test_what_a_caveat_does_not_excuse_fails():
    case = CASES["swing, EA 1e+04 N"]()
    wrong = replace(case, judge=lambda run: [Statement(ENERGY, "energy", 2.0, most=1.0)])
    assert try_case(wrong, "midpoint").outcome == FAILED


@pytest.mark.parametrize("method", ["DOP853", "Radau", "BDF", "LSODA"])
def test_scipy_holds_the_quadrotors(method):
    assert try_case(CASES["quadrotors apart, 1e3 N"](), method).outcome == HELD


@pytest.mark.parametrize("method", ["RK45", "DOP853", "Radau", "BDF", "LSODA"])
def test_scipy_refuses_what_takes_too_long(method):
    found = try_case(CASES["swing, EA 1e+09 N"](), method)
    assert found.outcome == REFUSED
    assert "steps" in found.reason or "force evaluations were not enough" in found.reason


# --- the judge itself ---------------------------------------------------------------------------------------------------


def test_a_broken_statement_fails_with_its_numbers():
    case = CASES["gravity upwards"]()
    wrong = replace(case, judge=lambda run: [Statement(LOAD, "length", 2.0, 0.5, 1.0, "m")])
    found = try_case(wrong, "edmc")
    assert found.outcome == FAILED
    assert found.reason == "length is 2 m and must be at least 0.5 and at most 1 m"
    assert not Statement(LOAD, "", math.nan, most=1.0).holds


def test_a_default_that_refuses_has_failed():
    case = CASES["net, steps of 0.1 s"]()
    assert try_case(case, "verlet").outcome == REFUSED  # beyond its limit, says the warning
    lost = Case("", case.scene, 1.0, start="nowhere")
    assert try_case(lost, DEFAULT).outcome == FAILED and try_case(lost, "edmc").outcome == REFUSED


def test_too_many_steps_are_counted():
    found = try_case(CASES["swing, EA 1e+09 N"](), "verlet")
    assert found.outcome == REFUSED and "verlet would need" in found.reason and "steps of" in found.reason
    assert found.dt < 1e-5


def test_energy_out_of_nothing_is_seen():
    """The rise is that above the least energy before, over what is in play; work put in is no rise."""
    rows = np.array([[0, 0, 1, 0, 0], [0.5, 0, 0.5, 0, 0], [1.0, 0.2, 0, 0, 0], [3.2, 0, 0, 2.0, 0]], float)
    run = object.__new__(Run)
    for name, value in {"energy": rows, "method": "edmc"}.items():
        object.__setattr__(run, name, value)
    assert energy_rise(run) == pytest.approx(0.2 / 3.2)
    assert energy_statement(run).kind == ENERGY and not energy_statement(run).holds


def test_the_bound_of_evaluations_is_taken_back():
    before = scipy_adapter.MOST_WORK
    with pytest.raises(ZeroDivisionError), bounded_work(7):
        assert scipy_adapter.MOST_WORK == 7
        raise ZeroDivisionError
    assert scipy_adapter.MOST_WORK == before


def test_folded_chain_in_the_ideal_limit():
    """0.847213 of the time of free fall (Calkin & March 1989)."""
    assert _fall_time(1.0) / math.sqrt(2.0 / 9.81) == pytest.approx(0.847213, abs=2e-6)


def test_released_pendulum_is_in_balance_along_its_cable():
    """Its tension is (M + m below) g cos(angle) in every segment; and a heavy payload's pull is M g (3 - 2 cos a)."""
    scene = pendulum(payload=0.1)
    T = released(scene, ANGLE).tension("a-b")
    below = 0.1 + 0.01 * (1 - (np.arange(20) + 0.5) / 20)
    np.testing.assert_allclose(T, below * 9.81 * math.cos(ANGLE), rtol=1e-9)
    heavy = pendulum(payload=1e3)
    # the cable's 10 g are 1e-5 of it
    assert rod_tension(heavy, ANGLE) == pytest.approx(1e3 * 9.81 * (3 - 2 * math.cos(ANGLE)), rel=1e-4)


def test_all_methods_are_tried():
    assert set(methods_tried()) == {DEFAULT, EXTRAPOLATED, *schemes.names()}
    assert {DEFAULT, *schemes.names(own=True), EXTRAPOLATED} == {"explicit_euler", *ALWAYS, *IN_TURN, *PUMPS}


@pytest.mark.slow
def test_diffrax_holds():
    """One scene and method, for which JAX compiles."""
    assert try_case(CASES["quadrotors apart, 1e3 N"](), "Tsit5").outcome == HELD


@pytest.mark.parametrize("method", ["Tsit5", "Kvaerno5"])
def test_diffrax_refuses(method, monkeypatch):
    """With too few steps it gives up and says so."""
    monkeypatch.setattr(outcome, "node_tries", lambda scheme: 100.0)
    found = try_case(CASES["quadrotors apart, 1e3 N"](), method)
    said = ("would need", "steps tried were not enough", "too few steps to try")
    assert found.outcome == REFUSED and any(words in found.reason for words in said)


@pytest.mark.parametrize("case", list(CASES))
def test_every_case_states_what_half_the_step_may_change(case):
    found = CASES[case]()
    assert found.measure is not None and 0.0 < found.tolerance <= 0.1 and found.description


def test_everything_asked_for_is_there():
    """Each beginning is that of a case, and no case is there for nothing."""
    used = set()
    for hard, beginnings in REQUIRED.items():
        for beginning in beginnings:
            cases = {case for case in CASES if case.startswith(beginning)}
            assert cases, f"{hard}: no case begins with {beginning!r}"
            used |= cases
    assert used == set(CASES)
