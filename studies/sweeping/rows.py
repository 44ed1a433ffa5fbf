"""Run one function over many rows: in parallel, each line on disk as it comes, resumable after a kill.

Every study and every sweep goes through `run_rows`. A row is a dict of inputs (numbers, words); the function turns it
into a dict of results, which may hold a `status` ("done" where it does not) and a `reason`.
"""

import contextlib
import importlib
import logging
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from anet_lumped.limits import ROWS, check_most
from anet_lumped.regular_files import check_target
from studies.sweeping.batch import BUDGET, CRASHED, BatchRunner, check_budget
from studies.sweeping.folder_lock import LOCK, locked
from studies.sweeping.parts import LARGEST_PART, PART_SECONDS, NumberedRows, PartTask, Shard, gathered, open_parts
from studies.sweeping.provenance import library
from studies.sweeping.row_log import (
    LARGE,
    RowsError,
    key,
    kind,
    line_of,
    open_log,
    plain,
    read_log,
    read_meta,
    rows_again,
    standing,
    take,
)
from studies.sweeping.workers import OwnPool, Pace, WorkerError, check_workers, slots, through_executor

LOG = logging.getLogger(__name__)
TOLD_EVERY = 5.0  # [s], between two words on how far the rows are
REDRAWN = 2.0  # times a second, of the progress bar: ten times would take a twelfth of a core that runs rows
__all__ = ["RowsError", "gather", "read_rows", "run_rows", "save_table"]


class RowsInterrupt(KeyboardInterrupt):
    """Ctrl-C while rows were done; ``found`` is the table of those that were."""

    def __init__(self, message: str, found: Any) -> None:
        super().__init__(message)
        self.found = found


def run_rows(
    function: Callable[[dict], dict],
    rows: Iterable[dict],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    identity: dict | None = None,
    columns: Iterable[str] = (),
    label: str | None = None,
    budget: float | None = None,
    shard: Shard | None = None,
    heads: dict[str, str] | None = None,
):
    """Table with `function(row)` beside every row, in the order of `rows`.

    A function that raises and a worker process that dies make a line with a status and a reason, never a lost table.
    With `out` each line is written (`rows.jsonl`) as it comes, so that kill -9 loses only what was running, and forced to the
    disk every FORCED_AFTER and at the end.

    Parameters
    ----------
    function : picklable, dict of inputs -> dict of results
    rows : dicts of inputs, all different, of values that JSON holds
    executor : where the rows run; by default a pool of processes, rebuilt when one of them dies
    workers : processes of that pool, by default one for each core that this process may use; or rows that the executor runs at once
    out : folder for `rows.jsonl` and `meta.json`, and at the end for `rows.parquet` and `rows.csv`
    resume : keep the lines that `out` holds (but for crashed ones, and those over a smaller `budget`) and do the rest
    identity : what else the results depend on (JSON values): rows with another identity are not resumed
    columns : names that the results of a row that is done have: a line without one of them is damaged and not resumed
    label : name of a progress bar on stderr; none by default
    budget : float or None [s], that a row may take; one that takes longer is "over budget"
    shard : of the rows these alone, and all to parts of the folder `out` (see `parts`), which other processes share; those that are
        there are kept. With an executor its workers write the parts, so that all of them must see the folder
    heads : names of columns in `rows.csv`, where they have units

    Returns
    -------
    pandas.DataFrame : one line a row; columns inputs, results, status, reason

    Raises
    ------
    RowsError : two rows are equal, or `out` holds rows that are not resumed, belong to something else or are damaged
    FolderInUseError : another run writes to `out`
    InputError : more rows than `limits.ROWS`, or workers or a budget that cannot be
    WorkerError : workers that do not come up or, with parts, cannot do what they are given; an executor that breaks
    RowsInterrupt : Ctrl-C
        Both say how many rows are done, and where they are; the table of these is their `found`.
    """
    check_workers(workers, elsewhere=executor is not None)
    run = BatchRunner(function, check_budget(budget))
    rows, names, total = _own_rows(rows, shard)
    asked = {key(row, names): number for number, row in rows.items()}
    if len(asked) < len(rows):
        raise RowsError(f"Rows must differ in their inputs, but {len(rows) - len(asked)} of {len(rows)} are repeated.")
    out = None if out is None else Path(out)
    lock = LOCK if shard is None else f"{LOCK}-{shard}"
    with locked(out, lock):
        lines, log = {}, None
        settings = {"identity": plain(identity or {}), "columns": columns}
        if shard is not None:
            out = out.resolve()
            lines, log = open_parts(out, shard, names, total, heads=heads, **settings)
        elif out is not None:
            kept, log = open_log(out, names, asked, resume=resume, **settings)
            lines = {asked[one]: line for one, line in kept.items()}
        earlier = rows_again(lines, budget)
        todo = [number for number in rows if number not in lines]
        threading.Thread(target=importlib.import_module, args=("pandas",), daemon=True).start()  # while the workers start
        in_parts = shard is not None and executor is not None
        with log or contextlib.nullcontext(), contextlib.ExitStack() as stack:
            if in_parts:
                pace = Pace(workers or slots(executor), PART_SECONDS, LARGEST_PART)
                task = PartTask(run, out, shard, library(), log.stamp)
                results = through_executor(executor, task, NumberedRows(rows), todo, pace, strict=True)
            elif executor:
                results = through_executor(executor, run, rows, todo)
            else:
                results = stack.enter_context(OwnPool(run, workers)).results(rows, todo)
            stack.callback(results.close)
            try:
                for number, result in _with_progress(results, len(todo), label):
                    line = line_of(rows[number], result, budget)
                    if log and not (in_parts and line["status"] != CRASHED):  # those of parts are on the disk
                        log.append(number, line)
                    lines[number] = max(line, earlier.get(number, line), key=standing)  # as whoever reads the folder
            except (KeyboardInterrupt, WorkerError) as stopped:
                raise with_done(stopped, [lines[number] for number in rows if number in lines], names, log, len(rows)) from None
        table = table_of([lines[number] for number in rows], names)
        if out is not None and len(rows) == total:
            save_table(table, out / "rows", heads)
        return table


