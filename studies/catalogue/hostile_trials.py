"""Input that cannot be, at random: each case ends in a result, or in one line that says what must hold.

Run as `python -m studies.fuzz hostile`; see the study `hostile_input`. A case is drawn with a `Pick`, so that tests draw the same
from another source of chance.
"""

import contextlib
import importlib
import io
import logging
import math
import signal
import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from anet_lumped import (
    Cable,
    EquilibriumError,
    Fixed,
    Free,
    InputError,
    PayloadChange,
    Scene,
    equilibrium,
    load_run,
    load_scene,
    paths,
    read_moordyn,
    rope,
    signals,
    simulate,
    waves,
    wind,
)
from anet_lumped.effects import Air, AxialDamping, Gravity, Ground, Load, Temperature, ViscousDamping, Water

from .hostile_files import SCENE, VALUES, changed_bytes, changed_moordyn_file, changed_scene_file, mooring
from .hostile_outcomes import (
    ACCEPTED,
    HANG,
    LONG_LINE,
    LONGEST_LINE,
    LONGEST_TIME,
    NOT_A_NUMBER,
    OTHER_NUMBERS,
    REFUSED,
    SAID,
    TRACEBACK,
)
from .random_trials import Random

SIZES = tuple(10.0**power for power in (-320, -300, -150, -99, -60, -30, -12, 12, 30, 60, 99, 150, 300))


class Outcome(NamedTuple):
    """How a case ended, with what was said or raised."""

    outcome: str
    said: str = ""


class _TooLongError(BaseException):
    """A case has run for `LONGEST_TIME`."""


def attempt(kind: str, pick: Any, folder: Path) -> Outcome:
    """Draw a case of a kind of `KINDS`, and see how it ends.

    Parameters
    ----------
    kind : str
    pick : Pick
    folder : Path
        That files are written to.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        case = KINDS[kind](pick, folder)
        began = time.perf_counter()
        try:
            with _at_most(LONGEST_TIME):
                found = case()
        except _TooLongError:
            return Outcome(HANG)
        except InputError as error:
            found = Outcome(REFUSED, str(error))
        except (EquilibriumError, MemoryError) as error:
            found = Outcome(SAID if isinstance(error, EquilibriumError) else TRACEBACK, str(error))
        except Exception as error:
            return Outcome(TRACEBACK, f"{type(error).__name__}: {error}")
    if time.perf_counter() - began > LONGEST_TIME:
        return Outcome(HANG)
    if not all(len(line) <= LONGEST_LINE and line.isprintable() for line in found.said.split("\n")):
        return Outcome(LONG_LINE, found.said)
    return found


def _compile(folder):
    """Run what cases are made of once, so that none of them waits for a compiler."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        (folder / "whole.toml").write_text(SCENE, encoding="utf-8")
        for scene in (load_scene(folder / "whole.toml"), mooring(), _hanging()):
            _used(scene)


