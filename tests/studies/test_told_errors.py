"""The study of what runs tell of their errors: its random motions, a look at two of them, and its answer from made-up rows."""

import json

import numpy as np
import pandas as pd
import pytest
from slow import slow

from anet_lumped import simulate
from anet_lumped.motion.known_errors import Wanted
from studies.catalogue.random_motions import KINDS, random_motion
from studies.questions import error_estimate


def test_random_motions_are_the_same_again_and_of_all_kinds():
    motions = [random_motion(number) for number in range(60)]
    assert {motion.kind for motion in motions} == set(KINDS)
    assert motions[7] == random_motion(7) and motions[7] != random_motion(7, seed=12)


@pytest.mark.parametrize("number", [3, 7, *slow(140)])  # a pendulum and two strings, of which the last rings from step to step
def test_a_motion_beside_its_reference(number):
    row = error_estimate.compare({"number": number, "most_steps": error_estimate.MOST_STEPS})
    runs, default = pd.DataFrame(json.loads(row["runs"])), json.loads(row["default"])
    judged = runs[runs.judged]
    assert len(runs) == 4 and len(judged) >= 2 and (judged.true_m.diff()[1:] < 0.0).all()
    assert (judged.told_m / judged.true_m).between(0.25, 4.0).all()
    assert default["kept"] and default["true_m"] < 2.0 * default["allowed_m"]


@pytest.mark.parametrize("number", [92, 94])
def test_a_fall_that_goes_loose_is_not_off_by_more_than_it_says(number):
    """Of four segments, whose places change at once with the step (14 times what it said once), and a short run of Verlet (4)."""
    motion = random_motion(number)
    run = simulate(motion.scene, motion.t_end, start=motion.start)
    fine = simulate(
        motion.scene, motion.t_end, start=motion.start, method="edmc", dt=run.dt / 8, save_every=run.t[1] - run.t[0]
    )  # fmt: skip
    off = np.linalg.norm(run.q - fine.q, axis=2).max()
    assert off < 2.0 * (Wanted(None, 0.02).of_places(run) if run.kept else run.error_estimate)


def rows(told, kept=True):
    runs = pd.DataFrame(
        {"judged": [True, True, False], "told_m": [told, 1e-3, 1.0], "true_m": [1e-3, 1e-3, 2.0],
         "told_tension": [told, 0.01, 0.01], "true_tension": [1.1e-3, 1e-5, 0.01], "judged_tension": [True, False, False]}
    )  # fmt: skip
    cases = runs.assign(told_m=told, true_m=1e-3, judged=[True, False, False])
    default = {"status": "done", "kept": kept, "judged": True, "true_m": 1e-3, "allowed_m": 2e-3}
    default |= {"true_tension": 0.03, "tension_known_to": 1e-3}
    return {"runs": runs, "cases": cases, "defaults": pd.DataFrame([default, default | {"status": "unconverged"}])}


def test_the_answer():
    text = error_estimate.answer(rows(2e-3))
    assert "Random motions, 2 runs of edmc at a given step: 100 % tell" in text and "and none tell less than a tenth" in text
    assert "The catalogue of hard cases, 1 run of edmc at a given step: 100 % tell" in text
    assert "1 of 1 runs say that they keep 0.1 % of the longest cable" in text and "100 % keep it" in text
    assert "Of 1 largest tension that references know to 0.2 %, 0 % are kept, 100 % within a factor of two" in text
    assert "Left out: 3 runs " in text and "and 2 runs of which the same is true of the largest tension" in text
    assert "Of 1 error of the largest tension beyond 0.1 % of it, 100 % are told within that factor" in text
    text = error_estimate.answer(rows(5e-5, kept=False))
    assert "50 % tell their error" in text and "and 50 % tell less than a tenth" in text and "0 of 1 runs say" in text
    assert "keep it" not in text and "largest tension that" not in text


def test_a_reference_is_known_to_the_sum_of_a_series():
    """Of differences that fall by r, d + d r + ... = d/(1 - r); where they do not fall, nothing says that they tend to anything."""
    assert error_estimate.known_to(16e-6, 1e-6) == pytest.approx(1e-6 / (1 - 1 / 16), rel=1e-12)
    assert error_estimate.known_to(1e-6, 1e-6) == error_estimate.known_to(1e-6 / 3, 1e-6) == pytest.approx(20e-6, rel=1e-12)
    assert error_estimate.known_to(0.0, 0.0) == 0.0


def test_a_hard_case_beside_its_reference():
    """What flies after it is let go: what the march alone tells is a hundredth of the truth."""
    runs = pd.DataFrame(
        json.loads(error_estimate.compare_case({"case": "quadrotors drop a net", "most_steps": error_estimate.MOST_STEPS})["runs"])
    )
    assert len(runs) == 4 and runs.judged.all() and (runs.told_m / runs.true_m).between(0.25, 4.0).all()
