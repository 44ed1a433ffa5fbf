"""The report: runs the studies, cheap and telling ones first, and writes the page after each of them."""

import time
import traceback
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path

from studies.shown.page import Entry, State, write_page
from studies.study import NAMES, Part, module_of, run_study
from studies.sweeping.folder_lock import locked
from studies.sweeping.provenance import provenance

PAGE = "report.html"


class ReportInterrupt(KeyboardInterrupt):
    """Ctrl-C during a report; the page holds the studies that were done, which the message says."""


@dataclass(frozen=True)
class Progress:
    """Where a report stands, as its caller is told when a study starts and when one ends.

    Parameters
    ----------
    number, total : of the study among all of them, from 1
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
    tell: Callable[[Progress], None] = lambda progress: None,
) -> list[str]:
    """Run the studies and write `out/report.html` after each of them, with each study's data in a folder beside it.

    Parameters
    ----------
    out : folder
    full : all of every study; otherwise there is a first look of the long ones, and the page says what it leaves out
    executor : where the studies' rows run
    names : of the studies, in the order in which they run
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
        return _write(out, names, full, executor, tell)


def _write(out, names, full, executor, tell):
    """`write_report` in a folder that nobody else writes to."""
    entries = {name: _entry(name, full) for name in names}
    command = "anet-lumped report" + " --full" * full

    def write(stopped=""):
        write_page(out / PAGE, entries.values(), Part, made=provenance(), command=command, stopped=stopped)

    for number, name in enumerate(names, 1):
        entries[name] = replace(entries[name], state=State.RUNNING)
        write()
        tell(Progress(number, len(names), name, State.RUNNING))
        began = time.perf_counter()
        try:
            entries[name] = _run(entries[name], out / name, executor)
        except KeyboardInterrupt:
            entries[name] = replace(entries[name], state=State.TO_COME)
            said = f"The report was stopped after {number - 1} of {len(names)} studies, while {name} ran"
            write(f"{said}; the others are still to come.")
            raise ReportInterrupt(f"{said}; {out / PAGE} holds those that are done.") from None
        tell(Progress(number, len(names), name, entries[name].state, time.perf_counter() - began, entries[name].reason))
    write()
    return [name for name, entry in entries.items() if entry.state is State.FAILED]


def _entry(name, full):
    record = module_of(name).STUDY
    return Entry(name, record.question, record.part, first_look="" if full else record.first_look)


def _run(entry, out, executor):
    try:
        study = run_study(entry.name, out, quick=bool(entry.first_look), executor=executor)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        return replace(entry, state=State.FAILED, reason=reason, traceback=traceback.format_exc())
    return replace(entry, state=State.DONE, study=study)
