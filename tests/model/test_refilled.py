"""A model made from that of a scene with the same names is the model that `build` makes from nothing, to the last bit."""

from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
import pytest
from hanging import held_net
from toy_effects import hung, pull, pull_energy

from anet_lumped import Cable, CableCut, Driven, Fixed, Free, PayloadChange, Scene, SceneError, load_scene, paths, signals, wind
from anet_lumped.effects import REGISTRY, Air, Bending, Effect, Gravity, LineChange
from anet_lumped.model import build as building
from anet_lumped.model.build import _cut, build, refilled


def with_cables(scene, **changes):
    return replace(scene, cables=[replace(one, **changes) for one in scene.cables])


CURVE = ((0.01, 100.0), (0.02, 300.0))
NET = held_net(segments=3, diameter=0.01, zeta=0.1)
LIKES = {
    "stiffness": (NET, with_cables(NET, EA=3e5, zeta=0.3)),
    "lengths and masses": (NET, with_cables(NET, length=1.3, mass_per_length=0.2, BA=4.0, zeta=0.0)),
    "one cable of four": (NET, replace(NET, cables=[replace(NET.cables[0], EA=7.0), *NET.cables[1:]])),
    "payload and place": (NET, replace(NET, points=[Fixed("s0", (-0.6, -0.5, 0.1)), *NET.points[1:4], Free("p0", 0.4)])),
    "compression": (with_cables(NET, compression="damped"), with_cables(NET, compression="damped", EA_compression=50.0)),
    "a curve": (with_cables(NET, EA=None, tension_strain=CURVE), with_cables(NET, EA=None, tension_strain=CURVE, length=1.1)),
    "strength": (NET, with_cables(NET, breaking_tension=3.0)),
    "effects": (
        replace(with_cables(NET, EI=0.2), effects=[Gravity(), Air(wind=wind.Uniform((1.0, 0.0, 0.0))), Bending()]),
        replace(with_cables(NET, EI=0.1, Cdn=0.7), effects=[Gravity(1.6), Air(density=0.3), Bending()]),
    ),
    "lengths that change": (
        replace(NET, effects=[Gravity(), LineChange(paid_out={"s0-p0": signals.line(0.0, 0.01, 0.0)})]),
        replace(with_cables(NET, EA=2e4), effects=[Gravity(9.0), LineChange(paid_out={"s1-p0": signals.line(0.0, 0.02, 0.0)})]),
    ),
    "bodies": (load_scene("quadrotors_net"), with_cables(load_scene("quadrotors_net"), EA=77.0)),
    "creep": (with_cables(NET, EA_dynamic=2e4, BA_creep=1e5), with_cables(NET, EA_dynamic=3e4, BA_creep=2e5)),
    "events": (NET, replace(NET, events=[PayloadChange("p0", 0.1, 0.2), CableCut("s0-p0", 0.1)])),
}


def assert_same(one, other, where):
    if isinstance(one, tuple) and not isinstance(one, str):
        assert len(one) == len(other), where
        for k, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_same(a, b, f"{where}[{k}]")
    elif isinstance(one, np.ndarray):
        assert one.dtype == other.dtype and np.array_equal(one, other, equal_nan=True), where
    else:
        assert one == other, where


@pytest.mark.parametrize("kind", LIKES)
def test_a_refilled_model_is_the_model(kind):
    known, scene = LIKES[kind]
    found, whole = refilled(_cut(known), scene), _cut(scene)
    for field in fields(whole):
        assert_same(getattr(found, field.name), getattr(whole, field.name), field.name)
    names = (
        "creep",
        "breaking_tension",
        "ends",
        "cable_of",
        "n_segments",
        "node_segments",
        "path_table",
        "springs_of_cables",
        "kinds_of_library",
        "unheld",
        "forces",
    )
    for name in names:
        assert_same(getattr(found, name), getattr(whole, name), name)


def test_a_path_is_that_of_the_scene():
    hangs = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=10.0, segments=2)
    one = Scene([Driven("a", paths.line((0, 0, 0), (1, 0, 0), 0.1)), Free("b", 1.0)], [hangs])
    other = replace(one, points=[Driven("a", paths.line((0, 0, 1), (2, 0, 0), 0.2)), one.points[1]])
    known = build(one)
    assert_same(known.path_table, _cut(one).path_table, "")
    assert_same(build(other).path_table, _cut(other).path_table, "")
    assert known.path_table.coefficients[0, 0, 2] == 0.0


def test_scenes_with_the_same_names_share_what_names_decide():
    building._KNOWN.clear()
    first, second = build(NET), build(with_cables(NET, EA=123.0))
    assert second.node_of is first.node_of and second.ends is first.ends and second.scene.cables[0].EA == 123.0
    other = build(with_cables(NET, segments=4))
    assert other.node_of is not first.node_of and len(building._KNOWN) == 2


def test_topologies_that_are_kept_are_few():
    for segments in range(1, 20):
        build(with_cables(NET, segments=segments))
    assert len(building._KNOWN) == building.TOPOLOGIES


def test_frequencies_beyond_numbers_are_refused_of_a_known_topology_too():
    build(NET)
    with pytest.raises(SceneError, match=r'frequencies of a cable must be up to .* cable "s0-p0"'):
        build(with_cables(NET, EA=1e100, mass_per_length=1e-100, length=1e-100))


@dataclass(frozen=True)
class Tether(Effect):
    """A spring from the loose end to the origin that says of itself that it is a dead load, which it is without a stiffness."""

    stiffness: float = 0.0

    dead_load: ClassVar[bool] = True

    def kernels(self):
        return {"force": pull.compiled, "energy": pull_energy.compiled}

    def table(self, model):
        return np.zeros(0, np.int64), np.array([self.stiffness])


def test_what_a_users_effect_says_of_itself_is_compared_again_with_other_numbers(monkeypatch):
    monkeypatch.setattr(REGISTRY, "classes", dict(REGISTRY.classes))
    REGISTRY["tether_to_origin"] = Tether
    build(hung(Tether(0.0)))
    with pytest.raises(SceneError, match="dead load must be the same at any position"):
        build(hung(Tether(3.0)))
