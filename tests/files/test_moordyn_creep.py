"""Viscoelastic lines of MoorDyn files: what is read, what is written, and MoorDyn itself beside it."""

import numpy as np
import pytest
from slow import slow

from anet_lumped import paths, simulate
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError
from anet_lumped.files.moordyn_writer import moordyn_text
from studies.peers.moordyn import silence

DECK = """\
a rope that is driven along itself, in air
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope 0.02 0.3 {EA} {BA} 0 0 0 0 0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 0 0 -20 0 0 0 0
2 Coupled 20.2 0 -20 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 rope 1 2 20 4 -
--- OPTIONS ---
0.0002 dtM
rk4 tScheme
0 rho
50 WtrDpth
0 kBot
0 cBot
0 writeLog
1 disableOutput
20 TmaxIC
--- OUTPUTS ---
--- need this line ---
"""


def read(EA, BA, coupled=None):
    return deck_from_text(DECK.format(EA=EA, BA=BA), coupled=coupled)


def test_numbers():
    (cable,) = read("1E6|3E6|20", "2E6|1E4").scene.cables
    assert (cable.EA, cable.EA_dynamic, cable.EA_dynamic_per_tension, cable.BA_creep, cable.BA) == (1e6, 3e6, 20.0, 2e6, 1e4)
    (cable,) = read("1E6|3E6", "-20|1E4").scene.cables
    assert cable.BA_creep == pytest.approx(20.0 * 5.0 * np.sqrt(1e6 * 0.3)) and cable.BA == 1e4
    deck = read("1E6|3E6", "1e5")
    assert deck.scene.cables[0].BA == 0.0 and deck.scene.cables[0].compression == "none"
    assert any('"line1" creeps and only pulls' in remark for remark in deck.remarks)


@pytest.mark.parametrize("EA", ["1E6|3E6", "1E6|3E6|20.0"])
def test_written_and_read_again(EA):
    scene = read(EA, "2E6|1E4").scene
    assert f" {EA.replace('E6', '000000.0')} 2000000.0|10000.0 " in moordyn_text(scene)
    assert deck_from_text(moordyn_text(scene)).scene == scene


@pytest.mark.parametrize(
    ("EA", "BA", "says"),
    [
        ("1|2|3|4", "1|1", r"EA must be up to 3 numbers between bars, but is 1\|2\|3\|4"),
        ("1e6|x", "1|1", r"EA must be up to 3 numbers between bars, but is 1e6\|x"),
        ("1e6|2e6", "1|1|1", r"BA/-zeta must be up to 2 numbers between bars, but is 1\|1\|1"),
        ("1e6", "1|1", r"BA/-zeta must be one number where EA is, but is 1\|1"),
        ("2e6|1e6", "1|1", r"`EA_dynamic` must be larger than the EA"),
    ],
)
def test_refused(EA, BA, says):
    with pytest.raises(DeckError, match=says):
        read(EA, BA)


@pytest.mark.parametrize(("EA", "BA"), [*slow(("1E6|3E6", "1E6|1E4")), ("1E6|1.5E6|100", "1E6|1E4"), ("1E6|3E6", "-20|1E4")])
def test_moordyn_pulls_as_this_does(tmp_path, EA, BA):
    """A harmonic stretch that grows in a second. Both begin at rest, which MoorDyn finds to 7 N, and forgets in some seconds."""
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    (tmp_path / "rope.txt").write_text(DECK.format(EA=EA, BA=BA))
    t = np.linspace(0.0, 4.0, 401)
    s = np.clip(t, 0.0, 1.0)
    x = 20.2 + 0.06 * s**3 * (10.0 - 15.0 * s + 6.0 * s * s) * np.sin(2.0 * np.pi * t / 1.5)
    theirs = []
    with silence():
        engine = moordyn.Create(str(tmp_path / "rope.txt"))
        try:
            moordyn.Init(engine, [x[0], 0.0, -20.0], [0.0, 0.0, 0.0])
            line = moordyn.GetLine(engine, 1)
            for k in range(len(t) - 1):
                h = t[k + 1] - t[k]
                moordyn.Step(engine, [x[k], 0.0, -20.0], [(x[k + 1] - x[k]) / h, 0.0, 0.0], t[k], h)
                theirs.append(np.linalg.norm(moordyn.GetLineNodeTen(line, 2)))
        finally:
            moordyn.Close(engine)
    path = paths.samples(t, np.column_stack([x, 0.0 * x, -20.0 + 0.0 * x]))
    run = simulate(read(EA, BA, {2: path}).scene, 4.0, method="edmc", dt=0.005, save_every=0.01)
    ours = run.tension("line1")[1:, 1:3].mean(axis=1)
    assert np.ptp(theirs) > 5e3 and np.abs(ours - theirs)[:-1].max() < 2e-3 * np.ptp(theirs)
