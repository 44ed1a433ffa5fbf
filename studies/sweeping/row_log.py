"""Rows on the disk: `rows.jsonl` with a line for each row as it comes, and `meta.json` that says what they were made with.

What is read back may have been torn by a kill, or damaged: a line that was torn is done again, everything else is refused by its
file and line, so that no row that is good is lost.
"""

import json
import logging
import os
import time
import warnings
from collections.abc import Container, Iterable, Iterator
from numbers import Real
from pathlib import Path
from typing import Any

from anet_lumped.checks import InputError, shown
from anet_lumped.limits import BYTES, check_most
from studies.sweeping.batch import BUDGET, CRASHED, OVER_BUDGET
from studies.sweeping.provenance import provenance

LOG = logging.getLogger(__name__)
LARGE = "large"
OF_JSON = (int, float, bool, type(None))  # which need no look at their characters
PARTS = "parts"  # folder of the parts that many processes share, see `parts`
ABSENT = object()  # in place of a value that is not given
TOLD = 3  # of what differs between two sweeps
FORCED_AFTER = 0.5  # [s]; to force every line to the disk would take longer than a short row


class RowsError(InputError):
    """Rows that cannot be told apart, or a folder that holds rows of something else, or damaged ones."""


class RowLog:
    """`rows.jsonl`, opened behind its last whole line.

    Parameters
    ----------
    path : of the file
    whole : bytes of its whole lines; what is behind them goes
    """

    def __init__(self, path: Path, whole: int):
        self.path, self.file, self.forced = path, path.open("ab"), time.perf_counter()
        self.file.truncate(whole)

    def append(self, number: int, line: dict) -> None:
        """Write the line of a row; it survives the end of this process, and once it is forced to the disk that of the machine."""
        try:
            self.file.write((json.dumps(line) + "\n").encode())
            self.file.flush()
            if time.perf_counter() - self.forced > FORCED_AFTER:
                self.force()
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self.path)) from None

    def force(self) -> None:
        """Force all lines to the disk."""
        os.fsync(self.file.fileno())
        self.forced = time.perf_counter()

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.force()
        self.file.close()


def open_log(
    out: Path,
    names: list[str],
    asked: Container[str] | None,
    *,
    resume: bool,
    identity: dict,
    columns: Iterable[str],
) -> tuple[dict[str, dict], RowLog]:
    """Lines of `out` by their keys, and the log to which further ones go.

    Parameters
    ----------
    out : folder
    names : of the inputs
    asked : keys of the rows that are wanted; None for any
    resume : whether there may be lines
    identity : what else the results depend on, which must be that of the lines
    columns : names that a row which is done has

    Raises
    ------
    RowsError : lines that are not to be resumed, are of something else, or cannot be read
    """
    log, meta = out / "rows.jsonl", out / "meta.json"
    data = _content(log) if log.exists() else b""
    if data and not resume:
        raise RowsError(f"{log} holds {len(data.splitlines())} rows already: resume them, or choose another folder.")
    if (out / PARTS).exists():
        raise RowsError(f"{out} holds parts of a sweep that many processes share: the same command goes on with them.")
    if data:
        check_identity(log, meta, identity)
    else:
        check_regular(meta)
        meta.write_text(json.dumps({"identity": identity, **provenance()}, indent=1))
    lines, whole = {}, 0
    for number, text in enumerate(data.splitlines(keepends=True), 1):
        try:
            line = line_of_text(text, names, columns)
        except ValueError as error:
            if text.endswith((b"\n", b"\r")):
                raise RowsError(
                    f"Rows must be whole to be resumed, but {log}, line {number}, {error}; without the line its row is done again."
                ) from None
            warnings.warn(f"{log}, line {number}, was torn: its row is done again.", stacklevel=2)
            break
        if line is not None:
            _, before = lines.get(key(line, names), (number, line))
            if standing(line) >= standing(before):
                lines[key(line, names)] = number, line
        whole += len(text)
    _check_kinds(log, lines.values(), columns)
    strange = [(number, line) for one, (number, line) in lines.items() if asked is not None and one not in asked]
    if strange:
        number, line = strange[0]
        inputs = shown({name: line[name] for name in names})
        raise RowsError(f"{log} holds {len(strange)} rows that are not asked for now, the first with {inputs} in line {number}.")
    opened = RowLog(log, whole)
    if data[:whole] and not data[:whole].endswith(b"\n"):  # a last line that only lacks its end
        opened.file.write(b"\n")
    return {one: line for one, (_, line) in lines.items()}, opened


