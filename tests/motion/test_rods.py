"""Rods: mass and inertia, what falls through water and floats in it, alone, pinned, on a cable and as a part of a body."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from anet_lumped import Body, Cable, Fixed, Free, Rod, Scene, SceneError, equilibrium, rod_body, simulate
from anet_lumped.effects import Air, Gravity, Water
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

G, RHO = 9.81, 1025.0
D, LENGTH, MU, N = 0.1, 4.0, 12.0, 8
AREA = 0.25 * math.pi * D**2
COEFFICIENTS = dict(Cdn=1.1, Cdt=0.02, Can=0.9, Cat=0.1, Cd_end=0.8, Ca_end=0.6)
THIN = dict(mass_per_length=1e-6, EA=1e4, diameter=1e-4)


def alone(body, *effects):
    points = [Fixed("far", (60.0, 0.0, 30.0)), Free("tip", at=(61.0, 0.0, 30.0))]
    return Scene(points, [Cable("far", "tip", length=1.0, segments=2, **THIN)], [Gravity(G), *effects], bodies=[body])


def rod(start, end, **given):
    made = dict(diameter=D, mass_per_length=MU, segments=N) | COEFFICIENTS | given
    return rod_body("rod", start, end, **made)


LEVEL, UPRIGHT = ((-2.0, 0.0, -50.0), (2.0, 0.0, -50.0)), ((0.0, 0.0, -50.0), (0.0, 0.0, -46.0))


def drag(ends):
    """Coefficients k of the force k v^2 on a rod that falls, and its added mass that way."""
    if ends is LEVEL:
        return 0.5 * RHO * COEFFICIENTS["Cdn"] * D * LENGTH, RHO * AREA * LENGTH * COEFFICIENTS["Can"]
    along = math.pi * COEFFICIENTS["Cdt"] * D * LENGTH + 2.0 * COEFFICIENTS["Cd_end"] * AREA
    caps = 2.0 * COEFFICIENTS["Ca_end"] * math.pi * D**3 / 12.0
    return 0.5 * RHO * along, RHO * (AREA * LENGTH * COEFFICIENTS["Cat"] + caps)


def test_mass_and_inertia_are_those_of_a_solid_cylinder():
    body = rod((1.0, 2.0, 3.0), (3.0, 2.0, 3.0))
    m = 2.0 * MU
    across, along = m * (3.0 * (0.5 * D) ** 2 + 4.0) / 12.0, 0.5 * m * (0.5 * D) ** 2
    assert body.whole.total == pytest.approx(m)
    assert_allclose(body.whole.centre, (0.0, 0.0, 1.0))
    assert_allclose(body.whole.inertia, np.diag([across, across, along]), atol=1e-12)
    points = {point.name: point for point in body.points}
    assert_allclose(points["rod.b"].at, (3.0, 2.0, 3.0), atol=1e-15)
    masses, arms = np.array([p.mass for p in body.points]), np.array([p.arm for p in body.points])
    assert masses.sum() == pytest.approx(m)
    second = np.einsum("k,kx,ky->xy", masses, arms - (0, 0, 1), arms - (0, 0, 1))
    assert_allclose(np.trace(second) * np.eye(3) - second, body.whole.inertia, atol=1e-9 * across)


def test_a_rod_adds_its_mass_to_that_of_its_body():
    """Two point-like masses and a rod between them: sums and Steiner's theorem."""
    leg = Rod("leg", (1.0, 0.0, 0.0), (1.0, 0.0, -2.0), diameter=0.1, mass_per_length=3.0)
    body = Body("b", mass=4.0, inertia=(0.5, 0.6, 0.7), at=(0.0, 0.0, 0.0), centre_of_mass=(-0.5, 0.0, 0.0), rods=[leg])
    centre = (4.0 * np.array([-0.5, 0.0, 0.0]) + 6.0 * np.array([1.0, 0.0, -1.0])) / 10.0
    assert_allclose(body.whole.centre, centre)
    d1, d2 = np.array([-0.5, 0.0, 0.0]) - centre, np.array([1.0, 0.0, -1.0]) - centre
    about_y = 0.6 + 4.0 * (d1[0] ** 2 + d1[2] ** 2) + 6.0 * (3 * 0.05**2 + 4.0) / 12.0 + 6.0 * (d2[0] ** 2 + d2[2] ** 2)
    assert body.whole.inertia[1, 1] == pytest.approx(about_y)


