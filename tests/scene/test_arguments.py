"""Every argument of what a user writes, given what it cannot be: one sentence that names it, and never another error."""

import contextlib
import inspect
import math
import warnings
from decimal import Decimal
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from anet_lumped import (
    Body,
    Cable,
    CableCut,
    Driven,
    Fixed,
    Free,
    InputError,
    PayloadChange,
    Release,
    Rod,
    Scene,
    SceneError,
    equilibrium,
    load_scene,
    paths,
    rope,
    save_moordyn,
    save_scene,
    shapes,
    signals,
    simulate,
    waves,
    wind,
    working_curves,
)  # fmt: skip
from anet_lumped.advice.compare import compare
from anet_lumped.advice.effect_audit import audit_effects
from anet_lumped.advice.markers import fit_markers
from anet_lumped.advice.recommend import recommend
from anet_lumped.checks import LONGEST
from anet_lumped.effects import REGISTRY
from anet_lumped.motion.stability import predict

POINTS = [Fixed("a", (0, 0, 0)), Free("b")]
MAKERS = {
    "Fixed": (Fixed, {"name": "a", "at": (0, 0, 0)}),
    "Driven": (Driven, {"name": "a", "path": paths.line((0, 0, 0), (1, 0, 0), 1.0)}),
    "Free": (Free, {"name": "a"}),
    "Body": (Body, {"name": "a", "mass": 1.0, "inertia": (0.1, 0.1, 0.1), "at": (0, 0, 0), "attachments": {"hook": (0, 0, 0.1)}}),
    "Rod": (Rod, {"name": "leg", "start": (0, 0, 0), "end": (0, 0, 1), "diameter": 0.1}),
    "Cable": (Cable, {"start": "a", "end": "b", "length": 1.0, "mass_per_length": 0.1, "EA": 1e3, "segments": 2}),
    "PayloadChange": (PayloadChange, {"point": "b", "t": 1.0, "mass": 1.0}),
    "CableCut": (CableCut, {"cable": "a-b", "t": 1.0, "segment": 0}),
    "Release": (Release, {"point": "b", "holder": "a", "t": 1.0, "tension": 9.0}),
    "paths.line": (paths.line, {"start": (0, 0, 0), "velocity": (1, 0, 0), "ramp": 1.0}),
    "paths.samples": (paths.samples, {"t": [0.0, 1.0], "xyz": [(0, 0, 0), (1, 0, 0)]}),
    "paths.circle": (
        paths.circle,
        dict(start=(1, 0, 0), center=(0, 0, 0), axis=(0.0, 0.0, 1.0), period=2.0, turns=1.5, ramp=0.5),
    ),
    "paths.lift": (paths.lift, dict(start=(0.0, 0.0, 0.0), by=(0.0, 0.0, 1.0), duration=1.0, hold=0.5)),
    "paths.harmonic": (paths.harmonic, {"center": (0, 0, 0), "amplitude": (1, 0, 0), "frequency": 1.0}),
    "paths.external": (paths.external, {"start": (0, 0, 0)}),
    "signals.line": (signals.line, {"start": 0.0, "rate": 1.0, "ramp": 1.0}),
    "signals.samples": (signals.samples, {"t": [0.0, 1.0], "values": [0.0, 1.0]}),
    "signals.harmonic": (signals.harmonic, {"center": 0.0, "amplitude": 1.0, "frequency": 1.0}),
    "rope": (rope, {"name": "nylon", "diameter": 0.01}),
    "wind.Uniform": (wind.Uniform, {"velocity": (1, 0, 0)}),
    "wind.PowerLaw": (wind.PowerLaw, {"speed": 8.0, "height": 10.0, "exponent": 0.14}),
    "wind.Logarithmic": (wind.Logarithmic, {"speed": 8.0, "height": 10.0, "roughness": 0.03}),
    "wind.Gust": (wind.Gust, {"amplitude": (1, 0, 0), "start": 0.0, "rise": 1.0}),
    "wind.Dryden": (wind.Dryden, {"sigma": 1.0, "length": 10.0, "carried": (5, 0, 0), "seed": 1}),
    "wind.Sampled": (wind.Sampled, {"samples": [(0.0, 1.0, 0.0), (10.0, 2.0, 0.0)]}),
    "wind.Recorded": (wind.Recorded, {"file": "wind.csv"}),
    "wind.Gridded": (wind.Gridded, {"velocity": [(1.0, 0.0, 0.0)]}),
    "shapes.Sphere": (shapes.Sphere, {"at": (0, 0, 0), "radius": 1.0}),
    "shapes.Cylinder": (shapes.Cylinder, {"at": (0, 0, 0), "radius": 1.0, "axis": (1, 0, 0), "length": 2.0, "edge": 0.1}),
    "shapes.Box": (shapes.Box, {"at": (0, 0, 0), "size": (1, 1, 1), "rotation": (0, 0, 1), "edge": 0.1}),
    "working_curves.Linear": (working_curves.Linear, {"permanent": 0.2, "T_max": 1.0}),
    "working_curves.Quadratic": (working_curves.Quadratic, {"permanent": 0.2, "bend": 0.5, "T_max": 1.0}),
    "working_curves.Exponential": (working_curves.Exponential, {"permanent": 0.2, "bend": 0.5, "T_max": 1.0}),
    "waves.Airy": (waves.Airy, {"height": 1.0, "period": 5.0}),
    "waves.Jonswap": (waves.Jonswap, {"height": 1.0, "period": 5.0, "seed": 1}),
    "waves.PiersonMoskowitz": (waves.PiersonMoskowitz, {"height": 1.0, "period": 5.0, "seed": 1}),
    "waves.Components": (waves.Components, {"components": [(0.1, 1.0, 0.0, 0.0)]}),
    "waves.Recorded": (waves.Recorded, {"file": "gauge.csv"}),
}
CABLE = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=2)
MAKERS["Scene"] = (Scene, {"points": POINTS, "cables": [CABLE]})
SCENE = SimpleNamespace(supports=[(0.0, 0.0, 0.0)], cables=[CABLE], longest=1.0, free_points=[Free("b")])
for name in REGISTRY.library:
    example = REGISTRY[name].example(SCENE)
    MAKERS[name] = (type(example), {key: getattr(example, key) for key in inspect.signature(type(example)).parameters})

