"""Rows that are resumed: what was torn is done again, what is damaged is refused by its file and line, and no good row is lost."""

import json
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas
import pytest

from anet_lumped.checks import InputError
from studies.sweeping import row_log
from studies.sweeping.row_log import RowsError, plain
from studies.sweeping.rows import run_rows

DONE = b'"status": "done", "reason": ""'


def square(row):
    return {"square": row["x"] ** 2, "word": "a"}


def rows(out, n=4, resume=False):
    with ThreadPoolExecutor(1) as executor:
        asked = [{"x": x} for x in range(n)]
        return run_rows(
            square, asked, executor=executor, out=out, resume=resume, identity={"scene": {"a": 1}}, columns=["square", "word"]
        )


@pytest.fixture
def folder(tmp_path):
    """Three of four rows, in order."""
    rows(tmp_path, 3)
    log = tmp_path / "rows.jsonl"
    log.write_bytes(b"".join(sorted(log.read_bytes().splitlines(keepends=True), key=lambda line: json.loads(line)["x"])))
    return tmp_path


LINES = {
    "junk": (b"\x80\x81\xff\n", "line 2, is no UTF-8: b'"),
    "NUL": (b"\0" * 50 + b"\n", r"line 2, is no JSON \(Expecting value\)"),
    "words": (b"hello\n", r"line 2, is no JSON \(Expecting value\): b'hello"),
    "two in one": (b'{"x": 1, {"x": 2}\n', "line 2, is no JSON"),
    "deep": (b"[" * 100_000 + b"\n", r"line 2, is nested too deep: b'\[\["),
    "digits": (b'{"x": ' + b"9" * 5000 + b"}\n", "line 2, cannot be read: Exceeds"),
    "a list": (b"[1, 2]\n", r"line 2, is no JSON object: \[1, 2\]"),
    "null": (b"null\n", "line 2, is no JSON object: None"),
    "no status": (b'{"x": 1, "reason": "", "square": 1, "word": "a"}\n', "line 2, lacks 'status'"),
    "no input": (b"{" + DONE + b', "square": 1, "word": "a"}\n', "line 2, lacks 'x'"),
    "no result": (b'{"x": 1, ' + DONE + b', "square": 1}\n', "line 2, lacks 'word'"),
    "a status of numbers": (b'{"x": 1, "status": 3, "reason": ""}\n', "line 2, has status=3, which is no text"),
    "a reason of lists": (b'{"x": 1, "status": "failed", "reason": []}\n', r"line 2, has reason=\[\], which is no text"),
    "a dict": (b'{"x": {}, ' + DONE + b', "square": 1, "word": "a"}\n', "line 2, has 'x'={}, which is no number and no text"),
    "a budget of words": (
        b'{"x": 1, "status": "over budget", "reason": "", "row_budget": "1 s"}\n',
        "line 2, has row_budget='1 s', which is no number",
    ),
    "another type": (b'{"x": 1, ' + DONE + b', "square": "one", "word": "a"}\n', "has square=0 in line 1 and 'one' in line 2"),
    "a huge number": (b'{"x": 1, ' + DONE + b', "square": ' + b"9" * 30 + b', "word": "a"}\n', "has square=0 in line 1 and 999"),
    "another input": (
        b'{"x": "1", ' + DONE + b', "square": 1, "word": "a"}\n',
        "holds 1 rows that are not asked for now, the first",
    ),
}


@pytest.mark.parametrize("kind", LINES)
def test_a_damaged_line_is_named_and_nothing_is_lost(folder, kind):
    damaged, message = LINES[kind]
    log = folder / "rows.jsonl"
    first, _, third = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(first + damaged + third)
    with pytest.raises(RowsError, match=message):
        rows(folder, resume=True)
    assert log.read_bytes() == first + damaged + third
    log.write_bytes(first + third)
    assert rows(folder, resume=True)["square"].tolist() == [0, 1, 4, 9]


@pytest.mark.parametrize("tail", [b'{"x": 3, "sta', b"\0" * 4096, b"\xff\xfe"])
def test_a_torn_line_is_done_again_in_a_word(folder, tail):
    log = folder / "rows.jsonl"
    whole = log.read_bytes()
    log.write_bytes(whole + tail)
    with pytest.warns(UserWarning, match=r"rows\.jsonl, line 4, was torn: its row is done again"):
        assert rows(folder, resume=True)["square"].tolist() == [0, 1, 4, 9]
    assert log.read_bytes().startswith(whole) and log.read_bytes().count(b"\n") == 4


