"""The thesis's three models: each finds the nets that it should, errors fall as they should, and every word is from the rows."""

import math

import numpy as np
import pandas as pd
import pytest

from anet_lumped.motion.simulate import simulate
from studies.questions import three_models as study
from studies.questions.three_models import cases, energy_method, root_finders, tables, twin, words
from studies.questions.three_models.cases import CARRIED, FLOWN, FOUR, MOTIONS, TWO, Motion

SPAN = {span.name: span for span in root_finders.SPANS}


# The energy method ------------------------------------------------------------------------------------------------------


def test_two_cables_without_a_load_are_those_of_table_5_1():
    """THESIS: 100 samples and 100 points give +0.036 cm against 0.2036 m, to the last digit stated."""
    assert 100 * (energy_method.sampled_rest(TWO, 0.0)[2] - 0.2036) == pytest.approx(0.036, abs=5e-4)


@pytest.mark.each_once
@pytest.mark.parametrize("name", cases.SUPPORTS)
@pytest.mark.parametrize("load", [0.0, 0.036])
def test_the_gradient_ends_where_samples_about_it_have_more_energy(name, load):
    supports = cases.SUPPORTS[name]
    p0 = energy_method.descended_rest(name, load)
    least = energy_method.energy(supports, p0, load)
    around = p0 + 1e-3 * np.concatenate([np.eye(3), -np.eye(3)])
    assert min(energy_method.energy(supports, at, load) for at in around) > least
    sample = energy_method.sampled_rest(name, load)
    assert np.abs(sample - p0).max() < energy_method.APART  # the least sample is one of those next to the minimum


@pytest.mark.parametrize("name", cases.SUPPORTS)
def test_equal_masses_are_a_payload_that_pulls_p0_down(name):
    """n points of equal mass are the trapezoid rule and half a point's mass more at each end of each cable."""
    n = energy_method.POINTS
    payload = 0.5 * len(cases.SUPPORTS[name]) * cases.MASS_PER_LENGTH * cases.LENGTH / (n - 1)
    free = cases.balanced(name, 0.0, elastic=False)[2]
    pulled = energy_method.descended_rest(name, 0.0)[2] - free
    assert pulled == pytest.approx(cases.balanced(name, payload, elastic=False)[2] - free, rel=0.05)  # the rule's own error


def test_a_sample_that_a_cable_does_not_reach_is_not_taken():
    supports = cases.SUPPORTS[TWO]
    beyond, within = (0.5, 0.0, 0.0), (0.5, 0.0, 0.5)
    assert math.dist(supports[0], beyond) > cases.LENGTH
    assert energy_method.least(supports, [beyond, within], 0.0) == pytest.approx(within)


def test_a_pose_of_the_energy_method_is_the_rest_carried_along():
    motion = MOTIONS[3]
    for model in (tables.DESCENDED, tables.BALANCED):
        place, _, _ = tables._poses(motion, model, 2)
        rest = cases.balanced(FOUR, motion.load, elastic=False)
        assert np.linalg.norm(place - rest) < 2e-3, model  # 1 mm of it from equal masses


# The reference ----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def flight():
    motion = Motion(FLOWN, FOUR, 0.01)
    return motion, *cases.reference(motion)


def test_the_reference_starts_at_the_elastic_catenaries(flight):
    motion, p0, _ = flight
    apart = np.linalg.norm(p0[0] - cases.balanced(FOUR, motion.load))
    coarse = simulate(motion.scene(), 0.1).position("p0")[0]
    assert apart < 0.05 * np.linalg.norm(
        coarse - cases.balanced(FOUR, motion.load)
    )  # what is left is of the next order in the segments


def test_finer_cables_tend_to_the_reference(flight):
    motion, p0, _ = flight
    errors = []
    for segments in (10, 20, 40):
        run = simulate(motion.scene(segments), motion.flight.t_end, dt=2e-3, method="edmc", save_every=cases.SAVE_EVERY)
        errors.append(np.linalg.norm(run.position("p0") - p0, axis=1).max())
    slopes = np.diff(np.log(errors)) / np.log(2)
    assert slopes == pytest.approx([-2.0, -2.0], abs=0.15)


