"""The loose cable of the studies through its whip at 0.55 s: what its methods converge to, and how."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import simulate
from studies.accuracy_cost.motions import loose

EA = 1e4
WHIP = 0.55  # [s]


def tip(law, method, dt, zeta=0.05, **options):
    """Places (51, 3) of the tip every 0.02 s."""
    scene = loose(EA, law=law).scene
    scene = replace(scene, cables=tuple(replace(cable, zeta=zeta) for cable in scene.cables))
    run = simulate(scene, 1.0, method=method, dt=dt, start="straight", save_every=0.02, **options)
    assert run.ok
    return run.position("tip")


def largest(track, reference, after):
    """Largest distance of two tracks before or after the whip [m]."""
    chosen = (0.02 * np.arange(51) > WHIP) == after
    return np.linalg.norm(track - reference, axis=1)[chosen].max()


@pytest.fixture(scope="module", params=["damped", "linear"])
def motion(request):
    """A law of compression whose force does not jump, and the tip by RK4 at a hundredth of the highest frequency's period."""
    return request.param, tip(request.param, "rk4", 5e-6)


def test_references_agree(motion):
    """RK4 and Verlet, before the whip and after; Verlet's error is of order 2."""
    law, exact = motion
    coarse, fine = (largest(tip(law, "verlet", dt), exact, True) for dt in (2e-5, 1e-5))
    assert fine < 5e-6 and coarse / fine == pytest.approx(4.0, abs=0.6)  # slope 2 +- 0.2
    assert largest(tip(law, "rk4", 1e-5), exact, True) < 1e-7


@pytest.mark.each_once
@pytest.mark.parametrize("after", [False, True])
def test_edmc_that_damps_nothing_is_of_second_order_through_the_whip(motion, after):
    """rho_inf = 1: the damper over a step is that of one time in the limit, slack turning taut included."""
    law, exact = motion
    steps = 2e-4 * 0.5 ** np.arange(4)
    errors = [largest(tip(law, "edmc", dt, rho_inf=1.0), exact, after) for dt in steps]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.15)


def test_edmc_that_damps_comes_to_the_same_once_it_resolves_the_ringing(motion):
    """rho_inf = 0: omega = 12,600 rad/s rings after the whip under the law "damped", and h omega/2 < 1/4 resolves it."""
    law, exact = motion
    coarse, fine = (largest(tip(law, "edmc", dt), exact, True) for dt in (2.5e-5, 1.25e-5))
    assert fine < 1e-4 and coarse / fine > 3.5  # order 2 or more
    # and before the whip at any of these steps
    assert largest(tip(law, "edmc", 1e-4), exact, False) < 5e-6
