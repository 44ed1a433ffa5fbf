"""Sweeps: what varies, what is measured, and that every variant becomes a row."""

import itertools
import os
import re
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from anet_lumped.checks import InputError
from anet_lumped.files.scene_file import load_scene
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from studies.sweeping import measures
from studies.sweeping.measures import MEASURES, Measure, MeasureError, read_measure
from studies.sweeping.rows import RowsError, run_rows
from studies.sweeping.sweep import sweep
from studies.sweeping.vary import VaryError, apply, grid, parse_values, parse_vary, read_values

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def net():
    return load_scene("net_carried")


@pytest.fixture(scope="module")
def hanging():
    from anet_lumped.effects import Gravity

    cable = Cable("top", "end", length=2.0, mass_per_length=0.1, EA=1e3, segments=10)
    return Scene([Fixed("top", (0.0, 0.0, 0.0)), Free("end", mass=0.5)], [cable], [Gravity(9.81)])


@pytest.mark.parametrize(
    "spec, whole, values",
    [
        ("0:1:5", False, [0.0, 0.25, 0.5, 0.75, 1.0]),
        ("1e2:1e6:5log", False, [1e2, 1e3, 1e4, 1e5, 1e6]),
        ("5:160:6log", True, [5, 10, 20, 40, 80, 160]),
        ("1:4:7", True, [1, 2, 3, 4]),  # 1.5, 2.5 and 3.5 round to even, once each
        ("3:9:1", False, [3.0]),
        ("5, 10,20.5", False, [5, 10, 20.5]),
        ("edmc,verlet,edmc", False, ["edmc", "verlet"]),
    ],
)
def test_a_specification_is_read(spec, whole, values):
    assert parse_values(spec, whole) == values


@pytest.mark.parametrize("spec", ["1:2", "1:2:x", "1:2:0", "-1:2:3log", "1:2:3:4", "a:b:3", "1:2:3lin"])
def test_a_range_that_cannot_be_read_says_what_one_is(spec):
    with pytest.raises(VaryError, match=rf'A range must be a:b:n or a:b:nlog, .* but "{spec}" was given'):
        parse_values(spec)


def test_what_varies_is_a_name_and_a_specification_once():
    assert parse_vary(["EA=1,2", "p0.mass=0:1:3"]) == {"EA": "1,2", "p0.mass": "0:1:3"}
    with pytest.raises(
        VaryError, match='must be NAME=VALUE, as in EA=1e4, or NAME=SPEC, as in EA=1e2:1e6:9log, but "EA" was given'
    ):
        parse_vary(["EA"])
    with pytest.raises(VaryError, match="`EA` is given 1 and 2"):
        parse_vary(["EA=1", "EA=2"])


def test_a_grid_holds_every_combination(net):
    rows = list(grid(read_values(net, {"segments": "5,10", "method": ["edmc", "rk4"], "dt": "0.1:0.2:2"})))
    assert len(rows) == 8
    assert rows[1] == {"segments": 5, "method": "edmc", "dt": 0.2}


def test_values_may_have_the_unit_of_their_field_in_another_size(net):
    values = read_values(net, {"diameter": "2mm,0.5 cm", "EA": "1kN:1MN:4log", "p0.mass": "40g", "dt": "5ms"})
    assert values == {"diameter": [0.002, 0.005], "EA": [1e3, 1e4, 1e5, 1e6], "p0.mass": [0.04], "dt": [0.005]}
    with pytest.raises(VaryError, match=r'A range must be a:b:n .*, but "1kg:2kg:3" was given'):
        read_values(net, {"EA": "1kg:2kg:3"})


@pytest.mark.parametrize(
    ("name", "value", "units"), [("diameter", "2kg", "mm, cm, um, µm, km, m"), ("EA", "1e3 lbf", "MN, kN, mN, N")]
)
def test_a_unit_of_another_kind_is_told_those_that_do(name, value, units):
    with pytest.raises(VaryError, match=f"A number may be given in {units} here, but it is '{value}'"):
        read_values(load_scene("net_held"), {name: value})


