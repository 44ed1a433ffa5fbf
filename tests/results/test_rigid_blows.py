"""The largest tension of cables that do not stretch has no value once they catch something, and runs say so."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, Scene, State, load_run, paths, simulate
from anet_lumped.effects import Gravity
from anet_lumped.results.events import BLOW

G, L, M = 9.81, 1.0, 2.0
NO_VALUE = "the largest tension has no value"


def hung(top, EA=math.inf, segments=1, mass_per_length=1e-3):
    cable = Cable("o", "m", length=L, mass_per_length=mass_per_length, EA=EA, segments=segments, compression="none")
    return Scene([top, Free("m", mass=M)], [cable], [Gravity(G)])


def from_bottom(scene, speed):
    """A straight cable that hangs and turns about its upper end, so that the weight has a speed."""
    segments = scene.cables[0].segments
    down = np.linspace(0.0, 1.0, segments + 1)[:, None]
    return State.of(scene, shapes={"o-m": down * (0, 0, -L)}, velocities={"o-m": down * (speed, 0, 0)})


def says(run):
    return any(NO_VALUE in words for words in run.warnings)


def test_a_weight_that_falls_into_its_cable():
    """What steps show is the impulse over their length; it is told, and the default does not keep it."""
    scene = hung(Fixed("o", (0, 0, 0)))
    start = State.of(scene, shapes={"o-m": [(0, 0, 0), (0.3, 0, -0.2)]})
    peaks = [simulate(scene, 1.0, start=start, method="edmc", dt=dt, save_every=0.02) for dt in (1e-3, 1e-4, 1e-5)]
    assert all(run.tension_error == 1.0 and says(run) for run in peaks)
    assert peaks[2].peak_tension() > 5.0 * peaks[1].peak_tension() > 10.0 * peaks[0].peak_tension()
    run = simulate(scene, 1.0, start=start)
    assert run.ok and run.kept is False and says(run) and run.tension_error == 1.0
    assert run.work.steps < 3000  # shorter steps are in vain


@pytest.mark.parametrize("method", [None, "links", "edmc"])
def test_a_start_at_once(method, tmp_path):
    """The weight has the speed of the point from the start on. A cable that stretches pulls with M g + v sqrt(k M)."""
    top = Driven("o", paths.line((0, 0, 0), (0, 0, 1.5), 0.0))
    run = simulate(hung(top), 1.0, method=method)
    assert run.tension_error == 1.0 and says(run) and not run.kept
    assert [event.kind for event in run.events] == [BLOW] and "velocities jump" in str(run.events[0])
    run.save(tmp_path / "run.nc")
    assert load_run(tmp_path / "run.nc").tension_error == 1.0
    EA = 2e4
    stretched = simulate(hung(top, EA), 0.2, method="dop853", rtol=1e-9, atol=1e-9, save_every=1e-3)
    assert not says(stretched)
    assert stretched.peak_tension() == pytest.approx(M * G + 1.5 * math.sqrt(EA / L * M), rel=0.01)


def test_cables_that_go_slack_and_catch_nothing_keep_their_largest_tension():
    """A weight that is thrown leaves its circle and flies; it pulled most at the bottom, with M g + M v^2/L."""
    speed, angle = 1.9 * math.sqrt(G * L), -0.8
    scene, along = hung(Fixed("o", (0, 0, 0))), np.array([math.cos(angle), 0.0, math.sin(angle)])
    v = math.sqrt(speed**2 - 2.0 * G * L * (1.0 - math.cos(angle))) * along
    start = State.of(scene, shapes={"o-m": [(0, 0, 0), (L * math.sin(angle), 0, -L * math.cos(angle))]}, velocities={"m": v})
    run = simulate(scene, 0.9, start=start)
    assert (run.segment_tension[-1] == 0.0).all() and run.kept and not says(run)
    assert run.peak_tension() == pytest.approx(M * G + M * speed**2 / L, rel=2e-3)


@pytest.mark.parametrize("slack", [True, False])
def test_a_rope_that_does_not_stretch_beside_one_that_does(slack):
    """A weight on a rubber cord falls into a rope of 1.8 m; one of 1 m holds it from the start on."""
    cord = Cable("a", "m", length=1.0, mass_per_length=0.02, EA=60.0, zeta=0.05, segments=4, compression="none")
    rope = Cable("b", "m", length=1.8 if slack else 1.0, mass_per_length=0.02, EA=math.inf, segments=1, compression="none")
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0.3, 0, 0)), Free("m", mass=5.0)], [cord, rope], [Gravity(G)])
    at = (0.3 - 0.1 * math.sqrt(3), 0, -0.9 if slack else -math.sqrt(0.97))
    start = State.of(scene, shapes={"a-m": [(0, 0, 0), at], "b-m": [(0.3, 0, 0), at]})
    for dt in (1e-3, 1e-4):
        run = simulate(scene, 0.8, start=start, method="edmc", dt=dt)
        assert says(run) is slack and (run.tension_error == 1.0) is slack


def test_what_stays_taut_keeps_its_largest_tension():
    scene = hung(Fixed("o", (0, 0, 0)), segments=4, mass_per_length=0.2)
    run = simulate(scene, 3.0, start=from_bottom(scene, 2.0))
    assert run.kept and not says(run) and run.tension_error < 0.02


def test_a_peak_between_steps_and_states_of_links():
    """A chain turns over fast between two of its steps and two saved states."""
    scene = hung(Fixed("o", (0, 0, 0)), segments=3, mass_per_length=0.6)
    scene = Scene([scene.points[0], Free("m", mass=0.2)], scene.cables, scene.effects)
    start = from_bottom(scene, 5.0)
    worst = 0.0
    for t_end in (1.5, 2.0, 2.5):
        run = simulate(scene, t_end, start=start)
        fine = simulate(scene, t_end, start=start, method="links", rtol=1e-11, atol=1e-12, save_every=t_end / 4000)
        worst = max(worst, abs(run.peak_tension() / fine.peak_tension() - 1.0)) if run.kept else worst
    assert worst < 0.02
