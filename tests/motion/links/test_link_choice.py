"""When links are chosen, what error they keep, and what is said of their steps."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from slow import slow
from systems import four_cables, loose_cable

from anet_lumped import Cable, Fixed, Free, InputError, Scene, State, simulate
from anet_lumped.effects import Load
from anet_lumped.model.build import build
from anet_lumped.motion.choice import time_scale
from anet_lumped.motion.known_errors import Wanted
from anet_lumped.motion.simulate import StabilityWarning, straight
from anet_lumped.motion.tolerance import keep_error_by_tolerance
from anet_lumped.results.run import Run

INF = math.inf


def loose(segments=20):
    return loose_cable(INF, 0.0, segments=segments, compression="linear")


@pytest.mark.parametrize("save_every", [0.0025, *slow(None)])
def test_the_default_takes_links_where_they_are_cheaper_and_says_so(save_every):
    """The level release past its whip: the run keeps 1 mm, whatever it saves, and one of a far smaller tolerance agrees."""
    run = simulate(loose(), 0.7, start="straight", save_every=save_every)
    fine = simulate(loose(), 0.7, method="links", rtol=1e-12, start="straight", save_every=save_every)
    assert run.method == "links" and run.kept
    assert run.reason.startswith("links: no cable stretches; a tolerance of") and "keeps places to 0.001 m" in run.reason
    assert np.abs(run.q - fine.q).max() < 1e-3


def test_the_default_keeps_edmc_where_that_is_cheaper():
    run = simulate(four_cables(INF, 0.0, carried=True), 1.0)
    fine = simulate(four_cables(INF, 0.0, carried=True), 1.0, method="links", rtol=1e-12)
    assert run.method == "edmc" and run.kept and run.reason.startswith('edmc: cable "s0-p0" does not stretch')
    assert np.abs(run.position("p0")[-1] - fine.position("p0")[-1]).max() < 1e-3


@pytest.mark.parametrize("error", [1e-5, *slow(1e-8)])
def test_an_error_that_is_asked_for_is_kept(error):
    scene = four_cables(INF, 0.0, segments=8, carried=True)
    run = simulate(scene, 2.0, method="links", error=error)
    fine = simulate(scene, 2.0, method="links", rtol=1e-13)
    assert run.kept and np.abs(run.q - fine.q).max() < error and run.work.steps < 2000
    assert f"keeps places to {error:.2g} m" in run.reason


@pytest.mark.parametrize("options", [{}, dict(error=1e-7), dict(rtol=1e-6), dict(dt=1e-3)])
def test_cables_that_stretch_are_never_marched_by_links(options):
    run = simulate(loose_cable(1e7, 0.05, segments=6), 0.3, start="straight", **options)
    assert not run.method.startswith("links")


@pytest.mark.parametrize("method", ["links", "links5"])
def test_they_are_refused_by_name(method):
    mixed = loose_cable(INF, 0.0)
    mixed = replace(
        mixed, points=[*mixed.points, Fixed("c", (2, 0, 0))],
        cables=[*mixed.cables, Cable("b", "c", length=1.5, mass_per_length=0.1, EA=2e4, segments=3)],
    )  # fmt: skip
    for scene, name, EA in ((loose_cable(1e4), "a-b", "10000"), (mixed, "b-c", "20000")):
        with pytest.raises(
            InputError, match=f'"{method}" needs cables that do not stretch, EA=inf, but cable "{name}" has EA={EA} N'
        ):
            simulate(scene, 0.1, method=method, start="straight")


@pytest.mark.parametrize("argument", ["rtol", "atol"])
def test_a_given_step_is_of_order_5_and_a_tolerance_of_order_8(argument):
    scene = four_cables(INF, 0.0, segments=3)
    assert simulate(scene, 0.05, method="links", dt=0.005).method == "links5"
    assert simulate(scene, 0.05, method="links", dt=0.005, **{argument: 1e-6}).method == "links"
    assert simulate(scene, 0.05, method="links").method == "links"


def test_a_step_beyond_the_transverse_limit_warns():
    """Limit: h omega = 1 with the highest transverse frequency of a hanging net; beyond it, whatever comes of it is said."""
    scene = four_cables(INF, 0.0)
    with pytest.warns(
        StabilityWarning, match=r'Step dt=0.05 s is beyond the largest stable step of "links5", .* transverse vibrations'
    ):
        run = simulate(scene, 1.0, method="links", dt=0.05)
    assert any("transverse vibrations" in text for text in run.warnings)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert simulate(scene, 1.0, method="links", dt=0.005).ok


@pytest.mark.parametrize("start", ["straight", "equilibrium"])
def test_a_senseless_tolerance_ends_in_bounded_work(start):
    """At 80 segments: done, or a message."""
    scene = loose_cable(INF, 0.0, segments=80) if start == "straight" else four_cables(INF, 0.0, segments=80, carried=True)
    run = simulate(scene, 1.0, method="links", rtol=0.1, atol=0.1, start=start)
    assert run.ok or run.message
    assert run.work.steps + run.work.rejected < 100_000 and np.isfinite(run.q).all()


@pytest.mark.each_once
@pytest.mark.parametrize("options", [{}, dict(method="links"), dict(method="edmc"), dict(method="links", error=1e-6)])
@pytest.mark.parametrize("speed", [0.0, 1e-3, 30.0])
def test_without_gravity(options, speed):
    """No weight and no stiffness says how fast a motion is: its speed does. A rod that turns about its middle."""
    cable = Cable("x", "y", length=1.0, mass_per_length=0.1, EA=INF, segments=4)
    scene = Scene([Free("x", 0.1, at=(-0.5, 0, 0)), Free("y", 0.1, at=(0.5, 0, 0))], [cable], [])
    model = build(scene)
    q = straight(model)
    v = np.stack([0 * q[:, 0], speed * q[:, 0], 0 * q[:, 0]], axis=1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = simulate(scene, 0.5, start=State(model, 0.0, q, v, np.zeros(4)), **options)
    angle = speed * 0.5
    assert run.ok and run.position("y")[-1] == pytest.approx([0.5 * math.cos(angle), 0.5 * math.sin(angle), 0.0], abs=2e-3)


def test_time_scale_without_gravity():
    scene = Scene(
        [Free("x", at=(0, 0, 0)), Free("y", at=(1, 0, 0))], [Cable("x", "y", length=1.0, mass_per_length=0.1, EA=INF, segments=4)]
    )
    assert time_scale(scene) == time_scale(scene, speed=1e-3) == pytest.approx(1 / math.sqrt(9.80665))
    assert time_scale(scene, speed=50.0) == pytest.approx(0.02)


def test_a_finer_run_that_fails_leaves_the_coarser_one():
    """It is told what is known of that, and why no more."""
    good = simulate(loose(4), 0.1, method="links", rtol=1e-3, start="straight")
    tried = []

    def march(tolerance) -> Run:
        tried.append(tolerance)
        return good if len(tried) == 1 else replace(good, status="unconverged", message="It stuck.")

    run = keep_error_by_tolerance(march, Wanted(1e-4, 0.02), 1.0)
    assert run.status == "done" and run.kept is False and len(tried) == 2 and tried[1] == pytest.approx(0.1 * tried[0])
    assert any("links with a smaller tolerance stopped at t=0.1 s: It stuck." in text for text in run.warnings)


@pytest.mark.parametrize("most", [2, 4])
def test_runs_that_do_not_come_nearer_end(most):
    """Chaos keeps no error: after so many runs the last one is told, with what they differ by."""
    good, tried = simulate(loose(4), 0.1, method="links", rtol=1e-3, start="straight"), []

    def march(tolerance) -> Run:
        tried.append(tolerance)
        return replace(good, q=good.q + 0.01 * (-1.0) ** len(tried))

    run = keep_error_by_tolerance(march, Wanted(1e-4, 0.02), 1.0, most)
    assert len(tried) == most and run.kept is False and f"with a tolerance of {tried[-1]:.2g} m" in run.reason


def test_a_slack_cable_that_cannot_be_followed_so_finely():
    """Past its whip a cable that cannot push keeps no 1e-5 m; the run is done, and says until when it does."""
    run = simulate(loose_cable(INF, 0.0), 0.9, method="links", error=1e-5, start="straight", save_every=0.005)
    assert run.status == "done" and run.kept is False
    assert any("places are known to 1e-05 m until t=0." in text for text in run.warnings)


def test_a_load_without_gravity():
    """A load turns a cable whose start says nothing of its speed."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=INF, segments=4, compression="linear")
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 1.0, at=(1, 0, 0))], [cable], [Load((0.0, 0.0, -5.0))])
    run = simulate(scene, 0.5, method="links", start="straight")
    fine = simulate(scene, 0.5, method="links", rtol=1e-12, start="straight")
    assert run.ok and np.abs(run.q - fine.q).max() < 1e-4
