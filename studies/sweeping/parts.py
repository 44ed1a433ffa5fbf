"""Rows that many processes or machines share: each writes what it has done as a part, a file that is there whole or not at all.

    FOLDER/meta.json                      what the rows are made with, written by whoever comes first
    FOLDER/parts/2-of-4/000000001.jsonl   lines as those of `rows.jsonl`, with the numbers of their rows, and one that ends the part

A part is named by the number of its first row. It appears by rename, so that a process that is killed leaves none that is half.
One that is torn nevertheless (a disk that lost what it held) lacks its last line or differs from its checksum. Whoever goes on
reads which rows are there, and does the others. Nobody waits for anybody.
"""

import contextlib
import json
import os
import socket
import time
import uuid
import warnings
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

from anet_lumped.checks import InputError, shown
from anet_lumped.regular_files import whole_file
from studies.sweeping.batch import BatchRunner
from studies.sweeping.part_stamp import check_stamp, stamp_of
from studies.sweeping.provenance import library, provenance
from studies.sweeping.row_log import (
    PARTS,
    RowsError,
    check_identity,
    is_kept,
    line_of,
    line_of_text,
    read_meta,
    take,
)
from studies.sweeping.workers import WorkerError

NUMBER = "row_number"  # key of a line of a part
PART_SECONDS = 20.0  # [s], after which a part is written; a kill loses no more than that of a worker
LARGEST_PART = 10_000  # rows
ENDING = ".jsonl"


class Shard(NamedTuple):
    """A share of the rows: every `count`-th of them, beginning with the `number`-th; all of them by default."""

    number: int = 1
    count: int = 1

    def __str__(self) -> str:
        return f"{self.number}-of-{self.count}"

    def numbers(self, rows: int) -> range:
        """Numbers of its rows, counted from 0, of so many."""
        return range(self.number - 1, rows, self.count)


def read_shard(text: str) -> Shard:
    """The shard that "2/4" means.

    Raises
    ------
    InputError
    """
    number, _, count = text.partition("/")
    if number.isdecimal() and count.isdecimal() and 1 <= int(number) <= int(count):
        return Shard(int(number), int(count))
    raise InputError(f"A shard must be i/n with i from 1 to n, as in 2/4, but {shown(text)} was given.")


class PartError(RowsError):
    """A part that is torn, or of something else."""


def part_file(folder: Path, shard: Shard, number: int) -> Path:
    """The file of a part that begins with a row."""
    return folder / PARTS / str(shard) / f"{number:09d}{ENDING}"


def write_part(path: Path, lines: Sequence[dict], seconds: float, stamp: dict[str, str] | None = None) -> None:
    """Write a part of the sweep of a stamp, which took so many seconds [s]; it is there whole, and on the disk, or not at all."""
    body = "".join(json.dumps(line) + "\n" for line in lines).encode()
    end = json.dumps({"part": {"rows": len(lines), "crc32": zlib.crc32(body), "seconds": seconds, "of": stamp}}) + "\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path, "A part") as half, half.open("wb") as file:
        file.write(body + end.encode())
        file.flush()
        os.fsync(file.fileno())


def read_part(
    path: Path, names: Iterable[str] = (), columns: Iterable[str] = (), stamp: dict[str, str] | None = None
) -> tuple[list[dict], float]:
    """Lines of a part, and the time that it took [s]; with a stamp it must be of that sweep.

    Raises
    ------
    PartError : it is torn or damaged
    RowsError : it is of another sweep
    """
    *texts, last = path.read_bytes().splitlines(keepends=True) or [b""]
    try:
        end = json.loads(last)["part"]
        whole = end["rows"] == len(texts) and end["crc32"] == zlib.crc32(b"".join(texts))
        seconds = float(end["seconds"])
    except (ValueError, TypeError, KeyError):
        whole = False
    if not whole:
        raise PartError(f"The part {path} is torn or damaged.")
    if stamp is not None:
        check_stamp(path, end.get("of"), stamp)
    try:
        return [line_of_text(text, [*names, NUMBER], columns) for text in texts], seconds
    except ValueError as error:
        raise PartError(f"A line of the part {path} {error}.") from None


