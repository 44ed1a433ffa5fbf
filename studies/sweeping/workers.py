"""Where rows run: in an executor that is given, or in a pool of processes that survives the death of its workers.

Rows are numbered: what waits, and what is given back, is the number of a row. What a worker does with a batch of rows is a `run`
(`batch.BatchRunner`, `parts.PartTask`): rows -> (results, seconds), picklable. Results that are fewer than the rows are those of
the first of them, and the others are given out again.
"""

import logging
import math
import multiprocessing
import os
import pickle
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, ProcessPoolExecutor, wait
from importlib.util import find_spec
from multiprocessing.process import BaseProcess
from numbers import Integral
from pathlib import Path
from typing import Any, NamedTuple

from anet_lumped.checks import InputError, shown
from integrators.compiling import NOTICE, NOTICED_AFTER, call_when_compiling
from studies.sweeping.batch import CRASHED, failed
from studies.sweeping.processes import held_back, prepare_process, script_untouched, without_script

LOG = logging.getLogger(__name__)
DIED = {
    "status": CRASHED,
    "reason": "the worker process died: killed by the system, out of memory, or a fault in compiled code",
}
MOST_WORKERS = 32  # on any machine; on one of many cores, four for each
MOST_ELSEWHERE = 1_000_000  # of an executor
PRELOADED = "studies.sweeping.preloaded"  # imported once, by the process that workers are forked from
LOOKED_EVERY, TOLD_AFTER = 1.0, 60.0  # [s]: for futures that are done unheard, and a word on what is waited for
BATCH_SECONDS, LARGEST_BATCH = 0.1, 64  # of work that a worker is given at a time, so that short rows need not travel one by one


class WorkerError(RuntimeError):
    """Worker processes that do not come up, or cannot do what they are given.

    Parameters
    ----------
    message : str
    found : DataFrame of the rows that were done before, or None
    """

    def __init__(self, message: str, found: Any = None) -> None:
        super().__init__(message)
        self.found = found


class ExecutorBrokeError(WorkerError):
    """An executor whose worker died; `lost` are the numbers of the rows that it had been given and did not give back."""

    def __init__(self, error: BrokenExecutor, lost: list[int]) -> None:
        super().__init__(f"The executor broke while rows were to do: {error}")
        self.lost = lost


class Pool(NamedTuple):
    """Processes that run rows; `compiles` is set by the first of them that has compiled for NOTICED_AFTER."""

    executor: Executor
    workers: int
    compiles: object


def through_executor(
    executor: Executor,
    run: Callable,
    rows: Sequence[dict] | Mapping[int, dict],
    numbers: Iterable[int] | None = None,
    pace: "Pace | None" = None,
    strict: bool = False,
) -> Iterator[tuple[int, dict]]:
    """Yield (number, result) as they finish.

    Parameters
    ----------
    executor : any of `concurrent.futures`
    run : see above
    rows : dicts of inputs, by their numbers
    numbers : of the rows that are to be done; all by default
    pace : how many rows a worker is given at a time; without, all are given out at once, one by one
    strict : whether an error that is not of a row ends all; else the rows that it came with are failed ones

    Raises
    ------
    WorkerError : the executor broke, takes no rows or cancels them, once what it has done is given back; or, if `strict`, at once
        where a worker cannot do what it is given
    """
    queue = deque(range(len(rows)) if numbers is None else numbers)
    window = 2 * pace.workers if pace else len(queue)
    return _results(executor, run, rows, queue, window=window, pace=pace, strict=strict)


