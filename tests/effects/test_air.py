"""Air on nets: its kernels, and motions and shapes at rest that have a closed form."""

import itertools
import math

import naive
import numpy as np
import pytest
from systems import nets, order_of_the_jacobian, scatter

from anet_lumped import Cable, Driven, Fixed, Free, Scene, SceneError, equilibrium, simulate
from anet_lumped.effects import Air, Gravity
from anet_lumped.effects.flow.wind import Dryden, Gust, Logarithmic, PowerLaw, Recorded, Uniform
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

G, MU, D, CDN, CDT, RHO = 9.81, 0.1, 0.01, 1.2, 0.02, 1.225
ACROSS = 0.5 * RHO * D * CDN  # [kg/m2]: force per length over the square of the normal velocity
BLOWS = (PowerLaw(8.0, 10.0, 0.2, ground=-20.0), Dryden(1.0, 5.0, (3, 0, 0), seed=1, modes=10))


def cable(start, end, length=1.0, segments=20, **kwargs):
    made = dict(mass_per_length=MU, EA=1e5, zeta=0.1, diameter=D, Cdn=CDN, Cdt=CDT) | kwargs
    return Cable(start, end, length=length, segments=segments, **made)


def with_air(name, wind=BLOWS, surface=None, **kwargs):
    """A small net of any topology with a payload that the wind sees."""
    scene = nets(**dict(diameter=0.02) | kwargs)[name]
    points = [Free(p.name, 0.5, CdA=0.3) if isinstance(p, Free) else p for p in scene.points]
    return Scene(points, scene.cables, [Air(wind=wind, surface=surface)])


def numbers(scene, seed=0):
    """Model, its table of Air, and random places and velocities."""
    model, rng = build(scene), np.random.default_rng(seed)
    (air,) = (effect for effect in scene.effects if isinstance(effect, Air))
    index, params = air.table(model)
    return model, air.kernels(), index, np.asarray(params, float), scatter(model, rng), 3.0 * rng.normal(size=(model.n, 3))


def twin(scene, model, t, q, v):
    """Drag (n, 3) from the words of the law, segment by segment and point by point."""
    from anet_lumped.effects.flow.wind.kernel import pack, wind_at

    (air,) = (effect for effect in scene.effects if isinstance(effect, Air))
    winds, f = pack(air.wind), np.zeros((model.n, 3))
    for one in scene.cables:
        nodes = model.nodes(one.name)
        for i, j in itertools.pairwise(nodes):
            tangent = (q[j] - q[i]) / np.linalg.norm(q[j] - q[i])
            for node in (i, j):
                u = np.array(wind_at(t, *q[node], winds)[0]) - v[node]
                along = np.dot(u, tangent) * tangent
                across = u - along
                per_length = 0.5 * air.density * one.diameter * (
                    one.Cdn * np.linalg.norm(across) * across + math.pi * one.Cdt * np.linalg.norm(along) * along
                )  # fmt: skip
                f[node] += per_length * one.L0 / 2
    for point in scene.points:
        if isinstance(point, Free):
            node = model.node(point.name)
            u = np.array(wind_at(t, *q[node], winds)[0]) - v[node]
            f[node] += 0.5 * air.density * point.CdA * np.linalg.norm(u) * u
    return f


@pytest.mark.parametrize("name", list(nets()))
def test_force_against_twin(name):
    scene = with_air(name)
    model, kernels, index, params, q, v = numbers(scene)
    f = np.zeros((model.n, 3))
    power = kernels["force"](0.3, q, v, index, params, f)
    np.testing.assert_allclose(f, twin(scene, model, 0.3, q, v), rtol=0, atol=1e-14 * np.abs(f).max() * len(q))
    assert power == pytest.approx(-np.sum(f * v), rel=1e-12)
    assert kernels["energy"](0.3, q, index, params) == 0.0


