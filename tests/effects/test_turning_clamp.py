"""Clamps whose direction moves: their energy and work, and a rod that is turned by one."""

import math

import numpy as np
import pytest
from test_bending import arrays, random_places

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, load_scene, paths, save_scene, simulate
from anet_lumped.effects import Bending, bending
from anet_lumped.model.build import build

TURNING = paths.circle((2.0, 0, 0), (0, 0, 0), (0, 1.0, 0), 4.0, 0.5, ramp=0.5)
SWINGING = paths.harmonic((0, 0, 1.0), (0.3, 0.2, 0), 0.7)


def rod(clamp, segments=8, compression="linear"):
    made = dict(length=1.0, mass_per_length=0.1, EA=1e5, EI=1.0, segments=segments, compression=compression)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))], [Cable("a", "b", zeta=0.02, **made)], [Bending({"a": clamp})])


@pytest.mark.parametrize("clamp", [TURNING, SWINGING], ids=lambda path: path.kind)
@pytest.mark.parametrize("h", [1e-4, 0.3])
def test_a_step_gives_back_its_energy_and_the_work_of_the_clamp(clamp, h):
    model = build(rod(clamp))
    base, q, index, params, f, D, near, far = random_places(model, 1), random_places(model, 2), *arrays(model)
    base[model.n_free :] = q[model.n_free :]
    taken, lost = bending.whole_step(1.1, h, 0.5, base, q, index, params, f, D, near, far)
    rise = bending.energy(1.1 + 0.5 * h, q, index, params) - bending.energy(1.1 - 0.5 * h, base, index, params)
    assert lost >= 0.0 and taken != 0.0
    assert rise == pytest.approx(-np.sum(f * (q - base)) - lost - taken, abs=1e-11)  # rounding of some 100 J


@pytest.mark.parametrize("clamp", [TURNING, SWINGING], ids=lambda path: path.kind)
def test_the_power_of_a_clamp_is_the_rate_of_the_energy_at_rest(clamp):
    model = build(rod(clamp))
    q, index, params, f, *_ = random_places(model, 3), *arrays(model)
    power = bending.force(1.1, q, 0 * q, index, params, f)
    rate = (bending.energy(1.1 + 1e-5, q, index, params) - bending.energy(1.1 - 1e-5, q, index, params)) / 2e-5
    assert abs(power) > 0.1 and power == pytest.approx(-rate, rel=1e-6)


def test_a_rod_is_turned_as_one_piece():
    """By 90 degrees in 9 s, at full speed in the middle: J w^2/2 with J = mu L^3/3, which the clamp has given.

    The first frequency is 11 rad/s: what the ramps of 4 s leave of vibrations is below a thousandth of the turn.
    """
    turn = paths.circle((1.0, 0, 0), (0, 0, 0), (0, -1.0, 0), 20.0, 0.25, ramp=4.0)
    run = simulate(rod(turn), 9.0, start="straight", method="edmc", dt=0.01)
    middle = int(np.argmin(abs(run.t - 4.5)))
    w, angle = 2.0 * math.pi / 20.0, math.pi / 4.0
    assert run.position("b")[middle] == pytest.approx([math.cos(angle), 0, math.sin(angle)], abs=2e-3)
    assert run.position("b")[-1] == pytest.approx([0, 0, 1], abs=2e-3)
    kinetic = 0.5 * 0.1 / 3.0 * w**2
    assert run.energy[middle, 0] == pytest.approx(kinetic, rel=0.03)  # (1 + 1/(2 n^2)) of nodes on a line; it vibrates a little
    assert run.energy[middle, 5] == pytest.approx(-kinetic, rel=0.05)  # with what bends it
    assert run.energy_balance.imbalance < 1e-6


def test_a_clamp_that_turns_is_in_scene_files(tmp_path):
    scene = rod(TURNING)
    save_scene(scene, tmp_path / "rod.toml")
    assert load_scene(tmp_path / "rod.toml") == scene


@pytest.mark.parametrize(
    "path, message",
    [
        (paths.external((1, 0, 0)), r'a path that is known before a run, but effect Bending at point "a" has external\('),
        (
            paths.line((-1, 0, 0), (1, 0, 0), 0.0),
            r'must never be zero, but .* at point "a" has \(0.0, 0.0, 0.0\) at t=1 s',
        ),
    ],
)
def test_directions_that_cannot_be_are_refused(path, message):
    with pytest.raises(SceneError, match=message):
        rod(path)