def test_a_name_means_all_parts_or_one(net):
    inputs = {"EA": 5.0, "s1-p0.EA": 7.0, "p0.mass": 0.5, "gravity.g": 1.6, "path.velocity.x": 0.4, "dt": 0.01}
    scene, settings = apply(net, inputs)
    assert [cable.EA for cable in scene.cables] == [5.0, 7.0, 5.0, 5.0]
    assert scene.point("p0").mass == 0.5
    np.testing.assert_allclose(scene.gravity, [0, 0, -1.6])
    assert {dict(point.path.parameters)["velocity"] for point in scene.points[:4]} == {(0.4, 0.0, 0.0)}
    assert settings == {"dt": 0.01}
    assert apply(net, {"dt": 0.01})[0] is net


def test_a_coordinate_varies_alone(hanging):
    scene, _ = apply(hanging, {"top.at.z": 0.5, "top.at.x": 0.1})
    assert scene.point("top").at == (0.1, 0.0, 0.5)


LISTED = """
points = [
    {name = "a", kind = "driven", path = {kind = "line", start = [0, 0, 0], velocity = [1, 0, 0], ramp = 1}},
    {name = "b", kind = "free", mass = 1},
]
cables = [{start = "a", end = "b", length = 1, mass_per_length = 1, segments = 4, tension_strain = [[0.1, 100], [0.2, 400]]}]
events = [{kind = "payload_change", point = "b", t = 1, mass = 2}]
[effects.gravity]
[effects.applied_forces]
force = {b = [0, 0, 1]}
[effects.air]
wind = [
    {kind = "power_law", speed = 6, height = 10, exponent = 0.1},
    {kind = "dryden", sigma = 1, length = 10, carried = [1, 0, 0], seed = 1, modes = 20},
]
[effects.line_change.paid_out]
a-b = {kind = "line", start = 0, rate = 0.1, ramp = 1}
"""


@pytest.fixture(scope="module")
def listed():
    return scene_from_dict(tomllib.loads(LISTED))


@pytest.mark.parametrize(
    "name, value, found",
    [
        ("air.wind.1.seed", 7, lambda scene: scene.effects[2].wind[1].seed),
        ("a-b.tension_strain.1.0", 0.3, lambda scene: scene.cables[0].tension_strain[1][0]),
        ("a-b.tension_strain.1.1", 500.0, lambda scene: scene.cables[0].tension_strain[1][1]),
        ("events.0.mass", 3.0, lambda scene: scene.events[0].mass),
        ("events.0.t", 0.5, lambda scene: scene.events[0].t),
        ("applied_forces.force.b.z", 2.0, lambda scene: dict(scene.effects[1].force)["b"][2]),
        ("applied_forces.force.b.2", 2.0, lambda scene: dict(scene.effects[1].force)["b"][2]),
        ("a.path.start.x", 0.5, lambda scene: dict(scene.points[0].path.parameters)["start"][0]),
        ("line_change.paid_out.a-b.rate", 0.2, lambda scene: dict(dict(scene.effects[3].paid_out)["a-b"].parameters)["rate"]),
    ],
)
def test_an_entry_of_a_list_and_a_number_below_a_name_vary_alone(listed, name, value, found):
    changed = apply(listed, {name: value})[0]
    before, after = scene_to_dict(listed), scene_to_dict(changed)
    assert found(changed) == value != found(listed)
    assert apply(changed, {name: found(listed)})[0] == listed and before != after


def test_seeds_of_a_range_are_whole_and_entries_of_a_list_are_not(listed):
    assert read_values(listed, {"air.wind.1.seed": "1:500:500"})["air.wind.1.seed"] == list(range(1, 501))
    assert read_values(listed, {"a-b.tension_strain.0.0": "0:1:3"})["a-b.tension_strain.0.0"] == [0.0, 0.5, 1.0]


