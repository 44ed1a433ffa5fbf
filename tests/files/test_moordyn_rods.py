"""Rods in MoorDyn files: read, written and read back."""

from dataclasses import replace

import pytest

from anet_lumped import Body, Cable, Driven, Fixed, Free, Release, Rod, Scene, SceneError, equilibrium, paths, rod_body
from anet_lumped.effects import Bending, Gravity, Water
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError
from anet_lumped.files.moordyn_writer import moordyn_text

ROD = "1 pole Free -10 0 -75 10 0 -75 4 -"
TYPE = "pole 0.25 77.7 1.6 1.0 1.5 0.9"
BODY = "--- BODIES ---\nh\nh\n1 Free 0 0 -75 0 90 0 900 0 400 0 0 0\n--- POINTS"
DECK = f"""\
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope 0.09 77.7 384.243E6 -0.3 0 1.6 1.0 0.1 0.0
--- ROD TYPES ---
TypeName Diam Mass/m Cd Ca CdEnd CaEnd
(name) (m) (kg/m) (-) (-) (-) (-)
{TYPE}
--- RODS ---
ID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs RodOutputs
(#) (name) (#/key) (m) (m) (m) (m) (m) (m) (-) (-)
{ROD}
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed -450 0 0 0 0 0 0
2 Fixed 450 0 0 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 rope 1 R1A 450 4 -
2 rope 2 Rod1b 450 4 -
--- OPTIONS ---
150 WtrDpth
--- OUTPUTS ---
--- need this line ---
"""
OF_ROD = {"diameter": 0.25, "mass_per_length": 77.7, "segments": 4, "Cdn": 1.6, "Can": 1.0, "Cdt": 0.0, "Cat": 0.0}
OF_ROD |= {"Cd_end": 1.5, "Ca_end": 0.9}


def read(*changes):
    deck = DECK
    for old, new in changes:
        assert deck.count(old) == 1, old
        deck = deck.replace(old, new)
    return deck_from_text(deck)


@pytest.mark.parametrize(("word", "pinned"), [("Free", None), ("Pinned", "a"), ("Pin", "a")])
def test_a_rod_that_moves_is_a_body(word, pinned):
    deck = read((ROD, ROD.replace("Free", word)))
    assert deck.scene.bodies == (rod_body("rod1", (-10.0, 0.0, -75.0), (10.0, 0.0, -75.0), pinned=pinned, **OF_ROD),)
    assert [cable.end for cable in deck.scene.cables] == ["rod1.a", "rod1.b"] and deck.points == {1: "point1", 2: "point2"}
    assert ('End A of rod "rod1" stays where it is, while the rod turns about it.' in deck.remarks) == (pinned is not None)


@pytest.mark.parametrize(("word", "is_fixed"), [("Fixed", True), ("Anchor", True), ("Coupled", False), ("Vessel", False)])
def test_ends_of_a_rod_that_others_move_are_points(word, is_fixed):
    deck = read((ROD, ROD.replace("Free", word)))
    for name, x in (("rod1.a", -10.0), ("rod1.b", 10.0)):
        at = (x, 0.0, -75.0)
        assert deck.scene.point(name) == (Fixed(name, at) if is_fixed else Driven(name, paths.external(at)))
    assert not deck.scene.bodies
    assert 'Rod "rod1" does not move by itself: lines are held at its ends, and no load on it is computed.' in deck.remarks


def test_a_rod_on_a_body_that_moves_is_part_of_it():
    deck = read(("--- POINTS", BODY), (ROD, "1 pole Body1 0 0 -10 0 0 10 4 -"))
    (body,) = deck.scene.bodies
    assert body.rods == (Rod("rod1", (0.0, 0.0, -10.0), (0.0, 0.0, 10.0), **OF_ROD),) and body.mass == 900.0
    assert body.attachments == (("rod1.a", (0.0, 0.0, -10.0)), ("rod1.b", (0.0, 0.0, 10.0)))
    assert deck.scene.cables[0].end == "body1.rod1.a"
    assert deck.scene.point("body1.rod1.a").at == pytest.approx((-10.0, 0.0, -75.0), abs=1e-12)  # of 75 m, turned by 90 degrees


def test_a_rod_may_be_all_that_a_body_weighs():
    deck = read(("--- POINTS", BODY.replace("900 0 400", "0 0 0")), (ROD, "1 pole Body1 0 0 -10 0 0 10 4 -"))
    assert deck.scene.bodies[0].mass is None and deck.scene.bodies[0].whole.total == pytest.approx(20 * 77.7, rel=1e-14)


