"""Obstacles, against Atwood's machine, the capstan, a rope that slides off a table, and statics by other means."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import (
    Body,
    Cable,
    Driven,
    Fixed,
    Free,
    Scene,
    SceneError,
    State,
    equilibrium,
    load_scene,
    paths,
    save_scene,
    shapes,
    simulate,
)
from anet_lumped.effects import Gravity, Obstacles, obstacles
from anet_lumped.effects.laws.solid import depth, numbers_of
from anet_lumped.model.build import build
from anet_lumped.motion.run_warnings import Finding, findings

G, MU = 9.81, 0.1
R = 0.2  # m, of the drum
DRUM = shapes.Cylinder((0, 0, 0), R)
SHAPES = {
    "ball": shapes.Sphere((0.1, 0.0, -0.1), 0.5),
    "roll": shapes.Cylinder((0.0, 0.1, 0.2), 0.4, axis=(1.0, 2.0, 0.5)),
    "drum": shapes.Cylinder((0.0, 0.1, 0.2), 0.4, axis=(1.0, 0.2, 0.5), length=0.7, edge=0.1),
    "box": shapes.Box((0.0, 0.1, 0.0), (1.0, 0.8, 0.6), (0.3, 0.4, 1.0), edge=0.15),
}


def rope(effects, start, length, segments, mu=MU, EA=1e6, first=None, last=None):
    """Scene of one rope with the ends given or free, and the State with its nodes at places at rest."""
    first, last = first or Free("a", at=tuple(start[0])), last or Free("b", at=tuple(start[-1]))
    cable = Cable(
        first.name, last.name, length=length, mass_per_length=mu, EA=EA, segments=segments, diameter=0.01, zeta=0.3, name="rope"
    )
    scene = Scene([first, last], [cable], [Gravity(G), *effects])
    return scene, State.of(scene, shapes={"rope": start})


def over_the_drum(L0, segments):
    """Nodes on the drum, chords L0 apart, and straight down from where they leave it, (segments + 1, 3) [m]."""
    turn = 2.0 * np.arcsin(0.5 * L0 / R)
    on = int(np.pi / turn) // 2 * 2
    angle = turn * (np.arange(on + 1) - on / 2)
    places = list(R * np.column_stack([np.sin(angle), 0.0 * angle, np.cos(angle)]))
    for _ in range((segments - on) // 2):
        for at, side in ((0, -R), (-1, R)):
            aside = side - places[at][0]
            below = places[at] + np.array([aside, 0.0, -np.sqrt(L0**2 - aside**2)])
            places.insert(0, below) if at == 0 else places.append(below)
    return np.array(places)


def rise(run):
    """Largest rise of the mechanical energy from one saved state to the next [J]."""
    return np.diff(run.energy[:, :3].sum(axis=1)).max()


@pytest.mark.parametrize("name", SHAPES)
def test_depths(name):
    """Distance from the surface, as geometry says, within and beyond the core."""
    shape = SHAPES[name]
    x = np.random.default_rng(1).uniform(-0.9, 0.9, (300, 3))
    params = numbers_of(shape.at, shape.solid())
    found = [depth(x, i, params, 0) for i in range(len(x))]
    own = (x - shape.at) @ shape.solid().rows.T  # rows are orthonormal: see below
    np.testing.assert_allclose(shape.solid().rows @ shape.solid().rows.T, np.eye(3), atol=1e-15)
    if name == "ball":
        expected = 0.5 - np.linalg.norm(own, axis=1)
    elif name == "roll":
        expected = 0.4 - np.linalg.norm(np.cross(x - shape.at, shape.axis), axis=1) / np.linalg.norm(shape.axis)
    else:
        out = np.abs(own) - (0.35, 0.25, 0.15)
        if name == "drum":
            along = (x - shape.at) @ shape.axis / np.linalg.norm(shape.axis)
            across = np.sqrt(np.sum((x - shape.at) ** 2, axis=1) - along**2)
            out = np.column_stack([across - 0.3, np.abs(along) - 0.25])
        expected = shape.edge - np.linalg.norm(np.maximum(out, 0.0), axis=1) - np.minimum(out.max(axis=1), 0.0)
    np.testing.assert_allclose(found, expected, atol=1e-14)
    assert (expected > 0.0).sum() > 10 and (expected < 0.0).sum() > 10


def test_a_box_is_turned_as_a_body_is():
    """By 45 degrees about z: its long axis lies along (1, 1, 0)."""
    beam = shapes.Box((0, 0, 0), (2.0, 0.2, 0.2), rotation=(0.0, 0.0, np.pi / 4))
    x = np.array([(0.6, 0.6, 0.0), (0.6, -0.6, 0.0)])
    along, across = (depth(x, i, numbers_of(beam.at, beam.solid()), 0) for i in (0, 1))
    assert along == pytest.approx(0.1, abs=1e-12) and across == pytest.approx(0.1 - 0.6 * np.sqrt(2.0))


def scattered(shape, seed, friction):
    """Table of an effect, and random places near its shape."""
    scene, _ = rope([Obstacles(shape, 1e5, 10.0, friction)], np.linspace((0, 0, 0), (1, 0, 0), 41), 1.0, 40)
    model, rng = build(scene), np.random.default_rng(seed)
    return model, *scene.effects[1].table(model), rng.uniform(-0.55, 0.55, (model.n, 3)), rng


@pytest.mark.parametrize("size", [1.0, 0.02, 1e-7])
@pytest.mark.parametrize("damper", [0.0, 0.5])
@pytest.mark.parametrize("name", SHAPES)
def test_step_gives_back_no_more_than_the_energy(name, damper, size):
    model, index, params, base, rng = scattered(SHAPES[name], 3, 0.7)
    q, h, near = base + size * rng.normal(size=base.shape), 0.01, np.zeros((0, 2, 3, 3))
    f, K = np.zeros_like(q), np.zeros((model.n_free, 3, 3))
    taken, by_method = obstacles.whole_step(0.0, h, damper, base, q, index, params, f, K, near, near)
    change = obstacles.energy(0.0, q, index, params) - obstacles.energy(0.0, base, index, params)
    lost, work = taken + by_method, np.sum(f * (q - base))
    assert taken > 0.0 and by_method >= 0.0 and (by_method > 0.0) == (damper > 0.0)
    rounding = 1e-13 * obstacles.energy(0.0, base, index, params)
    assert change == pytest.approx(-work - lost, rel=1e-9, abs=1e-10 * lost + rounding)


@pytest.mark.parametrize("size", [1.0, 0.02])
@pytest.mark.parametrize("name", SHAPES)
def test_derivatives(name, size):
    """Taylor's remainder is of order 2, with friction and dampers, of a step and of the force at one time."""
    model, index, params, base, rng = scattered(SHAPES[name], 5, 0.7)
    q, near = base + size * rng.normal(size=base.shape), np.zeros((0, 2, 3, 3))
    d, v = rng.normal(size=q.shape), rng.normal(size=q.shape)

    def of_step(x):
        f, K = np.zeros_like(q), np.zeros((model.n_free, 3, 3))
        obstacles.whole_step(0.0, 0.01, 0.5, base, q + x * d, index, params, f, K, near, near)
        return f, K

    def at_once(x):
        f, K = np.zeros_like(q), np.zeros((model.n_free, 3, 3))
        obstacles.force(0.0, base + x * d, v + 3.0 * x * d, index, params, f)
        obstacles.tangent(0.0, base + x * d, v + 3.0 * x * d, index, params, 1.0, 3.0, K, near, near)
        return f, K

    for act in (of_step, at_once):
        f, K = act(0.0)
        steps = 10.0 ** -np.arange(4.5, 6.1, 0.5)
        off = [np.linalg.norm(act(x)[0] - f + x * np.einsum("ixy,iy->ix", K, d)) for x in steps]
        assert np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_atwoods_machine_with_a_heavy_rope():
    """x = dm/(2 mu) (cosh(sqrt(2 mu g/M) t) - 1) over a drum without friction, M the mass of all."""
    N, L = 120, 3.0
    start = over_the_drum(L / N, N)
    weights = Free("a", mass=1.0, at=tuple(start[0])), Free("b", mass=1.2, at=tuple(start[-1]))
    scene, start = rope([Obstacles(DRUM)], start, L, N, first=weights[0], last=weights[1])
    run = simulate(scene, 0.4, method="edmc", dt=0.002, start=start)
    sunk = run.position("b")[0, 2] - run.position("b")[:, 2]
    expected = 0.2 / (2.0 * MU) * (np.cosh(np.sqrt(2.0 * MU * G / 2.5) * run.t) - 1.0)
    polygon = R * (L / N / R) ** 2 / 8.0  # by which a polygon's height changes as it rolls on: 0.4 of 63 mm
    np.testing.assert_allclose(sunk, expected, atol=polygon)
    assert sunk[-1] > 0.06 and rise(run) < 1e-9 and run.work.newton_iterations < 4 * run.work.steps


