"""Bodies and rods of MoorDyn files that are "CoupledPinned": they follow what moves their pins, and turn freely."""

import math
from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Driven, Session, SixMotions, equilibrium, paths, platform, signals, simulate
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.files.moordyn_writer import moordyn_text
from studies.peers.moordyn import silence

DECK = """\
--- LINE TYPES ---
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
thread 0.001 1e-5 10 -0.1 0 0 0 0 0
--- ROD TYPES ---
Name Diam Mass/m Cd Ca CdEnd CaEnd
(-) (m) (kg/m) (-) (-) (-) (-)
pole 0.25 77.7 0 0 0 0
--- RODS ---
ID Type Attachment Xa Ya Za Xb Yb Zb Segs Out
(-) (-) (-) (m) (m) (m) (m) (m) (m) (-) (-)
1 pole CoupledPinned 10 0 -5 10 0 -7 4 -
--- BODIES ---
ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca
(-) (-) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m^2) (m^3) (m^2) (-)
1 CoupledPinned 0 0 -5 0 0 0 900 0|0|-1 50 0 0 0
--- POINTS ---
ID Type X Y Z M V CdA Ca
(-) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 10 0 -30 0 0 0 0
2 Body1 0 0 -2 0 0 0 0
3 Fixed 0 0 -30 0 0 0 0
--- LINES ---
ID Type A B Length Segs Out
(-) (-) (-) (-) (m) (-) (-)
1 thread 1 R1B 40 4 -
2 thread 3 2 40 4 -
--- OPTIONS ---
200 WtrDpth
0 rho
9.81 g
0.0005 dtM
rk4 tScheme
0 TmaxIC
0 writeLog
1 disableOutput
--- OUTPUTS ---
--- need this line ---
"""
A, OMEGA = 0.5, 0.2 * math.pi  # [m], [rad/s] of the surge


def deck():
    return deck_from_text(DECK)


def test_they_are_pinned_to_driven_points():
    scene, remarks = deck().scene, deck().remarks
    for name, pinned, at in (("body1", "", (0.0, 0.0, -5.0)), ("rod1", "a", (10.0, 0.0, -5.0))):
        body = scene.body(name)
        assert (body.pinned, body.pinned_to, body.at) == (pinned, f"{name}.pin", at)
        assert scene.point(f"{name}.pin") == Driven(f"{name}.pin", paths.external(at))
    assert 'Body "body1" turns about its origin, which is pinned to "body1.pin".' in remarks
    assert 'End A of rod "rod1" is pinned to "rod1.pin", and the rod turns about it.' in remarks


def test_a_body_of_MoorDyn_that_is_pinned_to_nothing_stays():
    """MoorDyn 2.7.2 knows no such word of a body and lets it fall; of a rod it does."""
    read = deck_from_text(DECK.replace("CoupledPinned", "Pinned"))
    assert [(body.pinned, body.pinned_to) for body in read.scene.bodies] == [("", None), ("a", None)]
    assert (
        'The origin of body "body1" stays where it is, while the body turns about it; MoorDyn\'s C++ version lets it fall.'
        in read.remarks
    )


@pytest.mark.each_once
@pytest.mark.parametrize(("method", "step"), [("edmc", {"dt": 0.005}), ("dop853", {"rtol": 1e-8})])
@pytest.mark.parametrize(("name", "inertia_over_m_l"), [("rod1.b", 4 / 3 + 0.125**2 / 4), ("body1.point2", 950 / 900)])
def test_a_pendulum_whose_pivot_surges(method, step, name, inertia_over_m_l):
    """angle = omega²/g A Omega²/(omega² - Omega²) (cos Omega t - cos omega t), of a surge of A cos Omega t that begins at rest.

    omega² = g m l/J about the pivot, with l = 1 m of a solid cylinder and of the body. The equation is linear: of 2 mrad it leaves
    out 1e-6. A thread of 4 mN hangs at twice the arm of 1500 N: 4e-5 after 15 radians. Steps of edmc leave (omega dt)²/12 = 2e-5 of
    an angle for each radian, twice as much of the difference.
    """
    omega2, length = 9.81 / inertia_over_m_l, 2.0
    surge = SixMotions(surge=signals.harmonic(0.0, 0.1 * A, 0.1, phase=0.5 * math.pi))
    run = simulate(platform(deck().scene, surge, 5.0), 5.0, method=method, save_every=0.1, **step)
    omega, pin = math.sqrt(omega2), 0.1 * A * np.cos(OMEGA * run.t)
    size = omega2 / 9.81 * 0.1 * A * OMEGA**2 / (omega2 - OMEGA**2)
    angle = size * (np.cos(OMEGA * run.t) - np.cos(omega * run.t))
    found = run.position(name)[:, 0] - run.position(f"{name.split('.')[0]}.pin")[:, 0]
    assert run.status == "done" and run.position("rod1.a")[:, 0] == pytest.approx(10.0 + pin, abs=1e-9)
    assert found == pytest.approx(length * np.sin(angle), abs=(6e-4 if method == "edmc" else 6e-5) * length * size)


