"""Polyester lines of MoorDyn files, of the Syrope model: what is read, what is refused, and MoorDyn itself beside it."""

from dataclasses import replace

import numpy as np
import pytest
from slow import slow

from anet_lumped import SceneError, equilibrium, paths, read_moordyn, save_moordyn, simulate, working_curves
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError, DeckWarning
from anet_lumped.files.moordyn_writer import moordyn_text
from studies.peers.moordyn import silence

DECK = """\
a polyester rope that is driven along itself, in air
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
poly 0.2 40 {EA} {BA} 0 0 0 0 0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 0 0 -5 0 0 0 0
2 Coupled 10.25 0 -5 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 poly 1 2 10 1 -
--- SYROPE IC ---
Line(s) Tmax0 Tmean0
(-) (N) (N)
{IC}
--- OPTIONS ---
0.001 dtM
rk4 tScheme
0 g
0 rho
50 WtrDpth
0 kBot
0 cBot
0 writeLog
1 disableOutput
0 TmaxIC
--- OUTPUTS ---
--- need this line ---
"""
EA, BA, IC = "SYROPE:syrope.dat|1.53E8|23.12", "5e9|1e5", "1 1.5e6 1e6"
MODEL = "owc.dat OWC the original curve\n{kind} WCType shape\n{k1} k1 first\n{k2} k2 second"  # MoorDyn takes no empty last line
ORIGINAL = np.array([(0.0, 0.0), (0.02, 0.8e6), (0.05, 3e6), (0.08, 6e6), (0.11, 9.5e6)])
FINE = np.column_stack([np.linspace(0.0, 0.11, 23), np.interp(np.linspace(0.0, 0.11, 23), *ORIGINAL.T)])
KINDS = [("LINEAR", 0.25, 0.0), ("LINEAR", 1.25e8, 0.0), ("QUADRATIC", 0.3, 0.6), ("EXP", 0.25, 1.1)]


def write(folder, kind="EXP", k1=0.25, k2=1.1, rows=ORIGINAL):
    """The files that the deck names; of the original curve MoorDyn passes over three lines."""
    (folder / "syrope.dat").write_text(MODEL.format(kind=kind, k1=k1, k2=k2))
    rows = "\n".join(f"{strain:.10g} {tension:.10g}" for strain, tension in rows)
    (folder / "owc.dat").write_text(f"polyester\nstrain tension\n(-) (N)\n{rows}")


def read(folder, EA=EA, BA=BA, IC=IC, coupled=None):
    return deck_from_text(DECK.format(EA=EA, BA=BA, IC=IC), coupled=coupled, folder=folder)


@pytest.mark.parametrize(("kind", "k1", "k2"), KINDS)
def test_numbers(tmp_path, kind, k1, k2):
    write(tmp_path, kind, k1, k2)
    deck = read(tmp_path, IC="2,1 1.5e6 1e6")
    (cable,) = deck.scene.cables
    expected = {
        ("LINEAR", 0.25): working_curves.Linear(permanent=0.25, T_max=1.5e6),
        ("LINEAR", 1.25e8): working_curves.Linear(EA=1.25e8, T_max=1.5e6),
        ("QUADRATIC", 0.3): working_curves.Quadratic(0.3, 0.6, T_max=1.5e6),
        ("EXP", 0.25): working_curves.Exponential(0.25, 1.1, T_max=1.5e6),
    }
    assert cable.working_curve == expected[kind, k1] and cable.tension_strain == tuple(map(tuple, ORIGINAL[1:].tolist()))
    assert (cable.EA_dynamic, cable.EA_dynamic_per_tension, cable.BA_creep, cable.BA) == (1.53e8, 23.12, 5e9, 1e5)
    assert any("mean tensions at the start, which statics find" in remark for remark in deck.remarks)
    with pytest.warns(UserWarning, match="act on slack segments"):
        save_moordyn(deck.scene, tmp_path / "out.txt")
    with pytest.warns(DeckWarning):
        assert read_moordyn(tmp_path / "out.txt").scene == deck.scene


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"tension_strain": [(0.002 * k, 2e5 * k) for k in range(1, 31)], "working_curve": working_curves.Linear(EA=1.25e8)},
            "must have fewer than 30 rows to be written for MoorDyn, but that of cable .line1. has 30",
        ),
        (
            {"tension_strain": [(1.0, 0.3)], "working_curve": working_curves.Linear(EA=0.5)},
            r"must be at least 1 N to be written for MoorDyn, but that of cable .line1. is 0\.5",
        ),
        ({"length": 30.0, "working_curve": working_curves.Linear(EA=1.25e8)}, None),
    ],
)
def test_not_written(tmp_path, change, says):
    write(tmp_path)
    scene = read(tmp_path).scene
    scene = replace(scene, cables=[replace(scene.cables[0], EA=None, **change)])
    if says is None:
        assert "\n1 0.0 0.0\n" in moordyn_text(scene)  # slack in still air without gravity
        return
    with pytest.raises(SceneError, match=says):
        moordyn_text(scene)