# Rigid links ------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.skipif(not twin.installed(), reason="MuJoCo is not installed")
def test_links_feel_the_acceleration_in_the_frame_of_their_supports_alone(flight):
    motion, p0, t = flight
    dt, every = 4e-3, 10
    runs = {
        way: twin.run_twin(motion.scene(), motion.flight.t_end, flight=motion.flight, way=way, dt=dt)
        for way in (twin.FRAME, twin.MOCAP)
    }
    apart = {way: np.linalg.norm(run.p0[::every] - p0, axis=1).max() for way, run in runs.items()}
    static = np.linalg.norm(p0[0] + motion.shift(t) - p0, axis=1).max()
    assert apart[twin.FRAME] < 2e-3 < 0.1 < static
    assert apart[twin.MOCAP] == pytest.approx(static, rel=0.01)  # it hangs still
    finer = twin.run_twin(motion.scene(), motion.flight.t_end, flight=motion.flight, dt=2e-3)
    assert abs(tables._kept(finer.energy)) < 0.6 * abs(tables._kept(runs[twin.FRAME].energy)) < 6e-3  # of first order in the step


@pytest.mark.slow
@pytest.mark.skipif(not twin.installed(), reason="MuJoCo is not installed")
def test_a_step_that_is_too_long_loses_the_links(flight):
    motion, p0, t = flight
    step = twin.largest_step(motion, t, p0, 4e-3)
    assert 4e-3 <= step < twin.LAST_STEP
    lost = twin.run_twin(motion.scene(), motion.flight.t_end, flight=motion.flight, dt=2 * step)
    there = np.stack([np.interp(lost.t, t, p0[:, x]) for x in range(3)], axis=1)[lost.t <= t[-1]]
    apart = np.linalg.norm(lost.p0[: len(there)] - there, axis=1)
    assert lost.status == "failed" or apart.max() > twin.LOST


# Root finders -----------------------------------------------------------------------------------------------------------


def test_false_position_needs_thousands_of_iterations_where_bisection_needs_dozens():
    span, bracket = SPAN["2 m over 1 m"], (0.05, 10.0)
    found = {method: root_finders.bracketed(span, bracket, method) for method in ("bisection", "false position")}
    assert {method: one.iterations for method, one in found.items()} == {"bisection": 35, "false position": 17_139}
    ours = root_finders.ours(span)
    assert ours.iterations < 20
    for one in (*found.values(), ours):
        assert one.root == pytest.approx(0.2296402151, abs=1e-9) and one.status == "done"


@pytest.mark.parametrize("span", root_finders.SPANS, ids=lambda span: span.name)
def test_the_librarys_own_root_is_one_of_the_equation(span):
    found = root_finders.ours(span)
    assert found.status == "done" and found.iterations < 20
    slope = abs(root_finders.mismatch(span)(found.root * (1 + 1e-6)) - root_finders.mismatch(span)(found.root)) / 1e-6
    assert abs(root_finders.mismatch(span)(found.root)) < 1e-12 * slope + 1e-15  # a to 12 digits, and rounding of f


@pytest.mark.parametrize(
    ("span", "bracket", "method", "status"),
    [
        ("2 m over 1 m", (0.5, 10.0), "bisection", "no change of sign"),
        ("2 m over 1 m", (1e-4, 10.0), "false position", "not a number"),
        ("2 m over 1 m", (-10.0, -0.05), "bisection", "mirrored"),
        ("nearly taut", (0.05, 10.0), "false position", "too many iterations"),
    ],
)
def test_brackets_that_fail_say_why(monkeypatch, span, bracket, method, status):
    monkeypatch.setattr(root_finders, "MOST", 2000)
    found = root_finders.bracketed(SPAN[span], bracket, method)
    assert found.status == status and (status == "mirrored") == (found.root < 0.0)


def test_a_search_without_a_bracket_may_end_at_the_mirrored_root():
    span = SPAN["2 m over 1 m"]
    found = [root_finders.unbracketed(span, start) for start in root_finders.STARTS]
    assert {one.status for one in found} == {"done", "mirrored", "no root"}
    for one in found:
        if one.status != "no root":
            assert abs(one.root) == pytest.approx(root_finders.ours(span).root, rel=1e-8)


# The study --------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def rows():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(energy_method, "POINTS", 20)
        patch.setattr(root_finders, "MOST", 20_000)
        yield study.compute(quick=True)


@pytest.mark.slow
def test_tables_hold_every_model_and_case(rows):
    assert set(rows) == set(study.TABLES)
    models = {tables.SAMPLED, tables.DESCENDED, tables.BALANCED}
    links = {tables.TWIN} if twin.installed() else set()
    assert set(rows["rest"]["model"]) == models | {tables.EQUILIBRIUM} | links
    assert len(rows["rest"]) == 4 * (4 + len(links))
    assert set(rows["motions"]["model"]) - {tables.TWIN_MOCAP} == models | {tables.LUMPED, tables.LUMPED_DEFAULT} | links
    for name in ("rest", "motions"):
        assert (rows[name]["status"] == "done").all() and (rows[name]["error_mm"] > 0.0).all()