def standing(line: dict) -> tuple[bool, float, bool]:
    """What lines of one row count by: that of a row that came to its end most, else that with the larger budget [s]; a crash of a
    row that had none counts least."""
    return line["status"] not in (OVER_BUDGET, CRASHED), line.get(BUDGET, 0.0), line["status"] == OVER_BUDGET


def take(lines: dict[Any, dict], found: dict[Any, dict]) -> None:
    """Add lines to `lines`; of two of one row that which stands higher counts."""
    for one, line in found.items():
        if one not in lines or standing(line) > standing(lines[one]):
            lines[one] = line


def is_kept(line: dict, budget: float | None) -> bool:
    """Whether the row of a line is not done again, as one that crashed or was over a smaller budget [s] is."""
    return line["status"] != CRASHED and (line["status"] != OVER_BUDGET or line.get(BUDGET, 0.0) >= (budget or 0.0))


def rows_again(lines: dict[Any, dict], budget: float | None) -> dict[Any, dict]:
    """Take the lines of rows that are to be done again (see `is_kept`) out of `lines`, and give them; the number of those over a
    smaller budget is told."""
    again = {one: line for one, line in lines.items() if not is_kept(line, budget)}
    for one in again:
        del lines[one]
    over = sum(line["status"] == OVER_BUDGET for line in again.values())
    if over:
        LOG.warning("rows that were over a smaller budget and are done again: %d", over)
    return again


def read_log(log: Path) -> list[dict]:
    """Lines of `rows.jsonl`, but for a last one that is torn or still being written; none where there is no file.

    Raises
    ------
    RowsError : a line is damaged
    """
    lines = []
    for number, text in enumerate(_content(log).splitlines(keepends=True) if log.exists() else [], 1):
        if not text.endswith((b"\n", b"\r")):
            break
        try:
            line = line_of_text(text, (), ())
        except ValueError as error:
            raise RowsError(f"Rows must be whole to be read, but {log}, line {number}, {error}.") from None
        if line is not None:
            lines.append(line)
    return lines


def key(row: dict, names: list[str]) -> str:
    """What tells a row from others: its inputs."""
    return json.dumps([row.get(name) for name in names])


def plain(value: Any) -> Any:
    """The same value in JSON's own types, which NumPy's, tuples and paths are not; characters that UTF-8 lacks are "?"."""
    if isinstance(value, dict) and all(type(one) in OF_JSON for one in value.values()):
        return dict(value)
    text = json.dumps(value, ensure_ascii=False, default=lambda x: x.tolist() if hasattr(x, "tolist") else str(x))
    return json.loads(text.encode("utf-8", "replace"))


def _content(path):
    """The bytes of a file of a sweep."""
    check_regular(path)
    try:
        check_most(BYTES, path.stat().st_size, f"To read {path}")
        return path.read_bytes()
    except OSError as error:
        raise RowsError(f"A folder of rows must be readable, but {path}: {error.strerror}.") from None


def check_regular(path: Path) -> None:
    """What is there must be a file, and no folder, pipe or device."""
    if path.exists() and not path.is_file():
        raise RowsError(f"A folder of rows must hold files, but {path} is none.")


def _parsed(text):
    """Value of a JSON text in bytes; ValueError says what is wrong."""
    try:
        return json.loads(text.decode("utf-8-sig"))
    except json.JSONDecodeError as error:
        raise ValueError(f"is no JSON ({error.msg}): {shown(text)}") from None
    except RecursionError:
        raise ValueError(f"is nested too deep: {shown(text)}") from None
    except UnicodeDecodeError:
        raise ValueError(f"is no UTF-8: {shown(text)}") from None
    except ValueError as error:  # more digits than Python reads
        raise ValueError(f"cannot be read: {error}") from None


def line_of(row: dict, result: dict, budget: float | None = None) -> dict:
    """The line of a row: its inputs, its result, status and reason; of one that crashed the budget [s] that it had, if any."""
    line = plain({"status": "done", "reason": ""} | result | row)
    return line | {BUDGET: budget} if budget and line["status"] == CRASHED else line


