"""MoorDyn's input files: what they say arrives, what is written comes back, what is not supported is named with its line."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import (
    Cable,
    CableCut,
    Driven,
    Fixed,
    Free,
    PayloadChange,
    Scene,
    SceneError,
    equilibrium,
    load_scene,
    save_scene,
    simulate,
)
from anet_lumped.effects import Bending, Gravity, Ground, MoordynBottom, ViscousDamping, Water
from anet_lumped.files.moordyn_file import deck_from_text, read_moordyn
from anet_lumped.files.moordyn_writer import moordyn_text, save_moordyn
from anet_lumped.prescribed import paths
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.scene.as_dict import scene_to_dict
from studies.peers.moordyn import silence, state_file
from studies.peers.problem import Problem, problem

DECK = """\
--------------------- MoorDyn Input File ------------------------------------
a chain and a rope that meet at a clump weight, in air
---------------------- LINE TYPES -------------------------------------------
TypeName   Diam    Mass/m     EA     BA/-zeta    EI         Cd     Ca     CdAx    CaAx
(name)     (m)     (kg/m)     (N)    (N-s/-)     (N-m^2)    (-)    (-)    (-)     (-)
chain      0.1     150.0      1e8    -1          0          2.3    1.1    1.0     0.5
rope       0.05    1.5        4e7    3.0e3       0          1.2    1.0    0.01    0.0
---------------------- POINTS -----------------------------------------------
ID    Attachment  X       Y     Z      Mass   Volume  CdA    Ca
(#)   (word/ID)   (m)     (m)   (m)    (kg)   (m^3)   (m^2)  (-)
1     Fixed      -500     0    -150    0      0       0      0
2     Free       -200     5     -60    20     0.1     0.2    0.3
3     Coupled     0       0     -9     0      0       0      0
---------------------- LINES ------------------------------------------------
ID   LineType   AttachA  AttachB  UnstrLen  NumSegs  LineOutputs
(#)  (name)     (ID)     (ID)     (m)       (-)      (-)
1    chain      1        2        300       20       p
2    rope       2        3        240       12       -
---------------------- OPTIONS ----------------------------------------------
0       writeLog
1       disableOutput
0.002   dtM           time step to use in mooring integration (s)
rk4     tScheme
9.81    g
0       rho           in air
500     WtrDpth
0       kBot
0       cBot
0       WaveKin
---------------------- OUTPUTS ----------------------------------------------
FairTen2
--------------------- need this line ----------------------------------------
"""
IN_WATER = DECK.replace("0       rho           in air", "1025    rho           in sea water")
OLD = """\
MoorDyn v1
---------------------- LINE DICTIONARY --------------------------------------
LineType  Diam    MassDenInAir  EA   BA/-zeta   Can   Cat   Cdn   Cdt
(-)       (m)     (kg/m)        (N)  (Pa-s/-)   (-)   (-)   (-)   (-)
rope      0.05    1.5           4e7  -0.8       1.0   0.1   1.6   0.05
---------------------- NODE PROPERTIES --------------------------------------
Node   Type     X      Y     Z      M     V      FX    FY    FZ    CdA    CA
(-)    (-)      (m)    (m)   (m)    (kg)  (m^3)  (kN)  (kN)  (kN)  (m^2)  (-)
1      Fix     -50     0    -60     0     0      0     0     0     0      0
2      Connect -20     0    -30     2     0.1    0     0     0     0.2    0.3
3      Vessel   0      0     -9     0     0      0     0     0     0      0
---------------------- LINE PROPERTIES --------------------------------------
Line   LineType  UnstrLen  NumSegs  NodeAnch  NodeFair  Flags/Outputs
(-)    (-)       (m)       (-)      (-)       (-)       (-)
1      rope      50        8        1         2         p
2      rope      30        4        2         3         p
---------------------- SOLVER OPTIONS ---------------------------------------
0.001    dtM     - time step
0.0      rhoW    - water density
0        kb      - bottom stiffness
0        cb      - bottom damping
5.0      ICDfac  - factor by which to scale drag
"""


def changed(old, new, deck=DECK):
    """The deck with one thing changed."""
    assert deck.count(old) == 1, old
    return deck.replace(old, new)


def test_a_deck_says_what_the_scene_is(tmp_path):
    (tmp_path / "mooring.txt").write_text(DECK)
    deck = read_moordyn(tmp_path / "mooring.txt")
    assert deck.scene.points == (
        Fixed("point1", (-500, 0, -150)),
        Free("point2", 20.0, (-200, 5, -60), CdA=0.2, volume=0.1, Ca=0.3),
        Driven("point3", paths.external((0, 0, -9))),
    )
    chain, rope = deck.scene.cables
    assert chain == Cable(
        "point1", "point2", name="line1", length=300.0, segments=20, mass_per_length=150.0, EA=1e8, zeta=1.0, diameter=0.1,
        Cdn=2.3, Can=1.1, Cdt=1.0, Cat=0.5, compression="damped",
    )  # fmt: skip
    assert (rope.name, rope.BA, rope.zeta, rope.segments, rope.length) == ("line2", 3e3, 0.0, 12, 240.0)
    assert deck.scene.effects == (Gravity(9.81),)
    assert deck.options == {"writeLog": 0, "disableOutput": 1, "dtM": 0.002, "tScheme": "rk4", "WaveKin": 0}


def test_the_columns_and_headings_of_version_1():
    deck = deck_from_text(OLD)
    assert deck.scene.point("point2") == Free("point2", 2.0, (-20, 0, -30), CdA=0.2, volume=0.1, Ca=0.3)
    first = deck.scene.cable("line1")
    assert (first.start, first.end, first.length, first.segments) == ("point1", "point2", 50.0, 8)
    assert (first.zeta, first.Can, first.Cat, first.Cdn, first.Cdt, first.EI) == (0.8, 1.0, 0.1, 1.6, 0.05, 0.0)
    assert deck.scene.effects == (Gravity(9.80665),)
    assert deck.options == {"dtM": 0.001, "CdScaleIC": 5.0}


def test_a_coupled_point_follows_the_path_it_is_given():
    sway = paths.harmonic((0, 0, -9), (1, 0, 0), 0.1)
    scene = deck_from_text(DECK, coupled={3: sway}).scene
    assert scene.point("point3") == Driven("point3", sway)
    with pytest.raises(SceneError, match=r"`coupled` must name coupled points of deck \(3\), but names 1"):
        deck_from_text(DECK, coupled={1: sway})


def test_a_negative_length_is_a_multiple_of_the_distance():
    scene = deck_from_text(changed("300       20", "-1.05     20")).scene
    assert scene.cable("line1").length == pytest.approx(1.05 * np.sqrt(300.0**2 + 5.0**2 + 90.0**2), rel=1e-15)


def test_remarks_and_tabs_are_no_columns():
    deck = changed("1    chain      1        2        300       20       p", "1\tchain\t1 P2 300 20 p # 9 9")
    assert deck_from_text(deck).scene == deck_from_text(DECK).scene


def test_water_bottom_and_bending_come_by_their_options():
    deck = changed("0       rho ", "1025    rho ")
    deck = changed("0       kBot", "3e6     kBot", changed("0       cBot", "3e5     cBot\n0.4 FrictionCoefficient", deck))
    deck = changed("3.0e3       0 ", "3.0e3       70", deck)
    effects = {type(effect): effect for effect in deck_from_text(deck).scene.effects}
    assert effects[Water].density == 1025.0
    ground = effects[Ground]
    assert (ground.height, ground.stiffness, ground.damping, ground.friction) == (-500.0, 3e6, 3e5, 0.4)
    assert Bending in effects
    assert [cable.EI for cable in deck_from_text(deck).scene.cables] == [0.0, 70.0]


def test_a_deck_that_is_silent_has_moordyns_sea_down_to_its_deepest_point():
    silent = DECK[: DECK.index("9.81    g")] + DECK[DECK.index("0       WaveKin") :]
    effects = {type(effect): effect for effect in deck_from_text(silent).scene.effects}
    ground = effects[Ground]
    assert effects[Gravity].g == 9.80665 and effects[Water].density == 1025.0
    assert (ground.height, ground.stiffness, ground.damping, ground.friction) == (-150.0, 3e6, 3e5, 0.0)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rope       2        3", "rop        2        3", r'line 18, "2 +rop +2 .*": .* but "rop" is none, did .* "rope"'),
        ("rope       2        3", "wire       2        3", r'line 18, .*"wire" is none; known: chain, rope\.'),
        ("rope       2        3", "rope       2        4", r"line 18, .*point 4 is not there; known: 1, 2, 3\."),
        ("rope       2        3", "rope       2        R1A", r"line 18, .*a line must end at a rod in RODS, but R1A is none"),
        ("rope       2        3", "rope       2        x", r"line 18, .*must end at the number of a point, but x is none"),
        ("rope       2        3", "rope       2        2", r"line 18, .*must join two different points"),
        ("240       12       -", "240       12", r"line 18, .*a line must have 7 columns .* but has 6"),
        ("240       12       -", "240       12.5     -", r"line 18, .*NumSegs must be an integer of at least 1, but is 12.5"),
        ("240       12       -", "0         12       -", r"line 18, .*`length` must be positive and finite \[m\]"),
        ("240       12       -", "x         12       -", r"line 18, .*UnstrLen must be a finite number, but is x"),
        ("2    rope ", "1    rope ", r"line 18, .*a line must come once, but line1 comes again"),
        ("4e7    3.0e3", "rope.dat 3.0e3", r"line 7, .*EA must be a number or the name of a readable file, but .*rope.dat"),
        ("4e7    3.0e3", "nan    3.0e3", r"line 7, .*EA must be a number or the name of a readable file, but nan: No such file"),
        ("4e7    3.0e3", "8e7|4e7 3.0e3", r"line 7, .*`EA_dynamic` must be larger"),
        ("4e7    3.0e3", "4e7    3e3|4e3", r"line 7, .*BA/-zeta must be one number where EA is, but is 3e3\|4e3"),
        ("4e7    3.0e3       0 ", "4e7    3.0e3       ei.dat ", r"line 7, .*EI must be a number or the name of a read"),
        ("4e7    3.0e3", "-4e7   3.0e3", r"line 7, .*`EA` must be positive"),
        ("0.01    0.0\n", "0.01\n", r"line 7, .*a line type must have 10 columns .* but has 9"),
        ("2     Free ", "2     Fre  ", r'line 12, .*must be Fixed, Coupled, Free or Body and a number, did you mean "free"\?'),
        ("2     Free ", "2     Loose", r"line 12, .*must be Fixed, Coupled, Free or Body and a number\."),
        ("2     Free ", "1     Free ", r"line 12, .*a point must come once, but 1 comes again"),
        ("2     Free ", "0     Free ", r"line 12, .*the number of a point must be an integer of at least 1, but is 0"),
        ("0.1     0.2    0.3", "0.1    0.2", r"line 12, .*a point must have 9 columns .* but has 8"),
        ("20     0.1", "-20    0.1", r"line 12, .*`mass` must be non-negative"),
        ("-200 ", "inf  ", r"line 12, .*X must be a finite number, but is inf"),
        ("0       WaveKin", "9       WaveKin", r'line 29, "9 +WaveKin": WaveKin must be an integer from 0 to 7'),
        ("0       WaveKin", "WtrDpth 30", r"line 29, .*the value of an option must come before its name"),
        ("0       WaveKin", "7       Currents", r"line 29, .*Currents must be an integer from 0 to 5"),
        ("0       WaveKin", "bottom.txt SeafloorFile", r"line 29, .*a seafloor must be in a readable file, but bottom"),
        ("0       kBot", "-1      kBot", r"line 27, .*kBot must not be negative"),
        ("500     WtrDpth", "sea.txt WtrDpth", r"line 26, .*a seafloor must be in a readable file, but sea"),
        ("-- LINE TYPES", "-- KINDS", r"mooring.txt: a MoorDyn file must have a section LINE TYPES, but this has none"),
    ],
)  # fmt: skip
def test_messages(tmp_path, old, new, message):
    (tmp_path / "mooring.txt").write_text(changed(old, new))
    with pytest.raises(SceneError, match=message) as refused:
        read_moordyn(tmp_path / "mooring.txt")
    assert str(refused.value).startswith("mooring.txt")


def test_static_friction_is_that_of_moordyns_bottom():
    deck = changed("0       kBot", "3e6     kBot\n1.5 StatDynFricScale")
    assert deck_from_text(deck).options["StatDynFricScale"] == 1.5
    rough = changed("0       WaveKin", "0.5 FrictionCoefficient", deck)
    assert any("to 1.5 of that before it slips, StatDynFricScale; read_moordyn(" in said for said in deck_from_text(rough).remarks)
    (bottom,) = [effect for effect in deck_from_text(rough, like_moordyn=True).scene.effects if isinstance(effect, MoordynBottom)]
    assert (bottom.friction, bottom.static_ratio) == (0.5, 1.5)


def test_no_file(tmp_path):
    with pytest.raises(SceneError, match=r"A MoorDyn file must be readable, but .*none.txt: No such file"):
        read_moordyn(tmp_path / "none.txt")


number = st.floats(-1e9, 1e9)
positive = st.floats(1e-9, 1e9)
amount = st.just(0.0) | positive
place = st.tuples(number, number, st.floats(-4e3, 1e9))
name = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=6).filter(str.strip) | st.just('a --- ! name: "b')


@st.composite
def scenes(draw):
    names = draw(st.lists(name, min_size=2, max_size=4, unique=True))
    points = [
        draw(st.one_of(
            st.builds(Fixed, st.just(own), place),
            st.builds(Free, st.just(own), amount, place, CdA=amount, volume=amount, Ca=amount),
        ))
        for own in names
    ]  # fmt: skip
    cables = [
        Cable(
            *pair,
            **{key: draw(positive) for key in ("length", "mass_per_length", "EA", "diameter")},
            **{key: draw(amount) for key in ("Cdn", "Cdt", "Can", "Cat")},
            **draw(st.fixed_dictionaries({"zeta": amount}) | st.fixed_dictionaries({"BA": positive})),
            segments=draw(st.integers(1, 10**6)),
            compression="damped",
            name=f"{i} {draw(name)}",
        )
        for i, pair in enumerate(zip(names, [*names[1:], names[0]], strict=True))
    ]
    return Scene(points, cables, draw(st.just([]) | st.builds(Gravity, positive).map(lambda effect: [effect])))


@tried(50, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(scene=scenes())
def test_round_trip(tmp_path, scene):
    save_scene(scene, tmp_path / "scene.dat")
    assert load_scene(tmp_path / "scene.dat") == scene


def test_round_trip_with_water_bottom_and_bending():
    scene = deck_from_text(DECK).scene
    cables = [replace(scene.cables[0], EI=12.5), *scene.cables[1:]]
    effects = [Gravity(), Water(density=1000.0), Ground(height=-200.0, stiffness=1e5, damping=1e4, friction=0.5)]
    scene = Scene(scene.points, cables, [*effects, Bending()])
    assert deck_from_text(moordyn_text(scene)).scene == scene


def test_round_trip_of_moordyns_own_laws():
    scene = deck_from_text(DECK).scene
    effects = [Gravity(), Water(density=1000.0, points_float=False), MoordynBottom(-200.0, 1e5, 1e4, 0.5, 300.0)]
    scene = Scene(scene.points, scene.cables, effects)
    assert deck_from_text(moordyn_text(scene), like_moordyn=True).scene == scene
    assert isinstance(scene.point("point3"), Driven)
    with pytest.raises(SceneError, match="must have one bottom to be written for MoorDyn, but it has Ground and MoordynBottom"):
        moordyn_text(Scene(scene.points, scene.cables, [*effects, Ground(-200.0)]))


def test_what_a_deck_has_no_place_for():
    """A path becomes its start, a place is where the point rests, a diameter a millimetre."""
    scene = deck_from_text(DECK).scene
    path = paths.harmonic((0, 0, -9), (1, 0, 0), 0.1)
    points = [scene.points[0], replace(scene.points[1], at=None), Driven("point3", path)]
    scene = Scene(points, [replace(cable, diameter=None) for cable in scene.cables], scene.effects)
    back = deck_from_text(moordyn_text(scene, {"dtM": 1e-3}), coupled={3: path})
    assert back.options == {"dtM": 1e-3}
    assert back.scene.point("point3") == scene.point("point3")
    assert np.array_equal(back.scene.point("point2").at, equilibrium(scene).position("point2"))
    assert {cable.diameter for cable in back.scene.cables} == {1e-3}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"compression": "linear"}, r'must have compression="damped" or "none" .* cable "line1" has "linear"'),
        ({"EA": np.inf}, r'must have a finite `EA` to be written for MoorDyn, but cable "line1" has EA=inf'),
        ({"breaking_tension": 7e5}, r'must have no `breaking_tension` to be written for MoorDyn, but cable "line1" has .*=700000'),
        (
            {"events": [PayloadChange("point2", 1.0, 0.0)]},
            r"no payloads that change to be written for MoorDyn, but it has P",
        ),
        ({"events": [CableCut("line1", 1.0, 1)]}, r'must be cut at an end to be written for MoorDyn, but of "line1" segment 1 is'),
        ({"effects": [ViscousDamping(0.1)]}, r"A scene must have no ViscousDamping to be written for MoorDyn"),
        ({"effects": [Gravity(9.81, (0, 1, -1))]}, r"Gravity must point along -z to be written for MoorDyn, but"),
        ({"effects": [], "at": None}, r'A free point must have a place to be written for MoorDyn, but "point2" has no `at`'),
        ({"level": 2.0}, r"Water must have level=0 to be written .* it has level=2.0"),
        ({"g": 3.0}, r"Water must have the g of Gravity, 9.81 m/s2, .* it has g=3.0"),
        ({"height": 2.0}, r"The ground must lie at or below z=0 .* height=2.0"),
    ],
)
def test_what_moordyn_cannot_do_is_refused(tmp_path, change, message):
    scene = deck_from_text(DECK).scene
    effects, points, fields = list(scene.effects), scene.points, dict(change)
    for key in ("level", "g"):
        if key in fields:
            effects.append(Water(**{key: fields.pop(key)}))
    if "height" in fields:
        effects.append(Ground(height=fields.pop("height"), stiffness=1.0, damping=0.0, friction=0.0))
    if "at" in fields:
        points = (points[0], replace(points[1], at=fields.pop("at"), mass=0.0), points[2])
    effects, events = fields.pop("effects", effects), fields.pop("events", ())
    scene = Scene(points, [replace(scene.cables[0], **fields), scene.cables[1]], effects, events)
    with pytest.raises(SceneError, match=message):
        save_moordyn(scene, tmp_path / "scene.txt")


def test_a_warning_where_moordyns_dampers_act_and_ours_do_not(tmp_path):
    scene = deck_from_text(DECK).scene
    scene = Scene(scene.points, [replace(cable, compression="none") for cable in scene.cables], scene.effects)
    with pytest.warns(UserWarning, match=r'MoorDyn.s dampers act on slack segments too: .* cable "line1" has "none"'):
        save_scene(scene, tmp_path / "scene.moordyn")
    assert scene_to_dict(load_scene(tmp_path / "scene.moordyn"))["cables"][0]["compression"] == "damped"


def moordyn_reads(deck, start, t_end, dt):
    """What MoorDyn makes of a deck, marched from a Problem's start: for each line, places [m] and tensions [N] of its nodes."""
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    with silence():
        engine = moordyn.Create(str(deck))
        try:
            fairlead, still = start.model.scene.point("point3").path.at(0.0)[0], [0.0] * 3
            moordyn.Init_NoIC(engine, list(fairlead), still)
            (deck.parent / "state").write_bytes(state_file(start))
            moordyn.LoadState(engine, str(deck.parent / "state"))
            for k in range(round(t_end / dt)):
                moordyn.Step(engine, list(fairlead), still, k * dt, dt)
            found = []
            for i in range(len(start.model.scene.cables)):
                line = moordyn.GetLine(engine, i + 1)
                nodes = range(moordyn.GetLineNumberNodes(line))
                places = np.array([moordyn.GetLineNodePos(line, node) for node in nodes])
                tensions = np.array([moordyn.GetLineNodeTen(line, node) for node in nodes])
                found.append((places, np.linalg.norm(tensions, axis=1)))
            return found
        finally:
            moordyn.Close(engine)


@pytest.mark.parametrize("deck", [DECK, IN_WATER], ids=["in air", "in water"])
def test_moordyn_rests_where_we_do(tmp_path, deck):
    """MoorDyn, started at our equilibrium of its deck, has our tensions at both ends of each line and keeps still for 1 s.

    A false length, stiffness, mass or end would move the nodes by centimetres in that time. Rounding of coordinates of 500 m
    leaves k·eps·|x| = 7e6 N/m · 1e-13 m = 1 mN of 5e5 N.
    """
    (tmp_path / "mooring.txt").write_text(deck)
    rest = equilibrium(read_moordyn(tmp_path / "mooring.txt").scene)
    theirs = moordyn_reads(tmp_path / "mooring.txt", problem(rest.scene, 1.0, 1.0, rest), 1.0, 0.002)
    for cable, (places, tensions) in zip(rest.scene.cables, theirs, strict=True):
        assert np.allclose(tensions[[0, -1]], rest.tension(cable.name)[[0, -1]], rtol=1e-8)
        assert np.allclose(places, rest.q[rest.model.nodes(cable.name)], atol=1e-9)


@pytest.mark.parametrize(("deck", "off"), [(DECK, 1e-6), (IN_WATER, 5e-6)], ids=["in air", "in water"])
def test_moordyn_moves_as_we_do(tmp_path, deck, off):
    """From the rest of a lighter clump. Both march with a fourth-order step; 2 ms leave less than 1e-6 m of a way of 0.1 m.

    In water MoorDyn takes drag and added mass of a node along the mean direction of its segments, we those of its half segments
    along their own: of the square of the angle between them, here 1e-2, and 1e-3 of the way is drag's.
    """
    (tmp_path / "mooring.txt").write_text(changed("20     0.1 ", "9000   0.1 ", deck))
    scene = read_moordyn(tmp_path / "mooring.txt").scene
    rest = equilibrium(deck_from_text(deck).scene)
    theirs = moordyn_reads(tmp_path / "mooring.txt", problem(scene, 0.5, 0.5, rest), 0.5, 0.002)
    ours = simulate(scene, 0.5, method="rk4", dt=0.001, start=rest).final
    assert np.linalg.norm(ours.position("point2") - rest.position("point2")) > 0.1
    for cable, (places, _) in zip(scene.cables, theirs, strict=True):
        assert np.allclose(places, ours.q[ours.model.nodes(cable.name)], rtol=0, atol=off)


def test_a_deck_in_water_runs_from_file_to_result(tmp_path):
    """A mooring with a chain on the bottom, let go with its fairlead 5 m off, comes to rest where statics has it."""
    deck = changed("500     WtrDpth", "150     WtrDpth", changed("0       kBot", "1e5     kBot", IN_WATER))
    deck = changed("0       cBot", "1e5     cBot", deck)
    (tmp_path / "mooring.txt").write_text(deck)
    scene = load_scene(tmp_path / "mooring.txt")
    assert {type(effect) for effect in scene.effects} == {Gravity, Water, Ground}
    rest = equilibrium(scene)
    aside = Driven("point3", paths.external((-5.0, 0.0, -9.0)))
    start = equilibrium(Scene((*scene.points[:2], aside), scene.cables, scene.effects))
    scene = Scene((*scene.points[:2], Fixed("point3", (0, 0, -9))), scene.cables, scene.effects)
    run = simulate(scene, 120.0, start=start)
    assert run.ok, run.message
    assert error_of_steps(run) < 1e-4
    moved = np.abs(start.position("point2") - rest.position("point2")).max()
    left = np.abs(run.position("point2")[-1] - rest.position("point2")).max()
    assert moved > 1.0 and left < 1e-3 * moved


@pytest.mark.parametrize("damping", ["-0.8", "3.0e3"])
def test_damping_is_moordyns(tmp_path, damping):
    """The tension of a segment that stretches, T = EA·eps + BA·(dl/dt)/L0, by its damping ratio or its viscosity.

    A step of 1 ns changes neither strain nor rate by more than 1e-7 of them.
    """
    (tmp_path / "mooring.txt").write_text(changed("4e7    3.0e3", f"4e7    {damping}"))
    rest = equilibrium(read_moordyn(tmp_path / "mooring.txt").scene)
    model, rope = rest.model, rest.scene.cable("line2")
    v = np.zeros_like(rest.q)
    nodes = model.nodes("line2")
    v[nodes[-2]] = (0.4, -0.3, 0.2)
    start = Problem(model, rest.q, v, np.array([0.0, 1.0]))
    _, (_, tensions) = moordyn_reads(tmp_path / "mooring.txt", start, 1e-9, 1e-9)
    along = rest.q[nodes[-1]] - rest.q[nodes[-2]]
    rate = -v[nodes[-2]] @ along / np.linalg.norm(along)
    expected = rest.tension("line2")[-1] + rope.axial_viscosity * rate / rope.L0
    assert abs(rope.axial_viscosity * rate / rope.L0) > 10.0
    assert tensions[-1] == pytest.approx(expected, rel=1e-7)