@contextlib.contextmanager
def _at_most(seconds):
    """Raise `_TooLongError` after a time, where the system can."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(number, frame):
        raise _TooLongError

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _used(scene: Scene) -> Outcome:
    """What rest and some steps of a scene come to."""
    try:
        rest = equilibrium(scene)
    except EquilibriumError as error:
        return Outcome(SAID, str(error))
    if not (np.isfinite(rest.q).all() and np.isfinite(rest.segment_tension).all()):
        return Outcome(NOT_A_NUMBER)
    run = simulate(scene, 0.02, method="edmc", dt=0.01, start=rest)
    if run.ok and not (np.isfinite(run.q).all() and np.isfinite(run.segment_tension).all() and np.isfinite(run.energy).all()):
        return Outcome(NOT_A_NUMBER)
    return Outcome(ACCEPTED if run.ok else SAID, run.message)


def _scene_file(pick, folder):
    file = folder / "scene.toml"
    file.write_text(changed_scene_file(pick), encoding="utf-8")
    return lambda: _used(load_scene(file))


def _moordyn_file(pick, folder):
    file = folder / "mooring.txt"
    file.write_text(changed_moordyn_file(pick), encoding="utf-8", errors="surrogatepass")
    return lambda: _used(read_moordyn(file).scene)


@cache
def _saved(folder):
    """A run, and the content of the file in which it is saved."""
    run = simulate(_hanging(), 0.1, method="edmc", dt=0.01)
    run.save(folder / "whole.nc")
    return run, (folder / "whole.nc").read_bytes()


def _saved_run(pick, folder):
    run, content = _saved(folder)
    file = folder / "run.nc"
    file.write_bytes(changed_bytes(pick, content))

    def case():
        found = load_run(file)
        same = all(
            np.array_equal(getattr(found, name), getattr(run, name)) for name in ("t", "q", "v", "energy", "segment_tension")
        )
        return Outcome(ACCEPTED if same and found.scene == run.scene and found.work == run.work else OTHER_NUMBERS)

    return case


def _hanging(length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, g=9.81, mass=0.1, at=0.0, segments=4):
    cable = {"length": length, "mass_per_length": mass_per_length, "EA": EA, "zeta": zeta, "segments": segments, "diameter": 0.01}
    points = [Fixed("a", (at, 0.0, 0.0)), Fixed("b", (at + 0.6, 0.0, 0.0)), Free("p", mass, at=(at + 0.3, 0.0, -0.5))]
    return Scene(points, [Cable("a", "p", **cable), Cable("p", "b", **cable)], [Gravity(g)])


def _extreme_sizes(pick, folder):
    names = ("length", "mass_per_length", "EA", "zeta", "g", "mass", "at")
    sizes = {pick.one_of(names): pick.one_of(SIZES) for _ in range(pick.integer(1, 3))}
    return lambda: _used(_hanging(**sizes))


STRANGE = (
    *VALUES, None, Fraction(1, 3), Fraction(10**400), np.float32(1.5), np.longdouble("1e4000"), np.array(1.5),
    np.array([1.0, 2.0, 3.0]), np.zeros((0, 3)), np.array("x"), 1j, b"x", set("abc"), object, iter([1, 2]), range(3), slice(1),
    float, lambda: 1,
)  # fmt: skip
"""What an argument in Python is given."""


class _Call(NamedTuple):
    """A public function, and arguments that it takes."""

    function: Callable[..., Any]
    arguments: dict[str, Any]


@cache
def _calls():
    hanging = _hanging()
    cable = {
        "start": "a",
        "end": "b",
        "length": 1.0,
        "mass_per_length": 0.1,
        "EA": 1e4,
        "segments": 4,
        "zeta": 0.0,
        "diameter": 0.1,
    }
    return (
        _Call(Fixed, {"name": "a", "at": (0, 0, 0)}),
        _Call(Free, {"name": "a", "mass": 1.0, "at": (0, 0, 0), "CdA": 0.1, "volume": 0.1, "Ca": 0.1}),
        _Call(_cable, cable | {"compression": "damped", "EI": 0.1, "breaking_tension": 9.0, "EA_compression": 0.0}),
        _Call(PayloadChange, {"point": "b", "t": 1.0, "mass": 0.1, "velocity": (0, 0, 0)}),
        _Call(Scene, {"points": hanging.points, "cables": hanging.cables, "effects": hanging.effects, "events": ()}),
        _Call(paths.line, {"start": (0, 0, 0), "velocity": (1, 0, 0), "ramp": 1.0}),
        _Call(paths.samples, {"t": [0, 1], "xyz": [[0, 0, 0], [1, 0, 0]]}),
        _Call(paths.harmonic, {"center": (0, 0, 0), "amplitude": (1, 0, 0), "frequency": 1.0, "phase": 0.0, "ramp": 0.0}),
        _Call(signals.line, {"start": 0.0, "rate": 1.0, "ramp": 0.0}),
        _Call(signals.samples, {"t": [0, 1], "values": [1.0, 2.0]}),
        _Call(wind.PowerLaw, {"speed": 1.0, "height": 1.0, "exponent": 0.1, "direction": (1, 0, 0)}),
        _Call(wind.Sampled, {"samples": [(0, 1, 2)]}),
        _Call(wind.Dryden, {"sigma": 1.0, "length": 1.0, "carried": (1, 0, 0), "seed": 1, "modes": 3}),
        _Call(waves.Airy, {"height": 0.1, "period": 3.0, "direction": (1, 0, 0), "depth": 10.0, "phase": 0.0, "ramp": 0.0}),
        _Call(Gravity, {"g": 9.81, "direction": (0, 0, -1)}),
        _Call(Air, {"density": 1.0, "wind": None, "surface": None}),
        _Call(Water, {"density": 1.0, "level": 0.0, "current": None, "wave": None, "g": None}),
        _Call(Ground, {"height": 0.0, "stiffness": 1.0, "damping": 1.0, "friction": 0.1, "normal": (0, 0, 1), "slip_speed": 0.1}),
        _Call(ViscousDamping, {"rate": 0.1}),
        _Call(AxialDamping, {"rate": 0.1}),
        _Call(Load, {"per_length": (1, 0, 0), "cables": None, "ramp": 0.0}),
        _Call(Temperature, {"expansion": 1e-5, "change": 1.0}),
        _Call(rope, {"name": "nylon", "diameter": 0.012, "tension": None}),
        _Call(load_scene, {"path": "net_held"}),
        _Call(equilibrium, {"scene": hanging, "tolerance": 1e-12, "start": None}),
        _Call(
            simulate,
            {"scene": hanging, "t_end": 1e-3, "method": "edmc", "dt": 1e-3, "start": "straight", "save_every": None, "rtol": None,
             "atol": None, "rho_inf": None, "error": None, "tension_error": None, "audit": False},
        ),
    )  # fmt: skip


def _cable(start, end, **more):
    return Cable(start, end, **more)


def _arguments(pick, folder):
    function, arguments = pick.one_of(_calls())
    name, value = pick.one_of(tuple(arguments)), pick.one_of(STRANGE)

    def case():
        function(**arguments | {name: value})
        return Outcome(ACCEPTED)

    return case


def _state(pick, folder):
    rest, name = equilibrium(_hanging()), pick.one_of(("q", "v", "segment_tension", "t", "model", "start"))
    value = pick.one_of((*STRANGE, np.zeros((50, 3)), np.full_like(rest.q, math.nan), np.full_like(rest.q, 1e300), 1e18, -1e18))
    start = value if name == "start" else replace(rest, **{name: value})

    def case():
        run = simulate(rest.scene, 0.01, start=start, method="edmc", dt=1e-3)
        return Outcome(ACCEPTED if run.ok else SAID, run.message)

    return case


COMMAND_WORDS = (
    "net_held", "loose_cable", "none.toml", "", " ", "\x1b[31m", "two\nlines", "a\0b", "é" * 3000, "[" * 2000, "--t-end", "--dt",
    "--json", "--set", "--at", "--method", "--start", "--save-every", "--error", "1", "10ms", "nan", "inf", "1e400", "9" * 400,
    "EA=1e400", "EA=1",
    "segments=3", "p0.mass=x", "=", "edmc", "verlet", "straight", "p0", "1mm", "1 parsec", "-1", "--help", "/dev/zero", ".",
)  # fmt: skip


def _command(pick, folder):
    program = importlib.import_module("studies.command_line")  # by its name: the program runs studies, and this one runs it
    commands = ("equilibrium", "check", "simulate", "mismatch", "ropes", "measures", "convert", "nothing", "")
    words = [pick.one_of(commands), *(pick.one_of(COMMAND_WORDS) for _ in range(pick.integer(0, 5)))]

    def case():
        out, err = io.StringIO(), io.StringIO()
        with contextlib.chdir(folder), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), _telling_as_before():
            try:
                program.main(words)
            except SystemExit as ended:
                status = ended.code
        outcome = {0: ACCEPTED, None: ACCEPTED, 1: SAID, 2: REFUSED}.get(status, TRACEBACK)
        return Outcome(outcome, err.getvalue().rstrip("\n"))

    return case


@contextlib.contextmanager
def _telling_as_before():
    """A command has what the library logs told on stderr; afterwards this process tells it as it did."""
    logs = [logging.getLogger(name) for name in ("anet_lumped", "integrators", "studies")]
    before = [(log.handlers, log.level) for log in logs]
    try:
        with warnings.catch_warnings():
            yield
    finally:
        for log, (handlers, level) in zip(logs, before, strict=True):
            log.handlers = handlers
            log.setLevel(level)


KINDS: dict[str, Callable[[Any, Path], Callable[[], Outcome]]] = {
    "scene file": _scene_file,
    "MoorDyn file": _moordyn_file,
    "saved run": _saved_run,
    "argument": _arguments,
    "state": _state,
    "extreme sizes": _extreme_sizes,
    "command": _command,
}
"""Kinds of cases: each draws one and returns what carries it out."""


def each(seed: int, first: int, count: int, kinds: Iterable[str] = tuple(KINDS)) -> Iterator[dict]:
    """Cases of each kind by number as they end, as dicts: kind, number, outcome, said."""
    with tempfile.TemporaryDirectory() as folder:
        _compile(Path(folder))
        for kind in kinds:
            for number in range(first, first + count):
                outcome, said = attempt(kind, Random((seed, number)), Path(folder))
                yield {"kind": kind, "number": number, "outcome": outcome, "said": said[:1000]}


def try_many(kind: str, seed: int, first: int, count: int) -> list[dict]:
    """What `each` says of the cases of one kind, once all have ended."""
    return list(each(seed, first, count, (kind,)))
