"""Effects of one's own: the same as those that come with this where the law is the same, exact derivatives, clear refusals."""

import math
import pickle
import re
import runpy
import types
from dataclasses import replace
from functools import partial
from pathlib import Path

import naive
import numpy as np
import pytest
from numba import njit
from slow import slow
from systems import four_cables, loose_cable, nets, scatter

from anet_lumped import (
    Cable,
    Driven,
    Fixed,
    Free,
    NoRestError,
    Scene,
    SceneError,
    equilibrium,
    load_scene,
    save_scene,
    simulate,
)
from anet_lumped.effects import REGISTRY, Air, Gravity, ViscousDamping, node_energy, node_force, segment_energy, segment_force
from anet_lumped.effects.laws.drag import segment_coefficients, segment_drag, tangent_of
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from anet_lumped.results.energy_balance import error_of_steps

EPS = np.finfo(float).eps
EXAMPLE = Path(__file__).parents[2] / "examples" / "own_effect.py"


@node_energy(dead=True)
def own_weight(t, q, mass, g=9.81):
    """Weight."""
    return mass * g * q[2]


@node_force
def own_damping(t, q, v, mass, rate):
    return -rate * mass * v[0], -rate * mass * v[1], -rate * mass * v[2]


@node_energy
def own_magnet(t, q, strength, at, beat=0.0):
    """A dipole whose strength may swing in time."""
    x, y, z = q[0] - at[0], q[1] - at[1], q[2] - at[2]
    return -strength * (1.0 + 0.5 * math.sin(beat * t)) / (x * x + y * y + z * z) ** 1.5


@segment_energy
def own_spring(t, q0, q1, L0, EA):
    """The elastic energy of a segment that pulls and pushes."""
    x, y, z = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
    stretch = math.sqrt(x * x + y * y + z * z) - L0
    return 0.5 * EA / L0 * stretch**2


@segment_force
def own_drag(t, q0, q1, v0, v1, L0, normal, along, wind):
    """Drag across and along a segment, by the law that Air has, whose derivatives are written by hand there."""
    tx, ty, tz, _ = tangent_of(q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2], L0)
    on_0 = segment_drag(wind[0] - v0[0], wind[1] - v0[1], wind[2] - v0[2], tx, ty, tz, normal, along)
    on_1 = segment_drag(wind[0] - v1[0], wind[1] - v1[1], wind[2] - v1[2], tx, ty, tz, normal, along)
    return on_0, on_1


@segment_force
def own_leash(t, q0, q1, v0, v1, L0, EA, gain=0.3):
    """Something of everything: it depends on all places and velocities, on no side alike, and is cut."""
    x, y, z = q1[0] - q0[0], q1[1] - q0[1], q1[2] - q0[2]
    l = math.hypot(math.hypot(x, y), z)
    rate = (x * (v1[0] - v0[0]) + y * (v1[1] - v0[1]) + z * (v1[2] - v0[2])) / l
    pull = max(EA * math.tanh((l - L0) / L0), 0.0) + gain * rate * abs(rate) + math.sin(t)
    pull /= l
    return (pull * x + gain * v0[1], pull * y, pull * z), (-pull * x, -pull * y - gain * q0[0], 2.0 * -pull * z)


def evaluate(effect, model, t, q, v):
    """Force (n, 3), power and energy of an effect by itself."""
    index, params = effect.table(model)
    f = np.zeros((model.n, 3))
    kernels = effect.kernels()
    power = kernels["force"](t, q, v, index, params, f)
    return f, power, kernels["energy"](t, q, index, params)


def tangent_of_effect(effect, model, t, q, v, c_q, c_v):
    """(n_free, 3, n_free, 3) of c_q df/dq + c_v df/dv, from the blocks that its tangent writes."""
    index, params = effect.table(model)
    D, near, far = np.zeros((model.n_free, 3, 3)), np.zeros((model.n_segments, 2, 3, 3)), np.zeros((model.n_segments, 2, 3, 3))
    effect.kernels()["tangent"](t, q, v, index, params, c_q, c_v, D, near, far)
    assert not far.any()
    return naive.matrix_of_blocks(model, D, near)


def with_diameter(scene):
    return replace(scene, cables=tuple(replace(cable, diameter=0.01) for cable in scene.cables))