@pytest.mark.parametrize("name", list(nets()))
def test_tangent_by_taylor(name, surface=None, seed=1):
    """Remainder of second order of c_q df/dq + c_v df/dv along a random change of the moving nodes, wind gradient included."""
    scene = with_air(name, surface=surface, diameter=0.02 if surface is None else 0.2)
    model, kernels, index, params, q, v = numbers(scene, seed)
    blocks = np.zeros((model.n_free, 3, 3)), np.zeros((model.n_segments, 2, 3, 3)), np.zeros((0, 2, 3, 3))
    c_q, c_v = 0.5, 7.0
    kernels["tangent"](0.3, q, v, index, params, c_q, c_v, *blocks)
    move = np.random.default_rng(5).normal(size=(model.n, 3))
    move[model.n_free :] = 0.0
    slope = -np.einsum("ixy,iy->ix", blocks[0], move[: model.n_free])
    for s, (i, j) in enumerate(model.ends):
        for row, column, block in ((i, j, blocks[1][s, 0]), (j, i, blocks[1][s, 1])):
            if row < model.n_free and column < model.n_free:
                slope[row] -= block @ move[column]

    def force(h):
        f = np.zeros((model.n, 3))
        kernels["force"](0.3, q + h * c_q * move, v + h * c_v * move, index, params, f)
        return f[: model.n_free]

    steps = 2.0 ** -np.arange(12, 19)
    left = [np.linalg.norm(force(h) - force(0.0) - h * slope) for h in steps]
    assert np.polyfit(np.log(steps), np.log(left), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("name", ["loose end", "loop"])
def test_tangent_by_taylor_at_a_surface(name):
    test_tangent_by_taylor(name, surface=0.2, seed=4)


@pytest.mark.parametrize(
    ("low", "high", "share", "of_point"),
    [(-1.5, -0.5, 0.0, 0.0), (-1.0, 0.0, 0.0, 0.5), (-0.25, 0.75, 0.75, 1.0), (0.1, 1.1, 1.0, 1.0), (0.0, 0.0, 0.5, 0.5)],
)
def test_air_ends_at_the_surface(low, high, share, of_point):
    """The drag of what is above it, half of what is level in it, none below; a payload by the volume of its sphere."""
    rod = cable("a", "b", length=1.0, segments=1, diameter=1e-6)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", CdA=0.3)], [rod], [Air(RHO, Uniform((5, 0, 0)), surface=0.0)])
    model, kernels, index, params, q, v = numbers(scene)
    q[model.nodes("a-b")], v[:] = [(0, 0 if low < high else -1.0, low), (0, 0, high)], 0.0
    f = np.zeros_like(q)
    kernels["force"](0.0, q, v, index, params, f)
    # the layer of the surface is even about it; of the segment that ends there a share of d/L0 = 1e-6
    whole = 0.5 * RHO * 25.0
    assert f[model.node("b"), 0] == pytest.approx(whole * 0.3 * of_point, abs=whole * 1e-6)
    assert f[:, 0].sum() - whole * 0.3 * of_point == pytest.approx(whole * 1.2e-6 * share, abs=1e-5 * whole * 1.2e-6)


def test_jacobian_of_a_net_by_taylor():
    """The blocks reach their places in the Jacobian that stiff solvers of other packages get."""
    scene = with_air("loose end", BLOWS)
    model, _, _, _, q, v = numbers(scene, 2)
    assert order_of_the_jacobian(model, q, v) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("seed", range(20))
def test_air_at_rest_only_takes_energy(seed):
    name = list(nets())[seed % len(nets())]
    model, kernels, index, params, q, v = numbers(with_air(name, wind=None), seed)
    assert kernels["force"](0.0, q, v, index, params, np.zeros((model.n, 3))) > 0.0


def falling(direction, payload=0.0, CdA=0.0, t_end=12.0):
    """Speed at which a free cable of 1 m falls after a while, from rest."""
    far = tuple(np.array(direction, float))
    points = [Free("a", payload, at=(0.0, 0.0, 0.0), CdA=CdA), Free("b", at=far)]
    # a soft cable: springs of 1e6 N/m would be known to 1e-7 N only, 1 km from the origin
    scene = Scene(points, [cable("a", "b", segments=8, EA=10.0)], [Gravity(G), Air(RHO)])
    run = simulate(scene, t_end, method="edmc", dt=0.02, start="straight", save_every=t_end)
    assert run.ok, run.message
    velocity = run.v[-1]
    # Newton stops at 1e-6 of the largest force on a node
    np.testing.assert_allclose(velocity - velocity[0], 0.0, rtol=0, atol=1e-6 * np.abs(velocity[0, 2]))  # none overtakes another
    np.testing.assert_allclose(velocity[:, :2], 0.0, rtol=0, atol=1e-9)
    return -velocity[0, 2]


@pytest.mark.parametrize(
    ("direction", "payload", "CdA", "drag"),
    [
        ((1, 0, 0), 0.0, 0.0, ACROSS),
        ((0, 0, 1), 0.0, 0.0, 0.5 * RHO * math.pi * D * CDT),
        ((0, 0, 1), 0.4, 0.02, 0.5 * RHO * (math.pi * D * CDT + 0.02)),
    ],
    ids=["broadside", "lengthwise", "payload below its cable"],
)
def test_terminal_velocity(direction, payload, CdA, drag):
    """Drag carries the weight: V = sqrt(m g/drag), reached as tanh(g t/V)."""
    V = math.sqrt((MU + payload) * G / drag)
    time = 22.0 * V / G  # tanh(22) is 1 within rounding
    assert falling(direction, payload, CdA, time - time % 0.02) == pytest.approx(V, rel=1e-6)


def critical_angle(V):
    """Angle to the flow at which a cable streams: mu g cos(phi) = rho/2 d Cdn V^2 sin^2(phi)."""
    ratio = MU * G / (2.0 * ACROSS * V * V)
    return math.acos(math.sqrt(1.0 + ratio * ratio) - ratio)


@pytest.mark.parametrize("V", [3.0, 10.0, 30.0])
def test_critical_angle_in_wind(V):
    """A loose cable in uniform wind is straight at the critical angle; its tension carries weight and tangential drag."""
    phi = critical_angle(V)
    assert MU * G * math.cos(phi) == pytest.approx(ACROSS * V**2 * math.sin(phi) ** 2, rel=1e-12)
    line = cable("a", "b", length=2.0, segments=10)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [line], [Gravity(G), Air(RHO, Uniform((V, 0, 0)))])
    rest = equilibrium(scene)
    shape = rest.shape("a-b")
    towards = shape[-1] / np.linalg.norm(shape[-1])
    # forces balance to 1e-9 of the load
    np.testing.assert_allclose(towards, [math.cos(phi), 0.0, -math.sin(phi)], rtol=0, atol=1e-8)
    np.testing.assert_allclose(np.cross(shape, towards), 0.0, rtol=0, atol=1e-8)
    per_length = MU * G * math.sin(phi) + 0.5 * RHO * math.pi * D * CDT * (V * math.cos(phi)) ** 2
    beyond = 2.0 - 0.2 * (np.arange(10) + 0.5)  # [m] of cable below the middle of each segment
    np.testing.assert_allclose(rest.tension("a-b"), per_length * beyond, rtol=1e-7)


