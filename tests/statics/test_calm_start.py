"""Rests in turbulence and waves: sought from the calm, and a start where there is none."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import EquilibriumError, Session, equilibrium, load_scene, simulate
from anet_lumped.effects import Air
from anet_lumped.statics.equilibrium import calm

TETHER = load_scene("tether")


def in_gusts(seed):
    shear, gusts = next(effect.wind for effect in TETHER.effects if isinstance(effect, Air))
    effects = [Air(wind=(shear, replace(gusts, seed=seed))) if isinstance(effect, Air) else effect for effect in TETHER.effects]
    return replace(TETHER, effects=effects)


def test_a_rest_in_turbulence_is_found_from_the_calm():
    gusty = in_gusts(2)
    rest, still = equilibrium(gusty), equilibrium(calm(gusty))
    assert rest.stable and rest.residual < 1e-9
    assert np.linalg.norm(rest.position("balloon") - still.position("balloon")) > 0.1  # m: turbulence moves it


def test_where_turbulence_leaves_no_rest_a_start_is_named_and_works():
    gusty = in_gusts(46)
    with pytest.raises(EquilibriumError, match=r'turbulence or waves may leave no rest at a time; begin with start="calm"'):
        equilibrium(gusty)
    run = simulate(gusty, 1.0, start="calm")
    still = equilibrium(calm(gusty))
    assert run.ok
    np.testing.assert_array_equal(run.position("balloon")[0], still.position("balloon"))
    assert np.linalg.norm(run.position("balloon")[-1] - still.position("balloon")) > 1e-3  # m: the turbulence acts in the run
    with Session(gusty, dt=0.05, start="calm") as session:
        np.testing.assert_array_equal(session.position("balloon"), still.position("balloon"))
