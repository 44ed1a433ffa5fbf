"""Files that are odd, and that MoorDyn runs: they are read as it reads them."""

import numpy as np
import pytest
from beside_moordyn import places_of_points
from test_moordyn_loads_on_bodies import DECK

from anet_lumped import SceneError, simulate
from anet_lumped.files.moordyn_file import deck_from_text

ROD = """\
--- ROD TYPES ---
h
h
bar 0.5 0 0.6 1.0 0 0
--- RODS ---
h
h
1 bar Free 0.5 0.2 -20.3 -0.5 -0.2 -19.7 4 -
--- POINTS ---"""


def changed(*changes):
    deck = DECK
    for old, new in changes:
        assert deck.count(old) == 1, old
        deck = deck.replace(old, new)
    return deck


TWICE = ("--- BODIES ---", "light 0.02 0.05 3e4 0 0 0 0 0 0\n--- BODIES ---")


@pytest.mark.parametrize(
    ("change", "remark"),
    [
        (TWICE, "Line type light is given on lines 4 and 5; the last one counts, as in MoorDyn."),
        (("--- OPTIONS ---", "--- LINES ---\nh\nh\n2 light 1 3 9 1 -\n--- OPTIONS ---"),
         'No use is made of sections that come again, as by MoorDyn: the section "LINES" (line 19).'),
        (("100 WtrDpth", "-100 WtrDpth"), None),
    ],
    ids=["line type", "section", "depth"],
)  # fmt: skip
def test_what_moordyn_takes_without_a_word(change, remark):
    deck = deck_from_text(changed(change))
    (cable,) = deck.scene.cables
    assert cable.mass_per_length == (0.05 if change is TWICE else 0.01)
    assert remark is None or remark in deck.remarks


LOADED = ("-0.3 50 0.02 0.3 0.5", "-0.3 0 0 0 0")
HEAVY = ("light 0.01 0.01 2e4", "light 0.01 4 2e4")
THREE = (
    (
        "1 light 1 2 60 1 -",
        "1 light 1 2 25 1 -\n2 light 4 3 25 1 -\n3 light 5 6 25 1 -",
    ),
    (
        "3 Body1 -0.5 -0.2 0.3 0 0 0 0",
        "3 Body1 -0.5 -0.2 0.3 0 0 0 0\n4 Fixed -20 0 0 0 0 0 0\n5 Fixed 0 20 0 0 0 0 0\n6 Body1 0 0.7 0 0 0 0 0",
    ),
)


@pytest.mark.parametrize("mass", [100, 0], ids=["no inertia", "no mass"])
def test_moordyn_moves_light_bodies_as_we_do(tmp_path, mass):
    """MoorDyn lacks the pull of the ends of lines that circle: 2e-4 of the way after 20 ms, and growing with the time squared."""
    quiet = "--- OPTIONS ---\n5e-5 dtM\nRK4 tScheme\n0 TmaxIC\n1 disableOutput\n0 writeLog"
    light = ("0 100 0 20 0.05", f"0 {mass} 0 0 0.05")
    text = changed(light, LOADED, HEAVY, *THREE, ("--- OPTIONS ---", quiet))
    deck = deck_from_text(text, like_moordyn=True)
    assert any("has no inertia I; it is given" in said for said in deck.remarks)
    path, t_end = tmp_path / "deck.txt", 0.02
    path.write_text(text)
    places = places_of_points(path, t_end, (2, 3))
    ours = simulate(deck.scene, t_end, method="edmc", dt=2e-4, start="straight").final
    for name, place in zip(("body1.point2", "body1.point3"), places, strict=True):
        way = np.linalg.norm(np.subtract(place, deck.scene.point(name).at))
        assert way > 2e-3 and np.allclose(ours.position(name), place, rtol=0.0, atol=1e-3 * way)


def test_a_rod_without_a_mass():
    text = changed(("--- POINTS ---", ROD), ("1 light 1 2 60", "1 light 1 R1A 60"))
    deck = deck_from_text(text)
    assert any("a rod of no mass that moves by itself is given 1e-06" in said for said in deck.remarks)
    rod = deck.scene.body("rod1").rods[0]
    assert rod.mass_per_length == pytest.approx(1e-6 * 1000.0 * np.pi * 0.25 * 0.25, rel=1e-12)
    assert simulate(deck.scene, 0.05, method="edmc", dt=0.005, start="straight").ok


JUNK = (
    "0 -1 1e308 nan inf x 1|2|3 a|b | Body1 Body1Pinned Free Pinned R1A R9B 999 1.5 Turbine1 - 1e-300 file.txt ../x SYROPE:f|1|2 "
    "1,2 Point1 6.0D8 true % # --- 1_000 \x00"
).split(" ")


@pytest.mark.parametrize("seed", range(4))
def test_what_is_no_deck_is_refused_in_sentences(seed):
    """Words, lines and rows at random: read, or refused with the name of the file in each line, and never a traceback."""
    rng, refused = np.random.default_rng(seed), 0
    whole = changed(
        ("--- POINTS ---", ROD),
        ("--- OPTIONS ---", "--- EXTERNAL LOADS ---\nh\nh\n1 Body1 1|2|3 1|1|1 0 G\n--- OPTIONS ---"),
    )
    whole = whole.replace(
        "--- OPTIONS ---", "--- FAILURE ---\nh\nh\n1 2 1 9 0\n2 2 1 0 9e4\n3 1 1 5 7\n--- OPTIONS ---\n0.3 MU_KT\n0.1 MU_KA"
    )
    for _ in range(100):
        lines = whole.splitlines()
        for _ in range(rng.integers(1, 5)):
            i, way = rng.integers(len(lines)), rng.integers(4)
            words = lines[i].split() or ["x"]
            if way == 0:
                del lines[i]
            elif way == 1:
                lines.insert(i, lines[rng.integers(len(lines))])
            elif way == 2:
                del words[rng.integers(len(words))]
                lines[i] = " ".join(words)
            else:
                words[rng.integers(len(words))] = JUNK[rng.integers(len(JUNK))]
                lines[i] = " ".join(words)
        try:
            deck_from_text("\n".join(lines))
        except SceneError as error:
            refused += 1
            assert all(line.startswith("deck") and len(line) < 400 for line in str(error).splitlines())
    assert 20 < refused < 100


def test_empty_lines_between_rows_change_nothing():
    """MoorDyn counts an empty line as one of the two above the rows and stops; a row of units alone is a heading here."""
    assert deck_from_text(DECK.replace("\n", "\n\n")).scene == deck_from_text(DECK).scene


def test_a_section_whose_rows_are_taken_for_its_headings():
    units = "(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)\n"
    with pytest.raises(SceneError, match="LINE TYPES must have rows below its two lines of names and units, but has none"):
        deck_from_text(changed((units, "")))


def test_a_length_that_is_a_multiple_of_the_distance_is_told():
    (line,) = (row for row in DECK.splitlines() if row.startswith("1 light 1 2 "))
    number = DECK.splitlines().index(line) + 1
    deck = deck_from_text(changed((line, "1 light 1 2 -60 1 -")))
    (cable,) = deck.scene.cables
    told = f"Line {number}: UnstrLen -60 is 60 times the distance of both ends, {cable.length:g} m, as by MoorDyn."
    assert told in deck.remarks and cable.length > 60.0
