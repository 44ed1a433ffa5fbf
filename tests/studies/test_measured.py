"""The study of measured tensions and flights."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from anet_lumped.checks import InputError
from studies.questions import measured
from studies.questions.measured import flights, hanging, lindahl, tables, words
from studies.questions.measured.lindahl import Chain, fit, fold
from studies.study import StudyError, run_study


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    with ThreadPoolExecutor(1) as executor:  # in this process
        return measured.compute(quick=True, executor=executor, out=tmp_path_factory.mktemp("measured"))


@pytest.mark.slow
def test_the_chain_is_as_near_as_the_answer_says(rows):
    """The slower motion within its experiment's scatter twice over; the faster one to what an independent code is off by."""
    chain = rows["chain"].set_index(["setting", "period_s"])
    assert (rows["chain"]["status"] == "done").all()
    slow, fast = chain.loc[(tables.GIVEN, 3.5)], chain.loc[(tables.GIVEN, 1.25)]
    assert slow.rms_N < 1.2 and abs(slow.peak_error_percent) < 1.0
    other = {period: chain.loc[("MoorDyn 2.7.2", period)] for period in lindahl.PERIODS}
    for own, period in ((slow, 3.5), (fast, 1.25)):
        assert own.rms_N == pytest.approx(other[period].rms_N, abs=0.1)  # the same model: what steps and dampers leave
        assert own.mean_N == pytest.approx(other[period].mean_N, rel=2e-3)
        assert own.peak_N == pytest.approx(other[period].peak_N, rel=2e-2)  # a snap of a few milliseconds
    fitted = chain.loc[(tables.TUNED, 3.5)]
    assert fitted.rms_N < 0.8 < slow.rms_N and chain.loc[(tables.TUNED, 1.25)].rms_N < 4.0


@pytest.mark.slow
def test_the_answer_follows_from_the_rows(rows):
    assert set(rows) == set(measured.TABLES) and set(measured.plot(rows)) == {"chain", "sensitivity"}
    text = measured.answer(rows)
    assert "47.154, 26.634 and 11.476 kN (320 segments)" in text and "--data FOLDER" in text and "slow 34" not in text
    worse = rows | {"chain": rows["chain"].assign(rms_N=77.0)}
    assert "off by 77.00 N rms" in measured.answer(worse)


def test_what_was_measured_has_its_mean():
    assert [len(one) for one in lindahl.MEASURED.values()] == [25, 25]
    assert np.mean(lindahl.MEASURED[3.5]) == pytest.approx(24.19, abs=0.02)
    assert np.mean(lindahl.MEASURED[1.25]) == pytest.approx(26.45, abs=0.02)  # of the whole series, which the source gives


def test_the_driven_end_goes_around_its_circle():
    path = Chain().scene(1.25).point("fairlead").path
    for phase, place in ((0.0, (32.754, 0, 3.3)), (0.25, (32.554, 0, 3.1)), (0.5, (32.354, 0, 3.3))):
        assert path.at(1.25 * (4 + phase))[0] == pytest.approx(place, abs=1e-6)  # a spline through 200 places of a period
    assert path.at(0.0)[0] == pytest.approx((32.554, 0, 3.3), abs=1e-12)


def test_a_phase_is_the_mean_about_it(monkeypatch):
    """Of cos(2 pi phase) the mean over 1/25 about a phase is the cosine there times sin(pi/25)/(pi/25)."""

    class Run:
        t = np.linspace(0.0, 10.0, 10_001)
        status, message = "done", ""

        def tension(self, cable):
            return np.column_stack([0.0 * self.t, np.cos(2.0 * np.pi * self.t)])

    monkeypatch.setattr(lindahl, "simulate", lambda *args, **settings: Run())
    folded = fold(Chain(cycles=10), 1.0)
    expected = np.cos(2.0 * np.pi * np.arange(25) / 25) * np.sinc(1.0 / 25)
    assert folded.tension == pytest.approx(expected, abs=1e-4)  # of 40 points a phase, between saved ones
    assert folded.peak == pytest.approx(1.0, abs=1e-5)


