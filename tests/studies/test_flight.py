"""The study of flights: its rows, its period of sway, and words that are of the rows."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from studies.questions import flight as study


@pytest.fixture(scope="module")
def rows():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "QUICK_SHORTEST", 10e-3)
        patch.setattr(study, "QUICK_END", 0.4)
        two = [one for one in study.flights() if one.name in (study.NET, study.SWAY)]
        two[0] = two[0]._replace(scenario=replace(two[0].scenario, t_end=1.0))
        patch.setattr(study, "flights", lambda: two)
        patch.setattr(study, "QUICK_STEPS", (20e-3,))
        yield study.compute(quick=True)


@pytest.mark.slow
def test_rows_of_flights(rows):
    table = rows["flights"].set_index(["flight", "step_ms"])
    assert list(table.index) == [(study.NET, 20.0), (study.NET, 10.0), (study.SWAY, 20.0)]
    assert (table["status"] == "done").all() and (table["imbalance"] < 1e-8).all()
    assert (table["peak_tension_differs_percent"].abs() < 1.0).all()
    assert table.loc[(study.NET, 10.0), "peak_tension_differs_percent"] == 0.0
    assert (table["p0_error_mm"] >= table["p0_error_at_end_mm"]).all()
    # a net of 0.41 kg on four cables that meet half a metre and more below their ends swings faster than a pendulum of 1 m
    assert 0.8 < table.loc[(study.SWAY, 20.0), "sway_period_s"] < 2.0


def test_the_period_of_a_sway():
    """Of a sine about the middle of quadrotors that go on moving: exact but for chords between saved times, h^2/8 omega^2."""
    t = np.arange(0.0, 9.0, 0.02)
    y = {"a": 0.1 * t, "b": 0.1 * t + 2.0, "p0": 0.1 * t + 1.0 + 0.3 * np.sin(2.0 * np.pi / 1.3 * t)}
    bodies = [SimpleNamespace(name="a"), SimpleNamespace(name="b")]
    run = SimpleNamespace(t=t, scene=SimpleNamespace(bodies=bodies), position=lambda name: np.array([0 * t, y[name], 0 * t]).T)
    assert study.sway_period(run, "p0") == pytest.approx(1.3, rel=1e-3)
    y["p0"] = y["a"] + 3.0
    assert np.isnan(study.sway_period(run, "p0"))


@pytest.mark.slow
def test_figures_and_answer(rows):
    words = study.answer(rows)
    assert words.startswith(f"The largest tension of {study.NET} and sway is the same within 1 % at all their steps, ")
    assert "10 to 20 ms and 20 ms." in words
    drawn = set(study.plot(rows))
    if len(rows["loads"]):  # what is left where casadi is missing
        assert drawn == {"steps", "tuning"} and "cord of 1 g, 1 m at once: within 50 mm after no time flown" in words
        assert list(rows["loads"]["plans"]) == [4, 4]
    else:
        assert drawn == {"steps"}


@pytest.mark.slow
def test_without_casadi_the_answer_says_what_is_left_out(rows):
    words = study.answer(rows | {"loads": pd.DataFrame(), "loads_in_time": pd.DataFrame()})
    assert "CasADi is not installed" in words and "Model-predictive control with" not in words
    assert set(study.plot(rows | {"loads_in_time": pd.DataFrame()})) == {"steps"}


def test_words_are_of_the_rows():
    steps = {"flight": ["quadrotors_break"] * 2, "step_ms": [20.0, 1.0], "peak_tension_differs_percent": [-5.1, 0.0]}
    words = study._finding(pd.DataFrame(steps))
    assert words.startswith("The largest tension of quadrotors_break differs by up to 5.1 %. There a cable breaks")
    sway = pd.DataFrame({"flight": ["sway"] * 2, "sway_period_s": [1.0, 1.02], "sway_period_differs_percent": [0.0, 2.0]})
    assert "p0 sways in 1 to 1.02 s: not within 1 %, by 2 % at most." in study._sway(sway)
    line = {"cable": "c", "way": "w", "half_way_s": 1.0, "swing_degrees": 9.0, "plan_ms": 40.0}
    ends = ("untuned", 2.0, 10.0), ("tuned", np.nan, 60.0)
    loads = pd.DataFrame([line | {"weights": name, "settled_s": s, "overshoot_mm": o} for name, s, o in ends])
    words = study._tuning(loads)
    assert "within 50 mm after 2.0 s, tuned no time flown" in words and "10 and 60 mm too far" in words