WRONG = {
    "a string": "text",
    "nothing": None,
    "an empty list": [],
    "a list": [1.0],
    "nan": math.nan,
    "an empty dict": {},
    "a dict": {"a": 1.0},
    "a bool": True,
    "an object": object(),
    "400 digits": 10**400,
    "5000 digits": 10**5000,
    "a huge fraction": Fraction(10**400, 3),
    "a Decimal": Decimal("1.5"),
    "a complex number": 1j,
    "a time of NumPy": np.timedelta64(3, "s"),
    "an array of text": np.array("x"),
    "huge numbers": [10**400, 10**400, 10**400],
    "escapes": ["\x1b[31m\n" * 100],
}
NAMES = {
    ("Body", "name"), ("Rod", "name"), ("Fixed", "name"), ("Driven", "name"), ("Free", "name"), ("Cable", "start"),
    ("Cable", "end"), ("Cable", "name"), ("PayloadChange", "point"), ("CableCut", "cable"),
    ("Release", "point"), ("Release", "holder"),
}  # fmt: skip
NONE = {
    ("Release", "t"), ("Release", "tension"),
    ("Free", "at"), ("Cable", "BA"), ("Cable", "name"), ("Cable", "diameter"), ("Cable", "breaking_tension"),
    ("Cable", "tension_strain"), ("Cable", "EA_dynamic"), ("Cable", "BA_creep"), ("Cable", "working_curve"),
    ("Cable", "shedding_window"),
    ("working_curves.Linear", "EA"),
    ("air", "wind"), ("air", "surface"), ("water", "current"), ("water", "wave"),
    ("water", "waves"), ("water", "g"), ("shapes.Cylinder", "edge"), ("shapes.Box", "edge"),
    ("waves.Jonswap", "spreading"), ("waves.PiersonMoskowitz", "spreading"),
    ("load", "cables"), ("rope", "tension"), ("Body", "pinned"), ("Body", "pinned_to"), ("Body", "path"), ("Body", "turning"),
    ("Body", "hull"), ("paths.samples", "ends"), ("paths.samples", "periods"), ("signals.samples", "ends"),
    ("signals.samples", "periods"), ("paths.lift", "hold"), ("PayloadChange", "volume"), ("PayloadChange", "CdA"),
}  # fmt: skip
EMPTY = {
    ("air", "wind"),
    ("water", "current"),
    ("water", "waves"),
    ("bending", "clamped"),
    ("moment_curvature", "clamped"),
    ("Scene", "effects"),
    ("Scene", "events"),
    ("Scene", "bodies"),
    ("Body", "attachments"),
    ("Body", "rods"),
    ("Body", "carried"),
}
APPLIED = ("force", "torque", "force_in_body")
DASHPOTS = ("linear", "quadratic", "linear_in_body", "quadratic_in_body")
BY_NAME = {("axial_damping", "rate"), ("temperature", "expansion")}
RIGHT = (
    {("a string", *one) for one in NAMES}
    | {("nothing", *one) for one in NONE}
    | {("an empty list", *one) for one in EMPTY}
    | {("a dict", *one) for one in BY_NAME}
    | {
        ("an empty dict", "bending", "clamped"),
        ("an empty dict", "moment_curvature", "clamped"),
        ("an empty dict", "Body", "attachments"),
        ("an empty dict", "Body", "carried"),
        ("a bool", "wind.Gust", "stays"),
        ("a bool", "water", "points_float"),
        ("escapes", "load", "cables"),
    }
    | {(empty, "applied_forces", what) for empty in ("an empty list", "an empty dict") for what in APPLIED}
    | {(empty, "dashpots", what) for empty in ("an empty list", "an empty dict") for what in DASHPOTS}
    | {("a list", "wind.Gridded", axis) for axis in "xyzt"}
    | {
        (f"{digits} digits", owner, "seed")
        for digits in (400, 5000)
        for owner in ("wind.Dryden", "waves.Jonswap", "waves.PiersonMoskowitz")
    }
)
"""What is no mistake after all."""


