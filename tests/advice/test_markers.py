"""Marker files of every order and unit; clouds made from the exact net, sequenced and fitted back."""

import numpy as np
import pytest
from slow import slow

from anet_lumped.advice.markers import MarkerError, fit_markers, read_markers, sequence
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.catenary_net import catenary_net
from anet_lumped.statics.equilibrium import equilibrium

TRUE_LENGTHS = (1.04, 0.97, 1.02, 0.95)
NOISE = 0.002


def net(lengths=(1.0,) * 4):
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    return Scene(
        points=[Fixed(f"s{i}", at) for i, at in enumerate(corners)] + [Free("p0", mass=0.036, at=(0, 0, -0.6))],
        cables=[Cable(f"s{i}", "p0", length=length, mass_per_length=0.1, EA=1e4, segments=40) for i, length in enumerate(lengths)],
        effects=[Gravity()],
    )


def cloud(seed, lengths=TRUE_LENGTHS, noise=NOISE, hidden=0.2, strays=0.1, spacing=0.04):
    """Shuffled markers (m, 3), the cable of each (-1 for a stray) and the arc of each; hidden ones are left out."""
    rng = np.random.default_rng(seed)
    scene = net(lengths)
    exact = catenary_net(scene, {point.name: point.at for point in scene.points})
    parts = []
    for i, length in enumerate(lengths):
        arc = np.arange(spacing / 2, length - spacing / 3, spacing)
        arc = arc[rng.random(len(arc)) >= hidden]
        points = exact.cables[f"s{i}-p0"].point(arc)
        parts.append((points + rng.normal(0, noise, points.shape), np.full(len(arc), i), arc))
    n = round(strays * sum(len(arc) for *_, arc in parts))
    parts.append((rng.uniform((-0.7, -0.7, -1), (0.7, 0.7, 0.2), (n, 3)), np.full(n, -1), np.full(n, np.nan)))
    shuffled = rng.permutation(sum(len(arc) for *_, arc in parts))
    return tuple(np.concatenate(part)[shuffled] for part in zip(*parts, strict=True))


