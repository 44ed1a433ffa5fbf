"""Audits of flights: the flight again with shorter steps, under controllers that are asked as often."""

import numpy as np
import pytest

from anet_lumped import InputError, RunInterrupt, load_run, load_scene
from anet_lumped.flight.fly import fly
from anet_lumped.flight.geometric import geometric
from anet_lumped.flight.quadrotor import THESIS_QUADROTOR
from anet_lumped.flight.scenarios import SCENARIOS, controller_for
from anet_lumped.flight.seen import Sensors

CREW = [THESIS_QUADROTOR] * 4


def flown(name, t_end, **options):
    """A bundled flight, up to a time."""
    scene = load_scene(name)
    return fly(scene, controller_for(scene, SCENARIOS[name]), t_end, save_every=0.1, **options)


@pytest.mark.parametrize("dt", [0.02, 0.004])
def test_an_audit_tells_the_error(monkeypatch, dt):
    """Against steps of a sixteenth, in which the controller is asked as often; the flight itself is the same, bit for bit."""
    run, plain = flown("quadrotors_net", 3.0, dt=dt, audit=True), flown("quadrotors_net", 3.0, dt=dt)
    assert run.ok and run.audit.passed and np.array_equal(run.q, plain.q) and plain.audit is None
    from anet_lumped.flight import fly as module

    found = []
    monkeypatch.setattr(module, "audited", lambda run, finer, order, allowed: found.append(finer(16)) or run)
    flown("quadrotors_net", 3.0, dt=dt, audit=True)
    true = np.linalg.norm(run.q - found[0].q, axis=2).max()
    assert true < run.audit.error < 2.0 * true and true > 1e-4


class Counted:
    """A controller in Python that counts how often it is asked, and may stop the flight at one of its calls."""

    def __init__(self, controller, stop_at=None):
        self.controller, self.calls, self.stop_at = controller, 0, stop_at

    def reset(self):
        self.controller.reset()

    def __call__(self, seen):
        self.calls += 1
        if self.calls == self.stop_at:
            raise KeyboardInterrupt
        return self.controller(seen)


@pytest.mark.parametrize("sensors", [None, Sensors()])
def test_a_controller_in_python_is_asked_as_often(sensors):
    scene = load_scene("quadrotors_net")
    controller = Counted(controller_for(scene, SCENARIOS["quadrotors_net"]))
    run = fly(scene, controller, 0.4, dt=0.01, sensors=sensors, audit=True)
    assert run.ok and run.audit is not None and controller.calls == 80
    compiled = fly(scene, controller_for(scene, SCENARIOS["quadrotors_net"]), 0.4, dt=0.01, audit=True)
    assert compiled.audit.error == pytest.approx(run.audit.error, rel=1e-6)


def test_a_flight_that_no_step_makes_sure_fails():
    """A weak cable tears, and what is left whips: another step, another flight."""
    run = flown("quadrotors_break", 4.0, dt=0.02, audit=True)
    assert run.status == "audit failed" and run.audit.error > 1.0 and "where" in run.message


def test_ctrl_c_in_an_audit_keeps_the_flight(tmp_path):
    scene = load_scene("quadrotors_net")
    controller = Counted(controller_for(scene, SCENARIOS["quadrotors_net"]), stop_at=50)
    with pytest.raises(RunInterrupt, match="its audit was stopped by the user") as stopped:
        fly(scene, controller, 0.4, dt=0.01, audit=True)
    run = stopped.value.run
    assert run.status == "interrupted" and run.t[-1] == pytest.approx(0.4) and run.audit is None
    run.save(tmp_path / "run.nc")
    assert load_run(tmp_path / "run.nc").message == run.message


@pytest.mark.parametrize("audit", [-1.0, 0.0, np.nan, "yes", None])
def test_what_is_no_error_is_refused(audit):
    scene = load_scene("quadrotors_net")
    with pytest.raises(InputError, match="audit"):
        fly(scene, geometric(CREW, lambda seen: None), 0.1, audit=audit)