@pytest.mark.parametrize("method", ["edmc", "verlet", "generalised_alpha"])
def test_own_weight_is_gravity(method):
    """At rest and in motion, to the last bit: the loads are the same numbers; and so is the work."""
    for scene, start in ((four_cables(carried=True), "equilibrium"), (loose_cable(), "straight")):
        own = replace(scene, effects=(own_weight(),))
        dt = {"verlet": 1e-5}.get(method, 0.005)
        runs = [simulate(one, 0.1 if method == "verlet" else 0.5, method=method, dt=dt, start=start) for one in (scene, own)]
        np.testing.assert_allclose(runs[1].q, runs[0].q, rtol=0, atol=16 * EPS)
        assert runs[1].work == runs[0].work and runs[1].status == runs[0].status == "done"
        # m g z and m (g z) differ in their last bits
        assert runs[1].energy_balance.potential == pytest.approx(runs[0].energy_balance.potential, rel=1e-12, abs=1e-14)
    rest = [equilibrium(replace(four_cables(), effects=(effect,))) for effect in (Gravity(), own_weight())]
    np.testing.assert_array_equal(rest[1].q, rest[0].q)


def test_weight_that_is_not_said_to_be_dead():
    """Statics then relax to rest, and Newton's method takes as many iterations in motion as with Gravity."""

    @node_force
    def pulled_down(t, q, v, mass, g=9.81):
        return 0, 0, -mass * g

    scene = four_cables(carried=True)
    own = replace(scene, effects=(pulled_down(),))
    np.testing.assert_allclose(equilibrium(own).q, equilibrium(scene).q, atol=1e-9)  # relaxed to 1e-9 of the load
    start = equilibrium(scene)
    runs = [simulate(one, 1.0, method="edmc", dt=0.01, start=start) for one in (scene, own)]
    np.testing.assert_allclose(runs[1].q, runs[0].q, atol=1e-12)  # the same Newton steps, each looked at once more
    assert runs[1].work.newton_iterations == runs[0].work.newton_iterations
    # a force has no energy of its own: what the weight gives is taken, with the sign turned, for dissipated
    gravity, balance = runs[0].energy_balance, runs[1].energy_balance
    assert balance.dissipated == pytest.approx(gravity.dissipated + gravity.potential, abs=1e-10)
    assert balance.imbalance < 1e-9


@pytest.mark.slow
def test_own_damping_is_viscous_damping():
    scene = replace(four_cables(carried=True), effects=(Gravity(), ViscousDamping(0.8)))
    own = replace(scene, effects=(Gravity(), own_damping(rate=0.8)))
    runs = [simulate(one, 0.5, method="edmc", dt=0.01) for one in (scene, own)]
    np.testing.assert_allclose(runs[1].q, runs[0].q, atol=1e-9)  # own statics relax to 1e-9 of the load
    assert runs[1].work.newton_iterations <= runs[0].work.newton_iterations + 2
    assert runs[1].energy_balance.dissipated == pytest.approx(runs[0].energy_balance.dissipated, rel=1e-6)


@pytest.mark.slow
def test_own_drag_is_that_of_air():
    """Force and power, and a tangent by dual numbers against one by hand: the library's law with its own derivatives."""
    for name, scene in nets().items():
        scene = with_diameter(scene)
        model, rng = build(scene), np.random.default_rng(len(name))
        q, v = scatter(model, rng), rng.normal(size=(model.n, 3))
        normal, along = segment_coefficients(1.225, scene.cables[0])
        one = [c for c in scene.cables if c.L0 == scene.cables[0].L0]
        if len(one) < len(scene.cables):
            continue  # the coefficients of the law above are those of one length
        own, air = own_drag(normal=normal, along=along, wind=(0.0, 0.0, 0.0)), Air()
        for mine, theirs in zip(evaluate(own, model, 0.0, q, v), evaluate(air, model, 0.0, q, v), strict=True):
            np.testing.assert_allclose(mine, theirs, rtol=1e-13, atol=1e-15)
        tangents = [tangent_of_effect(effect, model, 0.0, q, v, 0.7, 0.3) for effect in (own, air)]
        np.testing.assert_allclose(*tangents, rtol=1e-12, atol=1e-14, err_msg=name)