def open_parts(
    out: Path,
    shard: Shard,
    names: list[str],
    rows: int,
    *,
    identity: dict,
    columns: Iterable[str],
    heads: dict[str, str] | None = None,
) -> tuple[dict[int, dict], "PartLog"]:
    """Lines of a shard by their numbers, and where its further lines go. Torn parts are taken away, in a word.

    Parameters
    ----------
    out : folder
    shard : Shard
    names : of the inputs
    rows : how many there are
    identity : what else the results depend on, which must be that of the parts
    columns : names that a row which is done has
    heads : names of columns in `rows.csv`, for `gather`

    Raises
    ------
    RowsError : the folder holds rows of one process, of another sweep or of another version of this library
    """
    meta = out / "meta.json"
    if (out / "rows.jsonl").exists():
        raise RowsError(f"{out} holds rows of a sweep in one process, {out / 'rows.jsonl'}: choose another folder.")
    content = {"identity": identity, "rows": rows, "names": names, "heads": heads or {}, "library": library(), **provenance()}
    if not (meta.exists() or _write_first(meta, json.dumps(content, indent=1))):
        raise RowsError(f"What rows are made with must be written, but {meta} cannot be.")
    before = check_identity(out / PARTS, meta, identity)
    if before.get("names") != names or before.get("rows") != rows:
        raise RowsError(f"{meta} is not of these rows: choose another folder.")
    check_library(before.get("library"), f"the rows of {out}")
    lines: dict[int, dict] = {}
    stamp = stamp_of(before)
    for folder in _shard_folders(out, shard):
        found, torn = lines_of_parts(folder, names, columns, stamp)
        take(lines, found)
        for path in torn:
            warnings.warn(f"The part {path} was torn: its rows are done again.", stacklevel=2)
            path.unlink(missing_ok=True)
    own = shard.numbers(rows)
    return {number: without_number(line) for number, line in lines.items() if number in own}, PartLog(out, shard, stamp)


def without_number(line: dict) -> dict:
    """A line, or a row, without its number."""
    return {name: value for name, value in line.items() if name != NUMBER}


def _shard_folders(out, shard):
    """Folders of parts with rows of a shard: its own, and those of shards of another count."""
    folders = [path for path in (out / PARTS).glob("*-of-*") if path.is_dir()]
    same_count = {str(Shard(number, shard.count)) for number in range(1, shard.count + 1)} - {str(shard)}
    return sorted(path for path in folders if path.name not in same_count)


def lines_of_parts(
    folder: Path, names: Iterable[str], columns: Iterable[str], stamp: dict[str, str]
) -> tuple[dict[int, dict], list[Path]]:
    """Lines of all parts of a shard's folder by their numbers, and the parts that are torn."""
    lines: dict[int, dict] = {}
    torn = []
    for path in sorted(folder.glob(f"*{ENDING}")):
        if path.name.startswith("."):
            continue
        try:
            found, _ = read_part(path, names, columns, stamp)
        except PartError:
            torn.append(path)
            continue
        for line in found:
            take(lines, {line[NUMBER]: line})
    return lines, torn


def _write_first(path, text):
    """Write a file unless it is there, whole at once, whoever else does the same; say whether it is there now."""
    half = path.with_name(f".{uuid.uuid4().hex}")
    half.write_text(text)
    try:
        os.link(half, path)
    except FileExistsError:
        pass
    except OSError:  # a file system without links
        half.replace(path)
    half.unlink(missing_ok=True)
    return path.exists()


def check_library(before: dict | None, of: str) -> None:
    """What is installed here must be what something was begun with.

    Raises
    ------
    VersionError
    """
    now = library()
    if before != now:
        other = [name for name in now if (before or {}).get(name) != now[name]]
        was, here = (", ".join(f"{name} {made.get(name)}" for name in other) for made in (before or {}, now))
        raise VersionError(
            f"All machines must have the same versions, but {of} were begun with {was}, and {socket.gethostname()} has {here}."
        )


class VersionError(RowsError):
    """A machine with another version of what results depend on."""


