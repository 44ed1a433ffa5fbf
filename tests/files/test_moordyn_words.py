"""What MoorDyn files of many hands have: read as MoorDyn reads them, and said in one warning; what is refused, all at once."""

import pickle

import numpy as np
import pytest

from anet_lumped import Driven, Fixed, Free, Release, SceneError, equilibrium, load_scene, paths, simulate
from anet_lumped.effects import CableFriction, Ground, MoordynBottom, Water
from anet_lumped.files.moordyn_attachments import WORDS, Hold
from anet_lumped.files.moordyn_file import deck_from_text, read_moordyn
from anet_lumped.files.moordyn_findings import DeckError, DeckWarning
from anet_lumped.files.moordyn_writer import moordyn_text

DECK = """\
a hose that hangs from a pontoon
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
hose 0.2 45 3.1e7 -0.6 0 1.1 1.0 0.02 0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 62 0 -41 0 0 0 0
2 Free 30 0 -25 80 0.05 0.1 0.5
3 Coupled 1 2 -3 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 hose 1 2 42 14 -
2 hose 2 3 41 14 -
--- OPTIONS ---
41 WtrDpth
4e5 kBot
2e4 cBot
--- OUTPUTS ---
--- need this line ---
"""


def changed(*changes, deck=DECK):
    """The deck with some things changed."""
    for old, new in changes:
        assert deck.count(old) == 1, old
        deck = deck.replace(old, new)
    return deck


def read(*changes, **how):
    return deck_from_text(changed(*changes), **how)


def said(*changes, **how):
    """Remarks that changes bring."""
    usual = deck_from_text(DECK).remarks
    return [remark for remark in read(*changes, **how).remarks if remark not in usual]


POINT_2, POINT_3 = "2 Free 30 0 -25 80 0.05 0.1 0.5", "3 Coupled 1 2 -3 0 0 0 0"


@pytest.mark.parametrize("word", [*WORDS[Hold.COUPLED], "Coupled1", "VESSEL2", "Turbine1", "T3"])
def test_coupled_points_are_driven_from_outside(word):
    point = read((POINT_3, f"3 {word} 1 2 -3 0 0 0 0")).scene.point("point3")
    assert point == Driven("point3", paths.external((1.0, 2.0, -3.0)))


@pytest.mark.parametrize("word", [*WORDS[Hold.FIXED], "Anchor4"])
def test_fixed_points(word):
    assert read((POINT_3, f"3 {word} 1 2 -3 0 0 0 0")).scene.point("point3") == Fixed("point3", (1.0, 2.0, -3.0))


@pytest.mark.parametrize("word", [*WORDS[Hold.FREE], "Connect2"])
def test_free_points(word):
    assert read((POINT_2, f"2 {word} 30 0 -25 80 0.05 0.1 0.5")).scene.point("point2").mass == 80.0


@pytest.mark.parametrize(
    ("rows", "load", "remark"),
    [
        ("2 Free 30 0 -25 80 0.05 0.1 0.5 7", (0.1, 0.5), "No use is made of columns of points behind CA: 7 (line 10)."),
        ("2 Free 30 0 -25 80 0.05 0.1 0.5 7 8", (0.1, 0.5), "No use is made of columns of points behind CA: 7 8 (line 10)."),
        ("2 Free 30 0 -25 80 0.05 0 0 0 0.1 0.5", (0.1, 0.5), None),
        ("2 Free 30 0 -25 80 0.05 0 0 0 0.1 0.5 x", (0.1, 0.5), "No use is made of columns of points behind CA: x (line 10)."),
    ],
)
def test_columns_of_points_count_from_the_front(rows, load, remark):
    point = read((POINT_2, rows)).scene.point("point2")
    assert (point.CdA, point.Ca) == load
    assert said((POINT_2, rows)) == ([remark] if remark else [])


