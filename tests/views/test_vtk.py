"""Runs as VTK's XML: every number of every state is there, and a reader of VTK finds them."""

import base64
import xml.etree.ElementTree as tree
from dataclasses import replace

import numpy as np
import pytest
from looked_at import breaking
from systems import four_cables

from anet_lumped import Cable, Fixed, Free, InputError, Scene, signals, simulate
from anet_lumped.effects import Gravity, LineChange, Temperature
from anet_lumped.results.events import broken
from anet_lumped.views.motion import strain
from anet_lumped.views.vtk_writer import write_pvd

TYPES = {"Float64": "<f8", "Int64": "<i8"}


def decoded(element):
    """Numbers, or texts, of an array in base64."""
    if element.get("type") == "String":
        return bytes(map(int, element.text.split())).decode().split("\0")[:-1]
    content = base64.b64decode(element.text)
    size = int(np.frombuffer(content[:8], "<u8")[0])
    assert size == len(content) - 8
    values = np.frombuffer(content[8:], TYPES[element.get("type")])
    return values.reshape(-1, int(element.get("NumberOfComponents"))) if element.get("NumberOfComponents") else values


def read(file):
    """Arrays of a `.vtp`, by the element that holds them and their names."""
    root = tree.parse(file).getroot()
    assert root.get("type") == "PolyData" and root.get("byte_order") == "LittleEndian" and root.get("header_type") == "UInt64"
    found = {}
    for parent in root.iter():
        for element in parent:
            if element.tag in ("DataArray", "Array"):
                found[parent.tag, element.get("Name")] = decoded(element)
    piece = root.find("PolyData/Piece")
    return found, {name: int(value) for name, value in piece.items()}


def series(file):
    """Times and files of a `.pvd`."""
    entries = tree.parse(file).getroot().findall("Collection/DataSet")
    return [float(entry.get("timestep")) for entry in entries], [file.parent / entry.get("file") for entry in entries]


@pytest.fixture(scope="module")
def broke():
    run = breaking()
    assert broken(run.events)
    return run


def test_every_state_is_in_the_series_with_its_time(tmp_path, broke):
    file = broke.save_vtk(tmp_path / "new" / "folder")
    assert file == tmp_path / "new" / "folder" / "run.pvd"
    times, states = series(file)
    assert times == broke.t.tolist() and len(set(states)) == len(broke.t) == 31
    for t, q, v, state in zip(broke.t, broke.q, broke.v, states, strict=True):
        found, _ = read(state)
        np.testing.assert_array_equal(found["Points", "Points"], q)
        np.testing.assert_array_equal(found["PointData", "velocity"], v)
        assert found["FieldData", "TimeValue"].tolist() == [t]


def test_segments_carry_their_numbers_in_the_order_of_their_cable(tmp_path):
    run = simulate(four_cables(segments=3, carried=True), 0.1, method="edmc", dt=0.01)
    found, counts = read(series(write_pvd(run, tmp_path / "net.pvd"))[1][-1])
    assert (counts["NumberOfPoints"], counts["NumberOfVerts"], counts["NumberOfLines"]) == (13, 5, 12)
    assert found["FieldData", "cables"] == [cable.name for cable in run.scene.cables]
    assert found["FieldData", "points"] == [point.name for point in run.scene.points]
    pairs = found["Lines", "connectivity"].reshape(-1, 2)
    assert found["Lines", "offsets"].tolist() == list(range(2, 26, 2)) and found["Verts", "offsets"].tolist() == [1, 2, 3, 4, 5]
    for number, point in enumerate(run.scene.points):
        np.testing.assert_array_equal(run.q[-1][found["Verts", "connectivity"][number]], run.position(point.name)[-1])
        assert found["PointData", "point"][run.model.node(point.name)] == number
    assert np.count_nonzero(found["PointData", "point"] >= 0) == 5
    for number, cable in enumerate(run.scene.cables):
        own = np.flatnonzero(found["CellData", "cable"] == number)
        own = own[np.argsort(found["CellData", "segment"][own])]  # from the cable's start to its end
        np.testing.assert_array_equal(found["CellData", "tension"][own], run.tension(cable.name)[-1])
        lengths = np.linalg.norm(np.diff(run.shape(cable.name)[-1], axis=0), axis=1)
        np.testing.assert_allclose(found["CellData", "strain"][own], lengths * 3 / cable.length - 1.0, atol=1e-14)
        for line, (a, b) in zip(
            pairs[own - 5], zip(run.shape(cable.name)[-1], run.shape(cable.name)[-1][1:], strict=False), strict=True
        ):
            assert {tuple(run.q[-1][node]) for node in line} == {tuple(a), tuple(b)}
    for name, none in (("tension", np.nan), ("strain", np.nan), ("cable", -1), ("segment", -1)):
        np.testing.assert_array_equal(found["CellData", name][:5], np.full(5, none))


