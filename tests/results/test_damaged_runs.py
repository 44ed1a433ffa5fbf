"""Saved runs that are cut, damaged, edited, of another version or no runs at all: one sentence, and never other numbers."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
import xarray
from drawn import Drawn
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import InputError, load_run
from anet_lumped.checks import LONGEST
from anet_lumped.results.run_file import FORMAT, DamagedError, _OnceThrough
from studies.catalogue.hostile_files import changed_bytes

OLD = Path(__file__).parents[1] / "files" / "run_of_version_0_1.nc"  # without format and checksum
ACCOUNT = ("method", "dt", "reason", "status", "message", "wall_time", "warnings", "events", "extrapolated", "kept")


@pytest.fixture(scope="module")
def run():
    return load_run(OLD)


@pytest.fixture(scope="module")
def saved(run, tmp_path_factory):
    """Content of a file as it is written now."""
    path = tmp_path_factory.mktemp("saved") / "run.nc"
    run.save(path)
    return path.read_bytes()


def said_of(run):
    """All that is read of a run."""
    arrays = [getattr(run, name).tobytes() for name in ("t", "q", "v", "energy", "segment_tension")]
    return arrays, asdict(run.work), run.audit, run.scene, [getattr(run, name) for name in ACCOUNT]


def edited(tmp_path, saved, attributes=None, **arrays):
    """A file of before there were formats and checksums, with other attributes and arrays."""
    (tmp_path / "saved.nc").write_bytes(saved)
    with xarray.open_dataset(tmp_path / "saved.nc", engine="scipy") as data:
        data = data.load()
    for name in ("format", "checksum"):
        del data.attrs[name]
    for name, value in (attributes or {}).items():
        data.attrs[name] = value
        if value is None:
            del data.attrs[name]
    for name, change in arrays.items():
        data = change(data, name)
    data.to_netcdf(tmp_path / "edited.nc", engine="scipy")
    return tmp_path / "edited.nc"


def test_a_file_of_before_there_were_checksums_is_read(tmp_path, saved, run):
    assert said_of(load_run(edited(tmp_path, saved))) == said_of(run)


@tried(300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_changed_file_is_refused_or_says_the_same(tmp_path, saved, run, data):
    (tmp_path / "run.nc").write_bytes(changed_bytes(Drawn(data), saved))
    try:
        found = load_run(tmp_path / "run.nc")
    except InputError as refused:
        said = str(refused)
        assert said.startswith("A saved run must be as `Run.save` wrote it, but ") and said.isprintable() and len(said) <= LONGEST
    else:
        assert said_of(found) == said_of(run)


@tried(200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_changed_file_without_a_checksum_is_refused_or_a_run(tmp_path, data):
    (tmp_path / "run.nc").write_bytes(changed_bytes(Drawn(data), OLD.read_bytes()))
    try:
        found = load_run(tmp_path / "run.nc")
    except InputError as refused:
        assert str(refused).isprintable() and len(str(refused)) <= LONGEST
    else:
        assert found.position("b").shape == (len(found.t), 3) and np.isfinite(found.energy_balance.in_play)


def test_every_bit_of_the_numbers_counts(tmp_path, saved, run):
    at = saved.index(run.q.astype(">f8").tobytes())
    for bit in range(0, 8 * run.q.nbytes, 997):
        content = bytearray(saved)
        content[at + bit // 8] ^= 1 << bit % 8
        (tmp_path / "run.nc").write_bytes(content)
        with pytest.raises(InputError, match=r"its checksum is not that of its content"):
            load_run(tmp_path / "run.nc")


@pytest.mark.parametrize(
    "content",
    [b"", b"CDF\x01", b"CDF\x02" + b"\x7f" * 400, b"\x89HDF\r\n\x1a\n" + bytes(99), b"t,u,v,w\n", b"CDF\x01" + bytes(400)],
)
def test_what_is_no_run(tmp_path, content):
    (tmp_path / "run.nc").write_bytes(content)
    with pytest.raises(InputError, match=r"but .*run.nc: (it is no netCDF-3 file|it has no `t`|it claims to)"):
        load_run(tmp_path / "run.nc")


def test_a_foreign_netcdf_file(tmp_path):
    xarray.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf(tmp_path / "run.nc", engine="scipy")
    with pytest.raises(InputError, match="it has no `t`"):
        load_run(tmp_path / "run.nc")


def test_no_byte_is_handed_out_twice():
    """Each of many arrays that a header puts at the same bytes would be a copy: more memory than there is."""
    stream = _OnceThrough(b"12345678")
    stream.left = 8
    assert (stream.read(4), stream.read(10**9)) == (b"1234", b"5678")
    stream.seek(0)
    with pytest.raises(DamagedError, match="it claims to hold more than it does"):
        stream.read(1)


def test_a_file_of_a_newer_version_says_so(tmp_path, saved, monkeypatch, run):
    monkeypatch.setattr("anet_lumped.results.run_file.FORMAT", FORMAT + 1)
    run.save(tmp_path / "run.nc")
    monkeypatch.undo()
    with pytest.raises(
        InputError,
        match=rf"written by a newer version of anet-lumped, in format {FORMAT + 1} where this one reads up to {FORMAT}\.",
    ):
        load_run(tmp_path / "run.nc")
    with pytest.raises(InputError, match=r"its format is -3\."):
        load_run(edited(tmp_path, saved, {"format": -3}))


def scene_with(run, **changes):
    from anet_lumped.scene.as_dict import scene_to_dict

    entries = scene_to_dict(run.scene)
    entries["cables"][0] |= changes
    return json.dumps(entries)


EVENT = {"t": 0.1, "kind": "broke", "where": "a-b", "lost": 0.0, "segment": 1, "tension": 2.0}


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({"scene": None}, "its `scene` is missing"),
        ({"scene": "{"}, "its scene cannot be read: Expecting property name"),
        ({"scene": "[1]"}, "its scene cannot be read: scene: must be a table of keys and values"),
        ({"scene": "[" * 10**5}, "its scene cannot be read: "),
        ({"scene": "1" * 5000}, "its scene cannot be read: E"),
        ({"method": "edm"}, "its method 'edm' is unknown"),
        ({"status": "fine"}, "its status 'fine' is unknown"),
        ({"reason": 3}, "its `reason` is 3"),
        ({"dt": -1.0}, r"its `dt` is -1\.0"),
        ({"dt": float("nan")}, "its `dt` is nan"),
        ({"wall_time": "soon"}, "its `wall_time` is 'soon'"),
        ({"work": "null"}, "its `work` is missing"),
        ({"work": '{"steps": 1.5}'}, "its `work` cannot be read: Input should be a valid integer"),
        ({"work": '{"stepz": 1}'}, "its `work` has a field that is unknown"),
        ({"warnings": '["a", 3]'}, "its `warnings` cannot be read: Input should be a valid string"),
        ({"kept": "2"}, "its `kept` cannot be read: Input should be a valid boolean"),
        ({"audit": '{"error": "x"}'}, "its `audit` cannot be read: Input should be a valid number"),
        ({"audit": "[" * 10**5}, "its `audit` cannot be read: Invalid JSON: recursion limit exceeded"),
        ({"events": json.dumps([EVENT | {"where": "b"}])}, r"its scene has no place for Event\("),
        ({"events": json.dumps([EVENT | {"segment": 3}])}, r"its scene has no place for Event\("),
        ({"events": json.dumps([EVENT | {"kind": "bent"}])}, r"its scene has no place for Event\("),
        ({"events": json.dumps([EVENT | {"kind": "payload changed"}])}, r"its scene has no place for Event\("),
        ({"author": "me"}, "its attribute 'author' is unknown"),
    ],
)
def test_accounts_that_no_run_has(tmp_path, saved, attributes, message):
    with pytest.raises(InputError, match=rf"^A saved run must be as `Run.save` wrote it, but .*edited.nc: {message}"):
        load_run(edited(tmp_path, saved, attributes))


def test_a_scene_of_other_arrays_is_refused_before_its_model_is_built(tmp_path, saved, run):
    message = "its scene has 1000000001 nodes and 1000000000 segments, but its arrays are of 4 nodes and 3 segments"
    with pytest.raises(InputError, match=message):
        load_run(edited(tmp_path, saved, {"scene": scene_with(run, segments=10**9)}))


def test_a_scene_that_no_model_can_be_made_of(tmp_path, saved, run):
    entries = json.loads(scene_with(run))
    entries["effects"]["air"] = {"density": 1.2}
    with pytest.raises(InputError, match="its scene has no model: The effect Air needs the `diameter`"):
        load_run(edited(tmp_path, saved, {"scene": json.dumps(entries)}))


def put(row, value):
    def change(data, name):
        data[name].values[row] = value
        return data

    return change


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (
            {"t": lambda data, name: data.assign_coords(t=[0.0, np.nan, 0.1, 0.2, 0.3])},
            "its times are not finite, or",
        ),
        ({"t": lambda data, name: data.assign_coords(t=[0.0, 0.2, 0.1, 0.3, 0.4])}, "its times are not finite, or"),
        ({"q": put(2, np.inf)}, "its run reached its end, but `q` is not finite"),
        ({"energy": put(2, np.nan)}, "its run reached its end, but `energy` is not finite"),
        ({"v": lambda data, name: data.drop_vars(name)}, "it has no `v`"),
        ({"v": lambda data, name: data.assign(v=data["v"].astype("f4"))}, "its variable 'v' is unknown, or not of the"),
        (
            {"v": lambda data, name: data.assign(v=data["v"].rename(node="knot"))},
            "its variable 'v' is unknown, or not of the",
        ),
        ({"w": lambda data, name: data.assign(w=data["v"])}, "its variable 'w' is unknown, or not of the"),
        ({"t": lambda data, name: data.isel(t=slice(0, 0))}, "its variable `.*` has the shape"),
        ({"axis": lambda data, name: data.assign_coords(axis=["x", "y", "w"])}, "its axes or kinds of energy are unknown"),
        ({"axis": lambda data, name: data.assign_coords(axis=[1.0, 2.0, 3.0])}, "its axes or kinds of energy are unknown"),
    ],
)
def test_arrays_that_no_run_has(tmp_path, saved, arrays, message):
    with pytest.raises(InputError, match=message):
        load_run(edited(tmp_path, saved, **arrays))
