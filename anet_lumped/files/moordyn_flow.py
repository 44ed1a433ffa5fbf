"""Waves and currents of a MoorDyn file, from the files beside it that MoorDyn's C++ version reads.

| option | file | becomes |
|---|---|---|
| WaveKin 2 | wave_frequencies.txt: omega, real and imaginary part of an amplitude, heading | a sum of waves |
| WaveKin 3 | wave_elevation.txt: time and elevation at the origin | the waves of its Fourier series, up to 0.5 Hz |
| WaveKin 7 | wave_frequencies.txt | a sum of these waves |
| Currents 1 | current_profile.txt: z and velocity, below three lines | a profile |
| Currents 2 | current_profile_dynamic.txt: heights on line 5, times and velocities from line 7 on | a profile that changes |
| Currents 5 | current_profile_4d.txt: lengths of the axes, the axes, place, time and velocity | a velocity on a grid |

WaveKin 1 is given by another program. MoorDyn reads nothing for the other numbers, and neither is anything read here.

The elevation of WaveKin 2 is the real part of sum_m A_m exp(i (omega_m t - k_m s)), with half of the first and of the last, at
frequencies of one spacing, to which what is given is interpolated. That of WaveKin 7 is the imaginary part. WaveKin 3 takes its
elevation every dtWave, interpolated. MoorDyn puts the waves of 2 and 3 on the grid of water_grid.txt, in its own time step, and
takes them from there; here they are evaluated wherever a node is.

Source: MoorDyn's documentation, "Water Kinematics In MoorDyn"; its sources Waves.cpp, WaveGrid.cpp, WaveSpectrum.cpp,
SpectrumKin.cpp (version 2.7).
"""

import math
import pathlib
from collections.abc import Callable, Sequence
from itertools import takewhile
from typing import Any

import numpy as np

from anet_lumped.checks import InputError
from anet_lumped.effects.flow import waves, wind
from anet_lumped.effects.flow.waves.recorded import fourier_series
from anet_lumped.regular_files import read_text

from .moordyn_options import Options
from .moordyn_rows import Row, made, number_of

HIGHEST = 0.5  # [Hz], above which MoorDyn leaves out what a recorded elevation holds
DT_WAVE = 0.25  # [s], MoorDyn's default of dtWave
FROM_OUTSIDE = 1  # WaveKin: by the program that calls MoorDyn
TABLES = {
    ("WaveKin", 2): "wave_frequencies.txt", ("WaveKin", 3): "wave_elevation.txt", ("WaveKin", 7): "wave_frequencies.txt",
    ("Currents", 1): "current_profile.txt", ("Currents", 2): "current_profile_dynamic.txt",
    ("Currents", 5): "current_profile_4d.txt",
}  # fmt: skip
HEIGHTS_ON = 5  # line of current_profile_dynamic.txt; the next one is passed over
FIRST = {"current_profile.txt": 4, "current_profile_dynamic.txt": HEIGHTS_ON}  # lines with numbers begin there


def read_flow(options: Options, depth: Callable[[], float], folder: str | pathlib.Path) -> dict[str, Any]:
    """Return the arguments `waves` and `current` of the water of a file, as far as it has them.

    Parameters
    ----------
    options : Options
    depth : callable
        Returns the depth of the water [m].
    folder : str or pathlib.Path
        Where the tables are.
    """
    found: dict[str, Any] = {}
    for name, argument in (("WaveKin", "waves"), ("Currents", "current")):
        with options.findings.refusing():
            kind = int(options.values.get(name, 0.0))
            if kind and (name, kind) not in TABLES:
                _pass_over(name, kind, options)
            elif kind and (lines := _lines(name, kind, options, folder)) is not None:
                row = options.rows[name]
                flow = _wave(kind, lines, options, depth) if name == "WaveKin" else CURRENTS[kind](lines, row)
                found |= {} if flow is None else {argument: flow}
    if options.values.get("WaveKin") != 3.0 and "dtWave" in options.rows:
        options.findings.unused("dtWave", options.rows["dtWave"].line, "options of MoorDyn's own run")
    if "waves" not in found and "waveKin_rampT" in options.rows:
        options.findings.unused("waveKin_rampT", options.rows["waveKin_rampT"].line, "options of MoorDyn's own run")
    return found


class _Lines(list):
    """Numbers of each line of a table, with its line in the file, behind the lines that are passed over."""

    def __init__(self, file: str, row: Row, text: str, first: int) -> None:
        self.file, self.row = file, row
        lines = [(number, line.split()) for number, line in enumerate(text.splitlines(), start=1) if number >= first]
        super().__init__((number, words) for number, words in lines if words)

    def error(self, line: int, why: str) -> Exception:
        """The option's row is refused for what a line of the table says."""
        return self.row.error(f"{self.file}, line {line}: {why}")

    def numbers(self, k: int, least: int) -> list[float]:
        """Numbers of the k-th line, of which there must be at least ``least``."""
        line, words = self[k]
        values = [number_of(word) for word in words]
        if len(values) < least or not all(map(math.isfinite, values[:least])):
            raise self.error(line, f"must begin with {least} finite numbers, but it is {' '.join(words):.60}.")
        return list(takewhile(math.isfinite, values))


