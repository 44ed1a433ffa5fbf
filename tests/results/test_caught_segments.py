"""Slack segments that are caught, beside the closed form of an impact on a spring and a damper."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, State, simulate
from anet_lumped.effects import Gravity
from anet_lumped.results.caught_segments import caught_tension, impact

G, L, EA, M = 9.81, 1.0, 1e6, 1.0


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.3, 0.49, 0.51, 2.0])
def test_a_mass_that_runs_into_a_spring_and_a_damper(zeta):
    """x'' + 2 zeta x' + x = 0 with x(0) = 0, x'(0) = 1, by small steps of Heun's method: the largest x + 2 zeta x'."""
    h, x, v, largest = 1e-3, 0.0, 1.0, 2.0 * zeta
    for _ in range(4000):
        a = -x - 2.0 * zeta * v
        x_next, v_next = x + h * v, v + h * a
        x, v = x + 0.5 * h * (v + v_next), v + 0.5 * h * (a - x_next - 2.0 * zeta * v_next)
        largest = max(largest, x + 2.0 * zeta * v)
    assert impact(zeta) == pytest.approx(largest, abs=1e-5)  # h^2


def thrown(compression="none", segments=1, at=0.5, speed=2.0):
    """A weight that flies down from above the end of its cable, without gravity."""
    cable = Cable("a", "b", length=L, mass_per_length=1e-6, EA=EA, segments=segments, compression=compression)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=M, at=(0.0, 0.0, -at))], [cable], [])
    shape, v = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, -at), segments + 1), np.zeros((segments + 1, 3))
    v[-1, 2] = -speed
    return scene, State.of(scene, shapes={"a-b": shape}, velocities={"a-b": v})


@pytest.mark.parametrize("dt", [1e-2, 3e-2])
def test_a_weight_that_is_caught_between_two_saved_states(dt):
    """T = u sqrt(k M): steps of omega dt = 10 and 30 show less than a third of it."""
    scene, start = thrown()
    run = simulate(scene, 0.5, method="edmc", dt=dt, save_every=dt, start=start)
    wave = 2.0 * math.sqrt(EA / L * M)
    assert run.segment_tension.max() < wave / 3.0
    assert caught_tension(run) == pytest.approx(wave, rel=0.05)  # 1/(1 + s^2) of it is resolved
    assert run.segment_tension.max() / (1.0 - run.tension_error) == pytest.approx(wave, rel=0.05)


def test_what_is_resolved_or_never_caught_is_not_counted():
    scene, start = thrown()
    fine = simulate(scene, 0.5, method="edmc", dt=5e-5, save_every=5e-5, start=start)
    assert fine.segment_tension.max() == pytest.approx(2.0 * math.sqrt(EA / L * M), rel=1e-3)
    assert caught_tension(fine) < 0.01 * fine.segment_tension.max()
    away = simulate(scene, 0.2, method="edmc", dt=1e-2, save_every=1e-2, start=start)
    assert not away.segment_tension.any() and caught_tension(away) == 0.0
    pushes, start = thrown("linear", at=0.99)
    assert caught_tension(simulate(pushes, 0.1, method="edmc", dt=1e-3, save_every=1e-3, start=start)) == 0.0


def test_what_hangs_taut_is_not_caught():
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", mass=M)], thrown()[0].cables, [Gravity(G)])
    assert caught_tension(simulate(scene, 0.1, method="edmc", dt=1e-3)) == 0.0
