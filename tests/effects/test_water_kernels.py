"""Kernels of water against the words of their law: force, added mass, tangent, and the work of a whole step."""

import itertools
import math

import numpy as np
import pytest
from systems import nets, order_of_the_jacobian, scatter
from water_cases import RHO, STREAM, WAVE, G, cable

from anet_lumped import Fixed, Free, Scene
from anet_lumped.effects import Gravity, Water
from anet_lumped.effects.flow.waves.kernel import pack as pack_waves
from anet_lumped.effects.flow.waves.kernel import wave_at
from anet_lumped.effects.flow.wind.kernel import pack, wind_at
from anet_lumped.effects.laws.submergence import immersed, sphere_diameter, submerged_share
from anet_lumped.model.build import build

WATERS = {"still": {}, "stream": {"current": STREAM}, "wave": {"current": STREAM, "wave": WAVE}}


def in_water(name, payload=True, water=None, **kwargs):
    """A small net of any topology, as thick as its segments are long, so that the surface cuts many of them."""
    scene = nets(**dict(diameter=0.1, Can=0.8, Cat=0.2, Cdt=0.1) | kwargs)[name]
    load = dict(CdA=0.03, volume=2e-3, Ca=0.6) if payload else {}
    points = [Free(p.name, 0.5, **load) if isinstance(p, Free) else p for p in scene.points]
    return Scene(points, scene.cables, [Gravity(G), Water(RHO, 0.1, **(water or {}))])


def numbers(scene, seed=0):
    """Model, water, its kernels and table, and random places and velocities."""
    model, rng = build(scene), np.random.default_rng(seed)
    water = scene.effects[1]
    index, params = water.table(model)
    q = scatter(model, rng)
    q[:, 2] += water.level - q[:, 2].mean()
    return model, water, water.kernels(), index, params, q, rng.normal(size=(model.n, 3))


def surface(water, t, place):
    """Height above the surface, velocity and acceleration of the water at a place."""
    velocity = np.array(wind_at(t, *place, pack(water.current))[0])
    if water.wave is None:
        return place[2] - water.level, velocity, np.zeros(3)
    (eta, *_), u, _, a, _ = wave_at(t, *place, pack_waves(water.wave, G, water.level))
    return place[2] - water.level - eta, velocity + u, np.array(a)


def twin(scene, t, q, v):
    """Force (n, 3) but for buoyancy, buoyancy (n, 3), and added masses (n, 3, 3), from the words of the law."""
    model, water = build(scene), scene.effects[1]
    f, lift, A = np.zeros((model.n, 3)), np.zeros((model.n, 3)), np.zeros((model.n, 3, 3))
    for one in scene.cables:
        volume = math.pi / 4.0 * one.diameter**2 * one.L0
        for i, j in itertools.pairwise(model.nodes(one.name)):
            tangent = (q[j] - q[i]) / np.linalg.norm(q[j] - q[i])
            P = np.outer(tangent, tangent)
            N = np.eye(3) - P
            shares = immersed(surface(water, t, q[i])[0], surface(water, t, q[j])[0], one.diameter)[1:3]
            for node, w in zip((i, j), shares, strict=True):
                _, u, a = surface(water, t, q[node])
                across, along = N @ (u - v[node]), P @ (u - v[node])
                f[node] += w * one.L0 * 0.5 * RHO * one.diameter * (
                    one.Cdn * np.linalg.norm(across) * across + math.pi * one.Cdt * np.linalg.norm(along) * along
                )  # fmt: skip
                f[node] += w * RHO * volume * ((1 + one.Can) * N @ a + (1 + one.Cat) * P @ a)
                lift[node, 2] += w * RHO * G * volume
                A[node] += w * RHO * volume * (one.Can * N + one.Cat * P)
    for point in scene.points:
        if isinstance(point, Free):
            node = model.node(point.name)
            z, u, a = surface(water, t, q[node])
            w, _, _ = submerged_share(z, sphere_diameter(point))
            f[node] += w * 0.5 * RHO * point.CdA * np.linalg.norm(u - v[node]) * (u - v[node])
            f[node] += w * RHO * point.volume * (1 + point.Ca) * a
            lift[node, 2] += w * RHO * G * point.volume
            A[node] += w * RHO * point.volume * point.Ca * np.eye(3)
    return f, lift, A


