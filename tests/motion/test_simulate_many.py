"""`simulate_many` gives what `simulate` gives, to the last bit, whatever the scenes have; a run that fails, fails alone."""

import os
import signal
from dataclasses import replace

import numpy as np
import pytest
from hanging import CORNERS, cable, held_net

from anet_lumped import (
    Cable,
    CableCut,
    Driven,
    Fixed,
    Free,
    InputError,
    PayloadChange,
    RunsInterrupt,
    Scene,
    SceneError,
    equilibrium,
    paths,
    simulate,
    simulate_many,
    wind,
)  # fmt: skip
from anet_lumped.effects import Air, Gravity, ViscousDamping
from anet_lumped.limits import BYTES
from anet_lumped.results.run_table import RunTable

DT, T_END = 0.01, 0.3
WEIGHT = (Gravity(),)


def net(EA=1e4, mass=0.036, effects=WEIGHT, events=(), driven=True, **kwargs):
    """A small net, carried or held."""
    places = [paths.line((x, y, z), (0.3, 0.0, 0.0), 0.1) if driven else (x, y, z) for x, y, z in CORNERS]
    points = [(Driven if driven else Fixed)(f"s{i}", place) for i, place in enumerate(places)]
    cables = [cable(f"s{i}", "p0", EA=EA, segments=4, diameter=0.01, **kwargs) for i in range(4)]
    return Scene([*points, Free("p0", mass)], cables, effects, events)


def uneven(EA):
    """A net with a cable of more segments than the others, and one that is eliminated from its end."""
    scene = net(EA)
    longer, other = replace(scene.cables[0], segments=6), replace(scene.cables[1], start="p0", end="s1", name="p0-s1")
    return replace(scene, cables=[longer, other, *scene.cables[2:]])


def turned(EA):
    """A net with a cable that is eliminated from its end, and has as many segments as the others."""
    scene = net(EA)
    return replace(scene, cables=[replace(scene.cables[0], start="p0", end="s0", name="p0-s0"), *scene.cables[1:]])


def blown(speed):
    return Air(wind=wind.Uniform((speed, 0.0, 0.0)))


KINDS = {
    "driven": [net(1e3), net(2e4), net(1e4, mass=0.1)],
    "loads and drag": [net(effects=[Gravity(g), blown(w), ViscousDamping(0.3)]) for g, w in ((9.81, 2.0), (5.0, 3.0))],
    "payload changes": [net(events=[PayloadChange("p0", t=0.1, mass=m)]) for m in (0.2, 0.01)],
    "cables break": [net(breaking_tension=T, mass=0.5, zeta=0.05) for T in (1.5, 1.9, 1e3)],
    "cut": [net(EA, events=[CableCut("s1-p0", t=0.1, segment=1)]) for EA in (1e3, 1e4)],
    "curves": [net(None, tension_strain=((0.01, 100.0), (0.02, T))) for T in (250.0, 400.0)],
    "uneven cables": [uneven(EA) for EA in (1e3, 1e4)],
    "a turned cable": [turned(EA) for EA in (1e3, 1e4)],
    "one goes its own way": [net(1e3), net(1e4, breaking_tension=1e6), net(2e3)],
}


def assert_same(found, k, run):
    """The k-th run of a Dataset is a run, to the last bit."""
    alone, rows = run.to_xarray(), len(run.t)
    assert found.status.values[k] == run.status and found.reason.values[k] == run.message
    for name in ("position", "velocity", "tension", "shape", "energy"):
        of_run = found[name].values[k]
        assert np.array_equal(of_run[:rows], alone[name].values, equal_nan=True) and np.isnan(of_run[rows:]).all(), name
    assert np.array_equal(found.t.values[:rows], run.t)
    assert found.steps.values[k] == run.work.steps and found.step.values[k] == run.dt
    assert found.newton_iterations.values[k] == run.work.newton_iterations
    assert found.warnings.values[k] == "\n".join(run.warnings)


KEEP = ("position", "velocity", "tension", "shape", "energy")


@pytest.mark.parametrize("kind", KINDS)
def test_each_run_is_that_of_simulate(kind):
    scenes = KINDS[kind]
    found = simulate_many(scenes, T_END, method="edmc", dt=DT, keep=KEEP, workers=2)
    for k, scene in enumerate(scenes):
        assert_same(found, k, simulate(scene, T_END, method="edmc", dt=DT))