def test_names_of_columns_tell_that_there_is_no_force():
    """MoorDyn takes columns 8 to 10 of a row of 12 for a force, whatever they are called."""
    named = ("Mass Volume CdA Ca\n", "Mass Volume CdA Ca Name Group Extern\n")
    row = (POINT_2, POINT_2 + " 7 8 9")
    assert read(named, row).scene == deck_from_text(DECK).scene
    assert read((POINT_2, "2 Free 30 0 -25 80 0.05 0 0 0 0.1 0.5")).scene == deck_from_text(DECK).scene


def test_headings_may_have_tabs():
    assert deck_from_text(DECK.replace(" ", "\t")).scene == deck_from_text(DECK).scene


ONCE = ("4e5 kBot", "4e5 kBot\n%s")


@pytest.mark.parametrize(
    ("option", "remark"),
    [
        ("0.01 dtM", "No use is made of options of MoorDyn's own run: dtM (line 20)."),
        ("False Echo", "No use is made of options of MoorDyn's own run: Echo (line 20)."),
        ("1 gendynamicic", "No use is made of options of MoorDyn's own run: ICgenDynamic (line 20)."),
        ("start.ic fileIC", "No use is made of options of MoorDyn's own run: fileIC (line 20)."),
        ("5 pumps", "No use is made of options that MoorDyn does not have: pumps (line 20)."),
        ("5 WaveKn", 'No use is made of options that MoorDyn does not have: WaveKn, did you mean "wavekin" (line 20).'),
        ("5", "No use is made of options that are not a value and a name: 5 (line 20)."),
        ("0 WaveKin", None),
        ('"" WaterKin', None),
        ("1 WaveKin", "Line 20: WaveKin 1 is a flow that the program gives which calls MoorDyn. None is given: the water is "
         "still."),
        ("4 WaveKin", "Line 20: MoorDyn has no WaveKin 4 yet and reads nothing for it, so that nothing flows by it."),
        ("3 Currents", "Line 20: MoorDyn has no Currents 3 yet and reads nothing for it, so that nothing flows by it."),
        ("2 WaveKin", "Line 20: WaveKin 2 reads wave_frequencies.txt, which is not beside the deck. There are no waves here."),
        ("1 Currents", "Line 20: Currents 1 reads current_profile.txt, which is not beside the deck. There is no current here."),
        ("0.1 dtWave", "No use is made of options of MoorDyn's own run: dtWave (line 20)."),
        ("SEASTATE WaterKin", "Line 20: WaterKin SEASTATE is a flow that the program gives which calls MoorDyn. None is given: "
         "the water is still."),
        ("flow.dat WaterKin", "Line 20: WaterKin names a file that is not there, flow.dat; MoorDyn's C++ version never reads one. "
         "The water is still."),
        ("4e5 KBOT", "kBot is given on lines 19 and 20; the last one counts, as in MoorDyn: 4e5."),
    ],
)  # fmt: skip
def test_options_that_change_nothing(option, remark):
    assert read((ONCE[0], ONCE[1] % option)).scene == deck_from_text(DECK).scene
    assert said((ONCE[0], ONCE[1] % option)) == ([remark] if remark else [])


def test_friction_of_the_fortran_version():
    """Along and across a line alike; else nothing here means it."""
    both = read((ONCE[0], ONCE[1] % "0.4 MU_KT\n0.4 MU_KA")).scene
    assert both == read((ONCE[0], ONCE[1] % "0.4 FrictionCoefficient")).scene != deck_from_text(DECK).scene
    differs = ONCE[0], ONCE[1] % "0.4 MU_KT"
    found = [effect for effect in read(differs).scene.effects if isinstance(effect, CableFriction)]
    assert found == [CableFriction(along=0.0, across=0.4, height=-41.0, stiffness=4e5)]
    assert any(
        said.startswith("Friction on the bottom is 0.4 of the load across a line and 0 along it") for said in read(differs).remarks
    )
    like = read(differs, like_moordyn=True)
    assert "friction that differs along and across, as by MoorDyn's C++ version: MU_KT and MU_KA (line 20)" in like.remarks[0]
    assert not any(isinstance(effect, CableFriction) for effect in like.scene.effects)


