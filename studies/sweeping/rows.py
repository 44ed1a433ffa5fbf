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

from anet_lumped.limits import ROWS, check_most
from anet_lumped.regular_files import check_target
from studies.sweeping.folder_lock import locked
from studies.sweeping.row_log import LARGE, RowsError, key, kind, open_log, plain
from studies.sweeping.workers import check_workers, through_executor, through_own_pool

LOG = logging.getLogger(__name__)
TOLD_EVERY = 5.0  # [s], between two words on how far the rows are
__all__ = ["RowsError", "run_rows", "save_table"]


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
    workers : processes of that pool; by default one for each core that this process may use
    out : folder for `rows.jsonl` and `meta.json`, and at the end for `rows.parquet` and `rows.csv`
    resume : keep the lines that `out` holds (but for crashed ones) and do the rest
    identity : what else the results depend on (JSON values): rows with another identity are not resumed
    columns : names that the results of a row that is done have: a line without one of them is damaged and not resumed
    label : name of a progress bar on stderr; none by default
    heads : names of columns in `rows.csv`, where they have units

    Returns
    -------
    pandas.DataFrame : one line a row; columns inputs, results, status, reason

    Raises
    ------
    RowsError : two rows are equal, or `out` holds rows that are not resumed, belong to something else or are damaged
    FolderInUseError : another run writes to `out`
    InputError : more rows than `limits.ROWS`, or workers that cannot be
    KeyboardInterrupt : on Ctrl-C, its message says how many rows are kept and where
    """
    check_workers(workers)
    rows = list(_counted(map(plain, rows)))
    names = list(dict.fromkeys(name for row in rows for name in row))
    asked = {key(row, names): row for row in rows}
    if len(asked) < len(rows):
        raise RowsError(f"Rows must differ in their inputs, but {len(rows) - len(asked)} of {len(rows)} are repeated.")
    out = None if out is None else Path(out)
    with locked(out):
        lines, log = {}, None
        if out is not None:
            lines, log = open_log(out, names, asked, resume=resume, identity=plain(identity or {}), columns=columns)
        todo = [row for one, row in asked.items() if one not in lines]
        results = through_executor(executor, function, todo) if executor else through_own_pool(function, todo, workers)
        threading.Thread(target=importlib.import_module, args=("pandas",), daemon=True).start()  # while the workers start
        with log or contextlib.nullcontext(), contextlib.closing(results):
            try:
                for row, result in _with_progress(results, len(todo), label):
                    line = plain({"status": "done", "reason": ""} | result | row)
                    if log:
                        log.append(line)
                    lines[key(row, names)] = line
            except KeyboardInterrupt:
                on_disk = f", which are in {log.path}" if log else ""
                raise KeyboardInterrupt(f"Stopped after {len(lines)} of {len(asked)} rows{on_disk}.") from None
        table = _table([lines[one] for one in asked], names)
        if out is not None:
            save_table(table, out / "rows", heads)
        return table


def save_table(table, stem: Path, heads: dict[str, str] | None = None) -> None:
    """Write a DataFrame as `stem`.parquet and `stem`.csv, the latter with other names of columns if there are any."""
    stem.parent.mkdir(parents=True, exist_ok=True)
    for ending in (".csv", ".parquet"):
        check_target(stem.with_name(stem.name + ending), "A table")
    table.rename(columns=heads or {}).to_csv(stem.with_name(stem.name + ".csv"), index=False)
    table.to_parquet(stem.with_name(stem.name + ".parquet"), index=False)


def _table(lines, names):
    import pandas

    results = dict.fromkeys(name for line in lines for name in line if name not in (*names, "status", "reason"))
    table = pandas.DataFrame(lines, columns=[*names, *results, "status", "reason"])
    for name in table:  # a column of numbers and words, such as 0.1 and "auto", has no type in a parquet file
        kinds = {kind(value) for value in table[name].dropna()}
        if len(kinds) > 1 or LARGE in kinds:
            table[name] = table[name].map(str, na_action="ignore")
    return table


def _counted(rows):
    """The rows, as long as they are not too many for one table."""
    for number, row in enumerate(rows, 1):
        check_most(ROWS, number, "This table")
        yield row


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
    with Progress(*columns, console=Console(stderr=True)) as progress:
        task = progress.add_task(label, total=total)
        for row, result in results:
            yield row, result
            progress.advance(task)
