"""Answers of the studies, from made-up rows of both kinds: what holds is said, and where it does not hold the contrary is."""

import numpy as np
import pandas as pd
import pytest

from studies.accuracy_cost import work_precision_answer
from studies.accuracy_cost.comparisons import CHOICE_OVER_BEST, DEAREST_OVER_CHEAPEST, NET, PEER_OVER_OURS
from studies.accuracy_cost.contestants import OURS, OWN_CHOICE
from studies.accuracy_cost.paired_timing import UNRESOLVED
from studies.questions import effects_cost, energy_rise, model_mismatch, order, speed
from studies.questions.length_error import words as length_error
from studies.questions.stability_map import words as stability_map
from studies.questions.thesis_tables import words as thesis_tables
from studies.questions.thesis_tables.tables import SAMPLING
from studies.thesis_cable import explicit_schemes, implicit_schemes

NOISE = np.array([0.7, 1.4, 0.9, 1.2, 0.8, 1.3, 0.6, 1.1, 1.5, 1.0, 0.9, 1.2])  # of turns; their median is about 1


# effects_cost -----------------------------------------------------------------------------------------------------------


def libraries(stripped, noise=NOISE, memory=(8, 8, 8)):
    """A table of processes in which a step of verlet takes `stripped` times as long in the library without other effects."""
    rows = []
    for process, slow in enumerate(noise):
        for library, bytes_, factor in zip(effects_cost.LIBRARIES, memory, (1.0, stripped, 1.0), strict=True):
            own = noise[(process + len(library)) % len(noise)] if noise is NOISE else slow
            rows.append({"process": process, "turn": 0, "library": library, "verlet_ns": 20 * factor * own, "newton_ns": 60 * slow,
                         "memory_bytes": bytes_, "effects_imported": "gravity"})  # fmt: skip
    return pd.DataFrame(rows)


def test_an_effect_that_a_scene_lacks_costs_nothing_that_is_seen():
    words = effects_cost._lacking(libraries(1.01))
    assert words.startswith("An effect that a scene lacks costs no time that is seen here.") and UNRESOLVED in words
    assert "the same memory" in words and "imports gravity only" in words and "little" not in words


@pytest.mark.parametrize(("stripped", "told"), [(1.4, "40 % more time"), (0.7, "30 % less time")])
def test_an_effect_that_a_scene_lacks_costs_much(stripped, told):
    words = effects_cost._lacking(libraries(stripped, noise=1.0 + 1e-3 * np.arange(12), memory=(8, 8, 16)))
    assert f"is not free here: with another library a step or an iteration of the plain net takes {told}" in words
    assert "another memory" in words and "8 to 16 bytes" in words
    assert "nothing" not in words and "no time" not in words


def test_an_effect_that_a_scene_lacks_costs_next_to_nothing():
    words = effects_cost._lacking(libraries(0.99, noise=1.0 + 1e-6 * np.arange(12)))
    assert "costs next to nothing: a step of the plain net differs by 1 % at most" in words


def test_turns_of_one_process_are_one_pair():
    """Whatever a process has by chance, all its turns have: three turns of two processes resolve nothing."""
    rows = [{"process": process, "turn": turn, "library": library, "verlet_ns": 20.0 * (library == "whole") + 10, "newton_ns": 60.0,
             "memory_bytes": 8, "effects_imported": "gravity"}
            for process in range(2) for turn in range(3) for library in ("whole", "stripped")]  # fmt: skip
    found = effects_cost.ratios(pd.DataFrame(rows))
    assert set(found) == {("stripped", "verlet"), ("stripped", "newton")} and found["stripped", "verlet"].pairs == 2
    assert effects_cost._lacking(pd.DataFrame(rows)).startswith("An effect that a scene lacks takes no memory.")  # nothing of time


def test_what_an_effect_adds_is_told_where_it_is_resolved():
    turns = pd.DataFrame({
        "gravity, verlet": NOISE, "gravity, newton": NOISE, "air, verlet": 3.0 * NOISE, "air, newton": NOISE[::-1] * 1.01,
        f"{effects_cost.OWN}, verlet": 1.5 * NOISE, f"{effects_cost.OWN}, newton": NOISE[::-1],
    })  # fmt: skip
    table = pd.DataFrame([{"effect": "air", "beside": "gravity", "more_bytes": 96, "entries": 9}])
    assert "air +200 % and not resolved, 96 bytes, 9 entries" in effects_cost._having(table, turns)
    words = effects_cost._own(turns)
    assert f"an iteration of edmc {UNRESOLVED}" in words and "a step of verlet 1.5 (1.5 to 1.5)" in words