def test_columns_of_lines_in_the_other_order():
    """Names of columns of the first version over the columns of the second one: what is a point says which they are."""
    names = "ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs", "Line LineType UnstrLen NumSegs NodeAnch NodeFair Flags"
    assert read(names).scene == deck_from_text(DECK).scene
    assert [text for text in said(names) if "columns 3 to 6 are read as A, B, UnstrLen, NumSegs" in text]


def test_the_last_of_an_option_counts():
    scene = read((ONCE[0], ONCE[1] % "7e5 kb")).scene
    assert scene.effects[-1] == Ground(-41.0, 7e5, 2e4)


def test_a_file_of_flow_that_has_none_is_passed_over(tmp_path):
    (tmp_path / "flow.dat").write_text("--- WAVES ---\n0  WaveKinMod - type\n--- CURRENT ---\n 0 CurrentMod - type\n")
    still = changed((ONCE[0], ONCE[1] % '"flow.dat" WaterKin'))
    assert deck_from_text(still, folder=tmp_path).scene == deck_from_text(DECK).scene
    (tmp_path / "flow.dat").write_text("a\nb\n")
    with pytest.raises(DeckError, match=r'line 20, ".*WaterKin": WaterKin must name a file with WaveKinMod and CurrentMod'):
        deck_from_text(still, folder=tmp_path)


@pytest.mark.parametrize("word", ["3.1D7", "3.1d+7", "31.D6", ".31D8"])
def test_exponents_of_fortran(word):
    """MoorDyn's C++ version makes 3.1 N of it (C's atof)."""
    change = ("3.1e7", word)
    assert read(change).scene == deck_from_text(DECK).scene
    assert said(change) == [f"Line 5: EA {word} is read as 3.1e+07; MoorDyn's C++ version stops reading at the D."]


@pytest.mark.parametrize("segments", ["14.0", "14."])
def test_counts_that_are_written_as_numbers(segments):
    assert read(("42 14 -", f"42 {segments} -")).scene == deck_from_text(DECK).scene


def test_letters_of_output_may_stand_apart():
    deck = read(("42 14 -", "42 14 p t"))
    assert deck.scene == deck_from_text(DECK).scene
    assert deck.line_outputs == {1: "pt"}


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        ("--- NOTES ---\nof mine", 'No use is made of text between the sections: the section "NOTES" (line 17).'),
        ("--- TURBINES ---\n1 2 3", 'No use is made of text between the sections: the section "TURBINES" (line 17).'),
        (
            "--- CONTROL ---\nh\nh\n1 2",
            "No use is made of control channels, for which there is no controller: channel 1 (line 20).",
        ),
        ("--- ROD TYPES ---\nh\nh\nbuoy 2 300 1 1 1 1", "No use is made of types of rods that no line ends at: buoy (line 20)."),
        ("--- RODS ---\nh\nh\n1 b Free 0 0 0 0 0 1 4 -", "No use is made of rods that no line ends at: rod 1 (line 20)."),
        ("--- RODS ---\nh\nh", None),
        ("--- BODIES ---\nh\nh\n1 Free 0 0 0", "No use is made of bodies that hold no line: body 1 (line 20)."),
        ("--- EXTERNAL LOADS ---\nh\nh\n1 Body1 0|0|0 0 0 G", "No use is made of external loads: 0 (line 20)."),
        ("--- FAILURE ---\nh\nh\n1 3 2 0 0", "No use is made of failures at no time and no tension: failure 1 (line 20)."),
    ],
)
def test_sections_that_change_nothing(text, remark):
    change = ("--- OPTIONS", f"{text}\n--- OPTIONS")
    assert read(change).scene == deck_from_text(DECK).scene
    assert said(change) == ([remark] if remark else [])


