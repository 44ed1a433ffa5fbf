"""Runs by names: the same numbers as the run has by index, with units, in xarray, pandas and files."""

import numpy as np
import pytest
import xarray

from anet_lumped import Cable, Fixed, Free, Scene, load_run, simulate
from anet_lumped.effects import Gravity


@pytest.fixture(scope="module")
def run():
    """A bottle on two cables of unlike segments, the second of which ends at the first point of the scene."""
    points = [Fixed("left", (0, 0, 0)), Free("bottle", mass=0.5, at=(0.5, 0, -0.5)), Fixed("right", (1, 0, 0))]
    cables = [
        Cable("left", "bottle", length=0.7, mass_per_length=0.1, EA=100.0, segments=4, name="line1"),
        Cable("right", "bottle", length=0.8, mass_per_length=0.1, EA=100.0, segments=2, name="line2"),
    ]
    return simulate(Scene(points, cables, [Gravity(9.81)]), 0.02, method="verlet", dt=1e-3, save_every=0.005, start="straight")


def test_points_and_cables_are_selected_by_name(run):
    data = run.to_xarray()
    np.testing.assert_array_equal(data.sel(point="bottle")["position"], run.position("bottle"))
    np.testing.assert_array_equal(data.sel(point="bottle")["velocity"], run.velocity("bottle"))
    for name, n in (("line1", 4), ("line2", 2)):
        one = data.sel(cable=name)
        np.testing.assert_array_equal(one["tension"][:, :n], run.tension(name))
        np.testing.assert_array_equal(one["shape"][:, : n + 1], run.shape(name))
        assert np.isnan(one["tension"][:, n:]).all() and np.isnan(one["arc"][n + 1 :]).all()
    np.testing.assert_allclose(data.sel(cable="line1")["arc"], [0, 0.175, 0.35, 0.525, 0.7], rtol=1e-15)
    assert float(data.sel(cable="line2")["arc_of_segment"][1]) == pytest.approx(0.6, rel=1e-15)
    np.testing.assert_array_equal(data.sel(energy_of="kinetic")["energy"], run.energy[:, 0])


def test_every_variable_has_a_unit(run, tmp_path):
    data = run.to_xarray()
    assert {name: data[name].attrs["units"] for name in ("t", *data.data_vars, "arc")} == {
        "t": "s", "position": "m", "velocity": "m/s", "shape": "m", "tension": "N", "largest_tension": "N", "energy": "J",
        "arc": "m",
    }  # fmt: skip
    run.save(tmp_path / "run.nc")
    with xarray.open_dataset(tmp_path / "run.nc", engine="scipy") as file:
        assert all("units" in file[name].attrs for name in ("t", *file.data_vars))


def test_a_table_has_a_row_for_each_time_and_a_unit_for_each_column(run):
    table = run.to_frame()
    assert table.index.name == "t [s]" and all(name.endswith("]") for name in table)
    np.testing.assert_array_equal(table["bottle z [m]"], run.position("bottle")[:, 2])
    np.testing.assert_array_equal(table["bottle vx [m/s]"], run.velocity("bottle")[:, 0])
    np.testing.assert_array_equal(table["line2 largest tension [N]"], run.tension("line2").max(axis=1))
    np.testing.assert_array_equal(table["line1 length [m]"], run.length("line1"))
    np.testing.assert_array_equal(table["kinetic [J]"], run.energy[:, 0])


def test_a_file_says_of_what_each_node_and_segment_is_and_is_read_as_before(run, tmp_path):
    run.save(tmp_path / "run.nc")
    with xarray.open_dataset(tmp_path / "run.nc", engine="scipy") as file:
        file = file.load()
    bottle = file.set_xindex("point").sel(point="bottle")
    np.testing.assert_array_equal(bottle["q"], run.position("bottle"))
    assert bottle["cable"] == "line1" and bottle["arc"] == pytest.approx(0.7)  # the first cable that ends there
    second = file["tension"].isel(segment=np.flatnonzero(file["segment_cable"] == "line2"))
    second = second.isel(segment=np.argsort(second["segment_arc"].values))
    np.testing.assert_array_equal(second, run.tension("line2"))
    inner = file["q"].isel(node=np.flatnonzero((file["cable"] == "line2") & (file["point"] == "")))
    np.testing.assert_array_equal(inner[:, 0], run.shape("line2")[:, 1])
    again = load_run(tmp_path / "run.nc")
    for name in ("t", "q", "v", "energy", "segment_tension"):
        np.testing.assert_array_equal(getattr(again, name), getattr(run, name))