def test_capstan():
    """A rope that slips over a drum: T_1/T_2 = exp(mu theta), and of a polygon the product over its corners, exactly."""
    friction, N, L, v = 0.3, 60, 2.0, 0.1
    start = over_the_drum(L / N, N)
    pulled = Driven("a", paths.line(tuple(start[0]), (0.0, 0.0, -v), ramp=0.4))
    load = Free("b", mass=2.0, at=tuple(start[-1]))
    scene, start = rope([Obstacles(DRUM, friction=friction)], start, L, N, mu=1e-3, EA=1e4, first=pulled, last=load)
    run = simulate(scene, 2.6, method="edmc", dt=0.002, start=start)
    late = run.t > 0.93  # five segments long
    T = run.tension("rope")[late].mean(axis=0)
    turn = 2.0 * np.arcsin(0.5 * L / N / R)
    corners = np.pi / turn * 2.0 * np.arctanh(friction * np.tan(0.5 * turn))  # N = 2 T sin(turn/2) and friction at each
    assert np.log(T[0] / T[-1]) == pytest.approx(corners, rel=1e-3)  # rope's own weight: 1e-3 of the load
    assert T[0] / T[-1] == pytest.approx(np.exp(friction * np.pi), rel=4e-3)
    assert run.ok and run.energy_balance.imbalance < 1e-6