# speed ------------------------------------------------------------------------------------------------------------------


def paces(*lines):
    return pd.DataFrame(lines, columns=["EA_N", "step_s", "p0_error_mm", "times_real_time", "status"])


def test_one_pace_is_no_range():
    words = speed._finding(paces((1e4, 0.01, 0.09, 1046.0, "done"), (1e4, 0.02, 0.4, 2000.0, "done")))
    assert "runs 1046 times faster than real time at EA = 1e4 N, on one core, with edmc at 10 ms" in words
    words = speed._finding(paces((1e4, 0.01, 0.09, 1046.0, "done"), (1e8, 0.01, 0.05, 300.0, "done")))
    assert "runs 300 to 1046 times faster" in words and "EA = 1e4 to 1e8 N" in words


def test_an_accuracy_that_is_missed_is_told():
    assert "none of the steps tried" in speed._finding(paces((1e4, 0.01, 0.9, 1046.0, "done")))
    words = speed._finding(paces((1e4, 0.01, 0.09, 1046.0, "done"), (1e8, 0.01, 0.05, 300.0, "diverged")))
    assert "At EA = 1e8 N no step tried is as accurate." in words


def test_ratios_of_speed_are_of_pairs():
    turns = pd.DataFrame({"nodes": 81, "verlet, a step": NOISE, "edmc, a step": 7.0 * NOISE, speed.ACCOUNT: NOISE[::-1] * 7.0})
    words = speed._ratios(turns)
    assert "with 81 nodes 7 (7 to 7)" in words and f"and {UNRESOLVED} (" in words and "by 12 pairs each" in words


# thesis_tables ----------------------------------------------------------------------------------------------------------


def table_5_1(*errors):
    lines = [(10 * i, 10, stated, error) for i, (stated, error) in enumerate(errors, 1)]
    return pd.DataFrame(lines, columns=["samples", "points", "thesis_error_cm", "error_cm"])


def test_errors_that_come_out_and_errors_that_do_not():
    quick = pd.Series({"method": "lumped", "time_ms": 0.25, "error_mm": 0.4})
    words = thesis_tables._finding(table_5_1((3.0, 3.001), (-0.84, -0.839)), quick)
    assert "all 2 errors of Table 5.1 come out to their last digit. The method" in words and "is less than the largest" in words
    words = thesis_tables._finding(table_5_1((3.0, 2.66), (-0.04, 0.036), (0.5, 0.5)), quick)
    assert "1 of 3 errors" in words and "(20, 10) with the opposite sign" in words and "; (10, 10) is 0.34 cm off" in words
    assert "which is not less than the largest" in thesis_tables._finding(table_5_1((0.01, 0.01)), quick)


@pytest.mark.parametrize(("factor", "told"), [(1.0, "which explains the error"), (2.0, "which does not explain the error")])
def test_the_cause_of_the_bias_is_measured(factor, told):
    n = np.array([10, 100])
    bias = pd.DataFrame({"points": n, "equal_masses_mm": -200.0 / n, "half_end_masses_mm": -40.0 / (n - 1.0) ** 2,
                         "payload_mm": -200.0 * factor / n})  # fmt: skip
    words = thesis_tables._cause(bias)
    assert told in words and "power -2.00" in words and "follows from its masses" in words
    assert "follows from its masses" not in thesis_tables._cause(bias.assign(half_end_masses_mm=bias["equal_masses_mm"]))


def test_sampling_against_the_balance_of_forces():
    motion = pd.DataFrame([(net, "lumped", 0.3) for net in ("two cables", "four cables")], columns=["net", "method", "time_s"])
    quick = pd.Series({"method": "lumped"})
    turns = pd.DataFrame({SAMPLING: 0.03 * NOISE, "lumped": 0.0003 * NOISE})
    assert "is 100 (100 to 100)" in thesis_tables._times(turns, quick, motion)
    assert f"is {UNRESOLVED} (" in thesis_tables._times(turns.assign(lumped=0.03 * NOISE[::-1]), quick, motion)


