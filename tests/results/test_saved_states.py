"""Saved states of a run, found by their number."""

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, InputError, Scene, simulate
from anet_lumped.effects import Gravity


@pytest.fixture(scope="module")
def run():
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=3)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable], [Gravity()])
    return simulate(scene, 0.03, method="edmc", dt=0.01, save_every=0.01)


@pytest.mark.parametrize("k", [0, 3, -1, -4, np.int64(2)])
def test_a_state_is_that_of_its_time(run, k):
    assert run.state(k).t == run.t[k]
    np.testing.assert_array_equal(run.state(k).q, run.q[k])


@pytest.mark.parametrize("k, said", [("a", "'a'"), (4, "4"), (-5, "-5"), (1.0, "1.0"), (None, "None"), (True, "True")])
def test_another_number_is_refused(run, k, said):
    with pytest.raises(InputError, match=rf"`k` must be an integer from -4 to 3, the number of a saved time, but it is {said}\."):
        run.state(k)