def test_a_rope_slides_off_a_table():
    """Its lower end is at the depth Z = Z_0 cosh(sqrt(g/L) t), until the rope would lift off the edge."""
    N, L, edge, over = 80, 2.0, 0.1, 0.5
    s = np.linspace(0.0, L, N + 1) - (L - over)  # from where the edge begins
    a = np.clip(s / edge, 0.0, np.pi / 2)
    start = np.column_stack([np.minimum(s, 0.0) + edge * np.sin(a), 0.0 * s, edge * (np.cos(a) - 1.0)])
    start[:, 2] -= np.maximum(s - edge * np.pi / 2, 0.0)
    table = shapes.Box((edge - 2.0, 0.0, -1.0), (4.0, 2.0, 2.0), edge=edge)
    scene, start = rope([Obstacles(table)], start, L, N)
    run = simulate(scene, 0.5, method="edmc", dt=0.002, start=start)
    Z = -run.position("b")[:, 2]
    np.testing.assert_allclose(Z, Z[0] * np.cosh(np.sqrt(G / L) * run.t), atol=edge * (L / N / edge) ** 2 / 8.0)  # the polygon's
    assert Z[-1] > 1.6 * Z[0] and rise(run) < 1e-9


def test_a_rope_over_a_ball_at_rest():
    """z = -0.4003 m by minimisation of the energy (scipy's L-BFGS-B); and it says that it would slip off."""
    points = [Fixed("a", (-2, 0, 0)), Fixed("b", (2, 0, 0))]
    cable = Cable("a", "b", length=5.0, mass_per_length=4.0, EA=1e5, segments=20, diameter=0.02)
    ball = Obstacles(shapes.Sphere((0, 0, -0.9), 0.5), stiffness=2e7, friction=0.3)  # 1e5 N/m a node
    laid = equilibrium(Scene(points, [cable], [Gravity(), ball]), start="straight")
    assert laid.shape("a-b")[10, 2] == pytest.approx(-0.4003, abs=5e-5)
    assert laid.stable is False and laid.residual <= 1e-9