class PartLog:
    """Where a process collects the lines of its shard, and writes them as a part every PART_SECONDS and at the end."""

    def __init__(self, out: Path, shard: Shard, stamp: dict[str, str] | None = None):
        self.stamp = stamp
        self.path, self.out, self.shard = out / PARTS / str(shard), out, shard
        self.lines: list[dict] = []
        self.began = time.perf_counter()

    def append(self, number: int, line: dict) -> None:
        """Take a line of a row."""
        self.lines.append({NUMBER: number, **line})
        if time.perf_counter() - self.began > PART_SECONDS:
            self.force()

    def force(self) -> None:
        """Write the lines that are not written yet; no part that is there is replaced."""
        if self.lines:
            path = part_file(self.out, self.shard, self.lines[0][NUMBER])
            again = 1
            while path.exists():  # its first row crashed or was over a smaller budget, and was done again
                again += 1
                path = path.with_name(f"{self.lines[0][NUMBER]:09d}-{again}{ENDING}")
            write_part(path, self.lines, time.perf_counter() - self.began, self.stamp)
        self.lines, self.began = [], time.perf_counter()

    def __enter__(self) -> "PartLog":
        return self

    def __exit__(self, *exception: object) -> None:
        self.force()


@dataclass(frozen=True)
class PartTask:
    """What a worker of an executor does: it runs rows for PART_SECONDS, writes them as a part, and gives their results back.

    A part that is there, of the same task that was given out before its worker died, is read and not done again.

    Parameters
    ----------
    run : BatchRunner
    out : folder, which every worker must see
    shard : that the rows are of
    made_with : `library()` of the process that gives out the rows
    stamp : of the sweep
    """

    run: BatchRunner
    out: Path
    shard: Shard
    made_with: dict
    stamp: dict[str, str] | None = None

    def __call__(self, rows: Sequence[dict]) -> tuple[list[dict], float]:
        """Results of the first rows, each with its number as `NUMBER`, and their time [s]."""
        check_library(self.made_with, "the rows")
        if not (self.out / "meta.json").exists():
            raise WorkerError(f"All workers must see the folder of the rows, but {socket.gethostname()} does not see {self.out}.")
        path = part_file(self.out, self.shard, rows[0][NUMBER])
        if path.exists():
            with contextlib.suppress(PartError):
                lines, seconds = read_part(path, stamp=self.stamp)
                found = {line[NUMBER]: line for line in lines if is_kept(line, self.run.budget)}
                known = takewhile(lambda row: row[NUMBER] in found, rows)
                there = [without_number(found[row[NUMBER]]) for row in known]
                if there:
                    return there, seconds
        log = PartLog(self.out, self.shard, self.stamp)
        results = []
        try:
            for row in rows:
                given = without_number(row)
                (result,), _ = self.run([given])
                log.lines.append({NUMBER: row[NUMBER], **line_of(given, result)})
                results.append(result)
                if time.perf_counter() - log.began > PART_SECONDS:
                    break
            return results, time.perf_counter() - log.began
        finally:  # also on Ctrl-C in this worker
            log.force()


class NumberedRows(dict):
    """Rows by their numbers that carry them, as a `PartTask` takes them."""

    def __getitem__(self, number: int) -> dict:
        return {NUMBER: number, **super().__getitem__(number)}


def gathered(out: Path) -> tuple[list[dict], dict, list[int], list[Path]]:
    """Lines of all parts in the order of their rows, what `meta.json` holds, numbers of the rows that lack, and torn parts.

    Raises
    ------
    RowsError : the folder holds no parts, parts of another sweep, or something that is none of theirs
    """
    kept = read_meta(out / "meta.json")
    if not (isinstance(kept, dict) and isinstance(kept.get("rows"), int) and (out / PARTS).is_dir()):
        raise RowsError(f"A folder to gather must hold the parts of a sweep, but {out} holds none.")
    lines: dict[int, dict] = {}
    torn: list[Path] = []
    stamp = stamp_of(kept)
    for folder in sorted(path for path in (out / PARTS).iterdir() if path.is_dir()):
        found, damaged = lines_of_parts(folder, kept["names"], (), stamp)
        torn += damaged
        take(lines, found)
    strange = next((number for number in lines if not (isinstance(number, int) and 0 <= number < kept["rows"])), None)
    if strange is not None:
        raise RowsError(f"{out / PARTS} holds a row of number {shown(strange)}, which this sweep of {kept['rows']} rows has not.")
    missing = [number for number in range(kept["rows"]) if number not in lines]
    return [without_number(lines[number]) for number in sorted(lines)], kept, missing, torn