@pytest.mark.parametrize(
    "effect",
    [
        pytest.param(own_magnet(strength=0.02, at=(0.1, 0.2, -3.0), beat=2.0), marks=pytest.mark.slow),
        own_damping(rate=0.5),
        own_spring(),
        pytest.param(own_leash(), marks=pytest.mark.slow),
    ],
    ids=lambda effect: type(effect).__name__,
)
def test_tangent_by_differences(effect):
    """Central differences of the force: h^2 of its third derivative and eps/h of its size, against a scale of 1e4 N/m."""
    for scene in (nets()["junction"], nets()["loop"], nets(compression="linear")["loose end, reversed"]):
        model, rng = build(scene), np.random.default_rng(7)
        q, v, h = scatter(model, rng), rng.normal(size=(model.n, 3)), 1e-5
        for c_q, c_v in ((1.0, 0.0), (0.0, 1.0), (0.6, 2.0)):
            K = tangent_of_effect(effect, model, 0.3, q, v, c_q, c_v)
            differences = np.zeros_like(K)
            for i in range(model.n_free):
                for x in range(3):
                    e = np.zeros_like(q)
                    e[i, x] = h
                    high, low = (evaluate(effect, model, 0.3, q + s * c_q * e, v + s * c_v * e)[0] for s in (1.0, -1.0))
                    differences[:, :, i, x] = (high - low)[: model.n_free] / (2 * h)
            np.testing.assert_allclose(K, differences, rtol=0, atol=1e-7 * max(np.abs(K).max(), 1.0))


def test_force_is_the_slope_of_the_energy_and_power_its_rate():
    for effect in (own_magnet(strength=0.02, at=(0.1, 0.2, -3.0), beat=2.0), own_spring(), own_weight()):
        model, rng = build(nets()["junction"]), np.random.default_rng(1)
        q, v, d, h = scatter(model, rng), rng.normal(size=(model.n, 3)), rng.normal(size=(model.n, 3)), 1e-6
        d[model.n_free :] = 0.0
        f, power, _ = evaluate(effect, model, 0.4, q, v)
        energies = [evaluate(effect, model, 0.4, q + s * h * d, v)[2] for s in (1, -1)]
        assert np.sum(f * d) == pytest.approx(-(energies[0] - energies[1]) / (2 * h), rel=1e-6)
        energies = [evaluate(effect, model, 0.4 + s * h, q, v)[2] for s in (1, -1)]
        # what the energy gains with the time alone is put in from outside
        assert power == pytest.approx(-(energies[0] - energies[1]) / (2 * h), rel=1e-6, abs=1e-9)


@pytest.mark.slow
def test_a_magnet_in_motion():
    """The account of energy closes, and two methods agree; the magnet's own beat puts energy in."""
    magnet = own_magnet(strength=0.02, at=(0.1, 0.0, -1.0), beat=5.0, points=["p0"])
    scene = replace(four_cables(), effects=(Gravity(), magnet))
    runs = {
        method: simulate(scene, 0.5, method=method, dt=dt, save_every=0.01)
        for method, dt in (("edmc", 1e-3), ("generalised_alpha", 1e-3), ("verlet", 1e-5))
    }
    for method, run in runs.items():
        assert run.status == "done" and error_of_steps(run) < 1e-4, method
        np.testing.assert_allclose(run.position("p0"), runs["verlet"].position("p0"), atol=2e-5)  # of second order at 1 ms
    assert np.ptp(runs["verlet"].position("p0")[:, 2]) > 1e-4