def test_breaks_happen_in_the_runs_compared():
    counts = [len(simulate(scene, T_END, method="edmc", dt=DT).events) for scene in KINDS["cables break"]]
    assert counts[0] > 0 and counts[-1] == 0


@pytest.mark.parametrize(
    "asked", [{"method": "verlet", "dt": 2e-4, "save_every": 0.1}, {"dt": DT}, {"rtol": 1e-4}, {"save_every": 0.1}]
)
def test_each_method_and_choice_of_steps_gives_the_run_of_simulate(asked):
    scenes = [net(1e3, zeta=0.1), net(1e4, zeta=0.1)]
    found = simulate_many(scenes, 0.2, start="equilibrium", keep=KEEP, **asked)
    for k, scene in enumerate(scenes):
        run = simulate(scene, 0.2, **asked)
        alone = run.to_xarray()
        assert found.status.values[k] == "done" and found.method.values[k] == run.method
        for name in KEEP:
            assert np.array_equal(found[name].values[k], alone[name].values, equal_nan=True), name
        assert np.allclose(found.t, run.t, rtol=0, atol=1e-12)  # multiples of each run's own step


def test_runs_from_a_state_and_from_shapes_start_where_it_is():
    scenes = [net(1e3), net(1e4)]
    begin = equilibrium(scenes[0])
    for start in (begin, {one.name: begin.shape(one.name) for one in scenes[0].cables}):
        found = simulate_many(scenes, T_END, method="edmc", dt=DT, start=start, keep=KEEP)
        for k, scene in enumerate(scenes):
            assert_same(found, k, simulate(scene, T_END, method="edmc", dt=DT, start=start))


def test_runs_start_from_the_calm():
    """They were refused, here and in sweeps with a step, as if "calm" were no start."""
    turbulent = replace(net(mass=0.2), effects=[Gravity(), Air(wind=wind.Dryden(2.0, 5.0, (3.0, 0.0, 0.0), seed=1, modes=20))])
    scenes = [turbulent, replace(turbulent, cables=[replace(one, EA=2e4) for one in turbulent.cables])]
    found = simulate_many(scenes, T_END, method="edmc", dt=DT, start="calm", keep=KEEP)
    for k, scene in enumerate(scenes):
        assert_same(found, k, simulate(scene, T_END, method="edmc", dt=DT, start="calm"))


def test_straight_cables_that_do_not_stretch_move_as_in_simulate():
    """A method that keeps lengths lets them be straight between held points, which was refused here."""
    cables = [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=np.inf, segments=4)]
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0, 0, -1.0))], cables, WEIGHT)
    found = simulate_many([scene], 0.1, method="links", dt=1e-3, start="straight", keep=KEEP)
    assert found.status.values[0] == "done"
    assert_same(found, 0, simulate(scene, 0.1, method="links", dt=1e-3, start="straight"))


def test_numbers_beside_words_stay_numbers():
    """The first run was refused EA='1000.0'."""
    found = simulate_many(net(), T_END, vary={"EA": [1e3, "many"]}, method="edmc", dt=DT)
    assert list(found.status.values) == ["done", "failed"] and "it is 'many'" in found.reason.values[1]


def test_places_vary_and_are_coordinates():
    """All runs were lost as the table was made of them."""
    at = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]]
    found = simulate_many(net(driven=False), T_END, vary={"s0.at": at}, method="edmc", dt=DT)
    assert found["s0.at"].values.tolist() == at and found["s0.at"].attrs["units"] == "m"
    assert found.position.sel(point="s0").isel(t=0).values.tolist() == at


def test_one_scene_with_other_numbers_is_the_scene_made_with_them():
    scene = net(effects=[Gravity(), blown(1.0)])
    EA, mass, g, speed = [1e3, 1e4], [0.02, 0.05], [9.81, 1.6], [0.1, 0.4]
    vary = {"EA": EA, "p0.mass": mass, "gravity.g": g, "s0.path.velocity.x": speed, "air.wind.velocity.x": [0.0, 5.0]}
    found = simulate_many(scene, T_END, vary=vary, method="edmc", dt=DT, keep=KEEP)
    for k in range(2):
        points = [replace(p, path=paths.line(CORNERS[0], (speed[k], 0, 0), 0.1)) if p.name == "s0" else p for p in scene.points[:4]]
        cables = [replace(one, EA=EA[k]) for one in scene.cables]
        alone = Scene([*points, Free("p0", mass[k])], cables, [Gravity(g[k]), blown((0.0, 5.0)[k])])
        assert_same(found, k, simulate(alone, T_END, method="edmc", dt=DT))
    assert list(found.EA.values) == EA and list(found["gravity.g"].values) == g
    assert (
        found.position.sel(point="p0").dims == ("run", "t", "axis") and list(found.tension.sel(cable="s0-p0").dims)[-1] == "segment"
    )