@pytest.mark.slow
def test_only_models_with_motion_follow_it(rows):
    for _, table in rows["motions"].groupby("motion"):
        errors = table.set_index("model")["error_mm"]
        assert errors[[tables.LUMPED, tables.LUMPED_DEFAULT]].max() < 1.0 < 10.0 < errors[tables.BALANCED]


@pytest.mark.slow
def test_edmc_loses_energy_and_never_gains_it(rows):
    change = rows["motions"].set_index("model")["energy_change_percent"][[tables.LUMPED, tables.LUMPED_DEFAULT]]
    assert change.between(-1.0, 0.0).all()


@pytest.mark.slow
def test_figures_and_answer(rows):
    drawings = study.plot(rows)
    assert set(drawings) == {"cost_and_error", "root_finders"}
    for drawing in drawings.values():
        drawing.figure.draw_without_rendering()
        assert drawing.caption.endswith(".")
        assert drawing.figure.axes[0].get_ylabel()
    text = study.answer(rows)
    assert "nan" not in text and "bisection 35, false position 17139" in text
    assert ("MuJoCo is not installed" in text) != twin.installed()


@pytest.mark.slow
def test_without_the_engine_no_word_is_of_links(rows):
    bare = {name: table for name, table in rows.items()}
    for name in ("rest", "motions", "steps"):
        bare[name] = rows[name][~rows[name]["model"].str.startswith("rigid")]
    bare["turns"] = pd.DataFrame()
    text = study.answer(bare)
    assert "MuJoCo is not installed, so that there are no rigid links." in text and "mocap" not in text
    assert text.count("links") == 1
    study.plot(bare)


def motion_rows(**links):
    """Lumped masses and rigid links in flight."""
    line = {"motion": FLOWN, "net": FOUR, "load_g": 10.0, "status": "done", "setup_ms": 1.0, "energy_change_percent": -0.5}
    lumped = line | {"model": tables.LUMPED, "step_ms": 10.0, "error_mm": 0.5, "time_of_a_second_ms": 2.0}
    return pd.DataFrame([lumped, line | {"model": tables.TWIN, "step_ms": 4.0, "error_mm": 1.0} | links])


def test_words_are_of_the_rows():
    text = words._in_motion(motion_rows(time_of_a_second_ms=100.0), FLOWN)
    assert "0.5 mm with edmc on lumped masses (2 ms, steps of 10 ms) and 1 mm with rigid links (0.1 s, steps of 4 ms)" in text
    text = words._in_motion(motion_rows(time_of_a_second_ms=100.0, status="failed"), FLOWN)
    assert text.endswith("Not done: rigid links at 4 ms.")
    assert "by -0.5 % with edmc on lumped masses at 10 ms and -0.5 % with rigid links" in words._energies(motion_rows())


def test_links_and_edmc_are_compared_pair_by_pair():
    turns = pd.DataFrame({"edmc_s": [0.01] * 7, "links_s": [1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6], "links_step_ms": 4.0})
    assert words._side_by_side(turns) == "Side by side, the time of the links at 4 ms over that of edmc is 130 (100 to 160)."
    assert words._side_by_side(turns.iloc[:0]) == ""


def test_steps_without_a_limit_are_told():
    lines = [("lumped", "verlet", 0.14, "predicted"), ("lumped", "edmc", np.inf, "predicted"), (tables.TWIN, "x", 8.0, "doubled")]
    table = pd.DataFrame(lines, columns=["model", "method", "largest_step_ms", "known"]).assign(net=FOUR)
    text = words._steps(table)
    assert "0.14 ms of verlet (predicted) and 8 ms of rigid links (doubled)." in text and text.endswith(
        "For edmc there is no limit."
    )


@pytest.mark.parametrize(("name", "reached"), [(CARRIED, (0.7, 0.0, 0.0)), (FLOWN, (0.0, 10.0, 0.0))])
def test_supports_go_as_far_as_the_thesis_says(name, reached):
    """0.2 m/s for 4 s less half of the second in which they set off, and (0, 0, 0) to (0, 10, 0)."""
    motion = next(motion for motion in MOTIONS if motion.name == name)
    assert motion.shift([motion.flight.t_end])[0] == pytest.approx(reached)
