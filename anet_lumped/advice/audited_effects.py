"""What there is to audit of each effect: when a scene has it, the scenes with and without it, its dimensionless numbers."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple, NoReturn

import numpy as np

from anet_lumped.checks import quoted
from anet_lumped.effects import REGISTRY
from anet_lumped.effects.effect import Effect
from anet_lumped.motion.stability import top_modes
from anet_lumped.results.run import Run
from anet_lumped.scene.creep import WITHOUT_CREEP
from anet_lumped.scene.scene import Cable, Free, Scene, SceneError

from . import dimensionless

UPRIGHT = 1e-12  # cosine of a chord's inclination, by rounding alone: such a cable has no sag


class Scales(NamedTuple):
    """Sizes of a motion, of cables by name.

    Parameters
    ----------
    tension : of each cable, mean over the run [N]
    along, chord, inclination : tension along its chord [N], chord [m] and its inclination [rad] at the start
    speed, air_speed : largest of a node [m/s], and against the wind
    g : gravity [m/s2]
    swing : time of a swing [s]
    """

    tension: dict[str, float]
    along: dict[str, float]
    chord: dict[str, float]
    inclination: dict[str, float]
    speed: float
    air_speed: float
    g: float
    swing: float


class Audited(NamedTuple):
    """How one effect is audited.

    ``present(scene)`` tells whether a scene has it; ``without(scene)`` gives one that has not, ``with_it(scene, water_level)`` one
    that has, or raises a SceneError that says which data it lacks. ``numbers(scene, scales)`` are the dimensionless ones of a scene
    that has it, ``frequency(scene)`` is the highest that it brings [rad/s].
    """

    present: Callable[[Scene], bool]
    without: Callable[[Scene], Scene]
    with_it: Callable[[Scene, float | None], Scene]
    numbers: Callable[[Scene, Scales], dict[str, float]]
    frequency: Callable[[Scene], float] = lambda scene: 0.0


def scales(run: Run, swing: float) -> Scales:
    """Scales of a run, given the time of a swing [s]."""
    scene, tension, along, chord, inclination = run.scene, {}, {}, {}, {}
    for cable in scene.cables:
        shape, name = run.shape(cable.name)[0], cable.name
        ends, segments = shape[-1] - shape[0], np.diff(shape, axis=0)
        chord[name] = float(np.linalg.norm(ends))
        inclination[name] = math.atan2(abs(ends[2]), math.hypot(ends[0], ends[1]))
        directions = segments / np.maximum(np.linalg.norm(segments, axis=1), 1e-12 * cable.L0)[:, None]
        along[name] = float(np.mean(run.tension(name)[0] * (directions @ ends))) / max(chord[name], 1e-12 * cable.length)
        tension[name] = float(run.tension(name).mean())
    speed = float(np.linalg.norm(run.v, axis=2).max())
    air_speed = max(speed, _against_wind(run))
    return Scales(tension, along, chord, inclination, speed, air_speed, float(np.linalg.norm(scene.gravity)), swing)


def _against_wind(run: Run) -> float:
    """Largest speed of a node against the wind, if the scene has one [m/s]."""
    air = _effect(run.scene, "air")
    if air is None or air.wind is None:
        return 0.0
    from anet_lumped.effects.flow.wind.kernel import pack, wind_at

    winds = pack(air.wind if isinstance(air.wind, tuple) else (air.wind,))
    flows = np.array([[wind_at(t, *x, winds)[0] for x in q] for t, q in zip(run.t, run.q, strict=True)])
    return float(np.linalg.norm(flows - run.v, axis=2).max())


def _effect(scene: Scene, name: str) -> Any:
    """The effect of a scene that has a name, or None."""
    return next((effect for effect in scene.effects if REGISTRY.name_of(effect) == name), None)


def _changed_cables(scene: Scene, **changes: Any) -> Scene:
    return replace(scene, cables=tuple(replace(cable, **changes) for cable in scene.cables))


def _without(scene: Scene, name: str) -> Scene:
    return replace(scene, effects=tuple(effect for effect in scene.effects if REGISTRY.name_of(effect) != name))


def _with(scene: Scene, effect: Effect) -> Scene:
    return replace(scene, effects=(*scene.effects, effect))


def _largest(scene: Scene, number: Callable[[Cable], float], wanted: Callable[[Cable], bool] = lambda cable: True) -> float:
    """The largest of a number over the cables that it is wanted of, NaN where it is of none."""
    return max((number(cable) for cable in scene.cables if wanted(cable)), default=math.nan)


def _elastic_numbers(scene: Scene, scales: Scales) -> dict[str, float]:
    numbers = {"strain": _largest(scene, lambda c: c.strain(scales.tension[c.name]))}
    sagging = {
        c.name
        for c in scene.cables
        if scales.along[c.name] > 0.0
        and scales.chord[c.name] > 0.0
        and math.cos(scales.inclination[c.name]) > UPRIGHT
        and not c.inextensible
    }
    if scales.g > 0.0 and sagging:
        numbers["Irvine's lambda²"] = min(
            dimensionless.irvine(
                c.mass_per_length * scales.g, scales.chord[c.name], scales.inclination[c.name], scales.along[c.name], c.EA
            )
            for c in scene.cables
            if c.name in sagging
        )
    return numbers


def _slowest_damping(scene: Scene, scales: Scales) -> dict[str, float]:
    """Of the first axial mode."""
    return {
        "damping ratio, first axial mode": _largest(
            scene,
            lambda c: dimensionless.axial_damping_ratio(c.axial_viscosity, c.EA, c.mass_per_length, c.length),
            lambda c: not c.inextensible,
        )
    }


def _drag_number(scene: Scene, scales: Scales, density: float, speed: float) -> float:
    return _largest(
        scene,
        lambda c: dimensionless.drag_over_weight(density, speed, c.diameter or 0.0, c.Cdn, c.mass_per_length * scales.g),
        lambda c: c.diameter is not None and scales.g > 0.0,
    )


def _air_numbers(scene: Scene, scales: Scales) -> dict[str, float]:
    return {"drag/weight": _drag_number(scene, scales, _effect(scene, "air").density, scales.air_speed)}


def _water_numbers(scene: Scene, scales: Scales) -> dict[str, float]:
    water = _effect(scene, "water")
    density, swings = water.density, [wave.usual_period for wave in water.all_waves]
    thickest = max((cable.diameter or 0.0 for cable in scene.cables), default=0.0)
    return {
        "drag/weight": _drag_number(scene, scales, density, scales.speed),
        "buoyancy/weight": _largest(
            scene, lambda c: dimensionless.buoyancy_over_weight(density, c.diameter or 0.0, c.mass_per_length)
        ),
        "Froude": dimensionless.froude(scales.speed, _largest(scene, lambda c: c.length), scales.g) if scales.g else math.nan,
        "Keulegan-Carpenter": dimensionless.keulegan_carpenter(scales.speed, max(swings, default=scales.swing), thickest)
        if thickest
        else math.nan,
    }


def _bending_numbers(scene: Scene, scales: Scales) -> dict[str, float]:
    def number(cable: Cable) -> float:
        tension = scales.tension[cable.name]
        return dimensionless.bending_over_segment(cable.EI, tension, cable.L0) if tension > 0.0 else math.inf

    return {"√(EI/T)/L0": _largest(scene, number, lambda c: c.EI > 0.0)}


def _damping_numbers(scene: Scene, scales: Scales) -> dict[str, float]:
    rate = _effect(scene, "viscous_damping").rate
    return {"damping ratio of a swing": dimensionless.damping_ratio(rate, 2.0 * math.pi / scales.swing)}


def _gravity_numbers(scene: Scene, scales: Scales) -> dict[str, float]:
    longest = _largest(scene, lambda c: c.length)
    return {"Froude": dimensionless.froude(scales.speed, longest, scales.g) if scales.g > 0.0 else math.inf}


def _payload_numbers(scene: Scene, scales: Scales) -> dict[str, float]:
    cables = sum(cable.mass_per_length * cable.length for cable in scene.cables)
    return {"payload/cables": dimensionless.payload_over_cables(sum(_masses(scene)), cables) if cables else math.inf}


def _ground_numbers(scene: Scene, scales: Scales) -> dict[str, float]:
    ground = _effect(scene, "ground")
    return {
        "depth/diameter": _largest(
            scene,
            lambda c: dimensionless.penetration(c.mass_per_length * scales.g, ground.stiffness, c.diameter or 0.0),
            lambda c: c.diameter is not None,
        )
    }


def _masses(scene: Scene) -> list[float]:
    return [point.mass for point in scene.points if isinstance(point, Free)]


def _unloaded(scene: Scene) -> Scene:
    points = tuple(replace(point, mass=0.0) if isinstance(point, Free) else point for point in scene.points)
    return replace(scene, points=points)


class InputMissing(SceneError):
    """What an effect would need and a scene does not say: a sentence, and the name of the `missing` input."""

    def __init__(self, sentence: str, missing: str) -> None:
        super().__init__(sentence)
        self.missing = missing


def _lacking(missing: str, sentence: str) -> Callable[[Scene, float | None], Scene]:
    """What raises the sentence: the data that an effect would need."""

    def refuse(scene: Scene, level: float | None) -> NoReturn:
        raise InputMissing(sentence, missing)

    return refuse


def _in_air(scene: Scene, level: float | None) -> Scene:
    return _if_thick("air", scene, lambda: REGISTRY["air"]())


def _in_water(scene: Scene, level: float | None) -> Scene:
    if level is None:
        raise InputMissing("It needs the level of the water [m], as in water_level=0.0.", "water level")
    if "water" not in REGISTRY:
        raise SceneError("There is no effect of water.")
    return _if_thick("water", scene, lambda: REGISTRY["water"](level=level))


def _if_thick(name: str, scene: Scene, make: Callable[[], Effect]) -> Scene:
    thin = [cable.name for cable in scene.cables if cable.diameter is None]
    if thin:
        raise InputMissing(f"It needs the `diameter` [m] of every cable, but {quoted(thin[0])} has none.", "diameter")
    return _with(scene, make())


def _bent(scene: Scene, level: float | None) -> Scene:
    if not any(cable.EI > 0.0 for cable in scene.cables):
        raise InputMissing("It needs cables with an `EI` [N·m²], but none has any.", "EI")
    return _with(scene, REGISTRY["bending"]())


def _axial_frequency(scene: Scene) -> float:
    return max((mode.omega for mode in top_modes(scene).values()), default=0.0)


def _in_scene(name: str) -> Callable[[Scene], bool]:
    return lambda scene: _effect(scene, name) is not None


def _registered(
    name: str, with_it: Callable[[Scene, float | None], Scene], numbers: Callable[[Scene, Scales], dict[str, float]]
) -> Audited:
    return Audited(
        _in_scene(name),
        lambda scene: _without(scene, name),
        with_it,
        numbers,
        lambda scene: _effect(scene, name).highest_frequency(scene),
    )


AUDITED: dict[str, Audited] = {
    "elasticity": Audited(
        lambda scene: not all(cable.inextensible for cable in scene.cables),
        lambda scene: _changed_cables(scene, EA=math.inf, tension_strain=None, **WITHOUT_CREEP),
        _lacking("EA", "It needs the `EA` [N] of the cables."),
        _elastic_numbers,
        _axial_frequency,
    ),
    "axial damping": Audited(
        lambda scene: any(cable.axial_viscosity > 0.0 for cable in scene.cables),
        lambda scene: _changed_cables(scene, zeta=0.0, BA=None),
        _lacking("zeta", "It needs the `zeta` or `BA` of cables that stretch."),
        _slowest_damping,
    ),
    "payload": Audited(
        lambda scene: any(_masses(scene)),
        _unloaded,
        _lacking("mass", "It needs the `mass` [kg] of a free point."),
        _payload_numbers,
    ),
    "gravity": _registered("gravity", lambda scene, level: _with(scene, REGISTRY["gravity"]()), _gravity_numbers),
    "air": _registered("air", _in_air, _air_numbers),
    "water": _registered("water", _in_water, _water_numbers),
    "bending": _registered("bending", _bent, _bending_numbers),
    "ground": _registered("ground", _lacking("height", "It needs the `height` [m] of the ground."), _ground_numbers),
    "viscous_damping": _registered("viscous_damping", _lacking("rate", "It needs a `rate` [1/s]."), _damping_numbers),
}


def audited_in(scene: Scene) -> dict[str, Audited]:
    """How each effect is audited, by name: those above, and whatever else the scene has."""
    others = [name for effect in scene.effects if (name := REGISTRY.name_of(effect)) and name not in AUDITED]
    return AUDITED | {name: _registered(name, _lacking("", ""), lambda scene, scales: {}) for name in others}
