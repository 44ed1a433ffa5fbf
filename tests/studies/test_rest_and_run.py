"""Rows of a sweep that share arrays rest and run as `equilibrium` and `simulate` have it, to the last bit."""

import numpy as np
import pytest
from hanging import held_net

from anet_lumped import PayloadChange, Scene, equilibrium, simulate, wind
from anet_lumped.effects import Air, Gravity
from studies.sweeping.rest_and_run import rest_and_run
from studies.sweeping.vary import apply

NET = held_net(segments=4, diameter=0.01)
BLOWN = Scene(NET.points, NET.cables, [Gravity(), Air(wind=wind.Uniform((1.0, 0.0, 0.0)))])
PICKS_UP = Scene(NET.points, NET.cables, NET.effects, [PayloadChange("p0", 0.05, 0.2)])
SETTINGS = [
    {"method": "edmc", "dt": 0.01},
    {"dt": 1e-4},
    {"method": "edmc", "rtol": 1e-3},
    {"method": "edmc", "dt": 0.02, "rho_inf": 0.5},
]


@pytest.mark.each_once
@pytest.mark.parametrize("scene", [NET, BLOWN, PICKS_UP], ids=["net", "blown", "picks up"])
@pytest.mark.parametrize("settings", SETTINGS)
def test_rows_are_what_they_are_alone(scene, settings):
    settings = {"t_end": 0.1} | settings
    for EA in (1e3, 2e4, 1e3):
        row, varied = apply(scene, {"EA": EA, "dt": settings.get("dt", 0.01)})
        rest, run = rest_and_run(row, settings, rests=True)
        alone = equilibrium(row)
        assert varied and np.array_equal(rest.q, alone.q) and np.array_equal(rest.segment_tension, alone.segment_tension)
        whole = simulate(row, start=alone, **settings)
        for name in ("t", "q", "v", "energy", "segment_tension", "error_growth"):
            ours, theirs = (np.asarray(getattr(one, name), float) for one in (run, whole))  # None, not known, is NaN
            assert np.array_equal(ours, theirs, equal_nan=True), name
        assert (run.status, run.method, run.work, run.events) == (whole.status, whole.method, whole.work, whole.events)


def test_a_row_that_only_rests_has_no_run():
    rest, run = rest_and_run(NET, None, rests=True)
    assert run is None and np.array_equal(rest.q, equilibrium(NET).q)
    assert rest_and_run(NET, {"t_end": 0.1, "dt": 0.01}, rests=False)[0] is None
