"""Vortex-induced vibration in MoorDyn files: what is read and written, and MoorDyn itself beside it."""

from dataclasses import replace

import numpy as np
import pytest
from beside_moordyn import begun, nodes_of_line

from anet_lumped import equilibrium, read_moordyn, save_moordyn, simulate
from anet_lumped.effects import Water
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_findings import DeckError

DECK = """\
a taut riser of 10 m in a current
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx Cl dF cF
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-) (-) (-) (-)
riser 0.02 0.5 1e6 100 0 1.2 1.0 0 0 {columns}
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 0 0 -15 0 0 0 0
2 Fixed 0 0 -5 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 riser 1 2 9.99 {segments} -
--- OPTIONS ---
{dtM} dtM
rk4 tScheme
9.81 g
1000 rho
50 WtrDpth
1 Currents
20 TmaxIC
0 writeLog
--- OUTPUTS ---
--- need this line ---
"""
D = 0.02


def write(folder, columns="0.8 0.08 0.18", segments=10, dtM=2e-4, speeds=(1.0, 1.0)):
    """The deck, and a current that changes steadily from z = -15 to -5 m."""
    (folder / "deck.txt").write_text(DECK.format(columns=columns, segments=segments, dtM=dtM))
    rows = "\n".join(f"{z} {u} 0 0" for z, u in zip((-15, -5), speeds, strict=True))
    (folder / "current_profile.txt").write_text(f"a current\nz ux uy uz\n(m) (m/s) (m/s) (m/s)\n{rows}\n")


def read(folder, **how):
    return deck_from_text((folder / "deck.txt").read_text(), folder=folder, **how)


def test_numbers(tmp_path):
    write(tmp_path, "0.8 0.05 0.2")
    deck = read(tmp_path)
    (cable,) = deck.scene.cables
    assert (cable.Cl, cable.St_range, cable.St, cable.shedding_window) == (0.8, 0.05, 0.2, None)
    (remark,) = (remark for remark in deck.remarks if "Vortices" in remark)
    assert remark == (
        "Vortices shake line1. Vibrations are known by their mean squares over 10 periods of the vortices, where MoorDyn takes "
        "500 dtM; read_moordyn(..., like_moordyn=True) takes them."
    )
    alike = read(tmp_path, like_moordyn=True)
    assert alike.scene.cables[0] == replace(cable, shedding_window=0.1)
    assert not any("Vortices" in remark for remark in alike.remarks)


def test_without_a_step(tmp_path):
    write(tmp_path)
    text = (tmp_path / "deck.txt").read_text().replace("0.0002 dtM\n", "")
    deck = deck_from_text(text, folder=tmp_path, like_moordyn=True)
    assert deck.scene.cables[0].shedding_window is None
    assert any(remark.endswith("where MoorDyn takes 500 dtM, and the file gives no dtM.") for remark in deck.remarks)


@pytest.mark.parametrize(
    ("columns", "numbers"), [("0.8", (0.8, 0.08, 0.18)), ("0.8 0.05", (0.8, 0.05, 0.18)), ("0 0.5 0.1", (0.0, 0.08, 0.18))]
)
def test_defaults(tmp_path, columns, numbers):
    write(tmp_path, columns)
    (cable,) = read(tmp_path).scene.cables
    assert (cable.Cl, cable.St_range, cable.St) == numbers


def test_a_column_of_another_name(tmp_path):
    """MoorDyn reads it as the coefficient of lift all the same."""
    write(tmp_path)
    text = (tmp_path / "deck.txt").read_text().replace("CaAx Cl dF cF", "CaAx Cdt dF cF")
    remarks = deck_from_text(text, folder=tmp_path).remarks
    assert any("column 11 is read as Cl, as MoorDyn does, though the file calls it cdt." in remark for remark in remarks)


@pytest.mark.parametrize(
    ("columns", "says"),
    [
        ("-1", "`Cl` must be non-negative"),
        ("0.8 0.2 0.1", "`St_range` must be less than `St`"),
        ("x", "Cl must be a finite number"),
    ],
)
def test_refused(tmp_path, columns, says):
    write(tmp_path, columns)
    with pytest.raises(DeckError, match=says):
        read(tmp_path)


def test_written_and_read_back(tmp_path):
    write(tmp_path, "0.8 0.05 0.2")
    scene = read(tmp_path).scene
    still = replace(scene, effects=[replace(one, current=None) if isinstance(one, Water) else one for one in scene.effects])
    other = replace(still.cables[0], name="line2", Cl=0.0, St=0.18, St_range=0.08)
    both = replace(still, cables=[*still.cables, other])
    save_moordyn(both, tmp_path / "out.txt")
    with pytest.warns(UserWarning, match="Vortices shake line1"):
        assert read_moordyn(tmp_path / "out.txt").scene == both


def vibration(t, y):
    """Root mean squares of the vibration across the flow [d] at the nodes inside, and the mean frequency of its power [Hz]."""
    across = y[:, 1:-1, 1] - y[:, 1:-1, 1].mean(axis=0)
    power = (np.abs(np.fft.rfft(across * np.hanning(len(t))[:, None], axis=0)) ** 2).sum(axis=1)
    frequencies = np.fft.rfftfreq(len(t), t[1] - t[0])
    return np.sqrt((across**2).mean(axis=0)) / D, float(frequencies @ power / power.sum())


def of_moordyn(folder, segments, t_end):
    t, y = [], []
    with begun(folder / "deck.txt") as (moordyn, engine):
        for k in range(round(t_end / 0.01)):
            y.append(nodes_of_line(moordyn, engine, segments))
            t.append(0.01 * k)
            moordyn.Step(engine, [], [], t[-1], 0.01)
    return np.array(t), np.array(y)


@pytest.mark.parametrize("speeds", [pytest.param((1.0, 1.0), marks=pytest.mark.slow), (0.7, 1.1)])
def test_moordyn_vibrates_as_this_does(tmp_path, speeds):
    """A riser at rest, in a current that is there at once: how it vibrates from 6 to 12 s, in the same window of 500 dtM.

    They differ by 0.1 % and 0.3 % of the largest. In a stronger shear, from 0.4 to 1.2 m/s, several modes make the vibration
    irregular, and either code differs from itself with another step, by up to 8 % over 30 s.
    """
    segments, t_end = 10, 12.0
    write(tmp_path, segments=segments, speeds=speeds)
    t, y = of_moordyn(tmp_path, segments, t_end)
    scene = read(tmp_path, like_moordyn=True).scene
    still = replace(scene, effects=[replace(one, current=None) if isinstance(one, Water) else one for one in scene.effects])
    run = simulate(scene, t_end, method="edmc", dt=1e-3, save_every=0.01, start=equilibrium(still))
    late = slice(round(t_end / 0.02), round(t_end / 0.01))
    theirs, f = vibration(t[late], y[late])
    ours, own_f = vibration(t[late], run.q[late][:, run.model.nodes("line1")])
    assert theirs.max() > 0.3 and np.abs(ours - theirs).max() < 0.01 * theirs.max() and own_f == pytest.approx(f, rel=0.005)
    assert run.q[late][:, run.model.nodes("line1")[5], 0].mean() == pytest.approx(y[late][:, 5, 0].mean(), rel=0.005)
