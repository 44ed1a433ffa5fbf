"""Functions that only compiled functions call: linked into their callers, also from the disk, and no machine code by themselves."""

import importlib
import sys

import pytest
from numba import config
from numba.core import types

from integrators import source_stamp
from integrators.jit import internal, njit
from integrators.linked_code import LinkedCode

PARTS = """from integrators.jit import inlined, internal


@internal
def deep(x):
    return x * x


@internal
def halved(x):
    return 0.5 * deep(x)


@inlined
def copied(x):
    return halved(x) + 1.0
"""
CALLER = """from linked.parts import copied, halved
from integrators.jit import njit


@njit("float64(float64)", cache=True)
def caller(x):
    return copied(x) + halved({number})
"""


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A function that imports the parts and a new caller of them as a new process would."""
    folder = tmp_path / "linked"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "parts.py").write_text(PARTS)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # which would not notice two texts within a second
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "cache"))

    def forget():
        source_stamp._read.cache_clear()
        for name in [name for name in sys.modules if name.partition(".")[0] == "linked"]:
            del sys.modules[name]

    def load(number):
        forget()
        (folder / "callers.py").write_text(CALLER.format(number=number))
        return importlib.import_module("linked.callers").caller, importlib.import_module("linked.parts")

    yield load
    forget()
    source_stamp.PACKAGES.discard("linked")


def hits(function):
    """How often a function was loaded from the disk, and how often compiled."""
    return sum(function.stats.cache_hits.values()), sum(function.stats.cache_misses.values())


def test_a_new_caller_links_what_another_process_has_compiled(package):
    caller, parts = package(2.0)
    assert caller(3.0) == 0.5 * 9.0 + 1.0 + 0.5 * 4.0
    assert hits(caller) == hits(parts.halved) == hits(parts.deep) == (0, 1)
    caller, parts = package(2.0)
    assert caller(3.0) == 7.5 and hits(caller) == (1, 0)
    assert hits(parts.halved) == hits(parts.deep) == (0, 0)  # whose code the caller holds
    caller, parts = package(4.0)
    assert caller(3.0) == 0.5 * 9.0 + 1.0 + 0.5 * 16.0 and hits(caller) == (0, 1)
    assert hits(parts.halved) == hits(parts.copied) == (1, 0)


def test_only_its_callers_have_machine_code(package):
    caller, parts = package(2.0)
    engine = caller.targetctx.codegen()._engine
    for function, kind in ((parts.halved, LinkedCode), (parts.copied, LinkedCode), (caller, None)):
        result = function.overloads[(types.float64,)]
        assert isinstance(result.library, LinkedCode) == (kind is LinkedCode)
        assert engine.is_symbol_defined(result.fndesc.llvm_func_name) == (kind is None)


def test_an_error_comes_through_and_what_needs_objects_of_python_is_one():
    @internal
    def fails(x):
        if x < 0.0:
            raise ValueError("negative")
        print("x is", x)
        return x

    @njit()
    def calls(x):
        return fails(x)

    with pytest.raises(ValueError, match="negative"):
        calls(-1.0)
    with pytest.raises(RuntimeError, match="missing Environment"):
        calls(1.0)
