"""Files of measured tensions and marker tracks."""

import zipfile

import numpy as np
import pytest

from anet_lumped.files.measured_series import SeriesError, capture_of, holds_tracks, read_tensions, read_tracks

TRC = """PathFileType\t4\t(X/Y/Z)\tcarried.trc
DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames
100\t100\t3\t2\tmm\t100\t1\t3
Frame#\tTime\tp0\t\t\ts0-p0@0.25\t\t
\t\tX1\tY1\tZ1\tX2\tY2\tZ2

1\t0.00\t1000\t0\t-200\t10\t20\t30
2\t0.01\t1001\t0\t-200\t\t\t
3\t0.02\t1002\t0\t-200\t12\t20\t30
"""


def write(folder, name, text):
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def test_csv(tmp_path):
    found = read_tensions(write(tmp_path, "t.csv", "s0-p0, t,s1-p0.start\n1.5,0.0,\n2.5,0.1,3\n\n"))
    assert found.t.tolist() == [0.0, 0.1] and found.channels["s0-p0"].tolist() == [[1.5], [2.5]]
    assert np.isnan(found.channels["s1-p0.start"][0, 0]) and found.channels["s1-p0.start"][1, 0] == 3.0
    found = read_tracks(write(tmp_path, "m.csv", "t,p0.y,p0.x,p0.z\n0,2,1,3\n1,5,4,6\n"))
    assert found.channels["p0"].tolist() == [[1, 2, 3], [4, 5, 6]]


