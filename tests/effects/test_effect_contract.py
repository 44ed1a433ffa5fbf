"""The contract of effects: what cannot work is refused before a run, with a sentence that names the effect and what must hold."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numba import types
from toy_effects import DEAD, LIVE, NAME, constant, hung, later, level, light, made, none, pull, pull_energy, pull_tangent, step

from anet_lumped import Driven, Free, PayloadChange, Scene, SceneError, equilibrium, paths, simulate, wind
from anet_lumped.compiled.exceptions import may_raise
from anet_lumped.effects import REGISTRY, Air, Effect, Gravity, Load, Temperature, ViscousDamping, Water, node_force
from anet_lumped.effects.effect import STRAIN, LengthChange, check_effect_class
from anet_lumped.effects.signatures import FORCE_SIGNATURE, SLOTS
from anet_lumped.model import tables
from anet_lumped.model.build import build
from studies.questions.effects_cost import joins_others, plain


@pytest.fixture(autouse=True)
def own_registry(monkeypatch):
    """Effects that a test registers are gone after it."""
    monkeypatch.setattr(REGISTRY, "classes", dict(REGISTRY.classes))


# --- functions that may not stand where they do ---------------------------------------------------------------------------


@later()
def not_compiled(t, q, v, index, params, f):
    return 0.0


@later([FORCE_SIGNATURE, types.float64(types.int64, *FORCE_SIGNATURE.args[1:])])
def twice(t, q, v, index, params, f):
    return 0.0


@later(FORCE_SIGNATURE)
def late(t, q, v, index, params, f):
    if t > 0.05:
        raise ValueError("too late")
    return 0.0


@later(FORCE_SIGNATURE)
def careful(t, q, v, index, params, f):
    if not t < 10.0:
        raise AssertionError
    return 0.0


@later(FORCE_SIGNATURE)
def divided(t, q, v, index, params, f):
    return 1.0 / t


@later(FORCE_SIGNATURE, error_model="numpy")
def divided_to_inf(t, q, v, index, params, f):
    return 1.0 / t


@later(FORCE_SIGNATURE, boundscheck=True)
def watched(t, q, v, index, params, f):
    f[int(t), 0] += 0.0
    return 0.0


@later(FORCE_SIGNATURE)
def unreachable(t, q, v, index, params, f):
    total = 0.0
    for x in range(3):
        if x == 3:
            raise ValueError("never")
        total += (t, t, t)[x]
    return 0.0 * total


# --- the compiled functions, when an effect is made -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kernels", "members", "message"),
    [
        (
            {"force": pull, "tangent": pull_tangent},
            {},
            "must have .* `force`, `energy`, `tangent`, but effect Toy has no `energy`",
        ),
        ({"energy": none, "tangent": level}, {}, "An effect that exerts forces must have .* but effect Toy has no `force`"),
        ({"force": pull, "energy": pull_energy}, {}, "must have .* but effect Toy has no `tangent`"),
        ({"force": constant}, {"dead_load": True}, "A dead load must have .* `force`, `energy`, but effect Toy has no `energy`"),
        (LIVE, {"dead_load": True}, "A dead load .* alone, but effect Toy, whose `dead_load` is True, has `tangent`"),
        (DEAD | {"inertia": light}, {"dead_load": True}, "alone, but effect Toy, whose `dead_load` is True, has `inertia`"),
        (LIVE | {"whole_step": step}, {"linear_in_node_state": True}, "linear in the state of its node must have no `whole_step`"),
        (LIVE | {"between": step}, {}, "must be among `force`, .*`settle`, but effect Toy has `between`"),
        (LIVE | {"enery": none}, {}, "effect Toy has `enery`, did you mean `energy`"),
        (
            LIVE | {"force": lambda *of: 0.0},
            {},
            "`force` of an effect must be .* that of effect Toy is <function <lambda>",
        ),
        (LIVE | {"energy": None}, {}, "function `energy` of an effect must be compiled by Numba .* that of effect Toy is None"),
        (LIVE | {"force": not_compiled}, {}, "signatures.FORCE_SIGNATURE alone, but that of effect Toy is compiled for none"),
        (LIVE | {"energy": pull}, {}, r"signatures.ENERGY_SIGNATURE alone, but that of effect Toy is \(float64, .*\) -> float64"),
        (LIVE | {"force": twice}, {}, r"signatures.FORCE_SIGNATURE alone, .* float64, \(int64, "),
        (
            LIVE | {"force": late},
            {},
            r"`force` .* must not raise, but that of effect Toy may raise ValueError in line \d+",
        ),
        (LIVE | {"force": careful}, {}, "may raise AssertionError in line"),
        (LIVE | {"force": watched}, {}, "may raise IndexError"),
        (LIVE | {"force": divided}, {}, 'may raise ZeroDivisionError; with @njit.*error_model="numpy"'),
        ([pull], {}, "`kernels` of an effect must return a dict of compiled functions, but that of effect Toy is"),
        ({}, {}, "An effect must have `kernels` or `length_changes`, but effect Toy has neither"),
    ],
)
def test_compiled_functions_that_do_not_fit(kernels, members, message):
    with pytest.raises(SceneError, match=message):
        made(kernels, **members)


def test_compiled_functions_that_fit():
    assert made(LIVE) and made(DEAD, dead_load=True)
    assert made(LIVE | {"whole_step": step, "inertia": light}) and made(LIVE | {"force": divided_to_inf})
    assert made(LIVE | {"force": unreachable}), "what cannot be raised is no fault"
    assert may_raise(late.compiled) and not may_raise(unreachable.compiled) and not may_raise(divided_to_inf.compiled)


def test_slots_are_the_columns_of_the_table():
    assert [getattr(tables, f"SLOT_{slot.upper()}") for slot in SLOTS] == list(range(len(SLOTS)))


def test_laws_of_users_may_not_raise():
    """They are compiled, and checked, when a model is built."""

    @node_force
    def fragile(t, q, v):
        if q[2] < -2.0:
            raise ValueError("too deep")
        return 0.0, 0.0, 0.0

    @node_force
    def summed(t, q, v, weights):
        total = 0.0
        for w in weights:
            total += w * math.log(1.0 + q[0] ** 2)
        for x in range(3):
            total += weights[x] * q[x] / (1.0 + q[x] ** 2)
        return total, 0.0, 0.0

    with pytest.raises(SceneError, match=r"`force` .* must not raise, but that of effect fragile may raise ValueError in"):
        build(hung(fragile()))
    assert build(hung(summed(weights=(1.0, 2.0, 3.0)))), "loops over a tuple cannot leave it"


# --- classes --------------------------------------------------------------------------------------------------------------


def test_classes_that_are_none_of_effects():
    class Plain:
        pass

    class Undecorated(Effect):
        pass

    @dataclass
    class Changing(Effect):
        pass

    for kind, message in (
        (Plain, "must be a class derived from anet_lumped.effects.Effect, but it is <class .*Plain"),
        (Gravity(), r"must be a class derived from .*, but it is Gravity\(g=9.81"),
        (Undecorated, r"must be a frozen dataclass, @dataclass\(frozen=True\), but Undecorated is none"),
        (Changing, "must be a frozen dataclass, .* but Changing is none"),
    ):
        with pytest.raises(SceneError, match=message):
            REGISTRY[NAME] = kind
    with pytest.raises(TypeError, match="must check its parameters in `check_parameters`, but Hasty has `__post_init__`"):

        class Hasty(Effect):
            def __post_init__(self):
                pass


def test_effects_of_a_scene_are_registered():
    with pytest.raises(SceneError, match=r"must hold effects \(Air, .*Water.*\), but holds 3\."):
        hung(3)
    toy = made(LIVE)
    del REGISTRY[NAME]
    with pytest.raises(SceneError, match=r'holds Toy\(\); register its class: REGISTRY\["its_name"\] = Class\.'):
        hung(toy)


def test_tables():
    with pytest.raises(NotImplementedError, match="An effect with compiled functions must have a `table`, but effect Toy has none"):
        build(hung(made(LIVE, table=Effect.table)))
    square = made(LIVE, table=lambda self, model: (np.zeros(0, np.int64), np.eye(2)))
    with pytest.raises(SceneError, match=r"must return two flat arrays, .* of effect Toy they have shapes \(0,\) and \(2, 2\)"):
        build(hung(square))


@pytest.mark.parametrize("name", REGISTRY.library)
def test_effects_of_the_library(name):
    """Each has an example that acts on the net of the studies, and says of itself what its functions do."""
    kind, scene = REGISTRY[name], plain()
    check_effect_class(kind)
    assert kind.__module__ == f"anet_lumped.effects.{name}"
    effect = kind.example(scene)
    assert replace(effect) == effect and joins_others(effect, scene) == (name != "line_change")
    others = () if name == "gravity" else (Gravity(),)
    model = build(replace(scene, effects=(*others, effect)))
    assert (effect in model.forces) == (not effect.length_changes(scene))


def test_what_effects_say_of_themselves():
    """Defaults are the safe answers, and what depends on parameters follows them."""
    toy = made(LIVE)
    assert not any((toy.dead_load, toy.no_force_at_rest, toy.linear_in_node_state, toy.passive, toy.stiff, toy.jax_traceable))
    assert (toy.coupled_neighbours, toy.time_scales, toy.signals, toy.mass_damping_rate) == (0, (), (), 0.0)
    assert toy.uniform_acceleration == (0.0, 0.0, 0.0) and toy.length_changes(None) == () and toy.after_break({}, ()) is toy
    still_air, windy = Air(), Air(wind=_wind())
    assert still_air.no_force_at_rest and not windy.no_force_at_rest and not windy.passive
    steady, growing_load = Load((0, 0, 1.0)), Load((0, 0, 1.0), ramp=1.0)
    assert steady.dead_load and steady.passive and not growing_load.dead_load and not growing_load.passive
    assert ViscousDamping(2.0).mass_damping_rate == 2.0 and ViscousDamping(2.0).no_force_at_rest
    assert Water().stiff and not Water().passive


def _wind():
    return wind.Uniform((1.0, 0.0, 0.0))


def test_scenes_ask_members_and_not_names():
    """Gravity under another name, and two effects that accelerate all nodes, which add up."""

    @dataclass(frozen=True)
    class Downhill(Gravity):
        direction: tuple[float, float, float] = (1.0, 0.0, 0.0)

    REGISTRY["downhill"] = Downhill
    scene = hung(Downhill(2.0))
    np.testing.assert_allclose(scene.gravity, [2.0, 0.0, -9.81])
    angle = equilibrium(scene).position("b")
    assert angle[0] / -angle[2] == pytest.approx(2.0 / 9.81, rel=1e-9)


def test_one_function_of_time_for_a_rest_length():
    @dataclass(frozen=True)
    class Shrinking(Effect):
        def length_changes(self, scene):
            return [LengthChange(cable.name, STRAIN, 1.0, -1e-3) for cable in scene.cables]

    REGISTRY[NAME] = Shrinking
    shrunk = equilibrium(hung(Shrinking()))
    assert shrunk.position("b")[2] == pytest.approx(equilibrium(hung()).position("b")[2] + 1e-3, rel=1e-12)
    with pytest.raises(
        SceneError, match="strain at rest of a cable must be one function of time, but Shrinking gives a second one for"
    ):
        build(hung(Temperature(1e-5, 10.0), Shrinking()))


def test_payloads_change_beside_effects_without_functions():
    """What is picked up asks effects for added masses, of which those that change lengths have none."""
    points = [Driven("a", paths.line((0, 0, 0), (0.1, 0, 0), 0.1)), Free("b", mass=0.2)]
    scene = Scene(points, hung().cables, [Gravity(), Temperature(1e-5, 10.0)], [PayloadChange("b", 0.1, 0.4)])
    run = simulate(scene, 0.2, method="edmc", dt=0.01)
    assert run.ok and len(run.events) == 1
