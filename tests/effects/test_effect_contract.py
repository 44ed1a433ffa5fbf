"""The contract of effects: what cannot work is refused before a run, with a sentence that names the effect and what must hold."""

import math
from dataclasses import dataclass, make_dataclass, replace

import numpy as np
import pytest
from numba import njit, types
from systems import four_cables, nets

from anet_lumped import Cable, Driven, Fixed, Free, PayloadChange, Scene, SceneError, equilibrium, paths, simulate, wind
from anet_lumped.compiled.exceptions import may_raise
from anet_lumped.effects import REGISTRY, Air, Effect, Gravity, Load, Temperature, ViscousDamping, Water, node_energy, node_force
from anet_lumped.effects.effect import STRAIN, LengthChange, check_effect_class
from anet_lumped.effects.signatures import (
    ENERGY_SIGNATURE,
    FORCE_SIGNATURE,
    INERTIA_SIGNATURE,
    SLOTS,
    TANGENT_SIGNATURE,
    WHOLE_STEP_SIGNATURE,
)
from anet_lumped.model import tables
from anet_lumped.model.build import build
from studies.questions.effects_cost import joins_others, plain

NAME = "toy"


@pytest.fixture(autouse=True)
def own_registry(monkeypatch):
    """Effects that a test registers are gone after it."""
    monkeypatch.setattr(REGISTRY, "classes", dict(REGISTRY.classes))


# --- functions that do what their names say -------------------------------------------------------------------------------


@njit(FORCE_SIGNATURE)
def pull(t, q, v, index, params, f):
    """-q on each of the nodes that ``params`` has a number for."""
    for i in range(params.shape[0]):
        for x in range(3):
            f[i, x] -= params[i] * q[i, x]
    return 0.0


@njit(TANGENT_SIGNATURE)
def pull_tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    for i in range(min(params.shape[0], D.shape[0])):
        for x in range(3):
            D[i, x, x] += c_q * params[i]


@njit(ENERGY_SIGNATURE)
def pull_energy(t, q, index, params):
    total = 0.0
    for i in range(params.shape[0]):
        for x in range(3):
            total += 0.5 * params[i] * q[i, x] ** 2
    return total


@njit(ENERGY_SIGNATURE)
def none(t, q, index, params):
    return 0.0


@njit(TANGENT_SIGNATURE)
def level(t, q, v, index, params, c_q, c_v, D, near, far):
    pass


@njit(FORCE_SIGNATURE)
def still(t, q, v, index, params, f):
    return 0.0


@njit(FORCE_SIGNATURE)
def constant(t, q, v, index, params, f):
    f[0, 0] += 1.0
    return 0.0


@njit(ENERGY_SIGNATURE)
def of_constant(t, q, index, params):
    return -q[0, 0]


@njit(FORCE_SIGNATURE)
def dragged(t, q, v, index, params, f):
    f[0, 0] -= v[0, 0]
    return v[0, 0] * v[0, 0]


@njit(FORCE_SIGNATURE)
def pushed(t, q, v, index, params, f):
    f[0, 0] += v[0, 0]
    return -v[0, 0] * v[0, 0]


@njit(FORCE_SIGNATURE)
def growing(t, q, v, index, params, f):
    f[0, 0] += t
    return 0.0


@njit(FORCE_SIGNATURE)
def on_supports(t, q, v, index, params, f):
    f[f.shape[0] - 1, 2] += 1.0
    return 0.0


@njit(FORCE_SIGNATURE)
def paid(t, q, v, index, params, f):
    f[0, 0] += 1.0
    return 1.0


@njit(FORCE_SIGNATURE)
def cubic(t, q, v, index, params, f):
    f[0, 0] -= q[0, 0] ** 3
    return 0.0


@njit(FORCE_SIGNATURE)
def joined(t, q, v, index, params, f):
    f[0, 0] -= q[0, 0] - q[1, 0]
    return 0.0


@njit(TANGENT_SIGNATURE)
def wide(t, q, v, index, params, c_q, c_v, D, near, far):
    near[0, 0, 0, 0] -= c_q


@njit(TANGENT_SIGNATURE)
def wider(t, q, v, index, params, c_q, c_v, D, near, far):
    far[0, 0, 0, 0] -= c_q


@njit(WHOLE_STEP_SIGNATURE)
def step(t, h, base, q, index, params, f, D, near, far):
    return 0.0


@njit(WHOLE_STEP_SIGNATURE)
def wide_step(t, h, base, q, index, params, f, D, near, far):
    near[0, 0, 0, 0] -= 1.0
    return 0.0


