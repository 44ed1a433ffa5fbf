"""Cables that do not stretch, EA = inf: lengths, the limit of stiff ones, a pendulum, energy, and what does not take them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from systems import MU, four_cables, loose_cable

from anet_lumped import Cable, Driven, Fixed, Free, Scene, catenary, equilibrium, load_scene, save_scene, simulate
from anet_lumped.effects import Gravity
from anet_lumped.results.energy_balance import error_of_steps


def pendulum(angle, segments=1, mass=10.0):
    """A heavy ball on a rod of 1 m, let go at an angle [rad]; a thread of a millionth of its mass."""
    cable = Cable("a", "m", length=1.0, mass_per_length=1e-6 * mass, EA=math.inf, segments=segments, compression="linear")
    at = (math.sin(angle), 0.0, -math.cos(angle))
    return Scene([Fixed("a", (0, 0, 0)), Free("m", mass=mass, at=at)], [cable], [Gravity()])


def test_equilibrium_is_that_of_rigid_links():
    """The limit of stiff nets, and its own residual; lengths are those of the cables."""
    rest, stiff = equilibrium(four_cables(math.inf)), equilibrium(four_cables(1e9))
    assert rest.residual < 1e-14
    np.testing.assert_allclose(rest.q, stiff.q, atol=1e-8)
    assert all(rest.length(cable.name) == pytest.approx(1.0, abs=1e-12) for cable in rest.scene.cables)


@pytest.mark.parametrize("segments", [1, 2, 4, 8, 20, 300])
def test_a_cable_that_hangs_straight_down(segments):
    """Nothing is flexible in it along itself."""
    rest = equilibrium(loose_cable(math.inf, segments=segments))
    np.testing.assert_allclose(rest.position("b"), [0, 0, -1], atol=1e-12)
    assert simulate(rest.scene, 0.5, method="edmc", dt=0.1, start=rest).ok


def test_equilibrium_against_the_catenary():
    """Twice as many links, a quarter of the distance from the catenary that does not stretch."""
    curve = catenary((0, 0), (0.8, 0), length=1.0)
    off = []
    for segments in (20, 40):
        cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=math.inf, segments=segments)
        rest = equilibrium(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0.8, 0, 0))], [cable], [Gravity()]))
        off.append(abs(rest.shape("a-b")[:, 2].min() - curve.lowest[1]))
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("dt", [0.02, 0.005])
def test_lengths_over_a_minute(dt):
    """To 1e-9 of the cable over 60 s of a loose cable that whips and slackens; it never gets longer, and energy never rises."""
    run = simulate(loose_cable(math.inf, 0.0), 60.0, method="edmc", dt=dt, save_every=dt, start="straight")
    assert run.ok and run.length("a-b").max() < 1.0 + 1e-9
    total = run.energy[:, :3].sum(axis=1)
    assert np.diff(total).max() < 1e-6 * 0.981  # Newton's tolerance times the energy in play
    assert total[-1] < total[0] and error_of_steps(run) < 1e-6


def test_taut_lengths_of_the_carried_net():
    run = simulate(four_cables(math.inf, carried=True), 60.0, method="edmc", dt=0.02)
    assert run.ok
    for cable in run.scene.cables:
        assert np.abs(run.length(cable.name) - 1.0).max() < 1e-9
    assert error_of_steps(run) < 1e-6


def test_stiff_nets_tend_to_it():
    """p0 and tensions of the carried net at EA = 1e8 and 1e10 N differ from those at EA = inf by what the cables stretch."""
    runs = {EA: simulate(four_cables(EA, carried=True), 2.0, method="edmc", dt=0.01) for EA in (1e8, 1e10, math.inf)}
    for EA, largest in ((1e8, 3e-8), (1e10, 3e-10)):
        np.testing.assert_allclose(runs[EA].position("p0"), runs[math.inf].position("p0"), atol=largest + 2e-8)
        np.testing.assert_allclose(runs[EA].tension("s0-p0"), runs[math.inf].tension("s0-p0"), rtol=1e-3)


def test_pendulum():
    """A quarter of the period 4 K(1/2) sqrt(L/g) from 90 degrees to the bottom, of order 2; tension 3 m g cos(angle)."""
    quarter = math.sqrt(1 / 9.81) * quad(lambda x: (1 - 0.5 * math.sin(x) ** 2) ** -0.5, 0, math.pi / 2)[0]
    off = []
    for steps in (50, 100):
        dt = quarter / steps
        run = simulate(pendulum(math.pi / 2), quarter, method="edmc", dt=dt, save_every=dt, start="straight")
        off.append(np.linalg.norm(run.position("m")[-1] - [0.0, 0.0, -1.0]))
        np.testing.assert_allclose(np.linalg.norm(run.position("m"), axis=1), 1.0, atol=1e-9)
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.1)
    z = run.position("m")[:, 2]
    middle = 0.5 * (z[1:] + z[:-1])  # the tension of a step is that of its middle
    np.testing.assert_allclose(run.tension("a-m")[1:, 0], -3 * 10.0 * 9.81 * middle, atol=1e-3 * 294.3)


def test_only_edmc_and_links_take_it():
    with pytest.raises(ValueError, match=r'needs method="edmc" or .*"links.*, but cable "a-b" has EA=inf and the method is rk4'):
        simulate(loose_cable(math.inf), 0.1, method="rk4", dt=1e-3, start="straight")
    assert simulate(loose_cable(math.inf), 0.1, start="straight").method == "edmc"


def test_scene_file(tmp_path):
    scene = loose_cable(math.inf, 0.0)
    save_scene(scene, tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == scene


@pytest.mark.parametrize("dt", [4e-3, 0.5e-3])
def test_a_net_that_is_stopped_at_once_does_not_ring(dt):
    """Its velocities would change lengths: an impulse takes that, and tensions are those that links find, at any step."""
    moving = load_scene("net_carried")
    rigid = replace(moving, cables=tuple(replace(c, EA=math.inf, compression="linear") for c in moving.cables))
    last = simulate(rigid, 2.0, method="links", save_every=2.0, rtol=1e-9).final
    points = [Fixed(p.name, p.path.at(2.0)[0]) if isinstance(p, Driven) else p for p in rigid.points]
    still = replace(rigid, points=points)
    run = simulate(still, 0.5, method="edmc", dt=dt, start=last, save_every=0.02)
    exact = simulate(still, 0.5, method="links", rtol=1e-9, start=last, save_every=0.02)
    # a mean over the step before is some 2 % beside the tension at its end where transverse waves pass, at the longer step
    assert np.abs(run.segment_tension[1:] - exact.segment_tension[1:]).max() < 0.05 * exact.segment_tension.max()
    lost = run.energy_balance.imbalance
    assert lost < 1e-9 and run.energy[0, 5] == pytest.approx(exact.energy[0, 5], rel=1e-6) and run.energy[0, 5] > 1e-4
