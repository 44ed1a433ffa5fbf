"""The thesis's tables: Table 5.1 by its own method, the spread behind its R squared, and both studies end to end."""

import numpy as np
import pytest
from slow import slow

from studies.questions import model_mismatch, thesis_tables
from studies.questions.thesis_tables import tables

TABLE_5_1_CM = {
    (10, 10): 2.66,
    (100, 10): -2.589,
    (100, 50): -0.839,
    (100, 100): 0.036,
    (200, 100): -0.435,
    (200, 500): 0.0,
}


@pytest.mark.parametrize(("samples", "points"), TABLE_5_1_CM)
def test_table_5_1(samples, points):
    """THESIS.md, section 3; the thesis rounds p0 to 0.2036 m. Tolerance: the last digit stated."""
    error = 100 * (tables.sample_p0(samples, points) - tables.REFERENCE)
    assert error == pytest.approx(TABLE_5_1_CM[samples, points], abs=0.00051)


def test_straight_cables_are_the_lowest_sample():
    heights = tables.point_heights(tables.LOWEST, 5)
    assert heights == pytest.approx(np.linspace(1, tables.LOWEST, 5))


def test_a_full_mass_at_the_ends_is_a_payload():
    """n equal masses are the trapezoid rule's and 1/(n - 1) of a cable at p0; the rule's own error is of order n^-2."""
    for points in (50, 200):
        exact = tables.balance_p0(tables.hanging_scene(tables.two_supports()))[2]
        loaded = tables.hanging_scene(tables.two_supports(), payload=1 / (points - 1))
        sampled = tables.least_energy_p0(points, "equal") - exact
        assert tables.balance_p0(loaded)[2] - exact == pytest.approx(sampled, rel=2 / points)


def test_half_masses_at_the_ends_leave_second_order():
    exact = tables.balance_p0(tables.hanging_scene(tables.two_supports()))[2]
    numbers = np.array([20, 50, 100, 200])
    errors = [abs(tables.least_energy_p0(n, "trapezoid") - exact) for n in numbers]
    assert np.polyfit(np.log(numbers - 1), np.log(errors), 1)[0] == pytest.approx(-2, abs=0.15)


def test_p0_by_balance_of_forces():
    """THESIS.md, section 3: p0 = (0.5, 0.2036116441)."""
    p0 = tables.balance_p0(tables.hanging_scene(tables.two_supports()))
    assert p0 == pytest.approx((0.5, 0.0, 0.2036116441), abs=1e-9)


def test_no_coordinate_spreads_as_the_thesis_tables_say():
    table = model_mismatch._thesis()
    finite = table.dropna()
    assert len(table) == 20
    assert len(finite) == 18
    assert finite["spread_of_Y_m"].min() > 0.49 > model_mismatch.MOST_SPREAD
    assert finite["spread_of_Y_m"].max() < 0.75
    # Pooled with the supports at the height found, a branch has just that spread.
    row = finite.iloc[0]
    assert model_mismatch._spreads(row["supports_above_origin_m"])[3] == pytest.approx(row["spread_of_Y_m"], rel=1e-3)


@pytest.mark.parametrize("case", model_mismatch.CASES)
def test_cases(case):
    scene = model_mismatch.thesis_net(case)
    assert scene.point("s0").at[2] == (model_mismatch.RAISED if case.startswith("II ") else 0.0)
    assert scene.point("p0").mass == pytest.approx(model_mismatch.CASES[case] / 1e3)
    assert sum(cable.mass_per_length * cable.length for cable in scene.cables) == pytest.approx(0.083)


@pytest.fixture(scope="module")
def executor():
    """One thread: the rows are milliseconds each."""
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(1) as pool:
        yield pool


@pytest.mark.parametrize("study", [thesis_tables, *slow(model_mismatch)])
def test_study(study, executor, tmp_path):
    rows = study.compute(quick=True, executor=executor, out=tmp_path)
    assert all(len(table) for table in rows.values())
    if "mismatch" in rows:
        assert (rows["mismatch"]["status"] == "done").all(), rows["mismatch"]["reason"].unique()
    for drawing in study.plot(rows).values():
        drawing.figure.set_layout_engine("none")  # which draws all several times
        drawing.figure.draw_without_rendering()
        assert drawing.caption.endswith(".") and "`" not in drawing.caption
        for axes in drawing.figure.axes:
            assert axes.get_ylabel() or axes.get_shared_y_axes().get_siblings(axes) or axes.get_yticklabels()
    if "bias" in rows:
        assert rows["bias"]["payload_mm"].iloc[-1] == pytest.approx(rows["bias"]["equal_masses_mm"].iloc[-1], rel=0.02)
    words = study.answer(rows)
    assert "nan" not in words
    assert set(rows) == set(study.TABLES)