# model_mismatch ---------------------------------------------------------------------------------------------------------


def mismatch(coarse_mm):
    rows = [(n, rmse, rmse, 0.01) for n, rmse in ((5, coarse_mm), (10, coarse_mm / 4))]
    return pd.DataFrame(rows, columns=["segments", "rmse_mm", "p0_error_mm", "tension_error_percent"])


@pytest.mark.parametrize(("coarse", "told"), [(3.7, "the segments do not explain it"), (40.0, "the segments may explain it")])
def test_whether_segments_explain_the_misfit(coarse, told):
    thesis, origin = pd.DataFrame({"rmse_m": [0.03, 0.04]}), pd.DataFrame({"r_squared_pooled": [0.95, 0.999]})
    words = model_mismatch._finding(mismatch(coarse), thesis, origin)
    assert told in words and "says little" in words and "R² = 0.9500 or 0.9990" in words
    steady = model_mismatch._finding(mismatch(coarse), thesis, pd.DataFrame({"r_squared_pooled": [0.95, 0.951]}))
    assert "hardly depends on the frame's origin" in steady and "says little" not in steady


# order ------------------------------------------------------------------------------------------------------------------


def orders(*lines):
    return {"orders": pd.DataFrame(lines, columns=["problem", "method", "order", "position_slope", "velocity_slope"])}


def test_slopes_that_miss_their_order_are_named():
    words = order.answer(orders(("swing", "edmc", 2, 2.01, 1.99), ("swing", "rk4", 4, 3.98, 4.0)))
    assert "Of 4 slopes of errors over the step, for positions and for velocities, 4 lie within 0.15" in words
    assert "No slope of position errors is farther from its order. No slope of velocity errors" in words
    words = order.answer(orders(("swing", "edmc", 2, 1.2, 1.99), ("swing", "rk4", 4, np.nan, 4.9)))
    assert "Of 3 slopes" in words and ", 1 lie within 0.15" in words
    assert "Farther from it are, of position errors: edmc (swing, 1.20 for 2) below the order." in words
    assert "Farther from it are, of velocity errors: RK4 (swing, 4.90 for 4) above the order." in words
    assert "all of RK4 in the swing" in words and "Symplectic Euler" not in words


# length_error -----------------------------------------------------------------------------------------------------------


def floors(rk4, euler):
    rows = [("hung", scheme, dt, 20, floor * (dt / 1e-2) ** 2) for scheme, floor in (("rk4", rk4), ("symplectic_euler", euler))
            for dt in (1e-3, 1e-2)]  # fmt: skip
    return pd.DataFrame(rows, columns=["arrangement", "scheme", "dt_s", "segments", "floor_measured"])


def cured(stretch, ended="done"):
    rows = [(scheme, dt, 1e4, stretch, stretch, 0.0, 2.0, ended) for scheme in ("edmc", "rk4") for dt in (1e-3, 1e-2)]
    names = ["scheme", "dt_s", "EA_N", "stretch_at_rest", "largest_stretch", "energy_rise", "newton_per_step", "ended"]
    return pd.DataFrame(rows, columns=names)


def test_the_floor_and_its_cure():
    springs = pd.DataFrame({"arrangement": ["hung"], "cord_is_stiffer_by": [1835.0]})
    words = length_error._finding({"springs": springs, "floor": floors(0.098, 0.196), "cure": cured(1e-5)})
    assert (
        "such springs are what an explicit step of about 10 ms enforces" in words
        and "has no such floor: all 2 of its runs" in words
    )
    words = length_error._finding({"springs": springs, "floor": floors(0.001, 0.002), "cure": cured(0.5)})
    assert "enforces" not in words and "did not get below it either" in words
    words = length_error._cure(floors(0.098, 0.196), cured(1e-5, "diverged"))
    assert "none of 2 runs reached their end" in words and "2 are below its floor; all 2 below it diverged" in words


# stability_map ----------------------------------------------------------------------------------------------------------


def failures(stable, limit=10.1):
    changes = ("as found", "k × 1.2", "k × 10", "k × 10 and environment 2 /s", "c = m/dt", "c = 10 m/dt")
    rows = [(scheme, change, 0.01, limit, change == "as found" or stable or scheme == "edmc")
            for scheme in (*stability_map.TRIED, "edmc") for change in changes]  # fmt: skip
    return stability_map.Failures(pd.DataFrame(rows, columns=["scheme", "change", "dt_s", "largest_step_ms", "stable"]))


