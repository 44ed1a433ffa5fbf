"""Runs that fail, that a user stops, and arguments that are refused."""

import math
import os
import re
import signal
import threading
import time
import warnings
from dataclasses import replace

import numpy as np
import pytest
from small_net import state
from systems import four_cables, loose_cable, spring_mass

from anet_lumped import (
    Cable,
    Fixed,
    RunError,
    RunInterrupt,
    Scene,
    SceneError,
    equilibrium,
    simulate,
)
from anet_lumped.effects import Gravity
from anet_lumped.motion.simulate import StabilityWarning
from integrators import schemes
from integrators.marching import interruptible, march
from integrators.schemes import record
from integrators.schemes.record import Origin


@pytest.mark.parametrize("method", ["symplectic_euler", "verlet", "rk4", "dop853"])
def test_divergence(method):
    """Beyond the limit: a warning before with both numbers, a status and where and when after, the good part kept."""
    net = four_cables(1e6, segments=10)
    with pytest.warns(StabilityWarning, match=rf'Step dt=0.001 s is beyond the largest stable step of "{method}"') as told:
        run = simulate(net, 1.0, method=method, dt=1e-3)
    warning = str(told[0].message)
    limit = float(re.search(r'", ([\d.e-]+) s, set by cable', warning).group(1))
    omega = float(re.search(r"top frequency ([\d.e+]+) rad/s", warning).group(1))
    assert limit < 1e-3 and 1.5 < limit * omega < (6.5 if method == "dop853" else 3.0)
    assert run.warnings == (warning,)
    assert run.status == "diverged" and not run.ok
    pattern = (
        rf"{method} with dt=0.001 s, whose predicted limit is {limit:.3g} s, diverged at t=([\d.e-]+) s at "
        r'(node \d+ of 10 of cable "s\d-p0"|point "p0"); try a smaller step or method="edmc".'
    )
    found = re.fullmatch(pattern, run.message)
    assert found, run.message
    assert run.t[-1] <= float(found.group(1)) < 1.0
    assert np.isfinite(run.q).all() and np.abs(run.q).max() < 1e7
    with pytest.raises(RunError, match=re.escape(run.message)) as raised, pytest.warns(StabilityWarning):
        simulate(net, 1.0, method=method, dt=1e-3, check=True)
    assert raised.value.run.status == "diverged"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert simulate(net, 0.1, method=method, dt=0.9 * limit).ok


def test_an_unstable_method_says_so():
    with pytest.warns(StabilityWarning, match='"explicit_euler".*stable.*dt=0.0001'):
        simulate(four_cables(1e3, zeta=0.0, segments=4), 1e-3, method="explicit_euler", dt=1e-4)


@pytest.mark.parametrize(("method", "law", "advice"), [
    ("edmc", "none", "a smaller step"),
    ("midpoint", "none", 'a smaller step or method="edmc"'),
    ("edmc", "damped", 'a smaller step or compression="none"'),
])  # fmt: skip
def test_unconverged(method, law, advice, monkeypatch):
    """Newton is not allowed a single iteration: the step is halved to the end, and the run says why it stopped."""
    monkeypatch.setattr(record, "NEWTON_ITERATIONS", 0)
    run = simulate(loose_cable(compression=law), 0.1, method=method, dt=0.01, start="straight")
    assert run.status == "unconverged" and run.work.halvings == 13 and run.work.steps == 0
    assert run.message == (f"{method} with dt=0.01 s did not converge at t=0 s even with the step cut to 2.4e-06 s; try {advice}.")


def test_a_run_that_does_not_converge_can_be_an_error(monkeypatch):
    monkeypatch.setattr(record, "NEWTON_ITERATIONS", 0)
    with pytest.raises(RunError, match="did not converge") as raised:
        simulate(loose_cable(), 0.1, method="edmc", dt=0.01, start="straight", check=True)
    assert raised.value.run.t[-1] == 0.0
    assert simulate(loose_cable(), 0.1, rtol=1e-4, start="straight").status == "unconverged"


