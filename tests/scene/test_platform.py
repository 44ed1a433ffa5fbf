"""Platforms that carry points: coupled points of a deck move as one, and a run in which nothing moves says so."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import (
    Cable,
    Driven,
    Fixed,
    Scene,
    SceneError,
    SixMotions,
    load_scene,
    paths,
    platform,
    save_scene,
    signals,
    simulate,
)
from anet_lumped.effects import Gravity
from anet_lumped.files.moordyn_file import deck_from_text
from studies.peers.moordyn import silence

FAIRLEADS = {"f1": (5.0, 0.0, -1.0), "f2": (-4.0, 3.0, -1.0)}
CHAINS = Scene(
    [
        Fixed("a1", (40.0, 0.0, -20.0)),
        Fixed("a2", (-40.0, 3.0, -20.0)),
        *(Driven(n, paths.external(at)) for n, at in FAIRLEADS.items()),
    ],
    [Cable(f"a{i}", f"f{i}", length=48.0, mass_per_length=5.0, EA=1e6, zeta=0.5, segments=12) for i in (1, 2)],
    [Gravity(9.81)],
)
MOTIONS = SixMotions(surge=signals.harmonic(0.0, 1.0, 0.1), yaw=signals.harmonic(0.0, 0.1, 0.1))


def test_points_move_as_one_body():
    moved = platform(CHAINS, MOTIONS, 10.0)
    run = simulate(moved, 10.0)
    assert run.ok and not any("stood still" in warning for warning in run.warnings)
    one, other = run.position("f1"), run.position("f2")
    assert np.ptp(one[:, 0]) > 1.5 and np.ptp(one[:, 1]) > 0.5
    assert np.ptp(np.linalg.norm(one - other, axis=1)) < 1e-9
    t, arm = run.t, np.array(FAIRLEADS["f1"])
    angle, surge = 0.1 * np.sin(0.2 * np.pi * t), np.sin(0.2 * np.pi * t)
    assert np.allclose(one[:, 0], surge + np.cos(angle) * arm[0] - np.sin(angle) * arm[1], atol=1e-9)


def test_a_platform_carries_those_that_are_named_about_its_origin():
    moved = platform(CHAINS, SixMotions(yaw=signals.harmonic(0.3, 0.0, 0.0)), 1.0, points=["f2"], origin=(-4.0, 3.0, 7.0))
    assert moved.point("f1") == CHAINS.point("f1")
    assert np.allclose(moved.point("f2").path.at(0.5)[0], FAIRLEADS["f2"], atol=1e-12)
    assert moved.cables == CHAINS.cables and moved.effects == CHAINS.effects


def test_a_moved_scene_is_written_and_read(tmp_path):
    moved = platform(CHAINS, MOTIONS, 2.0)
    save_scene(moved, tmp_path / "moved.toml")
    assert load_scene(tmp_path / "moved.toml") == moved


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: platform(CHAINS, "surge", 1.0), 'The motions of a platform must be SixMotions, but they are "?.surge'),
        (
            lambda: platform(CHAINS, MOTIONS, 1.0, points=["a1"]),
            'must carry points with the path paths.external, but "a1" has another',
        ),
        (lambda: platform(CHAINS, MOTIONS, 1.0, points=["f3"]), 'The scene has no point "f3"'),
        (lambda: platform(platform(CHAINS, MOTIONS, 1.0), MOTIONS, 1.0), "must carry points that are driven from outside"),
        (lambda: platform(CHAINS, MOTIONS, 0.0), "`t_end` must be positive"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_a_run_in_which_nothing_moves_says_so():
    (warning,) = simulate(CHAINS, 1.0).warnings
    assert warning.startswith(
        'Nothing moves in this run: 2 points, from "f1" on, are driven from outside and stood still; platform('
    )
    fixed = replace(CHAINS, points=[*CHAINS.points[:2], *(Fixed(name, at) for name, at in FAIRLEADS.items())])
    assert simulate(fixed, 1.0).warnings == ()


DECK = """\
two chains of a pontoon
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
chain 0.08 60 5e6 -0.8 0 1.3 1 0.2 0
--- BODIES ---
ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca
(#) (-) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m2) (m3) (m2) (-)
1 Coupled 0 0 0 0 0 0 0 0 0 0 0 0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 70 10 -50 0 0 0 0
2 Fixed -70 0 -50 0 0 0 0
3 Body1 12 3 -4 0 0 0 0
4 Body1 -12 0 -4 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 chain 1 3 80 16 -
2 chain 2 4 80 16 -
--- OPTIONS ---
0.002 dtM
rk4 tScheme
400 WtrDpth
0 kBot
0 cBot
0 writeLog
1 disableOutput
--- OUTPUTS ---
--- need this line ---
"""


def test_moordyns_body_moves_the_same_points(tmp_path):
    """Surge, heave, roll and yaw of a coupled body: places to 1e-6 m, and what its chains pull to 0.5 % of the largest tension.

    MoorDyn moves its body by mean velocities over coupling steps of 10 ms. Our steps keep tensions to 2 %, and are within 0.4 %
    here after the first 5 s, in which chains that are jerked from rest ring.
    """
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    (tmp_path / "pontoon.txt").write_text(DECK)
    motions = SixMotions(
        surge=signals.harmonic(0.0, 1.0, 0.1), heave=signals.harmonic(0.0, 0.5, 0.1),
        roll=signals.harmonic(0.0, 0.05, 0.1), yaw=signals.harmonic(0.0, 0.1, 0.1),
    )  # fmt: skip
    scene = platform(deck_from_text(DECK).scene, motions, 20.0)
    ours = simulate(scene, 20.0, save_every=0.5)
    places, pulls, h = [], [], 0.01
    with silence():
        engine = moordyn.Create(str(tmp_path / "pontoon.txt"))
        try:
            moordyn.Init(engine, [0.0] * 6, [0.0] * 6)
            for k in range(2000):
                now, after = motions.at(k * h), motions.at((k + 1) * h)
                moordyn.Step(engine, now[0].tolist(), ((after[0] - now[0]) / h).tolist(), k * h, h)
                if (k + 1) % 50 == 0:
                    places.append([moordyn.GetPointPos(moordyn.GetPoint(engine, i)) for i in (3, 4)])
                    pulls.append([np.linalg.norm(moordyn.GetLineNodeTen(moordyn.GetLine(engine, i), 16)) for i in (1, 2)])
        finally:
            moordyn.Close(engine)
    theirs = np.array(places)
    mine = np.stack([ours.position("point3"), ours.position("point4")], axis=1)[1:]
    assert np.allclose(mine, theirs, atol=1e-6)
    tension = np.stack([ours.tension("line1")[1:, -1], ours.tension("line2")[1:, -1]], axis=1)
    late = ours.t[1:] > 5.0
    off = np.abs(tension - pulls)[late].max() / np.max(pulls)
    assert off < 0.005, off
