"""Many runs on one machine: scenes, or one scene with other numbers, moved side by side, and what came of them by names."""

import os
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from itertools import islice
from numbers import Integral
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import InputError, number, shown
from anet_lumped.limits import ROWS, check_most
from anet_lumped.results.run import Run
from anet_lumped.results.run_table import KEPT, NOT_RUN, RunTable
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene, check_scene
from anet_lumped.scene.varied import SETTINGS, Varied
from anet_lumped.statics.starts import Start, check_start_kind
from integrators.ctrl_c import ctrl_c_later

from .plan import Asked, check_arguments
from .quick_switches import quick_switches
from .repeated import Ready, Repeated
from .simulate import quiet_in_this_thread, simulate
from .times import Leg, save_times

TOGETHER, BYTES_TOGETHER = 32, 1.6e7  # runs that a thread takes at a time, and the most bytes of their rows


class RunsInterrupt(KeyboardInterrupt):
    """Ctrl-C during many runs; ``found`` is the Dataset of those that were done, the status of the others is "not run"."""

    def __init__(self, message: str, found: Any) -> None:
        super().__init__(message)
        self.found = found


class Given(NamedTuple):
    """Scenes to be run: of each its number, and the scene, which may be made only when its turn comes.

    Parameters
    ----------
    count : int
    scene_of : callable, number of a run -> Scene
    first : Scene
    varied : dict, name -> values, of the fields that vary
    """

    count: int
    scene_of: Callable[[int], Scene]
    first: Scene
    varied: dict[str, np.ndarray]


def simulate_many(
    scenes: Scene | Iterable[Scene], t_end: float, *, vary: Mapping[str, Sequence[Any]] | None = None, method: str | None = None,
    dt: float | None = None, start: Start = "equilibrium", save_every: float | None = None, rtol: float | None = None,
    atol: float | None = None, rho_inf: float | None = None, error: float | None = None, tension_error: float | None = None,
    keep: Sequence[str] = KEPT, workers: int | None = None,
) -> Any:  # fmt: skip
    """Motions of many scenes of one topology, side by side; each is to the last bit the run that `simulate` makes of its scene.

    Runs share arrays, tables and compiled code where their scenes have the same points, cables and segments, and `method` or `dt`
    is given: then a run costs little more than its steps. Threads take one run after another.

    Parameters
    ----------
    scenes : Scene or iterable of Scene
        Scenes with the same points and cables, or one scene, of which `vary` says what is other in each run.
    t_end : float [s]
    vary : mapping of names to sequences, all of one length
        Values of fields of the scene in each run, by the names that a sweep has for them: `EA` of all cables, `s0-p0.EA`,
        `p0.mass`, `gravity.g`, `s0.path.velocity.x`, `air.wind.speed`.
    method, dt, start, save_every, rtol, atol, rho_inf, error, tension_error : as in `simulate`, for every run
        Runs that choose their fixed steps save at the same times only with `save_every`, which they then need.
    keep : sequence of str
        What is kept of each run, of "position", "velocity" (of points), "tension" (of segments), "shape" (of cables) and "energy";
        and what it tells of its errors, "error_estimate" [m] and "tension_error" [1], to compute which takes time of its own.
    workers : int or None
        Threads; one for each core by default. While several run, `sys.setswitchinterval` is 0.1 ms at most.

    Returns
    -------
    xarray.Dataset
        Over `run`: `status` and `reason` (of a run that is not done), `warnings`, `method`, `step` [s], `end_time` [s], `steps`,
        `newton_iterations`, and what is kept, as in `Run.to_xarray`, NaN where a run did not get. What varies is a coordinate.
        A run that fails, fails alone: "failed" is the status of one that ended in an exception, with its words.

    Raises
    ------
    InputError : an argument that no run can have; scenes of other points or cables; a name that nothing has; more than memory holds
    RunsInterrupt : Ctrl-C; with the runs that were done in its ``found``, which has also what else a signal's handler raises
    """
    check_arguments(t_end, method, dt, save_every, rtol, atol, rho_inf, False, error, tension_error)
    check_start_kind(start)
    given = _given(scenes, vary)
    workers = _threads(workers, given.count)
    t_end, dt, save_every, rtol, atol, rho_inf, error, tension_error = (
        None if value is None else number(value) for value in (t_end, dt, save_every, rtol, atol, rho_inf, error, tension_error)
    )
    save_every = None if save_every is None else min(save_every, t_end)
    begin = start.t if isinstance(start, State) else 0.0
    table = RunTable(given.first, given.count, _saved_times(begin, t_end, save_every, dt, rtol, atol), keep)
    settings = {"method": method, "dt": dt, "start": start, "save_every": save_every, "rtol": rtol, "atol": atol}
    settings |= {"rho_inf": rho_inf, "error": error, "tension_error": tension_error}
    try:
        each_run(given, t_end, settings, table.take, table.fail, workers)
    except BaseException as stopped:
        done, found = given.count - int(np.count_nonzero(table.status == NOT_RUN)), table.dataset(given.varied)
        message = f"Stopped after {done} of {given.count} runs."
        if isinstance(stopped, KeyboardInterrupt):
            raise RunsInterrupt(message, found) from stopped
        stopped.found = found  # type: ignore[attr-defined]
        stopped.add_note(f"{message} The `found` of this exception has those that were done.")
        raise
    return table.dataset(given.varied)


