"""Bottoms of MoorDyn files that are not flat: both forms of their tables, written and read again, and what is refused."""

import numpy as np
import pytest

from anet_lumped import SceneError, equilibrium, read_moordyn, save_moordyn
from anet_lumped.effects import CableFrictionMap, Ground, GroundMap
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError

DECK = """\
a chain that lies on a slope
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
chain 0.05 40 4e7 -0.8 0 1.5 1 0.3 0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 0 0 -20 0 0 0 0
2 Coupled 75 0 -2 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 chain 1 2 80 16 -
--- OPTIONS ---
{OPTION}
2e5 kBot
2e4 cBot
0.4 FrictionCoefficient
--- OUTPUTS ---
--- need this line ---
"""
GRID = "3 2\n-50 50 150\n-9 9\n-50 -9 -25\n50 -9 -15\n150 -9 -5\n-50 9 -25\n50 9 -15\n150 9 -5\n"
DEPTHS = "--- Bathymetry ---\nnGridX 3\nnGridY 2\n -50 50 150\n-9 25 15 5\n9 25 15 5\n"


def read(folder, table=None, option="floor.txt SeafloorFile", **how):
    (folder / "deck.txt").write_text(DECK.format(OPTION=option))
    if table is not None:
        (folder / "floor.txt").write_text(table)
    with pytest.warns(match="deck"):
        return read_moordyn(folder / "deck.txt", **how)


@pytest.mark.parametrize(("table", "option"), [(GRID, "floor.txt SeafloorFile"), (DEPTHS, '"floor.txt" WtrDpth')])
def test_both_forms(tmp_path, table, option):
    deck = read(tmp_path, table, option)
    assert any("presses along its normal" in remark for remark in deck.remarks)
    scene = deck.scene
    floor = next(effect for effect in scene.effects if isinstance(effect, GroundMap))
    expected = GroundMap((-50, 50, 150), (-9, 9), ((-25, -25), (-15, -15), (-5, -5)), 2e5, 2e4, 0.4)
    assert floor == expected
    rest = equilibrium(scene)
    above = rest.shape("line1")[:, 2] - [floor.height_at(x, y) for x, y, _ in rest.shape("line1")]
    assert (above < 0.01).sum() > 5 and above.min() > -0.1  # it lies along the slope
    save_moordyn(scene, tmp_path / "again.txt")
    with pytest.warns(match="again"):
        assert read_moordyn(tmp_path / "again.txt").scene == scene


def test_no_seafloor_is_a_flat_bottom(tmp_path):
    scene = read(tmp_path, None, "- SeafloorFile\n25 WtrDpth").scene
    assert next(effect for effect in scene.effects if isinstance(effect, Ground)).height == -25.0


@pytest.mark.parametrize(
    ("table", "says"),
    [
        (None, r"line 16, .*a seafloor must be in a readable file, but floor.txt"),
        (GRID.replace("50 9 -15\n", ""), r"a seafloor must have a height at each place of its grid, but has none at \(50.0, 9.0\)"),
        (GRID.replace("50 9 -15", "51 9 -15"), r"rows of a seafloor must be a place x and a place y of its grid .*is 51 9 -15"),
        (GRID.replace("-50 50 150", "-50 50"), r"must begin with the numbers of places x and y, the places x and the places y"),
        (GRID.replace("-15", "deep"), r"a seafloor must be numbers, but has 50 -9 deep"),
        (DEPTHS.replace("nGridY", "rows"), r"must begin with a title, nGridX and nGridY, or with the numbers of places"),
        (
            DEPTHS.replace("9 25 15 5\n", "9 25 15\n"),
            r"must have nGridX places x and then nGridY rows of",
        ),
        (DEPTHS.replace("-50 50 150", "50 -50 150"), r"Argument `x` must be two or more places \[m\] that grow"),
    ],
)
def test_refused(tmp_path, table, says):
    (tmp_path / "deck.txt").write_text(DECK.format(OPTION="floor.txt SeafloorFile"))
    if table is not None:
        (tmp_path / "floor.txt").write_text(table)
    with pytest.raises(DeckError, match=says):
        read_moordyn(tmp_path / "deck.txt")


def test_other_laws_and_two_bottoms_are_refused(tmp_path):
    (tmp_path / "deck.txt").write_text(DECK.format(OPTION="floor.txt SeafloorFile"))
    (tmp_path / "floor.txt").write_text(GRID)
    with pytest.raises(DeckError, match=r"line 16, .*it must be read without like_moordyn"):
        read_moordyn(tmp_path / "deck.txt", like_moordyn=True)
    (tmp_path / "deck.txt").write_text(DECK.format(OPTION="../floor.txt SeafloorFile"))
    with pytest.raises(DeckError, match=r"a table must be in the folder of its deck"):
        read_moordyn(tmp_path / "deck.txt")
    scene = read(tmp_path, GRID).scene
    two = type(scene)(scene.points, scene.cables, (*scene.effects, Ground(-30.0)))
    with pytest.raises(SceneError, match=r"must have one bottom to be written for MoorDyn, but it has Ground and GroundMap"):
        save_moordyn(two, tmp_path / "two.txt")
    assert np.isfinite(equilibrium(scene).residual)


LEVEL = """\
--- LINE TYPES ---
h
h
rope 0.1 9 1e6 1 0 1 1 0 0
--- POINTS ---
h
h
1 Fixed 0 0 -9 0 0 0 0
2 Fixed 9 0 -9 0 0 0 0
--- LINES ---
h
h
1 rope 1 2 12 4 -
--- OPTIONS ---
sea.txt SeafloorFile
0.3 MU_KT
--- OUTPUTS ---
"""


def test_friction_that_differs_along_and_across(tmp_path):
    (tmp_path / "sea.txt").write_text("2 2\n-50 50\n-50 50\n-50 -50 -20\n-50 50 -20\n50 -50 -20\n50 50 -25\n")
    floor, friction = deck_from_text(LEVEL, folder=tmp_path).scene.effects[-2:]
    assert isinstance(floor, GroundMap) and floor.friction == 0.0
    assert friction == CableFrictionMap(0.0, 0.3, floor.x, floor.y, floor.heights, floor.stiffness)
