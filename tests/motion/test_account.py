"""The account of energy where a cable has no inner nodes, is reeled, is hoisted or breaks: it closes, and its parts are right."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, Scene, simulate
from anet_lumped.effects import Gravity, LineChange
from anet_lumped.prescribed import paths, signals
from anet_lumped.results.energy_balance import BY_METHOD, COLUMNS, book_remainder
from anet_lumped.results.events import BREAK
from integrators import schemes
from integrators.schemes.record import EnergyPromise

G, MASS, EA, LENGTH, RATE, RAMP, T_END = 9.81, 1.0, 1e4, 2.0, 0.4, 0.5, 1.0
RISE = RATE * (T_END - 0.5 * RAMP)
STABLE = schemes.names(own=True, stable_undamped=True)
MADE = [(method, EA) for method in STABLE] + [("edmc", math.inf)]


def lifted(way, method, EA, segments):
    """A run of a payload on a light cable that is reeled in, whose support rises, or rises until it breaks at 1.5 weights."""
    top, effects, more = Fixed("a", (0, 0, 0)), [Gravity(G)], {}
    if way == "reel":
        effects.append(LineChange({"a-b": signals.line(0.0, -RATE, RAMP)}))
    else:
        rate = RATE if way == "hoist" else 10.0 * RATE
        top = Driven("a", paths.line((0, 0, 0), (0, 0, rate), ramp=RAMP))
        more = {} if way == "hoist" else {"breaking_tension": 1.5 * MASS * G}
    zeta = 0.0 if math.isinf(EA) else 0.3
    cable = Cable("a", "b", length=LENGTH, mass_per_length=1e-3, EA=EA, zeta=zeta, segments=segments, **more)
    dt = {} if schemes.scheme(method).explicit else {"dt": 0.01}
    return simulate(Scene([top, Free("b", mass=MASS)], [cable], effects), T_END, method=method, **dt)


@pytest.mark.each_once
@pytest.mark.parametrize("segments", [1, 2, 10])
@pytest.mark.parametrize(("method", "EA"), MADE)
@pytest.mark.parametrize("way", ["reel", "hoist", "break"])
def test_it_closes_and_its_parts_are_right(way, method, EA, segments):
    """What is put in is the payload's rise and its kinetic energy; nothing is taken but by the method."""
    run = lifted(way, method, EA, segments)
    assert run.reached_end, run.message
    balance, scheme = run.energy_balance, schemes.scheme(method)
    assert balance.imbalance < 1e-9  # Newton's tolerance of 1e-6 of the force is met by far
    if way == "break":
        assert all(event.kind == BREAK for event in run.events)
        assert balance.by_effects == pytest.approx(sum(event.lost for event in run.events), abs=1e-12)
        first = run.events[0]
        within = 0.15 if math.isinf(EA) or scheme.observes_mean_over_stages else 1e-7  # a mean over a step of 10 ms
        assert first.segment == 0 and first.tension == pytest.approx(1.5 * MASS * G, rel=within)
        if scheme.energy is EnergyPromise.NEVER_RISES:
            # the payload falls from the break on, without what was stored; a rigid cable was once flung away by a step of 1e-12 s
            assert run.ok and abs(balance.by_method) < 2e-2 * balance.in_play
        return
    held = 0.0 if math.isinf(EA) else MASS * G / EA  # strain: material that comes in is stretched
    bounce = 0.0 if math.isinf(EA) else 3e-3  # what is left of the axial bounce, in part of the work
    exact = MASS * G * RISE * (1.0 - 0.5 * held * (way == "reel")) + 0.5 * MASS * RATE**2
    off = 0.5 * MASS * G * RATE * run.dt if scheme.damps_the_motion else 1e-4 * balance.work  # of the step of 10 ms, and its square
    assert balance.work == pytest.approx(exact, abs=off + bounce + 2e-3 * balance.work)  # the cable's own mass is 2e-3
    # the tension of backward Euler lags by a step h: M h int a^2 dt = 10/7 M h v^2/ramp of a quintic ramp; damper and cable besides
    by_method = MASS * run.dt * RATE**2 * 10 / 7 / RAMP if scheme.damps_the_motion else 0.0
    assert balance.by_method == pytest.approx(by_method, rel=0.15, abs=(5e-4 if scheme.explicit else 5e-5) * balance.work)


@pytest.mark.each_once
@pytest.mark.parametrize("rate", [-1.0, -0.5, 0.5])
@pytest.mark.parametrize("segments", [1, 2, 5])
def test_a_winch_of_a_cable_that_does_not_stretch(segments, rate):
    """There is no damper: int T v dt is M v^2/2 + M g h of the payload, to 1e-6; once M v^2/2 more was put in and taken again."""
    M, L, mu, t_end = 50.0, 6.0, 1e-4, 3.0
    cable = Cable("hook", "load", length=L, mass_per_length=mu, EA=math.inf, segments=segments)
    scene = Scene(
        [Fixed("hook", (0, 0, 0)), Free("load", mass=M, at=(0, 0, -L))],
        [cable],
        [Gravity(G), LineChange({"hook-load": signals.line(0.0, rate, 1.0)})],
    )
    run = simulate(scene, t_end, start="equilibrium", dt=1e-3)
    rise = -rate * (t_end - 0.5)
    lengths = L, L - rise
    own = [mu * length**2 * G / 2 for length in lengths]  # of the cable: its weight times its depth
    kinetic = 0.5 * (M + 0.5 * mu * lengths[1] / segments) * rate**2
    balance = run.energy_balance
    assert balance.imbalance < 1e-9 and run.warnings == ()
    assert balance.work == pytest.approx(M * G * rise + own[0] - own[1] + kinetic, rel=1e-6)
    assert abs(balance.dissipated) < 1e-7 * abs(balance.work)


def test_the_work_of_a_stage_is_that_of_its_force():
    """Once the tension at the end of a step counted, which rings where a midpoint step does not resolve the stretching."""
    exact = lifted("hoist", "edmc", math.inf, 10).energy_balance.work
    for method in ("midpoint", "sdirk2", "tr_bdf2"):
        assert lifted("hoist", method, EA, 10).energy_balance.work == pytest.approx(exact, rel=1e-3), method


def test_the_remainder_goes_to_the_method():
    rows = np.zeros((3, len(COLUMNS)))
    rows[:, :6] = [[0, 0, 5, 0, 0, 0], [2, 1, 3, 2, 0.5, 0.1], [2, 1, 3, 2, 0.5, 0.1]]
    rows[0, 2], rows[2, 0] = 5.0, 1.5
    book_remainder(rows)
    np.testing.assert_allclose(rows[:, BY_METHOD], [0.0, 0.4, 0.9], atol=1e-15)
