"""The study of cost against accuracy: comparisons at equal error, references kept on disk, the parts of the error."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from anet_lumped import simulate
from integrators import schemes
from studies.accuracy_cost import comparisons, contestants, references, total_error, work_precision_figures
from studies.accuracy_cost.equal_error import on_front, time_at, weights_at
from studies.accuracy_cost.motions import carried, dropped, loose, stopped
from studies.questions import work_precision


def test_time_between_two_runs_lies_on_a_line_in_both_logarithms():
    """Errors that fall with the square of the time: error = 1/time^2."""
    times = np.array([1.0, 2.0, 4.0, 8.0])
    assert time_at(times**-2.0, times, 0.1) == pytest.approx((10.0**0.5, 0.1), rel=1e-12)


def test_time_at_an_error_takes_the_runs_on_the_front_alone():
    """The run of 3 s is no better than that of 2 s, and the one that failed does not count."""
    errors, times = [1.0, 0.1, 0.2, np.nan, 0.01], [1.0, 2.0, 3.0, 3.5, 4.0]
    assert time_at(errors, times, 0.1) == pytest.approx((2.0, 0.1))
    assert time_at(errors, times, 0.1**1.5)[0] == pytest.approx(8.0**0.5)


def test_nothing_is_extrapolated():
    assert time_at([0.5, 0.2], [1.0, 2.0], 0.7) == (1.0, 0.5)
    assert np.isnan(time_at([0.5, 0.2], [1.0, 2.0], 0.1)).all()
    assert np.isnan(time_at([np.nan], [1.0], 0.1)).all()


def test_front_against_its_definition():
    """Each point against every other one."""
    rng = np.random.default_rng(1)
    errors, times = rng.integers(0, 12, (2, 80)).astype(float)
    found = on_front(errors, times)
    for i in range(80):
        beaten = (errors <= errors[i]) & (times <= times[i]) & ((errors < errors[i]) | (times < times[i]))
        assert not (found[i] and beaten.any())
        assert found[i] or beaten.any() or found[(errors == errors[i]) & (times == times[i])].any()
    assert not on_front([np.nan, 1.0], [1.0, np.inf]).any()


@pytest.fixture(scope="module")
def short():
    """A carried net that takes milliseconds."""
    return carried(1e4, 5, t_end=0.4)


def test_a_reference_is_computed_once(short, tmp_path, monkeypatch):
    calls = []

    def counted(*arguments, **options):
        calls.append(options["method"])
        return simulate(*arguments, **options)

    monkeypatch.setattr(references, "simulate", counted)
    first = references.reference(short, tmp_path)
    again = references.reference(short, tmp_path)
    assert calls == ["rk4", "verlet"] and len(list(tmp_path.iterdir())) == 2
    for name, track in first.tracks.items():
        assert np.array_equal(track.position, again.tracks[name].position)
        assert track.least_tension == again.tracks[name].least_tension
    references.reference(replace(short, t_end=0.8), tmp_path)
    references.reference(short.with_law("damped"), tmp_path)
    assert len(calls) == 6 and len(list(tmp_path.iterdir())) == 6


@pytest.mark.parametrize(
    "change",
    [
        {"t_end": 0.8}, {"save_every": 0.02}, {"recipe": "otherwise"}, {"scene": carried(2e4, 5).scene},
        {"scene": carried(1e4, 6).scene},
    ],
)  # fmt: skip
def test_the_name_on_disk_changes_with_all_that_the_motion_depends_on(short, change):
    names = {references.cache_key(motion, "rk4", (dt,)) for motion in (short, replace(short, **change)) for dt in (1e-3, 2e-3)}
    assert len(names) == 4


def test_a_method_is_not_judged_by_itself(short, tmp_path):
    """Two tracks that are a millimetre apart; each one's own method is judged by the other."""
    track = references.reference(short, tmp_path).tracks["rk4"]
    shifted = replace(track, position=track.position + np.array([1e-3, 0.0, 0.0]))
    judge = references.Reference({"rk4": track, "verlet": shifted})
    assert judge.difference == pytest.approx(1e-3)
    assert judge.error("edmc", track.position) == judge.error("verlet", track.position) == 0.0
    assert judge.error("rk4", track.position) == pytest.approx(1e-3)