def test_a_drum_carries_a_rope_at_rest():
    """Let down from above, without a guess. It slides to one side; the drum carries what the supports do not, and presses T/R."""
    points = [Fixed("a", (-1, 0, 0)), Fixed("b", (1, 0, 0))]
    cable = Cable("a", "b", length=2.6, mass_per_length=4.0, EA=1e5, segments=52, diameter=0.02)
    drum = Obstacles(shapes.Cylinder((0, 0, -0.5), 0.3, length=1.0))
    rest = equilibrium(Scene(points, [cable], [Gravity(G), drum]))
    z, T, f = rest.shape("a-b")[:, 2], rest.tension("a-b"), drum.force_on(rest)
    top = 11 + int(z[11:-11].argmax())
    assert rest.stable and z[top] == pytest.approx(-0.2, abs=1e-3)
    carried = sum(rest.reaction(end)[2] for end in "ab") - f[:, 2].sum()
    assert carried == pytest.approx(2.6 * 4.0 * G, rel=1e-9)
    pressed = 2.0 * T[top - 1 : top + 1].mean() * np.sin(0.5 * 0.05 / 0.3) + 4.0 * 0.05 * G
    assert -f[rest.model.nodes("a-b")[top], 2] == pytest.approx(pressed, rel=2e-3)  # a chord for an arc; 0.3 degrees from the top


@pytest.mark.each_once
@pytest.mark.parametrize("EA", [1e3, 1e7])
@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize(("dt", "friction"), [(0.001, 0.5), (0.005, 0.0), (0.02, 0.5)])
def test_the_energy_never_rises_from_a_hard_start(name, EA, dt, friction):
    """A rope with two masses falls on an obstacle and slides off, without dampers of its own."""
    shape = replace(SHAPES[name], at=(0.1, 0.05, -0.8))
    points = [Free("a", mass=0.1, at=(-0.6, 0, 0)), Free("b", mass=0.2, at=(0.7, 0.1, 0.1))]
    cable = Cable("a", "b", length=1.31, mass_per_length=0.1, EA=EA, segments=20, diameter=0.01, zeta=0.0)
    effect = Obstacles(shape, friction=friction)
    run = simulate(Scene(points, [cable], [Gravity(G), effect]), 0.6, method="edmc", dt=dt, start="straight")
    assert run.ok and rise(run) < 1e-10 and run.energy_balance.imbalance < 1e-6
    assert np.abs(effect.force_on(run.state(-1))).max() > 0.0


def test_a_body_stands_on_a_box():
    """With its contact area shared by four feet; beside the foot of the cable, which has half a segment more, they sink in less."""
    feet = {f"f{i}": (x, y, -0.1) for i, (x, y) in enumerate([(0.2, 0.2), (0.2, -0.2), (-0.2, 0.2), (-0.2, -0.2)])}
    body = Body("case", mass=5.0, inertia=(0.1, 0.1, 0.1), at=(0, 0, 0.1), contact_area=0.04, attachments=feet)
    cable = Cable("top", "case.f0", length=2.0, mass_per_length=1e-3, EA=1e4, segments=10, diameter=0.01)
    deck = Obstacles(shapes.Box((0, 0, -0.5), (2.0, 2.0, 1.0)), stiffness=1e6, damping=1e4)
    scene = Scene([Fixed("top", (0.2, 0.2, 1.9))], [cable], [Gravity(G), deck], bodies=[body])
    run = simulate(scene, 1.0, method="edmc", dt=0.005, start="straight")
    k, more = 1e6 * 0.01, 1e6 * 0.01 * 0.1
    share = 2.0 / (1.0 + k / (k + more))  # of f0 over that of f1, as the feet stay in a plane
    assert -run.position("case.f1")[-1, 2] == pytest.approx(5.0 * G / (2.0 * (1.0 + share) * k), rel=1e-4)  # cable: 2e-5
    assert run.ok and np.abs(run.v[-1, run.model.node("case")]).max() < 1e-6