def test_the_mass_of_an_event_is_not_that_of_a_point(listed):
    changed = apply(listed, {"mass": 5.0})[0]
    assert (changed.point("b").mass, changed.events[0].mass) == (5.0, 2.0)


def test_an_entry_beyond_a_list_says_how_many_there_are(listed):
    with pytest.raises(
        VaryError, match=r"`a-b.tension_strain.3` can be varied here: `a-b.tension_strain` has 2 entries, counted from 0"
    ):
        read_values(listed, {"a-b.tension_strain.3": "1"})
    with pytest.raises(VaryError, match=r"Nothing called `air.density.0` can be varied here"):
        read_values(listed, {"air.density.0": "1"})


def test_axial_viscosity_takes_the_place_of_the_damping_ratio(net):
    cable = apply(net, {"BA": 3.0})[0].cables[0]
    assert (cable.BA, cable.zeta) == (3.0, 0.0)
    cable = apply(apply(net, {"BA": 3.0})[0], {"zeta": 0.2})[0].cables[0]
    assert (cable.BA, cable.zeta) == (None, 0.2)


def test_an_unknown_name_names_the_nearest(net):
    with pytest.raises(VaryError, match=r"Nothing called `s0-p0.Ea` can be varied here, did you mean `s0-p0.EA`\?"):
        read_values(net, {"s0-p0.Ea": "1,2"})
    with pytest.raises(VaryError, match=r"Nothing called `qqqq` .* known are t_end, method, .* as in `s0-p0.length`\."):
        read_values(net, {"qqqq": "1"})
    for name in ("p0.at.z", "p0.at", "at.z"):
        with pytest.raises(VaryError, match=f"Nothing called `{name}` can be varied here: `p0` has no `at` in this scene"):
            read_values(net, {name: "1"})
    with pytest.raises(VaryError, match="Nothing called `qqqq`"):
        apply(net, {"qqqq": 1})


@pytest.mark.parametrize(
    "text, message",
    [
        ("sagg", r"no measure called `sagg`, did you mean `sag`\?"),
        ("qqqq", "no measure called `qqqq`; known are stretch, sag"),
        ("height", "target of measure `height` must be one of s0, s1, s2, s3, p0, as in height:p0, but `height` was"),
        ("sag:p0", "target of measure `sag` must be one of s0-p0, .* but `sag:p0` was given"),
        ("reaction:p0", "target of measure `reaction` must be one of s0, s1, s2, s3, as in reaction:s3, but `reaction:p0` was"),
        ("mean_touchdown", "measure `mean_touchdown` is of what lies on the ground, but this scene has no ground"),
        ("steps:p0", "measure `steps` takes no target, but `steps:p0` was given"),
    ],
)
def test_a_measure_that_cannot_be_is_named(net, text, message):
    with pytest.raises(MeasureError, match=message):
        read_measure(text, net)


def test_measures_at_rest_are_those_of_the_hanging_cable(hanging):
    """The largest tension of a segment is all the weight below its middle; at the ends it is that of the payload, and of all."""
    asked = ["stretch", "tension", "tension:end", "height:end", "sag", "slack", "tension:top", "reaction:top"]
    table = sweep(hanging, {"EA": [1e3, 1e4]}, asked, workers=1)
    assert set(table["status"]) == {"done"}
    weight, half = 9.81 * (0.5 + 0.2), 9.81 * 0.1 * 0.1
    # equilibrium() stops at a force residual of 1e-10 of the weight
    np.testing.assert_allclose(table["tension"], weight - half, rtol=1e-8)
    np.testing.assert_allclose(table["tension:end"], 9.81 * 0.5, rtol=1e-8)
    np.testing.assert_allclose(table["tension:top"], weight, rtol=1e-8)
    np.testing.assert_allclose(table["reaction:top"], weight, rtol=1e-8)
    mean = 9.81 * (0.5 + 0.1)
    np.testing.assert_allclose(table["stretch"], mean / table["EA"], rtol=1e-7)
    np.testing.assert_allclose(table["height:end"], -2.0 * (1 + mean / table["EA"]), rtol=1e-8)
    np.testing.assert_allclose(table["sag"], 0.0, atol=1e-8)
    assert (table["slack"] == 0).all()