def test_both_pairs_of_references_agree(short, tmp_path):
    """Explicit ones at a tenth of their limit, 0.07 ms, and implicit ones extrapolated from 0.5 ms, over 20 mm of way: fourth
    order leaves 1e-9 mm, Newton's tolerance of 1e-6 of the force about 1e-6 mm."""
    methods, steps = references.plan(short)
    assert methods == references.EXPLICIT_PAIR
    explicit = references.track(short, methods[0], steps[methods[0]], tmp_path)
    for method in references.IMPLICIT_PAIR:
        implicit = references.track(short, method, (0.5e-3, 0.25e-3), tmp_path)
        assert references.largest_distance(explicit.position, implicit.position) < 1e-8


def test_too_stiff_for_explicit_references():
    methods, steps = references.plan(carried(1e8, 80))
    assert methods == references.IMPLICIT_PAIR and all(len(of) == 2 for of in steps.values())


def test_cables_that_do_not_stretch_are_the_limit_of_those_that_do(tmp_path):
    """The limit from two finite stiffnesses beside the library's own EA = inf, of 20 mm of way; both methods of order 2."""
    motion = carried(np.inf, 5, t_end=0.4)
    judge = references.reference(motion, tmp_path)
    assert tuple(judge.tracks) == references.INEXTENSIBLE_PAIR and judge.taut
    assert judge.difference < 1e-8
    with pytest.raises(ValueError, match="Only a motion from rest or from straight cables has another stiffness"):
        stopped(1e4, 5).with_stiffness(1e6)


def test_cases_start_as_they_say():
    halt, fall, whip = stopped(1e4, 5), dropped(1e4, 5), loose(1e4, 5)
    v = halt.start.velocity("p0")
    assert v[0] == pytest.approx(0.2, abs=0.1) and not any(hasattr(p, "path") for p in halt.scene.points)
    assert np.allclose(halt.scene.point("s0").at, [-0.5 + 0.2 * 1.5, -0.5, 0.0])  # a ramp of 1 s loses half a second
    assert fall.scene.point("p0").mass == 0.036 and fall.start.scene.point("p0").mass == 0.536
    assert whip.law == "damped" and whip.nodes == 6 and carried(1e4, 5).nodes == 21


def test_every_method_of_the_library_runs_at_some_setting(short):
    named = {one.method: one for one in contestants.ours(short)}
    assert set(schemes.names()) | {contestants.ADAPTIVE, contestants.EXTRAPOLATED, contestants.OWN_CHOICE} == set(named)
    assert all(one.settings for one in named.values())
    for name in ("explicit_euler", "rk4", "edmc", contestants.OWN_CHOICE):
        attempt = named[name].run(short.t_end, named[name].settings[-1])
        assert attempt.status == "done" and attempt.position.shape == (11, 3)


def test_a_run_beyond_the_bound_is_left_out_and_said_so(short, tmp_path, monkeypatch):
    judge = references.reference(short, tmp_path)
    monkeypatch.setattr(work_precision, "LONGEST", 0.0)
    table, _ = work_precision.race(short, judge, only=("edmc",), with_peers=False)
    assert (table["status"] == "left out").all() and table["reason"].str.contains("it would take about").all()
    assert table["error_mm"].isna().all()


def test_errors_in_the_table_are_those_of_the_runs(short, tmp_path):
    """Second order: a quarter at half the step, within 10 % at the two finest steps."""
    judge = references.reference(short, tmp_path)
    table, _ = work_precision.race(short, judge, only=("edmc",), with_peers=False)
    assert (table["status"] == "done").all() and (table["repeats"] == work_precision.REPEATS).all()
    coarse, fine = table["error_mm"].iloc[-2:]
    assert coarse / fine == pytest.approx(4.0, rel=0.1)
    run = simulate(short.scene, short.t_end, method="edmc", dt=short.steps[-1], start=short.start, save_every=short.save_every)
    assert fine == pytest.approx(1e3 * references.largest_distance(run.position("p0"), judge.tracks["rk4"].position), rel=1e-9)