def test_a_fit_finds_the_numbers_of_a_linear_model(monkeypatch):
    phases = np.arange(25)
    monkeypatch.setitem(lindahl.MEASURED, 3.5, tuple(2.0 * phases + 3.0 * np.sin(phases)))

    def model(chain, period):
        return lindahl.Folded(chain.Cdn * phases + chain.Cdt * np.sin(phases), 0.0, "done", "")

    monkeypatch.setattr(lindahl, "fold", model)
    found = fit(Chain(), {"Cdn": 0.1, "Cdt": 0.1}, 3.5, rounds=1)
    assert (found.chain.Cdn, found.chain.Cdt) == pytest.approx((2.0, 3.0)) and max(found.errors.values()) < 1e-9


def test_the_hanging_cable_to_five_digits():
    lines = {line["code"]: (line["top_kN"], line["bottom_kN"], line["horizontal_kN"]) for line in hanging.rows()}
    for code in (hanging.EXACT, "this library, 320 segments"):
        assert lines[code] == pytest.approx((47.154, 26.634, 11.476), abs=5e-4)
    off = np.abs(np.array(lines["this library, 20 segments"]) - lines[hanging.EXACT])
    assert (np.abs(np.array(lines["this library, 320 segments"]) - lines[hanging.EXACT]) < off / 100).all()  # order 2: 1/256


# --- flights ------------------------------------------------------------------------------------------------------------


def flight_file(folder, name, payload=(0.0, 0.0, -0.4), seconds=1.0, columns=10):
    """Two drones that hover 0.6 m apart, and a payload on cables of 0.5 m."""
    t = np.linspace(3.0, 3.0 + seconds, 101)
    places = np.tile(np.r_[-0.3, 0.0, 0.0, 0.3, 0.0, 0.0, payload], (len(t), 1))
    np.savetxt(folder / name, np.column_stack([t, places])[:, :columns], delimiter=",", header="t, places")
    return folder / name


def test_a_payload_at_rest_is_where_the_guess_has_it(tmp_path):
    flight = flights.read(flight_file(tmp_path, "slow_1.csv"))
    assert flight.lengths == pytest.approx((0.5, 0.5)) and flights.guess(flight)[0] == pytest.approx((0, 0, -0.4), abs=1e-12)
    found = flights.payload_distances(tmp_path / "slow_1.csv", 0.5)
    assert found["guess_rms_mm"] < 1e-9
    assert found["model_rms_mm"] < 0.2  # stretched by 0.06 N of 500 N, 0.06 mm, and the cables' own weight


def test_halves_take_turns_within_each_kind(tmp_path):
    for name in ("fast_1.csv", "fast_2.csv", "fast_3.csv", "slow_1.csv", "slow_34.csv"):
        flight_file(tmp_path, name)
    found = [(file.stem, half) for file, _, half in flights.files(tmp_path)]
    assert found == [("fast_1", "fitted"), ("fast_2", "held back"), ("fast_3", "fitted"), ("slow_1", "fitted")]


def test_flights_in_the_answer(tmp_path, monkeypatch):
    monkeypatch.setattr(flights, "DAMPINGS", (0.5,))
    for name in ("fast_1.csv", "fast_2.csv"):
        flight_file(tmp_path, name, payload=(0.0, 0.02, -0.4), seconds=0.1)
    with ThreadPoolExecutor(1) as executor:
        table = tables._flights(flights.files(tmp_path), executor, tmp_path / "rows")
    assert list(table["half"]) == ["fitted", "held back"]
    text = words._flights(table)
    assert "2 measured flights" in text and "0.5 1/s" in text and "1 flight held back" in text
    assert measured.figures._plot_flights(table).axes[0].get_ylabel() == "rms distance of the payload [mm]"


def test_flights_that_are_none(tmp_path):
    with pytest.raises(InputError, match=r"The folder of measured flights must hold a CSV file for each, but .* has none"):
        flights.files(tmp_path)
    with pytest.raises(InputError, match=r"must have 10 finite columns .* has 7 columns and 101 rows"):
        flights.read(flight_file(tmp_path, "fast_1.csv", columns=7))
    (tmp_path / "fast_1.csv").write_text("0,one,2\n")
    with pytest.raises(InputError, match=r"A measured flight must be a table of numbers in CSV, but .*fast_1.csv"):
        flights.read(tmp_path / "fast_1.csv")


def test_data_are_refused_by_a_study_that_takes_none(tmp_path):
    with pytest.raises(StudyError, match=r'The study "order" takes no measured data, but --data gives it flights'):
        run_study("order", tmp_path, data="flights")