def with_done(
    stopped: BaseException, lines: list[dict], names: list[str], log: Any, asked: int | None = None
) -> RowsInterrupt | WorkerError:
    """What ended rows, with the table of those that are done, how many they are of those asked for, and where they are kept."""
    of, table = "" if asked is None else f" of {asked}", table_of(lines, names)
    on_disk = f", which are in {log.path}" if log and lines else ""
    if not isinstance(stopped, WorkerError):
        return RowsInterrupt(f"Stopped after {len(lines)}{of} rows{on_disk}.", table)
    on_disk = on_disk or ", which are in the `found` of this error"
    return WorkerError(f"{str(stopped).rstrip('.')}; {len(lines)}{of} rows are done{on_disk}." if lines else str(stopped), table)


def gather(out: str | Path):
    """Put the parts of a sweep together: one table in the order of its rows, also as `rows.parquet` and `rows.csv` in its folder.

    Parameters
    ----------
    out : folder of the sweep, which may still run

    Returns
    -------
    table : pandas.DataFrame
    missing : list of int, numbers of the rows that are not there, from 0
    torn : list of Path, parts that are torn or damaged

    Raises
    ------
    RowsError : the folder holds no parts
    """
    out = Path(out)
    lines, meta, missing, torn = gathered(out)
    table = table_of(lines, meta["names"])
    save_table(table, out / "rows", meta.get("heads"))
    return table, missing, torn


def read_rows(out: str | Path):
    """The rows of a folder, however they are kept, also while they are still being done.

    Returns
    -------
    table : pandas.DataFrame
    meta : dict, what `meta.json` holds
    asked : int or None, how many rows are asked for, where that is known

    Raises
    ------
    RowsError : the folder holds no rows, or damaged ones
    """
    out = Path(out)
    meta = read_meta(out / "meta.json")
    if not (isinstance(meta, dict) and isinstance(meta.get("identity"), dict)):
        raise RowsError(f"A folder of rows must hold meta.json, but {out} does not.")
    if "rows" in meta:
        lines, meta, _, _ = gathered(out)
        return table_of(lines, meta["names"]), meta, meta["rows"]
    lines = read_log(out / "rows.jsonl")
    if not lines:
        raise RowsError(f"{out} holds no rows.")
    vary = [name for name in lines[0] if name in meta["identity"].get("vary", {})]
    best: dict = {}  # lines of rows that were done again stand higher
    for number, line in enumerate(lines):
        take(best, {key(line, vary) if vary else number: line})
    return table_of(list(best.values()), vary), meta, None


def save_table(table, stem: Path, heads: dict[str, str] | None = None) -> None:
    """Write a DataFrame as `stem`.parquet and `stem`.csv, the latter with other names of columns if there are any."""
    stem.parent.mkdir(parents=True, exist_ok=True)
    for ending in (".csv", ".parquet"):
        check_target(stem.with_name(stem.name + ending), "A table")
    table.rename(columns=heads or {}).to_csv(stem.with_name(stem.name + ".csv"), index=False)
    table.to_parquet(stem.with_name(stem.name + ".parquet"), index=False)


def table_of(lines: list[dict], names: list[str]):
    """DataFrame of lines: inputs by their names, results, status and reason."""
    import pandas

    results = dict.fromkeys(name for line in lines for name in line if name not in (*names, "status", "reason", BUDGET))
    table = pandas.DataFrame(lines, columns=[*names, *results, "status", "reason"])
    for name in table:  # a column of numbers and words, such as 0.1 and "auto", has no type in a parquet file
        kinds = {kind(value) for value in table[name].dropna()}
        if len(kinds) > 1 or LARGE in kinds:
            table[name] = table[name].map(str, na_action="ignore")
    return table


def _own_rows(rows, shard):
    """Rows by their numbers, all of them or those of a shard; names of their inputs; how many rows there are in all."""
    own, names, number = {}, {}, -1
    for number, row in enumerate(rows):
        check_most(ROWS, number + 1, "This table")
        names.update(dict.fromkeys(row))
        if shard is None or number % shard.count == shard.number - 1:
            own[number] = plain(row)
    return own, list(names), number + 1


def _with_progress(results, total, label):
    if label is None:
        told = time.monotonic()
        for done, line in enumerate(results):
            if time.monotonic() - told > TOLD_EVERY:
                told = time.monotonic()
                LOG.info("%d of %d rows are done", done, total)
            yield line
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    columns = "{task.description}", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), "left"
    with Progress(*columns, console=Console(stderr=True), refresh_per_second=REDRAWN) as progress:
        task = progress.add_task(label, total=total)
        for row, result in results:
            yield row, result
            progress.advance(task)