def _pass_over(name: str, kind: int, options: Options) -> None:
    line = options.rows[name].line
    if name == "WaveKin" and kind == FROM_OUTSIDE:
        options.findings.remark(
            f"Line {line}: WaveKin 1 is a flow that the program gives which calls MoorDyn. None is given: the water is still."
        )
        return
    options.findings.remark(f"Line {line}: MoorDyn has no {name} {kind} yet and reads nothing for it, so that nothing flows by it.")


def _lines(name: str, kind: int, options: Options, folder: str | pathlib.Path) -> _Lines | None:
    """Lines of the table of an option; None, with a remark, where there is no such file."""
    row, file = options.rows[name], TABLES[name, kind]
    path = pathlib.Path(folder) / file
    if not path.exists():
        thing = "are no waves" if name == "WaveKin" else "is no current"
        options.findings.remark(f"Line {row.line}: {name} {kind} reads {file}, which is not beside the deck. There {thing} here.")
        return None
    try:
        text = read_text(path, "It", errors="replace")
    except InputError as error:
        raise row.error(f"{file} must be a table. {error}") from None
    lines = _Lines(file, row, text, FIRST.get(file, 1))
    if not lines:
        raise row.error(f"{file} must hold numbers from line {FIRST.get(file, 1)} on, but it ends before.")
    return lines


def _wave(kind: int, lines: _Lines, options: Options, depth: Callable[[], float]) -> waves.Wave | None:
    """Waves of WaveKin 2, 3 or 7; None if nothing moves."""
    row = options.rows["WaveKin"]
    under, ramp = positive_depth(row, depth), _ramp(options)
    rows = _of_elevation(lines, options) if kind == 3 else _of_frequencies(lines, evenly=kind == 2)
    if kind != 7:
        options.findings.remark(
            f"Line {row.line}: the waves of WaveKin {kind} are evaluated at each node, where MoorDyn interpolates linearly on the "
            "grid of water_grid.txt and in time."
        )
    if not ramp:
        options.findings.remark(
            "A run starts from a rest in the water at t = 0, which waves move already; MoorDyn's starts in still water. With a "
            "`ramp` the waves grow from nothing: --set water.waves.ramp=20."
        )
    rows = rows[rows[:, 0] != 0.0]
    return made(row, waves.Components, tuple(map(tuple, rows.tolist())), under, ramp) if len(rows) else None


def positive_depth(row: Row, depth: Callable[[], float]) -> float:
    """Depth of the water [m], which waves need."""
    if not depth() > 0.0:
        raise row.error("waves need the depth of the water; WtrDpth must be positive.")
    return depth()


def _ramp(options: Options) -> float:
    """Time [s] over which waves grow from nothing: linearly in MoorDyn, by a smoothstep here."""
    ramp = options.values.get("waveKin_rampT", 0.0)
    if not isinstance(ramp, float) or ramp < 0.0:
        raise options.rows["waveKin_rampT"].error("waveKin_rampT must be a number of at least 0.")
    if ramp:
        line = options.rows["waveKin_rampT"].line
        options.findings.remark(f"Line {line}: waves grow over {ramp:g} s by a smoothstep, where MoorDyn's grow linearly.")
    return ramp


def _of_frequencies(lines: _Lines, evenly: bool) -> np.ndarray:
    """Components (n, 4) of wave_frequencies.txt: amplitude [m], circular frequency [rad/s], phase and heading [rad]."""
    table = np.array([[*lines.numbers(k, 3), 0.0][:4] for k in range(len(lines))])
    if (table[:, 0] < 0.0).any():
        raise lines.error(lines[int(np.argmax(table[:, 0] < 0.0))][0], "a frequency must not be negative.")
    omega, amplitude, heading = table[:, 0], table[:, 1] + 1j * table[:, 2], table[:, 3]
    if not evenly:  # the imaginary part of A exp(i (omega t - k s)) is |A| cos(k s - omega t - arg A + pi/2)
        return np.column_stack([np.abs(amplitude), omega, 0.5 * math.pi - np.angle(amplitude), heading])
    steps = np.diff(omega)
    if len(omega) < 2 or not (steps > 0.0).all() or omega[0] != 0.0:
        raise lines.error(lines[0][0], "for WaveKin 2 frequencies must begin with 0 and increase.")
    even = steps.min() * np.arange(math.floor(omega[-1] / steps.min() * (1.0 + 1e-12)) + 1)
    amplitude, heading = np.interp(even, omega, amplitude), np.interp(even, omega, heading)
    amplitude[[0, -1]] *= 0.5
    return np.column_stack([np.abs(amplitude), even, -np.angle(amplitude), heading])