def test_broken_segments_are_gone(tmp_path, broke):
    (event,) = broke.events
    times, states = series(write_pvd(broke, tmp_path / "run.pvd"))
    for t, state in zip(times, states, strict=True):
        segments = read(state)[0]["CellData", "segment"][2:].tolist()
        assert (event.segment in segments) == (t <= event.t) and len(segments) == (10 if t <= event.t else 9)


def test_strain_is_that_of_the_rest_length_of_its_time():
    """Of a cable that is paid out by 0.1 m a second and has grown by 1 %, after half a second."""
    effects = [Gravity(), LineChange({"a-b": signals.line(0.0, 0.1, 0.0)}), Temperature(1e-4, 100.0)]
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("b", 0.5)], [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=4)], effects
    )
    run = simulate(scene, 0.5, method="edmc", dt=0.01)
    lengths = np.linalg.norm(np.diff(run.shape("a-b")[-1], axis=0), axis=1)
    np.testing.assert_allclose(strain(run, -1)[run.model.segments("a-b")], lengths / (1.05 / 4 * 1.01) - 1.0, atol=1e-14)


def test_states_that_are_not_finite_are_left_out(tmp_path, broke):
    q = broke.q.copy()
    q[-2:] = np.inf
    assert series(replace(broke, q=q).view(tmp_path / "run.pvd"))[0] == broke.t[:-2].tolist()


def test_names_are_text_of_xml(tmp_path):
    run = breaking('<a href="&amp;">\n\x1b</a> é')
    found, _ = read(series(write_pvd(run, tmp_path / 'R&D "<x>.pvd'))[1][0])
    assert found["FieldData", "points"] == ["a", '<a href="&amp;">\n\x1b</a> é']


@pytest.mark.parametrize(
    ("path", "message"),
    [("run.vtk", "must be written to a file that ends in .pvd"), ("", "must be given the path"), (7, "must be given the path")],
)
def test_what_is_no_pvd_is_refused(path, message, broke):
    with pytest.raises(InputError, match=message):
        write_pvd(broke, path)


def test_what_is_no_folder_is_refused(tmp_path, broke):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"must be written to a folder, but .*file is a file"):
        broke.save_vtk(tmp_path / "file")
    for path in ("", None):
        with pytest.raises(InputError, match="must be given the path of a folder"):
            broke.save_vtk(path)


def test_vtk_reads_the_files(tmp_path, broke):
    """The library of ParaView itself, where it is installed."""
    vtk = pytest.importorskip("vtkmodules.vtkIOXML")
    numbers = pytest.importorskip("vtkmodules.util.numpy_support").vtk_to_numpy
    for k, state in enumerate(series(broke.save_vtk(tmp_path))[1]):
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(str(state))
        reader.Update()
        data, holds = reader.GetOutput(), broke.holds("rope")[k]
        assert (data.GetNumberOfPoints(), data.GetNumberOfVerts(), data.GetNumberOfLines()) == (11, 2, holds.sum())
        np.testing.assert_array_equal(numbers(data.GetPoints().GetData()), broke.q[k])
        np.testing.assert_array_equal(numbers(data.GetPointData().GetArray("velocity")), broke.v[k])
        tensions = np.sort(numbers(data.GetCellData().GetArray("tension"))[2:])
        np.testing.assert_array_equal(tensions, np.sort(broke.tension("rope")[k][holds]))
        assert data.GetFieldData().GetAbstractArray("points").GetValue(1) == "b"
        assert data.GetFieldData().GetArray("TimeValue").GetValue(0) == broke.t[k]