def test_a_body_moves_as_in_MoorDyn(tmp_path):
    """MoorDyn takes the pin's motion as linear between calls, 1 ms here: 0.03 mm after 4 s, half of it at half the time.

    Its rods that are pinned do not feel that their pin is accelerated, so they are not compared.
    """
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    file, apart, places = tmp_path / "deck.txt", 1e-3, []
    file.write_text(DECK)

    def at(t):
        return 0.1 * A * np.cos(OMEGA * t)

    with silence():
        engine = moordyn.Create(str(file))
        try:
            x, x_moves = np.zeros(moordyn.NCoupledDOF(engine)), np.zeros(moordyn.NCoupledDOF(engine))
            x[:6], x_moves[[0, 3]] = (0, 0, -5, 10, 0, -5), 1.0  # body, rod, and three numbers of no use
            moordyn.Init(engine, (x + x_moves * at(0.0)).tolist(), [0.0] * len(x))
            for k in range(4000):
                now, then = at(k * apart), at((k + 1) * apart)
                moordyn.Step(engine, (x + x_moves * now).tolist(), (x_moves * (then - now) / apart).tolist(), k * apart, apart)
                if k % 1000 == 999:
                    places.append(moordyn.GetPointPos(moordyn.GetPoint(engine, 2)))
        finally:
            moordyn.Close(engine)
    surge = SixMotions(surge=signals.harmonic(0.0, 0.1 * A, 0.1, phase=0.5 * math.pi))
    run = simulate(platform(deck().scene, surge, 4.0), 4.0, method="dop853", rtol=1e-8, save_every=1.0)
    assert run.position("body1.point2")[1:] == pytest.approx(np.array(places), abs=1e-5)
    assert np.ptp(run.position("body1.point2")[:, 0]) > 0.05


def test_a_platform_may_begin_elsewhere_and_turned():
    """The pins are where the platform has them at t = 0, at rest and in motion; a rod that hangs keeps its direction."""
    six = SixMotions(surge=signals.harmonic(2.0, 0.0, 0.0), yaw=signals.harmonic(0.5 * math.pi, 0.0, 0.0))
    rest = equilibrium(platform(deck().scene, six, 1.0))
    assert rest.position("rod1.a") == pytest.approx((2.0, 10.0, -5.0), abs=1e-9)
    assert rest.position("rod1.b") == pytest.approx((2.0, 10.0, -7.0), abs=0.01)  # drawn aside by its thread
    assert rest.position("body1") == pytest.approx((2.0, 0.0, -5.0), abs=1e-9)


def test_a_session_moves_a_pin():
    with Session(deck().scene, dt=0.01) as session:
        for k in range(1, 51):
            session.drive("body1.pin", (0.001 * k, 0.0, -5.0), (0.1, 0.0, 0.0))
            session.step()
        assert session.state.position("body1") == pytest.approx((0.05, 0.0, -5.0), abs=1e-9)


def test_they_are_written_and_read_back():
    """A rod that a driven point holds is written as a body with a rod on it, as every rod that is a body of its own."""
    scene = deck().scene
    text = moordyn_text(scene)
    assert text.count("CoupledPinned") == 2 and "Coupled " not in text
    back = deck_from_text(text).scene
    assert set(back.points) == set(scene.points) and back.cables == tuple(replace(cable, end=cable.end) for cable in scene.cables)
    for name in ("body1", "rod1"):
        one, other = back.body(name), scene.body(name)
        assert (one.at, one.pinned_to, one.mass, one.whole.total) == (other.at, other.pinned_to, other.mass, other.whole.total)


def test_a_pin_at_which_a_cable_ends_is_written():
    scene = deck().scene
    cables = [*scene.cables, replace(scene.cables[0], start="point3", end="rod1.pin", name="more")]
    text = moordyn_text(replace(scene, cables=cables))
    assert text.count("CoupledPinned") == 2 and text.count("Coupled ") == 1