def test_a_run_that_fails_fails_alone():
    found = simulate_many(net(), T_END, vary={"EA": [1e3, -1.0, 1e4]}, method="edmc", dt=DT)
    assert list(found.status.values) == ["done", "failed", "done"]
    assert "must be positive and finite [N]" in found.reason.values[1] and np.isnan(found.position.values[1]).all()
    whole = simulate_many(net(), T_END, vary={"EA": [1e3, 1e4]}, method="edmc", dt=DT)
    assert np.array_equal(found.position.values[[0, 2]], whole.position.values)


def test_a_run_that_diverges_keeps_what_it_did_and_says_why():
    scenes = [net(EA, zeta=0.1) for EA in (1e3, 1e9)]
    found = simulate_many(scenes, 0.2, method="verlet", dt=1e-3, save_every=0.01)
    assert list(found.status.values) == ["done", "diverged"] and "diverged" in found.reason.values[1]
    with pytest.warns(UserWarning, match="beyond the largest stable step"):
        run = simulate(scenes[1], 0.2, method="verlet", dt=1e-3, save_every=0.01)
    assert found.end_time.values[1] == run.t[-1] < 0.2 and found.warnings.values[1] == "\n".join(run.warnings)


def test_a_scene_without_a_rest_has_a_reason():
    scenes = [net(), replace(net(), effects=())]
    scenes[1] = replace(net(driven=True), effects=[Gravity(0.0)])
    found = simulate_many(scenes, T_END, method="edmc", dt=DT)
    assert list(found.status.values) == ["done", "failed"] and "NoRestError" in found.reason.values[1]


@pytest.mark.parametrize(
    ("scenes", "asked", "message"),
    [
        (net(), {}, "One scene needs `vary`"),
        ([net()], {"vary": {"EA": [1.0]}}, "`vary` is given beside several"),
        ([], {}, "none is given"),
        ([net(), held_net()], {}, "those of scenes\\[1\\] differ"),
        ([net(), 3], {}, "A scene must be a Scene"),
        (3, {}, "A scene must be a Scene"),
        (net(), {"vary": {"EB": [1.0]}}, "Nothing called `EB` can be varied here"),
        (net(), {"vary": {"dt": [1.0]}}, "`dt` is an argument of all runs"),
        (net(), {"vary": {"EA": [1e3, 1e4], "zeta": [0.1]}}, "a value for every run"),
        (net(), {"vary": {"EA": 1e3}}, r"in a sequence, one for each run, but `EA` has 1000\.0"),
        (net(), {"vary": {"EA": "1e3"}}, r"in a sequence, one for each run, but `EA` has '1e3'"),
        (net(), {"vary": {"EA": [[1.0], [1.0, 2.0]]}}, "in a sequence, one for each run"),
        (net(), {"vary": {"segments": [5, 10]}}, "the same segments, which `segments` changes; a sweep may vary them"),
        (net(), {"vary": {"s0-p0.segments": [5, 10]}}, "the same segments, which `s0-p0.segments` changes"),
        ("net_held", {"vary": {"EA": [1.0]}}, "A scene must be a Scene, but it is 'net_held'"),
        ([net()], {"keep": "position"}, r"`keep` must be a list .*, as .*position.*, but it is 'position'"),
        ([net()], {"keep": 3}, r"`keep` must be a list .* but it is 3"),
        ([net()], {"start": "rest"}, '`start` must be "equilibrium", "calm", "straight" or a State, but it is \'rest\''),
        (net(), {"vary": {5: [1.0]}}, "must be named by a text, but the name is 5"),
        ([net()], {"keep": ("tensions",)}, "did you mean `tension`|has 'tensions'|tension"),
        ([net()], {"dt": None}, "neither `save_every` nor `dt` is given"),
        ([net()], {"save_every": 0.015}, "`save_every` must be a multiple of the step"),
        ([net()], {"workers": 0}, "`workers` must be an integer from 1"),
        ([net()], {"method": "edmcc"}, "Argument `method` must be one of"),
    ],
)
def test_what_cannot_be_is_refused(scenes, asked, message):
    with pytest.raises((InputError, SceneError), match=message):
        simulate_many(scenes, T_END, **({"method": "edmc", "dt": DT} | asked))


