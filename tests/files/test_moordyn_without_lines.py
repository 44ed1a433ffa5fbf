"""MoorDyn files without lines: bodies, rods and points alone, and MoorDyn beside them."""

import numpy as np
import pytest
from beside_moordyn import begun, march

from anet_lumped import NoRestError, SceneError, equilibrium, simulate
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_writer import moordyn_text

BODIES = """\
--- BODIES ---
ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca
(#) (-) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m^2) (m^3) (m^2) (-)
1 Free 0 0 -20 0 0 0 1500 0 100 1.0 0.5 0.5
"""
RODS = """\
--- ROD TYPES ---
TypeName Diam Mass/m Cd Ca CdEnd CaEnd
(name) (m) (kg/m) (-) (-) (-) (-)
buoy 0.5 300 1.0 1.0 0.8 0.6
--- RODS ---
ID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs RodOutputs
(#) (name) (#/key) (m) (m) (m) (m) (m) (m) (-) (-)
1 buoy Pinned 0 0 -10 3 0 -12 8 p
"""
POINTS = """\
--- POINTS ---
ID Type X Y Z M V CdA CA
(#) (name) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Free 1 2 -10 500 0.1 0.3 0.5
2 Free 0 0 -15 50 0.1 0.3 0.5
"""
OPTIONS = """\
--- OPTIONS ---
0.001 dtM
100 WtrDpth
9.81 g
1025 rho
0 TmaxIC
1 disableOutput
0 writeLog
--- need this line ---
"""


def beside(tmp_path, text, t_end, places):
    """What MoorDyn tells, ``places(moordyn, engine)``, at the start and after a time [s]."""
    (tmp_path / "deck.txt").write_text(text)
    with begun(tmp_path / "deck.txt") as (moordyn, engine):
        first = np.array(places(moordyn, engine))
        march(moordyn, engine, t_end, 0.01)
        return first, np.array(places(moordyn, engine))


def points(moordyn, engine):
    return [moordyn.GetPointPos(moordyn.GetPoint(engine, number)) for number in (1, 2)]


def body(moordyn, engine):
    return [moordyn.GetBodyState(moordyn.GetBody(engine, 1))[0][:3]]


def rod(moordyn, engine):
    return [moordyn.GetRodNodePos(moordyn.GetRod(engine, 1), 8)]


@pytest.mark.parametrize(
    ("sections", "places", "names"),
    [(POINTS, points, ("point1", "point2")), (BODIES, body, ("body1",)), (RODS, rod, ("rod1.b",))],
    ids=["points", "body", "rod"],
)
def test_moordyn_moves_them_as_we_do(tmp_path, sections, places, names):
    """The bottom, of MoorDyn's default stiffness, is touched by none. Both take steps of second order: 1e-3 of the way."""
    text = sections + OPTIONS
    first, then = beside(tmp_path, text, 2.0, places)
    like_moordyn = sections is not RODS  # whose MoordynBottom takes no rods
    run = simulate(deck_from_text(text, like_moordyn=like_moordyn).scene, 2.0, start="straight", error=1e-4)
    for k, name in enumerate(names):
        place = run.position(name)
        way = np.linalg.norm(place[-1] - place[0])
        if sections is not RODS:  # of which MoorDyn tells the end only after its first call
            assert place[0] == pytest.approx(first[k], abs=1e-12)
        assert way > 0.5 and place[-1] == pytest.approx(then[k], abs=1e-3 * way)