@pytest.mark.parametrize(
    ("of_deck", "of_model", "says"),
    [
        ({"EA": "SYROPE:syrope.dat|1e8"}, {}, r"EA of a Syrope model must be SYROPE:file\|EA_Dc\|EA_D_Lm"),
        ({"BA": "5e9"}, {}, r"BA/-zeta of a Syrope model must be BA_s\|BA_d, two numbers that are not negative"),
        ({"BA": "-1|1e5"}, {}, "two numbers that are not negative"),
        ({"EA": "SYROPE:other.dat|1.53e8|23"}, {}, r"must name a readable file, but other\.dat"),
        ({"IC": "1 1.5e6"}, {}, "a row of SYROPE IC must have 3 columns"),
        ({"IC": "2 1.5e6 1e6"}, {}, "a Syrope line must have its Tmax0 in a section SYROPE IC"),
        ({}, {"kind": "CUBIC"}, "WCType of a Syrope model must be LINEAR, QUADRATIC or EXP, but is CUBIC"),
        ({}, {"k1": "a"}, "k1 and k2 of a Syrope model must be numbers, but are a and 1.1"),
        ({}, {"k1": 0.9}, "must be less steep than its fast spring"),
        ({}, {"k2": 0.0}, "`bend` must be positive"),
        (
            {},
            {"rows": ORIGINAL[1:]},
            "an original curve must begin at the strain 0 and the tension 0, but that of owc.dat does not",
        ),
    ],
)
def test_refused(tmp_path, of_deck, of_model, says):
    write(tmp_path, **of_model)
    with pytest.raises(DeckError, match=says):
        read(tmp_path, **of_deck)


def test_a_model_that_lacks_a_number(tmp_path):
    write(tmp_path)
    (tmp_path / "syrope.dat").write_text("owc.dat OWC x\nEXP WCType x\n0.2 k1 x")
    with pytest.raises(DeckError, match=r"must say OWC, WCType, k1 and k2, but syrope\.dat lacks K2"):
        read(tmp_path)


def test_a_curve_with_fewer_lines_above_it(tmp_path):
    write(tmp_path)
    curve = tmp_path / "owc.dat"
    assert not any("above its numbers" in remark for remark in read(tmp_path).remarks)
    curve.write_text(curve.read_text().partition("\n")[2])
    deck = read(tmp_path)
    assert any("owc.dat has 2 lines above its numbers" in remark for remark in deck.remarks)
    assert deck.scene.cables[0].tension_strain == tuple(map(tuple, ORIGINAL[1:].tolist()))


def test_a_line_of_another_type_in_its_section(tmp_path):
    deck = deck_from_text(DECK.format(EA="1e7", BA="-1", IC=IC), folder=tmp_path)
    assert any("line 1 is in SYROPE IC, but is no Syrope line" in remark for remark in deck.remarks)


