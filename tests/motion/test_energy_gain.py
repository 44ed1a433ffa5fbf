"""Energy out of nothing: which runs must say that they gained some, and which must not."""

from dataclasses import replace

import numpy as np
import pytest
from systems import four_cables, loose_cable, spring_mass

from anet_lumped import RunError, Scene, load_run, simulate
from anet_lumped.effects import node_force
from anet_lumped.model.build import build
from anet_lumped.motion.choice import SHARE_OF_LIMIT_SLACK, choose
from anet_lumped.motion.energy_gain import ALLOWED_GAIN, GAINED, energy_gain
from anet_lumped.motion.failure_messages import why_it_stopped
from anet_lumped.motion.run_warnings import warnings_of
from integrators.system import DIVERGED, UNCONVERGED
from studies.catalogue.cases import CASES


@pytest.fixture
def in_flight():
    """A slack cable that nothing holds, undamped."""
    case = CASES["cable in free flight"]()
    return case.scene, case.t_end, case.start_state()


@pytest.mark.parametrize("method", ["verlet", "symplectic_euler"])
def test_a_symplectic_step_that_pumps_says_so(method, in_flight, tmp_path):
    """At half of the limit it gains half of the energy in play; at the step that is chosen for it it does not."""
    scene, t_end, start = in_flight
    limit = choose(scene, method).limit
    run = simulate(scene, t_end, method=method, dt=0.5 * limit, start=start)
    assert run.status == GAINED and not run.ok and run.reached_end and run.t[-1] == t_end
    small = f"{SHARE_OF_LIMIT_SLACK * limit:.3g} s"
    assert f"its energy rose by {energy_gain(run):.2g} of the energy in play that nothing put in" in run.message
    assert f"at most an eighth of the predicted limit, {small}, a damping ratio of 0.01 or more, or" in run.message
    chosen = simulate(scene, t_end, method=method, start=start)
    assert (
        chosen.ok and chosen.dt == pytest.approx(SHARE_OF_LIMIT_SLACK * limit, rel=1e-2) and energy_gain(chosen) < ALLOWED_GAIN / 2
    )
    run.save(tmp_path / "run.nc")
    back = load_run(tmp_path / "run.nc")
    assert (back.status, back.message, back.ok) == (run.status, run.message, False)
    with pytest.raises(RunError, match="that nothing put in"):
        simulate(scene, t_end, method=method, dt=0.5 * limit, start=start, check=True)


@pytest.mark.filterwarnings("ignore::anet_lumped.motion.simulate.StabilityWarning")
def test_a_step_beyond_the_limit_is_named(in_flight):
    scene, _, start = in_flight
    limit = choose(scene, "verlet").limit
    run = simulate(scene, 4 * limit, method="verlet", dt=2 * limit, start=start)
    assert run.status == GAINED and f"its step is beyond the largest stable one, {limit:.3g} s" in run.message


def test_the_share_of_the_limit_is_enough_where_a_cable_whips():
    """Whip and flight, five times as long as they take: the energy rises by less than a tenth."""
    for scene, t_end, start in (
        (loose_cable(1e4, 0.0), 3.0, "straight"),
        (loose_cable(1e6, 0.0), 1.0, "straight"),
        (loose_cable(1e4, 0.0, compression="damped"), 3.0, "straight"),
    ):
        for method in ("verlet", "symplectic_euler"):
            assert simulate(scene, t_end, method=method, start=start).ok


@pytest.mark.parametrize("method", ["midpoint", "generalised_alpha", "tr_bdf2"])
def test_an_implicit_method_that_pumps_says_so(method, in_flight):
    scene, t_end, start = in_flight
    run = simulate(scene, t_end, method=method, dt=1e-3, start=start)
    assert run.status == GAINED and 'try method="edmc", which never gains any, or a smaller step' in run.message
    assert simulate(scene, t_end, method="edmc", dt=1e-3, start=start).ok
    assert simulate(scene, t_end, method="backward_euler", dt=1e-3, start=start).ok


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("carried", [False, True])
@pytest.mark.parametrize("method", ["verlet", "symplectic_euler", "rk4"])
def test_a_net_that_stays_taut_is_left_alone(carried, method):
    """Undamped, at half of the limit: neither warned of nor found to have gained anything."""
    net = four_cables(1e3, 0.0, carried=carried)
    net = replace(net, points=[replace(p, mass=0.04) if p.name == "p0" else p for p in net.points])
    dt = 0.5 * choose(net, method).limit
    run = simulate(net, 1.0, method=method, dt=dt, start=simulate(four_cables(1e3, 0.0, carried=carried), dt, dt=dt).final)
    assert run.ok and energy_gain(run) < 1e-2 * ALLOWED_GAIN


