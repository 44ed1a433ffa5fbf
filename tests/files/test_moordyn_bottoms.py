"""Bottoms of MoorDyn files that are no plain spring: those that only damp, in closed form and beside MoorDyn."""

import numpy as np
import pytest
from beside_moordyn import begun, march, nodes_of_line, places_of_points

from anet_lumped import equilibrium, simulate
from anet_lumped.files.moordyn_file import deck_from_text

MUD = """a chain in mud
--- LINE TYPES ---
Name Diam Mass/m EA BA EI Cd Ca CdAx CaAx
() () () () () () () () () ()
chain 0.1 100 1e7 -0.8 0 0 0 0 0
--- POINTS ---
ID Type X Y Z M V CdA CA
() () () () () () () () ()
1 Free 0 0 -20.5 0 0 0 0
2 Free 10 0 -20.5 0 0 0 0
--- LINES ---
ID Type A B L N Out
() () () () () () ()
1 chain 1 2 10 5 -
--- OPTIONS ---
20 WtrDpth
0 kBot
3e4 cBot
2e-4 dtM
0 TmaxIC
1 disableOutput
0 writeLog
--- OUTPUTS ---
--- need this line ---
"""
SAG = (
    MUD.replace("-0.8 0 0 0 0 0", "-0.8 0 9 0 9 0").replace("3e4 cBot", "2e3 cBot")
    .replace("1 Free 0 0 -20.5", "1 Fixed 0 0 -20").replace("2 Free 10 0 -20.5", "2 Fixed 9 0 -20")
)  # fmt: skip


def sunk(t):
    """How far a chain sinks in mud from rest [m]: w t/c less what it takes to get there, with its weight w and c = cBot d."""
    weight, c = (100.0 - 1025.0 * np.pi / 4.0 * 0.1**2) * 9.80665, 3e4 * 0.1
    return weight / c * (t - 100.0 / c * -np.expm1(-c / 100.0 * t))


@pytest.mark.parametrize("like_moordyn", [True, False])
def test_a_bottom_that_only_damps(like_moordyn):
    deck = deck_from_text(MUD, like_moordyn=like_moordyn)
    assert any("The bottom has a kBot of 0: what lies on it sinks on against its damper" in remark for remark in deck.remarks)
    run = simulate(deck.scene, 2.0, method="edmc", dt=1e-3, start="straight")
    assert run.ok and run.energy_balance.imbalance < 1e-6
    assert -20.5 - run.position("point1")[-1, 2] == pytest.approx(sunk(2.0), rel=1e-6)


def test_moordyn_sinks_so_too(tmp_path):
    (tmp_path / "mud.txt").write_text(MUD)
    for place in places_of_points(tmp_path / "mud.txt", 2.0, (1, 2)):
        assert -20.5 - place[2] == pytest.approx(sunk(2.0), rel=1e-5)  # 0.2 ms


def test_a_rest_over_mud_is_one_without_a_bottom(tmp_path):
    rests = [equilibrium(deck_from_text(text).scene).shape("line1") for text in (SAG, SAG.replace("2e3 cBot", "0 cBot"))]
    assert rests[0][:, 2].min() < -21.8
    np.testing.assert_allclose(rests[0], rests[1], atol=1e-9)
    (tmp_path / "sag.txt").write_text(SAG)
    with begun(tmp_path / "sag.txt") as (moordyn, engine):
        march(moordyn, engine, 20.0, 0.01)
        theirs = np.array(nodes_of_line(moordyn, engine, 5))
    np.testing.assert_allclose(rests[0], theirs, atol=1e-6)