def test_own_spring_in_parallel_doubles_the_stiffness():
    """Axial springs of one's own beside those of the cables: a hanging mass stretches half as much, by both laws alike."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=50.0, segments=4, compression="linear")
    points = [Fixed("a", (0, 0, 0)), Free("b", mass=0.2)]
    doubled = equilibrium(Scene(points, [replace(cable, EA=100.0)], [Gravity()]))
    own = equilibrium(Scene(points, [cable], [Gravity(), own_spring()]))
    np.testing.assert_allclose(own.position("b"), doubled.position("b"), atol=1e-9)  # relaxed to 1e-9 of the load


def test_what_it_acts_on_and_what_is_filled_in():
    @node_force
    def per_share(t, q, v, length, area, mass, p):
        return p * length, p * area, p * mass

    scene = with_diameter(nets()["string of cables"])
    model = build(scene)
    f, _, _ = evaluate(per_share(p=2.0), model, 0.0, *np.zeros((2, model.n, 3)))
    np.testing.assert_allclose(f[: model.n_free, 2], 2 * model.mass[: model.n_free], rtol=1e-15)
    halves = [(1 / 3 + 1 / 4) / 2, (1 / 4 + 1 / 2) / 2, 1 / 4]
    for name, half in zip("xyz", halves, strict=True):
        np.testing.assert_allclose(f[model.node(name), :2], [2 * half, 2 * half * 0.01], rtol=1e-15)
    f, _, _ = evaluate(per_share(p=2.0, points=["y"]), model, 0.0, *np.zeros((2, model.n, 3)))
    assert np.flatnonzero(f.any(axis=1)).tolist() == [model.node("y")]

    @segment_force
    def uphill(t, q0, q1, v0, v1, L0, diameter):
        return (L0, diameter, 0), (1.0, 0.0, 0.0)

    f, _, _ = evaluate(uphill(cables=["a-x-0"]), model, 0.0, *np.zeros((2, model.n, 3)))
    nodes = model.nodes("a-x-0")  # node 0 of each segment is the one towards the start, whichever way it is eliminated
    np.testing.assert_allclose(f[nodes], [[1 / 3, 0.01, 0], *2 * [[4 / 3, 0.01, 0]], [1, 0, 0]], rtol=1e-15)
    reversed_one = with_diameter(nets()["loose end, reversed"])
    model = build(reversed_one)
    f, _, _ = evaluate(uphill(), model, 0.0, *np.zeros((2, model.n, 3)))
    assert f[model.node("x"), 0] == pytest.approx(1 / 7) and f[model.node("a"), 0] == 1.0


def test_in_scene_files_runs_sweeps_and_other_processes(tmp_path):
    magnet = own_magnet(strength=0.02, at=(0.1, 0.0, -1.0), points=["p0"])
    scene = replace(four_cables(), effects=(Gravity(), magnet))
    save_scene(scene, tmp_path / "net.toml")
    assert load_scene(tmp_path / "net.toml") == scene
    assert REGISTRY.name_of(magnet) == "own_magnet" and "strength=0.02" in repr(magnet)
    assert pickle.loads(pickle.dumps(scene)) == scene
    from studies.sweeping.vary import apply

    assert apply(scene, {"own_magnet.strength": 0.03})[0].effects[1] == replace(magnet, strength=0.03)


def test_on_a_cable_that_breaks():
    """It goes on with the parts that are left of the cables that it names, and is gone with the last of them."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, zeta=0.2, segments=4, breaking_tension=1.0)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=0.2)], [cable], [Gravity(), own_spring(cables=["a-b"])])
    start = equilibrium(replace(scene, cables=[replace(cable, breaking_tension=None)]))
    run = simulate(scene, 0.2, method="edmc", dt=1e-3, start=start)
    assert run.ok and run.events and run.position("b")[-1, 2] < -1.1  # it falls
    piece = replace(cable, name="a-b[1:4]", start="a-b[1]", segments=3, length=0.75)
    assert scene.effects[1].after_break({"a-b": [piece]}, [piece]).cables == ("a-b[1:4]",)
    assert scene.effects[1].after_break({"a-b": []}, []) is None and own_spring().after_break({"a-b": []}, []) == own_spring()


@pytest.mark.slow
def test_an_effect_may_be_made_again_under_its_name():
    """As where a notebook's cell is run twice."""

    def make(size):
        @node_force
        def again(t, q, v):
            return -size, 0.0, 0.0

        return again()

    model = build(nets()["loose end"])
    for size in (1.0, 2.0):
        assert evaluate(make(size), model, 0.0, *np.zeros((2, model.n, 3)))[0][0, 0] == -size


@pytest.mark.slow
def test_the_example():
    found = types.SimpleNamespace(**runpy.run_path(str(EXAMPLE)))
    z = {name: state.position("p0")[2] for name, state in found.rest.items()}
    assert z["magnet"] < z["weight alone"] and found.run.status == "done"
    assert found.rest["downwash"].tension("s0-p0")[0] > found.rest["weight alone"].tension("s0-p0")[0]
    np.testing.assert_allclose(found.rest["downwash"].position("p0")[:2], 0.0, atol=1e-9)  # four jets, alike


@njit
def bessel_like(x):
    return math.lgamma(x)


def not_compiled(x):
    return x


def moves(t, q, v, strength):
    return strength, 0.0, 0.0


