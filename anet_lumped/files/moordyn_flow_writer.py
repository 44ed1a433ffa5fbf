"""Waves and a current of a scene → the files beside a deck from which MoorDyn's C++ version reads them.

A current that depends on the height alone is `Currents 1`, rows of a height and a velocity in current_profile.txt. Waves are sums
of regular ones, `WaveKin 7`: rows of a circular frequency, the two parts of an amplitude A and a heading in wave_frequencies.txt,
whose elevation is the imaginary part of A exp(i (omega t - k s)); so a cos(k s - omega t + phase) has A = a exp(i (pi/2 - phase)).
The first frequency must be 0. The names of both files are MoorDyn's, so that a folder holds the flow of one deck.
"""

import math
from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, shown
from anet_lumped.effects.flow import wind
from anet_lumped.effects.flow.waves.base import ALONG_X, ALONG_Y, AMPLITUDE, FREQUENCY, PHASE
from anet_lumped.effects.flow.wind.base import as_winds
from anet_lumped.scene.scene import Scene

from .moordyn_flow import TABLES

ONE_HEIGHT = (-1.0, 0.0)  # [m], where a current that is the same at all heights is written


def flow_options(water: Any, depth: float | None) -> dict[str, float]:
    """Options of the flow of Water; with waves, the depth of the water where no bottom gives it.

    Parameters
    ----------
    water : Water
    depth : float [m] or None
        Of the bottom, None without one.

    Raises
    ------
    SceneError : waves that grow from nothing, or in water of another depth; a current that is no profile over the height
    """
    options: dict[str, float] = {}
    if any(wave.rows(1.0)[:, FREQUENCY].min() == 0.0 for wave in water.all_waves):
        raise SceneError("Waves must have no constant elevation to be written for MoorDyn, but one has a frequency of 0.")
    if as_winds(water.current):
        _profile(water)
        options["Currents"] = 1
    if not water.all_waves:
        return options
    depths = {wave.depth for wave in water.all_waves}
    for wave in water.all_waves:
        if wave.ramp:
            raise SceneError(f"Waves must be there from the start to be written for MoorDyn, but one has ramp={wave.ramp}.")
    if len(depths) > 1 or (depth is not None and depths != {depth}):
        bottom = "" if depth is None else f" over a bottom {depth:g} m deep"
        raise SceneError(
            f"Waves must have the depth of the water to be written for MoorDyn, but have {shown(sorted(depths))} m{bottom}."
        )
    options["WaveKin"] = 7
    (of_waves,) = depths
    return options | ({} if math.isinf(of_waves) else {"WtrDpth": of_waves})


def flow_files(scene: Scene) -> dict[str, str]:
    """Texts of the files of the waves and the current of a scene, by their names; none for still water."""
    from anet_lumped.effects import REGISTRY

    water: Any = next((effect for effect in scene.effects if REGISTRY.name_of(effect) == "water"), None)
    files: dict[str, str] = {}
    if water is None:
        return files
    g = water.gravity(scene)
    if as_winds(water.current):
        heads = "the current over the height\nz u v w\n(m) (m/s) (m/s) (m/s)\n"
        files[TABLES["Currents", 1]] = heads + _text(_profile(water))
    if water.all_waves:
        waves = np.concatenate([wave.rows(g) for wave in water.all_waves])
        amplitude = waves[:, AMPLITUDE] * np.exp(1j * (0.5 * math.pi - waves[:, PHASE]))
        heading = np.arctan2(waves[:, ALONG_Y], waves[:, ALONG_X])
        table = np.column_stack([waves[:, FREQUENCY], amplitude.real, amplitude.imag, heading])
        rows = [[0.0] * 4, *table[np.argsort(waves[:, FREQUENCY], kind="stable")].tolist()]
        files[TABLES["WaveKin", 7]] = _text(rows)
    return files


def _text(rows: list[list[float]]) -> str:
    """Lines of numbers."""
    return "".join(" ".join(map(repr, row)) + "\n" for row in rows)


def _profile(water: Any) -> list[list[float]]:
    """Rows of a height [m] and a velocity [m/s] of a current, (n, 4)."""
    profiles = []
    for one in as_winds(water.current):
        if isinstance(one, wind.Uniform):
            profiles.append(np.array([[0.0, *one.velocity]]))
        elif isinstance(one, wind.Sampled):
            samples = np.array(one.samples)
            profiles.append(np.column_stack([samples, np.zeros(len(samples))]))
        elif isinstance(one, wind.Gridded) and len(one.t) == len(one.x) == len(one.y) == 1:
            profiles.append(np.column_stack([one.z, np.array(one.velocity)]))
        else:
            raise SceneError(
                "A current must be made of Uniform and Sampled, or of a Gridded that changes over the height alone, to be written "
                f"for MoorDyn, but Water has {shown(one)}."
            )
    z = np.unique(np.concatenate([profile[:, 0] for profile in profiles]))
    z = np.array(ONE_HEIGHT) if len(z) == 1 else z
    velocity = sum(np.column_stack([np.interp(z, p[:, 0], p[:, 1 + x]) for x in range(3)]) for p in profiles)
    return np.column_stack([z, velocity]).tolist()