@pytest.mark.parametrize("word", ["Body1Pinned", "Body1Pin"])
@pytest.mark.parametrize("frame", ["Free", "Fixed", "Coupled"])
def test_a_rod_that_turns_on_a_body(word, frame):
    """On one that moves by itself it is pinned to an attachment, on one that others move to a driven point, or to its place."""
    deck = read(("--- POINTS", BODY.replace("Free", frame)), (ROD, f"1 pole {word} 0 0 -10 0 0 10 4 -"))
    pole = deck.scene.body("rod1")
    assert pole.rods[0].diameter == 0.25 and deck.scene.cables[0].end == "rod1.a"
    assert pole.at == pytest.approx((-10.0, 0.0, -75.0), abs=1e-12)  # of 75 m, turned by 90 degrees
    assert deck.scene.point("rod1.b").at == pytest.approx((10.0, 0.0, -75.0), abs=1e-12)
    if frame == "Fixed":
        assert (pole.pinned, pole.pinned_to) == ("a", None)
    elif frame == "Free":
        body = deck.scene.body("body1")
        assert (pole.pinned, pole.pinned_to) == ("a", "body1.rod1") and body.attachments == (("rod1", (0.0, 0.0, -10.0)),)
        assert not body.rods and 'End A of rod "rod1" is pinned to "body1.rod1", and the rod turns about it.' in deck.remarks
    else:
        assert pole.pinned_to == "rod1.pin" and isinstance(deck.scene.point("rod1.pin"), Driven)


@pytest.mark.parametrize("word", ["Fixed", "Coupled"])
def test_ends_of_a_rod_on_a_body_that_others_move_are_points(word):
    deck = read(("--- POINTS", BODY.replace("Free", word)), (ROD, "1 pole Body1 0 0 -10 0 0 10 4 -"))
    point = deck.scene.point("rod1.a")
    assert isinstance(point, Fixed if word == "Fixed" else Driven)
    at = point.at if word == "Fixed" else point.path.at(0.0)[0]
    assert at == pytest.approx((-10.0, 0.0, -75.0), abs=1e-12)  # of 75 m, turned by 90 degrees


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ([("Rod1b", "Rod2b")], r"line 22, .*a line must end at a rod in RODS, but Rod2b is none"),
        ([(ROD, f"{ROD}\n{ROD}")], r"line 13, .*a rod must come once, but 1 comes again"),
        (
            [(ROD, "1 pole Loose -10 0 -75 10 0 -75 4 -")],
            r"line 12, .*a rod must be Free, Pinned, Fixed, Coupled, CoupledPinned",
        ),
        ([(ROD, "1 pole Free -10 0 -75 10 0 -75 4")], r"line 12, .*a rod must have 11 columns .* but has 10"),
        ([(ROD, "1 mast Free -10 0 -75 10 0 -75 4 -")], r'line 12, .*must be of a type in ROD TYPES, but "mast" is none'),
        ([(ROD, "1 pole Free -10 0 -75 10 0 -75 1.5 -")], r"line 12, .*NumSegs must be an integer of at least 0"),
        ([(ROD, "1 pole Free -10 0 -75 -10 0 -75 4 -")], r"line 12, .*A rod must have a length"),
        ([(ROD, "1 pole Body2 -10 0 -75 10 0 -75 4 -")], r"line 12, .*a rod must be on a body in BODIES, but body 2 is not there"),
        ([(TYPE, "pole 0.25 77.7 1.6 1.0 1.5")], r"line 8, .*a type of rods must have 7 columns .* but has 6"),
    ],
)
def test_refusals(changes, message):
    with pytest.raises(DeckError, match=message):
        read(*changes)


def scene_of(*rods, **fields):
    cables = [
        Cable(f"p{end}", f"spar.{end}", length=8.0, segments=4, EA=1e5, mass_per_length=1.0, diameter=0.1, compression="damped")
        for end in "ab"
    ]
    body = rod_body("spar", (0.0, 0.0, -20.0), (3.0, 0.0, -24.0), **(OF_ROD | fields))
    points = [Fixed("pa", (-5.0, 0.0, -15.0)), Fixed("pb", (8.0, 0.0, -18.0))]
    return Scene(points, cables, [Gravity(9.81), Water(1000.0)], bodies=[body])


def deck_with_poles(**first):
    """A deck with two poles that turn at it, and a line at one of them."""
    deck = Body(
        "deck", mass=900.0, inertia=(400.0, 500.0, 600.0), at=(0.0, 1.0, -20.0), rotation=(0.1, 0.2, -0.3),
        attachments={"hinge": (1.0, 0.0, 0.5), "eye": (-1.0, 0.0, 0.0)},
    )  # fmt: skip
    points = [Fixed("pa", (-5.0, 0.0, -15.0)), Fixed("pb", (8.0, 0.0, -18.0))]
    line = dict(length=8.0, segments=4, EA=1e5, mass_per_length=1.0, diameter=0.1, compression="damped")
    cables = [Cable("pa", "deck.eye", **line), Cable("pb", "pole.b", **line)]
    at = Scene([Fixed("far", (0, 0, 0)), *points], [Cable("far", "deck", **line)], bodies=[deck]).point("deck.hinge").at
    end = (at[0] + 1.0, at[1] - 0.5, at[2] + 4.0)
    pole = rod_body("pole", at, end, **dict(OF_ROD, pinned="a", pinned_to="deck.hinge") | first)
    spar = rod_body("spar", deck.at, (deck.at[0], deck.at[1] + 2.0, deck.at[2] - 3.0), **OF_ROD, pinned="a", pinned_to="deck")
    return Scene(points, cables, [Gravity(9.81), Water(1000.0)], bodies=[pole, deck, spar])