def test_critical_angle_of_tow():
    """The same angle behind a top that is towed through air at rest."""
    V = 10.0
    scene = Scene(
        [Driven("a", paths.line((0, 0, 0), (V, 0, 0), ramp=2.0)), Free("b")],
        [cable("a", "b", EA=1e3, segments=10)],
        [Gravity(G), Air(RHO)],
    )
    run = simulate(scene, 30.0, method="edmc", dt=0.02, save_every=30.0)
    assert run.ok, run.message
    shape = run.final.shape("a-b") - run.final.position("a")
    phi = critical_angle(V)
    for node in shape[1:]:  # what is left of the swing after 30 s
        np.testing.assert_allclose(node / np.linalg.norm(node), [-math.cos(phi), 0.0, -math.sin(phi)], rtol=0, atol=1e-6)


def test_small_deflection():
    """A loaded plumb line in light wind: y = p/(mu g) (L - M/mu ln(1 + mu L/M)) with p = rho/2 d Cdn W^2."""
    W, M, L = 0.5, 0.3, 2.0
    p = ACROSS * W * W
    errors = []
    for segments in (10, 20, 40):
        points = [Fixed("a", (0, 0, 0)), Free("b", M)]
        scene = Scene(points, [cable("a", "b", length=L, segments=segments, EA=1e8)], [Gravity(G), Air(RHO, Uniform((W, 0, 0)))])
        exact = p / (MU * G) * (L - M / MU * math.log(1.0 + MU * L / M))
        errors.append(equilibrium(scene).position("b")[0] / exact - 1.0)
    # the lumping is of second order; without it, the square of the angle is left, (p L/(M g))^2 = 2e-6
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.1)
    assert abs(4 * errors[2] - errors[1]) / 3 < 4e-6