def test_runs_are_measured_and_a_bad_value_is_a_row(net, tmp_path):
    table = sweep(
        net, {"EA": [1e4, -2.0], "method": "edmc,no_such"}, ["end_x:p0", "peak_tension", "energy_rise", "height:p0"],
        t_end=0.1, dt=0.01, workers=2, out=tmp_path,
    )  # fmt: skip
    assert table["status"].tolist() == ["done", "failed", "failed", "failed"]
    assert "no_such" in table["reason"][1]
    assert "EA" in table["reason"][2] and "-2.0" in table["reason"][2]
    good = table.iloc[0]
    assert good["peak_tension"] > 0.1 and good["energy_rise"] <= 1e-9 and abs(good["end_x:p0"]) < 0.1


def test_every_measure_of_a_run_gives_a_value(net):
    targets = {"point": ":p0", "support": ":s0"}
    texts = [name + targets.get(measure.target, "") for name, measure in MEASURES.items() if not measure.of_ground]
    line = sweep(net, {"dt": [0.01]}, texts, t_end=0.05, method="edmc", workers=1).iloc[0]
    assert line["status"] == "done", line["reason"]
    assert line[[text for text in texts if text != "error_estimate"]].notna().all()


def test_a_run_that_diverges_is_a_row_with_what_its_good_part_shows(net):
    table = sweep(net, {"dt": [0.01]}, ["steps", "method_used"], t_end=1.0, method="verlet", workers=1)
    assert table["status"][0] == "diverged" and table["method_used"][0] == "verlet"
    assert table["reason"][0]


def count_points(state):
    return len(state.scene.points)


def test_a_measure_can_be_added_and_any_executor_used(net, monkeypatch):
    monkeypatch.setitem(measures.MEASURES, "points", Measure(count_points, "rest", "", "-", "number of points"))
    with ThreadPoolExecutor(2) as executor:
        assert sweep(net, {"EA": "1e3,1e4"}, ["points"], executor=executor)["points"].tolist() == [5, 5]


@pytest.mark.parametrize(
    "vary, asked, settings, what",
    [
        ({"EA": "1,2"}, ["steps"], {}, "measure `steps`"),
        ({"dt": "0.1,0.2"}, [], {}, "setting `dt`"),
        ({"EA": "1,2"}, [], {"method": "edmc"}, "setting `method`"),
    ],
)
def test_what_needs_a_run_needs_its_length(net, vary, asked, settings, what):
    with pytest.raises(VaryError, match=rf"`t_end` \[s\] must be given for a run, which {what} needs"):
        sweep(net, vary, asked, **settings)


@pytest.mark.parametrize("changed", ["scene", "vary", "measures", "settings"])
def test_another_sweep_is_not_mixed_in(net, hanging, tmp_path, changed):
    asked = {"scene": hanging, "vary": {"EA": "1e3,1e4"}, "measures": ["height:end"], "settings": {}}
    sweep(asked["scene"], asked["vary"], asked["measures"], workers=1, out=tmp_path)
    other = {
        "scene": apply(hanging, {"end.mass": 0.6})[0], "vary": {"EA": "1e3,1e4,1e5"}, "measures": ["sag"],
        "settings": {"t_end": 0.1},
    }  # fmt: skip
    asked[changed] = other[changed]
    differs = {
        "scene": "scene.points[1].mass was 0.5 and is 0.6",
        "vary": "vary.EA was [1000.0, 10000.0] and is [1000.0, 10000.0, 100000.0]",
        "measures": "measures was ['height:end'] and is ['sag']",
        "settings": "settings.t_end was not given and is 0.1",
    }[changed]
    with pytest.raises(RowsError, match=re.escape(f"is of another sweep: {differs}; ask for the same")):
        sweep(asked["scene"], asked["vary"], asked["measures"], **asked["settings"], out=tmp_path, resume=True)