class OwnPool:
    """Processes of this machine that run rows; on leaving the `with` block all are ended.

    A pool whose worker dies is rebuilt. The rows in flight when that happens run again, one by one: only a row that kills its
    worker alone is a crashed one. On an exception from outside (Ctrl-C) the workers are terminated at once; if this process is
    killed, they end with the row that they run.

    Parameters
    ----------
    run : see above
    workers : processes; by default one for each core that this process may use
    """

    def __init__(self, run: Callable, workers: int | None = None):
        self.run, self.workers, self.pool = run, workers or available_cores(), None
        self.started: list[BaseProcess] = []  # by this pool, and not by one in another thread

    def __enter__(self) -> "OwnPool":
        return self

    def __exit__(self, *raised: object) -> None:
        if self.pool and raised[0] is None:
            self.pool.executor.shutdown()
        _terminate(self.started)
        if self.pool:  # waits for its thread, which else may find its pipe closed as the interpreter ends
            self.pool.executor.shutdown(cancel_futures=True)

    def results(
        self, rows: Sequence[dict] | Mapping[int, dict], numbers: Iterable[int] | None = None
    ) -> Iterator[tuple[int, dict]]:
        """Yield (number, result) of those rows as they finish."""
        queue = deque(range(len(rows)) if numbers is None else numbers)
        while queue:
            if self.pool is None:
                self.pool = _start_pool(min(self.workers, len(queue)), self.run, self.started)
            try:
                yield from _results_of_pool(self.pool, self.run, rows, queue)
            except ExecutorBrokeError as broke:
                yield from self._one_by_one(rows, deque(broke.lost))
                self._start_anew(None)

    def _one_by_one(self, rows, lost):
        """`results` of rows one of which has killed its worker."""
        while lost:
            self._start_anew(1)
            try:
                yield from _results(self.pool.executor, self.run, rows, lost, window=1)
            except ExecutorBrokeError as broke:
                yield from ((number, DIED) for number in broke.lost)

    def _start_anew(self, workers):
        _terminate(self.started)  # one that started as the pool broke would be waited for for ever
        self.pool.executor.shutdown()
        self.pool = workers and _start_pool(workers, self.run, self.started)


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


def check_workers(workers: int | None, elsewhere: bool = False) -> None:
    """Refuse a number of workers that is none, or more than this machine, or any `elsewhere`, could ever keep busy.

    Raises
    ------
    InputError
    """
    most = MOST_ELSEWHERE if elsewhere else max(MOST_WORKERS, 4 * available_cores())
    whole = isinstance(workers, Integral) and not isinstance(workers, bool)
    if workers is not None and not (whole and 1 <= workers <= most):
        raise InputError(f"Argument `workers` must be an integer from 1 to {most}, but it is {shown(workers)}.")


def available_cores() -> int:
    """Number of cores that this process may use."""
    return len(own_cores() or ()) or os.cpu_count() or 1


def own_cores() -> set[int] | None:
    """Cores that this process may use; None on a system that gives no process cores of its own."""
    return os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else None


def slots(executor: Executor) -> int:
    """Rows that an executor may run at once, as far as it says so; else as many as any machine can keep busy."""
    given = getattr(executor, "_max_workers", None) or getattr(executor, "num_workers", None)
    return given if isinstance(given, int) and given > 0 else MOST_WORKERS


def _results_of_pool(pool, run, rows, queue):
    """`_results` of a pool whose first row goes ahead while it compiles, so that no two workers compile the same."""
    began, pace = time.perf_counter(), Pace(pool.workers)

    def window():
        if pool.compiles.value:
            NOTICE.give()
        alone = not pace.rows and (pool.compiles.value or time.perf_counter() - began < 2.0 * NOTICED_AFTER)
        return 1 if alone else pool.workers + 1

    return _results(pool.executor, run, rows, queue, window, pace)


class Pace:
    """How many rows a worker is given at a time, by the time that the last ones took: one, and once some are done for half the time
    so far, so that the first come back soon.

    Parameters
    ----------
    workers : that share the rows
    seconds : [s], what a batch should take at most
    largest : rows of a batch
    """

    def __init__(self, workers: int, seconds: float = BATCH_SECONDS, largest: int = LARGEST_BATCH):
        self.workers, self.rows, self.batch_seconds, self.largest = workers, 0, seconds, largest
        self.seconds, self.began = math.inf, time.perf_counter()  # of a row, as far as one is done

    def heard(self, rows: int, seconds: float) -> None:
        """Take note of rows that are done, and of their time [s]."""
        self.rows += rows
        self.seconds = seconds / max(rows, 1)

    def batch(self, remaining: int) -> int:
        """Rows of the next batch."""
        fair = math.ceil(remaining / (2 * self.workers))
        seconds = min(self.batch_seconds, 0.5 * (time.perf_counter() - self.began))
        return max(1, min(self.largest, fair, int(seconds / max(self.seconds, 1e-6))))


class Waiting:
    """Says what is waited for where an executor gives nothing back, after TOLD_AFTER and each time after twice as long."""

    def __init__(self):
        self.began, self.tell_after = time.monotonic(), TOLD_AFTER

    def look(self, done: int, pending: Mapping, rows: Sequence[dict] | Mapping[int, dict]) -> None:
        """Take note of how many batches were done, of the `pending` ones."""
        silent = time.monotonic() - self.began
        if done:
            self.__init__()
        elif silent > self.tell_after and pending:
            self.tell_after *= 2.0
            first = next(iter(pending.values()))[0]
            LOG.warning(
                "no row has come back for %.0f s: %d batches are waited for, the first of row %d, %s; Ctrl-C keeps what is done",
                silent, len(pending), first, shown(rows[first]),
            )  # fmt: skip