def no_law(t, q):
    return undefined_name + q[0]  # noqa: F821


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: node_force(3.0), "law of an effect must be a function, but it is 3.0"),
        (lambda: node_force(lambda q, v: (0, 0, 0)), r"must have the arguments \(t, q, v, ...\).*`<lambda>` has \(q, v\)"),
        (lambda: node_energy(lambda t, q, *p: 0.0), r"each by a name of its own, but `<lambda>` has \(t, q, \*p\)"),
        (lambda: segment_energy(lambda t, q: 0.0), r"must have the arguments \(t, q0, q1, ...\)"),
        *(
            (partial(node_force, law), f"argument of a law must not be called `{name}`, as every effect has that, but `<lambda>`")
            for name, law in {
                "points": lambda t, q, v, points: q,
                "table": lambda t, q, v, table: q,
                "law": lambda t, q, v, k, law: q,
                "self": lambda t, q, v, self: q,
                "where": lambda t, q, v, where: q,
                "kernels": lambda t, q, v, kernels: q,
            }.items()
        ),
        (lambda: segment_energy(lambda t, q0, q1, cables: 0.0), "must not be called `cables`"),
        (lambda: node_energy(no_law)(), r"must compile with Numba, but `no_law` does not: .*undefined_name"),
        (lambda: node_energy(lambda t, q: not_compiled(q[0]))(), "`<lambda>` does not: .*not_compiled.*, in line \\d+"),
        (lambda: node_energy(lambda t, q: q)(), r"must return one number, the energy \[J\], but `<lambda>` returns UniTuple"),
        (lambda: node_force(lambda t, q, v: (q[0], q[1]))(), r"must return the force \(fx, fy, fz\) \[N\], but"),
        (lambda: node_force(lambda t, q, v: q[0])(), r"must return the force \(fx, fy, fz\) \[N\], but `<lambda>` returns float64"),
        (lambda: segment_force(lambda t, q0, q1, v0, v1: q0)(), r"must return the forces on both nodes"),
        (lambda: node_energy(lambda t, q: bessel_like(q[0]))().kernels(), "made of arithmetic and of .*sqrt.* is not: .*lgamma"),
        (lambda: node_force(moves)(), "missing 1 required positional argument: 'strength'"),
        (lambda: node_force(moves)(strength=math.nan), "`strength` must be a finite number, but effect moves has strength=nan"),
        (lambda: node_force(moves)(strength="big"), "but effect moves has strength='big'"),
        (lambda: node_force(moves)(strength=(1.0, math.inf)), "but effect moves has strength=inf"),
        (
            lambda: node_force(moves)(strength=1.0, points="p0"),
            "sequence of names, or None for all, but effect moves has points='p0'",
        ),
        (lambda: build(with_effect(own_damping(rate=1.0, points=["s0"]))), 'effect own_damping has points with "s0", held'),
        (lambda: build(with_effect(own_damping(rate=1.0, points=["p1"]))), 'no point "p1", did you mean'),
        (lambda: build(with_effect(own_spring(cables=["s0-p9"]))), 'no cable "s0-p9", did you mean "s0-p0"'),
        (lambda: build(with_effect(in_air())), 'in_air needs the `diameter` of its cables, but cable "s0-p0" has none'),
        (lambda: build(with_effect(thick())), r'thick needs the `diameter` \[m\] of every cable, but cable "s0-p0"'),
        (
            lambda: build(with_effect(not_dead(k=2.0))),
            "must be the same at any position, .* not_dead, .* changes with the position",
        ),
        (lambda: build(with_effect(own_weight(), own_weight(g=1.0))), "given twice"),
    ],
)
def test_messages(make, message):
    with pytest.raises((SceneError, TypeError), match=message):
        make()


def test_a_default_may_be_a_list():
    made = node_energy(lambda t, q, at=[0.0, 1.0, 2.0]: at[0] * q[0])
    assert made().at == (0.0, 1.0, 2.0)


@node_force
def root_of_height(t, q, v, z0):
    return 0.0, 0.0, 0.01 * math.sqrt(q[2] - z0)


@node_energy
def logarithm(t, q, depth):
    return depth * math.log(q[2] + depth)


@node_force
def root_of_depth(t, q, v, z0):
    return 0.0, 0.0, max(z0 - q[2], 0.0) ** 0.5


@node_force
def root_aside(t, q, v, k):
    return 0.0, 0.0, k * math.sqrt(abs(q[1]))


@node_force
def root_of_distance(t, q, v, k):
    return 0.0, 0.0, k * (q[0] ** 2 + q[1] ** 2) ** 0.25


@node_force
def until(t, q, v, t0):
    return 0.0, 0.0, 0.01 * math.sqrt(t0 - t)


def loose(*effects):
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=20)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))], [cable], [Gravity(9.81), *effects])


def test_a_law_that_is_not_finite_is_named_by_statics():
    with pytest.raises(NoRestError, match=r"^The force of effect root_of_height is \(0, 0, nan\) N at t=0 s at .* No equil"):
        equilibrium(loose(root_of_height(-0.5)))


