"""Channels of a MoorDyn file: what they mean by closed forms, what MoorDyn writes beside it, and the files."""

import numpy as np
import pytest

from anet_lumped import SixMotions, equilibrium, platform, signals, simulate
from anet_lumped.files.moordyn_channels import outputs, write_asked, write_outputs
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckWarning
from studies.peers.moordyn import silence, state_file
from studies.peers.problem import problem

CHANNELS = (
    "FairTen1 AnchTen1 Line2TenA Line2TenB Con2pz Point3px P3vx Con3fx Con3fz Con2T Con1Ten L1N0fz L1N8fz L1N8T L1N3T L2N2px "
    "Line2NBfx L1N4fz"
)
DECK = f"""\
a hose from the bottom to a buoy, and on to a pontoon
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
hose 0.1 25 2e6 -0.7 0 1.1 1.0 0.02 0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 0 0 -40 0 0 0 0
2 Free 14 0 -20 30 0.9 0.3 0.5
3 Coupled 30 2 -2 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 hose 1 2 26 8 ptsvD
2 hose 2 3 30 10 -
--- OPTIONS ---
0.001 dtM
60 WtrDpth
0 kBot
0 cBot
0 writeLog
60 TmaxIC
1e-6 threshIC
--- OUTPUTS ---
{CHANNELS} L9N1px L1N9px Con2ax Body1px
--- need this line ---
"""
WEIGHT = 9.80665 * (25.0 - 1025.0 * np.pi / 4.0 * 0.1**2)  # of a metre of hose in water


@pytest.fixture(scope="module")
def at_rest():
    deck = deck_from_text(DECK)
    return deck, simulate(deck.scene, 0.05, method="edmc", dt=0.05)


def test_channels_at_rest(at_rest):
    """Both ends of a line carry its weight; nodes and free points are in balance, to what statics leave, 1e-9 of a force."""
    deck, run = at_rest
    columns = {name: column[0] for name, column in outputs(deck, run).columns.items()}
    rest = equilibrium(deck.scene)
    assert columns["Con2pz"] == rest.position("point2")[2] and columns["Point3px"] == 30.0 and columns["P3vx"] == 0.0
    top = columns["FairTen1"]
    assert columns["L1N0fz"] + columns["L1N8fz"] == pytest.approx(-26.0 * WEIGHT, rel=1e-6)
    assert columns["L1N0fz"] + columns["Con3fz"] == pytest.approx(-56.0 * WEIGHT + 9.80665 * (0.9 * 1025.0 - 30.0), rel=1e-6)
    assert columns["Con2T"] < 1e-6 * top and abs(columns["L1N4fz"]) < 1e-6 * top
    assert columns["Con1Ten"] == pytest.approx(columns["AnchTen1"], rel=1e-12)
    assert columns["Line2NBfx"] == columns["Con3fx"] and columns["L1N8T"] == columns["FairTen1"]
    assert columns["L1N0fz"] > 0.0 > columns["L1N8fz"]  # the line pulls its anchor up, and its buoy down
    tension = rest.tension("line1")
    assert columns["L1N3T"] == pytest.approx(0.5 * (tension[2] + tension[3]), rel=1e-3)  # that of the mean of both vectors


def test_what_is_not_written_is_named(at_rest):
    found = outputs(*at_rest)
    assert found.missing == ("L9N1px", "L1N9px", "Con2ax", "Body1px", "D of line 1")
    assert {name: found.units[name] for name in ("FairTen1", "P3vx", "Con2pz")} == {"FairTen1": "N", "P3vx": "m/s", "Con2pz": "m"}