def test_catenary_in_cross_wind():
    """Wind across the plane turns a hanging cable about its chord by atan(p/(mu g)), but for the square of that angle."""
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (1.5, 0, 0))]
    line = cable("a", "b", length=2.0, segments=20)
    still = equilibrium(Scene(points, [line], [Gravity(G)])).shape("a-b")
    for W in (1.0, 2.0):
        angle = math.atan(ACROSS * W * W / (MU * G))
        blown = equilibrium(Scene(points, [line], [Gravity(G), Air(RHO, Uniform((0, W, 0)))])).shape("a-b")
        turned = np.column_stack([still[:, 0], -still[:, 2] * math.sin(angle), still[:, 2] * math.cos(angle)])
        np.testing.assert_allclose(blown, turned, rtol=0, atol=1.0 * angle**2)
        assert np.abs(blown - turned)[:, 1].max() < 2.0 * angle**3  # across the plane the next order is the third
        assert np.abs(blown - still).max() > 0.5 * angle  # it did move


def test_balance_at_rest():
    """In a wind that has it all, the law's own words leave no force on a net at rest."""
    winds = (PowerLaw(8.0, 10.0, 0.2, ground=-5.0), Dryden(1.0, 5.0, (3, 0, 0), seed=1, modes=10))
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (2, 0, 0.3)), Free("p", 0.2, CdA=0.05), Free("c")]
    joined = (("a", "p", 1.3, 4), ("b", "p", 1.2, 3), ("p", "c", 1.0, 3))
    cables = [cable(i, j, length=length, segments=segments, EA=1e3) for i, j, length, segments in joined]
    scene = Scene(points, cables, [Gravity(G), Air(RHO, winds)])
    rest = equilibrium(scene)
    model, v = rest.model, np.zeros_like(rest.q)
    f = twin(scene, model, 0.0, rest.q, v) - naive.masses(model)[:, None] * [0, 0, G]
    assert np.abs(f[: model.n_free]).max() > 1.0  # so that there is something to balance
    for one in scene.cables:
        for i, j in itertools.pairwise(model.nodes(one.name)):
            d = rest.q[j] - rest.q[i]
            pull = naive.tension(one, np.linalg.norm(d), 0.0) * d / np.linalg.norm(d)
            f[i] += pull
            f[j] -= pull
    load = (model.mass * G).sum()
    np.testing.assert_allclose(f[: model.n_free], 0.0, rtol=0, atol=1e-9 * load)  # what `equilibrium` promises


def carried(diameter=0.1, wind=None, segments=10, **kwargs):
    """The carried net in air that counts: four cables of 10 cm to a payload."""
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.0), (-0.5, 0.5, 0.0)]
    points = [Driven(f"s{i}", paths.line(at, (1.0, 0.0, 0.0), ramp=1.0)) for i, at in enumerate(corners)]
    made = dict(segments=segments, EA=1e4, zeta=0.05, diameter=diameter) | kwargs
    cables = [cable(f"s{i}", "p0", **made) for i in range(4)]
    return Scene([*points, Free("p0", 0.036, CdA=0.02)], cables, [Gravity(G), Air(RHO, wind)])


@pytest.mark.parametrize("quantity", ["q", "v"])
def test_order(quantity):
    """edmc is of second order with drag, in a gust and a profile."""
    scene = carried(wind=(PowerLaw(2.0, 10.0, 0.2, (0, 1, 0), ground=-5.0), Gust((0, 3, 0), 0.2, 0.5)))
    final = [getattr(simulate(scene, 1.6, method="edmc", dt=0.01 / 2**k, save_every=1.6), quantity)[-1] for k in range(6)]
    differences = [np.abs(a - b).max() for a, b in itertools.pairwise(final)]
    slopes = np.log2(np.array(differences[:-1]) / differences[1:])
    assert slopes == pytest.approx(2.0, abs=0.15)


def test_two_methods_one_motion():
    """edmc, with the tangent, and rk4, with the force alone, see the same net move in the same wind."""
    scene = carried(wind=(Uniform((0, 4, 0)), Gust((0, 3, 0), 0.2, 0.5)), segments=4, EA=1e3)
    implicit = simulate(scene, 0.8, method="edmc", dt=5e-4, extrapolate=True, save_every=0.8)
    explicit = simulate(scene, 0.8, method="rk4", dt=1e-4, save_every=0.8)
    assert implicit.ok and explicit.ok
    moved = np.abs(explicit.q[-1] - explicit.q[0])
    assert moved[:, 1].max() > 0.05  # [m] across
    # extrapolated, edmc's error is its own times (h omega)^2: far below the 1e-6 m of one run, by `test_order`
    np.testing.assert_allclose(implicit.q[-1], explicit.q[-1], rtol=0, atol=1e-7)