@pytest.mark.parametrize("effect", [root_aside(1.0), root_of_distance(1.0)])
def test_a_slope_that_is_not_finite_is_named_by_statics(effect):
    """Forces that are finite and rise as x**0.5 from 0 on: Newton's method needs their slope, inf or 0 * inf there."""
    name = type(effect).__name__
    with pytest.raises(
        NoRestError, match=rf"^The force of effect {name} has a slope that is not finite at t=0 s at node 1 of 20 .* No"
    ):
        equilibrium(loose(effect))


@pytest.mark.parametrize(
    ("effect", "settings", "message"),
    [
        (root_aside(1.0), {}, "The force of effect root_aside has a slope that is not finite at t=0 s .* edmc with"),
        (logarithm(0.3), {}, r"The energy of effect logarithm is nan J at t=0.0\d+ s\. edmc with .* did not converge"),
        *slow(
            (logarithm(0.3), {"method": "dop853"}, r"The energy of effect logarithm is nan J .* dop853 with rtol"),
            (logarithm(0.3), {"method": "verlet", "dt": 2e-5}, "The (energy|force) of effect logarithm is .* verlet with"),
        ),
        (until(0.1), {"dt": 0.001}, r"The force of effect until is \(0, 0, nan\) N at t=0.1"),
        (until(0.1), {"method": "verlet", "dt": 2e-5}, r"The force of effect until is \(0, 0, nan\) N at t=0.1.* diverged at"),
        *slow((until(0.1), {"method": "backward_euler", "dt": 0.01}, "The force of effect until is")),
    ],
)
def test_a_law_that_is_not_finite_is_named_by_a_run(effect, settings, message):
    run = simulate(loose(effect), t_end=0.3, start="straight", **settings)
    assert not run.ok and re.match(message, run.message), run.message


def with_effect(*effects):
    return replace(four_cables(), effects=effects)


@segment_force
def in_air(t, q0, q1, v0, v1, diameter):
    return (diameter, 0.0, 0.0), (diameter, 0.0, 0.0)


@node_energy(dead=True)
def thick(t, q, area):
    return area * q[0]


@node_energy(dead=True)
def not_dead(t, q, k):
    return 0.5 * k * q[0] ** 2


def test_methods_of_diffrax_do_not_take_them():
    pytest.importorskip("diffrax")
    with pytest.raises(ValueError, match=r"Methods of diffrax need effects that JAX can trace, .* but own_weight is none"):
        simulate(with_effect(own_weight()), 0.1, method="Tsit5")


def test_the_library_s_names_are_taken():
    def gravity(t, q):
        return q[2]

    with pytest.raises(SceneError, match="must have a name of its own, but `gravity` is that of Gravity"):
        node_energy(gravity)


def test_a_law_that_is_no_number_stops_the_run():
    """Division by zero is no exception in compiled code; the run says that it failed, and does not end as done."""

    @node_force
    def bursts(t, q, v):
        return 1.0 / max(0.1 - t, 0.0) - 1.0 / max(0.1 - t, 0.0), 0.0, 0.0

    scene = Scene([Driven("a", paths.line((0, 0, 0), (0.1, 0, 0), 1.0)), Free("b")], loose_cable().cables, [Gravity(), bursts()])
    run = simulate(scene, 0.3, method="verlet", dt=1e-4)
    assert run.status != "done" and run.t[-1] < 0.2


@node_force
def own_square_drag(t, q, v, k):
    speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return -k * speed * v[0], -k * speed * v[1], -k * speed * v[2]


def test_a_drag_without_a_smooth_root_begins_at_rest():
    """A weight falls on a slack cable: sinking by u^2/g ln cosh(g t/u), u^2 = m g/k."""
    cable = Cable("o", "b", length=8.0, mass_per_length=1e-6, EA=1e3, segments=1)
    points = [Fixed("o", (0.0, 0.0, 0.0)), Free("b", 2.0, at=(0.0, 0.0, -1.0))]
    run = simulate(Scene(points, [cable], [Gravity(9.81), own_square_drag(k=1.0, points=["b"])]), 1.2, start="straight")
    sunk = 2.0 * math.log(math.cosh(9.81 * 1.2 / math.sqrt(2.0 * 9.81)))
    assert run.ok and run.kept
    assert -1.0 - run.position("b")[-1, 2] == pytest.approx(sunk, abs=8e-3)  # 1 mm a metre of the cable