def cells(loud=(), rise=0.5):
    """Two cells of each scheme: implicit ones fail in the whip where they are `loud`."""
    rows = []
    for scheme, dt in ((scheme, dt) for scheme in explicit_schemes() + implicit_schemes() for dt in (1e-3, 1e-2)):
        beyond = scheme in explicit_schemes() and dt > 5e-3
        rows.append({"plane": "stiffness", "scheme": scheme, "EA_N": 10.0, "damper_Ns_per_m": 1.0, "dt_s": dt, "predicted_s": 5e-3,
                     "rest_growth": 1e9 if beyond else 0.0, "whip_rise": rise if scheme in loud else 0.0, "rest_at_once": False,
                     "rest_ended": "done", "whip_ended": "done"})  # fmt: skip
    table = pd.DataFrame(rows)
    return table.assign(verdict=stability_map.verdict(table), survived=stability_map.survived(table))


def test_the_failures_of_the_thesis_are_the_border():
    words = stability_map._finding(cells(), failures(stable=False))
    assert "both failures of the thesis are the border of explicit steps" in words and "rises in none of 2 cells" in words
    words = stability_map._finding(cells(loud=["edmc"]), failures(stable=True))
    assert "both failures" not in words and "none made all explicit schemes blow up" in words and "rises in all 2 cells" in words
    assert "both failures" not in stability_map._finding(cells(), failures(stable=False, limit=0.1))


def test_implicit_schemes_that_gain_energy_and_those_that_do_not():
    words = stability_map._implicit(cells(loud=["midpoint"]))
    assert "implicit midpoint in 2 cells of the first plane and none of the second, by up to 0.5 times" in words
    assert "With edmc, backward Euler" in words
    assert "it rises with" not in stability_map._implicit(cells())
    assert "without bound in 2" in stability_map._implicit(cells(loud=["midpoint"], rise=np.inf))


def test_prediction_is_counted():
    borders = pd.DataFrame({"scheme": ["rk4"], "rest_over_predicted": [1.001], "rest_one_way_over_predicted": [0.97]})
    words = stability_map._predicted(cells(), borders)
    assert "all 8 cells" in words and "within 0.1 %" in words and "within 3.0 %" in words
    table = cells()
    wrong = table.assign(predicted_s=0.1)
    assert "4 of 8 cells" in stability_map._predicted(wrong, borders)


def test_margins_in_the_whip():
    borders = pd.DataFrame({"scheme": ["rk4", "rk4"], "damper_Ns_per_m": [0.0, 0.2], "whip_over_predicted": [0.6, 1.4]})
    rows = [("verlet", 0.8, zeta, rise) for zeta, rise in ((0.0, 40.0), (0.05, 0.0))]
    longer = pd.DataFrame(rows, columns=["scheme", "share_of_limit", "zeta", "whip_rise"])
    words = stability_map._whip(borders, longer)
    assert "needs a margin with velocity Verlet." in words and "does not help" not in words
    assert "such a damper does not help" in stability_map._whip(borders, longer.assign(whip_rise=40.0))
    assert "margin" not in stability_map._whip(borders, longer.assign(whip_rise=0.0))


# energy_rise ------------------------------------------------------------------------------------------------------------


def by_scheme(**rises):
    lines = [
        {"scheme": scheme, "runs": 4, "runs_that_gained": 3 * (rise > energy_rise.GAIN), "runs_that_say_so": 2 * (rise > 0.1),
         "worst_rise": rise, "worst_rise_zeta_to_0.05": rise, "diverged": 0, "unconverged": 0}
        for scheme, rise in rises.items()
    ]  # fmt: skip
    return {"by_scheme": pd.DataFrame(lines)}


def test_schemes_that_never_gain_energy():
    words = energy_rise._finding(by_scheme(edmc=1e-12, midpoint=40.0))
    assert "Of 2 implicit schemes edmc never gains energy" in words and "energy in play is 1e-12 with edmc" in words
    assert "no more than round-off" in words and "The worst rise with midpoint is 40 times" in words
    words = energy_rise._finding(by_scheme(edmc=1e-3))
    assert "yet more than round-off" in words and "although linear theory" not in words
    assert energy_rise._finding(by_scheme(edmc=2.0)).startswith("Every implicit scheme gains energy in some run.")
    assert "none. A rise is" in energy_rise._gains(by_scheme(edmc=0.0)) and "Of no run that gained, 0" in energy_rise._gains(
        by_scheme(edmc=0.0)
    )


