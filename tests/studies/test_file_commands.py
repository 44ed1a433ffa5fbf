"""Commands that read and write files: scenes of other programs, saved runs, ropes by their diameter."""

import json
import math

import pytest
from program import OLD_RUN, call

from anet_lumped import load_run
from anet_lumped.files.scene_file import SCENES


def test_ropes_out_of_their_range_are_named(capsys):
    assert call("ropes", "--diameter", "24") == 0  # meant as mm
    assert "warning: A diameter of 2.4e+04 mm is out of the range of nylon (4.76 to 92.1 mm), " in capsys.readouterr().out
    assert call("ropes", "--diameter", "24mm") == 0
    assert "warning" not in capsys.readouterr().out
    assert call("ropes", "--diameter", "-1") == 2


def test_ropes_lists_the_catalogue(capsys):
    assert call("ropes", "--diameter", 0.02, "--json") == 0
    rows = {row["rope"]: row for row in json.loads(capsys.readouterr().out)["ropes"]}
    assert rows["nylon"]["mass_per_metre_kg"] == pytest.approx(585.0 * 0.02**2)
    assert rows["hmpe"]["compared_from_mm"] is None and rows["polyester"]["to_mm"] == pytest.approx(290.0)
    assert call("ropes") == 0
    assert "breaking load [N]" in capsys.readouterr().out


def test_convert_writes_what_every_command_reads(tmp_path, capsys):
    deck, again = tmp_path / "net.txt", tmp_path / "net.toml"
    assert call("convert", "net_held", deck) == 0
    said = capsys.readouterr()
    assert said.out.strip() == str(deck) and "warning: MoorDyn's dampers act on slack segments too" in said.err
    assert call("convert", deck, again) == 0
    capsys.readouterr()
    rests = []
    for scene in ("net_held", deck, again):
        assert call("equilibrium", scene, "--json") == 0
        rests.append(json.loads(capsys.readouterr().out)["points"])
    assert rests[0] == rests[1] == rests[2]


MOORING = """\
--- LINE TYPES ---
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rode 0.05 12 3e6 -0.8 0 1.5 1 0.2 0
--- POINTS ---
ID Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 40 0 -20 0 0 0 0
2 Vessel 0 0 -2 0 0 0 0
--- LINES ---
ID Type A B Length Segs Flags
(-) (-) (-) (-) (m) (-) (-)
1 rode 1 2 46 10 t
--- OPTIONS ---
0 kBot
0 cBot
0.01 dtM
--- OUTPUTS ---
FairTen1 Con2px
--- need this line ---
"""


def test_a_platform_moves_a_mooring_file_and_its_channels_are_written(tmp_path, capsys):
    (tmp_path / "rode.dat").write_text(MOORING)
    arguments = ["simulate", tmp_path / "rode.dat", "--t-end", "5s", "--out", tmp_path / "out"]
    assert call(*arguments, "--move", "surge=1sin0.1", "--move", "pitch=2degsin0.1") == 0
    said = capsys.readouterr()
    assert "warning: rode.dat: No use is made of options of MoorDyn's own run: dtM (line 17)." in said.err
    names, _, *rows = [line.split() for line in (tmp_path / "out" / "rode.out").read_text().splitlines()]
    assert names == ["Time", "FairTen1", "Con2px"]
    assert max(float(row[2]) for row in rows) == pytest.approx(1.0 - 2.0 * math.sin(math.radians(2.0)), rel=1e-3)  # at t = 2.5 s
    assert (tmp_path / "out" / "rode.Line1.out").is_file()
    assert call(*arguments) == 0
    assert 'Nothing moves in this run: point "point2" is driven from outside' in capsys.readouterr().out


def test_a_winch_keeps_a_tension(tmp_path, capsys):
    """Steady within its band of a twentieth; at a speed that it cannot reach the tension would be that of a fixed length."""
    arguments = ["simulate", "tether", "--t-end", "2s", "--out", tmp_path / "out"]
    assert call(*arguments, "--winch", "tether=140N@winch,2m/s") == 0
    kept = load_run(tmp_path / "out" / "run.nc").end_tension("tether", "winch")
    assert call(*arguments) == 0
    fixed = load_run(tmp_path / "out" / "run.nc").end_tension("tether", "winch")
    assert abs(kept[-1] - 140.0) < 8.0 < abs(fixed[-1] - 140.0)
    assert call(*arguments, "--winch", "tether=140N") == 2
    assert "A winch must be as tether=30N@ground,0.2m/s" in capsys.readouterr().err


def test_all_that_is_refused_of_a_mooring_file_is_told_line_by_line(tmp_path, capsys):
    (tmp_path / "rode.dat").write_text(MOORING.replace("0.01 dtM", "-0.3 MU_KT\nbottom.txt SeafloorFile"))
    assert call("equilibrium", tmp_path / "rode.dat") == 2
    first, second = capsys.readouterr().err.splitlines()
    assert first.startswith('anet-lumped: rode.dat, line 17, "-0.3 MU_KT": MU_KT must not be negative')
    assert second.startswith('anet-lumped: rode.dat, line 18, "bottom.txt SeafloorFile": a seafloor must be in a readable file')


def test_convert_does_not_write_over_what_it_reads(tmp_path, capsys):
    file = tmp_path / "net.toml"
    assert call("convert", "net_held", file) == 0
    text = "# of mine\n" + file.read_text()
    file.write_text(text)
    assert call("convert", file, tmp_path / "." / "net.toml") == 2 and file.read_text() == text
    assert "OUT must be another file than SCENE" in capsys.readouterr().err


def test_convert_refuses_an_ending_it_does_not_know(tmp_path, capsys):
    assert call("convert", "net_held", tmp_path / "net.yaml") == 2
    assert "OUT must end in .toml, .txt, .dat, .moordyn, .xml, .sdf, but is" in capsys.readouterr().err


def test_view_and_convert_show_a_saved_run(tmp_path, capsys):
    assert call(*"simulate loose_cable --t-end 0.05 --dt 0.01 --out".split(), tmp_path) == 0
    capsys.readouterr()
    for arguments, file in (
        (["view", tmp_path], "run.html"),
        (["view", tmp_path / "run.nc", "--out", tmp_path / "film.gif"], "film.gif"),
        (["convert", tmp_path / "run.nc", tmp_path / "series.pvd"], "series.pvd"),
    ):
        assert call(*arguments) == 0
        assert capsys.readouterr().out == f"{tmp_path / file}\n" and (tmp_path / file).stat().st_size > 500
    assert len(list((tmp_path / "series").glob("*.vtp"))) == 6


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["view", "nowhere.nc"], "A saved run must be readable, but nowhere.nc: No such file or directory."),
        (["view", "."], "A saved run must be readable, but run.nc: No such file or directory."),
        (["view", SCENES / "net_held.toml"], "it is no netCDF-3 file, or is cut or damaged."),
        (["view", OLD_RUN, "--out", "run.txt"], "A view of a run must end in .html, .pvd, .gif, .mp4, but it is 'run.txt'."),
        (["view", OLD_RUN, "--out", "nowhere/run.html"], "A page must be written to a folder that is there, but nowhere is none."),
        (["convert", OLD_RUN, "run.toml"], "A view of a run must end in .html, .pvd, .gif, .mp4, but it is 'run.toml'."),
        (["convert", "net_held", "net.pvd"], "but is net.pvd; .pvd is for a saved run (.nc)."),
    ],
)
def test_what_cannot_be_shown_is_one_sentence(arguments, sentence, capsys):
    assert call(*arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("anet-lumped: ") and line.endswith(sentence)