def test_npz(tmp_path):
    np.savez(tmp_path / "m.npz", t=[0.0, 1.0], p0=[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    assert read_tracks(tmp_path / "m.npz").channels["p0"][1].tolist() == [4, 5, 6]
    np.savez(tmp_path / "t.npz", **{"t": [0.0, 1.0], "s0-p0": [7.0, 8.0]})
    assert read_tensions(tmp_path / "t.npz").channels["s0-p0"].tolist() == [[7.0], [8.0]]


def test_trc_in_its_unit(tmp_path):
    found = read_tracks(write(tmp_path, "m.trc", TRC))
    assert found.t.tolist() == [0.0, 0.01, 0.02] and found.channels["p0"][2] == pytest.approx((1.002, 0.0, -0.2))
    hidden = found.channels["s0-p0@0.25"]
    assert np.isnan(hidden[1]).all() and hidden[0] == pytest.approx((0.01, 0.02, 0.03))


MOTIVE = """Format Version,1.23,Capture Frame Rate,120.000000,Rotation Type,Quaternion,Length Units,Millimeters

,Type,Rigid Body,Rigid Body,Rigid Body,{one},{one},{one},Marker,Marker,Marker,Marker,Marker,Marker
,Name,quad1,quad1,quad1,quad1:1,quad1:1,quad1:1,Net:p0,Net:p0,Net:p0,Unlabeled 7,Unlabeled 7,Unlabeled 7
,ID,a,a,a,b,b,b,c,c,c,d,d,d
,,Position,Position,Position,Position,Position,Position,Position,Position,Position,Position,Position,Position
Frame,Time (Seconds),X,Y,Z,X,Y,Z,X,Y,Z,X,Y,Z
0,0.000000,1,2,3,1,2,3,1000,2000,3000,,,
1,0.008333,1,2,3,1,2,3,1001,2000,3000,5,6,7
""".replace("{one}", "Rigid Body Marker")
NEXUS = """Devices
1000
,,Force
Frame,Sub Frame,Fx
,,N
1,0,3

Trajectories
100
,,Net:s0-p0@0.25,,,Net:p0,,
Frame,Sub Frame,X,Y,Z,X,Y,Z
,,mm,mm,mm,mm,mm,mm
5,0,10,20,30,1000,0,-200
6,0,,,,1001,0,-200

"""


def test_an_export_of_motive(tmp_path):
    """Millimetres, y up: z of the scene is y of the file, and y of the scene -z of it."""
    file = write(tmp_path, "take.csv", MOTIVE)
    found = read_tracks(file)
    assert holds_tracks(file) and set(found.channels) == {"quad1", "p0", "Unlabeled 7"}
    assert found.t.tolist() == [0.0, 0.008333] and found.channels["p0"] == pytest.approx(np.array([(1, -3, 2), (1.001, -3, 2)]))
    assert np.isnan(found.channels["Unlabeled 7"][0]).all()
    assert read_tracks(file, up="z").channels["p0"][0] == pytest.approx((1, 2, 3))
    assert set(capture_of(file).markers) == {"p0", "Unlabeled 7"} and set(capture_of(file).bodies) == {"quad1"}
    with pytest.raises(SeriesError, match=r"must be \"y\" or \"z\", but up='x' was given"):
        read_tracks(file, up="x")


def test_an_export_of_nexus(tmp_path):
    found = read_tracks(write(tmp_path, "trial.csv", NEXUS))
    assert found.t == pytest.approx([0.05, 0.06])
    assert found.channels["p0"] == pytest.approx(np.array([(1, 0, -0.2), (1.001, 0, -0.2)]))
    assert np.isnan(found.channels["s0-p0@0.25"][1]).all()


@pytest.mark.parametrize(
    "text, sentence",
    [
        (MOTIVE.replace("Millimeters", "Feet"), "must have Length Units of meters or millimeters, but .* has 'Feet'"),
        (MOTIVE.replace(",Name,", ",Nom,"), "must have lines Type, Name and Frame"),
        (MOTIVE.replace("1,0.008333,1", "1,0.008333,one"), "Samples must be numbers, but .* row 2 of them"),
        (MOTIVE.replace("X,Y,Z,X", "X,Y,W,X"), r"must have the columns X, Y and Z, but .*'W', 'X', 'Y'"),
        (NEXUS.replace("Trajectories\n100", "Trajectories\nfast"), "must have its frames a second below Trajectories"),
        (NEXUS.replace(",,mm,mm,mm,mm", ",,mm,mm,mm,m"), "must have columns Frame and Sub Frame and one unit"),
        (NEXUS.split("5,0")[0], "must hold places of markers, but .* has none"),
    ],
)
def test_exports_that_cannot_be_read(tmp_path, text, sentence):
    with pytest.raises(SeriesError, match=sentence):
        read_tracks(write(tmp_path, "m.csv", text))


@pytest.mark.parametrize(
    "header, tracks", [("x,y,z", False), ("t,x,y,z", False), ("t,p0.x,p0.y,p0.z", True), ("name,x,y,z", False)]
)
def test_a_cloud_of_markers_is_no_track(tmp_path, header, tracks):
    assert holds_tracks(write(tmp_path, "m.csv", header + "\n")) is tracks
    assert holds_tracks(write(tmp_path, "m.txt", header + "\n")) is tracks
    assert holds_tracks("any.trc") and holds_tracks("any.c3d")


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("a,b\n1,2\n", r"A file of tensions must have a header with one t and no name twice"),
        ("t,a,a\n1,2,3\n", r"no name twice"),
        ("t\n1\n2\n", r"at least one channel besides the time"),
        ("t,a\n1,2\n", r"A file of .* must have two samples or more, but .* has 1\."),
        ("t,a\n1,2\n1,3\n", r"Times must grow, but in .* sample 2, t=1, follows t=1\."),
        ("t,a\n1,2\nnan,3\n", r"Times must be finite numbers, but sample 2 of .* has none"),
        ("t,a\n1,2\n2,x\n", r"Samples must be numbers, but .*line 3 has"),
        ("t,a\n1,2,3\n", r"A row must have 2 cells at most, .*line 2 has 3"),
        ("t,a\n1,\n2,nan\n", r'finite samples, but "a" of .* has none'),
        ("t,a\n1,2\n2,inf\n", r"has none or infinite ones"),
        ('t,a\n1,"' + "2" * 140000 + '\n', r"must be a table in CSV, but .* is not"),
    ],
)  # fmt: skip
def test_tensions_that_are_none(tmp_path, text, sentence):
    with pytest.raises(SeriesError, match=sentence):
        read_tensions(write(tmp_path, "t.csv", text))


@pytest.mark.parametrize(
    "name, text, sentence",
    [
        ("m.csv", "t,p0.x,p0.y\n0,1,2\n", r'NAME.x, NAME.y and NAME.z \[m\], but .* lacks "p0.z"'),
        ("m.csv", "t,p0\n0,1\n", r' has "p0"'),
        ("m.json", "", r"A file of marker tracks must end in .csv, .npz, .trc, .c3d, but it is "),
        ("m.trc", "PathFileType\n", r"must begin with PathFileType, as TRC does, and hold rows"),
        ("m.trc", TRC.replace("PathFileType", "Other"), r"must begin with PathFileType"),
        ("m.trc", TRC.replace("\tmm\t", "\tinch\t"), r'Units of m, cm or mm in its third line, but .* has "inch"'),
        ("m.trc", TRC.replace("\t1001\t", "\tone\t"), r"Samples must be numbers, but .*line 8"),
        ("m.npz", "no zip", r"must be an NPZ file of plain numbers"),
    ],
)  # fmt: skip
def test_tracks_that_are_none(tmp_path, name, text, sentence):
    with pytest.raises(SeriesError, match=sentence):
        read_tracks(write(tmp_path, name, text))


