"""What a Run refuses, and how far apart two runs are."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, InputError, Scene, simulate
from anet_lumped.effects import Gravity
from anet_lumped.results.distances import distances


@pytest.fixture(scope="module")
def run():
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=3)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Free("b", at=(1.0, 0.0, 0.0))], [cable], [Gravity(9.81)])
    return simulate(scene, 0.2, method="edmc", dt=0.01, save_every=0.02, start="straight")


@pytest.mark.parametrize(
    ("name", "wrong", "shapes"),
    [
        ("q", lambda run: run.q[1:], r"\(11, 4, 3\), but its shape is \(10, 4, 3\)"),
        ("v", lambda run: run.v[:, 1:], r"\(11, 4, 3\), but its shape is \(11, 3, 3\)"),
        ("q_near", lambda run: run.q[0], r"\(11, 4, 3\), but its shape is \(4, 3\)"),
        ("energy", lambda run: run.energy[:, :3], r"\(11, 7\), but its shape is \(11, 3\)"),
        ("segment_tension", lambda run: run.segment_tension[:, :2], r"\(11, 3\), but its shape is \(11, 2\)"),
        ("error_growth", lambda run: run.error_growth[:-1], r"\(11,\), but its shape is \(10,\)"),
    ],
)
def test_arrays_have_a_row_for_each_saved_time(run, name, wrong, shapes):
    with pytest.raises(InputError, match=f"Argument `{name}` of a Run must be of the shape {shapes}"):
        replace(run, **{name: wrong(run)})


def test_energies_of_version_0_1_have_five_columns(run):
    assert replace(run, energy=run.energy[:, :5]).energy.shape == (11, 5)


def test_distances_at_the_times_that_both_have_saved(run):
    other = replace(
        run, t=run.t[::2], q=run.q[::2] + np.array([0.0, 3.0, 4.0]), v=run.v[::2], energy=run.energy[::2],
        error_growth=run.error_growth[::2], segment_tension=run.segment_tension[::2], largest_tension=None,
    )  # fmt: skip
    rows, other_rows, apart = distances(run, other)
    assert rows.tolist() == [0, 2, 4, 6, 8, 10] and other_rows.tolist() == [0, 1, 2, 3, 4, 5]
    np.testing.assert_allclose(apart, 5.0, rtol=1e-14)
    assert distances(other, run).rows.tolist() == other_rows.tolist()