def test_all_that_differs_from_another_sweep_is_told_with_both_values(net, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # a long path would leave less of the message
    settings = {"t_end": 0.02, "dt": 0.01}
    sweep(net, {"EA": "1e3,1e4"}, ["peak_tension"], **settings, method="edmc", workers=1, out="rows")
    told = (
        "another sweep: measures was ['peak_tension'] and is ['sag'], settings.t_end was 0.02 and is 0.04, settings.method was "
        "'edmc' and is not given; ask for the same, or take another folder."
    )
    with pytest.raises(RowsError, match=re.escape(told)):
        sweep(net, {"EA": "1e3,1e4"}, ["sag"], t_end=0.04, dt=0.01, workers=1, out="rows", resume=True)
    with pytest.raises(RowsError, match=r"settings\.method was 'edmc' and is not given and 3 more; ask"):
        other = {"t_end": 0.04, "dt": 0.02, "start": "straight"}
        sweep(net, {"EA": "1e3,2e4"}, ["sag"], **other, workers=1, out="rows", resume=True)


SCRIPT = """
from anet_lumped import Cable, Fixed, Free, Scene
from anet_lumped.effects import Gravity, node_energy
from studies.sweeping.sweep import sweep

print("begins", flush=True)

@node_energy
def magnet(t, q, strength):
    return -strength * q[0]

def hung():
    cable = Cable("top", "end", length=2.0, mass_per_length=0.1, EA=1e3, segments=10)
    return Scene([Fixed("top", (0.0, 0.0, 0.0)), Free("end")], [cable], [Gravity(9.81), *EFFECTS])

GUARD
    print(sweep(hung(), {"EA": [1e3, 1e4]}, ["height:end"], workers=2)["status"].tolist())
"""


def run_script(folder, effects="", guard="if True:"):
    script = folder / "script.py"
    script.write_text(SCRIPT.replace("*EFFECTS", effects).replace("GUARD", guard))
    here = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.run([sys.executable, str(script)], capture_output=True, text=True, cwd=folder, env=here, timeout=300)


def test_a_plain_script_needs_no_guard_and_runs_once(tmp_path):
    done = run_script(tmp_path)
    assert (done.returncode, done.stdout) == (0, "begins\n['done', 'done']\n"), done.stderr


@pytest.mark.slow
def test_a_script_with_an_effect_of_its_own_needs_a_guard_and_one_sentence_says_so(tmp_path):
    done = run_script(tmp_path, "magnet(0.1)")
    last = done.stderr.splitlines()[-1]
    assert done.returncode == 1 and last.startswith(
        "studies.sweeping.workers.WorkerError: A script whose own functions or effects worker processes need must"
    )
    assert len(last) < 400 and done.stderr.count("Traceback") == 1, done.stderr
    done = run_script(tmp_path, "magnet(0.1)", 'if __name__ == "__main__":')
    assert done.returncode == 0 and done.stdout.endswith("['done', 'done']\n"), done.stderr


# Refusals ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ("EA=1", "What is varied must be a dict from names to values, but it is 'EA=1'"),
        ({"EA": 5.0}, r"The values of `EA` must be a specification or a list, but they are 5\.0"),
        ({"EA": "1,nan"}, "A number must be one that a float can hold, but it is nan"),
        ({"EA": "1e400"}, "A number must be one that a float can hold, but it is 1e400"),
        ({"EA": "9" * 400}, "A number must be one that a float can hold, but it is 999"),
        (
            {"EA": "lognormal(1e4,0.2)"},
            r"Values of a grid must be a range or a list, but `EA` is given the distribution lognormal\(",
        ),
    ],
)
def test_what_cannot_vary_is_told(hanging, vary, message):
    with pytest.raises(VaryError, match=message):
        sweep(hanging, vary)
    assert parse_values("inf, -inf") == [np.inf, -np.inf]


