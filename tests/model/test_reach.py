"""Cables that do not stretch and do not reach: refused at rest, at the start and where they are driven to, with both numbers."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import (
    Cable,
    CableCut,
    Driven,
    Fixed,
    Free,
    InputError,
    NoRestError,
    Scene,
    Session,
    equilibrium,
    paths,
    signals,
    simulate,
)
from anet_lumped.effects import Gravity, LineChange
from anet_lumped.model.reach import first_shortfall, shortfall


def rigid(start, end, length=1.0, segments=5, **more):
    return Cable(start, end, length=length, mass_per_length=0.1, EA=np.inf, segments=segments, **more)


def spanned(span, segments=5, EA=np.inf):
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=EA, segments=segments)
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", (span, 0, 0))], [cable], [Gravity()])


def chain(span):
    """Two cables of 1 m with a free point between them."""
    points = [Fixed("a", (0, 0, 0)), Free("m", mass=0.1, at=(0.5 * span, 0, 0)), Fixed("b", (span, 0, 0))]
    return Scene(points, [rigid("a", "m"), rigid("b", "m", segments=1)], [Gravity()])


@pytest.mark.parametrize("segments", [1, 5])
@pytest.mark.parametrize("span", [1.000001, 1.1, 2.0])
def test_a_cable_that_does_not_reach_is_refused(span, segments):
    numbers = rf'"a-b" is 1 m long, and points "a" and "b" are {span:.9g} m apart at t=0 s; give EA'
    with pytest.raises(NoRestError, match=numbers):
        equilibrium(spanned(span, segments))
    for start in ("equilibrium", "straight"):
        with pytest.raises(InputError, match=numbers):
            simulate(spanned(span, segments), 0.1, start=start)


def test_a_loaded_cable_as_long_as_its_chord_has_no_tension_that_would_do():
    with pytest.raises(NoRestError, match=r'"a-b" is 1 m long, and points "a" and "b" are 1 m apart'):
        equilibrium(spanned(1.0))


@pytest.mark.parametrize("EA", [1e4, 7e10, np.inf])
@pytest.mark.parametrize("span", [0.8, 1.0 - 1e-12, 1.0])
def test_a_single_segment_that_is_not_stretched_carries_nothing(span, EA):
    assert equilibrium(spanned(span, 1, EA)).tension("a-b") == pytest.approx(0.0, abs=0.0)


@pytest.mark.parametrize(("compression", "tension"), [("none", 0.0), ("damped", 0.0), ("linear", -2000.0)])
def test_a_single_segment_between_supports_follows_its_law(compression, tension):
    bar = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=1, compression=compression)
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0.8, 0, 0))], [bar], [Gravity()])
    assert equilibrium(scene).tension("a-b") == pytest.approx(tension, rel=1e-12)


def test_cables_one_after_the_other_reach_as_far_as_all_of_them():
    assert equilibrium(chain(1.9)).stable
    with pytest.raises(NoRestError, match=r'cables "a-m", "b-m" are 2 m long, and points "a" and "b" are 2.1 m apart'):
        equilibrium(chain(2.1))


def test_a_start_that_pulls_a_loose_end_too_far_is_refused():
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=0.1, at=(1.2, 0, 0))], [rigid("a", "b")], [Gravity()])
    assert shortfall(scene, 0.0) is None and equilibrium(scene).stable
    with pytest.raises(ValueError, match=r'"a-b" is 1 m long, and points "a" and "b" are 1.2 m apart'):
        simulate(scene, 0.1, start="straight")


@pytest.mark.parametrize("segments", [1, 5])
def test_a_run_stops_where_a_cable_is_driven_taut(segments):
    """From 0.9 m at 0.5 m/s, reached over 0.1 s: 0.025 m in the ramp, and 0.075 m in 0.15 s after it."""
    points = [Fixed("a", (0, 0, 0)), Driven("b", paths.line((0.9, 0, 0), (0.5, 0, 0), 0.1))]
    scene = Scene(points, [rigid("a", "b", segments=segments)], [Gravity()])
    assert first_shortfall(scene, 0.0, 1.0).t == pytest.approx(0.25, abs=1e-6)
    run = simulate(scene, 1.0)
    assert run.status == "unconverged" and not run.reached_end
    assert run.t[-1] == pytest.approx(0.25, abs=0.02)  # within some steps
    assert "stopped at t=0.25 s. A cable with EA=inf must be longer" in run.message and "1 m apart at t=0.25 s" in run.message


def test_a_run_stops_where_a_cable_is_reeled_in_too_far():
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (0.9, 0, 0))]
    reel = LineChange({"a-b": signals.line(0.0, -0.2, 0.1)})
    scene = Scene(points, [rigid("a", "b")], [Gravity(), reel])
    short = first_shortfall(scene, 0.0, 2.0)
    assert short.length == pytest.approx(0.9, abs=1e-6) and short.distance == pytest.approx(0.9)
    run = simulate(scene, 2.0)
    assert run.status == "unconverged" and '"a-b" is 0.9 m long' in run.message


def test_what_reaches_is_left_alone():
    points = [Fixed("a", (0, 0, 0)), Driven("b", paths.line((0.5, 0, 0), (0.1, 0, 0), 0.1))]
    scene = Scene(points, [rigid("a", "b")], [Gravity()])
    assert first_shortfall(scene, 0.0, 1.0) is None and simulate(scene, 0.2).ok


def zigzag(middle, compression):
    """A cable of two segments of 0.5 m, of which the first is longer or shorter, hanging on a support."""
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=1.0)], [rigid("a", "b", segments=2, compression=compression)], [Gravity()])
    return dict(scene=scene, start={"a-b": [(0, 0, 0), (0, 0, -middle), (0.3, 0, -middle - 0.4)]})


@pytest.mark.parametrize("method", ["edmc", "links"])
@pytest.mark.parametrize(("middle", "compression"), [(0.51, "none"), (0.51, "linear"), (0.49, "linear")])
def test_a_start_of_segments_of_another_length_is_refused(method, middle, compression):
    """Every step would have to give the segments their lengths back, with tensions that are as large as the step is short."""
    made = zigzag(middle, compression)
    numbers = rf'segment 0 of cable "a-b" is 0.5 m long, and its nodes are {middle} m apart at t=0 s; start from a rest'
    with pytest.raises(InputError, match=numbers):
        simulate(made["scene"], 0.1, start=made["start"], method=method)
    with pytest.raises(InputError, match=numbers):
        Session(made["scene"], 0.01, start=made["start"])


def test_a_start_of_slack_segments_is_taken():
    made = zigzag(0.49, "none")
    assert simulate(made["scene"], 0.1, start=made["start"]).ok


@pytest.mark.parametrize("segment", [0, 2])
def test_a_run_goes_on_past_the_cut_of_a_cable_that_does_not_stretch(segment):
    """What has fallen is farther from the support than the cable is long. The end that hangs on falls freely, or swings on."""
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("b", mass=1.0)], [rigid("a", "b")], [Gravity()], events=[CableCut("a-b", 0.05, segment)]
    )
    run = simulate(scene, 0.6, dt=1e-3)
    on = simulate(scene, 0.1, start=run.final, dt=1e-3)
    assert run.ok and on.ok and on.events == run.events
    assert on.position("b")[-1, 2] == pytest.approx(-1.0 - 0.5 * 9.81 * 0.65**2, abs=1e-2)
    with Session(scene, 1e-3, start=run.final) as session:
        session.step()
    late = replace(equilibrium(scene), t=1.0)
    assert simulate(scene, 0.1, start=late, dt=1e-3).ok
