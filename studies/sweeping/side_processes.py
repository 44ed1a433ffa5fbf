"""Calls in processes beside this one, some at once. A process that dies loses the call that it was busy with, and no other."""

import contextlib
import multiprocessing
import signal
import threading
from collections.abc import Callable, Hashable
from multiprocessing.connection import wait
from typing import Any

from integrators.compiling import NOTICE
from studies.stop_signals import stop_signals
from studies.sweeping.processes import held_back, prepare_process, without_script

COMPILES, RESULT = "compiles", "result"  # what a process tells
PATIENCE = 3.0  # [s] for a process to end in order
DIED = "the process died: killed by the system, out of memory, or a fault in compiled code"


class ProcessDiedError(RuntimeError):
    """A process that ended before its call did."""


class SideProcesses:
    """Processes that begin when they are first needed and are kept for further calls; on leaving the `with` block all are ended."""

    def __init__(self) -> None:
        self._free: list[tuple] = []  # (connection, process)
        self._busy: dict[Any, tuple] = {}  # by connection: key and process

    def __enter__(self) -> "SideProcesses":
        return self

    def __exit__(self, *raised: object) -> None:
        processes = [process for _, process in [*self._free, *self._busy.values()]]
        for connection in [*self._busy, *(connection for connection, _ in self._free)]:
            connection.close()  # one that waits for a call ends
        for _, process in self._busy.values():
            process.terminate()
        for process in processes:
            process.join(PATIENCE)
            process.kill()
            process.join()

    def start(self, key: Hashable, function: Callable, *arguments: object) -> None:
        """Have `function(*arguments)` called; function, arguments and result are picklable, and not of the program's script."""
        self._free = [(connection, process) for connection, process in self._free if process.is_alive()]
        with held_back("SIGINT", "SIGTERM", "SIGHUP"):  # a process that is lost as it starts would not be ended
            connection, process = self._free.pop() if self._free else _begin()
            self._busy[connection] = key, process
        with contextlib.suppress(BrokenPipeError):  # `next_result` says so
            connection.send((function, arguments))

    def next_result(self) -> tuple[Hashable, Any]:
        """Wait for the next call that ends: its key, and what it returned, or a `ProcessDiedError` for what it lost.

        What a call raises ends its process too; so a function that may raise returns the exception instead.
        """
        while True:
            for connection in wait(list(self._busy)):
                try:
                    what, result = connection.recv()
                except (EOFError, OSError):
                    key, process = self._busy.pop(connection)
                    connection.close()
                    process.join(PATIENCE)
                    return key, ProcessDiedError(DIED)
                if what == COMPILES:
                    NOTICE.give()
                    continue
                key, process = self._busy.pop(connection)
                self._free.append((connection, process))
                return key, result


def _begin():
    """Connection and process; it begins anew and not from a process that has imported what rows need, which compiles that first."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(theirs,))
    with without_script():
        process.start()
    theirs.close()
    return ours, process


def _serve(connection):
    """Call what is sent, until no more is; SIGTERM ends this, and the processes that it has begun, in order."""
    prepare_process()
    lock = threading.Lock()

    def tell(*what):
        with lock:
            connection.send(what)

    NOTICE.prepare("", lambda line: tell(COMPILES, None))
    NOTICE.listen()
    with stop_signals(), contextlib.suppress(EOFError, OSError, KeyboardInterrupt):
        if hasattr(signal, "pthread_sigmask"):
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
        while True:
            function, arguments = connection.recv()
            tell(RESULT, function(*arguments))
