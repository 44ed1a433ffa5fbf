"""The study of what a step costs: every thing that costs is timed at every size, and the carried net is right at its pace."""

import numpy as np
import pytest

from studies.questions import speed


@pytest.fixture
def rows(monkeypatch):
    monkeypatch.setattr(speed, "T_END", 0.4)
    monkeypatch.setattr(speed, "REFERENCE", 2e-3)
    monkeypatch.setattr(speed, "SEGMENTS", (5, 10, 20))
    return speed.compute(quick=True)


@pytest.mark.slow
def test_costs_and_paces(rows):
    costs = rows["costs"].pivot(index="nodes", columns="what", values="cost_a_node_ns")
    assert costs.index.tolist() == [21, 41, 81] and np.isfinite(costs.to_numpy()).all() and (costs.to_numpy() > 0.0).all()
    assert {speed.ITERATION, speed.ACCOUNT, "equilibrium", "verlet, a step", "edmc, a step"} <= set(costs.columns)
    turns = rows["turns"].groupby("nodes").size()
    assert (turns == speed.QUICK_REPEATS).all() and set(turns.index) == set(costs.index)
    assert set(rows["paces"]["EA_N"]) == set(speed.STIFFNESSES[::2])
    paces = rows["paces"][rows["paces"]["EA_N"] == 1e4].set_index("step_s")
    assert (paces.status == "done").all() and (paces.imbalance < 1e-6).all()
    assert paces.p0_error_mm[5e-3] < 0.3 * paces.p0_error_mm[20e-3] < 0.3  # second order, against another method


@pytest.mark.slow
def test_figure_and_answer(rows):
    assert set(speed.plot(rows)) == {"speed"}
    first, *_ = speed.answer(rows).split("\n\n")
    assert "faster than real time" in first or "none of the steps tried" in first
