"""Water: what floats, sinks, swings and streams in it by closed forms, and the way through its surface."""

import itertools
import math

import numpy as np
import pytest
from water_cases import AREA, MU, RHO, STREAM, WAVE, D, G, cable

from anet_lumped import Driven, Fixed, Free, Scene, SceneError, State, equilibrium, simulate
from anet_lumped.effects import Gravity, Water
from anet_lumped.effects.flow.waves import Airy
from anet_lumped.effects.flow.wind import PowerLaw, Uniform
from anet_lumped.effects.laws.submergence import sphere_diameter, submerged_share
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict


def hanging(*effects, top=-1.0, points=(), **kwargs):
    return Scene([Fixed("a", (0, 0, top)), *(points or [Free("b")])], [cable(**kwargs)], [Gravity(G), *effects])


def test_a_sphere_hangs_by_its_weight_less_that_of_the_water():
    """Archimedes, of the payload and of the cable: the last segment carries the payload and half of itself."""
    for level, share_of_sphere in ((0.0, 1.0), (-2.0, 0.5), (-9.0, 0.0)):
        scene = hanging(Water(RHO, level), points=[Free("b", 1.0, volume=5e-4)], EA=1e7)
        wet = 1.0 if level > -1.0 else 0.0
        T = equilibrium(scene).tension("a-b")
        expected = G * (1.0 - RHO * 5e-4 * share_of_sphere + (MU - RHO * AREA * wet) * 0.05)
        # half in, it sinks with the cable's stretch of 1e-6 m, 1e-5 of the diameter; half a segment is in at its end
        assert T[-1] == pytest.approx(expected, rel=1e-4 if level == -2.0 else 1e-9)
        assert T[0] - T[-1] == pytest.approx(0.9 * G * (MU - RHO * AREA * wet), rel=1e-9 if level != -2.0 else 1e-4)


def test_a_cable_hangs_half_in_the_water():
    """Above the surface the tension grows by mu g, below it by (mu - rho A) g, and neither knows where the nodes are."""
    for segments in (7, 8, 10):
        rest = equilibrium(hanging(Water(RHO), top=0.5, segments=segments, EA=1e7))
        T, middle = rest.tension("a-b"), 0.5 - (np.arange(segments) + 0.5) / segments
        dry = 0.5 * MU * G
        for z, tension in zip(middle, T, strict=True):
            if abs(z) > 0.5 / segments + D:  # the segment that is in the surface carries the mean of its ends
                expected = (0.5 + z) * (MU - RHO * AREA) * G + (RHO * AREA * G * z if z > 0 else 0.0)
                # forces balance to 1e-9; the stretch of 1e-7 and the layer of (D/L0)^2 are left
                assert tension == pytest.approx(expected, rel=2e-5)
        assert T[0] > dry


def test_draft_of_a_float():
    """It floats where x^2 (3 - 2 x) = m/(rho V), tethered by a cable that is slack."""
    volume, m = 2e-3, 1.0
    scene = Scene([Fixed("a", (0, 0, -0.2)), Free("b", m, volume=volume)], [cable(mass_per_length=1e-6, diameter=1e-4, EA=10.0)],
                  [Gravity(G), Water(RHO)])  # fmt: skip
    z = equilibrium(scene).position("b")[2]
    assert submerged_share(z, sphere_diameter(scene.point("b")))[0] == pytest.approx(
        (m + 1e-6) / (RHO * volume), rel=1e-5
    )  # what the cable weighs


@pytest.mark.parametrize("EA", [1e7, 1e10])
def test_a_buoy_pulls_its_mooring_upwards(EA):
    """From a shape that hangs, statics finds the one that stands, as exactly however stiff it is."""
    scene = Scene([Fixed("a", (0, 0, -3.0)), Free("b", 1.0, volume=2e-3)], [cable(EA=EA)], [Gravity(G), Water(RHO)])
    rest = equilibrium(scene)
    assert rest.position("b")[2] == pytest.approx(-2.0, abs=1e-5)
    assert rest.tension("a-b")[-1] == pytest.approx(G * (RHO * 2e-3 - 1.0 + (RHO * AREA - MU) * 0.05), rel=1e-13)  # rounding