def test_what_no_line_has_may_be_anything():
    change = ("--- POINTS", "fancy 0.1 3 1e5|2e5 x y\n--- POINTS")
    assert read(change).scene == deck_from_text(DECK).scene
    assert said(change) == ["No use is made of line types that no line has: fancy (line 6)."]
    change = ("3 Coupled", "4 Free 0 0 0 1 0 0 0\n3 Coupled")
    assert read(change).scene == deck_from_text(DECK).scene
    assert said(change) == ["Point 4 is left out: it moves freely and no line ends there."]


def test_numbers_of_rows_of_the_first_fortran_version():
    change = [
        ("TypeName Diam", "1 NTypes - number\nTypeName Diam"),
        ("ID Type", "3 NConnects\nID Type"),
        ("ID LineT", "2 NLines\nID LineT"),
    ]
    assert read(*change).scene == deck_from_text(DECK).scene


def test_columns_of_another_order_are_read_by_their_place():
    change = ("Cd Ca CdAx CaAx", "Can Cat Cdn Cdt")
    assert read(change).scene == deck_from_text(DECK).scene
    assert said(change) == [
        "Line 5: columns 7 to 10 are read as Cd, Ca, CdAx, CaAx, as MoorDyn does, though the file calls them can, cat, cdn, cdt."
    ]


@pytest.mark.parametrize("word", ["Fixed", "Coupled", "Vessel1", "Turbine2"])
def test_points_of_a_body_that_does_not_move_by_itself(word):
    """MoorDyn 2.7.2 has point 2 at (1.7332, 5.9776, -11.0532) m: a body at (1, 2, -5), turned by 10, 20 and 30 degrees."""
    bodies = f"--- BODIES ---\nh\nh\n1 {word} 1 2 -5 10 20 30 0 0 0 0 0 0\n--- POINTS"
    point = read(("--- POINTS", bodies), (POINT_3, "3 Body1 4 1 -6 0 0 0 0")).scene.point("point3")
    assert isinstance(point, Fixed if word == "Fixed" else Driven)
    at = point.at if word == "Fixed" else point.path.at(0.0)[0]
    assert np.allclose(at, (1.7332, 5.9776, -11.0532), atol=5e-5)  # of which MoorDyn's were noted to 1e-4


def test_the_bottom_is_no_higher_than_what_is_held():
    change = ("41 WtrDpth", "30 WtrDpth")
    assert read(change).scene == deck_from_text(DECK).scene
    assert said(change) == [
        "The bottom, WtrDpth = 30 m, lies above a point that is held at 41 m; it is taken at 41 m, as by MoorDyn."
    ]


def test_failures_of_one_line():
    """At both ends of line 2, whichever of several times and tensions is first; and they are written again."""
    change = ("--- OPTIONS", "--- FAILURE ---\nh\nh\n1 3 2 12 0\n2 P2 2 9.5 0\n3 3 2 11 7e4\n4 3 2 0 8e4\n--- OPTIONS")
    scene = read(change).scene
    assert set(scene.events) == {
        Release("point3.parted1", "point3", 11.0, 7e4),
        Release("point2.parted1", "point2", 9.5),
    }
    assert {scene.cables[1].start, scene.cables[1].end} == {"point3.parted1", "point2.parted1"}
    assert scene.cables[0] == deck_from_text(DECK).scene.cables[0]
    assert any(
        '"line2" parts from point 3 at 11 s or where the tension of one exceeds 70000 N there' in text for text in said(change)
    )
    assert deck_from_text(moordyn_text(scene)).scene == scene


def test_lines_that_fail_together_stay_joined():
    """As MoorDyn's Fortran version detaches them: they end at one free point from then on."""
    scene = read(("--- OPTIONS", "--- FAILURE ---\nh\nh\n1 2 1,2 0.5 0\n--- OPTIONS")).scene
    assert scene.events == (Release("point2.parted1", "point2", 0.5),)
    ends = [{cable.start, cable.end} for cable in scene.cables]
    assert ends[0] & ends[1] == {"point2.parted1"} and deck_from_text(moordyn_text(scene)).scene == scene
    rest = equilibrium(scene)
    assert (rest.position("point2.parted1") == rest.position("point2")).all()
    run = simulate(scene, 0.6, dt=0.01)
    assert [event.where for event in run.events] == ["point2.parted1"] and run.ok
    assert run.position("point2.parted1")[-1, 2] > run.position("point2")[-1, 2] + 1e-3  # the clump sinks alone


