"""What is recommended keeps the error against a far finer run, is the cheaper of what was tried, and says what is out of reach."""

import re
import shlex
from dataclasses import replace

import numpy as np
import pytest
from systems import four_cables, loose_cable

from anet_lumped import Cable, Fixed, Free, InputError, PayloadChange, Scene, SceneError, simulate
from anet_lumped.advice.pilots import Pilots, halfway
from anet_lumped.advice.recommend import recommend, scale_of_motion
from anet_lumped.advice.recommendation import RecommendError
from anet_lumped.effects import Gravity
from studies.command_line import main


@pytest.fixture(scope="module")
def found():
    return recommend(four_cables(1e4, carried=True), 1e-3, at="p0", t_end=2.0, realtime=2.0)


def test_error_is_kept(found):
    """Against four times the segments and an eighth of the step of another method."""
    best = simulate(found.scene, 2.0, save_every=0.05, **found.best.stepping)
    fine = four_cables(1e4, carried=True, segments=4 * found.segments["s0-p0"])
    exact = simulate(fine, 2.0, method="generalised_alpha", dt=1e-3, save_every=0.05)
    error = np.linalg.norm(best.position("p0") - exact.position("p0"), axis=1).max()
    assert error <= 1e-3
    assert found.checked_error == pytest.approx(error, rel=0.3)
    assert found.segments_error + found.time_error <= 1e-3 and found.fast_enough
    assert found.elasticity == pytest.approx(1.3e-4, rel=0.5)  # EA = 1e4 N against inf


def test_it_is_not_finer_than_it_need_be(found):
    """Parts near their shares: half of the error each, within what a whole number of segments and an even step leave."""
    assert found.segments_error > 0.2e-3 and found.time_error > 0.1e-3
    assert found.best.times_real_time >= found.runner_up.times_real_time


def test_the_error_of_a_tension_is_kept():
    """Of the ends of a cable, against four times the segments and an eighth of the step of another method."""
    found = recommend(four_cables(1e4, carried=True), 0.02, tension="s0-p0", t_end=1.0)
    best = simulate(found.scene, 1.0, save_every=1.0 / 160.0, **found.best.stepping)
    fine = four_cables(1e4, carried=True, segments=4 * found.segments["s0-p0"])
    exact = simulate(fine, 1.0, method="generalised_alpha", dt=1.0 / 1280.0, save_every=1.0 / 160.0)
    for end in ("s0", "p0"):
        assert np.abs(best.end_tension("s0-p0", end) - exact.end_tension("s0-p0", end)).max() <= 0.02
    assert found.unit == "N" and "error of the tension at the ends of s0-p0: asked 0.02 N" in str(found)
    assert found.segments_error + found.time_error <= 0.02 and found.checked_error <= 0.02


def test_smaller_errors_cost_more(found):
    fine = recommend(four_cables(1e4, carried=True), 2e-4, at="p0", t_end=2.0)
    assert fine.segments["s0-p0"] > 1.5 * found.segments["s0-p0"]
    assert fine.time_error < 1e-4 and fine.checked_error < 2e-4


def test_soft_cables_may_be_marched_explicitly():
    """Where the stable step is as long as the motion asks for, verlet is among what is compared."""
    scene = loose_cable(5.0, 0.0, compression="linear")
    search = Pilots(scene, ("b",), 0.3, "straight", scale_of_motion(scene, "straight"))
    found = list(search.candidates(10, 1e-3))
    assert {"edmc", "verlet"} == {one.method for one in found}
    assert all(one.error <= 1e-3 for one in found)


def call(words):
    with pytest.raises(SystemExit) as stopped:
        main(words)
    assert stopped.value.code == 0


def test_command(capsys):
    """The command that is printed runs as it stands."""
    call(["recommend", "net_carried", "--error", "2mm", "--at", "p0", "--t-end", "1"])
    command = re.search(r"command: anet-lumped (.*)", capsys.readouterr().out).group(1)
    call(shlex.split(command))
    assert "status: done" in capsys.readouterr().out


def test_messages(capsys):
    net = four_cables(1e4)
    with pytest.raises(ValueError, match=r"`error` must be positive and finite, but it is -1.0"):
        recommend(net, -1.0)
    with pytest.raises(InputError, match=r'Only one of `at` and `tension` may be given, but they are "p0" and "s0-p0"'):
        recommend(net, 1e-3, at="p0", tension="s0-p0")
    with pytest.raises(SceneError, match=r'no cable "s0-p1", did you mean "s0-p0"'):
        recommend(net, 1.0, tension="s0-p1")
    with pytest.raises(SceneError, match='free point, but "s0" is held; free are p0'):
        recommend(net, 1e-3, at="s0")
    with pytest.raises(RecommendError, match="segments in the finest cable, of which 3000 are the most"):
        recommend(four_cables(1e4, carried=True), 1e-9, t_end=0.2)
    with pytest.raises(SystemExit) as stopped:
        main(["recommend", "net_carried", "--error", "1furlong"])
    assert stopped.value.code == 2 and "must be a length such as 1mm" in capsys.readouterr().err


def test_a_pace_out_of_reach(capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["recommend", "net_carried", "--error", "1mm", "--t-end", "1", "--realtime", "1e6"])
    assert stopped.value.code == 1 and "allow a larger error" in capsys.readouterr().err


def test_scenes_without_free_points():
    scene = four_cables(1e4)
    held = Scene(scene.points[:2], [_between(scene)], scene.effects)
    assert recommend(held, 1e-3, t_end=0.2).segments_error <= 0.5e-3


def _between(scene):
    return replace(scene.cables[0], start="s0", end="s1", name="span", length=1.3)