def test_letters_of_a_line(at_rest):
    deck, run = at_rest
    columns = outputs(deck, run).lines[1]
    assert list(columns)[:4] == ["Node0px", "Node0py", "Node0pz", "Node1px"] and len(columns) == 9 * 3 * 2 + 8 * 2
    assert columns["Seg3Te"][0] == run.tension("line1")[0, 2]
    assert columns["Seg3St"][0] == pytest.approx(columns["Seg3Te"][0] / 2e6, rel=1e-6)
    assert columns["Node8pz"][0] == run.position("point2")[0, 2] and not columns["Node4vx"][0]


def test_files_are_like_moordyns(at_rest, tmp_path):
    deck, run = at_rest
    found = write_outputs(deck, run, tmp_path, "hose")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["hose.Line1.out", "hose.out"]
    names, units, *rows = [line.split() for line in (tmp_path / "hose.out").read_text().splitlines()]
    assert names == ["Time", *CHANNELS.split()] and units[:2] == ["(s)", "(N)"] and len(rows) == len(run.t)
    assert float(rows[-1][0]) == pytest.approx(0.05) and float(rows[-1][1]) == pytest.approx(
        found.columns["FairTen1"][-1], rel=1e-7
    )
    assert all(len(line) == 10 + 20 * len(CHANNELS.split()) for line in (tmp_path / "hose.out").read_text().splitlines())


def test_only_files_of_moordyn_want_something_written(at_rest, tmp_path):
    _, run = at_rest
    write_asked("net_held", run, tmp_path)
    assert not list(tmp_path.iterdir())
    (tmp_path / "hose.txt").write_text(DECK)
    with pytest.warns(
        DeckWarning, match=r"hose.txt: what it wants written and is not: L9N1px, L1N9px, Con2ax, Body1px, D of line 1"
    ):
        write_asked(tmp_path / "hose.txt", run, tmp_path)
    assert (tmp_path / "hose.Line1.out").is_file()


def test_a_moved_run_has_its_channels(at_rest):
    deck, _ = at_rest
    moved = platform(deck.scene, SixMotions(surge=signals.harmonic(0.0, 0.5, 0.2)), 2.0)
    run = simulate(moved, 2.0, save_every=0.25)
    columns = outputs(deck, run).columns
    assert np.allclose(columns["Point3px"], 30.0 + 0.5 * np.sin(0.4 * np.pi * run.t), atol=1e-9)
    assert np.allclose(columns["P3vx"], 0.2 * np.pi * np.cos(0.4 * np.pi * run.t), atol=1e-8)


def test_moordyn_writes_the_same_at_rest(tmp_path):
    """MoorDyn, started at our rest, and after two steps of 1 ms; what rounding of places leaves is 1e-8 of a tension."""
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    known = [name for name in CHANNELS.split() if not name.startswith("Con")]  # of its first version, which the C++ version has not
    file, fairlead = tmp_path / "hose.txt", [30.0, 2.0, -2.0]
    file.write_text(DECK.replace(CHANNELS, " ".join(known)).replace("L9N1px L1N9px Con2ax Body1px", ""))
    deck = deck_from_text(DECK, like_moordyn=True)
    rest = equilibrium(deck.scene)
    with silence():
        engine = moordyn.Create(str(file))
        try:
            moordyn.Init_NoIC(engine, fairlead, [0.0] * 3)
            (tmp_path / "state").write_bytes(state_file(problem(deck.scene, 1.0, 1.0, rest)))
            moordyn.LoadState(engine, str(tmp_path / "state"))
            for k in range(2):
                moordyn.Step(engine, fairlead, [0.0] * 3, k * 1e-3, 1e-3)
        finally:
            moordyn.Close(engine)
    names, _, *rows = [line.split() for line in (tmp_path / "hose.out").read_text().splitlines() if line.strip()]
    theirs = dict(zip(names[1:], map(float, rows[-1][1:]), strict=True))
    ours = outputs(deck, simulate(deck.scene, 0.05, method="edmc", dt=0.05)).columns
    assert len(theirs) > 8
    for name, value in theirs.items():
        assert ours[name][0] == pytest.approx(value, rel=1e-6, abs=1e-3), name