def write(path, xyz, columns="x,y,z", scale=1.0):
    order = ["xyz".index(name) for name in columns.split(",") if name in "xyz"]
    lines = [",".join(f"{scale * row[j]:.6f}" for j in order) for row in xyz]
    path.write_text("\n".join([columns, *lines]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("columns", ["x,y,z", "z,x,y"])
@pytest.mark.parametrize(("scale", "unit"), [(1.0, "m"), (1000.0, "mm")])
def test_any_order_of_columns_and_either_unit(tmp_path, columns, scale, unit):
    xyz, *_ = cloud(0)
    found = read_markers(write(tmp_path / "markers.csv", xyz, columns, scale), net())
    assert found.unit == unit
    assert found.xyz == pytest.approx(xyz, abs=1e-6)


@pytest.mark.parametrize("far", [1e-4, 1e6])
def test_unit_is_not_decided_by_one_stray_point(tmp_path, far):
    xyz, *_ = cloud(0)
    xyz[0] = far
    assert read_markers(write(tmp_path / "markers.csv", xyz), net()).unit == "m"


def test_other_columns_empty_cells_and_blank_lines(tmp_path):
    file = tmp_path / "markers.csv"
    file.write_text("\ufeffid, Z ,x,y\n1,-0.1,0.2,0.3\n2,,0.2,0.3\n\n3,nan,0.1,0.1\n4,-0.5,0.3\n5,-0.4,0.1,0.1\n", encoding="utf-8")
    found = read_markers(file, net(), unit="m")
    assert found.xyz == pytest.approx(np.array([(0.2, 0.3, -0.1), (0.1, 0.1, -0.4)]))
    assert found.empty_rows == 3


@pytest.mark.parametrize(
    ("text", "unit", "message"),
    [
        (
            "1,2,3\n4,5,6\n",
            None,
            r"must have a first line, with commas, of one x, one y and one z, or .* but .*csv has \['1', '2', '3'\]",
        ),
        ("x,y,z,x\n1,2,3,4\n", None, "must have a first line, with commas, of one x, one y and one z"),
        ("", None, "must have a first line, with commas, of one x, one y and one z"),
        ("x,y,z\n1,2,3\n1,two,3\n", None, r"must be numbers, but .*markers.csv, line 3 has \['1', 'two', '3'\]"),
        ("x,y,z\n1,2,3\n1,-inf,3\n", None, r"must not be beyond 1e\+09, but .*markers.csv, line 3 has \['1', '-inf', '3'\]"),
        ("x,y,z\n1,2,1e10\n", None, "must not be beyond"),
        ('x,y,z\n"' + "1" * 200_000 + '",2,3\n', None, r"must be a table in CSV, but .*markers.csv, line 2, is not: field larger"),
        ("x,y,z\n,,\n1,,2\n", None, "needs at least one row with x, y and z, but .*markers.csv has none"),
        ("x,y,z\n1e7,0,0\n2e7,0,0\n4e7,0,0\n", None, "must be in metres or millimetres, but those of .*csv lie"),
        ("x,y,z\n1,2,3\n", "cm", 'The unit of markers must be "m" or "mm", but unit=\'cm\' was given'),
    ],
)
def test_unreadable_files(tmp_path, text, unit, message):
    file = tmp_path / "markers.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(MarkerError, match=message):
        read_markers(file, net(), unit)


def test_sequence_on_the_model_itself():
    """Markers on the model's own nodes come back in their order, at their arcs."""
    state = equilibrium(net())
    rng = np.random.default_rng(0)
    shuffled = rng.permutation(40)
    found = sequence(state.shape("s2-p0")[:-1][shuffled], state)
    assert (found.cable == 2).all()
    assert (shuffled[found.along(2)] == np.arange(40)).all()
    assert found.arc == pytest.approx(shuffled / 40, abs=1e-12)
    assert found.distance == pytest.approx(np.zeros(40), abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_fit_recovers_assignment_order_and_lengths(seed):
    xyz, cable, arc = cloud(seed)
    found = fit_markers(xyz, net())
    order = found.sequence
    # A stray within 5 sigma (1 cm) of a cable, or a marker beyond it, may be taken wrongly: not more than 1 %.
    assert (order.cable == cable).mean() >= 0.99
    assert found.sequence.sigma == pytest.approx(NOISE, rel=0.4)
    for i, match in enumerate(found.cables):
        assert match.length_before == 1.0
        # 4 standard errors: once in 16,000; and the standard error itself is about a millimetre.
        assert abs(match.length_after - TRUE_LENGTHS[i]) < 4 * match.length_standard_error
        assert match.length_standard_error < 0.0015
        assert match.rmse_after < 2 * NOISE < 0.02 < match.rmse_before  # two of three coordinates: sqrt(2) noise
        rows = order.along(i)
        rows = rows[cable[rows] == i]
        assert arc[rows] == pytest.approx(order.arc[rows], abs=6 * NOISE)
        assert (np.diff(arc[rows]) > 0).all()  # spaced by twenty times the noise
        assert match.sag_after == pytest.approx(match.sag_measured, abs=0.01)
        assert min(match.r_squared_after) > 0.999 > max(match.r_squared_before[2], 0.99)
    assert np.abs(found.offset).max() < 0.003  # as for a shifted frame below


@pytest.mark.parametrize("strays", [0.8, *slow(0.1, 0.4)])
def test_strays_do_not_move_the_fit(strays):
    """Lengths 10 % off at the start, a third of the markers hidden, and up to nearly as many strays as markers."""
    lengths = (1.1, 0.91, 1.04, 0.95)
    xyz, cable, _ = cloud(10, lengths=lengths, strays=strays, hidden=0.33)
    found = fit_markers(xyz, net())
    for match, length in zip(found.cables, lengths, strict=True):
        assert abs(match.length_after - length) < 4 * match.length_standard_error < 0.006
    assert (found.sequence.cable == cable)[cable >= 0].mean() >= 0.99


def test_fit_counts_the_hidden_and_the_covered():
    xyz, cable, arc = cloud(4, hidden=0.15, strays=0.0, noise=0.001)
    for i, match in enumerate(fit_markers(xyz, net()).cables):
        own = np.sort(arc[cable == i])
        assert match.markers == len(own)
        assert match.missing == round((own[-1] - own[0]) / 0.04) + 1 - len(own)
        assert match.covered == pytest.approx((own[0], own[-1]), abs=0.005)
        gaps = np.diff([0.0, *own, TRUE_LENGTHS[i]])
        assert match.largest_gap == pytest.approx(gaps.max(), abs=0.01)


def test_fit_of_exact_markers_is_exact():
    """Without noise only the lumping is left: 40 segments, 0.1 mm."""
    xyz, cable, _ = cloud(5, noise=0.0, hidden=0.0, strays=0.0)
    found = fit_markers(xyz, net())
    assert (found.sequence.cable == cable).all()
    assert [match.length_after for match in found.cables] == pytest.approx(TRUE_LENGTHS, abs=3e-4)


def test_cable_with_too_few_markers_keeps_its_length():
    xyz, cable, _ = cloud(6, lengths=(1.0, 0.97, 1.02, 1.0), strays=0.0)
    keep = cable != 3
    keep[np.flatnonzero(cable == 3)[:2]] = True
    found = fit_markers(xyz[keep], net())
    assert found.cables[3].length_after == 1.0
    assert np.isnan(found.cables[3].length_standard_error)
    assert found.cables[1].length_after == pytest.approx(0.97, abs=0.005)


def test_irregular_spacing_has_no_missing_count():
    xyz, *_ = cloud(7, hidden=0.0, strays=0.0)
    rng = np.random.default_rng(0)
    found = fit_markers(xyz[rng.random(len(xyz)) < 0.35], net())
    assert None in [match.missing for match in found.cables]


def test_shifted_frame_shows_in_the_offset():
    shift = np.array([0.01, 0.0, 0.03])
    found = fit_markers(cloud(8)[0] + shift, net())
    assert found.offset == pytest.approx(shift, abs=0.003)  # four standard errors of a shift beside the lengths


def test_markers_of_another_place():
    xyz, *_ = cloud(9)
    with pytest.raises(MarkerError, match=r"Markers must lie along the cables .* are they in the scene's frame"):
        fit_markers(xyz + np.array([0.0, 3.0, 0.0]), net())


def test_too_few_markers():
    xyz, *_ = cloud(9)
    with pytest.raises(MarkerError, match="A fit needs at least three markers on one cable, but of the 2 given"):
        fit_markers(xyz[:2], net())


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xff\xfex\0,\0y\0", "must be UTF-8 text, but .*markers.csv is UTF-16"),
        (b"x,y,z,\xe9\n1,2,3,4\n", "must be UTF-8 text, but line 1 of .*markers.csv is not"),
        (b"\0" * 5000, "must be UTF-8 text, but .*markers.csv is binary"),
    ],
)
def test_a_file_that_is_no_text_is_refused(tmp_path, content, message):
    (tmp_path / "markers.csv").write_bytes(content)
    with pytest.raises(MarkerError, match=message):
        read_markers(tmp_path / "markers.csv", net())


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("nowhere.csv", "must be readable, but nowhere.csv: No such file"),
        ("/", "must be readable, but /: Is a directory"),
        ("a\0b", "must be given by the path of a file"),
    ],
)
def test_a_path_that_is_no_file_is_refused(path, message):
    with pytest.raises(MarkerError, match=message):
        read_markers(path, net())


