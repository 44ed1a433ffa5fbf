"""A scene far from its origin is computed about one near it: which origin, and that nothing but coordinates changes."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, Scene, paths, shapes, waves, wind
from anet_lumped.effects import REGISTRY, Air, Gravity, Ground, Obstacles, Water, node_force
from anet_lumped.model.build import build
from anet_lumped.scene.origin import FAR, near_origin

FAR_AWAY = (500_000.0, 5_000_000.0, 40_000.0)
PATHS = {
    "line": paths.line((0.5, 0.25, 0.0), (0.2, 0.0, 0.1), 0.5),
    "samples": paths.samples([0.0, 0.5, 1.0], [(0.5, 0.25, 0.0), (0.75, 0.25, 0.0), (0.75, 0.5, 0.25)]),
    "harmonic": paths.harmonic((0.5, 0.25, 0.0), (0.1, 0.0, 0.2), 2.0, ramp=0.5),
    "external": paths.external((0.5, 0.25, 0.0)),
}


def scene(path=PATHS["line"], effects=(), at=(0.0, 0.0, 0.0)):
    points = [Fixed("a", np.add((0.0, 0.0, 0.0), at)), Driven("b", paths.seen_from(path, np.negative(at))), Free("p", 0.1)]
    shared = {"mass_per_length": 0.1, "EA": 1e4, "segments": 3, "diameter": 0.01, "EI": 1e-3}
    return Scene(points, [Cable("a", "p", length=1.0, **shared), Cable("p", "b", length=1.0, **shared)], [Gravity(9.81), *effects])


@pytest.fixture
def pulled_to_zero(monkeypatch):
    monkeypatch.setattr(REGISTRY, "classes", dict(REGISTRY.classes))

    @node_force
    def pulled_to_zero(t, q, v, k):
        return -k * q[0], -k * q[1], -k * q[2]

    return pulled_to_zero(1.0)


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (3.0, -4.0, 7.0)])
def test_a_scene_near_its_origin_is_left_alone(at):
    near = scene(at=at)
    assert near_origin(near).scene is near


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
def test_places_are_moved_without_rounding(path):
    moved, origin, _ = near_origin(scene(path, at=FAR_AWAY))
    assert origin == FAR_AWAY  # the nearest multiple of 10 m
    assert moved == scene(path)
    for t in (0.0, 0.3, 2.0):
        np.testing.assert_allclose(moved.point("b").path.at(t), path.at(t), rtol=0, atol=1e-14)  # two ways to the same numbers


def test_the_origin_is_a_tenth_of_what_is_far():
    size = 1.0 + 1e-3
    for scale in (1e-3, 1.0, 1e4):
        points = [Fixed("a", (FAR * scale * size, 0.0, 0.0)), Free("p", 0.1)]
        far = Scene(points, [Cable("a", "p", length=scale, mass_per_length=0.1, EA=1e4, segments=3)])
        moved, origin, _ = near_origin(far)
        assert 0.9 * FAR * scale <= origin[0] <= 1.1 * FAR * scale
        assert moved.point("a").at[0] + origin[0] == far.point("a").at[0]


FLOWS = {
    "air in wind": Air(wind=(wind.PowerLaw(5.0, 10.0, 0.14), wind.Gust((1.0, 0.0, 0.0), 0.0, 2.0))),
    "current": Water(level=-0.3, current=wind.Sampled([(-5.0, 0.1, 0.0), (5.0, 0.8, 0.2)])),
    "wave": Water(level=-0.3, wave=waves.Airy(0.4, 3.0, direction=(1.0, 2.0, 0.0), depth=8.0, phase=0.3)),
    "slope": Ground(height=31.6, normal=(0.1, 0.0, 1.0), friction=0.3),
    "obstacles": Obstacles((shapes.Sphere((320.0, -640.0, -1.0), 3.0), shapes.Cylinder((320.0, -640.0, 1.0), 2.0)), friction=0.3),
}


@pytest.mark.parametrize("effect", dict.fromkeys([*REGISTRY.library, *FLOWS]))
def test_effects_exert_the_same_forces_seen_from_elsewhere(effect):
    kind = FLOWS.get(effect) or REGISTRY[effect].example(scene())
    if not kind.kernels():
        pytest.skip("exerts no forces")
    level = (320.0, -640.0, 0.0)
    whole = scene(effects=[] if isinstance(kind, Gravity) else [kind])
    seen = kind.seen_from(level, whole)
    model, random = build(whole), np.random.default_rng(1)
    q, v = random.normal(size=(2, model.n, 3), scale=3.0)
    far = q + level  # the effect as it is, at the far place, and as it is seen, at the near one
    there, here = np.zeros((2, model.n, 3))
    index = [numbers.table(model) for numbers in (kind, seen)]
    kind.kernels()["force"](0.7, far, v, *index[0], there)
    seen.kernels()["force"](0.7, q, v, *index[1], here)
    np.testing.assert_allclose(here, there, rtol=0, atol=1e-9 * np.abs(there).max())  # places are rounded to 1e-13 m there
    assert np.abs(there).max() > 0.0


@pytest.mark.parametrize("effects", [[FLOWS["air in wind"]], [FLOWS["wave"]], [FLOWS["slope"], FLOWS["current"]]])
def test_heights_stay_where_an_effect_depends_on_them(effects):
    moved, origin, _ = near_origin(scene(effects=effects, at=FAR_AWAY))
    assert origin == (*FAR_AWAY[:2], 0.0)
    assert moved.point("a").at == (0.0, 0.0, FAR_AWAY[2])


def test_a_ground_is_moved_with_the_height():
    moved, origin, _ = near_origin(scene(effects=[replace(FLOWS["slope"], normal=(0.0, 0.0, 2.0), height=40_000.5)], at=FAR_AWAY))
    assert origin == FAR_AWAY
    assert moved.effects[1].height == 0.5


@pytest.mark.parametrize("effect", ["a law of one's own", Air(wind=wind.Dryden(1.0, 10.0, (5.0, 0.0, 0.0), 1))])
def test_effects_that_depend_on_places_hold_the_origin(effect, pulled_to_zero):
    effect = effect if isinstance(effect, Air) else pulled_to_zero
    far = scene(effects=[effect], at=FAR_AWAY)
    near = near_origin(far)
    assert near.scene is far
    assert near.fixed_by is effect


def test_nothing_is_moved_where_only_the_height_is_far_and_holds():
    far = scene(effects=[FLOWS["air in wind"]], at=(0.0, 0.0, 40_000.0))
    assert near_origin(far) == (far, (0.0, 0.0, 0.0), FLOWS["air in wind"])