@pytest.mark.parametrize(
    ("direction", "payload", "drag", "wet"),
    [
        ((1, 0, 0), {}, 0.5 * RHO * D * 1.2, MU - RHO * AREA),
        ((0, 0, 1), {}, 0.5 * RHO * math.pi * D * 0.01, MU - RHO * AREA),
        ((0, 0, 1), {"mass": 0.4, "CdA": 0.002, "volume": 3e-4, "Ca": 0.5}, 0.5 * RHO * (math.pi * D * 0.01 + 0.002),
         MU - RHO * AREA + 0.4 - RHO * 3e-4),
    ],
    ids=["broadside", "lengthwise", "payload below its cable"],
)  # fmt: skip
def test_terminal_velocity(direction, payload, drag, wet):
    """Drag carries the weight in water, V = sqrt(w/drag), whatever the added mass: reached as tanh."""
    V = math.sqrt(wet * G / drag)
    points = [Free("a", at=(0, 0, -1.0), **payload), Free("b", at=(direction[0], 0, direction[2] - 1.0))]
    scene = Scene(points, [cable(segments=8, EA=10.0)], [Gravity(G), Water(RHO)])
    run = simulate(scene, 60.0, method="edmc", dt=0.02, start="straight", save_every=60.0)
    assert run.ok, run.message
    # Newton stops at 1e-6 of the largest force on a node
    np.testing.assert_allclose(-run.v[-1][:, 2], V, rtol=1e-6)


def pendulum(rho=RHO, **kwargs):
    """A sphere on one segment, turned by 0.01 rad: scene, start and frequency [rad/s] of small swings."""
    L, payload, volume, Ca = 0.8, 1.0, 3e-4, 0.5
    made = dict(segments=1, length=L, EA=1e6, Cdn=0.0, Cdt=0.0, Can=1.0, Cat=0.0) | kwargs
    scene = hanging(Water(rho), points=[Free("b", payload, volume=volume, Ca=Ca)], **made)
    rest = equilibrium(scene)
    q, b = rest.q.copy(), rest.model.node("b")
    length = -1.0 - q[b, 2]
    q[b] = (length * math.sin(0.01), 0.0, -1.0 - length * math.cos(0.01))
    start = State(rest.model, 0.0, q, np.zeros_like(q), rest.tension("a-b"))
    mass = payload + 0.5 * MU * L
    displaced = rho * (volume + 0.5 * AREA * L)
    omega = math.sqrt((mass - displaced) * G / (length * (mass + rho * (Ca * volume + 0.5 * AREA * L))))
    return scene, start, omega


@pytest.mark.parametrize(("method", "dt"), [("edmc", 5e-3), ("midpoint", 5e-3), ("tr_bdf2", 5e-3), ("rk4", 2e-4), ("verlet", 1e-4)])
def test_period_of_a_pendulum(method, dt):
    """omega^2 = (m - rho V) g/((m + A) L), far less than in air."""
    scene, start, omega = pendulum()
    assert omega < 0.8 * math.sqrt(G / 0.8)
    period = 2 * math.pi / omega
    dt = period / math.ceil(period / dt)
    run = simulate(scene, 4 * period, method=method, dt=dt, save_every=dt, start=start)
    assert run.ok, run.message
    x = run.position("b")[:, 0]
    i = np.flatnonzero((x[:-1] > 0) & (x[1:] <= 0))
    crossings = run.t[i] + dt * x[i] / (x[i] - x[i + 1])
    found = np.diff(crossings).mean()
    # the swing lengthens it by 0.01^2/16, the step of an implicit method by up to (omega h)^2/12
    assert found == pytest.approx(period * (1.0 + 0.01**2 / 16.0), rel=(omega * dt) ** 2 / 12.0 + 1e-8)


@pytest.mark.parametrize("V", [0.2, 0.5, 2.0])
def test_critical_angle_in_a_current(V):
    """A loose cable streams straight at the angle where (mu - rho A) g cos(phi) = rho/2 d Cdn V^2 sin^2(phi)."""
    weight = (MU - RHO * AREA) * G
    ratio = weight / (RHO * D * 1.2 * V * V)
    phi = math.acos(math.sqrt(1.0 + ratio * ratio) - ratio)
    assert weight * math.cos(phi) == pytest.approx(0.5 * RHO * D * 1.2 * V**2 * math.sin(phi) ** 2, rel=1e-12)
    rest = equilibrium(hanging(Water(RHO, current=Uniform((V, 0, 0)))))
    shape = rest.shape("a-b") - rest.position("a")
    # forces balance to 1e-9 of the load
    np.testing.assert_allclose(shape[-1] / np.linalg.norm(shape[-1]), [math.cos(phi), 0.0, -math.sin(phi)], rtol=0, atol=1e-7)
    np.testing.assert_allclose(np.cross(shape, shape[-1]), 0.0, rtol=0, atol=1e-7)
    per_length = weight * math.sin(phi) + 0.5 * RHO * math.pi * D * 0.01 * (V * math.cos(phi)) ** 2
    np.testing.assert_allclose(rest.tension("a-b"), per_length * (1.0 - 0.1 * (np.arange(10) + 0.5)), rtol=1e-6)