def test_an_energy_that_swings_is_no_gain():
    """Symplectic Euler at h omega = 1 keeps x^2 + v^2/omega^2 - h x v: the energy itself swings by more than half, for ever."""
    motion = spring_mass(g=0.0)
    run = simulate(motion.scene, 40.0, method="symplectic_euler", dt=0.2, start=motion.start)
    own = run.energy[:, :3].sum(axis=1)
    assert np.ptp(own) / own.max() > 0.5
    assert run.ok and energy_gain(run) < ALLOWED_GAIN


def test_work_put_in_is_no_gain():
    """A point that starts at 5 m/s at once, and one that stops within 10 ms: what is put in is put in."""
    for name in ("starts at 5 m/s", "support stops midway", "yanked at 1 m/s"):
        case = CASES[name]()
        for method in ("verlet", "symplectic_euler", "rk4", "backward_euler", "sdirk2"):
            dt = min(case.dt or np.inf, choose(case.scene, method).dt)
            run = simulate(case.scene, case.t_end, method=method, dt=dt, start=case.start_state())
            assert run.ok, f"{name}, {method}: {run.message}"


def test_gain_is_the_largest_rise_over_the_energy_in_play():
    """By hand: potential energy falls from 1 J, work of 2 J is put in, and 0.4 J come from nowhere."""
    run = simulate(four_cables(), 0.03, method="edmc", dt=0.01)
    rows = np.array([[0, 0, 1, 0, 0], [0.5, 0, 0.5, 0, 0], [0.5, 0, 0, 0, 0.5], [2.9, 0, 0, 2.0, 0.5]], float)
    pumped = replace(run, energy=rows)
    # 0.5 at the third state, 0.9 at the last; the largest energy in play is 2.9 J
    assert energy_gain(pumped) == pytest.approx(0.4 / 2.9, rel=1e-6)
    assert energy_gain(pumped, adaptive=True) == 0.0  # and 1 J at the first


def test_rest_is_no_gain():
    """Where nothing is in play, neither rounding nor Newton's tolerance is a gain."""
    weightless = Scene(loose_cable().points, loose_cable().cables)
    for method in ("edmc", "verlet", "midpoint", "backward_euler"):
        assert simulate(weightless, 0.05, method=method, dt=1e-4, start="straight").ok
        assert simulate(four_cables(1e6), 0.05, method=method, dt=1e-5).ok


def advice(effects, method, monkeypatch):
    """Message of a run of a scene that is taken to have gained energy."""
    monkeypatch.setattr("anet_lumped.motion.energy_gain.ALLOWED_GAIN", -1.0)
    net = four_cables()
    return simulate(replace(net, effects=(*net.effects, *effects)), 0.02, method=method, dt=0.01).message


def test_no_message_advises_the_method_that_failed(monkeypatch):
    """Each sentence that a run of edmc may end with, and those of the others, which advise it only for what it promises."""

    @node_force
    def gain_push(t, q, v, size):
        return size, 0.0, 0.0

    plain = advice((), "edmc", monkeypatch)
    assert "that nothing put in" in plain and plain.endswith("is allowed; try a smaller step.") and "method=" not in plain
    pushed = advice((gain_push(size=1.0),), "edmc", monkeypatch)
    assert "method=" not in pushed
    assert "try a smaller step, or an energy in place of the force of gain_push, of which nothing says that it is kept" in pushed
    assert 'try method="edmc", which never gains any, or a smaller step' in advice((), "midpoint", monkeypatch)
    assert 'try method="edmc" or a smaller step' in advice((gain_push(size=1.0),), "midpoint", monkeypatch)


@pytest.mark.parametrize("method", ["edmc", "backward_euler"])
@pytest.mark.parametrize("status", [DIVERGED, UNCONVERGED])
def test_nor_does_one_that_did_not_end(method, status):
    model = build(four_cables())
    text = why_it_stopped(model, choose(four_cables(), method, dt=0.01), status, 0.5, 0, None, np.zeros(6, int))
    assert "smaller step" in text and ('method="edmc"' in text) == (method != "edmc")


def test_nor_does_a_warning():
    run = simulate(four_cables(), 0.02, method="edmc", dt=0.01)
    rows = run.energy.copy()
    rows[-1, 4] += 0.5  # [J] taken of next to nothing
    (text,) = warnings_of(replace(run, energy=rows))
    assert text.endswith("take a smaller step than dt=0.01 s.")
