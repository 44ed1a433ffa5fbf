"""Air and water on rigid bodies: energies of steps, tangents, and what falls, floats, swings and drifts by closed forms."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from anet_lumped import Body, Cable, Fixed, Free, Rod, Scene, SceneError, equilibrium, paths, simulate
from anet_lumped.effects import Air, Gravity, Water
from anet_lumped.effects.flow.waves import Airy
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.waves.kernel import wave_at
from anet_lumped.effects.flow.wind import Uniform
from anet_lumped.model.build import build

G, RHO = 9.81, 1025.0
BALL = dict(mass=2.0, inertia=(0.02, 0.03, 0.04), at=(0.0, 0.0, -3.0))
THIN = dict(mass_per_length=1e-3, EA=1e3, diameter=1e-4)


def alone(*bodies, effects):
    """Bodies that no cable holds; a scene holds at least one cable."""
    points = [Fixed("far", (60.0, 0.0, 30.0)), Free("tip", at=(61.0, 0.0, 30.0))]
    return Scene(points, [Cable("far", "tip", length=1.0, segments=2, **THIN)], effects, bodies=bodies)


def thrown(scene, **change):
    """The start of a run, with a body's velocities given."""
    return simulate(scene, 1e-9, method="edmc", dt=1e-9, start="straight").state(0).moved(scene.bodies[0].name, **change)


def on_bodies(scene, which=-1):
    """The effect on bodies, its kernels and its table."""
    model = build(scene)
    effect = scene.effects[which].on_bodies(scene)
    return model, effect.kernels(), effect.table(model)


SHAPES = {
    "sphere": dict(volume=3e-3, Ca=(0.4, 0.5, 0.6), CdA=(0.01, 0.02, 0.04), centre_of_buoyancy=(0.01, -0.02, 0.05)),
    "turning": dict(volume=3e-3, CdA_rotation=(1e-5, 2e-5, 3e-5)),
    "hull": dict(hull=(0.3, 0.2, 0.25), Ca=(0.2, 0.3, 0.4), CdA=(0.02, 0.03, 0.01), centre_of_buoyancy=(0.0, 0.02, -0.03)),
    "rods": dict(rods=[Rod("a", (-0.2, 0.0, -0.1), (0.3, 0.1, 0.15), diameter=0.08, segments=3, Cd_end=0.0, Ca_end=0.0)]),
}


def placed(model, body, rng, height, spread=0.0):
    """Places of the nodes of a body turned at random with its origin at a height; each node besides moved by ``spread``."""
    q = np.zeros((model.n, 3))
    q[:] = rng.normal(size=(model.n, 3))
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    for point in body.points:
        q[model.node_of[point.name]] = R @ point.arm + (0.3, -0.2, height) + spread * rng.normal(size=3)
    return q


@pytest.mark.each_once
@pytest.mark.parametrize("shape", list(SHAPES))
@pytest.mark.parametrize("seed", range(3))
def test_a_step_in_still_water_gives_back_no_more_than_the_energy(shape, seed):
    """The work of the force over a step through the surface is what the energy falls by, less what drag takes."""
    scene = alone(Body("b", **BALL, **SHAPES[shape]), effects=[Gravity(G), Water(RHO, 0.1)])
    (model, kernels, (index, params)), rng = on_bodies(scene), np.random.default_rng(seed)
    base, q = placed(model, scene.bodies[0], rng, 0.05), placed(model, scene.bodies[0], rng, 0.12)
    f, blocks = np.zeros_like(q), (np.zeros((model.n_free, 3, 3)), np.zeros((model.near_rows, 2, 3, 3)), np.zeros((0, 2, 3, 3)))
    taken, by_method = kernels["whole_step"](0.0, 0.1, 0.0, base, q, index, params, f, *blocks)
    rise = kernels["energy"](0.0, q, index, params) - kernels["energy"](0.0, base, index, params)
    assert taken > 0.0 and by_method == 0.0
    assert rise == pytest.approx(-np.sum(f * (q - base)) - taken, rel=1e-11)