@pytest.mark.parametrize("t", [0.0, 0.7, 1.9, 3.1])
def test_wave_on_a_pile(t):
    """The whole of Morison's force on an upright cylinder in deep water, by integrals of exp(k z) from the surface down.

    Inertia rho A (1 + Can) a omega^2 sin(theta)/k, drag rho/2 d Cdn (a omega)^2 cos|cos|/(2 k), with Wheeler's stretching exactly.
    """
    wave, d, segments = Airy(2.0, 5.0), 0.3, 400
    k, omega = wave.wave_number(G), 2 * math.pi / 5.0
    pile = cable(length=200.0, segments=segments, diameter=d)
    scene = Scene([Fixed("a", (0, 0, -190.0)), Fixed("b", (0, 0, 10.0))], [pile], [Gravity(G), Water(RHO, wave=wave)])
    model = build(scene)
    q, f = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    q[model.nodes("a-b"), 2] = np.linspace(-190.0, 10.0, segments + 1)
    water = scene.effects[1]
    water.kernels()["force"](t, q, np.zeros_like(q), *water.table(model), f)
    theta = -omega * t
    inertia = RHO * math.pi / 4 * d * d * 2.0 * omega**2 * math.sin(theta) / k
    drag = 0.5 * RHO * d * 1.2 * omega**2 * math.cos(theta) * abs(math.cos(theta)) / (2 * k)
    size = RHO * math.pi / 4 * d * d * 2.0 * omega**2 / k
    # the trapezoidal rule, (k L0)^2/12 = 5e-4 of the whole, and the segment in the surface
    assert f[:, 0].sum() == pytest.approx(inertia + drag, abs=2e-3 * size)
    assert np.abs(f[:, 1]).max() == 0.0


def falling_float(CdA, Ca, **kwargs):
    """A float on a cable with a lump at its end, dropped from 0.3 m into the water: it plunges, and bobs."""
    points = [Free("a", 1.0, at=(0, 0, 0.3), volume=2e-3, CdA=CdA, Ca=Ca), Free("b", 0.2, at=(0, 0, -0.7))]
    made = dict(mass_per_length=0.2, Cdn=1.2 if CdA else 0.0, Cdt=0.01 if CdA else 0.0, Can=2 * Ca, Cat=0.0)
    return Scene(points, [cable(**made | kwargs)], [Gravity(G), Water(RHO)])


@pytest.mark.parametrize("CdA", [0.0, 0.002])
@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_energy_never_rises_through_the_surface(CdA, dt):
    run = simulate(falling_float(CdA, 0.0), 8.0, method="edmc", dt=dt, save_every=dt, start="straight")
    assert run.ok, run.message
    total = run.energy[:, :3].sum(axis=1)
    z = run.position("a")[:, 2]
    assert (np.diff(np.sign(z - 0.05)) != 0).sum() >= 4  # it goes in and out
    # Newton stops at 1e-6 of the largest force
    assert np.diff(total).max() <= 1e-6 * np.ptp(run.energy[:, 2])
    assert error_of_steps(run) < 1e-5


@pytest.mark.parametrize(("method", "dt"), [("edmc", 0.01), ("rk4", 2e-4), ("verlet", 1e-4)])
def test_energy_account_with_added_mass(method, dt):
    """What the fluid is given and gives back is in the account."""
    run = simulate(falling_float(0.02, 0.5, EA=1e3, zeta=0.3), 3.0, method=method, dt=dt, save_every=0.05, start="straight")
    assert run.ok, run.message
    # a float that snaps its cable taut: the explicit steps integrate the power of that from step to step
    assert error_of_steps(run) < (1e-6 if method == "edmc" else 1e-3)