FAILURE = "--- FAILURE ---\nh\nh\n1 %s\n--- OPTIONS"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("--- OPTIONS", FAILURE % "2 1,2 0 9\n2 2 1 4 0", r"line 21, .*a line must fail once at an end, but one does in line 20"),
        ("--- OPTIONS", FAILURE % "2 1 0 1e308", r"line 20, .*Argument `tension` must be positive and finite"),
        ("--- OPTIONS", FAILURE % "2 , 0 9", r"line 20, .*a failure must be of lines, but its third column names none"),
        ("--- OPTIONS", FAILURE % "R1a 1 0 9", r"line 20, .*a failure must be at a point in POINTS, but R1a is none"),
        ("--- OPTIONS", FAILURE % "3 7 0 9", r"line 20, .*a failure must be of a line in LINES, but 7 is none"),
        ("--- OPTIONS", FAILURE % "3 1 0 9", r'line 20, .*but "line1" does not end at point 3'),
        ("--- OPTIONS", FAILURE % "3 1 0", r"line 20, .*a failure must have 5 columns .* but has 4"),
        ("--- OPTIONS", "--- OPTION ---", r'line 17: a section must be one .* heading is "OPTION", did you mean "OPTIONS"\?'),
        ("1 hose 1 2 42", "1 hose 1 R1A 42", r"line 15, .*a line must end at a rod in RODS, but R1A is none"),
        (POINT_3, "3 Body1 1 2 -3 0 0 0 0", r"line 11, .*must be on a body in BODIES, but body 1 is not there"),
        (POINT_3, "3 Body 1 2 -3 0 0 0 0", r"line 11, .*must be Fixed, Coupled, Free or Body and a number"),
        (POINT_3, "3 CoupledPinned 1 2 -3 0 0 0 0", r"line 11, .*must be Fixed, Coupled, Free or Body and a number"),
        ("3.1e7", "SYROPE:s.dat|2|3", r"line 5, .*BA/-zeta of a Syrope model must be BA_s|BA_d"),
        ("4e5 kBot", "4e5 kBot\n8 WaveKin", r"line 20, .*WaveKin must be an integer from 0 to 7"),
        ("4e5 kBot", "4e5 kBot\nsea.txt WaveKin", r"line 20, .*WaveKin must be an integer from 0 to 7"),
        ("4e5 kBot", "4e5 kBot\n2.5 Currents", r"line 20, .*Currents must be an integer from 0 to 5"),
    ],
)  # fmt: skip
def test_refusals(old, new, message):
    with pytest.raises(DeckError, match=message):
        read((old, new))


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("1 Free 0 0 0 0 0 0 -1 0 1 0 0 0", r"line 9, .*Argument `mass` must be positive and finite"),
        ("1 Fre 0 0 0 0 0 0 9 0 1 0 0 0", r"line 9, .*a body must be Fixed, Coupled, CoupledPinned, Pinned or Free\."),
        ("1 Free 0 0 0 0 0 0 9 1|2 1 0 0 0", r"line 9, .*CG of a body must be 1 or 3 finite numbers with \| between them"),
        ("1 Free 0 0 0 0 0 0 9 0 1 0 1|2|3|4 0", r"line 9, .*CdA of a body must be 1 or 2 or 3 or 6 finite numbers"),
        ("1 Free 0 0 0 0 0 0 9 0 1|1|3 0 0 0", r"line 9, .*Principal moments"),
        ("1 Coupled 0 0 0", r"line 9, .*a body must have 14 columns .* but has 5"),
    ],
)
def test_refused_bodies_are_told_once(row, message):
    with pytest.raises(DeckError, match=message) as refused:
        read(("--- POINTS", f"--- BODIES ---\nh\nh\n{row}\n--- POINTS"), (POINT_3, "3 Body1 4 1 -6 0 0 0 0"))
    assert len(refused.value.args) == 1


