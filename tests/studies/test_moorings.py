"""The study of MoorDyn files."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd
import pytest

from anet_lumped import equilibrium
from anet_lumped.checks import InputError
from studies.questions import moorings
from studies.questions.moorings import decks, motion, prices, tables
from studies.questions.moorings.motion import displacement, prepare

STIFF = """a stiff tail with a free end, held above the bottom
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
tail 0.03 5.0 3.0E7 -0.5 2000 1.2 1.0 0.08 1.0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Free -10 0 -14.5 0 0 0 0
2 Fixed -14 0 -15.8 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 tail 1 2 4.5 5 -
--- OPTIONS ---
16 WtrDpth
--- OUTPUTS ---
--- need this line ---
"""
REFUSED = STIFF.replace("3.0E7", "SYROPE:curve.dat|1e8|20")


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    with ThreadPoolExecutor(1) as executor:  # in this process
        return moorings.compute(quick=True, executor=executor, out=tmp_path_factory.mktemp("moorings"))


@pytest.mark.slow
def test_own_decks_read_rest_and_move(rows):
    table = rows["decks"]
    assert list(table["deck"]) == [f"{name}.txt" for name in decks.OWN_NAMES]
    assert (table["read"] == "read").all() and (table["rest"] == "found").all() and (table["moves"] == "done").all()


@pytest.mark.slow
def test_own_decks_have_the_numbers_of_moordyn(rows):
    pytest.importorskip("moordyn", exc_type=ImportError)
    table = rows["decks"]
    assert (table["statics_error"] < 1e-3).all() and (table["motion_error"] < 1e-2).all()  # what the study asks
    assert set(rows["cost"]["code"]) == {prices.OWN, prices.OTHER}


@pytest.mark.slow
def test_a_shorter_step_is_nearer_to_the_fine_run(rows):
    """Of order 1 or better: half the step has less than 0.6 of the error."""
    cost = rows["cost"][rows["cost"]["setting"].str.startswith("edmc")]
    own = cost["error_over_range"].to_numpy().reshape(-1, 2)
    assert (own[:, 1] < 0.6 * own[:, 0]).all()


def test_written_decks_are_the_scenes_they_were(tmp_path):
    for file in decks.files(None, tmp_path):
        deck, laws = decks.read(file)
        assert deck.scene == decks.own_scene(file.stem) and laws == "MoorDyn's"


@pytest.mark.slow
def test_the_answer_follows_from_the_rows(rows):
    assert set(rows) == set(moorings.TABLES) and "cost" in moorings.plot(rows)
    text = moorings.answer(rows)
    assert "Of 3 files, 3 are read, 3 rest and 3 of the 3 with coupled points move to the end." in text
    far = {"statics_error": [2e-3, 1e-5, 1e-5], "motion_error": [0.03, 1e-4, 1e-4], "motion_rms": 1e-3, "moordyn": "reads it"}
    far |= {"finer_motion_error": 0.004, "own_change": 0.027, "moordyn_change": 0.001}
    text = moorings.answer(rows | {"decks": rows["decks"].assign(**far)})
    assert "At rest the tensions of 2 of 3 files are within 0.1 %" in text and "catenary.txt: 0.2 % (reads it)." in text
    assert "catenary.txt: 3 % at its worst time and 0.1 % rms, and with shorter steps 0.4 %" in text


def test_a_ratio_takes_the_cheapest_setting_within_the_tolerance():
    lines = [
        ("a.txt", prices.OWN, "coarse", 0.02, 0.1),
        ("a.txt", prices.OWN, "fine", 0.009, 0.2),
        ("a.txt", prices.OTHER, "coarse", 0.008, 0.7),
        ("a.txt", prices.OTHER, "fine", 0.0005, 0.9),
    ]
    cost = pd.DataFrame(lines, columns=list(prices.COLUMNS))
    assert prices.ratio(cost, "a.txt", 0.01) == pytest.approx(3.5)
    assert np.isnan(prices.ratio(cost, "a.txt", 0.001))  # nothing of this library is within it


def test_a_refused_deck_is_a_line_with_its_reason(tmp_path):
    (tmp_path / "syrope.txt").write_text(REFUSED, encoding="utf-8")
    found = tables.deck_row({"file": str(tmp_path / "syrope.txt"), "t_end_s": 1.0, "peer": False})
    assert found["read"] == "refused" and "Syrope" in found["reason"] and set(tables.RESULTS) <= set(found)


def test_a_stiff_tail_that_must_push_rests_with_cables_that_push(tmp_path):
    """On the bottom by half its weight: moments about the held end; MoorDyn's creeps, as its slack segments do not push."""
    (tmp_path / "tail.txt").write_text(STIFF, encoding="utf-8")
    deck, _ = decks.read(tmp_path / "tail.txt")
    with pytest.raises(InputError, match=r"no step of the search could be solved; a cable .* must push"):
        equilibrium(deck.scene)
    prepared = prepare(deck)
    assert prepared.changed == motion.PUSHING
    shape = prepared.rest.shape("line1")
    assert shape[0, 2] == pytest.approx(-16.0, abs=3e-3) and shape[-1, 2] == -15.8  # it sinks in by a millimetre
    assert np.linalg.norm(shape[0] - shape[-1]) == pytest.approx(4.5, abs=0.02)  # straight but for its sag


def test_bodies_that_move_have_the_bottom_of_this_library(tmp_path):
    """`MoordynBottom` holds up cables alone."""
    body = "--- BODIES ---\nh\nh\n1 Free -10 0 -14 0 0 0 900 0 400 1 0 0\n--- POINTS"
    (tmp_path / "body.txt").write_text(
        STIFF.replace("2000", "0").replace("--- POINTS", body).replace("1 Free -10 0 -14.5", "1 Body1 0 0 0")
    )
    deck, laws = decks.read(tmp_path / "body.txt")
    assert laws == "own" and "Ground" in [type(effect).__name__ for effect in deck.scene.effects]


def test_a_folder_without_decks_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"The folder of MoorDyn files must hold files \*\.txt or \*\.dat, but .* has none"):
        decks.files(tmp_path, tmp_path)


def test_coupled_points_surge_and_heave_together():
    x, y, z = displacement(np.array([22.5]))[0]  # a quarter of a period after the ramp is over
    assert (x, y, z) == pytest.approx((motion.SURGE, 0.0, motion.HEAVE), abs=1e-12)
