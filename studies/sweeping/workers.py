"""Where rows run: in an executor that is given, or in a pool of processes that survives the death of its workers."""

import multiprocessing
import os
import signal
import threading
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, ProcessPoolExecutor, wait

CRASHED = {
    "status": "crashed",
    "reason": "the worker process died: killed by the system, out of memory, or a fault in compiled code",
}
BROKEN = {"status": "crashed", "reason": "the executor broke before this row came back"}


def through_executor(executor: Executor, function: Callable[[dict], dict], rows: Iterable[dict]) -> Iterator:
    """Yield (row, result) as they finish; once the executor breaks, the rows that it still held are crashed ones."""
    queue = deque(rows)
    for row, result in _results(executor, function, queue, window=len(queue)):
        yield row, result or BROKEN
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
    others = multiprocessing.active_children()
    try:
        while queue:
            pool, lost = _start_pool(workers, function), []
            for row, result in _results(pool, function, queue, window=workers + 1):
                if result:
                    yield row, result
                else:
                    lost.append(row)
            for row in lost:
                pool = _start_pool(1, function)
                for _, result in _results(pool, function, deque([row]), window=1):
                    yield row, result or CRASHED
                pool.shutdown()
        if pool:
            pool.shutdown()
    finally:
        for process in set(multiprocessing.active_children()) - set(others):
            process.terminate()
        if pool:  # waits for its thread, which else may find its pipe closed as the interpreter ends
            pool.shutdown(cancel_futures=True)


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _results(executor, function, queue, window):
    """Yield (row, result), at most `window` rows in flight; of a broken executor (row, None) for those, then stop."""
    pending = {}
    broken = False
    try:
        while pending or (queue and not broken):
            while queue and len(pending) < window and not broken:
                try:
                    pending[executor.submit(_guarded, function, queue[0])] = queue[0]
                    queue.popleft()
                except BrokenExecutor:
                    broken = True
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                row = pending.pop(future)
                try:
                    yield row, future.result()
                except BrokenExecutor:
                    broken = True
                    yield row, None
                except Exception as error:  # the row or its result could not be sent
                    yield row, _failed(error)
    finally:
        for future in pending:
            future.cancel()


def _guarded(function, row):
    """Result of one row; an exception becomes a status and a reason where it is raised, so that it need not travel."""
    try:
        return dict(function(row))
    except Exception as error:
        return _failed(error)


def _failed(error):
    return {"status": "failed", "reason": f"{type(error).__name__}: {error}"}


def _start_pool(workers, function):
    """Pool of processes that can load `function`; each imports afresh (no fork: compiled code and threads mind)."""
    method = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
    context = multiprocessing.get_context(method)
    if method == "forkserver":
        context.set_forkserver_preload(["anet_lumped"])
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_prepare_worker)
    try:
        pool.submit(callable, function).result()
    except BrokenExecutor:
        raise RuntimeError(
            f"Worker processes must be able to import {function!r}, but they died doing so: define it in a module, and "
            'call run_rows and sweep below `if __name__ == "__main__":` in a script.'
        ) from None
    except Exception as error:  # pickle raises PicklingError, AttributeError or TypeError
        raise TypeError(f"A row's function must be picklable to reach worker processes, but {error}.") from None
    return pool


def _prepare_worker():
    """Leave Ctrl-C to the parent, die with the parent, keep warnings off the progress bar (rows carry a status)."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.simplefilter("ignore")
    threading.Thread(target=_die_with_parent, daemon=True).start()


def _die_with_parent():
    multiprocessing.parent_process().join()
    os._exit(1)