@pytest.mark.parametrize(
    "edit",
    [lambda text: text[:-1], lambda text: b"\xef\xbb\xbf" + text, lambda text: text.replace(b"\n", b"\r\n"), lambda text: text * 2],
    ids=["last line without its end", "byte-order mark", "lines of Windows", "twice"],
)
def test_good_rows_are_kept_however_they_are_laid_out(folder, edit, monkeypatch):
    log = folder / "rows.jsonl"
    log.write_bytes(edit(log.read_bytes()))
    done = []
    monkeypatch.setattr(
        row_log.RowLog,
        "append",
        lambda self, number, line, append=row_log.RowLog.append: (done.append(line), append(self, number, line)),
    )
    assert rows(folder, resume=True)["square"].tolist() == [0, 1, 4, 9]
    assert [line["x"] for line in done] == [3]
    for line in log.read_text(encoding="utf-8-sig").splitlines():
        json.loads(line)


def test_an_empty_log_is_begun_anew(folder):
    (folder / "rows.jsonl").write_bytes(b"")
    (folder / "meta.json").write_text("")
    assert rows(folder)["square"].tolist() == [0, 1, 4, 9]


METAS = {
    "empty": (b"", r"meta\.json is no JSON"),
    "junk": (b"\xff\x00", r"meta\.json is no UTF-8"),
    "no identity": (b"{}", r"to resume .*rows\.jsonl, but .*meta\.json does not say it"),
    "a list": (b"[1]", r"meta\.json does not say it"),
    "an identity of another type": (b'{"identity": "x"}', r"meta\.json does not say it"),
    "a scene of another type": (b'{"identity": {"scene": 3}}', r"another sweep: scene was 3 and is \{'a': 1\}"),
    "one more key": (b'{"identity": {"scene": {"a": 1, "b": null}}}', r"another sweep: scene\.b was None and is not given"),
}


@pytest.mark.parametrize("kind", METAS)
def test_what_rows_were_made_with_must_be_known(folder, kind):
    text, message = METAS[kind]
    (folder / "meta.json").write_bytes(text)
    with pytest.raises(RowsError, match=message):
        rows(folder, resume=True)


def test_without_a_meta_file_nothing_is_resumed(folder):
    (folder / "meta.json").unlink()
    with pytest.raises(RowsError, match=r"meta\.json does not say it"):
        rows(folder, resume=True)


@pytest.mark.parametrize("name", ["rows.jsonl", "meta.json"])
@pytest.mark.parametrize("kind", ["folder", "pipe", "device"])
def test_what_is_no_file_is_refused_and_not_waited_for(folder, name, kind):
    path = folder / name
    path.unlink()
    make = {"folder": path.mkdir, "pipe": lambda: os.mkfifo(path), "device": lambda: path.symlink_to("/dev/zero")}
    make[kind]()
    with pytest.raises(RowsError, match=f"must hold files, but .*{name} is none"):
        rows(folder, resume=True)


def test_a_pipe_in_place_of_the_meta_file_is_not_written_to(tmp_path):
    os.mkfifo(tmp_path / "meta.json")
    with pytest.raises(RowsError, match=r"must hold files, but .*meta\.json is none"):
        rows(tmp_path)


def test_a_log_that_cannot_be_read_or_written_is_named(folder, monkeypatch):
    def refuse(*arguments):
        raise PermissionError(13, "Permission denied")

    with (
        monkeypatch.context() as patched,
        pytest.raises(RowsError, match=r"must be readable, but .*rows\.jsonl: Permission denied"),
    ):
        patched.setattr("pathlib.Path.read_bytes", refuse)
        rows(folder, resume=True)
    monkeypatch.setattr(row_log.RowLog, "force", refuse)
    monkeypatch.setattr(row_log, "FORCED_AFTER", -1.0)
    with pytest.raises(OSError, match=r"Permission denied: '.*rows\.jsonl'"):
        log = row_log.RowLog(folder / "rows.jsonl", 0)
        log.append(0, {})


def test_a_log_that_is_too_large_is_refused(folder, monkeypatch):
    monkeypatch.setenv("ANET_LUMPED_MOST_BYTES", "100")
    with pytest.raises(InputError, match=r"To read .*rows\.jsonl would take \d+ bytes"):
        rows(folder, resume=True)


@pytest.mark.parametrize("values", [[1, True], [1.5, "auto"], [10**30, 1], ["\ud800", "b"], [[1], 2]], ids=repr)
def test_columns_of_any_values_reach_the_disk(tmp_path, values):
    with ThreadPoolExecutor(1) as executor:
        run_rows(lambda row: {"y": values[row["x"]]}, [{"x": 0}, {"x": 1}], executor=executor, out=tmp_path)
    assert (
        pandas.read_parquet(tmp_path / "rows.parquet")["y"].tolist() == [str(plain(value)) for value in values] or values[1] == "b"
    )


def test_plain_values_are_those_of_json():
    assert plain({"a": np.float64(1.5), "b": np.arange(2), "c": (1,), "d": "\udcff"}) == {"a": 1.5, "b": [0, 1], "c": [1], "d": "?"}