@njit(WHOLE_STEP_SIGNATURE)
def giving_step(t, h, base, q, index, params, f, D, near, far):
    return -1.0


@njit(INERTIA_SIGNATURE)
def light(t, q, index, params, A):
    pass


# --- functions that may not stand where they do ---------------------------------------------------------------------------


@njit
def not_compiled(t, q, v, index, params, f):
    return 0.0


@njit([FORCE_SIGNATURE, types.float64(types.int64, *FORCE_SIGNATURE.args[1:])])
def twice(t, q, v, index, params, f):
    return 0.0


@njit(FORCE_SIGNATURE)
def late(t, q, v, index, params, f):
    if t > 0.05:
        raise ValueError("too late")
    return 0.0


@njit(FORCE_SIGNATURE)
def careful(t, q, v, index, params, f):
    if not t < 10.0:
        raise AssertionError
    return 0.0


@njit(FORCE_SIGNATURE)
def divided(t, q, v, index, params, f):
    return 1.0 / t


@njit(FORCE_SIGNATURE, error_model="numpy")
def divided_to_inf(t, q, v, index, params, f):
    return 1.0 / t


@njit(FORCE_SIGNATURE, boundscheck=True)
def watched(t, q, v, index, params, f):
    f[int(t), 0] += 0.0
    return 0.0


@njit(FORCE_SIGNATURE)
def unreachable(t, q, v, index, params, f):
    total = 0.0
    for x in range(3):
        if x == 3:
            raise ValueError("never")
        total += (t, t, t)[x]
    return 0.0 * total


LIVE = {"force": pull, "tangent": pull_tangent, "energy": pull_energy}
DEAD = {"force": constant, "energy": of_constant}


def made(kernels, numbers=(), **members):
    """An effect of the user's own, registered: compiled functions, their numbers, and what it says of itself."""
    table = np.zeros(0, np.int64), np.array(numbers, float)
    namespace = {"kernels": lambda self: kernels, "table": lambda self, model: table} | members
    kind = make_dataclass("Toy", [], bases=(Effect,), namespace=namespace, frozen=True)
    REGISTRY[NAME] = kind
    return kind()


def hung(*effects, segments=1, mass=0.2):
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, zeta=0.1, segments=segments)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", mass=mass, at=(0, 0, -1))], [cable], [Gravity(), *effects])


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
        (LIVE | {"between": step}, {}, "must be among `force`, .*`inertia`, but effect Toy has `between`"),
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
    assert may_raise(late) and not may_raise(unreachable) and not may_raise(divided_to_inf)


def test_slots_are_the_columns_of_the_table():
    assert [getattr(tables, f"SLOT_{slot.upper()}") for slot in SLOTS] == list(range(len(SLOTS)))


def test_laws_of_users_may_not_raise():
    """They are compiled, and checked, when a model is built."""

    @node_force
    def fragile(t, q, v):
        if q[2] < -2.0:
            raise ValueError("too deep")
        return 0.0, 0.0, 0.0

    @node_energy
    def summed(t, q, weights):
        total = 0.0
        for w in weights:
            total += w * math.log(1.0 + q[0] ** 2)
        for x in range(3):
            total += weights[x] * q[x] / (1.0 + q[x] ** 2)
        return total

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
    assert still_air.passive and still_air.no_force_at_rest and not windy.passive and not windy.no_force_at_rest
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


# --- what an effect says of itself, when a model is built -----------------------------------------------------------------


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
    fixed = Scene(
        [Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1.0, segments=1)]
    )
    assert build(replace(fixed, effects=[Gravity(), made(LIVE, linear_in_node_state=True)]))


@njit(TANGENT_SIGNATURE)
def viscous(t, q, v, index, params, c_q, c_v, D, near, far):
    D[0, 0, 0] += c_v


def test_statics_leave_out_what_acts_on_motion_alone():
    """No relaxation is compiled, nor asked for, with damping and with air that stands still; with wind it is."""
    scene = four_cables()
    thick = replace(scene, cables=[replace(cable, diameter=0.01) for cable in scene.cables])
    rest = equilibrium(thick)
    for effect in (ViscousDamping(1.0), REGISTRY["axial_damping"](1.0), Air()):
        np.testing.assert_array_equal(equilibrium(replace(thick, effects=(*thick.effects, effect))).q, rest.q)
    assert np.abs(equilibrium(replace(thick, effects=(*thick.effects, Air(wind=_wind())))).q - rest.q).max() > 1e-6


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