@pytest.mark.each_once
@pytest.mark.parametrize("method", ["edmc", "dop853"])
@pytest.mark.parametrize("ends", [LEVEL, UPRIGHT], ids=["broadside", "endwise"])
def test_it_falls_by_the_hyperbolic_tangent(ends, method):
    """(m + added) dv/dt = weight - k v^2."""
    t_end, steps = (0.25, {"rtol": 1e-8}) if method == "dop853" else (3.0, {"dt": 0.005})  # the cable beside it asks for short ones
    run = simulate(alone(rod(*ends), Water(RHO)), t_end, method=method, start="straight", save_every=t_end / 12, **steps)
    k, added = drag(ends)
    weight = (MU - RHO * AREA) * LENGTH * G
    speed, rate = math.sqrt(weight / k), math.sqrt(weight * k) / (MU * LENGTH + added)
    expected = -speed * np.tanh(rate * run.t)
    assert_allclose(run.velocity("rod.b")[:, 2], expected, atol=(1e-7 if method == "dop853" else 2e-5) * speed)
    assert abs(run.energy_balance.imbalance) < 1e-7


def test_many_nodes_at_a_steady_speed_far_from_the_origin():
    """Weight and drag cancel, and what rounding leaves of the places of many light nodes does not keep a step from its end."""
    body = rod((-2.0, 0.0, -50.0), (2.0, 0.0, -50.0), segments=60, mass_per_length=60.0)
    run = simulate(alone(body, Water(RHO)), 8.0, method="edmc", dt=0.01, start="straight")
    k = drag(LEVEL)[0]
    assert run.status == "done"
    assert run.velocity("rod.a")[-1, 2] == pytest.approx(-math.sqrt((60.0 - RHO * AREA) * LENGTH * G / k), rel=1e-8)
    assert_allclose(run.rotation("rod")[-1][:, 2], (1.0, 0.0, 0.0), atol=1e-11)


def test_in_air_it_falls_by_the_drag_of_the_air():
    run = simulate(alone(rod(*LEVEL), Air(1.225)), 60.0, method="edmc", dt=0.05, start="straight")
    k = drag(LEVEL)[0] * 1.225 / RHO
    assert run.velocity("rod.a")[-1, 2] == pytest.approx(-math.sqrt(MU * LENGTH * G / k), rel=1e-4)


def test_a_spar_floats_at_its_draft_and_heaves():
    """Draft m/(rho A); period 2 pi sqrt((m + added)/(rho g A)) with the added mass of one cap."""
    m, ballast, cap = MU * 0.4 * LENGTH, 10.0, RHO * COEFFICIENTS["Ca_end"] * math.pi * D**3 / 12.0
    spar = Rod(
        "spar", (0.0, 0.0, 0.0), (0.0, 0.0, LENGTH), diameter=D, mass_per_length=0.4 * MU, segments=N,
        **(COEFFICIENTS | {"Cdn": 0.0, "Cdt": 0.0, "Cd_end": 0.0, "Cat": 0.0}),
    )  # fmt: skip
    draft = (m + ballast) / (RHO * AREA)
    assert 1.0 < draft < LENGTH - 0.3
    body = Body("b", mass=ballast, inertia=(0.01,) * 3, at=(0.0, 0.0, 0.05 - draft), rods=[spar])
    run = simulate(alone(body, Water(RHO)), 12.0, method="edmc", dt=0.005, start="straight", save_every=0.005)
    z = run.position("b")[:, 2] + draft
    up = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
    times = run.t[up] - z[up] * (run.t[up + 1] - run.t[up]) / (z[up + 1] - z[up])
    exact = 2.0 * math.pi * math.sqrt((m + ballast + cap) / (RHO * G * AREA))
    assert_allclose(np.diff(times).mean(), exact, rtol=1e-4)
    assert z.max() == pytest.approx(0.05, abs=1e-4) and z.min() == pytest.approx(-0.05, abs=1e-4)  # nothing takes energy
    assert abs(run.energy_balance.imbalance) < 1e-8  # what Newton's method leaves out of balance