def test_the_best_of_ours_beside_the_best_peer():
    """Ours takes 1/error^(1/2), of two peers one is coarse and fast; the doubt of the reference bounds what is claimed."""
    own = [("anet-lumped", "edmc", e, 0.1 * e**-0.5) for e in (10.0, 1.0, 0.05)] + [("anet-lumped", "rk4", 1e-6, 3.0)]
    other = [("A", "x", 5.0, 2.0), ("A", "x", 0.5, 20.0), ("B", "", 0.04, 7.0)]
    runs = pd.DataFrame(own + other, columns=["engine", "method", "error_mm", "wall_s"])
    runs = runs.assign(motion="m", EA_N=1e4, segments=20, reference_mm=0.02, times_real_time=4.0 / runs["wall_s"])
    found = comparisons.equal_errors(runs).set_index("target_mm")
    assert found.loc[1.0, "best_ours"] == "edmc" and found.loc[1.0, "ours_s"] == pytest.approx(0.1)
    assert found.loc[0.1, "ours_s"] == pytest.approx(0.1 * 10**0.5) and found.loc[0.1, "ours_error_mm"] == pytest.approx(0.1)
    assert found.loc[10.0, "best_peer"] == "A x" and found.loc[10.0, "peer_error_mm"] == 5.0
    assert found.loc[0.1, "best_peer"] == "B" and found.loc[0.1, "ratio"] == pytest.approx(7.0 / (0.1 * 10**0.5))
    assert found.loc[1.0, "ratio"] == pytest.approx(70.0) and found.loc[1.0, "ours_times_real_time"] == pytest.approx(40.0)
    assert found.loc[0.01, ["ours_s", "peer_s", "ratio"]].isna().all()


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """A cache folder of its own, in place of the user's."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        yield folder


@pytest.fixture(scope="module")
def study(cache):
    """The quick study, of whose runs none is left out however slow the machine is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(work_precision, "LONGEST", 60.0)
        return work_precision.compute(quick=True, out=cache)


@pytest.mark.slow
def test_parts_of_the_error_add_up(study):
    """The whole is at most the sum of its parts, and at least the largest less the others: they are distances."""
    table = study["total_error"]
    parts = table[["model_mm", "discretisation_mm", "time_mm"]].to_numpy()
    whole, largest = table["total_mm"], parts.max(axis=1)
    assert (whole <= parts.sum(axis=1) * (1 + 1e-9)).all()
    assert (whole >= 2 * largest - parts.sum(axis=1) - 1e-9).all()


@pytest.mark.slow
def test_parts_behave_as_their_causes(study):
    """Stretch falls as 1/EA, the error of segments as their number squared; 2 % from the next power."""
    table = study["total_error"]
    model = table.groupby("EA_N")["model_mm"].first()
    assert model.iloc[0] / model.iloc[1] == pytest.approx(100.0, rel=0.02)
    by_segments = table[table["EA_N"] == 1e4].groupby("segments")["discretisation_mm"].first()
    assert np.allclose(by_segments.iloc[:-1].to_numpy() / by_segments.iloc[1:].to_numpy(), 4.0, rtol=0.02)
    edmc = table.query("method == 'edmc' and EA_N == 1e4 and segments == 20").set_index("step_ms")["time_mm"]
    assert edmc.loc[20.0] / edmc.loc[10.0] == pytest.approx(4.0, rel=0.02)


def test_the_discretisation_error_at_rest_is_that_of_the_catenary_net(cache):
    """At t = 0 the extrapolated continuum hangs where the exact elastic catenaries hang: 20 segments leave 4 um at N^-4."""
    from anet_lumped.statics.catenary_net import catenary_net

    assert references.cache_folder().is_relative_to(cache)
    limits = total_error.Limits((1e4, 1e6), (10, 20))
    motion = carried(1e4, 20)
    positions = {point.name: motion.start.position(point.name) for point in motion.scene.points}
    exact = catenary_net(motion.scene, positions).points["p0"]
    divided, limit = (np.linalg.norm(track[0] - exact) for track in (limits.exact[1e4, 20], limits.continuous[1e4]))
    assert divided > 1e-5 and limit < divided / 50


@pytest.mark.slow
def test_the_quick_study_answers(study, tmp_path):
    runs = study["runs"]
    assert (runs["status"] == "done").all() and set(runs["engine"]) == {contestants.OURS}
    assert {"loose cable", "carried net"} == set(study["equal_error"]["motion"]) and study["equal_error"]["ratio"].isna().all()
    assert (study["references"]["difference_mm"] < 0.01).all()
    assert study["growth"]["error_mm"].max() < 0.1
    for drawing in work_precision.plot(study).values():
        drawing.figure.set_layout_engine("none")  # which draws all several times
        drawing.figure.draw_without_rendering()
        assert all(axes.lines or axes.collections for axes in drawing.figure.axes if axes.axison)
        assert drawing.caption.endswith(".") and "`" not in drawing.caption
    words = work_precision.answer(study)
    assert "nan" not in words and "{" not in words and "Other engines were not run" in words
    assert set(study) == set(work_precision.TABLES)
    for name, table in study.items():
        table.to_parquet(tmp_path / f"{name}.parquet")
    json.dumps({k: v for k, v in vars(work_precision).items() if k.isupper()}, default=str)
    assert isinstance(pd.read_parquet(tmp_path / "runs.parquet"), pd.DataFrame)


