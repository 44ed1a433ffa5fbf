"""Tables in place of numbers in the line types of MoorDyn files: of EI, and of BA."""

import numpy as np
import pytest
from beside_moordyn import begun, march, nodes_of_line

from anet_lumped import State, read_moordyn, save_moordyn, simulate
from anet_lumped.effects import Bending, MomentCurvature
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError

DECK = """\
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope 0.05 5 1e6 1e3 bend.txt 0 0 0 0
stiff 0.05 5 1e6 1e3 40 0 0 0 0
--- ROD TYPES ---
TypeName Diam Mass/m Cd Ca CdEnd CaEnd
(name) (m) (kg/m) (-) (-) (-) (-)
post 0.1 10 0 0 0 0
--- RODS ---
ID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs RodOutputs
(#) (name) (#/key) (m) (m) (m) (m) (m) (m) (-) (-)
1 post Fixed 0 5 -9 0 5 -10 2 -
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 0 0 -10 0 0 0 0
2 Fixed 2 0 -10 0 0 0 0
3 Fixed 2 5 -10 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (ID) (ID) (m) (-) (-)
1 rope 1 2 3 24 -
--- OPTIONS ---
0 rho
100 WtrDpth
0 kBot
0 cBot
9.81 g
--- OUTPUTS ---
--- need this line ---
"""
TABLE = "bending\ncurvature moment\n(1/m) (Nm)\n0 0\n0.5 20\n3 40"


def read(folder, *changes, table=TABLE):
    if table is not None:
        (folder / "bend.txt").write_text(table)
    deck = DECK
    for old, new in changes:
        assert deck.count(old) == 1, old
        deck = deck.replace(old, new)
    return deck_from_text(deck, folder=folder)


def test_a_table_of_EI_is_a_curve(tmp_path):
    scene = read(tmp_path).scene
    assert scene.cables[0].EI == 0.0
    assert scene.effects[1:] == (MomentCurvature({"line1": ((0.5, 20.0), (3.0, 40.0))}),)


def test_it_stands_beside_numbers_and_is_clamped_at_rods(tmp_path):
    more = ("1 rope 1 2 3 24 -", "1 rope R1B 2 9 24 -\n2 stiff 1 3 9 24 -\n3 rope 2 3 9 24 -")
    bending, curves = read(tmp_path, more).scene.effects[1:]
    assert bending == Bending() and set(dict(curves.curves)) == {"line1", "line3"}
    assert curves.clamped == (("rod1.b", (0.0, 0.0, -1.0)),)


def test_it_is_written_and_read_back(tmp_path):
    scene = read(tmp_path, ("1 rope 1 2 3 24 -", "1 rope 1 2 3 24 -\n2 stiff 1 3 9 24 -")).scene
    save_moordyn(scene, tmp_path / "written.txt")
    assert read_moordyn(tmp_path / "written.txt").scene == scene


@pytest.mark.parametrize(
    ("changes", "table", "message"),
    [
        ((), None, r"line 4, .*EI must be a number or the name of a readable file, but bend\.txt"),
        ((), "a b\n0 0\n1 x\n", r"line 4, .*rows of .*bend\.txt must be a curvature and a moment, but one is \"1 x\""),
        ((), "a b\n0 0\n1 2\n1 3\n", r"line 4, .*Curvatures of `curves` must increase"),
        (
            (("1e3 bend.txt", "damp.txt bend.txt"),),
            TABLE,
            r"line 4, .*BA/-zeta must be a number; from damp\.txt, a table in a file, MoorDyn finds",
        ),
        ((("bend.txt", "../bend.txt"),), TABLE, r"line 4, .*a table must be in the folder of its deck"),
    ],
)
def test_refusals(tmp_path, changes, table, message):
    with pytest.raises(DeckError, match=message):
        read(tmp_path, *changes, table=table)


def test_moordyn_bends_as_we_do(tmp_path):
    """From where MoorDyn starts, 0.2 s on. Its moment is M, here M cos of half of the angle between segments, 0.1 rad: with 12
    segments they differ by 13 % of the way, with 24 by 3 % and with 36 by 1.5 %."""
    quiet = "--- OPTIONS ---\n5e-5 dtM\nRK4 tScheme\n0 TmaxIC\n1 disableOutput\n0 writeLog"
    scene = read(tmp_path, ("--- OPTIONS ---", quiet)).scene
    (tmp_path / "deck.txt").write_text(DECK.replace("--- OPTIONS ---", quiet))
    with begun(tmp_path / "deck.txt") as (moordyn, engine):
        start = np.array(nodes_of_line(moordyn, engine, 24))
        march(moordyn, engine, 0.2, 0.01)
        end = np.array(nodes_of_line(moordyn, engine, 24))
    run = simulate(scene, 0.2, method="edmc", dt=5e-4, start=State.of(scene, shapes={"line1": start}))
    way = np.abs(end - start).max()
    assert way > 0.02 and np.abs(run.shape("line1")[-1] - end).max() < 0.04 * way