@pytest.mark.parametrize("values", [range(10**12), itertools.count(), "1:2:1000000000000"], ids=["range", "endless", "words"])
def test_values_are_counted_while_they_come(hanging, monkeypatch, values):
    monkeypatch.setenv("ANET_LUMPED_MOST_ROWS", "1000")
    with pytest.raises(InputError, match=r"would take \S+ rows, but must not take more than 1e\+03"):
        sweep(hanging, {"EA": values})


def test_rows_are_counted_while_they_come(monkeypatch):
    monkeypatch.setenv("ANET_LUMPED_MOST_ROWS", "1000")
    with pytest.raises(InputError, match="This table would take"):
        run_rows(abs, ({"x": x} for x in itertools.count()))


@pytest.mark.parametrize("workers", [0, -1, 10**6, 2.5, True, "two"])
def test_workers_are_an_integer_that_a_machine_can_keep_busy(hanging, workers):
    with pytest.raises(InputError, match=rf"Argument `workers` must be an integer from 1 to \d+, but it is {workers!r}"):
        sweep(hanging, {"EA": [1.0]}, workers=workers)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"t_end": float("nan")}, "Argument `t_end` must be positive and finite"),
        ({"dt": 0.0}, "Argument `dt` must be positive and finite"),
        ({"method": "edcm"}, r'No run can have method=\'edcm\', did you mean "edmc"\?'),
        ({"start": "qqqq"}, "No run can have start='qqqq'; known are equilibrium, calm, straight"),
    ],
)
def test_what_no_run_can_have_is_told_before_any_row(hanging, setting, message):
    with pytest.raises(InputError, match=message):
        sweep(hanging, {"EA": [1.0]}, **{"t_end": 1.0} | setting)


def test_bodies_without_cables_are_measured_by_their_heights():
    """Of a floating box, the draught m/(rho A)."""
    from anet_lumped import Body
    from anet_lumped.effects import Gravity, Water

    box = Body("box", mass=400.0, inertia=(200.0,) * 3, hull=(2.0, 2.0, 1.0), at=(0.0, 0.0, 0.4))
    scene = Scene([], [], [Gravity(9.81), Water(density=1000.0)], bodies=[box])
    found = sweep(scene, {"box.mass": [400.0, 600.0]})
    assert list(found["status"]) == ["done", "done"] and found["stable"].all()
    assert found["height:box"].to_numpy() == pytest.approx([0.4, 0.35], abs=1e-6)
    with pytest.raises(MeasureError, match="The measure `sag` is of cables, but this scene has none"):
        sweep(scene, {"box.mass": [400.0]}, ["sag"])


def test_sag_is_the_depth_below_the_chord():
    """Two segments of a metre over 1.6 m, EA = 1e9 N: 0.6 m."""
    from anet_lumped.effects import Gravity

    cable = Cable("a", "b", length=2.0, mass_per_length=0.1, EA=1e9, segments=2)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Fixed("b", (1.6, 0.0, 0.0))], [cable], [Gravity(9.81)])
    found = sweep(scene, {"a-b.EA": [1e9]}, ["sag"])
    assert found["sag"].to_numpy() == pytest.approx([0.6], rel=1e-6)


def test_a_sweep_starts_from_the_calm(hanging):
    """Each row with a step was refused its start."""
    table = sweep(hanging, {"EA": [1e3, 1e4]}, ["steps"], t_end=0.02, dt=0.01, method="edmc", start="calm", workers=1)
    assert table["status"].tolist() == ["done", "done"], table["reason"].tolist()