@pytest.mark.parametrize(
    "arrays, sentence",
    [
        ({"p0": np.zeros((2, 3))}, r"must hold an array t \(k,\)"),
        ({"t": np.zeros((2, 1)), "p0": np.zeros((2, 3))}, r"must hold an array t"),
        ({"t": [0.0, 1.0], "p0": 3.0}, r"arrays of as many samples"),
        ({"t": [0.0, 1.0], "p0": [1.0, 2.0]}, r'A marker must have x, y and z a sample, but .* has "p0" of \(2,\)'),
        ({"t": [0.0, 1.0], "p0": np.zeros((3, 3))}, r'a sample for each time, but .* has 3 of "p0" for 2'),
        ({"t": [0.0, 1.0], "p0": np.array([None, 1], object)}, r"NPZ file of plain numbers"),
    ],
)  # fmt: skip
def test_arrays_that_are_none(tmp_path, arrays, sentence):
    np.savez(tmp_path / "m.npz", **arrays)
    with pytest.raises(SeriesError, match=sentence):
        read_tracks(tmp_path / "m.npz")


def test_a_wide_tension(tmp_path):
    np.savez(tmp_path / "t.npz", **{"t": [0.0, 1.0], "s0-p0": np.zeros((2, 3))})
    with pytest.raises(SeriesError, match=r'A tension must be one number a sample, but .* has "s0-p0" of \(2, 3\)'):
        read_tensions(tmp_path / "t.npz")


def test_a_file_that_would_unpack_to_more_than_the_memory_allowed(tmp_path, monkeypatch):
    monkeypatch.setenv("ANET_LUMPED_MOST_BYTES", "1000")
    with zipfile.ZipFile(tmp_path / "m.npz", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("t.npy", b"0" * 10_000)
    with pytest.raises(ValueError, match="A file of marker tracks"):
        read_tracks(tmp_path / "m.npz")


def c3d_file(folder, labels=("p0", "s0-p0@0.25"), units="mm"):
    """Three frames of two markers; the second one is not seen in the second frame."""
    c3d = pytest.importorskip("c3d")
    writer = c3d.Writer(point_rate=100.0, point_units=units)
    writer.set_point_labels(list(labels))
    frames = np.zeros((3, 2, 5), np.float32)
    frames[:, 0, :3], frames[:, 1, :3], frames[1, 1, 3] = (1000.0, 0.0, -200.0), (10.0, 20.0, 30.0), -1.0
    frames[:, 0, 0] += np.arange(3)
    writer.add_frames([(points, np.zeros((0, 1))) for points in frames])
    with open(folder / "m.c3d", "wb") as file:
        writer.write(file)
    return folder / "m.c3d"


def test_c3d_in_its_unit(tmp_path):
    found = read_tracks(c3d_file(tmp_path))
    assert found.t.tolist() == [0.0, 0.01, 0.02] and found.channels["p0"][2] == pytest.approx((1.002, 0.0, -0.2))
    hidden = found.channels["s0-p0@0.25"]
    assert np.isnan(hidden[1]).all() and hidden[0] == pytest.approx((0.01, 0.02, 0.03))


def test_refused_c3d(tmp_path, monkeypatch):
    with pytest.raises(SeriesError, match=r'must have POINT:UNITS of m, cm or mm, but .* has "inch"'):
        read_tracks(c3d_file(tmp_path, units="inch"))
    with pytest.raises(SeriesError, match="must have a rate, and a name of its own for each marker"):
        read_tracks(c3d_file(tmp_path, labels=("p0", "p0")))
    (tmp_path / "m.c3d").write_bytes(b"no such thing" * 50)
    with pytest.raises(SeriesError, match=r"must be a C3D file, but .* cannot be read"):
        read_tracks(tmp_path / "m.c3d")
    monkeypatch.setitem(__import__("sys").modules, "c3d", None)
    with pytest.raises(SeriesError, match="C3D files are read by the package c3d: pip install"):
        read_tracks(tmp_path / "m.c3d")
