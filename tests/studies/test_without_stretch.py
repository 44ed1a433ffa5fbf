"""The study of cables that do not stretch: both methods tend to one motion, elastic cables too; every word is from the rows."""

import numpy as np
import pandas as pd
import pytest

from studies.questions import without_stretch as study


@pytest.fixture(scope="module")
def rows():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "RTOL", (1e-3, 1e-5, 1e-7))
        patch.setattr(study, "STEPS", (5e-3, 2.5e-3, 1.25e-3))
        patch.setattr(study, "SEGMENTS", (20, 40))
        patch.setattr(study, "TURNS", 1)
        yield study.compute()


@pytest.mark.slow
def test_methods_tend_to_one_motion(rows):
    done = rows["runs"][rows["runs"]["status"] == "done"]
    assert set(done["motion"]) == {motion.name for motion in study.motions()}
    for (name, method), line in done.groupby(["motion", "method"]):
        errors = line["error_mm"].to_numpy()
        if method == study.LINKS:
            assert (np.diff(errors) < 0.0).all() and errors[-1] < 1e-3, name
        elif method == study.EDMC and name == study.NET:  # order 2 between steps of half the length
            assert errors[:-1] / errors[1:] == pytest.approx(4.0, rel=0.2)


@pytest.mark.slow
def test_elastic_cables_tend_to_it_as_the_inverse_of_their_stiffness(rows):
    table = rows["elastic"]
    slope = np.polyfit(np.log(table["EA_N"]), np.log(table["apart_mm"]), 1)[0]
    assert slope == pytest.approx(-1.0, abs=0.05)  # the next term is of the order of the strain, some per cent at EA = 1e3 N


@pytest.mark.slow
def test_figure_and_answer(rows):
    assert set(study.plot(rows)) == {"cost"}
    words = study.answer(rows)
    assert "past its whip by links within" in words and "EA to the power -1.0" in words


def test_words_are_of_the_rows():
    line = {"motion": study.WHIP, "status": "done", "rtol": 1e-3, "step_s": None}
    runs = pd.DataFrame(
        [line | {"method": "links", "error_mm": 0.5, "wall_s": 1e-3}, line | {"method": "edmc", "error_mm": 0.9, "wall_s": 20e-3}]
    )
    assert study._finding(runs).endswith("within 1 mm in 1 ms, 20 times as fast as edmc.")
    assert "With none of the tolerances" in study._finding(runs[runs["method"] == "edmc"])