def test_more_than_memory_holds_is_refused(monkeypatch):
    monkeypatch.setenv(BYTES.variable, "1e4")
    with pytest.raises(InputError, match="What is kept of 100 runs"):
        simulate_many(net(), T_END, vary={"EA": np.geomspace(1e3, 1e4, 100)}, method="edmc", dt=DT)


def test_numbers_say_their_units():
    varied = {
        "EA": [1e3, 1e4],
        "p0.mass": [0.1, 0.2],
        "gravity.g": [9.81, 1.6],
        "zeta": [0.0, 0.1],
    }
    kept = ["position", "velocity", "tension", "shape", "energy", "error_estimate", "tension_error"]
    found = simulate_many(net(), T_END, vary=varied, method="edmc", dt=DT, keep=kept)
    units = {name: values.attrs.get("units") for name, values in found.variables.items() if values.dtype.kind in "if"}
    assert units == {
        "position": "m", "velocity": "m/s", "tension": "N", "shape": "m", "energy": "J",
        "error_estimate": "m", "tension_error": "1",
        "step": "s", "end_time": "s", "steps": "1", "newton_iterations": "1", "run": "1", "t": "s",
        "EA": "N", "p0.mass": "kg", "gravity.g": "m/s2", "zeta": None,
    }  # fmt: skip
    assert all(values.attrs["long_name"] for values in found.data_vars.values())


def test_errors_that_are_kept_are_those_that_each_run_tells():
    scenes = [net(1e3), net(2e4), net(1e4, mass=0.1)]
    found = simulate_many(scenes, T_END, method="edmc", dt=DT, keep=["error_estimate", "tension_error"])
    alone = [simulate(scene, T_END, method="edmc", dt=DT) for scene in scenes]
    assert found.error_estimate.values.tolist() == [run.error_estimate for run in alone]
    assert found.tension_error.values.tolist() == [run.tension_error for run in alone]
    assert "t" in found.coords and "position" not in found
    found = simulate_many(scenes[:1], 3 * DT, method="edmc", dt=DT, keep=["error_estimate"])  # too short to tell an error
    assert np.isnan(found.error_estimate.values).all() and simulate(scenes[0], 3 * DT, method="edmc", dt=DT).error_estimate is None


def test_ctrl_c_leaves_the_runs_that_were_done(monkeypatch):
    scenes, take, took = [net(EA) for EA in (1e3, 2e3, 3e3, 4e3)], RunTable.take, []

    def stopped(table, k, run):
        if len(took) == 2:
            raise KeyboardInterrupt
        took.append(k)
        take(table, k, run)

    monkeypatch.setattr(RunTable, "take", stopped)
    with pytest.raises(RunsInterrupt, match="Stopped after 2 of 4 runs") as caught:
        simulate_many(scenes, T_END, method="edmc", dt=DT, workers=1)
    found = caught.value.found
    assert found.status.values.tolist() == ["done", "done", "not run", "not run"]
    alone = simulate(scenes[1], T_END, method="edmc", dt=DT)
    assert np.array_equal(found.position.sel(run=1, point="p0"), alone.position("p0"))
    assert np.isnan(found.position.sel(run=2)).all()


@pytest.mark.skipif(not hasattr(signal, "SIGUSR1"), reason="the system has no such signal")
def test_what_a_handler_raises_leaves_the_runs_that_were_done_too(monkeypatch):
    """As the alarm by which a program limits its time."""
    take = RunTable.take

    def signalled(table, k, run):
        take(table, k, run)
        if k == 0:
            os.kill(os.getpid(), signal.SIGUSR1)

    def late(*given):
        raise TimeoutError("late")

    monkeypatch.setattr(RunTable, "take", signalled)
    before = signal.signal(signal.SIGUSR1, late)
    try:
        with pytest.raises(TimeoutError, match="late") as caught:
            simulate_many([net(EA) for EA in (1e3, 2e3, 3e3)], T_END, method="edmc", dt=DT, workers=1)
    finally:
        signal.signal(signal.SIGUSR1, before)
    alone = simulate(net(1e3), T_END, method="edmc", dt=DT)
    assert np.array_equal(caught.value.found.position.sel(run=0, point="p0"), alone.position("p0"))
    assert "of 3 runs. The `found` of this exception has those that were done" in caught.value.__notes__[0]