def test_within_the_limit_of_verlet():
    table = pd.DataFrame({"share_of_limit": [0.4, 0.8, 0.4, 0.8], "zeta": [0.0, 0.0, 0.05, 0.05], "rise": [1e-4, 9e7, 1e-9, 1e-8]})
    assert "gains energy from 0.8 of the limit on" in energy_rise._within_the_limit(table)
    assert "gains no energy on an undamped cable" in energy_rise._within_the_limit(table.assign(rise=1e-9))


@pytest.mark.parametrize(("most", "told"), [(3.2, "hardly depends on"), (9.0, "costs depends on")])
def test_whether_stiffness_makes_steps_dear(most, told):
    table = pd.DataFrame({"EA_N": [1e4, 1e8], f"newton_per_step_zeta_{energy_rise.ZETAS[1]:g}": [3.0, most]})
    assert told in energy_rise._iterations(table)


# work_precision ---------------------------------------------------------------------------------------------------------


def races(ratio=100.0, peer=True, missed=False):
    """The carried net at two stiffnesses, with or without another engine."""
    lines = [
        {"motion": NET, "EA_N": EA, "segments": 20, "target_mm": 0.1, "best_ours": "edmc", "ours_s": np.nan if missed else 0.004,
         "ours_times_real_time": 1000.0, "best_peer": "X rk4" if peer else "", "peer_s": 0.4 if peer else np.nan,
         "peer_error_mm": 0.2, "ratio": ratio if peer else np.nan}
        for EA in (1e4, 1e8)
    ]  # fmt: skip
    spread = (0.9 * ratio, 1.1 * ratio) if ratio > 2.0 else (0.5, 2.0)
    pairs = [
        {"compared": compared, "motion": NET, "EA_N": EA, "segments": 20, "error_mm": 0.1, "median_ratio": ratio, "low": spread[0],
         "high": spread[1], "pairs": 9, "second": "edmc"}
        for compared in (PEER_OVER_OURS, CHOICE_OVER_BEST, DEAREST_OVER_CHEAPEST) for EA in (1e4, 1e8)
    ]  # fmt: skip
    runs = [
        {"motion": NET, "EA_N": EA, "segments": 20, "method": OWN_CHOICE, "engine": OURS, "status": "done", "error_mm": 0.01,
         "wall_s": 0.004, "reason": "edmc at 8 ms"} for EA in (1e4, 1e8)
    ]  # fmt: skip
    return {"equal_error": pd.DataFrame(lines), "pairs": pd.DataFrame(pairs), "runs": pd.DataFrame(runs)}


def test_another_engine_that_takes_longer():
    words = work_precision_answer._finding(races())
    assert "runs 1000 times faster than real time on one core, with edmc, at EA = 1e4 N and EA = 1e8 N." in words
    assert "The time of the best other engine (X rk4) over that is 100 (90 to 110) at EA = 1e4 N" in words


def test_another_engine_that_is_as_fast_on_this_machine():
    words = work_precision_answer._finding(races(ratio=1.1))
    assert f"is {UNRESOLVED} (0.5 to 2) at EA = 1e4 N" in words and "longer" not in words


def test_no_other_engine_and_no_method_that_is_as_accurate():
    assert "Other engines were not run" in work_precision_answer._finding(races(peer=False))
    assert "No method and setting that was tried" in work_precision_answer._finding(races(missed=True))


def test_the_librarys_own_choice_beside_the_best():
    words = work_precision_answer._choice(races(ratio=3.0))
    assert "takes longer than the best of its methods on 2 of 2 motions" in words and "is 3 (2.7 to 3.3)" in words
    words = work_precision_answer._choice(races(ratio=1.1))
    assert "on 0 of 2 motions" in words and UNRESOLVED in words


def test_cost_over_stiffness_is_resolved_or_not():
    assert "the dearest over the cheapest is 3 (2.7 to 3.3)" in work_precision_answer._stiffness(races(ratio=3.0))
    assert f"the dearest over the cheapest is {UNRESOLVED}" in work_precision_answer._stiffness(races(ratio=1.1))
