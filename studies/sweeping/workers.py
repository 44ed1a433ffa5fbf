"""Where rows run: in an executor that is given, or in a pool of processes that survives the death of its workers."""

import math
import multiprocessing
import os
import pickle
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, ProcessPoolExecutor, wait
from importlib.util import find_spec
from multiprocessing.process import BaseProcess
from numbers import Integral
from pathlib import Path
from typing import NamedTuple

from anet_lumped.checks import InputError, shown
from integrators.compiling import NOTICE, NOTICED_AFTER, call_when_compiling
from studies.sweeping.processes import held_back, prepare_process, script_untouched, without_script

CRASHED = {
    "status": "crashed",
    "reason": "the worker process died: killed by the system, out of memory, or a fault in compiled code",
}
BROKEN = {"status": "crashed", "reason": "the executor broke before this row came back"}
MOST_WORKERS = 32  # on any machine; on one of many cores, four for each
PRELOADED = "studies.sweeping.preloaded"  # imported once, by the process that workers are forked from
BATCH_SECONDS, LARGEST_BATCH = 0.1, 64  # of work that a worker is given at a time, so that short rows need not travel one by one


class WorkerError(RuntimeError):
    """Worker processes that do not come up."""


class Pool(NamedTuple):
    """Processes that run rows; `compiles` is set by the first of them that has compiled for NOTICED_AFTER."""

    executor: Executor
    workers: int
    compiles: object


def through_executor(executor: Executor, function: Callable[[dict], dict], rows: Iterable[dict]) -> Iterator:
    """Yield (row, result) as they finish; once the executor breaks, the rows that it still held are crashed ones."""
    queue = deque(rows)
    for row, result in _results(executor, function, queue, window=len(queue)):
        yield row, BROKEN if result is None else result
    for row in queue:
        yield row, BROKEN


def through_own_pool(function: Callable[[dict], dict], rows: Iterable[dict], workers: int | None = None) -> Iterator:
    """Yield (row, result) as they finish, from a pool that is rebuilt when a worker process dies.

    The rows in flight when that happens run again, one by one: only a row that kills its worker alone is a crashed one.
    On an exception from outside (Ctrl-C) the workers are terminated at once; if this process is killed, they end with
    the row that they run.
    """
    queue = deque(rows)
    workers = min(workers or available_cores(), max(len(queue), 1))
    pool = None
    started: list[BaseProcess] = []  # by this sweep, and not by one in another thread
    try:
        while queue:
            pool, lost = _start_pool(workers, function, started), deque()
            for row, result in _results_of_pool(pool, function, queue):
                if result is None:
                    lost.append(row)
                else:
                    yield row, result
            while lost:
                _terminate(started)  # one that started as the pool broke would be waited for for ever
                pool.executor.shutdown()
                pool = _start_pool(1, function, started)
                for row, result in _results(pool.executor, function, lost, window=1):
                    yield row, CRASHED if result is None else result
        if pool:
            pool.executor.shutdown()
    finally:
        _terminate(started)
        if pool:  # waits for its thread, which else may find its pipe closed as the interpreter ends
            pool.executor.shutdown(cancel_futures=True)


def _terminate(processes):
    for process in processes:
        if process.is_alive():
            process.terminate()


def start_early() -> None:
    """Let the process that workers are forked from import what rows need while this process does the same.

    Not before the kernels are compiled and on the disk: both would compile them.
    """
    if _start_method() == "forkserver" and kernels_are_on_disk():
        _Context([])


def kernels_are_on_disk() -> bool:
    """Whether Numba has kept anything of `anet_lumped` on the disk, as far as a look at its folders tells."""
    folders = [Path(folder) for folder in find_spec("anet_lumped").submodule_search_locations]
    if os.environ.get("NUMBA_CACHE_DIR"):
        folders = [Path(os.environ["NUMBA_CACHE_DIR"])]
    return any(next(folder.rglob("*.nbi"), None) for folder in folders)


def check_workers(workers: int | None) -> None:
    """Refuse a number of workers that is none, or more than this machine could ever keep busy.

    Raises
    ------
    InputError
    """
    most = max(MOST_WORKERS, 4 * available_cores())
    whole = isinstance(workers, Integral) and not isinstance(workers, bool)
    if workers is not None and not (whole and 1 <= workers <= most):
        raise InputError(f"Argument `workers` must be an integer from 1 to {most}, but it is {shown(workers)}.")


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _results_of_pool(pool, function, queue):
    """`_results` of a pool whose first row goes ahead while it compiles, so that no two workers compile the same."""
    began, pace = time.perf_counter(), _Pace(pool.workers)

    def window():
        if pool.compiles.value:
            NOTICE.give()
        alone = not pace.rows and (pool.compiles.value or time.perf_counter() - began < 2.0 * NOTICED_AFTER)
        return 1 if alone else pool.workers + 1

    return _results(pool.executor, function, queue, window, pace)