@pytest.mark.parametrize("method", ["edmc", "backward_euler", "midpoint", "sdirk2"])
@pytest.mark.parametrize("dt", [1e-3, 1e-4])
def test_small_steps_converge(method, dt):
    """A kilogram on a soft spring, without weight: where the force passes through zero only rounding is left to allow."""
    motion = spring_mass(g=0.0)
    assert simulate(motion.scene, 3.0, method=method, dt=dt, start=motion.start).ok


def test_a_state_that_is_not_finite():
    scene = loose_cable()
    q = equilibrium(scene).q.copy()
    q[3, 1] = math.nan
    for method in ("verlet", "edmc"):
        with pytest.raises(ValueError, match=r"A start must be finite, but the position of node 4 of 20 of cable .* is \(0, nan"):
            simulate(scene, 0.01, method=method, dt=1e-4, start=state(scene, q))


LOOSE = loose_cable()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (dict(t_end=0.0), r"`t_end` must be positive and finite \[s\], but it is 0.0"),
        (dict(t_end=math.inf), "`t_end` must be positive and finite .* but it is inf"),
        (dict(t_end="1"), "`t_end` must be positive and finite .* but it is '1'"),
        (dict(t_end=1e-300), "`t_end` must be 1e-100 s or more, but it is 1e-300"),
        (dict(check="no"), "`check` must be True or False, but it is 'no'"),
        (dict(extrapolate=[1.0]), r"`extrapolate` must be True or False, but it is \[1.0\]"),
        (dict(dt=-1e-3), r"`dt` must be positive and finite \[s\], but it is -0.001"),
        (dict(dt=math.nan), "`dt` must be positive"),
        (dict(dt=0.2), r"Argument `dt` must not exceed t_end=0.1 s, but it is 0.2 s\."),
        (dict(save_every=0.2), r"Argument `save_every` must not exceed t_end=0.1 s, but it is 0.2 s\."),
        (dict(tension_error=2), "Argument `tension_error` must not exceed 1, all of the largest tension, but it is 2; 0.02 is 2 %"),
        (dict(save_every=0.0), r"`save_every` must be positive and finite \[s\]"),
        (dict(rtol=5), "Argument `rtol` must not exceed 1, all of the largest coordinate, but it is 5"),
        (dict(rtol=-1.0), "`rtol` must be positive and finite, but it is -1.0"),
        (dict(atol=0.0), r"`atol` must be positive and finite \[m\], but it is 0.0"),
        (dict(method="verlett"), "must be one of .*, but it is 'verlett', did you mean \"verlet\""),
        (dict(method="gear"), "`method` must be one of explicit_euler, .* Kvaerno5, but it is 'gear'"),
        (dict(method=3), "must be one of .* but it is 3"),
        (dict(method="verlet", rho_inf=0.5), "`rho_inf` belongs to edmc and generalised_alpha, but the method is verlet"),
        (dict(method="edmc", rho_inf=1.5), "`rho_inf` must lie between 0 and 1, but it is 1.5"),
        (dict(method="edmc", dt=0.01, save_every=0.015), "multiple of the step, but save_every=0.015 s and dt=0.01 s"),
        (dict(start="rest"), '`start` must be "equilibrium", "calm", "straight" or a State, but it is \'rest\''),
        (dict(start=None), "`start` must be .* but it is None"),
        (
            dict(start=equilibrium(loose_cable(segments=7))),
            r'the scene\'s cables, but of cable "a-b" with 20 segments it has 7',
        ),
        (dict(start=equilibrium(four_cables(segments=2))), 'of cable "a-b" with 20 segments it has none'),
    ],
)
def test_bad_arguments(arguments, message):
    with pytest.raises(ValueError, match=message):
        simulate(LOOSE, **({"t_end": 0.1} | arguments))