@pytest.mark.parametrize("Ca", [0.0, 0.5])
def test_a_float_comes_back_to_where_it_fell_from(Ca):
    """A conservative motion along a line, added mass or not: (m + A(z)) a = F(z) has the integral v^2/2 - int F/(m + A) dz."""
    points = [Free("a", 1.0, at=(0, 0, 0.3), volume=2e-3, Ca=Ca), Free("b", at=(0, 0, 0.2))]
    thread = cable(length=0.1, segments=1, mass_per_length=1e-3, diameter=1e-4, EA=1e2, Cdn=0.0, Cdt=0.0)
    scene = Scene(points, [thread], [Gravity(G), Water(RHO)])
    run = simulate(scene, 20.0, method="edmc", dt=0.002, save_every=0.002, start="straight")
    assert run.ok, run.message
    z = run.position("a")[:, 2]
    peaks = z[1:-1][(z[1:-1] > z[:-2]) & (z[1:-1] > z[2:])]
    assert len(peaks) > 8
    np.testing.assert_allclose(peaks, 0.3, rtol=0, atol=1e-5)  # states 2 ms apart miss a peak by up to g (1 ms)^2/2 = 5e-6


def twine_net(n=3, v=-2.0, height=0.6, **kwargs):
    """A net of 2 mm twine in meshes of 0.25 m, carried by its corners straight up or down at v, once it is on its way."""
    points, cables = [], []
    made = dict(length=0.255, mass_per_length=0.004, EA=2e3, zeta=0.05, diameter=0.002, segments=4) | kwargs
    for i, j in itertools.product(range(n + 1), repeat=2):
        at = (0.25 * i, 0.25 * j, height)
        corner = i in (0, n) and j in (0, n)
        points.append(Driven(f"{i},{j}", paths.line(at, (0, 0, v), ramp=0.2)) if corner else Free(f"{i},{j}"))
        cables += [cable(f"{i},{j}", f"{i + 1},{j}", **made)] if i < n else []
        cables += [cable(f"{i},{j}", f"{i},{j + 1}", **made)] if j < n else []
    return Scene(points, cables, [Gravity(G), Water(RHO)])


@pytest.mark.each_once
@pytest.mark.parametrize("EA", [5.0, 2e3, 1e5])
@pytest.mark.parametrize(("v", "height"), [(-2.0, 0.6), (2.0, -0.8)], ids=["into", "out of"])
def test_a_net_goes_through_the_surface_at_2_m_per_s(v, height, EA):
    """With the method and the step that the library chooses: no step is halved, Newton needs few iterations, forces stay drag's."""
    run = simulate(twine_net(v=v, height=height, EA=EA), 0.9)
    assert run.ok, run.message
    z = run.q[:, :, 2]
    assert z.min() < -0.3 and z.max() > 0.3
    assert run.work.halvings == 0 and run.work.newton_iterations <= 5 * run.work.steps
    assert error_of_steps(run) < 1e-6
    # the whole net, 24 twines broadside at 2 m/s, has this drag; four corners of three twines carry it, at a slope
    drag = 0.5 * RHO * 24 * 0.255 * 0.002 * 1.2 * 2.0**2
    assert max(run.tension(one.name).max() for one in run.model.scene.cables) < drag
    assert np.abs(run.v).max() < 15.0


# Error [m] after 0.8 s of a motion of a metre: with steps of 1 ms of second order, 50 us of first order and of verlet, 0.25 ms
# of rk4; of methods that choose their steps, their rtol.
EXACT = {"dop853": 1e-6, "Radau": 1e-6, "BDF": 1e-6, "RK45": 1e-6, "LSODA": 1e-6, "rk4": 1e-9, "verlet": 1e-7}
ERROR = dict.fromkeys(("edmc", "midpoint", "sdirk2", "tr_bdf2", "generalised_alpha"), 1e-6) | EXACT
ERROR |= {"backward_euler": 3e-5, "symplectic_euler": 1e-5}


@pytest.mark.parametrize("method", list(ERROR))
def test_every_method_sees_the_same_water(method):
    """A chain in a stream and a wave, with added mass, from slack to taut through the surface."""
    points = [Fixed("a", (0, 0, 0.3)), Free("b", 0.3, (0.6, 0, -0.5), CdA=0.01, volume=1e-4, Ca=0.5)]
    water = Water(RHO, current=Uniform((0.5, 0, 0)), wave=WAVE)
    scene = Scene(points, [cable(segments=4, EA=500.0, zeta=0.3)], [Gravity(G), water])
    dt = {"rk4": 2.5e-4, "verlet": 5e-5, "symplectic_euler": 5e-5, "backward_euler": 5e-5}.get(method, 1e-3)
    exact = simulate(scene, 0.8, method="rk4", dt=1e-4, start="straight", save_every=0.8)
    own = method in ("dop853", "Radau", "BDF", "RK45", "LSODA")
    run = simulate(scene, 0.8, method=method, start="straight", save_every=0.8, **({} if own else {"dt": dt}))
    assert run.ok and exact.ok, run.message
    assert np.abs(exact.q[-1] - exact.q[0]).max() > 0.1
    np.testing.assert_allclose(run.q[-1], exact.q[-1], rtol=0, atol=ERROR[method])