class _Pace:
    """How many rows a worker is given at a time, by the time that the last ones took."""

    def __init__(self, workers):
        self.workers, self.rows, self.seconds = workers, 0, math.inf

    def heard(self, rows, seconds):
        self.rows += rows
        self.seconds = seconds / rows

    def batch(self, remaining):
        fair = math.ceil(remaining / (2 * self.workers))
        return max(1, min(LARGEST_BATCH, fair, int(BATCH_SECONDS / max(self.seconds, 1e-6))))


def _results(executor, function, queue, window, pace=None):
    """Yield (row, result) of the rows in the queue; of a broken executor (row, None) for those in flight, then stop.

    Parameters
    ----------
    window : batches in flight at most, or a function that says so and is asked now and then
    pace : _Pace; rows go one by one without
    """
    pending = {}
    broken = False
    try:
        while pending or (queue and not broken):
            most = window() if callable(window) else window
            while queue and len(pending) < most and not broken:
                batch = [queue.popleft() for _ in range(pace.batch(len(queue)) if pace else 1)]
                try:
                    pending[executor.submit(_guarded, function, batch)] = batch
                except BrokenExecutor:
                    queue.extendleft(reversed(batch))
                    broken = True
            timeout = 0.5 * NOTICED_AFTER if callable(window) else None
            for future in wait(pending, timeout, return_when=FIRST_COMPLETED).done:
                batch = pending.pop(future)
                try:
                    results, seconds = future.result()
                except BrokenExecutor:
                    broken = True
                    results = [None] * len(batch)
                except Exception as error:  # a row or its result could not be sent
                    if len(batch) > 1:  # which of them is seen when they go one by one
                        queue.extendleft(reversed(batch))
                        pace = None
                        continue
                    results = [_failed(error)]
                else:
                    if pace:
                        pace.heard(len(batch), seconds)
                yield from zip(batch, results, strict=True)
    finally:
        for future in pending:
            future.cancel()


def _guarded(function, rows):
    """Results of rows, and their time [s]; an exception becomes a status and a reason here, so that it need not travel."""
    began = time.perf_counter()
    return [_guarded_row(function, row) for row in rows], time.perf_counter() - began


def _guarded_row(function, row):
    try:
        return dict(function(row))
    except Exception as error:
        return _failed(error)


def _failed(error):
    return {"status": "failed", "reason": f"{type(error).__name__}: {error}"}


def _start_method():
    """Each worker imports afresh, or is forked from a process that has: no fork of this one, whose threads may hold locks."""
    return "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"


_Process = multiprocessing.get_context(_start_method()).Process


class _ProcessWithScript(_Process):
    """A worker that imports the script which the program began with."""

    @staticmethod
    def _Popen(process):
        with script_untouched():
            return _Process._Popen(process)


class _ProcessWithoutScript(_Process):
    """A worker that does not import the script which the program began with, so that the script needs no guard."""

    @staticmethod
    def _Popen(process):
        with without_script():
            return _Process._Popen(process)


class _Context(type(multiprocessing.get_context(_start_method()))):
    """How workers begin; each of them is appended to `started`."""

    def __init__(self, started, needs_script=False):
        super().__init__()
        self.started, self.kind = started, _ProcessWithScript if needs_script else _ProcessWithoutScript
        if _start_method() == "forkserver":
            from multiprocessing import forkserver, resource_tracker  # which Windows does not import

            self.set_forkserver_preload([PRELOADED])
            with held_back("SIGHUP"):
                resource_tracker.ensure_running()  # which takes care of SIGINT itself, and gives it back to this process
            with held_back("SIGINT", "SIGHUP"):  # which a terminal sends to all; this process ends the others in order
                forkserver.ensure_running()

    def Process(self, *arguments, **options):
        process = self.kind(*arguments, **options)
        self.started.append(process)
        return process


def _start_pool(workers, function, started):
    """Pool of processes that can load `function`; they import the script of the program only if part of the function is of it."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        sys.exit(1)  # a worker that imports a script without a guard: the process that began it says so
    try:
        needs_script = b"__main__" in pickle.dumps(function)
    except Exception as error:  # pickle raises PicklingError, AttributeError or TypeError
        raise TypeError(f"A row's function must be picklable to reach worker processes, but {error}.") from None
    context = _Context(started, needs_script)
    compiles = context.RawValue("b", 0)  # without a lock, which a worker that is killed could hold
    executor = ProcessPoolExecutor(workers, mp_context=context, initializer=_prepare_worker, initargs=(compiles,))
    try:
        with held_back("SIGINT", "SIGTERM", "SIGHUP"):  # a process that is lost as it starts would not be ended
            loaded = executor.submit(callable, function)
        loaded.result()
    except (BrokenExecutor, AttributeError, ImportError):
        raise WorkerError(
            "A script whose own functions or effects worker processes need must call sweep and run_rows below "
            '`if __name__ == "__main__":`, or define them in a module that it imports; the workers could not load '
            f"{getattr(function, '__qualname__', type(function).__name__)}."
        ) from None
    return Pool(executor, workers, compiles)


def _prepare_worker(compiles):
    prepare_process()
    call_when_compiling(lambda: setattr(compiles, "value", 1))
