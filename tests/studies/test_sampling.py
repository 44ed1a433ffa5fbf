"""Samples of inputs, and the sensitivities that are taken from them."""

import importlib
import math
import re
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas
import pytest
from scipy import stats

from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.equilibrium import equilibrium
from studies.sweeping.measures import MeasureError
from studies.sweeping.own_measure import OwnMeasureError
from studies.sweeping.row_log import RowsError
from studies.sweeping.sampling import MATRIX, POINT, Input, inputs_of, read_inputs, read_sample, sampled
from studies.sweeping.sensitivity import SensitivityError, save_sensitivities, sensitivities
from studies.sweeping.sweep import sweep
from studies.sweeping.vary import VaryError, parse_vary


@pytest.fixture(scope="module")
def hanging():
    cable = Cable("top", "end", length=2.0, mass_per_length=0.1, EA=1e3, segments=10)
    return Scene([Fixed("top", (0.0, 0.0, 0.0)), Free("end", mass=0.5)], [cable], [Gravity(9.81)])


def in_this_process(*arguments, **options):
    with ThreadPoolExecutor(1) as executor:
        return sweep(*arguments, executor=executor, **options)


@pytest.mark.parametrize(
    ("spec", "distribution"),
    [
        ("1e3:2e3", stats.uniform(1e3, 1e3)),
        ("uniform(1e3,2e3)", stats.uniform(1e3, 1e3)),
        ("1e2:1e6:log", stats.loguniform(1e2, 1e6)),
        ("1kN:1MN:log", stats.loguniform(1e3, 1e6)),
        ("lognormal(10 kN,0.2)", stats.lognorm(0.2, scale=1e4)),
        ("loguniform(1e2, 1e6)", stats.loguniform(1e2, 1e6)),
        ("normal(1e4,10)", stats.norm(1e4, 10)),
        ("lognormal(1e4,0.2)", stats.lognorm(0.2, scale=1e4)),
        ("triangular(1,2,4)", stats.triang(1 / 3, 1, 3)),
        ("weibull(8,2)", stats.weibull_min(2, scale=8)),
        (stats.gamma(2.0, scale=1e3), stats.gamma(2.0, scale=1e3)),
    ],
    ids=lambda given: given if isinstance(given, str) else given.dist.name,
)
@pytest.mark.parametrize("kind", ["sobol:256", "lhs:200"])
def test_a_sample_follows_its_distribution(hanging, spec, distribution, kind):
    rows = list(sampled(kind, read_inputs(hanging, {"EA": spec, "end.mass": "0.1:0.2"}), seed=3))
    assert [row[POINT] for row in rows] == list(range(len(rows))) == list(range(int(kind.split(":")[1])))
    shares = distribution.cdf([row["EA"] for row in rows])
    # one value in each of n equal shares; 12 digits of a value may take it over the edge of its share
    assert np.abs(np.sort(shares) - (np.arange(len(rows)) + 0.5) / len(rows)).max() < 0.51 / len(rows)
    assert abs(np.corrcoef(shares, [row["end.mass"] for row in rows])[0, 1]) < 0.2  # of 200 random pairs: 0.07


def test_a_sample_is_that_of_its_seed(hanging):
    inputs = read_inputs(hanging, {"EA": "1e3:2e3"})
    one, again, other = (list(sampled("sobol:8", inputs, seed)) for seed in (1, 1, 2))
    assert one == again != other


def test_words_lists_and_whole_numbers_are_sampled(hanging):
    rows = list(
        sampled("sobol:64", read_inputs(hanging, {"segments": "5:8", "method": "edmc,verlet", "EA": [1.0, 2.0, 4.0, 8.0]}), 0)
    )
    assert {row["segments"] for row in rows} == {5, 6, 7, 8} and all(type(row["segments"]) is int for row in rows)
    assert [sum(row["method"] == name for row in rows) for name in ("edmc", "verlet")] == [32, 32]
    assert {row["EA"]: sum(other["EA"] == row["EA"] for other in rows) for row in rows} == {1.0: 16, 2.0: 16, 4.0: 16, 8.0: 16}


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("2:1", r"The distribution uniform\(a, b\) of `EA` must have a < b, but \(2,1\) was given"),
        ("-1:2:log", r"loguniform\(a, b\) of `EA` must have 0 < a < b"),
        ("normal(1)", r"normal\(mean, deviation\) of `EA` must have deviation > 0, but \(1\) was given"),
        ("lognormal(1e4,x)", r"lognormal\(median, deviation of the logarithm\) of `EA` must have both > 0"),
        ("normal(inf,1)", r"normal\(mean, deviation\) of `EA` must"),
        ("lognorm(1,2)", r'There is no distribution called lognorm for `EA`, did you mean "lognormal"'),
    ],
)
def test_a_distribution_that_cannot_be_is_told(hanging, spec, message):
    with pytest.raises(VaryError, match=message):
        read_inputs(hanging, {"EA": spec})