def test_a_panel_shows_few_curves_first_and_all_on_demand():
    """Twelve methods of ours and one engine: edmc, the own choice and what is cheapest at some error are among the eight."""
    names = [*(f"slow{i}" for i in range(9)), "edmc", contestants.OWN_CHOICE, "fast"]
    engines = [contestants.OURS] * len(names) + ["engine"]
    lines = [
        {"engine": engine, "method": method, "wall_s": wall * (0.1 if method in ("fast", "euler") else 1.0), "error_mm": 1.0 / wall}
        for engine, method in zip(engines, [*names, "euler"], strict=True) for wall in (1.0, 10.0, 100.0)
    ]  # fmt: skip
    runs = pd.DataFrame(lines).assign(motion="net", EA_N=1e4, segments=20, reference_mm=1e-6, times_real_time=1.0)
    few = work_precision_figures._few(runs, comparisons.equal_errors(runs))
    assert set(few["method"]) == {"edmc", contestants.OWN_CHOICE, "fast", "euler"} and len(few) == 12
    many = runs.assign(method=runs["method"].replace({"slow0": "verlet", "slow1": "edmc, adaptive"}))
    assert {"verlet", "edmc, adaptive"} < set(work_precision_figures._few(many, comparisons.equal_errors(many))["method"])


@pytest.mark.slow
def test_the_quick_study_compares_in_pairs(study):
    """The library's own choice beside its best method, at the error of the choice, on both motions."""
    pairs = study["pairs"]
    assert set(pairs["compared"]) == {comparisons.CHOICE_OVER_BEST} and len(pairs) == 2
    assert (pairs["pairs"] == comparisons.PAIRS).all() and (pairs["low"] <= pairs["median_ratio"]).all()
    assert (pairs["median_ratio"] <= pairs["high"]).all() and (pairs["error_mm"] > 0.0).all()


def test_sides_are_timed_in_turns_at_the_same_error():
    """Made up: ours takes 1/error^(1/2), the peer twice as long at each of its runs; a third turn is slow for both."""
    own = [("anet-lumped", "edmc", e, 0.1 * e**-0.5) for e in (10.0, 1.0, 0.1)]
    runs = pd.DataFrame([*own, ("A", "x", 1.0, 0.2)], columns=["engine", "method", "error_mm", "wall_s"])
    runs = runs.assign(motion="m", EA_N=1e4, segments=20, reference_mm=0.0, times_real_time=4.0 / runs["wall_s"])
    calls = []

    def timed(number):
        calls.append(number)
        slow = 3.0 if 4 < len(calls) < 8 else 1.0
        return slow * runs["wall_s"][number]

    entries = [lambda number=number: timed(number) for number in range(4)]
    equal = comparisons.equal_errors(runs)
    pairs = comparisons.paired(runs, entries, equal, pd.DataFrame(columns=["best"]))
    line = pairs[pairs["error_mm"] == 1.0].iloc[0]
    assert line["compared"] == comparisons.PEER_OVER_OURS and line["median_ratio"] == pytest.approx(2.0)
    assert (line["first"], line["second"]) == ("A x", "edmc") and calls[:4] == [3, 0, 3, 0]


def test_weights_are_those_of_a_line_in_both_logarithms():
    errors, times = [1.0, 0.1, 0.2, np.nan, 0.01], [1.0, 2.0, 3.0, 3.5, 4.0]
    assert weights_at(errors, times, 0.1) == {1: pytest.approx(1.0)} | weights_at(errors, times, 0.1)
    assert weights_at(errors, times, 0.1**1.5) == {1: pytest.approx(0.5), 4: pytest.approx(0.5)}
    assert weights_at(errors, times, 2.0) == {0: 1.0} and weights_at(errors, times, 1e-3) == {}