def _results(executor, run, rows, queue, window, pace=None, strict=False):
    """Yield (number, result) of the rows in the queue; those that an executor which breaks was not given yet stay there.

    Parameters
    ----------
    window : batches in flight at most, or a function that says so and is asked now and then
    pace : Pace; rows go one by one without
    strict : as of `through_executor`
    """
    pending: dict = {}
    lost: list[int] = []
    ended: WorkerError | None = None  # raised once nothing is pending: what is done comes first
    waiting = Waiting()
    try:
        while pending or (queue and not ended):
            most = window() if callable(window) else window
            while queue and len(pending) < most and not ended:
                batch = [queue.popleft() for _ in range(pace.batch(len(queue)) if pace else 1)]
                try:
                    pending[executor.submit(run, [rows[number] for number in batch])] = batch
                except Exception as error:
                    queue.extendleft(reversed(batch))
                    broke = isinstance(error, BrokenExecutor)
                    took_none = f"The executor must take rows, but it raised {type(error).__name__}: {error}"
                    ended = ExecutorBrokeError(error, lost) if broke else WorkerError(took_none)
            wait(pending, 0.5 * NOTICED_AFTER if callable(window) else LOOKED_EVERY, return_when=FIRST_COMPLETED)
            # one that is cancelled may never be told to `wait`, as those of a pool of threads that is shut down
            done = [future for future in pending if future.done()]
            waiting.look(len(done), pending, rows)
            for future in done:
                batch = pending.pop(future)
                try:
                    results, seconds = future.result()
                except BrokenExecutor as error:
                    lost += batch
                    ended = ExecutorBrokeError(error, lost)
                    continue
                except CancelledError:
                    ended = ended or WorkerError("The executor must do its rows, but it cancelled some of them.")
                    continue
                except Exception as error:  # a row or its result could not be sent, or kills its worker again and again
                    if strict and not _death(error):
                        raise WorkerError(f"A worker could not do its rows: {type(error).__name__}: {error}") from None
                    if len(batch) > 1:  # which of them is seen when they go one by one
                        queue.extendleft(reversed(batch))
                        pace = None
                        continue
                    results = [_death(error) or failed(error)]
                else:
                    queue.extendleft(reversed(batch[len(results) :]))
                    if pace:
                        pace.heard(len(results), seconds)
                yield from zip(batch, results, strict=False)
        if ended:
            raise ended
    except KeyboardInterrupt:  # here or in a worker: what has come back is not lost
        for future, batch in pending.items():
            if future.done() and not (future.cancelled() or future.exception()):
                yield from zip(batch, future.result()[0], strict=False)
        raise
    finally:
        for future in pending:
            future.cancel()


def _death(error):
    """The result of a row whose worker died as often as a cluster of Dask allows; None for another error."""
    distributed = sys.modules.get("distributed")
    return DIED if distributed and isinstance(error, distributed.KilledWorker) else None


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


def _start_pool(workers, run, started):
    """Pool of processes that can load `run`; they import the script of the program only if part of it is of it."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        sys.exit(1)  # a worker that imports a script without a guard: the process that began it says so
    try:
        needs_script = b"__main__" in pickle.dumps(run)
    except Exception as error:  # pickle raises PicklingError, AttributeError or TypeError
        raise TypeError(f"A row's function must be picklable to reach worker processes, but {error}.") from None
    context = _Context(started, needs_script)
    compiles = context.RawValue("b", 0)  # without a lock, which a worker that is killed could hold
    executor = ProcessPoolExecutor(workers, mp_context=context, initializer=_prepare_worker, initargs=(compiles, own_cores()))
    try:
        with held_back("SIGINT", "SIGTERM", "SIGHUP"):  # a process that is lost as it starts would not be ended
            loaded = executor.submit(callable, run)
        loaded.result()
    except (BrokenExecutor, AttributeError, ImportError):
        raise WorkerError(
            "A script whose own functions or effects worker processes need must call sweep and run_rows below "
            '`if __name__ == "__main__":`, or define them in a module that it imports; the workers could not load '
            f"{getattr(run.function, '__qualname__', type(run.function).__name__)}."
        ) from None
    return Pool(executor, workers, compiles)


def _prepare_worker(compiles, cores):
    """Run on the cores of the process that asked for this one, which are not always those of the process that it is forked from."""
    if cores:
        os.sched_setaffinity(0, cores)
    prepare_process()
    call_when_compiling(lambda: setattr(compiles, "value", 1))