@pytest.mark.parametrize("text", ["sobol", "sobol:", "sobol:x", "sobol:1", "halton:8", "lhs:-3", ""])
def test_a_sample_that_cannot_be_is_told(text):
    with pytest.raises(VaryError, match=r"A sample must be one of sobol:n, .* was given"):
        read_sample(text)


def test_numbers_of_points_that_cannot_be_are_told(hanging, monkeypatch):
    with pytest.raises(VaryError, match="points of a sample sobol must be a power of two, as 1024, but they are 1000"):
        read_sample("sobol:1000")
    monkeypatch.setenv("ANET_LUMPED_MOST_ROWS", "100")
    with pytest.raises(InputError, match="The sample saltelli:64 would take 192 rows"):
        sampled("saltelli:64", read_inputs(hanging, {"EA": "1:2"}), 0)


def test_a_number_without_bounds_is_told():
    endless = {"EA": Input(lambda shares: [math.inf for _ in shares], 0.0, math.inf)}
    with pytest.raises(VaryError, match="A sample must be of finite numbers, but that of `EA` is not"):
        sampled("lhs:2", endless, 0)


def test_a_name_and_its_distribution_are_read():
    assert parse_vary(["EA~lognormal(1e4,0.2)", "p0.mass = 1:2"]) == {"EA": "lognormal(1e4,0.2)", "p0.mass": "1:2"}


# Sensitivities --------------------------------------------------------------------------------------------------------


def ishigami(row):
    """T. Ishigami and T. Homma, Proc. ISUMA 1990, 398, with a = 7 and b = 0.1."""
    x1, x2, x3 = (row[name] for name in ("x1", "x2", "x3"))
    return math.sin(x1) + 7.0 * math.sin(x2) ** 2 + 0.1 * x3**4 * math.sin(x1)


@pytest.fixture(scope="module")
def ishigami_table():
    uniform = Input(lambda shares: (math.pi * (2.0 * shares - 1.0)).tolist(), -math.pi, math.pi)
    rows = list(sampled("saltelli:1024", {"x1": uniform, "x2": uniform, "x3": uniform}, seed=1))
    assert len(rows) == 5 * 1024
    lines = [row | {"y": ishigami(row), "flat": 3.0, "word": "a", "status": "done", "reason": ""} for row in rows]
    return pandas.DataFrame(lines)


def test_sensitivities_of_a_function_with_a_closed_form(ishigami_table):
    """Variances: a²/8 + b π⁴/5 + b² π⁸/18 + 1/2 in all, (1 + b π⁴/5)²/2 by x1, a²/8 by x2, 8 b² π⁸/225 by x1 with x3."""
    a, b = 7.0, 0.1
    by_1, by_2, by_13 = 0.5 * (1 + b * math.pi**4 / 5) ** 2, a**2 / 8, 8 * b**2 * math.pi**8 / 225
    total = a**2 / 8 + b * math.pi**4 / 5 + b**2 * math.pi**8 / 18 + 0.5
    found = sensitivities(ishigami_table, ["x1", "x2", "x3"], ["y", "flat", "word"])
    assert found["measure"].tolist() == ["y"] * 3 and found["points"].tolist() == [1024] * 3
    # a random sample of 1024 points leaves 0.03, by its intervals; Sobol' points less
    np.testing.assert_allclose(found["first"], np.array([by_1, by_2, 0.0]) / total, atol=0.03)
    np.testing.assert_allclose(found["total"], np.array([by_1 + by_13, by_2, by_13]) / total, atol=0.03)
    for index in ("first", "total"):
        width = found[f"{index}_high"] - found[f"{index}_low"]
        assert (found[f"{index}_low"] <= found[index]).all() and (found[index] <= found[f"{index}_high"]).all()
        assert (width < 0.3).all() and (width > 0.01).all()  # of 1024 points: 4/√1024 by order of magnitude


def test_points_without_a_number_are_left_out(ishigami_table):
    broken = ishigami_table.copy()
    broken.loc[broken.index[7], "status"] = "failed"
    broken.loc[broken.index[9], "y"] = np.nan
    assert sensitivities(broken, ["x1", "x2", "x3"], ["y"])["points"].tolist() == [512] * 3
    with pytest.raises(SensitivityError, match="Sensitivities are taken from a sample saltelli:n"):
        sensitivities(broken.drop(columns=MATRIX), ["x1"], ["y"])