@pytest.mark.each_once
@pytest.mark.parametrize("kind", ["middle", "whole_step"])
@pytest.mark.parametrize("fluid", ["air", "water", "wave"])
@pytest.mark.parametrize("shape", [shape for shape in SHAPES if shape != "turning"])  # axes of turns are left out too
def test_tangent_by_taylor(shape, fluid, kind):
    """What is left after the tangent is of second order; under water or in air, where shares do not change what drag does."""
    stream = Uniform((1.0, 2.0, 0.5))
    fluids = {"air": Air(500.0, stream), "water": Water(RHO, 9.0, stream)}
    fluids["wave"] = Water(RHO, 3.0, stream, Airy(0.5, 2.0, (1.0, 0.4, 0.0), depth=6.0))
    effects, given = [Gravity(G), fluids[fluid]], dict(SHAPES[shape])
    if fluid == "wave":  # accelerated water pushes along axes that turn, which the tangent leaves out
        given["Ca"] = (0.0, 0.0, 0.0)
    scene = alone(Body("b", **BALL, **given), effects=effects)
    if shape == "hull" and fluid == "water":  # its lift is exact through the surface
        still = dict(SHAPES[shape], CdA=(0.0, 0.0, 0.0))
        scene = alone(Body("b", **BALL, **still), effects=[Gravity(G), Water(RHO, 0.1)])
    (model, kernels, (index, params)), rng = on_bodies(scene), np.random.default_rng(1)
    body, n = scene.bodies[0], model.n_free
    base, q = placed(model, body, rng, 0.05), placed(model, body, rng, 0.12)
    v, d, e = rng.normal(size=(3, model.n, 3))
    pairs = model.bodies.node[model.bodies.pairs[:, 1:]]

    def act(x):
        f = np.zeros_like(q)
        D, near, far = np.zeros((n, 3, 3)), np.zeros((model.near_rows, 2, 3, 3)), np.zeros((0, 2, 3, 3))
        if kind == "middle":
            kernels["force"](0.0, q + x * d, v + x * e, index, params, f)
            slope = np.zeros((n, 3))
            for c_q, c_v, along in ((1.0, 0.0, d), (0.0, 1.0, e)):
                D[:], near[:] = 0.0, 0.0
                kernels["tangent"](0.0, q + x * d, v + x * e, index, params, c_q, c_v, D, near, far)
                slope -= along_blocks(D, near, along)
            return f[:n], slope
        kernels["whole_step"](0.0, 0.1, 0.0, base, q + x * d, index, params, f, D, near, far)
        return f[:n], -along_blocks(D, near, d)

    def along_blocks(D, near, d):
        out = np.einsum("ixy,iy->ix", D, d[:n])
        for (i, j), both in zip(pairs, near[model.n_segments :], strict=True):
            out[i] += both[0] @ d[j]
            out[j] += both[1] @ d[i]
        return out

    f, slope = act(0.0)
    steps = 10.0 ** -np.arange(3.0, 5.1, 0.5)
    off = [np.linalg.norm(act(x)[0] - f - x * slope) for x in steps]
    assert np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("axis", range(3))