def each_run(
    given: Given, t_end: float, settings: dict[str, Any], take: Callable[[int, Run], None], fail: Callable[[int, Exception], None],
    workers: int,
) -> None:  # fmt: skip
    """Run every scene and hand each run on as it ends.

    Parameters
    ----------
    given : Given
    t_end : float [s]
    settings : of `simulate`
    take : number of a run, and the run; its arrays are overwritten afterwards. It is called in several threads
    fail : number of a run, and the exception in which it ended
    workers : int, threads

    Raises
    ------
    KeyboardInterrupt : Ctrl-C, once every thread has ended its run; so what else the handler of a signal raises
    """
    others = {name: value for name, value in settings.items() if name in ("error", "tension_error") and value is not None}
    asked = Asked(t_end, *(settings[name] for name in ("method", "dt", "save_every", "rtol", "atol")))
    numbers, taking, stopped = iter(range(given.count)), threading.Lock(), threading.Event()
    raised: list[BaseException] = []

    def attempt(k: int, part: Callable[..., Any], *arguments: Any) -> Any:
        """What a part of the k-th run gives; None if it raised, after which this run alone has failed."""
        try:
            return part(*arguments)
        except Exception as error:
            fail(k, error)
            return None

    def work() -> None:
        quiet_in_this_thread()
        repeated, fair = Repeated(asked, settings["start"], settings["rho_inf"]), max(1, given.count // (4 * workers))
        while not stopped.is_set():
            most = 1 if others else repeated.rooms(min(TOGETHER, fair), BYTES_TOGETHER)
            with taking:
                scenes = [(k, attempt(k, given.scene_of, k)) for k in islice(numbers, most)]
            if not scenes:
                return
            # each part for all of them: code and tables of a part that runs again and again are at hand, and not after a march
            scenes = [(k, scene) for k, scene in scenes if scene is not None]
            ready = [(k, scene, None if others else attempt(k, prepared, repeated, scene)) for k, scene in scenes]
            ready = [one for one in ready if others or one[2] is not None]
            for room, (k, _, one) in enumerate(ready):
                if isinstance(one, Ready) and not stopped.is_set():
                    attempt(k, repeated.march, one, room)
            for k, scene, one in ready:
                if isinstance(one, Ready) and one.out is not None:
                    run = attempt(k, repeated.judge, one)
                elif stopped.is_set():
                    continue
                else:
                    run = attempt(k, partial(simulate, scene, t_end, **settings))
                if run is not None:
                    attempt(k, take, k, run)

    def run() -> None:
        try:
            work()
        except BaseException as error:  # of no run alone
            raised.append(error)
            stopped.set()

    threads = [threading.Thread(target=run, daemon=True) for _ in range(workers)]
    with quick_switches() if workers > 1 else nullcontext(), ctrl_c_later(stopped.set):  # then each ends the run at which it is
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    if raised:
        raise raised[0]


def _saved_times(
    begin: float, t_end: float, save_every: float | None, dt: float | None, rtol: float | None, atol: float | None
) -> np.ndarray:
    """Times at which all runs save [s]."""
    end, fixed = begin + t_end, rtol is None and atol is None
    if fixed and dt is not None and save_every is not None:
        Leg(begin, end, begin, end, save_every).stride(dt)  # refuses times that are no multiple of the step
    if not fixed or save_every is not None:
        return save_times(begin, end, save_every)
    if dt is None:
        raise InputError(
            "Runs that choose their steps must be given the times at which all save, but neither `save_every` nor `dt` is given."
        )
    stride, _ = Leg(begin, end, begin, end, None).stride(dt)
    t = begin + np.arange(0, int(t_end / dt) + 1, stride) * dt
    return np.append(t[t < end - 1e-6 * dt], end)


def prepared(repeated: Repeated, scene: Scene) -> Ready | bool:
    """A run that is ready to be marched; False if `simulate` has to."""
    return repeated.prepare(scene) or False


def _given(scenes: Any, vary: Any) -> Given:
    """The scenes that are given, in either way.

    Raises
    ------
    InputError : what is no scene, scenes of other points or cables, values that differ in number
    """
    if isinstance(scenes, Scene):
        if not isinstance(vary, Mapping) or not vary:
            raise InputError(f"One scene needs `vary`, names and values of what is other in each run, but it is {shown(vary)}.")
        for name in vary:
            if name in SETTINGS:
                raise InputError(f"What varies must be a field of the scene, but `{name}` is an argument of all runs.")
        varied = Varied(scenes, vary)
        for name, fields in varied.found.items():
            if any(field.section == "cables" and field.key == "segments" for field in fields):
                raise InputError(f"Runs must have the same segments, which `{name}` changes; a sweep may vary them.")
        values = {name: _values(name, given) for name, given in vary.items()}
        counts = {name: len(of_name) for name, of_name in values.items()}
        if len(set(counts.values())) > 1 or not min(counts.values()):
            raise InputError(f"What varies must have a value for every run, at least one, but the numbers of values are {counts}.")
        rows = list(zip(*values.values(), strict=True))
        check_most(ROWS, len(rows), "This table")
        columns = {name: np.array(of_name) for name, of_name in values.items()}
        return Given(len(rows), lambda k: varied.with_values(dict(zip(values, rows[k], strict=True))), scenes, columns)
    if vary is not None and not isinstance(scenes, str):
        raise InputError("What varies is for one scene, but `vary` is given beside several.")
    if isinstance(scenes, str) or not isinstance(scenes, Iterable):
        check_scene(scenes)
    listed = list(scenes)
    if not listed:
        raise InputError("There must be a scene to run, but none is given.")
    for scene in listed:
        check_scene(scene)
    of_first = _names(listed[0])
    for k, scene in enumerate(listed):
        if _names(scene) != of_first:
            raise InputError(
                f"Scenes must have the same points, and cables with the same ends and segments, but those of scenes[{k}] differ."
            )
    check_most(ROWS, len(listed), "This table")
    return Given(len(listed), listed.__getitem__, listed[0], {})


def _values(name: str, given: Any) -> list[Any]:
    """The values of what varies, one for each run.

    Raises
    ------
    InputError : one value alone, or values of different lengths
    """
    try:
        values = np.asarray(given)
    except ValueError:  # vectors of different lengths
        values = np.array(None)
    if values.ndim == 0:
        raise InputError(f"What varies must have values in a sequence, one for each run, but `{name}` has {shown(given)}.")
    if isinstance(given, list | tuple):  # numbers beside words stay numbers
        return [value.tolist() if hasattr(value, "tolist") else value for value in given]
    return list(values.tolist())


def _names(scene: Scene) -> Any:
    """What tells the nodes of a scene from those of another one."""
    points = [(type(point), point.name) for point in scene.all_points]
    return points, [(cable.name, cable.start, cable.end, cable.segments) for cable in scene.cables]


def _threads(workers: Any, count: int) -> int:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if workers is None:
        return min(cores, count)
    if isinstance(workers, bool) or not isinstance(workers, Integral) or not 1 <= workers <= 4 * max(cores, 8):
        raise InputError(f"Argument `workers` must be an integer from 1 to {4 * max(cores, 8)}, but it is {shown(workers)}.")
    return min(int(workers), count)