@pytest.mark.parametrize("water", list(WATERS))
@pytest.mark.parametrize("name", list(nets()))
def test_force_and_added_mass_against_twin(name, water):
    scene = in_water(name, water=WATERS[water])
    model, _, kernels, index, params, q, v = numbers(scene)
    f, A = np.zeros((model.n, 3)), np.zeros((model.n_free, 3, 3))
    power = kernels["force"](0.3, q, v, index, params, f)
    kernels["inertia"](0.3, q, index, params, A)
    moved, lift, added = twin(scene, 0.3, q, v)
    np.testing.assert_allclose(f, moved + lift, rtol=0, atol=1e-13 * np.abs(f).max() * len(q))
    np.testing.assert_allclose(A, added[: model.n_free], rtol=0, atol=1e-13 * np.abs(added).max())
    assert power == pytest.approx(-np.sum((moved + (lift if water == "wave" else 0.0)) * v), rel=1e-11)


def taken(model, blocks, move):
    """What blocks, subtracted from a tangent, say of a force's change (n_free, 3) along a change of the places."""
    slope = -np.einsum("ixy,iy->ix", blocks[0], move[: model.n_free])
    for s, (i, j) in enumerate(model.ends):
        for row, column, block in ((i, j, blocks[1][s, 0]), (j, i, blocks[1][s, 1])):
            if row < model.n_free and column < model.n_free:
                slope[row] -= block @ move[column]
    return slope


def empty(model):
    return np.zeros((model.n_free, 3, 3)), np.zeros((model.n_segments, 2, 3, 3)), np.zeros((0, 2, 3, 3))


