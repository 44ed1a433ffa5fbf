"""Run one function over many rows: in parallel, each line on disk as it comes, resumable after a kill.

Every study and every sweep goes through `run_rows`. A row is a dict of inputs (numbers, words); the function turns it
into a dict of results, which may hold a `status` ("done" where it does not) and a `reason`.
"""

import contextlib
import importlib
import json
import logging
import os
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from pathlib import Path

from studies.sweeping.provenance import provenance
from studies.sweeping.workers import through_executor, through_own_pool

LOG = logging.getLogger(__name__)
TOLD_EVERY = 5.0  # [s], between two words on how far the rows are
FORCED_AFTER = 0.5  # [s]; to force every line to the disk would take longer than a short row


class RowsError(ValueError):
    """Rows that cannot be told apart, or a folder that holds rows of something else."""


def run_rows(
    function: Callable[[dict], dict],
    rows: Iterable[dict],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    identity: dict | None = None,
    label: str | None = None,
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
    label : name of a progress bar on stderr; none by default

    Returns
    -------
    pandas.DataFrame : one line a row; columns inputs, results, status, reason

    Raises
    ------
    RowsError : two rows are equal, or `out` holds rows that are not resumed or belong to something else
    KeyboardInterrupt : on Ctrl-C, its message says how many rows are kept and where
    """
    rows = [_plain(row) for row in rows]
    names = list(dict.fromkeys(name for row in rows for name in row))
    asked = {_key(row, names): row for row in rows}
    if len(asked) < len(rows):
        raise RowsError(f"Rows must differ in their inputs, but {len(rows) - len(asked)} of {len(rows)} are repeated.")
    lines, log = {}, None
    if out is not None:
        lines, log = _open_log(Path(out), names, asked, resume, _plain(identity or {}))
    todo = [row for key, row in asked.items() if key not in lines]
    results = through_executor(executor, function, todo) if executor else through_own_pool(function, todo, workers)
    threading.Thread(target=importlib.import_module, args=("pandas",), daemon=True).start()  # while the workers start
    with log or contextlib.nullcontext(), contextlib.closing(results):
        try:
            for row, result in _with_progress(results, len(todo), label):
                line = _plain({"status": "done", "reason": ""} | result | row)
                if log:
                    log.append(line)
                lines[_key(row, names)] = line
        except KeyboardInterrupt:
            on_disk = f", which are in {log.file.name}" if log else ""
            raise KeyboardInterrupt(f"Stopped after {len(lines)} of {len(asked)} rows{on_disk}.") from None
    table = _table([lines[key] for key in asked], names)
    if out is not None:
        save_table(table, Path(out) / "rows")
    return table


def save_table(table, stem: Path) -> None:
    """Write a DataFrame as `stem`.parquet and `stem`.csv."""
    stem.parent.mkdir(parents=True, exist_ok=True)
    table.to_csv(stem.with_name(stem.name + ".csv"), index=False)
    table.to_parquet(stem.with_name(stem.name + ".parquet"), index=False)


def _open_log(out, names, asked, resume, identity):
    """Lines that `out` holds already, and its `rows.jsonl` opened behind the last whole one."""
    log, meta = out / "rows.jsonl", out / "meta.json"
    lines = {}
    whole = 0
    if log.exists():
        data = log.read_bytes()
        whole = data.rfind(b"\n") + 1  # behind it: a line torn by a kill
        lines = {_key(line, names): line for line in map(json.loads, data[:whole].splitlines())}
    if lines:
        if not resume:
            raise RowsError(f"{log} holds {len(lines)} rows already: resume them, or choose another folder.")
        before = json.loads(meta.read_text())["identity"]
        changed = [name for name in before | identity if before.get(name) != identity.get(name)]
        if changed:
            first = [next(_differences(before.get(name), identity.get(name), name)) for name in changed]
            raise RowsError(
                f"Rows of one table must agree, but {log} was made with another {' and '.join(changed)}: {'; '.join(first)}."
            )
        strange = [line for key, line in lines.items() if key not in asked]
        if strange:
            inputs = {name: strange[0].get(name) for name in names}
            raise RowsError(f"{log} holds {len(strange)} rows that are not asked for now, the first with {inputs}.")
    else:
        out.mkdir(parents=True, exist_ok=True)
        meta.write_text(json.dumps({"identity": identity, **provenance()}, indent=1))
    return {key: line for key, line in lines.items() if line["status"] != "crashed"}, _Log(log, whole)


class _Log:
    """`rows.jsonl`, opened behind its last whole line."""

    def __init__(self, path, whole):
        self.file, self.forced = path.open("ab"), time.perf_counter()
        self.file.truncate(whole)

    def append(self, line):
        self.file.write((json.dumps(line) + "\n").encode())
        self.file.flush()
        if time.perf_counter() - self.forced > FORCED_AFTER:
            self.force()

    def force(self):
        os.fsync(self.file.fileno())
        self.forced = time.perf_counter()

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.force()
        self.file.close()


def _key(row, names):
    return json.dumps([row.get(name) for name in names])


def _plain(value):
    """The same value in JSON's own types: NumPy's scalars and arrays, tuples and paths are not."""
    return json.loads(json.dumps(value, default=lambda x: x.tolist() if hasattr(x, "tolist") else str(x)))


def _table(lines, names):
    import pandas

    results = dict.fromkeys(name for line in lines for name in line if name not in (*names, "status", "reason"))
    table = pandas.DataFrame(lines, columns=[*names, *results, "status", "reason"])
    for name in table:  # a column of numbers and words, such as 0.1 and "auto", has no type in a parquet file
        if len({isinstance(value, str) for value in table[name].dropna()}) > 1:
            table[name] = table[name].map(str, na_action="ignore")
    return table


def _differences(before, now, where):
    """Yield "vary.EA was [1, 2] and is [1, 3]" for each part of two JSON values that differs."""
    if isinstance(before, dict) and isinstance(now, dict):
        parts = [(f"{where}.{key}", before.get(key), now.get(key)) for key in before | now]
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now) and dict in map(type, now):
        parts = [(f"{where}[{i}]", *pair) for i, pair in enumerate(zip(before, now, strict=True))]
    elif before != now:
        yield f"{where} was {before} and is {now}"
        return
    else:
        return
    for name, one, other in parts:
        yield from _differences(one, other, name)


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