def test_more_than_memory_holds_is_refused(monkeypatch):
    xyz, *_ = cloud(0)
    monkeypatch.setenv("ANET_LUMPED_MOST_BYTES", "1000")
    with pytest.raises(InputError, match=rf"A fit of 40 segments to {len(xyz)} markers would take \S+ bytes"):
        fit_markers(xyz, net())


def test_markers_on_one_another_have_no_spacing(recwarn):
    xyz, *_ = cloud(0, noise=0.0, strays=0.0)
    fit = fit_markers(np.repeat(xyz, 5, axis=0), net())
    assert all(match.missing is None for match in fit.cables) and not recwarn.list


def test_tracks_that_stand_still_are_one_shape(tmp_path):
    """The median of each marker over the frames, in the unit that the file says, and how far it moves about that."""
    xyz = cloud(0)[0][:6]
    still = [xyz - 0.004, xyz, xyz + 0.004, xyz, np.where(np.arange(6)[:, None] == 2, np.nan, xyz)]
    heads = ["Trajectories", "100", ",," + ",,,".join(f"Rope:{k}" for k in range(6))]
    heads += ["Frame,Sub Frame" + ",X,Y,Z" * 6, ",," + ",".join(["mm"] * 18)]
    rows = [f"{k},0," + ",".join("" if np.isnan(x) else f"{1e3 * x:.4f}" for x in frame.ravel()) for k, frame in enumerate(still)]
    (tmp_path / "trial.csv").write_text("\n".join([*heads, *rows]) + "\n", encoding="utf-8")
    found = read_markers(tmp_path / "trial.csv", net())
    assert found.unit == "mm" and found.names == tuple("012345") and found.xyz == pytest.approx(xyz, abs=1e-7)
    # two frames of five (of four for the one that was hidden) are 4 mm off in each coordinate
    expected = np.full(6, 0.004 * np.sqrt(3 * 2 / 5))
    expected[2] = 0.004 * np.sqrt(3 * 2 / 4)
    assert found.spread == pytest.approx(expected, abs=1e-6)


def test_residuals_and_picture_of_a_fit():
    xyz, *_ = cloud(3)
    found = fit_markers(xyz, net())
    assert np.linalg.norm(found.residuals, axis=1) == pytest.approx(found.sequence.distance)
    side, _, along = found.plot().axes
    drawn = {line.get_label(): line.get_xydata() for line in side.lines}
    np.testing.assert_allclose(drawn["markers"], xyz[found.sequence.cable >= 0][:, [0, 2]])
    points = np.concatenate([line.get_xydata() for line in along.lines])
    assert len(points) == (found.sequence.cable >= 0).sum()
    assert points[:, 1] == pytest.approx(1e3 * np.concatenate([found.sequence.distance[found.sequence.along(i)] for i in range(4)]))
