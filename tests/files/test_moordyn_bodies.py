"""Bodies that move by themselves in MoorDyn files: read, written and read back."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from beside_moordyn import places_of_points
from slow import slow

from anet_lumped import Body, Cable, Driven, Fixed, Scene, SceneError, paths, simulate
from anet_lumped.effects import Gravity, MoordynBottom, Water
from anet_lumped.files.moordyn_channels import outputs
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError
from anet_lumped.files.moordyn_writer import moordyn_text, save_moordyn

DECK = """\
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
hose 0.2 45 3.1e7 -0.6 0 1.1 1.0 0.02 0
--- BODIES ---
ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca
(#) (-) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m^2) (m^3) (m^2) (-)
1 Free 1 2 -5 10 20 30 900 0.5 400|500|600 0.3 2|0 0.5|0.6|0.7
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 62 0 -41 0 0 0 0
3 Body1 4 1 -6 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 hose 1 3 70 14 -
--- OPTIONS ---
41 WtrDpth
--- OUTPUTS ---
--- need this line ---
"""


def read(*changes, **how):
    deck = DECK
    for old, new in changes:
        assert deck.count(old) == 1, old
        deck = deck.replace(old, new)
    return deck_from_text(deck, **how)


def test_a_free_body():
    """MoorDyn 2.7.2 has point 3 of such a body at (1.7332, 5.9776, -11.0532) m."""
    deck = read()
    (body,) = deck.scene.bodies
    assert (body.name, body.mass, body.inertia, body.volume, body.pinned) == ("body1", 900.0, (400.0, 500.0, 600.0), 0.3, None)
    assert (body.CdA, body.CdA_rotation, body.Ca) == ((2.0, 2.0, 2.0), (0.0, 0.0, 0.0), (0.5, 0.6, 0.7))
    assert body.centre_of_mass == body.centre_of_buoyancy == (0.0, 0.0, 0.5)
    assert deck.points == {1: "point1", 3: "body1.point3"} and deck.scene.cables[0].end == "body1.point3"
    assert np.allclose(deck.scene.point("body1.point3").at, (1.7332, 5.9776, -11.0532), atol=5e-5)  # noted to 1e-4


@pytest.mark.parametrize(
    ("words", "along", "turning"),
    [
        ("2", (2, 2, 2), (2, 2, 2)),
        ("1|2|3", (1, 2, 3), (1, 2, 3)),
        ("2|5", (2, 2, 2), (5, 5, 5)),
        ("1|2|3|4|5|6", (1, 2, 3), (4, 5, 6)),
    ],
)
def test_drag_along_and_about_axes(words, along, turning):
    """As the documentation of MoorDyn has it of one, two, three and six numbers."""
    (body,) = read((" 2|0 0.5", f" {words} 0.5")).scene.bodies
    assert (body.CdA, body.CdA_rotation) == (along, turning)


@pytest.mark.parametrize("word", ["CoupledPinned", "VesselPinned", "CpldPin"])
def test_a_pinned_body(word):
    scene = read(("1 Free", f"1 {word}")).scene
    assert scene.bodies == (replace(read().scene.bodies[0], pinned="", pinned_to="body1.pin"),)
    assert scene.point("body1.pin") == Driven("body1.pin", paths.external((1.0, 2.0, -5.0)))


@pytest.mark.parametrize(
    ("change", "remark"),
    [
        (("Free", "Free"), 'Added mass of body "body1" acts at its centre of gravity, as its buoyancy does; MoorDyn has it at the'),
        (("Free", "Free"), "Bodies with a volume float at the surface, where MoorDyn has them under water always; read_moordyn("),
    ],
)
def test_what_is_said(change, remark):
    assert any(said.startswith(remark) for said in read(change).remarks)
    quiet = read(("2|0 0.5|0.6|0.7", "2|0 0"), like_moordyn=True).remarks
    assert not any(said.startswith(remark) for said in quiet)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("4 1 -6 0 0 0 0", '4 1 -6 0 0 0 0 ! name: ""'), r"line 13, .*must have a name, or be at the origin of the body"),
    ],
)
def test_refusals(change, message):
    with pytest.raises(DeckError, match=message):
        read(change)


def crate(**fields):
    arms = {"a": (1.0, 0.0, 0.0), "b": (-1.0, 0.0, 0.5)}
    centre = (0.1, 0.0, 0.2)
    usual = {"mass": 1000.0, "inertia": (500.0, 600.0, 700.0), "at": (1.0, 2.0, -20.0), "centre_of_mass": centre}
    usual |= {"volume": 0.5, "centre_of_buoyancy": centre, "CdA": (1.0, 2.0, 3.0), "Ca": (0.5, 0.6, 0.7)}
    usual |= {"attachments": arms, "rotation": (0.3, -0.2, 0.5)}
    return Body("crate", **(usual | fields))


def scene_of(body):
    kind = {"length": 31.0, "segments": 4, "mass_per_length": 10.0, "EA": 1e6, "zeta": 0.4, "diameter": 0.05}
    kind |= {"compression": "damped"}
    cables = [Cable("l", "crate.a", **kind), Cable("r", "crate.b", **kind), Cable("u", "crate", **kind)]
    points = [Fixed("l", (20.0, 0.0, 0.0)), Fixed("r", (-20.0, 0.0, 0.0)), Fixed("u", (0.0, 20.0, 0.0))]
    effects = [Gravity(9.81), Water(1000.0, points_float=False), MoordynBottom(-200.0, stiffness=3e5, damping=3e4)]
    return Scene(points, cables, effects, bodies=[body])


@pytest.mark.parametrize("fields", [{}, {"inertia": ((500, 0, 0), (0, 600, 0), (0, 0, 700))}])
def test_a_body_is_written_and_read_back(fields):
    scene = scene_of(crate(**fields))
    back = deck_from_text(moordyn_text(scene), like_moordyn=True).scene
    assert (back.points, back.cables, back.effects) == (scene.points, scene.cables, scene.effects)
    assert np.allclose(back.bodies[0].rotation, scene.bodies[0].rotation, rtol=1e-14)  # of angles and back
    assert replace(back.bodies[0], rotation=(0.3, -0.2, 0.5)) == crate(**fields | {"inertia": (500.0, 600.0, 700.0)})


@pytest.mark.parametrize(("CdA", "told"), [((1.0, 2.0, 3.0), 1), ((2.0, 2.0, 2.0), 0)])
def test_drag_that_moordyn_passes_over_is_told(tmp_path, CdA, told):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        save_moordyn(scene_of(crate(CdA=CdA)), tmp_path / "crate.txt")
    assert len(caught) == told and all("passes over the first CdA" in str(each.message) for each in caught)


def test_a_driven_body_is_coupled():
    path, turning = paths.line((1.0, 2.0, -20.0), (0.1, 0.0, 0.0), 1.0), paths.line((0.0, 0.0, 0.4), (0.1, 0.0, 0.0), 1.0)
    scene = scene_of(crate(at=None, path=path, turning=turning))
    back = deck_from_text(moordyn_text(scene), like_moordyn=True).scene
    for name, number in (("crate", 4), ("crate.a", 5), ("crate.b", 6)):
        at = back.points[number - 1].path.at(0.0)[0]
        assert np.allclose(at, scene.point(name).path.at(0.0)[0], rtol=0.0, atol=1e-13)  # of 20 m


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"pinned": "a"}, r'A body must be pinned at its origin to be written for MoorDyn, but body "crate" is pinned at "a"'),
        ({"volume": 0.0, "hull": (1.0, 1.0, 1.0)}, r"must have no `hull` .* has hull="),
        ({"contact_area": 1.0}, r"must have no `contact_area` .* has contact_area=1"),
        ({"inertia": ((5, 1, 0), (1, 5, 0), (0, 0, 5))}, r"must have moments of inertia along its axes"),
        ({"centre_of_buoyancy": (0, 0, 0)}, r"must have its centre of buoyancy at its centre of mass"),
    ],
)
def test_bodies_that_moordyn_does_not_have(fields, message):
    with pytest.raises(SceneError, match=message):
        moordyn_text(scene_of(crate(**fields)))


@pytest.mark.parametrize("in_water", [*slow(False), True], ids=["in air", "in water"])
def test_moordyn_moves_a_body_as_we_do(tmp_path, in_water):
    """MoorDyn's equations lack the gyroscopic moment and the pull of a centre of gravity that circles, so a ball is turned here.

    Cables of one light segment start alike in both. 0.1 ms of MoorDyn's and 1 ms of ours leave 1e-6 m of a way of 2.5 m; the 10 g/m
    of the cables are points that circle, of which MoorDyn's mass matrix lacks the pull: 0.5 kg of 1000, 1e-5 of it after 1 s.
    """
    fluid = {"volume": 0.4, "Ca": (0.5, 0.6, 0.7)} if in_water else {"volume": 0.0, "Ca": (0.0, 0.0, 0.0)}
    ball = {"inertia": (600.0, 600.0, 600.0), "CdA": (0.0, 0.0, 0.0)}
    origin = (0.0, 0.0, 0.0)
    scene = scene_of(crate(centre_of_mass=origin, centre_of_buoyancy=origin, **ball, **fluid))
    light = {"length": 25.0, "segments": 1, "EA": 2e4, "mass_per_length": 0.01, "diameter": 0.01, "Cdn": 0.0, "Cdt": 0.0}
    cables = [replace(cable, **light, Can=0.0, Cat=0.0) for cable in scene.cables]
    without_bottom = [effect for effect in scene.effects if not isinstance(effect, MoordynBottom)]  # which holds up no bodies
    scene = Scene(scene.points, cables, without_bottom if in_water else [Gravity(9.81)], bodies=scene.bodies)
    deck = tmp_path / "ball.txt"
    save_moordyn(scene, deck, {"dtM": 1e-4, "TmaxIC": 0, "tScheme": "RK4", "disableOutput": 1, "writeLog": 0})
    places = places_of_points(deck, 1.0, (4, 5, 6))
    ours = simulate(scene, 1.0, method="rk4", dt=0.001, start="straight").final
    way = np.linalg.norm(ours.position("crate") - scene.bodies[0].at)
    assert way > 0.5
    for name, place in zip(("crate", "crate.a", "crate.b"), places, strict=True):
        assert np.allclose(ours.position(name), place, rtol=0.0, atol=5e-5 * way)


def test_channels_of_a_point_on_a_body():
    """At rest the line's end pulls at the point as hard as the channel of the line says."""
    deck = read(
        ("2|0 0.5|0.6|0.7", "0 0"),
        ("--- OUTPUTS ---", "--- OUTPUTS ---\nCon3px Con3T FairTen1"),
        ("41 WtrDpth", "41 WtrDpth\n9.81 g"),
    )
    run = simulate(deck.scene, 0.05, method="rk4", dt=1e-3)
    columns = outputs(deck, run).columns
    assert np.array_equal(columns["Con3px"], run.position("body1.point3")[:, 0])
    assert columns["FairTen1"].min() > 0.0 and np.allclose(columns["Con3T"], columns["FairTen1"], rtol=1e-12)  # one sum
