"""Runs in files, also in one that version 0.1 wrote."""

from pathlib import Path

import numpy as np
import pytest

from anet_lumped import load_run
from anet_lumped.results.energy_balance import UNDIVIDED

OLD = Path(__file__).parents[1] / "files" / "run_of_version_0_1.nc"
"""0.2 s of a payload of 50 g on a cable of three segments; at 0.1 s one of 20 g takes its place. Written by version 0.1.0."""


@pytest.fixture(scope="module")
def old():
    return load_run(OLD)


def test_the_motion_of_an_old_run_is_loaded(old):
    assert (old.status, old.method, old.dt, old.work.steps, old.warnings) == ("done", "edmc", 0.01, 20, ())
    np.testing.assert_allclose(old.t, [0.0, 0.05, 0.1, 0.15, 0.2], rtol=1e-15)
    # as 0.1.0 printed them
    np.testing.assert_allclose(old.position("b")[-1], [0.8, 0.1, -0.48981289], atol=5e-9)
    np.testing.assert_allclose(old.tension("a-b")[-1], [5.03043741, 2.26277339, 0.0], atol=5e-9)


def test_the_scene_audit_and_events_of_an_old_run_are_loaded(old):
    assert old.scene.cable("a-b").segments == 3
    assert [type(effect).__name__ for effect in old.scene.effects] == ["Gravity", "ViscousDamping"]
    (event,), (change,) = old.events, old.scene.events
    assert (event.t, event.where, event.mass) == (change.t, change.point, change.mass) == (0.1, "b", 0.02)
    assert old.audit.passed and old.audit.where == 'node 2 of 3 of cable "a-b"'
    assert old.audit.error == pytest.approx(0.00434275343859964, rel=1e-15) and old.error_estimate is None


def test_an_old_run_does_not_say_who_dissipated_and_holds_no_extrapolation(old):
    balance = old.energy_balance
    assert old.energy.shape == (5, len(UNDIVIDED)) and not old.extrapolated
    assert (balance.by_dampers, balance.by_effects, balance.by_method) == (None, None, None)
    found = balance.kinetic, balance.elastic, balance.potential, balance.work, balance.dissipated
    told = 0.13399206559831264, 0.005182001843279131, -0.19242839151791347, -0.013734308255429978, 0.039520015820890486
    assert found == pytest.approx(told, rel=1e-15)  # by 0.1.0, of the same numbers
    assert balance.imbalance < 1e-13  # roundings of 20 steps


def test_an_old_run_is_saved_as_it_is(old, tmp_path):
    old.save(tmp_path / "again.nc")
    again = load_run(tmp_path / "again.nc")
    for name in ("t", "q", "v", "energy", "segment_tension"):
        np.testing.assert_array_equal(getattr(again, name), getattr(old, name))
    assert again.energy_balance == old.energy_balance and again.events == old.events and again.audit == old.audit