def _of_elevation(lines: _Lines, options: Options) -> np.ndarray:
    """Components (n, 4) of wave_elevation.txt, sampled every dtWave, an even number of times."""
    table = np.array([lines.numbers(k, 2)[:2] for k in range(len(lines))])
    given = options.values.get("dtWave", DT_WAVE)
    step = given if isinstance(given, float) else math.nan
    if not step > 0.0:
        raise options.rows["dtWave"].error("dtWave must be a positive number.")
    series = elevation_series(table, step, HIGHEST, lambda k, why: lines.error(lines[k][0], why))
    return np.column_stack([series, np.zeros(len(series))])


def elevation_series(table: np.ndarray, step: float, highest: float, error: Callable[[int, str], Exception]) -> np.ndarray:
    """Amplitude [m], circular frequency [rad/s] and phase [rad] (n, 3) of a recorded elevation.

    Parameters
    ----------
    table : (k, 2) float64, time [s] and elevation [m]
    step : float [s], in which it is sampled, an even number of times
    highest : float [Hz], above which components are left out
    error : callable
        Makes an error of a row of the table and why it does not do.
    """
    if len(table) < 2 or not (np.diff(table[:, 0]) > 0.0).all():
        raise error(0, "the times of an elevation must be at least two and increase.")
    count = math.floor(table[-1, 0] / step) + 1
    count -= count % 2
    if count < 2:
        raise error(-1, f"an elevation must last longer than one step of dtWave, {step:g} s.")
    return fourier_series(0.0, step, np.interp(step * np.arange(count), *table.T), highest)


def _profile(lines: _Lines, row: Row) -> wind.Wind:
    """Current of current_profile.txt."""
    table = np.array([[*lines.numbers(k, 2), 0.0, 0.0][:4] for k in range(len(lines))])
    if table[:, 3].any():
        return made(row, wind.Gridded, tuple(map(tuple, table[:, 1:].tolist())), tuple(table[:, 0].tolist()))
    return made(row, wind.Sampled, tuple(map(tuple, table[:, :3].tolist())))


def _profile_in_time(lines: _Lines, row: Row) -> wind.Wind:
    """Current of current_profile_dynamic.txt."""
    if lines[0][0] != HEIGHTS_ON:
        raise lines.error(lines[0][0], f"the heights must stand on line {HEIGHTS_ON}.")
    heights = lines.numbers(0, 1)
    n = len(heights)
    rows = [k for k, (line, _) in enumerate(lines) if line > HEIGHTS_ON + 1]
    if not rows:
        raise row.error(f"{lines.file} must have rows of a time and velocities from line {HEIGHTS_ON + 2} on.")
    t, velocity = [], []
    for k in rows:
        numbers = lines.numbers(k, 1 + n)
        t.append(numbers[0])
        u, v, w = (numbers[1 + i * n : 1 + (i + 1) * n] for i in range(3))
        v, w = (component if len(component) == n else [0.0] * n for component in (v, w))
        velocity += list(zip(u, v, w, strict=True))
    _say_what_of_times(lines, row, t)
    return made(row, wind.Gridded, tuple(velocity), tuple(heights), tuple(t))


def _grid(lines: _Lines, row: Row) -> wind.Wind:
    """Current of current_profile_4d.txt, whose rows may come in any order."""
    lengths = [int(number) for number in lines.numbers(0, 4)[:4]]
    if not 0 < math.prod(lengths) <= len(lines) - 5 or min(lengths) < 1:
        raise row.error(
            f"{lines.file} must have a row for each of {' x '.join(map(str, lengths))} places and times, but has {len(lines) - 5}."
        )
    x, y, z, t = (tuple(lines.numbers(1 + i, max(1, length))[:length]) for i, length in enumerate(lengths))
    place = {at: i for i, at in enumerate((a, b, c, d) for d in t for c in z for b in y for a in x)}
    velocity: list[Any] = [None] * len(place)
    for k in range(5, len(lines)):
        numbers = lines.numbers(k, 7)
        i = place.get((numbers[0], numbers[1], numbers[2], numbers[3]))
        if i is None:
            raise lines.error(lines[k][0], "a row must be at a place and a time of the grid.")
        velocity[i] = tuple(numbers[4:7])
    row.findings.remark(f"Line {row.line}: all rows of {lines.file} are read; MoorDyn 2.7 takes the first for a current of 0.")
    _say_what_of_times(lines, row, t)
    if None in velocity:
        missing = list(place)[velocity.index(None)]
        raise row.error(f"{lines.file} must have a row for each place and time, but none at {missing}.")
    return made(row, wind.Gridded, tuple(velocity), z, t, x, y)


def _say_what_of_times(lines: _Lines, row: Row, t: Sequence[float]) -> None:
    if len(t) > 1:
        row.findings.remark(
            f"Line {row.line}: the current is linear between the times of {lines.file}, and stays as it is after the last, "
            f"{t[-1]:g} s; MoorDyn 2.7 takes equal steps, and begins anew."
        )


CURRENTS = {1: _profile, 2: _profile_in_time, 5: _grid}
