"""One mooring in the hands of many: files as users and programs write them, read alike here and by MoorDyn, and at rest alike."""

import numpy as np
import pytest

from anet_lumped import Driven, equilibrium
from anet_lumped.files.moordyn_file import deck_from_text, read_moordyn
from studies.peers.moordyn import silence

DECK = """a chain from a vessel
--- LINE TYPES ---
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
chain 0.09 160 7.0E8 -0.8 0 2.0 0.8 0.4 0.25
--- POINTS ---
ID Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Anchor 240 0 -80 0 0 0 0
2 Vessel 20 0 -10 0 0 0 0
--- LINES ---
ID Type NodeA NodeB Length Segs Flags
(-) (-) (-) (-) (m) (-) (-)
1 chain 1 2 245 12 -
--- OPTIONS ---
80 WtrDpth
60 TmaxIC
1e-6 threshIC
2e-3 dtM
0 writeLog
1 disableOutput
--- OUTPUTS ---
--- need this line ---
"""
TYPE, LINE = "chain 0.09 160 7.0E8 -0.8 0 2.0 0.8 0.4 0.25", "1 chain 1 2 245 12 -"
BODY = "--- BODIES ---\nID Att X0 Y0 Z0 r p y M CG I V CdA Ca\n(-)\n1 Coupled 5 0 0 0 0 0 0 0 0 0 0 0\n--- POINTS"
OPENFAST = (
    (
        "a chain from a vessel",
        "-------- MoorDyn Input File ------\nMooring system for OpenFAST\nFALSE    Echo      - echo the data?",
    ),
    ("--- POINTS", "---------------------- CONNECTION PROPERTIES --------------------------------"),
    (
        "Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx",
        "Name     Diam      MassDen       EA    BA/-zeta    EI  Cd  Ca  CdAx  CaAx",
    ),
    ("--- OPTIONS ---", "---------------------- SOLVER OPTIONS ---------------------------------------"),
    ("80 WtrDpth", "80   WtrDpth - water depth (m)\n3.0e6         kbot           - bottom stiffness (Pa/m)\n3.0e5 cbot - damping"),
    (
        "--- need this line",
        "FairTen1\nAnchTen1\nEND\n------------------------- need this line --------------------------------------",
    ),
)
HANDS = {
    "plain": (),
    "windows": (("\n", "\r\n"),),
    "a byte-order mark": (("a chain from", "\ufeffa chain from"),),
    "tabs": ((TYPE, TYPE.replace(" ", "\t")), (LINE, " " + LINE.replace(" ", " \t  "))),
    "small letters": (("LINE TYPES", "line types"), ("--- OPTIONS", "--- options"), ("WtrDpth", "wtrdpth"), ("Anchor", "anchor")),
    "options with units": (("80 WtrDpth", "80   WtrDpth   [m] depth"), ("2e-3 dtM", "2e-3 dtM (s) time step")),
    "a type that nothing uses": ((TYPE, f"{TYPE}\nrope 0.15 20 3e7 -0.8 0 1.2 1.0 0.1 0.0"),),
    "remarks": ((LINE, f"{LINE} ! port # of the bow"), ("240 0 -80 0 0 0 0", "240 0 -80 0 0 0 0 ! the anchor")),
    "of OpenFAST": OPENFAST,
    "units of RAFT": (
        ("(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)", "(#)   (-)     (m)          (m)       (m)    (kg)   (mˆ3)  (m^2)  (-)"),
    ),
    "a coupled body": (("--- POINTS", BODY), ("2 Vessel 20", "2 Body1 15")),
    "no line behind END": (("--- need this line ---\n", "END\n"),),
    "no bottom but a damper": (("80 WtrDpth", "85 WtrDpth\n0 kBot\n3e3 cBot"), ("1 2 245 12", "1 2 232 12")),
    "an end that fails never": (("--- OPTIONS", "--- FAILURE ---\nID\n()\n1 2 1 0 0\n--- OPTIONS"),),
}
UNREAD = {"no line behind END", "tabs"}  # by MoorDyn 2.7.2, which reads beyond the end, and takes no tab between words


def written(hand):
    text = DECK
    for old, new in HANDS[hand]:
        assert old in text, old
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize("hand", [hand for hand in HANDS if hand != "no bottom but a damper"])
def test_all_are_one_scene(hand):
    scene = deck_from_text(written(hand)).scene
    usual = deck_from_text(DECK).scene
    assert scene.cables[0].length == 245.0 and scene.cables == usual.cables
    assert np.allclose(scene.points[1].path.at(0.0)[0], (20, 0, -10)) and set(scene.effects) == set(usual.effects)


@pytest.mark.parametrize("hand", [hand for hand in HANDS if hand not in UNREAD])
def test_moordyn_rests_where_we_do(tmp_path, hand):
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    (tmp_path / "deck.txt").write_bytes(written(hand).encode())
    with pytest.warns(match="deck"):
        deck = read_moordyn(tmp_path / "deck.txt", like_moordyn=True)
    driven = [point.path.at(0.0)[0] for point in deck.scene.points if isinstance(point, Driven)]
    begin = [5.0, 0.0, 0.0, 0.0, 0.0, 0.0] if hand == "a coupled body" else np.concatenate(driven).tolist()
    with silence():
        engine = moordyn.Create(str(tmp_path / "deck.txt"))
        try:
            moordyn.Init(engine, begin, [0.0] * len(begin))
            for k in range(200):
                moordyn.Step(engine, begin, [0.0] * len(begin), 0.1 * k, 0.1)
            line = moordyn.GetLine(engine, 1)
            theirs = np.array([moordyn.GetLineNodePos(line, i) for i in range(13)])
        finally:
            moordyn.Close(engine)
    assert np.abs(equilibrium(deck.scene).shape("line1") - theirs).max() < 1e-5 * 245.0  # of the length