def test_a_straight_start_that_stretches_its_cable_says_so():
    """Its ends are 1.5 m apart, and then as far as it is long."""
    far = replace(LOOSE, points=[replace(point, at=(1.5 * point.at[0], 0, 0)) for point in LOOSE.points])
    said = r'start="straight" stretches cable "a-b" of 1 m by 50%: its ends are 1.5 m apart, and the run begins with the energy'
    with pytest.warns(UserWarning, match=said):
        run = simulate(far, 0.01, start="straight")
    assert "stretches cable" in run.warnings[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert not any("stretches" in text for text in simulate(LOOSE, 0.01, start="straight").warnings)
        simulate(far, 0.01, start=run.state(0))  # a state is meant as it is


def test_a_long_march_tells_where_it_is(monkeypatch, caplog):
    """Every hundredth of a second here, of some 3e5 steps that take more than that."""
    monkeypatch.setattr(interruptible, "TOLD_EVERY", 0.01)
    caplog.set_level("INFO", logger="integrators")
    run = simulate(LOOSE, 3.0, method="verlet", dt=1e-5, start="straight")
    told = [
        re.fullmatch(r"step (\d+) of 300000, \d+ s left if the others take as long", record.message) for record in caplog.records
    ]
    assert run.ok and told and all(told)
    steps = [int(found[1]) for found in told]
    assert steps == sorted(steps)


def test_a_long_march_whose_steps_were_cut_tells_no_time_below_zero(monkeypatch, caplog):
    """Cut steps count: a march that was meant to take 840 steps told at the 1258th that -12 s were left."""
    real = march.interruptible

    def later(loop, stepper, *given, tell, **options):
        stepper.counts[march.STEPS] = 500
        tell()
        stepper.counts[march.STEPS] = 0
        return real(loop, stepper, *given, tell=tell, **options)

    monkeypatch.setattr(march, "interruptible", later)
    caplog.set_level("INFO", logger="integrators")
    assert simulate(LOOSE, 0.1, method="edmc", dt=1e-3, start="straight").ok
    (told,) = (record.message for record in caplog.records)
    assert told == "step 500, where 100 were meant: steps that do not converge are cut"


def test_divergence_is_judged_by_the_size_of_a_scene():
    """Its rest sags by 1.3e7 m, because its weight stretches it to 25 times its length."""
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (8e5, 0, 0))]
    long = Scene(points, [Cable("a", "b", length=1e6, mass_per_length=0.1, EA=1e4, segments=20)], [Gravity(9.81)])
    assert simulate(long, 1.0).status == "done"


def test_straight_needs_places():
    with pytest.raises(SceneError, match='needs the place of every point, but free point "p0" has no `at`'):
        simulate(four_cables(), 0.1, start="straight")


def test_every_method_has_a_limit_and_runs():
    """No name silently runs another scheme; diffrax's, for which JAX compiles, run in `test_diffrax_methods`."""
    for method in schemes.names():
        if method in schemes.names(origin=Origin.DIFFRAX):
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StabilityWarning)
            run = simulate(loose_cable(1e2, segments=3), 0.01, method=method, start="straight")
        assert run.ok and run.method == method and run.reason.startswith(f"{method}: asked for")


@pytest.mark.parametrize("options", [dict(method="edmc", dt=1e-3, save_every=0.02), dict(rtol=1e-8), dict(method="dop853")])
def test_interrupt(options, ctrl_c):
    """Ctrl-C ends a compiled march at once and hands over what was done."""
    simulate(loose_cable(), 0.1, start="straight", **options)  # compiled before the clock runs
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    began = time.perf_counter()
    with pytest.raises(RunInterrupt, match="was stopped by the user at t=") as stopped:
        simulate(loose_cable(), 1e3, start="straight", **options)
    run = stopped.value.run
    assert run.status == "interrupted" and not run.ok and 0.4 < time.perf_counter() - began < 5.0
    assert len(run.t) > 1 or "rtol" in options
    assert np.isfinite(run.q).all()