@pytest.mark.parametrize("dt", [0.01, 0.03, 0.1])
def test_drag_beyond_weight(dt):
    """Drag 1000 times the weight at 1 m/s: every step converges in a few iterations, and the energy only falls."""
    start = Scene(
        [Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))],
        [cable("a", "b", diameter=1.0, Cdn=1600.0, Cdt=500.0, EA=1e4)], [Gravity(G), Air(RHO)],
    )  # fmt: skip
    assert 0.5 * RHO * 1600.0 > 900 * MU * G
    run = simulate(start, 3.0, method="edmc", dt=dt, start="straight", save_every=dt)
    assert run.ok, run.message
    total = run.energy[:, :3].sum(axis=1)
    assert (np.diff(total) <= 1e-12 * np.abs(total).max()).all()
    assert run.energy[-1, 4:].sum() == pytest.approx(total[0] - total[-1], rel=1e-6)  # of the forces is what Newton stops at
    assert run.work.newton_iterations <= 8 * round(3.0 / dt)


def test_work_of_newton_is_bounded():
    """The tangent is that of the force: few iterations a step, however much the wind blows and the steps hold."""
    for wind, dt in ((Uniform((0, 20, 0)), 0.01), (Uniform((0, 20, 0)), 0.05), (BLOWS, 0.02)):
        run = simulate(carried(wind=wind), 2.0, method="edmc", dt=dt, save_every=2.0)
        assert run.ok, run.message
        assert run.work.newton_iterations <= 5 * run.work.steps


def test_scene_file(tmp_path):
    """One wind is a table, several are a list of tables; what is wrong is named with its place."""
    file = tmp_path / "wind.csv"
    file.write_text("t,u,v,w\n0,1,2,3\n1,2,3,4\n")
    many = (
        Uniform((1, 0, 0)), PowerLaw(8.0, 10.0, 0.2), Logarithmic(8.0, 10.0, 0.03), Gust((1, 0, 0), 1.0, 2.0, stays=True),
        Dryden(1.0, 5.0, (3, 0, 0), seed=1), Recorded(str(file), "cubic"),
    )  # fmt: skip
    points, cables = [Fixed("a", (0, 0, 0)), Free("b", CdA=0.1)], [cable("a", "b")]
    for wind in (None, *many, many):
        scene = Scene(points, cables, [Air(1.2, wind)])
        save_scene(scene, tmp_path / "scene.toml")
        assert load_scene(tmp_path / "scene.toml") == scene
    entries = scene_to_dict(scene)
    assert entries["effects"]["air"]["wind"][1] == {
        "kind": "power_law", "speed": 8.0, "height": 10.0, "exponent": 0.2, "direction": [1.0, 0.0, 0.0], "ground": 0.0
    }  # fmt: skip
    for wind, message in (
        ({"kind": "powerlaw"}, r'scene, effects.air.wind: unknown kind of wind .powerlaw., did you mean "power_law"\?'),
        ([{"velocity": [1, 2, 3]}], r"scene, effects.air.wind\[0\]: key `kind` is missing; a wind is one of"),
        ({"kind": "uniform", "speed": 1.0}, "scene, effects.air.wind: unknown key `speed`; known: `velocity`"),
        ({"kind": "uniform", "velocity": [1.0, 2.0]}, "effects.air.wind: key `velocity"),
        (3.0, "effects.air.wind: must be a table of keys and values, but is 3.0"),
    ):
        with pytest.raises(SceneError, match=message):
            scene_from_dict(entries | {"effects": {"air": {"wind": wind}}})


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Air(0.0), r"`density` must be positive and finite \[kg/m3\], but effect Air has density=0.0"),
        (lambda: Air(surface="sea"), r"`surface` must be a finite number \[m\], but effect Air has surface='sea'"),
        (lambda: Air(wind=3.0), "`wind` must be winds of anet_lumped.wind or None, but effect Air has wind=3.0"),
        (lambda: Air(wind=(Uniform((1, 0, 0)), "gale")), "but effect Air has wind="),
        (lambda: build(Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable("a", "b", diameter=None)], [Air()])),
         r'The effect Air needs the `diameter` \[m\] of every cable, but cable "a-b" has none'),
    ],
)  # fmt: skip
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()
