"""The audit of a run: its estimate against the true error, what makes it fail, and where its word goes."""

import warnings

import numpy as np
import pytest
from systems import four_cables, hanging_chain, loose_cable, spring_mass

from anet_lumped import RunError, load_run, simulate
from anet_lumped.motion.simulate import StabilityWarning


@pytest.mark.parametrize(
    ("method", "step"),
    [("edmc", dict(dt=5e-3)), ("verlet", dict(dt=1e-3)), ("backward_euler", dict(dt=1e-3)), ("rk4", dict(dt=4e-3))],
)
def test_estimate_is_the_error(method, step):
    """Swings of a hanging chain, against RK4 at a far smaller step."""
    motion = hanging_chain(rate=1.0, amplitude=1e-3)
    run = simulate(motion.scene, motion.t_end, method=method, start=motion.start, audit=True, save_every=0.04, **step)
    exact = simulate(motion.scene, motion.t_end, method="rk4", dt=1e-4, start=motion.start, save_every=0.04)
    error = np.linalg.norm(run.q - exact.q, axis=2).max()
    assert run.ok and run.audit.passed and run.audit.wall_time > 0
    assert run.audit.error == pytest.approx(error, rel=0.2)


def test_estimate_of_adaptive_steps():
    net = four_cables(1e4, carried=True)
    run = simulate(net, 1.0, rtol=1e-5, save_every=0.1, audit=True)
    exact = simulate(net, 1.0, method="edmc", dt=2.5e-4, save_every=0.1)
    error = np.linalg.norm(run.q - exact.q, axis=2).max()
    assert run.ok and 0.3 * error < run.audit.error < 3.0 * error


@pytest.mark.parametrize("method", ["dop853", "RK45"])
def test_estimate_of_methods_that_choose_their_steps(method):
    """A tenth of the tolerance leaves a tenth of the error or less."""
    motion = spring_mass()
    run = simulate(motion.scene, 5.0, method=method, rtol=1e-5, start=motion.start, save_every=0.1, audit=True)
    error = max(np.abs(q[:1, 0] - motion.exact(t)[0]).max() for t, q in zip(run.t, run.q, strict=True))
    assert run.ok and run.audit.error == pytest.approx(error, rel=0.2)


def test_a_run_that_fails_says_so_everywhere(tmp_path):
    """A millimetre is asked of a step that leaves centimetres."""
    options = dict(method="edmc", dt=0.02, start="straight", audit=1e-3)
    run = simulate(loose_cable(1e4), 0.6, **options)
    assert run.status == "audit failed" and not run.ok and not run.audit.passed
    assert run.message.startswith("The audit failed: ") and "where 0.001 m are allowed" in run.message
    assert "; try a smaller step" in run.message
    assert run.audit.where.startswith(("node ", 'point "b"')) and 0.0 < run.audit.t <= 0.6
    run.save(tmp_path / "run.nc")
    back = load_run(tmp_path / "run.nc")
    assert back.audit == run.audit and back.status == "audit failed" and back.message == run.message
    with pytest.raises(RunError, match="The audit failed"):
        simulate(loose_cable(1e4), 0.6, **options, check=True)


def test_energy_that_is_not_accounted_for():
    """Symplectic Euler near its limit on an undamped cable that whips."""
    scene = loose_cable(1e4, 0.0)
    run = simulate(scene, 3.0, method="symplectic_euler", dt=1.3e-4, start="straight", audit=10.0)
    assert run.status in ("audit failed", "diverged")
    assert "energy in play are not accounted for" in run.message or "diverged" in run.message


def test_an_audit_repeats_no_warning_and_leaves_the_filters_to_other_threads(monkeypatch):
    with pytest.warns(StabilityWarning) as warned:
        monkeypatch.setattr(warnings, "catch_warnings", None)
        run = simulate(loose_cable(), 0.01, method="verlet", dt=2e-3, start="straight", audit=10.0)
        monkeypatch.undo()
    assert run.audit is not None and len(warned) == 1 and warned[0].filename == __file__


def test_no_audit_unless_asked():
    run = simulate(four_cables(), 0.1, method="edmc", dt=0.01)
    assert run.audit is None and run.status == "done"


def test_message():
    with pytest.raises(ValueError, match=r"`audit` must be positive and finite \[m\], but it is -1.0"):
        simulate(four_cables(), 0.1, audit=-1.0)