@pytest.mark.parametrize("water", list(WATERS))
@pytest.mark.parametrize("name", list(nets()))
def test_tangent_by_taylor(name, water):
    """Remainder of second order of c_q df/dq + c_v df/dv along a random change of the moving nodes."""
    scene = in_water(name, water=WATERS[water])
    model, _, kernels, index, params, q, v = numbers(scene, 1)
    blocks, c_q, c_v = empty(model), 0.5, 7.0
    kernels["tangent"](0.3, q, v, index, params, c_q, c_v, *blocks)
    move = np.random.default_rng(5).normal(size=(model.n, 3))
    move[model.n_free :] = 0.0
    slope = taken(model, blocks, move)

    def force(h):
        f = np.zeros((model.n, 3))
        kernels["force"](0.3, q + h * c_q * move, v + h * c_v * move, index, params, f)
        return f[: model.n_free]

    steps = 2.0 ** -np.arange(14, 20)
    left = [np.linalg.norm(force(h) - force(0.0) - h * slope) for h in steps]
    assert np.polyfit(np.log(steps), np.log(left), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("water", list(WATERS))
@pytest.mark.parametrize("seed", range(6))
def test_step_gives_back_no_more_than_the_energy(seed, water):
    """Work of a whole step and its derivative; in still water what is lost is not negative."""
    scene = in_water(list(nets())[3 + seed], water=WATERS[water])
    model, _, kernels, index, params, base, v = numbers(scene, seed)
    h = (1e-3, 1e-1)[seed % 2]
    q, move = base + 0.1 * v, np.random.default_rng(seed).normal(size=(model.n, 3))
    move[model.n_free :] = 0.0

    def act(at):
        f, blocks = np.zeros_like(at), empty(model)
        lost, _ = kernels["whole_step"](0.2, h, 0.5, base, at, index, params, f, *blocks)
        return f, blocks, lost

    f, blocks, lost = act(q)
    rise = kernels["energy"](0.0, q, index, params) - kernels["energy"](0.0, base, index, params)
    assert rise == pytest.approx(-np.sum(f * (q - base)) - lost, rel=1e-9, abs=1e-11 * np.abs(f).max())
    assert (lost >= 0.0 and rise != 0.0) if water == "still" else True
    slope, steps = taken(model, blocks, move), 2.0 ** -np.arange(14, 20)
    left = [np.linalg.norm((act(q + x * move)[0] - f)[: model.n_free] - x * slope) for x in steps]
    assert np.polyfit(np.log(steps), np.log(left), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_buoyancy_is_the_slope_of_its_energy():
    scene = in_water("wheel")
    model, _, kernels, index, params, q, _ = numbers(scene, 3)
    f, move, h = np.zeros((model.n, 3)), np.random.default_rng(3).normal(size=(model.n, 3)), 1e-6
    kernels["force"](0.0, q, np.zeros_like(q), index, params, f)
    after, before = (kernels["energy"](0.0, q + x * move, index, params) for x in (h, -h))
    # energies of 1e2 J leave 1e-14/h = 1e-8 of 1e2 N
    assert -(after - before) / (2 * h) == pytest.approx(np.sum(f * move), rel=1e-7)


def test_jacobian_by_taylor():
    """Forces shared with added masses reach the stiff solvers of other packages; their own change with the place is left out there,

    so the cable is deep down and drags water along and across alike.
    """
    scene = in_water("junction", water={"current": STREAM}, Can=0.7, Cat=0.7)
    model, _, _, _, _, q, v = numbers(scene, 2)
    q[:, 2] -= 20.0
    assert order_of_the_jacobian(model, q, v) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("h", [1e-3, 1e-1])
def test_points_that_do_not_float_are_under_water_at_any_height(h):
    """Buoyancy, drag and added mass of a point in the air are those of one in the deep; the energy is -rho g V times the depth."""
    points = [Fixed("a", (0, 0, 5)), Free("b", 0.5, CdA=0.03, volume=2e-3, Ca=0.6)]
    effect = Water(RHO, points_float=False)
    scene = Scene(points, [cable(length=2.0)], [Gravity(G), effect])
    model = build(scene)
    index, params = effect.table(model)
    kernels, b = effect.kernels(), model.node_of["b"]
    q, base = np.zeros((2, model.n, 3))
    q[:, 2], base[:, 2] = 5.0, 4.0  # in the air, all of them
    v = np.random.default_rng(1).normal(size=(model.n, 3))
    f, A = np.zeros_like(q), np.zeros((model.n_free, 3, 3))
    kernels["force"](0.0, q, v, index, params, f)
    kernels["inertia"](0.0, q, index, params, A)
    drag = -0.5 * RHO * 0.03 * np.linalg.norm(v[b]) * v[b]
    np.testing.assert_allclose(f[b], drag + np.array([0.0, 0.0, RHO * G * 2e-3]), rtol=1e-14)  # rounding
    np.testing.assert_allclose(A[b], RHO * 2e-3 * 0.6 * np.eye(3), rtol=1e-14)
    assert not np.delete(f, b, axis=0).any()
    rise = kernels["energy"](0.0, q, index, params) - kernels["energy"](0.0, base, index, params)
    assert rise == pytest.approx(-RHO * G * 2e-3 * 1.0, rel=1e-12)
    D, near, far = np.zeros((model.n_free, 3, 3)), *np.zeros((2, model.n_segments, 2, 3, 3))
    g = np.zeros_like(q)
    taken, _ = kernels["whole_step"](0.0, h, 0.0, base, q, index, params, g, D, near, far)
    assert rise == pytest.approx(-np.sum(g * (q - base)) - taken, abs=1e-14 * taken) and taken > 0.0  # rounding of the drag