def test_sensitivities_of_a_cable_are_those_of_its_closed_form(hanging, tmp_path):
    """The tension at the top is g (m + mu L): of m from 0.1 to 0.3 and L from 2 to 4 the variances are as 0.2² to (0.1 · 2)²."""
    table = in_this_process(
        hanging, {"end.mass": "0.1:0.3", "length": "2:4", "EA": "1e3:2e3"}, ["tension:top"], sample="saltelli:64", out=tmp_path
    )
    assert len(table) == 5 * 64 and set(table["status"]) == {"done"}
    found = save_sensitivities(tmp_path, table).set_index("input")
    np.testing.assert_allclose(found.loc[["end.mass", "length"], "first"], 0.5, atol=0.05)  # of 64 points
    np.testing.assert_allclose(found.loc[["end.mass", "length"], "total"], 0.5, atol=0.05)
    np.testing.assert_allclose(found.loc["EA", ["first", "total"]], 0.0, atol=1e-6)
    assert len(pandas.read_csv(tmp_path / "sensitivities.csv")) == 3
    assert inputs_of(table.iloc[0].to_dict()).keys().isdisjoint({POINT, MATRIX})


def test_another_sample_is_not_mixed_in(hanging, tmp_path):
    in_this_process(hanging, {"EA": stats.uniform(1e3, 1e3)}, ["height:end"], sample="lhs:3", out=tmp_path)
    with pytest.raises(RowsError, match="is of another sweep: seed was 0 and is 1"):
        in_this_process(hanging, {"EA": stats.uniform(1e3, 1e3)}, ["height:end"], sample="lhs:3", seed=1, out=tmp_path)
    assert save_sensitivities(tmp_path, None) is None


# Measures of one's own -------------------------------------------------------------------------------------------------


@pytest.fixture
def own_module(tmp_path, monkeypatch):
    (tmp_path / "of_my_own.py").write_text(
        "def depth(state):\n    return -state.position('end')[2]\n\ndef last(run):\n    return run.t[-1]\n\nnumber = 3\n"
    )
    (tmp_path / "broken_of_my_own.py").write_text("import no_such_module\n")
    for name in ("of_my_own", "broken_of_my_own"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def test_a_function_of_a_module_is_a_measure_of_a_state_or_of_a_run(hanging, own_module):
    table = sweep(hanging, {"EA": [1e3, 1e4]}, ["of_my_own:depth", "height:end"], workers=1)  # another process finds it too
    assert table["of_my_own:depth"].tolist() == (-table["height:end"]).tolist()
    table = in_this_process(hanging, {"EA": [1e3]}, ["of_my_own:last"], t_end=0.05, dt=0.01)
    assert table["of_my_own:last"].tolist() == [0.05]


def test_rows_of_another_text_of_the_module_are_not_mixed_in(hanging, own_module):
    asked = hanging, {"EA": [1e3]}, ["of_my_own:depth"]
    sweep(*asked, workers=1, out=own_module / "rows")
    (own_module / "of_my_own.py").write_text("def depth(state):\n    return 0.0\n")
    with pytest.raises(RowsError, match="is of another sweep: own measures"):
        sweep(*asked, workers=1, out=own_module / "rows", resume=True)


@pytest.mark.parametrize(
    ("gives", "told"),
    [
        ("state.position('end')", r"gave an array of \(3,\)"),
        ("[1.0, [2.0]]", r"gave an array of \(2,\)"),
        ("None", "gave None"),
        ("1j", "gave 1j"),
        ("state.position('end')[2]", None),
        ("__import__('numpy').array(2.5)", None),
        ("state.stable", None),
        ("'a word'", None),
    ],
)
def test_a_function_gives_a_number_or_a_word(hanging, own_module, monkeypatch, gives, told):
    (own_module / "one_of_my_own.py").write_text(f"def gives(state):\n    return {gives}\n")
    monkeypatch.delitem(sys.modules, "one_of_my_own", raising=False)
    importlib.invalidate_caches()
    row = in_this_process(hanging, {"EA": [1e3]}, ["one_of_my_own:gives"]).iloc[0]
    if told is None:
        assert row["status"] == "done" and row["one_of_my_own:gives"] == eval(gives, {"state": equilibrium(hanging)})
    else:
        assert row["status"] == "failed"
        assert re.search(f"`one_of_my_own:gives` must give a number or a word, but it {told}", row["reason"])


def test_a_module_that_is_not_there_is_told(hanging, own_module):
    with pytest.raises(MeasureError, match="neither a measure nor, here or where Python looks, a module called `of_my_onw`"):
        sweep(hanging, {"EA": [1e3]}, ["of_my_onw:depth"])


def test_a_function_that_is_not_there_is_told(hanging, own_module):
    with pytest.raises(OwnMeasureError, match=r'of_my_own has none called \'depht\', did you mean "depth"'):
        sweep(hanging, {"EA": [1e3]}, ["of_my_own:depht"])
    with pytest.raises(OwnMeasureError, match=r"must be a function, but of_my_own has none called 'number'"):
        sweep(hanging, {"EA": [1e3]}, ["of_my_own:number"])
    with pytest.raises(OwnMeasureError, match="must import, but: ModuleNotFoundError: No module named 'no_such_module'"):
        sweep(hanging, {"EA": [1e3]}, ["broken_of_my_own:depth"])
