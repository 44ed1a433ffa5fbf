"""Compiled code on the disk: stamped with all that it was made of, and compiled anew where it cannot be read."""

import importlib
import logging
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from numba import config

from integrators import kept_code, source_stamp

ROOT = Path(__file__).parents[2]
TOY = {  # a package whose function is made of four files; it does not import the last
    "__init__.py": "",
    "numbers.py": "TWO = 2.0\n",
    "deep/__init__.py": "",
    "deep/parts.py": "from integrators.jit import internal\n\nfrom ..numbers import (  # a comment\n    TWO as FACTOR,\n)\n\n\n"
    "@internal\ndef scaled(x):\n    return FACTOR * x\n",
    "kernels.py": "import toy.deep.parts as parts\nfrom integrators.jit import njit\n\nscaled = parts.scaled\n\n\n"
    '@njit("float64(float64)", cache=True)\ndef kernel(x):\n    return scaled(x) + 1.0\n\n\n'
    "@njit(cache=True)\ndef plain(x):\n    return x + x\n",
    "other.py": "",
}


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """The folder of the toy package, and a function that imports it as a new process would."""
    folder = tmp_path / "toy"
    for name, text in TOY.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # which would not notice two texts within a second
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(kept_code, "_told", set())

    def forget():
        source_stamp._read.cache_clear()
        for name in [name for name in sys.modules if name.partition(".")[0] == "toy"]:
            del sys.modules[name]

    def load():
        forget()
        return importlib.import_module("toy.kernels")

    yield folder, load
    forget()
    source_stamp.PACKAGES.discard("toy")


def loads(function):
    """How often a function was loaded from the disk, and how often compiled."""
    return sum(function.stats.cache_hits.values()), sum(function.stats.cache_misses.values())


@pytest.mark.parametrize(
    ("file", "text", "value", "found"),
    [
        ("other.py", "ELSE = 1\n", 7.0, (1, 0)),
        ("numbers.py", "TWO = 3.0\n", 10.0, (0, 1)),
        ("deep/parts.py", TOY["deep/parts.py"].replace("FACTOR * x", "-FACTOR * x"), -5.0, (0, 1)),
        ("kernels.py", TOY["kernels.py"].replace("+ 1.0", "+ 2.0"), 8.0, (0, 1)),
    ],
)
def test_code_is_compiled_anew_when_a_file_changes_that_it_was_made_of(toy, file, text, value, found):
    folder, load = toy
    assert load().kernel(3.0) == 7.0
    (folder / file).write_text(text)
    kernel = load().kernel
    assert kernel(3.0) == value and loads(kernel) == found


def test_what_a_file_imports(toy):
    _, load = toy
    load()
    read = source_stamp._read
    assert read("toy.deep.parts")[1] == ["integrators.jit", "toy.numbers"]
    assert read("toy.kernels")[1] == ["toy.deep.parts", "integrators.jit"]
    assert read("numpy.random") is None or "numpy" not in source_stamp.PACKAGES
    assert source_stamp.source_stamp("no_module_of_that_name") == b""
    source_stamp.PACKAGES.discard("no_module_of_that_name")


def emptied(path):
    path.write_bytes(b"")


def junk(path):
    path.write_bytes(bytes(range(256)) * 4)


def cut_in_half(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def zeroed(path):
    """As a journal without data leaves it: of the same size."""
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2] + bytes(len(data) - len(data) // 2))


def one_byte_off(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


@pytest.mark.each_once
@pytest.mark.parametrize("damage", [emptied, junk, cut_in_half, zeroed, one_byte_off])
@pytest.mark.parametrize("kind", ["nbi", "nbc"])
def test_what_cannot_be_read_is_compiled_anew(toy, caplog, kind, damage):
    _, load = toy
    load()
    (file,) = (Path(config.CACHE_DIR)).rglob(f"kernels.kernel-*.{kind}")
    damage(file)
    kernel = load().kernel
    assert kernel(3.0) == 7.0 and loads(kernel) == (0, 1)
    lines = [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]
    assert len(lines) <= 1 and all("cannot be read" in line and "compiled anew" in line for line in lines)
    assert lines or (kind, damage) == ("nbi", one_byte_off)  # which may only look out of date
    assert loads(load().kernel) == (1, 0)


def test_code_of_another_signature_is_not_taken(toy):
    """Two processes that compile a function for different types may both call their file the first."""
    _, load = toy
    plain = load().plain
    assert (plain(1.5), plain(2)) == (3.0, 4)
    first, second = sorted(Path(config.CACHE_DIR).rglob("kernels.plain-*.nbc"))
    shutil.copy(first, second)
    plain = load().plain
    assert (plain(1.5), plain(2)) == (3.0, 4) and isinstance(plain(2), int) and loads(plain) == (1, 1)


def test_code_of_an_older_text_is_not_taken(toy):
    """A process that is killed between its two files leaves a new index and old code."""
    folder, load = toy
    load()
    (code,) = Path(config.CACHE_DIR).rglob("kernels.kernel-*.nbc")
    old = code.read_bytes()
    (folder / "numbers.py").write_text("TWO = 3.0\n")
    load()
    code.write_bytes(old)
    assert load().kernel(3.0) == 10.0


def test_where_nothing_can_be_written_a_line_says_what_to_set(toy, tmp_path, monkeypatch, caplog):
    folder, load = toy
    (tmp_path / "file").write_text("")
    (folder / "__pycache__").write_text("")
    (folder / "deep" / "__pycache__").write_text("")
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "file" / "cache"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    module = load()
    assert (module.kernel(3.0), module.plain(2)) == (7.0, 4)
    (line,) = (record.getMessage() for record in caplog.records)
    assert "cannot be kept" in line and "set the environment variable NUMBA_CACHE_DIR" in line and len(line) < 300


def test_what_is_there_is_read_where_nothing_can_be_written(toy, monkeypatch):
    _, load = toy
    load()
    monkeypatch.setattr(kept_code._Location, "_locator_classes", (kept_code._Unwritable,))
    assert loads(load().kernel) == (1, 0)


@pytest.mark.slow
def test_two_processes_that_compile_at_once(toy):
    """Into one empty folder, each for other types first."""
    folder, _ = toy
    code = "import sys; from toy.kernels import kernel, plain; first = {}; print(kernel(3.0), [plain(x) for x in first], plain(1j))"
    environment = {"NUMBA_CACHE_DIR": config.CACHE_DIR, "PYTHONPATH": f"{folder.parent}:{ROOT}"}
    for _ in range(2):  # the second time from what both have left
        started = [
            subprocess.Popen([sys.executable, "-c", code.format(first)], env=environment, stdout=subprocess.PIPE, text=True)
            for first in ("[1.5, 2]", "[2, 1.5]")
        ]
        assert [process.communicate()[0].strip() for process in started] == ["7.0 [3.0, 4] 2j", "7.0 [4, 3.0] 2j"]