def test_a_rod_rests_in_a_current_where_moordyn_does(tmp_path):
    """A pinned rod, heavy or light, leans with a current of 1 m/s; MoorDyn's swings about it are over after 120 s."""
    (tmp_path / "current_profile.txt").write_text("z x y z\n-- (m) (m/s) (m/s) (m/s)\n-- --\n-100 1.0 0.0 0.0\n0 1.0 0.0 0.0\n")
    flow = OPTIONS.replace("0 TmaxIC", "0 TmaxIC\n1 Currents\n0.1 dtWave")
    for mass, side in ((300, -1.0), (150, 1.0)):
        text = (RODS + flow).replace("buoy 0.5 300", f"buoy 0.5 {mass}")
        _, then = beside(tmp_path, text, 120.0, rod)
        rest = equilibrium(deck_from_text(text, folder=tmp_path).scene)
        x, _, z = rest.position("rod1.b")
        assert rest.stable and x > 0.3 and (z + 10.0) * side > 0.0
        assert then[0] == pytest.approx(rest.position("rod1.b"), abs=1e-3 * np.sqrt(13.0))


def test_what_stays_and_what_is_left_out():
    """Rods and bodies that move stay, and points with a mass; the bottom acts on rods alone."""
    still = POINTS.replace("2 Free 0 0 -15 50", "2 Free 0 0 -15 0") + "3 Fixed 0 0 -30 0 0 0 0\n"
    deck = deck_from_text(BODIES + RODS + still + OPTIONS)
    assert [one.name for one in deck.scene.bodies] == ["body1", "rod1"]
    assert [one.name for one in deck.scene.points] == ["point1", "point3"] and not deck.scene.cables
    assert "Point 2 is left out: it moves freely and no line ends there, and it has no mass." in deck.remarks
    kinds = [type(effect).__name__ for effect in deck.scene.effects]
    assert kinds == ["Gravity", "Water", "Ground"]
    assert [type(effect).__name__ for effect in deck_from_text(BODIES + OPTIONS).scene.effects] == ["Gravity", "Water"]
    with pytest.raises(NoRestError, match='nothing holds body "body1"'):
        equilibrium(deck_from_text(BODIES + OPTIONS).scene)


@pytest.mark.parametrize("sections", ["", POINTS.replace("Free", "Fixed"), BODIES.replace("Free", "Coupled")])
def test_nothing_that_moves(sections):
    message = "must have a section LINE TYPES" if not sections else "must have lines, or bodies, rods or points that move"
    with pytest.raises(SceneError, match=message):
        deck_from_text(sections + OPTIONS)


def test_they_are_written_and_read():
    scene = deck_from_text(BODIES + RODS.replace("Pinned", "Free") + POINTS + OPTIONS).scene
    back = deck_from_text(moordyn_text(scene)).scene
    assert [one.name for one in back.bodies] == ["body1", "rod1"] and len(back.free_points) == 2
    assert back.body("body1").mass == 1500.0 and back.body("rod1").rods[0].mass_per_length == 300.0


@pytest.mark.parametrize("seed", range(3))
def test_odd_files_are_refused_in_sentences(seed):
    """Words, rows and sections at random: read, or refused with the name of the file in each line, and never a traceback."""
    rng, refused, read = np.random.default_rng(seed), 0, 0
    junk = "0 -1 1e308 nan x 1|2|3 a|b | Body1 Body1Pinned Free Pinned CoupledPinned R1A 999 1.5 Turbine1 - 1e-300 # ---".split()
    loads = "--- EXTERNAL LOADS ---\nh\nh\n1 Body1 1|2|3 1|1|1 0 G\n1 Rod1 0|0|5 1|1 0 -\n1 Point1 0|0|9 0 0 -\n"
    for _ in range(150):
        rows = (BODIES + RODS + POINTS + loads + OPTIONS).splitlines()
        for _ in range(rng.integers(1, 4)):
            i, way = rng.integers(len(rows)), rng.integers(3)
            words = rows[i].split() or ["x"]
            if way == 0:
                del rows[i]
                continue
            if way == 1:
                del words[rng.integers(len(words))]
            else:
                words[rng.integers(len(words))] = junk[rng.integers(len(junk))]
            rows[i] = " ".join(words)
        try:
            deck_from_text("\n".join(rows))
            read += 1
        except SceneError as error:
            refused += 1
            assert all(line.startswith("deck") for line in str(error).splitlines())
    assert refused > 20 and read > 10
