"""Starts from a file of places along cables."""

import numpy as np
import pytest
from hanging import held_net, hung

from anet_lumped import State
from anet_lumped.checks import InputError
from anet_lumped.files.start_file import read_start
from studies.command_line import main


def test_rows_are_places_along_a_cable_from_either_end(tmp_path):
    scene, places = hung((0.8, 0, 0), segments=4), [(0.8, 0, 0), (0.4, 0, -0.3), (0, 0, 0)]
    rows = [f"a-b,{x},{y},{z},{k},0,0" for k, (x, y, z) in enumerate(places)]
    file = tmp_path / "start.csv"
    file.write_text("\n".join(["cable, x, y, z, vx, vy, vz", *rows]))
    found = read_start(file, scene)
    expected = State.of(scene, {"a-b": places}, {"a-b": [(0, 0, 0), (1, 0, 0), (2, 0, 0)]})
    assert (found.q == expected.q).all() and (found.v == expected.v).all() and found.v.any()
    assert found.shape("a-b")[2] == pytest.approx((0.4, 0, -0.3))


def test_the_nodes_that_a_rest_writes_are_a_start(tmp_path, capsys):
    with pytest.raises(SystemExit) as rest:
        main(["equilibrium", "net_held", "--out", str(tmp_path)])
    start = ["--start", str(tmp_path / "nodes.csv"), "--method", "edmc", "--dt", "0.01"]
    with pytest.raises(SystemExit) as run:
        main(["simulate", "net_held", "--t-end", "0.05", *start, "--out", str(tmp_path), "--json"])
    assert not rest.value.code and not run.value.code
    from anet_lumped import load_run

    moved = load_run(tmp_path / "run.nc")
    assert np.abs(moved.q - moved.q[0]).max() < 1e-6


@pytest.mark.parametrize(
    "text, message",
    [
        ("cable,x,y\n", r'must have the columns cable, x, y and z, but .* has no column "z"'),
        ("cable,x,y,z\na-b,0,0,what\n", r"A start must hold numbers, but in .*, line 2, there is none"),
        ("cable,x,y,z\ns0-p0,0,0,0\ns0-p0,1,0,0\n", r'must end where its cable does, but that of cable "s0-p0"'),
    ],
)
def test_what_is_no_start_is_refused(text, message, tmp_path):
    file = tmp_path / "start.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=message):
        read_start(file, held_net())