def both(folder, deck, x, t):
    """Tensions in the middle of a line whose end moves along x, by MoorDyn and here, from the same rest."""
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    rest = equilibrium(deck_from_text(deck.format(T="1e6"), folder=folder).scene).tension("line1")
    (folder / "deck.txt").write_text(deck.format(T=rest.mean()))
    theirs, middle = [], len(rest) // 2
    with silence():
        engine = moordyn.Create(str(folder / "deck.txt"))
        try:
            moordyn.Init(engine, [x[0], 0.0, -5.0], [0.0, 0.0, 0.0])
            line = moordyn.GetLine(engine, 1)
            for k in range(len(t) - 1):
                h = t[k + 1] - t[k]
                moordyn.Step(engine, [x[k], 0.0, -5.0], [(x[k + 1] - x[k]) / h, 0.0, 0.0], t[k], h)
                theirs.append(np.linalg.norm(moordyn.GetLineNodeTen(line, middle)))
        finally:
            moordyn.Close(engine)
    path = paths.samples(t, np.column_stack([x, 0.0 * x, -5.0 + 0.0 * x]))
    scene = deck_from_text(deck.format(T="1e6"), folder=folder, coupled={2: path}).scene
    run = simulate(scene, t[-1], method="edmc", dt=0.01, save_every=t[1])
    return np.array(theirs), run.tension("line1")[1:, max(middle - 1, 0) : middle + 1].mean(axis=1)


@pytest.mark.parametrize(("kind", "k1", "k2"), [*KINDS[2:], *slow(*KINDS[:2])])
def test_moordyn_pulls_as_this_does(tmp_path, kind, k1, k2):
    """Up the original curve, back along a working curve, and up again, with waves on it; taut all the time.

    MoorDyn interpolates the tension over the slow strain between rows of the curves, here over their strain: 22 rows of the same
    original curve leave 6e-4 of the range.
    """
    write(tmp_path, kind, k1, k2, FINE)
    t = np.linspace(0.0, 30.0, 3001)
    up = np.clip(t / 12.0, 0.0, 1.0) - 0.2 * np.clip((t - 12.0) / 8.0, 0.0, 1.0) + 0.5 * np.clip((t - 20.0) / 10.0, 0.0, 1.0)
    x = 10.25 + 0.3 * up + 0.02 * np.sin(2.0 * np.pi * t / 5.0) * np.clip(t, 0.0, 1.0)
    deck = DECK.format(EA=EA, BA="5e8|1e5", IC="1 1.5e6 {T}")
    theirs, ours = both(tmp_path, deck, x, t)
    assert theirs.min() > 1e5 and np.ptp(theirs) > 3e6 and np.abs(ours - theirs).max() < 1e-3 * np.ptp(theirs)


def test_moordyn_pulls_a_long_line_as_this_does(tmp_path):
    """400 m in 8 segments, which sag by 7 m; both begin at their own rest, which differ by 5 kN, and swing undamped about it."""
    write(tmp_path, rows=FINE)
    t = np.linspace(0.0, 60.0, 1201)
    s = np.clip(t / 10.0, 0.0, 1.0)
    waves = 1.5 * np.sin(2.0 * np.pi * t / 20.0) + 0.5 * np.sin(2.0 * np.pi * t / 6.0)
    x = 410.0 + (waves + 8.0 * t / 60.0) * s * s * (3.0 - 2.0 * s)
    deck = DECK.format(EA=EA, BA="5e8|1e6", IC="1 1.5e6 {T}").replace("10.25 0 -5", "410 0 -5").replace("1 2 10 1 -", "1 2 400 8 -")
    theirs, ours = both(tmp_path, deck.replace("0 g", "9.81 g").replace("0 TmaxIC", "60 TmaxIC"), x, t)
    assert theirs.min() > 5e5 and np.ptp(theirs) > 1.5e6 and np.abs(ours - theirs).max() < 6e-3 * np.ptp(theirs)
