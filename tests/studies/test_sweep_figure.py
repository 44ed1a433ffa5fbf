"""The picture of a sweep, its heads with units, and numbers of a column in one format."""

import numpy as np
import pandas
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, load_scene
from anet_lumped.effects import Gravity
from anet_lumped.results.rainflow import cycles
from studies.shown.show import column_texts, show, summed_up
from studies.shown.sweep_figure import plot_sweep
from studies.sweeping.units import unit_of


def table():
    rows = [
        {"EA": EA, "segments": n, "sag": 0.1 + n / EA, "status": "done", "reason": ""} for EA in (1e2, 1e3, 1e4) for n in (5, 10)
    ]
    rows[3] |= {"sag": np.nan, "status": "failed", "reason": "no rest"}
    return pandas.DataFrame(rows)


def test_a_curve_for_each_value_of_the_other_input():
    figure = plot_sweep(table(), ["EA", "segments"], {"EA": "EA [N]", "sag": "sag [m]"})
    (panel,) = figure.axes
    assert panel.get_xlabel() == "EA [N]" and panel.get_ylabel() == "sag [m]" and panel.get_xscale() == "log"
    curves = {line.get_label(): line.get_xydata() for line in panel.lines}
    assert set(curves) == {"segments = 5", "segments = 10"}
    np.testing.assert_allclose(curves["segments = 10"], [(1e2, 0.2), (1e4, 0.101)])  # the row that failed is left out, and told
    assert "1 of 6 rows are not done" in figure._supxlabel.get_text()


def test_seeds_are_a_histogram():
    rows = pandas.DataFrame({"air.wind.1.seed": range(30), "peak": np.arange(30.0) ** 2, "status": "done", "reason": ""})
    (panel,) = plot_sweep(rows, ["air.wind.1.seed"]).axes
    assert sum(bar.get_height() for bar in panel.patches) == 30 and {line.get_label() for line in panel.lines} == {
        "mean",
        "largest",
    }
    assert panel.lines[0].get_xdata()[0] == pytest.approx((np.arange(30.0) ** 2).mean())


@pytest.mark.parametrize(
    "column, unit",
    [
        ("EA", "N"), ("tether.EA", "N"), ("segments", ""), ("balloon.mass", "kg"), ("winch.at.z", "m"), ("gravity.g", "m/s2"),
        ("air.wind.1.sigma", "m/s"), ("air.wind.1.seed", ""), ("air.wind.0.speed", "m/s"), ("applied_forces.force.balloon.z", "N"),
        ("t_end", "s"), ("peak_tension:tether", "N"), ("snaps", ""), ("method", ""),
    ],
)  # fmt: skip
def test_units_of_columns(column, unit):
    assert unit_of(load_scene("tether"), column) == unit


def test_units_of_parts_whose_names_have_dots():
    scene = Scene(
        [Fixed("a.b", (0, 0, 0)), Free("c")], [Cable("a.b", "c", length=1.0, mass_per_length=0.1, EA=1e4, segments=2)], [Gravity()]
    )
    assert unit_of(scene, "a.b.at.x") == "m" and unit_of(scene, "a.b-c.mass_per_length") == "kg/m"


@pytest.mark.parametrize(
    "values, texts",
    [
        ([1e3, 1e4, 1e6], ["1e3", "1e4", "1e6"]),
        ([0.1524374, 0.1522, 0.15203], ["0.1524", "0.1522", "0.1520"]),
        ([1.11690, 1.1170], ["1.1169", "1.1170"]),  # as many digits as tell them apart
        ([1.1169, 1.1169001], ["1.117", "1.117"]),  # but rounding is no change
        ([146.4, 9.123, 0.0], ["146.40", "9.12", "0"]),
        ([8.24e-4, 8.25e-5, None], ["8.24e-4", "8.25e-5", ""]),
        ([100.0, 250.0], ["100", "250"]),
        ([5, 10], ["5", "10"]),
        ([True, False], ["True", "False"]),
        ([float("nan"), 2.0], ["–", "2"]),
    ],
)
def test_one_format_a_column(values, texts):
    assert column_texts(values) == texts