def test_terminal_velocity_along_each_axis(axis):
    """m g = rho/2 CdA v^2 of a body that falls in air with one of its axes vertical."""
    turns = [(0.0, math.pi / 2.0, 0.0), (math.pi / 2.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
    CdA = (0.1, 0.2, 0.4)
    scene = alone(Body("b", **BALL, CdA=CdA, rotation=turns[axis]), effects=[Gravity(G), Air(1.2)])
    run = simulate(scene, 20.0, method="edmc", dt=0.02, start="straight")
    assert_allclose(run.velocity("b")[-1], (0.0, 0.0, -math.sqrt(2.0 * 2.0 * G / (1.2 * CdA[axis]))), atol=1e-6)


@pytest.mark.parametrize("axis", range(3))
def test_a_turn_is_resisted_by_its_square(axis):
    """J dw/dt = -rho/2 CdA_rotation w^2 of a body that spins in air: w = w0/(1 + rho CdA_rotation w0 t/(2 J))."""
    spin, areas = 3.0, (0.02, 0.05, 0.03)
    scene = alone(Body("b", **BALL, CdA_rotation=areas), effects=[Air(1.2)])
    rest = simulate(scene, 1e-9, method="edmc", dt=1e-9, start="straight").state(0)
    start = rest.moved("b", angular_velocity=spin * np.eye(3)[axis])
    run = simulate(scene, 2.0, method="edmc", dt=0.01, start=start)
    expected = spin / (1.0 + 0.6 * areas[axis] * spin * 2.0 / BALL["inertia"][axis])
    assert run.ok and expected < 0.5 * spin
    assert_allclose(run.angular_velocity("b")[-1], expected * np.eye(3)[axis], rtol=0.0, atol=2e-4)  # steps of order 2 in w h


def test_an_inclined_body_is_pushed_aside():
    """A body held by its inertia alone has no moment from drag at its centre: the force is sum k |u_a| u_a e_a, at first."""
    scene = alone(Body("b", **BALL, CdA=(0.1, 0.0, 0.4), rotation=(0.0, 0.6, 0.0)), effects=[Air(1.2, Uniform((3.0, 0.0, 0.0)))])
    model, kernels, (index, params) = on_bodies(scene)
    f, q = np.zeros((model.n, 3)), simulate(scene, 1e-9, method="edmc", dt=1e-9, start="straight").state(0).q
    kernels["force"](0.0, q, np.zeros_like(q), index, params, f)
    c, s = math.cos(0.6), math.sin(0.6)
    along_x, along_z = 0.6 * 0.1 * (3.0 * c) ** 2, 0.6 * 0.4 * (3.0 * s) ** 2
    assert_allclose(f.sum(axis=0), (along_x * c + along_z * s, 0.0, -along_x * s + along_z * c), atol=1e-12)


@pytest.mark.parametrize("method", ["edmc", "dop853"])
def test_a_sphere_sinks_by_the_hyperbolic_tangent(method):
    """(m + Ca rho V) dv/dt = (m - rho V) g - rho/2 CdA v^2: v = v_inf tanh(t/T)."""
    volume, Ca, CdA = 1e-3, 0.5, 0.02
    body = Body("b", **BALL, volume=volume, Ca=(Ca,) * 3, CdA=(CdA,) * 3)
    scene = alone(body, effects=[Gravity(G), Water(RHO)])
    steps = {"rtol": 1e-10, "atol": 1e-12} if method == "dop853" else {"dt": 0.005}
    run = simulate(scene, 2.0, method=method, start="straight", save_every=0.1, **steps)
    weight, k = (2.0 - RHO * volume) * G, 0.5 * RHO * CdA
    speed = math.sqrt(weight / k)
    expected = -speed * np.tanh(run.t * math.sqrt(weight * k) / (2.0 + Ca * RHO * volume))
    assert_allclose(run.velocity("b")[:, 2], expected, atol=1e-7 if method == "dop853" else 5e-5 * speed)


def test_an_apparent_pendulum_swings_slower_by_its_added_mass():
    """T = 2 pi sqrt((J + m c^2 + Ca rho V c^2)/((m - rho V) g c)) of a body pinned above a small volume at its centre of mass."""
    c, J, m, volume, Ca = 0.8, 0.02, 3.0, 1e-3, 0.7
    body = Body(
        "b", mass=m, inertia=(J, J, J), at=(0.0, 0.0, -2.0), centre_of_mass=(0.0, 0.0, -c), centre_of_buoyancy=(0.0, 0.0, -c),
        volume=volume, Ca=(Ca,) * 3, pinned="", rotation=(0.02, 0.0, 0.0),
    )  # fmt: skip
    scene = alone(body, effects=[Gravity(G), Water(RHO)])
    exact = 2.0 * math.pi * math.sqrt((J + (m + Ca * RHO * volume) * c**2) / ((m - RHO * volume) * G * c))
    for method, steps in (("edmc", {"dt": 0.004}), ("dop853", {"rtol": 1e-9})):
        run = simulate(scene, 9.0, method=method, start="straight", save_every=0.004, **steps)
        x = run.rotation("b")[:, 1, 2]
        up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
        times = run.t[up] - x[up] * (run.t[up + 1] - run.t[up]) / (x[up + 1] - x[up])
        assert_allclose(np.diff(times).mean(), exact, rtol=2e-4)  # 1 + (0.02)^2/16, and the step


def test_spinning_with_added_mass_off_the_centre_is_of_order_two():
    """The methods agree on a body whose added mass turns with it, and edmc meets the other with the square of its step."""
    body = Body("b", **BALL, volume=1e-3, Ca=(0.5, 1.0, 2.0), CdA=(0.004, 0.002, 0.001), centre_of_buoyancy=(0.1, 0.05, -0.1))
    scene = alone(body, effects=[Gravity(G), Water(RHO, 9.0)])
    start = thrown(scene, angular_velocity=(6.0, -4.0, 8.0), velocity=(0.3, 0.2, 0.1))
    exact = simulate(scene, 0.5, method="dop853", start=start, rtol=1e-11, atol=1e-12).final
    errors = []
    for dt in (0.01, 0.005, 0.0025, 0.00125):
        run = simulate(scene, 0.5, method="edmc", dt=dt, start=start)
        errors.append(np.abs(run.final.q - exact.q).max())
        assert abs(run.energy_balance.imbalance) < 1e-9
    assert -np.polyfit(np.arange(4.0), np.log2(errors), 1)[0] == pytest.approx(2.0, abs=0.15)


def test_without_weight_and_drag_a_body_goes_with_the_water():
    """A body as dense as the water has the acceleration of the water: rho V (1 + Ca) a = (m + rho V Ca) dv/dt."""
    volume, wave = 2e-3, Airy(0.4, 3.0, (1.0, 0.0, 0.0), depth=20.0)
    body = Body("b", mass=RHO * volume, inertia=(0.02, 0.02, 0.02), at=(0.0, 0.0, -4.0), volume=volume, Ca=(0.5,) * 3)
    scene = alone(body, effects=[Gravity(G), Water(RHO, wave=wave)])
    numbers = pack_waves(wave, G, 0.0)
    start = thrown(scene, velocity=tuple(wave_at(0.0, 0.0, 0.0, -4.0, numbers)[1]))
    run = simulate(scene, 3.0, method="dop853", start=start, rtol=1e-9, save_every=0.01)
    here = [wave_at(t, *place, numbers)[3] for t, place in zip(run.t, run.position("b"), strict=True)]
    rates = np.gradient(run.velocity("b"), run.t, axis=0)
    assert_allclose(rates[2:-2], np.array(here)[2:-2], atol=1e-4)  # central differences over 0.01 s: (2 pi/3)^2 h^2/6 of 0.4 m/s2


def test_a_buoy_on_a_cable_rests_half_under_water():
    """A sphere of half the density of water, on a slack cable: its centre is in the surface, whatever the turn of the body."""
    volume = 4e-3
    body = Body("b", mass=0.5 * RHO * volume, inertia=(0.02, 0.02, 0.02), at=(0.0, 0.0, 0.05), volume=volume)
    cable = Cable("a", "b", length=2.1, segments=6, **(THIN | {"mass_per_length": 1e-9}))
    rest = equilibrium(Scene([Fixed("a", (0.0, 0.0, -2.0))], [cable], [Gravity(G), Water(RHO)], bodies=[body]))
    assert rest.stable and rest.position("b")[2] == pytest.approx(0.0, abs=1e-6)


def test_air_acts_above_the_surface_and_water_below_it():
    """On a body half under water the drag in both fluids is half of each."""
    body = Body("b", **BALL, volume=3e-3, CdA=(0.01, 0.01, 0.01))
    scene = alone(body, effects=[Gravity(G), Air(1.2, surface=-3.0), Water(RHO, -3.0)])
    model = build(scene)
    q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    for point in body.points:
        q[model.node_of[point.name]] = point.at
    v[model.node_of["b"]] = (2.0, 0.0, 0.0)
    for effect, density in zip(scene.effects[1:], (1.2, RHO), strict=True):
        made, f = effect.on_bodies(scene), np.zeros((model.n, 3))
        power = made.kernels()["force"](0.0, q, v, *made.table(model), f)
        assert f[:, 0].sum() == pytest.approx(-0.5 * 0.5 * density * 0.01 * 4.0) and power == pytest.approx(-2.0 * f[:, 0].sum())


def test_a_prescribed_body_and_one_without_shape_cost_nothing():
    plain = Body("b", **BALL)
    still = Body("c", at=(0.0, 0.0, 0.0), turning=paths.line((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.5), volume=1.0, CdA=(1.0,) * 3)
    scene = alone(plain, still, effects=[Gravity(G), Air(1.2), Water(RHO)])
    assert [effect.on_bodies(scene) for effect in scene.effects] == [None, None, None]
    assert len(build(scene).forces) == 3


@pytest.mark.parametrize(
    "given, match",
    [
        (dict(CdA=(0.1, -0.1, 0.0)), "`CdA` must not be negative along any axis, but body \"b\""),
        (dict(Ca=(0.1, 0.1)), "`Ca`"),
        (dict(volume=-1.0), "`volume`"),
        (dict(hull=(1.0, 0.0, 1.0)), "Edges of a `hull` must be positive"),
        (dict(hull=(1.0, 1.0, 1.0), volume=1.0), "Only one of `volume` and `hull`"),
        (dict(rods=["leg"]), "`rods` must be a sequence of Rod"),
        (dict(rods=[Rod("leg", (0, 0, 0), (0, 0, 1), diameter=0.1)] * 2), "Names of rods must be unique"),
        (dict(contact_area=-1.0), "`contact_area`"),
    ],
)  # fmt: skip
def test_messages(given, match):
    with pytest.raises(SceneError, match=match):
        Body("b", **BALL, **given)


def test_a_rod_without_length_is_refused():
    with pytest.raises(SceneError, match='A rod must have a length, but rod "leg" starts and ends at'):
        Rod("leg", (0, 0, 1), (0, 0, 1), diameter=0.1)


@pytest.mark.parametrize("method, order", [("backward_euler", 1), ("symplectic_euler", 1), ("verlet", 2), ("rk4", 4)])
def test_other_methods_take_the_added_mass_by_their_order(method, order):
    """A body whose added mass turns with it, without drag, which is no smooth function; a cable that allows explicit steps."""
    body = Body("b", **BALL, volume=1e-3, Ca=(0.5, 1.0, 2.0), centre_of_buoyancy=(0.1, 0.05, -0.1))
    points = [Fixed("far", (60.0, 0.0, 30.0)), Free("tip", at=(60.0, 0.0, 29.0))]
    cable = Cable("far", "tip", length=1.0, segments=1, mass_per_length=1.0, EA=1e3, diameter=1e-3)
    scene = Scene(points, [cable], [Gravity(G), Water(RHO, 9.0)], bodies=[body])
    start, nodes = thrown(scene, angular_velocity=(3.0, -2.0, 4.0), velocity=(0.3, 0.2, 0.1)), [p.name for p in body.points]
    exact = simulate(scene, 0.4, method="dop853", start=start, rtol=1e-12, atol=1e-13).final
    errors = []
    for dt in (0.008, 0.004, 0.002, 0.001):
        end = simulate(scene, 0.4, method=method, dt=dt, start=start).final
        errors.append(max(np.abs(end.position(name) - exact.position(name)).max() for name in nodes))
    assert -np.polyfit(np.arange(4.0), np.log2(errors), 1)[0] == pytest.approx(order, abs=0.15)


def test_where_points_do_not_float_small_bodies_do_not_either():
    """A body above the surface is lifted all the same, and its energy is that of its depth."""
    body = Body("b", **BALL, volume=1e-3)
    scene = alone(body, effects=[Gravity(G), Water(RHO, -9.0, points_float=False)])
    _, kernels, (index, params) = on_bodies(scene)
    q = simulate(scene, 1e-9, method="edmc", dt=1e-9, start="straight").state(0).q
    f = np.zeros_like(q)
    kernels["force"](0.0, q, np.zeros_like(q), index, params, f)
    assert f.sum(axis=0)[2] == pytest.approx(RHO * G * 1e-3)
    assert kernels["energy"](0.0, q, index, params) == pytest.approx(-RHO * G * 1e-3 * 6.0)