def test_rods_that_turn_on_a_body_are_written_and_read_back():
    scene = deck_with_poles()
    text = moordyn_text(scene)
    assert "Body1Pinned 1.0 0.0 0.5 " in text and " 2 R1B 8.0 4 " in text
    back = deck_from_text(text).scene
    assert back.cables == scene.cables and back.points == scene.points
    for given in scene.bodies:
        body = back.body(given.name)
        assert (body.rods, body.attachments, body.pinned, body.pinned_to) == (
            given.rods,
            given.attachments,
            given.pinned,
            given.pinned_to,
        )
        assert body.rotation == pytest.approx(given.rotation, abs=1e-13) and body.at == pytest.approx(given.at, abs=1e-13)


@pytest.mark.parametrize("given", [{"pinned": "b", "pinned_to": "deck.hinge"}, {"pinned_to": "pb"}])
def test_what_else_is_pinned_is_not_written(given):
    scene = deck_with_poles()
    pole = replace(scene.bodies[0], at=None, **given)
    with pytest.raises(
        SceneError, match=r'must be one rod, as `rod_body` makes it, pinned at its end "a" to a body .*"pole" is otherwise'
    ):
        moordyn_text(replace(scene, bodies=[pole, *scene.bodies[1:]]))


def test_a_rod_is_written_and_read_back():
    scene = scene_of()
    back = deck_from_text(moordyn_text(scene)).scene
    assert (back.points, back.cables, back.effects) == (scene.points, scene.cables, scene.effects)
    (body,), (given,) = back.bodies, scene.bodies
    assert (body.rods, body.attachments, body.at, body.mass) == (given.rods, given.attachments, given.at, None)
    assert body.rotation == pytest.approx(given.rotation, abs=1e-14)  # of angles and back


def test_a_pinned_rod_is_written_and_read_back():
    """MoorDyn's body has its place from outside, so that it comes back pinned to a driven point."""
    scene = deck_from_text(moordyn_text(scene_of(pinned="a"))).scene
    assert (scene.bodies[0].pinned, scene.bodies[0].pinned_to) == ("", "spar.pin")
    assert scene.point("spar.pin") == Driven("spar.pin", paths.external((0.0, 0.0, -20.0)))


@pytest.mark.parametrize("field", ["Cdt", "Cat"])
def test_what_moordyns_rods_do_not_have(field):
    with pytest.raises(SceneError, match=r'A rod must have Cdt=0 and Cat=0 to be written .* but "rod" of body "spar" has Cdt='):
        moordyn_text(scene_of(**{field: 0.1}))


STIFF = (
    ("384.243E6 -0.3 0 ", "384.243E6 -0.3 1.0E7 "),
    (ROD, "1 pole Fixed -20 0 50 -10 0 50 4 -"),
    ("1 rope 1 R1A 450 4 -\n2 rope 2 Rod1b 450 4 -", "1 rope R1B 3 10 20 -"),
    ("2 Fixed 450 0 0 0 0 0 0", "2 Fixed 450 0 0 0 0 0 0\n3 Free 0 0 50 0 0 0 0"),
)


def test_a_line_with_an_EI_is_clamped_in_line_with_a_rod_that_is_held():
    """A level beam that sags under its weight by q L^4/(8 EI): 95.2 mm of 10 m."""
    scene = read(*STIFF).scene
    (bending,) = [effect for effect in scene.effects if isinstance(effect, Bending)]
    assert dict(bending.clamped) == {"rod1.b": (10.0, 0.0, 0.0)}
    scene = replace(scene, cables=[replace(scene.cables[0], compression="linear")])
    sag = 50.0 - equilibrium(scene).position("point3")[2]
    assert sag == pytest.approx(77.7 * 9.80665 * 10.0**4 / (8.0 * 1e7), rel=5e-3)  # 20 segments: 1/(2 n)^2, and the slope of 0.013
    with pytest.raises(SceneError, match=r'Bending must clamp nothing to be written for MoorDyn, but it clamps point "rod1\.b"'):
        moordyn_text(scene)