def test_a_floating_rod_leans_on_its_cable():
    """Tied down at one end by a vertical cable, at the depth h: moments about that end leave sqrt(s) of its length under water.

    s is its density over that of water: rho A l^2/2 = mu L^2/2, and the sine of its slope is h/l. The cable pulls with
    rho A g l - mu g L.
    """
    s, h, depth = 0.25, 0.8, 3.0
    mu = s * RHO * AREA
    body = rod((0.0, 0.0, -h), (math.sqrt(LENGTH**2 - h**2), 0.0, 0.0), mass_per_length=mu)
    cable = Cable("bed", "rod.a", length=depth - h, segments=1, **(THIN | {"EA": 1e9}))
    rest = equilibrium(Scene([Fixed("bed", (0.0, 0.0, -depth))], [cable], [Gravity(G), Water(RHO)], bodies=[body]))
    wet = math.sqrt(s) * LENGTH
    along = (rest.position("rod.b") - rest.position("rod.a")) / LENGTH
    assert rest.stable
    assert along[2] == pytest.approx(h / wet, rel=1e-3)  # the surface cuts a cylinder of diameter d: (d/l)^2
    assert rest.tension("bed-rod.a")[0] == pytest.approx((RHO * AREA * wet - mu * LENGTH) * G, rel=1e-3)
    assert_allclose(rest.position("rod.a")[:2], np.zeros(2), atol=1e-6)


def test_a_pinned_rod_swings_in_water():
    """Small swings about its upper end: T = 2 pi sqrt((J + Can rho A L^3/3)/((mu - rho A) g L^2/2)), without drag."""
    quiet = dict(Cdn=0.0, Cdt=0.0, Cd_end=0.0, Ca_end=0.0, Cat=0.0)
    angle = 0.02
    ends = (0.0, 0.0, -10.0), (LENGTH * math.sin(angle), 0.0, -10.0 - LENGTH * math.cos(angle))
    body = rod(*ends, pinned="a", mass_per_length=MU, segments=20, **quiet)
    run = simulate(alone(body, Water(RHO)), 20.0, method="edmc", dt=0.01, start="straight", save_every=0.01)
    x = run.position("rod.b")[:, 0]
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    times = run.t[up] - x[up] * (run.t[up + 1] - run.t[up]) / (x[up + 1] - x[up])
    J = MU * LENGTH * (3.0 * (0.5 * D) ** 2 + LENGTH**2) / 12.0 + MU * LENGTH**3 / 4.0
    # added mass in nodes: the halves of a segment at its ends have 1 + 1/(2 n^2) of the moment of a line
    added = 0.9 * RHO * AREA * LENGTH**3 / 3.0 * (1.0 + 0.5 / 20**2)
    exact = 2.0 * math.pi * math.sqrt((J + added) / ((MU - RHO * AREA) * G * LENGTH**2 / 2.0))
    assert_allclose(np.diff(times).mean(), exact, rtol=2e-4)


def test_two_ropes_carry_a_rod_level():
    """A rod hangs level from two alike ropes, each with half of its weight in water."""
    body = rod((-2.0, 0.0, -10.0), (2.0, 0.0, -10.0))
    points = [Fixed("l", (-2.0, 0.0, -5.0)), Fixed("r", (2.0, 0.0, -5.0))]
    cables = [Cable(a, f"rod.{b}", length=5.0, segments=4, **(THIN | {"EA": 1e6})) for a, b in (("l", "a"), ("r", "b"))]
    rest = equilibrium(Scene(points, cables, [Gravity(G), Water(RHO)], bodies=[body]))
    for name in ("l-rod.a", "r-rod.b"):
        assert rest.tension(name)[-1] == pytest.approx(0.5 * (MU - RHO * AREA) * LENGTH * G, rel=1e-4)
    assert rest.position("rod.a")[2] == pytest.approx(rest.position("rod.b")[2], abs=1e-8)


def test_a_scene_with_rods_goes_to_a_file_and_back():
    scene = alone(Body("b", mass=1.0, inertia=(0.1,) * 3, at=(0, 0, 0), rods=[Rod("leg", (0, 0, 0), (0, 0, 1), diameter=0.1)]))
    assert scene_from_dict(scene_to_dict(scene)) == scene


@pytest.mark.parametrize(
    "given, match",
    [
        (dict(diameter=0.0), "`diameter`"),
        (dict(segments=0), "`segments`"),
        (dict(Ca_end=-1.0), "`Ca_end`"),
        (dict(pinned="c"), "`pinned`"),
    ],
)
def test_messages(given, match):
    with pytest.raises(SceneError, match=match):
        rod(*LEVEL, **given)
    with pytest.raises(SceneError, match='A rod must have a length, but rod "rod"'):
        rod((0, 0, 0), (0, 0, 0))