@pytest.mark.parametrize("quantity", ["q", "v"])
def test_order(quantity):
    """edmc is of second order in a stream and a wave, with added mass and through the surface."""
    points = [Fixed("a", (0, 0, 0.3)), Free("b", 0.3, CdA=0.01, volume=1e-4, Ca=0.5)]
    thick = cable(segments=4, EA=500.0, zeta=0.3, diameter=0.05, mass_per_length=2.0)
    scene = Scene(points, [thick], [Gravity(G), Water(RHO, current=Uniform((0.5, 0, 0)), wave=WAVE)])
    rest = equilibrium(Scene(points, [thick], [Gravity(G), Water(RHO)]))
    start = State(build(scene), 0.0, rest.q, rest.v, rest.tension("a-b"))
    final = [
        getattr(simulate(scene, 0.8, method="edmc", dt=0.0025 / 2**k, save_every=0.8, start=start), quantity)[-1] for k in range(5)
    ]
    differences = [np.abs(a - b).max() for a, b in itertools.pairwise(final)]
    slopes = np.log2(np.array(differences[:-1]) / differences[1:])
    assert slopes == pytest.approx(2.0, abs=0.15)


def test_a_wave_sets_the_step():
    """A wave of a second is resolved by the step that is chosen, though the cable swings in five."""
    points = [Fixed("a", (0, 0, -30)), Free("b", at=(0, 0, -130))]
    scene = Scene(points, [cable(length=100.0)], [Gravity(G), Water(RHO, wave=Airy(0.05, 1.0))])
    assert simulate(scene, 1.0, method="edmc", start="straight").dt <= 0.01


def test_scene_file(tmp_path):
    points, cables = [Fixed("a", (0, 0, 0)), Free("b", volume=0.1)], [cable()]
    everything = {"current": STREAM, "wave": WAVE, "level": 3.0, "g": 9.8}
    for arguments in ({}, {"current": STREAM[1]}, everything, {"wave": Airy(1.0, 9.0)}):
        scene = Scene(points, cables, [Gravity(G), Water(1000.0, **arguments)])
        save_scene(scene, tmp_path / "scene.toml")
        assert load_scene(tmp_path / "scene.toml") == scene
    entries = scene_to_dict(scene)
    assert entries["effects"]["water"]["wave"]["kind"] == "airy"
    for wave, message in (
        ({"kind": "stokes"}, r'effects.water.wave: unknown kind of wave .stokes.; known: "airy"'),
        ({"kind": "airy", "height": 1.0}, "effects.water.wave: key `period` is missing"),
        ({"height": 1.0}, "effects.water.wave: key `kind` is missing; a wave is one of"),
    ):
        with pytest.raises(SceneError, match=message):
            scene_from_dict(entries | {"effects": {"water": {"wave": wave}}})


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Water(0.0), r"`density` must be positive and finite \[kg/m3\], but effect Water has density=0.0"),
        (lambda: Water(level=math.inf), r"`level` must be a finite number \[m\], but effect Water has level=inf"),
        (lambda: Water(g=-1.0), r"`g` must be non-negative and finite \[m/s2\], but effect Water has g=-1.0"),
        (lambda: Water(current=3.0), "`current` must be winds of anet_lumped.wind or None, but effect Water has current=3.0"),
        (lambda: Water(wave=PowerLaw(1.0, 1.0, 0.1)), "`wave` must be a wave of anet_lumped.waves or None, but effect Water has"),
        (lambda: build(hanging(Water(), diameter=None)),
         r'Water needs the `diameter` \[m\] of every cable, but cable "a-b" has none'),
        (lambda: build(Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable()], [Gravity(G, (1, 0, -1)), Water()])),
         r"Water needs Gravity along -z, or a `g` of its own, but gravity is \("),
        (lambda: build(Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable()], [Water(wave=WAVE)])), "A wave needs gravity"),
    ],
)  # fmt: skip
def test_messages(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_points_float_must_be_said_by_a_flag():
    with pytest.raises(SceneError, match="`points_float` must be True or False"):
        Water(points_float=0.0)