def test_at_end_A_a_line_leaves_the_other_way():
    scene = read(*STIFF[:2], (STIFF[2][0], STIFF[2][1].replace("R1B", "R1A")), STIFF[3]).scene
    assert [dict(effect.clamped) for effect in scene.effects if isinstance(effect, Bending)] == [{"rod1.a": (-10.0, 0.0, 0.0)}]


def test_clamps_that_differ_from_MoorDyn_are_told():
    coupled = read(STIFF[0], (ROD, STIFF[1][1].replace("Fixed", "Coupled")), *STIFF[2:])
    assert any('"line1" is clamped at the end of a rod, whose direction stays' in remark for remark in coupled.remarks)
    free = read(STIFF[0])
    assert any('"line1" turns freely about the end of a rod that moves, where MoorDyn clamps' in remark for remark in free.remarks)
    assert all(not effect.clamped for effect in free.scene.effects if isinstance(effect, Bending))


def test_two_lines_with_an_EI_at_an_end_are_refused():
    two = (STIFF[2][0], STIFF[2][1] + "\n2 rope R1B 1 460 4 -")
    with pytest.raises(DeckError, match="the end of a rod must clamp one line with an EI, but two of them end there"):
        read(*STIFF[:2], two, STIFF[3])


CABLE = """\
--- LINE TYPES ---
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
cable 0.15 40 5e8 -1 2e4 1 1 0 0
--- ROD TYPES ---
Name Diam Mass/m Cd Ca CdEnd CaEnd
(-) (m) (kg/m) (-) (-) (-) (-)
joint 0.14 0 0 0 0 0
--- RODS ---
ID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs RodOutputs
(#) (name) (#/key) (m) (m) (m) (m) (m) (m) (-) (-)
1 joint Fixed 50 0 -60 51 0 -60 0 -
2 joint Free 20 0 -40 20 0 -40 0 -
3 joint Coupled 0 0 -5 0 0 -6 0 -
--- LINES ---
ID Type NodeA NodeB Length Segs Flags
(-) (-) (-) (-) (m) (-) (-)
1 cable R1B R2A 40 8 -
2 cable R2B R3A 45 8 -
--- FAILURE ---
FailureID Point Lines FailTime FailTen
() () (,) (s) (N)
1 r2b 2 3 0
--- OPTIONS ---
60 WtrDpth
--- OUTPUTS ---
"""


def test_rods_without_a_length_are_points():
    """Where end B is given counts for nothing, as in MoorDyn; POINTS may be missing; lines of both ends meet in one point."""
    deck = deck_from_text(CABLE)
    scene = deck.scene
    held = Free("rod2.parted1", at=(20.0, 0.0, -40.0))
    assert scene.all_points == (Fixed("rod1", (50.0, 0.0, -60.0)), Free("rod2", at=held.at), scene.point("rod3"), held)
    assert isinstance(scene.point("rod3"), Driven)
    assert [(cable.start, cable.end) for cable in scene.cables] == [("rod1", "rod2"), ("rod2.parted1", "rod3")]
    said = 'Line 19: lines with an EI may meet at an angle at "rod2", a rod without a length, where MoorDyn joins them without a'
    assert any(remark.startswith(said) for remark in deck.remarks)
    assert scene.events == (Release("rod2.parted1", "rod2", 3.0),)


def test_rods_without_a_length_on_a_body():
    body = (
        "--- BODIES ---\nID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca\n(#) (-)\n"
        "1 Free 0 0 -4 0 0 0 900 0 400|500|600 0 0 0\n--- RODS"
    )
    deck = deck_from_text(CABLE.replace("--- RODS", body).replace("3 joint Coupled 0 0 -5", "3 joint Body1 0 0 -1"))
    assert deck.scene.cables[1].end == "body1.rod3" and deck.scene.point("body1.rod3").at == (0.0, 0.0, -5.0)
    with pytest.raises(DeckError, match=r"line 14, .*a rod must be on a body in BODIES, but body 1 is not there"):
        deck_from_text(CABLE.replace("3 joint Coupled", "3 joint Body1"))


def test_a_rod_that_turns_on_a_body_that_is_held():
    """As one that is pinned at the place of its end A; body 1 lies at (0, 0, -75), turned by 90 degrees about y."""
    body = ("--- POINTS", BODY.replace("1 Free", "1 Fixed"))
    (rod,) = read(body, (ROD, "1 pole Body1Pinned 0 0 -10 0 0 10 4 -")).scene.bodies
    (same,) = read((ROD, ROD.replace("Free", "Pinned"))).scene.bodies
    assert rod.pinned == same.pinned == "a" and rod.at == pytest.approx(same.at, abs=1e-12)


def test_a_number_behind_pinned_is_passed_over():
    assert read((ROD, ROD.replace("Free", "Pinned1"))).scene == read((ROD, ROD.replace("Free", "Pinned"))).scene
