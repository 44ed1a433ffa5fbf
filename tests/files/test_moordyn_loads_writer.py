"""Forces, dampers and friction along and across cables, written for MoorDyn's Fortran version and read again."""

from dataclasses import replace

import pytest

from anet_lumped import SceneError, paths, simulate
from anet_lumped.effects import AppliedForces, CableFriction, CableFrictionMap, Dashpots, Ground, GroundMap, MoordynBottom
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_writer import moordyn_text, save_moordyn

DECK = """a buoy and a body
--- LINE TYPES ---
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope 0.05 5 1e6 -0.8 0 1 1 0 0
--- BODIES ---
h
h
1 Free 20 0 -6 0 0 0 50 0 5 0 0 0
--- POINTS ---
ID Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 0 0 -1 0 0 0 0
2 Free 0 0 -5 50 0 0 0
3 Fixed 20 0 -1 0 0 0 0
4 Body1 0 0 1 0 0 0 0
--- LINES ---
ID Type NodeA NodeB Length Segs Flags
(-) (-) (-) (-) (m) (-) (-)
1 rope 1 2 5 3 -
2 rope 3 4 5 3 -
--- EXTERNAL LOADS ---
ID Object Fext Blin Bquad CSys
(#) (name) (N) (Ns/m) (Ns^2/m^2) (-)
1 Point2 9|0|-3 4|4|5 0|1|0 -
2 Body1 1|2|3 0 7|8|9 G
3 Body1 0|0|4 1|2|3 0 L
--- OPTIONS ---
60 WtrDpth
2e5 kBot
2e4 cBot
--- OUTPUTS ---
--- need this line ---
"""


def scene_with(*effects):
    """The scene of the deck with other effects in place of its loads, and its bottom if one is among them."""
    scene, grounds = deck_from_text(DECK).scene, (Ground, GroundMap, MoordynBottom)
    own = [one for one in scene.effects if not isinstance(one, AppliedForces | Dashpots)]
    if any(isinstance(one, grounds) for one in effects):
        own = [one for one in own if not isinstance(one, grounds)]
    return replace(scene, effects=(*own, *effects))


def test_loads_are_written_and_read_again(tmp_path):
    scene = deck_from_text(DECK).scene
    with pytest.warns(UserWarning, match=r"MoorDyn's C\+\+ version passes over EXTERNAL LOADS"):
        save_moordyn(scene, tmp_path / "again.txt")
    back = deck_from_text((tmp_path / "again.txt").read_text()).scene
    assert set(back.effects) == set(scene.effects) and back.points == scene.points
    runs = [simulate(one, 0.2, dt=0.01, start="straight") for one in (scene, back)]
    assert (runs[0].q[-1] == runs[1].q[-1]).all()
    assert "EXTERNAL LOADS" not in moordyn_text(scene_with())


FLOOR = {"x": (-90.0, 90.0), "y": (-9.0, 9.0), "heights": ((-30.0, -30.0), (-20.0, -20.0)), "stiffness": 2e5}


@pytest.mark.parametrize(
    "effects",
    [
        (Ground(height=-60.0, stiffness=2e5, damping=2e4, friction=0.0), CableFriction(0.2, 0.7, height=-60.0, stiffness=2e5)),
        (GroundMap(**FLOOR, damping=2e4, friction=0.0), CableFrictionMap(0.2, 0.7, **FLOOR)),
    ],
    ids=["level", "map"],
)
def test_friction_along_and_across_is_written_and_read_again(tmp_path, effects):
    scene = scene_with(*effects)
    with pytest.warns(UserWarning, match=r"MoorDyn's C\+\+ version passes over MU_KT and MU_KA"):
        save_moordyn(scene, tmp_path / "again.txt")
    back = deck_from_text((tmp_path / "again.txt").read_text(), folder=tmp_path).scene
    assert set(back.effects) == set(scene.effects)


RUBBED = MoordynBottom(height=-60.0, stiffness=2e5, damping=2e4)


@pytest.mark.parametrize(
    ("effects", "message"),
    [
        (
            [AppliedForces(torque={"body1": (1, 0, 0)})],
            r'must be forces to be written for MoorDyn, but there is a torque on "body1"',
        ),
        (
            [AppliedForces({"point2": paths.line((0, 0, 0), (1, 0, 0), 1.0)})],
            r'must be constant .*, but that on "point2" is a path',
        ),
        ([AppliedForces(force_in_body={"body1.point4": (1, 0, 0)})], r'must be on the origin of one .* "body1.point4"'),
        ([Dashpots({"point2": (1, 2)})], r'must have three numbers .*, but that at "point2" has two'),
        ([CableFriction(0.2, 0.7, height=-60.0, stiffness=1e5)], r"CableFriction must be on the ground of the scene"),
        ([RUBBED, CableFriction(0.2, 0.7, height=-60.0, stiffness=2e5)], r"CableFriction must be on the ground of the scene"),
    ],
)
def test_what_a_file_has_no_place_for(effects, message):
    with pytest.raises(SceneError, match=message):
        moordyn_text(scene_with(*effects))
