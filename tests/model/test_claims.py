"""What an effect says of itself is compared with its functions when a model is built."""

from dataclasses import replace

import numpy as np
import pytest
from systems import four_cables, nets
from toy_effects import (
    DEAD,
    LIVE,
    constant,
    cubic,
    dragged,
    giving_step,
    growing,
    hung,
    joined,
    level,
    made,
    none,
    of_constant,
    on_supports,
    paid,
    pull,
    pull_energy,
    pushed,
    viscous,
    wide,
    wide_step,
    wider,
)  # fmt: skip

from anet_lumped import Fixed, Scene, SceneError, equilibrium, simulate, wind
from anet_lumped.effects import REGISTRY, Air, Gravity, ViscousDamping
from anet_lumped.model.build import build


@pytest.fixture(autouse=True)
def own_registry(monkeypatch):
    """Effects that a test registers are gone after it."""
    monkeypatch.setattr(REGISTRY, "classes", dict(REGISTRY.classes))


def test_a_tether_is_no_dead_load():
    """Said to be one, it would rest, as if in balance, where it does not; and drift from there in a run that ends as done."""
    functions = {"force": pull, "energy": pull_energy}
    with pytest.raises(SceneError, match=r"dead load must be the same at any position, .* Toy, .* changes with the position"):
        equilibrium(hung(made(functions, [3.0], dead_load=True)))
    scene = hung(made(LIVE, [3.0], linear_in_node_state=True, passive=True))
    rest, weight = equilibrium(scene), 0.25 * 9.81
    assert rest.position("b")[2] == pytest.approx(-weight / 3.0, abs=1e-9)
    run = simulate(scene, 1.0, method="edmc", dt=0.01, start=rest)
    assert run.ok and np.abs(run.q - rest.q).max() < 1e-7


@pytest.mark.parametrize(
    ("kernels", "numbers", "members", "message"),
    [
        ({"force": pull, "energy": pull_energy}, [1.0], {"dead_load": True}, "changes with the position"),
        ({"force": dragged, "energy": none}, [], {"dead_load": True}, "changes with the velocity"),
        ({"force": growing, "energy": none}, [], {"dead_load": True}, "changes with the time"),
        ({"force": on_supports, "energy": none}, [], {"dead_load": True}, 'must act on moving nodes alone, .* acts on point "a"'),
        ({"force": paid, "energy": of_constant}, [], {"dead_load": True}, "power that .* takes out must be 0, .* takes 1 W"),
        ({"force": constant, "energy": none}, [], {"dead_load": True}, "energy of a dead load must be -f.q .* by 0 J where"),
        (LIVE, [1.0], {"no_force_at_rest": True}, "force on nodes at rest must be zero, .* `no_force_at_rest` is True, exerts one"),
        (
            {"force": cubic, "tangent": level, "energy": none}, [], {"linear_in_node_state": True},
            "must be linear in the position and velocity of that node, .* Toy, .* has one that is not linear",
        ),
        (
            {"force": joined, "tangent": level, "energy": none}, [], {"linear_in_node_state": True},
            "must be linear .*, and depend on no other node, but the effect Toy, .* has one that changes with other nodes",
        ),
        (LIVE | {"tangent": level}, [1.0], {"linear_in_node_state": True}, "`tangent` must be the slope of `force` .* has another"),
        (
            {"force": pushed, "tangent": level, "energy": none}, [], {"passive": True},
            "power that a passive force takes out must not be negative, .* Toy, whose `passive` is True, takes -",
        ),
        (LIVE | {"whole_step": giving_step}, [], {"passive": True}, "takes in a step must not be negative, .* Toy, .* takes -1 J"),
        (LIVE | {"tangent": wide}, [], {}, "no farther away .* `coupled_neighbours` is 0, writes those of nodes 1 segments away"),
        (LIVE | {"tangent": wider}, [], {}, "`coupled_neighbours` is 0, writes those of nodes 2 segments away"),
        (LIVE | {"tangent": wider}, [], {"coupled_neighbours": 1}, "`coupled_neighbours` is 1, writes those of nodes 2 segments"),
        (LIVE | {"whole_step": wide_step}, [], {}, "`coupled_neighbours` is 0, writes those of nodes 1 segments away"),
        (LIVE, [], {"coupled_neighbours": 3}, "may couple a node with those 0, 1 or 2 segments away, .* is 3, is none of these"),
    ],
)  # fmt: skip
def test_claims_that_are_not_true(kernels, numbers, members, message):
    with pytest.raises(SceneError, match=message):
        build(hung(made(kernels, numbers, **members), segments=3))


def test_claims_that_are_true():
    """Of nets of all kinds, of which one has no node that moves."""
    toys = [
        lambda: made(DEAD, dead_load=True),
        lambda: made(LIVE, [1.0, 2.0], linear_in_node_state=True, passive=True),
        lambda: made({"force": dragged, "tangent": viscous, "energy": none}, no_force_at_rest=True, linear_in_node_state=True),
        lambda: made(LIVE | {"tangent": wide, "whole_step": wide_step}, coupled_neighbours=1),
        lambda: made(LIVE | {"tangent": wider}, coupled_neighbours=2),
    ]
    for make in toys:
        toy = make()
        for scene in nets().values():
            assert build(replace(scene, effects=(Gravity(), toy))).forces
    fixed = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], hung().cables)
    assert build(replace(fixed, effects=[Gravity(), made(LIVE, linear_in_node_state=True)]))


def test_statics_leave_out_what_acts_on_motion_alone():
    """No relaxation is compiled, nor asked for, with damping and with air that stands still; with wind it is."""
    scene = four_cables()
    thick = replace(scene, cables=[replace(cable, diameter=0.01) for cable in scene.cables])
    rest = equilibrium(thick)
    for effect in (ViscousDamping(1.0), REGISTRY["axial_damping"](1.0), Air()):
        np.testing.assert_array_equal(equilibrium(replace(thick, effects=(*thick.effects, effect))).q, rest.q)
    assert (
        np.abs(equilibrium(replace(thick, effects=(*thick.effects, Air(wind=wind.Uniform((1.0, 0.0, 0.0)))))).q - rest.q).max()
        > 1e-6
    )
