"""The search of the best inputs, against closed forms."""

from concurrent.futures import ThreadPoolExecutor

import pandas
import pytest
from scipy import stats

from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from studies.command_line import main
from studies.sweeping import best as search
from studies.sweeping.best import BestError, Constraint, best, read_constraint, read_objective
from studies.sweeping.row_log import RowsError

VARY = {"end.mass": "0:1", "EA": "1e3:1e4:log"}


@pytest.fixture(scope="module")
def hanging():
    cable = Cable("top", "end", length=2.0, mass_per_length=0.1, EA=1e3, segments=5)
    return Scene([Fixed("top", (0.0, 0.0, 0.0)), Free("end", mass=0.5)], [cable], [Gravity(9.81)])


def in_this_process(*arguments, **options):
    with ThreadPoolExecutor(1) as executor:
        return best(*arguments, executor=executor, **options)


def test_the_largest_load_that_a_stretch_allows(hanging, tmp_path, monkeypatch):
    """The stretch is g (m + mu L/2)/EA: the largest m for a stretch of 0.05 % and EA of 10 kN is 0.5/9.81 · 10 - 0.1."""
    monkeypatch.setattr(search, "ALIKE", 5e-3)
    monkeypatch.setattr(search, "PER_INPUT", 5)
    found = in_this_process(hanging, VARY, "max tension:top", constraints=["stretch<=5e-4"], out=tmp_path)
    mass = 5e-4 * 1e4 / 9.81 - 0.1
    assert found.row["tension:top"] == pytest.approx(9.81 * (mass + 0.2), rel=1e-2)  # twice what is alike
    assert found.row["stretch"] <= 5e-4 and found.row["EA"] == pytest.approx(1e4, rel=0.02)
    assert (
        len(found.table) == len(pandas.read_parquet(tmp_path / "rows.parquet"))
        and not found.table[["end.mass", "EA"]].duplicated().any()
    )


def test_the_least_of_a_measure_is_that_of_the_same_seed_and_is_resumed(hanging, tmp_path, monkeypatch):
    asked = hanging, {"end.mass": "0:1"}, "stretch"
    found = in_this_process(*asked, out=tmp_path / "once")
    assert found.row["end.mass"] == pytest.approx(0.0, abs=2e-3)
    log = tmp_path / "once" / "rows.jsonl"
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b"".join(lines[:10]))
    again = in_this_process(*asked, out=tmp_path / "once", resume=True)
    pandas.testing.assert_frame_equal(again.table, found.table)
    assert sorted(log.read_bytes().splitlines(keepends=True)) == sorted(lines)
    with pytest.raises(RowsError, match="is of another sweep: best was 'stretch' and is 'max stretch'"):
        in_this_process(hanging, {"end.mass": "0:1"}, "max stretch", out=tmp_path / "once", resume=True)


def test_rows_that_fail_are_not_the_best(hanging):
    found = in_this_process(hanging, {"EA": "-1e3:1e3"}, "min stretch")
    assert found.row["EA"] == pytest.approx(1e3, rel=2e-3) and (found.table["status"] == "failed").any()


def test_no_row_is_the_best_where_none_meets_a_constraint(hanging, monkeypatch):
    monkeypatch.setattr(search, "GENERATIONS", 2)
    assert in_this_process(hanging, {"end.mass": "0:1"}, "stretch", constraints=["stretch<=0"]).row is None


def test_the_command_line_tells_the_best(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(search, "GENERATIONS", 2)
    asked = ["sweep", "net_held", "--vary", "p0.mass=0.02:0.05", "--best", "tension", "--out", str(tmp_path), "--workers", "1"]
    with pytest.raises(SystemExit) as ended:
        main(asked)
    said = capsys.readouterr()
    assert ended.value.code == 0 and said.out.startswith("best") and "rows in" in said.err
    with pytest.raises(SystemExit) as ended:
        main([*asked, "--constraint", "tension<=0", "--out", str(tmp_path / "none")])
    assert ended.value.code == 1 and "No row that is done meets tension<=0." in capsys.readouterr().err


@pytest.mark.parametrize("text", ["", "least sag", "max", "max sag of", "min  max sag"])
def test_an_objective_that_cannot_be_read_is_told(text):
    with pytest.raises(BestError, match="must be a measure, min MEASURE or max MEASURE"):
        read_objective(text)
    assert [read_objective(text) for text in ("sag", "min sag", "max sag")] == [("sag", False), ("sag", False), ("sag", True)]


@pytest.mark.parametrize("text", ["", "sag", "sag<0.1", "sag<=", "sag<=x", "sag<=inf", "<=1"])
def test_a_constraint_that_cannot_be_read_is_told(text):
    with pytest.raises(BestError, match="A constraint must be MEASURE<=NUMBER or MEASURE>=NUMBER"):
        read_constraint(text)
    assert read_constraint("height:p0 >= -2.5") == Constraint("height:p0", False, -2.5)


def test_a_constraint_has_the_unit_of_its_measure_and_all_its_digits(hanging):
    """It is written beside the rows, and read again by their page."""
    assert read_constraint("sag <= 10cm", hanging) == read_constraint("sag<=0.1") == Constraint("sag", True, 0.1)
    assert read_constraint("tension>=2kN", hanging) == Constraint("tension", False, 2000.0)
    for text in ("sag<=10kN", "sag<=10 cm"):
        with pytest.raises(BestError, match="A constraint must be"):
            read_constraint(text, hanging)
    for bound in (0.12345678901, -2.0, 1e6, 1e-7):
        assert read_constraint(str(Constraint("sag", True, bound))).bound == bound


def test_what_has_no_ends_is_not_searched(hanging):
    with pytest.raises(BestError, match="What is searched must have ends, but `EA` ~ lognormal"):
        best(hanging, {"EA": "lognormal(1e4,0.2)"}, "stretch")
    with pytest.raises(InputError, match="must have ends"):
        best(hanging, {"EA": stats.norm(1e4, 1.0)}, "stretch")