ARGUMENTS = [(owner, argument) for owner, (maker, _) in MAKERS.items() for argument in inspect.signature(maker).parameters]


@pytest.fixture(autouse=True)
def recorded(tmp_path, monkeypatch):
    """A recorded wind and a recorded elevation in the folder that relative paths start from."""
    (tmp_path / "wind.csv").write_text("t,u,v,w\n0,1,0,0\n1,2,0,0\n", encoding="utf-8")
    (tmp_path / "gauge.csv").write_text("t,elevation\n0,1\n1,2\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)


def answer(owner, argument, wrong):
    """What is said to a wrong argument; "" if it is taken."""
    maker, arguments = MAKERS[owner]
    try:
        maker(**(arguments | {argument: WRONG[wrong]}))
    except SceneError as refused:
        return str(refused)
    return ""


def is_one_sentence_that_says_what_must_hold(said):
    return (
        said.endswith((".", "?"))
        and said.isprintable()
        and len(said) <= LONGEST
        and any(word in said for word in (" must ", " may ", "known: "))
    )


@pytest.mark.parametrize(("owner", "argument"), ARGUMENTS)
def test_wrong_types(owner, argument):
    for wrong in WRONG:
        said = answer(owner, argument, wrong)
        assert (not said) == ((wrong, owner, argument) in RIGHT), f"{wrong}: {said or 'taken'}"
        if said:
            assert is_one_sentence_that_says_what_must_hold(said), f"{wrong}: {said}"
            assert argument in said or "name of a" in said or "recorded wind" in said or owner == "rope", f"{wrong}: {said}"


@pytest.mark.parametrize("size", [1e308, -1e308, 1e200, 5e-324, 1e-200, 1e100, 1e-100, 0.0, Fraction(1, 3), np.array(1.5)], ids=str)
@pytest.mark.parametrize("owner", MAKERS)
def test_numbers_of_any_size_and_kind_are_taken_or_refused(owner, size):
    maker, arguments = MAKERS[owner]
    for argument, value in arguments.items():
        wrong = (size,) * 3 if isinstance(value, tuple) and len(value) == 3 else size
        with contextlib.suppress(InputError), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the diameter of a rope
            maker(**(arguments | {argument: wrong}))


@pytest.mark.parametrize("owner", MAKERS)
def test_what_is_right_is_made(owner):
    """With NumPy's numbers in place of Python's too, which become Python's."""
    maker, arguments = MAKERS[owner]
    made = maker(**arguments)
    numbers = {key: np.float64(value) for key, value in arguments.items() if type(value) is float}
    again = maker(**(arguments | numbers))
    assert again == made
    if not isinstance(made, dict | paths.Path | signals.Signal):
        assert all(type(getattr(again, key)) is float for key in numbers)


TAKE_A_SCENE = {
    "simulate": lambda scene: simulate(scene, 1.0),
    "equilibrium": equilibrium,
    "predict": predict,
    "recommend": lambda scene: recommend(scene, 1e-3),
    "audit_effects": lambda scene: audit_effects(scene, 1e-3),
    "fit_markers": lambda scene: fit_markers(np.zeros((3, 3)), scene),
    "save_scene": lambda scene: save_scene(scene, "net.toml"),
    "save_moordyn": lambda scene: save_moordyn(scene, "net.txt"),
}


@pytest.mark.parametrize("function", TAKE_A_SCENE)
@pytest.mark.parametrize("value", [[1], {}, None, np.zeros(3)], ids=str)
def test_what_takes_a_scene_refuses_what_is_none(function, value):
    with pytest.raises(SceneError, match=r"A scene must be a Scene, but it is .*\."):
        TAKE_A_SCENE[function](value)


def test_what_else_may_be_taken_for_a_scene_or_a_state():
    with pytest.raises(SceneError, match=r"but it is 'net_held'; load_scene\(...\) reads one from a file\."):
        equilibrium("net_held")
    with pytest.raises(SceneError, match=r"A scene file must be given by its path, but it is \[1\]\."):
        load_scene([1])
    with pytest.raises(InputError, match=r"must be a State, as equilibrium\(scene\) returns one, but it is <Scene of 2 points"):
        compare(Scene(POINTS, [CABLE]))


@pytest.mark.parametrize("value", [np.zeros((21, 3)), [1], None, 3, "straigt"], ids=str)
def test_a_start_that_is_none_is_named_in_short(value):
    with pytest.raises(InputError, match=r'`start` must be "equilibrium", "calm", "straight" or a State, but it is .*') as refused:
        simulate(Scene(POINTS, [CABLE], [REGISTRY["gravity"]()]), 0.1, start=value)
    assert len(str(refused.value)) < 300


def test_a_run_is_no_start_and_its_states_are():
    scene = Scene([POINTS[0], Free("b", at=(1, 0, 0))], [CABLE], [REGISTRY["gravity"]()])
    run = simulate(scene, 0.1, start="straight")
    with pytest.raises(InputError, match=r"but it is <Run 'done'.*>; a Run has States, run.final and run.state\(k\)\."):
        simulate(scene, 0.1, start=run)
    assert [repr(scene), repr(run.model)] == [
        "<Scene of 2 points, 1 cables of 2 segments, Gravity>",
        "<Model of 3 nodes and 2 segments>",
    ]
    assert repr(run.final) == "<State at t=0.1 s of 3 nodes>"
    assert repr(run).startswith("<Run 'done': edmc with dt=") and repr(run).endswith(" states of 3 nodes from t=0 s to 0.1 s>")


@pytest.mark.parametrize("name", ["t_end", "dt", "rho_inf", "method", "rtol"])
@pytest.mark.parametrize("value", ["0.1", [1], np.array([1.0, 2.0])], ids=str)
def test_arguments_of_a_run_refuse_what_they_cannot_be(name, value):
    with pytest.raises(InputError, match=f"Argument `{name}` must "):
        simulate(Scene(POINTS, [CABLE]), **{"t_end": 1.0} | {name: value})