def test_links_are_weighed_where_nothing_stretches():
    """Their error is kept against a tolerance a thousand times smaller, and the elastic net is as near as its stretch."""
    search = Pilots(four_cables(1e6, carried=True), ("p0",), 1.0, "equilibrium", 0.3)
    rigid = search.without_stretch(8)
    assert all(np.isinf(cable.EA) for cable in rigid.cables)
    found = search.by_links(rigid, 1e-6)
    assert found.method == "links" and found.error <= 1e-6 and found.times_real_time > 0.0
    exact = simulate(rigid, 1.0, method="links", rtol=1e-3 * found.rtol, save_every=0.025).position("p0")
    run = simulate(rigid, 1.0, save_every=0.025, **found.stepping)
    assert np.abs(run.position("p0") - exact).max() <= 1e-6


@pytest.mark.parametrize(
    ("stop", "left_out", "checked"),
    [
        ("adaptive", "other methods and the check by a finer run", False),
        ("check", "other methods and the check by a finer run", False),
        ("elasticity", "the same cables without stretch", True),
    ],
)
def test_ctrl_c_leaves_what_there_is(monkeypatch, capsys, stop, left_out, checked):
    def interrupted(self, *given):
        raise KeyboardInterrupt

    monkeypatch.setattr(Pilots, stop, interrupted)
    with pytest.raises(SystemExit) as ended:
        main(["recommend", "net_carried", "--error", "2mm", "--at", "p0", "--t-end", "0.5"])
    said = capsys.readouterr().out
    assert ended.value.code == 130 and f"stopped before: {left_out}" in said and "command: anet-lumped simulate" in said
    found = recommend(four_cables(1e4, carried=True), 2e-3, at="p0", t_end=0.5)
    assert found.left_out == left_out and f"stopped before {left_out}" in str(found)
    assert (found.checked_error is not None) == checked and ("checked [mm]" in said) == checked
    assert ("error not checked (asked 0.002 m)" in repr(found)) != checked and found.elasticity is None


def test_ctrl_c_before_any_method_leaves_nothing(monkeypatch):
    def interrupted(self, *given):
        raise KeyboardInterrupt

    monkeypatch.setattr(Pilots, "fixed", interrupted)
    with pytest.raises(KeyboardInterrupt):
        recommend(four_cables(1e4, carried=True), 2e-3, at="p0", t_end=0.5)


@pytest.mark.parametrize("segments", [2, 3, 4, 15])
def test_halfway_along_a_parabola_is_on_it(segments):
    x = np.linspace(-1.0, 2.0, segments + 1)
    place = halfway(np.stack([x, np.zeros_like(x), x * x], axis=1)[None])
    np.testing.assert_allclose(place, [[0.5, 0.0, 0.25]], rtol=0, atol=1e-15)


def test_cables_that_creep_are_recommended_fixed_steps():
    """Of edmc, which alone carries how far a cable has crept; other methods and tolerances are left out."""
    cable = Cable("a", "b", length=10.0, mass_per_length=1.0, EA=1e5, EA_dynamic=3e5, BA_creep=1e6, zeta=0.05, segments=10)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Fixed("b", (9.0, 0.0, 0.0))], [cable], [Gravity(9.81)])
    found = recommend(scene, 0.01, t_end=2.0)
    assert found.checked_error < 0.01 and found.best.method == "edmc" and "dt" in found.best.stepping


def plucked(*events, mass=0.5):
    """A string of 1.2 m under 880 N, pulled down in the middle by 3.3 mm."""
    kind = {"length": 0.5985, "mass_per_length": 6e-3, "EA": 3.5e5, "segments": 10}
    points = [Fixed("a", (0, 0, 0)), Free("p", mass), Fixed("b", (1.2, 0, 0))]
    return Scene(points, [Cable("a", "p", **kind), Cable("p", "b", **kind)], [Gravity(9.81)], events)


def test_what_happens_late_is_simulated():
    """The string is let go after half a second, a hundred times its period: 6.9 ms were simulated, in which it rests."""
    found = recommend(plucked(PayloadChange("p", 0.5, 0.01)), 5e-4, at="p")
    assert 0.5 < found.t_end < 0.6 and 2e-3 < found.way < 1e-2 and not found.note
    best = simulate(found.scene, found.t_end, **found.best.stepping)
    fine = replace(found.scene, cables=[replace(cable, segments=4 * cable.segments) for cable in found.scene.cables])
    exact = simulate(fine, found.t_end, method="edmc", dt=found.t_end / 2e4, save_every=found.t_end / 1e4)
    theirs = np.column_stack([np.interp(best.t, exact.t, x) for x in exact.position("p").T])
    assert np.linalg.norm(best.position("p") - theirs, axis=1).max() <= 5e-4


def test_a_motion_in_which_nothing_happens_is_told(capsys):
    """From the equilibrium the string rests: two segments and a step of any length were recommended without a word."""
    found = recommend(plucked(), 1e-4, at="p")
    assert found.way < 1e-9 and "less than the error asked for" in found.note and found.note in str(found)
    with pytest.raises(SystemExit) as stopped:
        main(["recommend", "net_carried", "--error", "9m", "--t-end", "0.1"])
    assert stopped.value.code == 0
    assert "less than the error asked for" in capsys.readouterr().out.replace("\n", " ")


def test_errors_that_rise_and_fall_with_the_number_of_segments(monkeypatch):
    """A number that keeps the error is not given up because those tried later are no nearer to it."""
    search = Pilots(plucked(), ("p",), 1.0, "equilibrium", 0.3)
    errors = {8: 1e-5, 2: 3e-3, 7: 1e-5}
    monkeypatch.setattr(search, "apart", lambda one, _: 0.75 * errors.get(one[0].cables[0].segments, 2e-3))
    count, error = search.segments(1e-3)
    assert (count, error) in ((8, 1e-5), (7, 1e-5))