def test_all_that_is_refused_is_told_at_once():
    with pytest.raises(DeckError) as refused:
        read(
            ("3.1e7", "3.1e7|x"), (POINT_2, "2 Fre 30 0 -25 80 0.05 0.1 0.5"), ("1 hose 1 2 42", "1 hase 1 2 42"),
            ("4e5 kBot", "x kBot\n9 WaveKin\n9 Currents"),
            ("--- OPT", "--- RODS ---\nh\nh\n--- FAILURE ---\nh\nh\n1 7 1 9 0\n--- OPT"),
        )  # fmt: skip
    lines = str(refused.value).split("\n")
    assert tuple(lines) == refused.value.args
    starts = [5, 10, 15, 23, 26, 27, 28]
    assert [line.split(":")[0].partition(",")[2].split()[:2] for line in lines] == [["line", f"{n},"] for n in starts]
    assert isinstance(refused.value, SceneError) and all(line.isprintable() and len(line) <= 280 for line in lines)
    assert str(pickle.loads(pickle.dumps(refused.value))) == str(refused.value)


def test_rows_that_are_refused_for_one_reason_are_told_together():
    loads = "--- EXTERNAL LOADS ---\nh\nh\n1 Point2 0 5 0 -\n2 Point2 0 6 0 -\n3 Point2 0 7 0 -\n--- OPTIONS"
    with pytest.raises(DeckError, match=r'^deck, lines 20 to 22, "1 Point2 0 5 0 -": Blin must be three finite numbers'):
        read(("--- OPTIONS", loads))


def test_one_warning_tells_everything(tmp_path):
    file = tmp_path / "hose.dat"
    file.write_text(changed(("41 WtrDpth", "41 WtrDpth\n0.1 dtM\n0.5 FrictionCoefficient")))
    with pytest.warns(DeckWarning) as told:
        load_scene(file)
    (warning,) = told
    first, *more = str(warning.message).split("\n")
    assert first == "hose.dat: No use is made of options of MoorDyn's own run: dtM (line 19)."
    assert more[0].startswith("Points with a volume or a CdA float") and more[1].startswith("The damper of the bottom never pulls")
    assert more[2].startswith("Friction on the bottom is 0.5 of the load") and "FricDamp = 200 N s/m" in more[2]
    assert warning.filename.endswith("scene_file.py") or warning.filename == __file__


def test_like_moordyn_takes_its_laws():
    friction = ("41 WtrDpth", "41 WtrDpth\n0.5 FrictionCoefficient\n300 FricDamp")
    deck = read(friction, like_moordyn=True)
    water, bottom = deck.scene.effects[1:]
    assert water == Water(1025.0, points_float=False)
    assert bottom == MoordynBottom(-41.0, 4e5, 2e4, 0.5, 300.0)
    assert not any("MoorDyn's." in remark for remark in deck.remarks)


def test_names_of_a_file_and_what_it_wants_written(tmp_path):
    file = tmp_path / "hose.dat"
    file.write_text(changed(("--- OUTPUTS ---", '--- OUTPUTS ---\nFairTen1 Con3px\n"L2N4T"\nEND'), ("3 Coupled", "3 Vessel")))
    with pytest.warns(DeckWarning):
        deck = read_moordyn(file)
    assert deck.points == {1: "point1", 2: "point2", 3: "point3"} and deck.lines == {1: "line1", 2: "line2"}
    assert deck.channels == ("FairTen1", "Con3px", "L2N4T")
    assert isinstance(deck.scene.point("point2"), Free)


def test_a_long_list_is_told_whole():
    types = "".join(f"spare{i} 0.1 3 1e5 1 0 1 1 0 0\n" for i in range(40))
    remarks = said(("--- POINTS", f"{types}--- POINTS"))
    assert len(remarks) > 1 and all(len(remark) <= 270 for remark in remarks)
    assert all(f"spare{i} (line {6 + i})" in " ".join(remarks) for i in range(40))