def line_of_text(text: bytes, names: Iterable[str], columns: Iterable[str]) -> dict | None:
    """The line that a text of a file is, None for an empty text; ValueError says what is wrong.

    Parameters
    ----------
    text : of one line
    names : that every line has, beside status and reason
    columns : names that a row which is done has
    """
    if not text.strip():
        return None
    line = _parsed(text)
    if not isinstance(line, dict):
        raise ValueError(f"is no JSON object: {shown(line)}")
    missing = [
        name for name in (*names, "status", "reason", *(columns if line.get("status") == "done" else ())) if name not in line
    ]
    if missing:
        raise ValueError(f"lacks {shown(missing[0])}")
    for name in ("status", "reason"):
        if not isinstance(line[name], str):
            raise ValueError(f"has {name}={shown(line[name])}, which is no text")
    if not isinstance(line.get(BUDGET, 0.0), Real):
        raise ValueError(f"has {BUDGET}={shown(line[BUDGET])}, which is no number")
    nested = next((name for name, value in line.items() if isinstance(value, dict)), None)
    if nested is not None:
        raise ValueError(f"has {shown(nested)}={shown(line[nested])}, which is no number and no text")
    return plain(line)


def kind(value: Any) -> Any:
    """The type that values of one column share, `Real` for all numbers; of a whole number beyond 64 bits, LARGE."""
    if isinstance(value, Real) and not isinstance(value, bool):
        return LARGE if isinstance(value, int) and abs(value) >= 2**63 else Real
    return type(value)


def _check_kinds(log, lines, columns):
    """A result must be of the same kind in all lines that have it."""
    first = {}
    for number, line in lines:
        for name in columns:
            if line.get(name) is not None:
                where, value = first.setdefault(name, (number, line[name]))
                if kind(value) is not kind(line[name]):
                    raise RowsError(
                        f"A result must be of one type in all rows, but {log} has {name}={shown(value)} in line {where} and "
                        f"{shown(line[name])} in line {number}; without the wrong line its row is done again."
                    )


def read_meta(meta: Path) -> Any:
    """What `meta.json` holds, None if it is not there.

    Raises
    ------
    RowsError : it cannot be read
    """
    try:
        return _parsed(_content(meta)) if meta.exists() else None
    except RowsError:
        raise
    except ValueError as error:
        raise RowsError(f"What rows were made with must be known to resume them, but {meta} {error}.") from None


def check_identity(log: Path, meta: Path, identity: dict) -> dict:
    """Lines of `log` must have been made with what is asked for now; gives what `meta` holds.

    Raises
    ------
    RowsError
    """
    kept = read_meta(meta)
    before = kept.get("identity") if isinstance(kept, dict) else None
    if not isinstance(before, dict):
        raise RowsError(f"What rows were made with must be known to resume {log}, but {meta} does not say it: take another folder.")
    changed = [name for name in before | identity if before.get(name) != identity.get(name)]
    if changed:
        found = [text for name in changed for text in _differences(before.get(name, ABSENT), identity.get(name, ABSENT), name)]
        more = f" and {len(found) - TOLD} more" if len(found) > TOLD else ""
        raise RowsError(
            f"Rows of one table must agree, but {log} is of another sweep: {', '.join(found[:TOLD])}{more}; ask for the same, or "
            "take another folder."
        )
    return kept


def _differences(before: Any, now: Any, where: str) -> Iterator[str]:
    """Yield "vary.EA was [1, 2] and is [1, 3]" for each part of two JSON values that differs."""
    if isinstance(before, dict) and isinstance(now, dict):
        parts = [(f"{where}.{key}", before.get(key, ABSENT), now.get(key, ABSENT)) for key in before | now]
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now) and dict in map(type, now):
        parts = [(f"{where}[{i}]", *pair) for i, pair in enumerate(zip(before, now, strict=True))]
    elif before != now:
        was, is_now = ("not given" if value is ABSENT else shown(value) for value in (before, now))
        yield f"{where} was {was} and is {is_now}"
        return
    else:
        return
    for name, one, other in parts:
        yield from _differences(one, other, name)