def test_a_long_table_is_summed_up():
    rows = [{"cable": f"c{k}", "tension": float((k * 7) % 100), "segments": 5, "slack": "0-3" if k < 2 else ""} for k in range(100)]
    tension, segments, slack = summed_up(rows)
    assert (tension["minimum"], tension["at"], tension["mean"], tension["maximum"], tension["at "]) == (
        0.0,
        "c0",
        49.5,
        99.0,
        "c57",
    )
    assert segments["minimum"] == segments["maximum"] == 5 and slack["at"] == "none (98), 0-3 (2)"


def test_rows_of_a_long_table_are_named_by_words_that_tell_them_apart():
    """And not by a word that all of them have, as `done`."""
    rows = [{"EA": 1e3 + k, "status": "done" if k else "failed"} for k in range(100)]
    stiffness, status = summed_up(rows)
    assert (stiffness["at"], stiffness["at "]) == ("row 1", "row 100") and status["at"] == "done (99), failed (1)"


def test_all_of_a_long_table_is_printed_where_asked_for(capsys):
    rows = [{"cable": f"c{k}", "tension": k + 0.5} for k in range(61)]
    show({"cables": rows})
    assert "cables, 61 rows; --all prints them" in (said := capsys.readouterr().out) and len(said.splitlines()) < 8
    show({"cables": rows}, whole=True)
    said = capsys.readouterr().out
    assert all(f"c{k} " in said for k in range(61))


def test_a_heading_that_has_its_unit_gets_no_second_one(capsys):
    show({"rows": [{"energy_rise [J]": 1.0, "tension": 2.0}, {"energy_rise [J]": 3.0, "tension": 4.0}]})
    said = capsys.readouterr().out
    assert "energy rise [J]" in said and "tension [N]" in said and said.count("[J]") == 1


def test_rainflow_of_the_standard():
    """ASTM E1049-85, figure 6: ranges 3, 4, 4, 8, 9, 8, 6, of which the one of 4 within is whole, the others half cycles."""
    t = np.arange(9.0)
    found = cycles(t, np.array([-2.0, 1, -3, 5, -1, 3, -4, 4, -2]))
    assert sorted(zip(found.ranges, found.counts, strict=True)) == [
        (3, 0.5),
        (4, 0.5),
        (4, 1.0),
        (6, 0.5),
        (8, 0.5),
        (8, 0.5),
        (9, 0.5),
    ]
    assert found.duration == 8.0 and (found.begin < found.end).all()


def test_the_equivalent_range_of_a_sinusoid_is_its_range():
    """Ten cycles a second of 2 A: at 10 Hz the same range does the damage, at 1 Hz one that is 10^(1/m) times as large."""
    t = np.linspace(0.0, 20.0, 20 * 40 + 1)
    found = cycles(t, 5.0 + 3.0 * np.cos(2 * np.pi * t))
    assert found.equivalent(3.0, 1.0) == pytest.approx(6.0, rel=1e-12)
    assert found.equivalent(4.0, 0.1) == pytest.approx(6.0 * 10.0**0.25, rel=1e-12)
    assert cycles(t, np.full(len(t), 2.0)).equivalent() == 0.0
    with pytest.raises(ValueError, match=r"`exponent` must be positive"):
        found.equivalent(0.0)


def test_a_sample_is_marks_over_the_input_that_a_measure_goes_with_and_its_numbering_is_no_measure():
    """Curves of two points each were drawn, and the number of a point in the sample as if it were measured."""
    shares = np.random.default_rng(0).permutation(64) / 64.0
    rows = {"EA": 10.0 ** (3.0 + shares), "mass": np.arange(64) / 64.0, "sample": np.arange(64), "matrix": "A"}
    drawn = pandas.DataFrame(rows | {"sag": -rows["mass"], "tension": rows["EA"], "status": "done", "reason": ""})
    figure = plot_sweep(drawn, ["EA", "mass"])
    assert [(panel.get_xlabel(), panel.get_ylabel()) for panel in figure.axes] == [("mass", "sag"), ("EA", "tension")]
    np.testing.assert_array_equal(figure.axes[0].lines[0].get_xydata(), drawn[["mass", "sag"]].to_numpy())
    assert not figure.legends
