"""The report: runs the studies, cheap and telling ones first, and writes the page after each of them.

Two studies run at once, each in a process beside this one: one compiles, draws or waits for its last rows while the other has
rows to run. Of studies that compare times one runs at a time, on a core that no other study has; what they compare takes turns, so
that what slows one of two down slows the other. With `full`, and where a system gives no process a core of its own, they run alone.
Before all of them two processes compile what most need.
"""

import contextlib
import os
import time
import traceback
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path

from studies.shown.page import Entry, State, write_page
from studies.shown.sentences import listed
from studies.study import NAMES, Part, module_of, run_study
from studies.sweeping.compiled_ahead import compile_ahead, compile_effects, compile_effects_of_studies, compile_motions
from studies.sweeping.folder_lock import locked
from studies.sweeping.provenance import provenance
from studies.sweeping.same_process import SameProcess
from studies.sweeping.side_processes import SideProcesses
from studies.sweeping.workers import available_cores, own_cores

PAGE = "report.html"
ALL_CORES = own_cores()  # that this process began with


class ReportInterrupt(KeyboardInterrupt):
    """Ctrl-C during a report; the page holds the studies that were done, which the message says."""


@dataclass(frozen=True)
class Progress:
    """Where a report stands, as its caller is told when a study starts and when one ends.

    Parameters
    ----------
    number, total : of the study among all of them, from 1, in the order in which they start
    name : of the study
    state : RUNNING, DONE or FAILED
    seconds : that the study took, 0 while it runs
    reason : of a failure
    """

    number: int
    total: int
    name: str
    state: State
    seconds: float = 0.0
    reason: str = ""


def write_report(
    out: str | Path,
    *,
    full: bool = False,
    executor: Executor | None = None,
    names: Iterable[str] = NAMES,
    at_once: int = 1,
    tell: Callable[[Progress], None] = lambda progress: None,
) -> list[str]:
    """Run the studies and write `out/report.html` after each of them, with each study's data in a folder beside it.

    Parameters
    ----------
    out : folder
    full : all of every study; otherwise there is a first look of the long ones, and the page says what it leaves out
    executor : where the studies' rows run; only with `at_once` of 1
    names : of the studies, in the order in which they are on the page and, but for those that wait for their turn, run
    at_once : studies that run at the same time, but for those that compare times; with 1 all run in this process
    tell : is told when a study starts and when it ends

    Returns
    -------
    list of str : names of the studies that failed; the page says why

    Raises
    ------
    FolderInUseError : another run writes to `out`
    ReportInterrupt : on Ctrl-C; the page holds what was done, and says that the report was stopped
    """
    out, names = Path(out), list(names)
    with locked(out):
        return _write(out, names, full, executor, at_once, tell)


def most_at_once() -> int:
    """Studies that this machine runs at once: two, unless there is one core only."""
    return min(2, available_cores())


def _write(out, names, full, executor, at_once, tell):
    """`write_report` in a folder that nobody else writes to."""
    beside = at_once > 1 and not full and ALL_CORES is not None
    entries = {name: _entry(name, full, beside) for name in names}
    command = "anet-lumped report" + " --full" * full
    began, done = {}, []

    def write(stopped=""):
        write_page(out / PAGE, entries.values(), Part, made=provenance(), command=command, stopped=stopped)

    def say(name, seconds=0.0):
        number = list(began).index(name) + 1
        tell(Progress(number, len(names), name, entries[name].state, seconds, entries[name].reason))

    def begin(name):
        began[name] = time.perf_counter()
        entries[name] = replace(entries[name], state=State.RUNNING)
        write()
        say(name)
        return entries[name], out / name, executor

    try:
        write()
        if at_once > 1:
            compile_ahead((compile_effects if full else compile_effects_of_studies, compile_motions))
        with contextlib.closing(_run_all(names, at_once, beside, begin)) as results:
            for name, result in results:
                entries[name] = result if isinstance(result, Entry) else _failed(entries[name], result)
                done.append(name)
                write()
                say(name, time.perf_counter() - began[name])
    except KeyboardInterrupt:
        running = [name for name in began if name not in done]
        entries |= {name: replace(entries[name], state=State.TO_COME) for name in running}
        said = f"The report was stopped after {len(done)} of {len(names)} studies" + f", while {listed(running)} ran" * bool(
            running
        )
        write(f"{said}; the others are still to come.")
        raise ReportInterrupt(f"{said}; {out / PAGE} holds those that are done.") from None
    return [name for name, entry in entries.items() if entry.state is State.FAILED]


def _run_all(names, at_once, beside, begin):
    """Yield the name of each study as it ends, and its entry, or the exception that the process beside this one was lost by.

    When nothing runs, the next study in order begins. Beside one runs the next in order that may.

    Parameters
    ----------
    names, at_once : as for `write_report`
    beside : whether a study that compares times runs beside one that does not
    begin : is called with the name of a study that begins now, and returns the arguments of `run_entry`
    """
    waiting, running = list(names), []
    times = {name for name in names if module_of(name).STUDY.compares_times}
    with SideProcesses() as processes:
        while waiting or running:
            excluded = (times if not beside or times & set(running) else set()) if running else set()
            name = next((name for name in waiting if name not in excluded), None) if len(running) < at_once else None
            if name is None:
                name, result = processes.next_result()
                running.remove(name)
                yield name, result
                continue
            cores = _cores(name in times) if beside and times & {*waiting, *running} else None
            waiting.remove(name)
            arguments = begin(name)
            if at_once == 1 or (name in times and not beside):
                yield name, run_entry(*arguments)
            else:
                running.append(name)
                processes.start(name, run_on, cores, *arguments)


def _cores(compares_times):
    """The core of a study that compares times, or those of the studies beside it."""
    first, *others = sorted(ALL_CORES)
    return {first} if compares_times else set(others)


def run_on(cores: set[int] | None, entry: Entry, out: Path, executor: Executor | None = None) -> Entry:
    """`run_entry` on some cores of the machine, with the processes that it begins; on all that it may use for None.

    With one core alone its rows run in this process: a fault of one of them costs the study, and no process beside this one loads
    what this one has loaded.
    """
    if ALL_CORES is not None:
        os.sched_setaffinity(0, cores or ALL_CORES)
    return run_entry(entry, out, SameProcess() if cores and len(cores) == 1 else executor)


def _entry(name, full, beside):
    record = module_of(name).STUDY
    return Entry(
        name, record.question, record.part, first_look="" if full else record.first_look,
        on_one_core=beside and record.compares_times,
    )  # fmt: skip


def run_entry(entry: Entry, out: Path, executor: Executor | None = None) -> Entry:
    """The entry of a study that has run, and is done or has failed."""
    try:
        study = run_study(entry.name, out, quick=bool(entry.first_look), executor=executor)
    except Exception as error:
        return _failed(entry, error)
    return replace(entry, state=State.DONE, study=study)


def _failed(entry, error):
    reason = f"{type(error).__name__}: {error}"
    return replace(entry, state=State.FAILED, reason=reason, traceback="".join(traceback.format_exception(error)))