def test_files_and_origins(tmp_path):
    q = np.array([(0.0, 0.0, 1.0), (1.0, 0.0, 1.0)])
    scene, _ = rope([Obstacles(tuple(SHAPES.values()), friction=0.2)], q, 1.0, 4)
    save_scene(scene, tmp_path / "scene.toml")
    text = (tmp_path / "scene.toml").read_text()
    assert load_scene(tmp_path / "scene.toml") == scene and 'kind = "cylinder"' in text and "[effects.obstacles]" in text
    moved = scene.effects[1].seen_from((2.0, 3.0, -1.0), None)
    assert moved.shapes[0].at == pytest.approx((-1.9, -3.0, 0.9)) and moved.shapes[0].radius == 0.5
    assert moved.at_rest().friction == 0.0 and Obstacles(DRUM).shapes == (DRUM,)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: shapes.Sphere((0, 0, 0), 0.0), r"`radius` must be positive and finite \[m\], but shape Sphere has radius=0"),
        (lambda: shapes.Cylinder((0, 0, 0), 1.0, axis=(0, 0, 0)), "Argument `axis` must not be zero, but shape Cylinder has"),
        (lambda: shapes.Cylinder((0, 0, 0), 1.0, edge=0.1), r"must have a `length` \[m\] to have edges, but shape Cylinder has "),
        (lambda: shapes.Cylinder((0, 0, 0), 1.0, length=0.5, edge=0.3), "`edge` must be no more than half of the smallest width"),
        (lambda: shapes.Box((0, 0, 0), (1.0, 0.0, 1.0)), r"`size` must be three positive widths \[m\], but shape Box has size="),
        (lambda: Obstacles(()), r"`shapes` must be one or more shapes of anet_lumped.shapes, but effect Obstacles has shapes=\(\)"),
        (lambda: Obstacles((1.0,)), "`shapes` must be one or more shapes of anet_lumped.shapes"),
        (lambda: Obstacles(DRUM, stiffness=0.0), "Argument `stiffness` must be positive"),
    ],
)  # fmt: skip
def test_what_cannot_be(make, says):
    with pytest.raises(SceneError, match=says):
        make()


def test_a_run_says_where_a_cable_may_have_gone_through():
    scene, start = rope([Obstacles(DRUM)], np.array([(0.0, 0.0, 1.0), (1.0, 0.0, 1.0)]), 1.0, 10)
    run = simulate(scene, 0.1, method="edmc", dt=0.01, start=start)
    assert Finding.THROUGH_AN_OBSTACLE not in findings(run)
    fast, long = replace(run, v=run.v + np.array([25.0, 0.0, 0.0])), replace(run, q=5.0 * run.q)
    assert "A node went 0.25 m in a step, and half of the smallest width of an obstacle is 0.2 m" in str(findings(fast))
    assert 'A segment of cable "rope" was stretched to 0.5 m, more than the smallest width of an obstacle' in str(findings(long))


def test_a_cable_that_is_too_coarse_is_refused():
    q = np.array([(0.0, 0.0, 1.0), (1.0, 0.0, 1.0)])
    scene, _ = rope([Obstacles((SHAPES["roll"], DRUM))], q, 1.0, 8)
    assert build(scene)
    says = (
        r'segments must not be longer than half the smallest width of a shape, but cable "rope" has segments of 0.25 m, and '
        r"shapes\[1\], a Cylinder, a half width of 0.2 m; it takes segments=5 or more"
    )
    with pytest.raises(SceneError, match=says):
        build(replace(scene, cables=[replace(scene.cables[0], segments=4)]))
