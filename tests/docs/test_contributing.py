"""The worked examples of CONTRIBUTING.md: each file is put where it says, each line of a registry is run, each test passes."""

import importlib
import inspect
import re
import sys
from pathlib import Path

import pytest

from anet_lumped.effects import REGISTRY
from anet_lumped.effects.flow.wind import KINDS
from integrators import schemes
from studies.study import NAMES
from studies.sweeping.measures import MEASURES

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
FILE = re.compile(r"^`(?P<file>[\w/]+\.py)`:\n\n```python\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)
LINE = re.compile(r"^One line.*?in `(?P<file>[\w/]+\.py)`.*?:\n\n```python\n(?P<code>[^\n]+)\n```$", re.MULTILINE | re.DOTALL)
SECTIONS = {title: body for title, _, body in (part.partition("\n") for part in TEXT.split("\n## "))}
ADDED = [title for title in SECTIONS if title.startswith("Add a")]


@pytest.fixture
def restored(tmp_path):
    """Registries, packages and modules are as they were, whatever an example adds to them."""
    registries, names = (REGISTRY.classes, KINDS, MEASURES, schemes.MODULES), list(NAMES)
    before = [dict(registry) for registry in registries]
    paths = {name: list(module.__path__) for name, module in sys.modules.items() if hasattr(module, "__path__")}
    yield
    for registry, entries in zip(registries, before, strict=True):
        registry.clear()
        registry.update(entries)
    NAMES[:] = names
    for name, path in paths.items():
        sys.modules[name].__path__[:] = path
    for name, module in list(sys.modules.items()):
        if str(getattr(module, "__file__", None)).startswith(str(tmp_path)):
            package, _, attribute = name.rpartition(".")
            vars(sys.modules[package]).pop(attribute, None)
            del sys.modules[name]


def put(folder, file, code):
    """Write a file and let its package find it there; return the name of its module."""
    path = folder / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(code, encoding="utf-8")
    package = importlib.import_module(".".join(path.parent.relative_to(folder).parts))
    package.__path__.append(str(path.parent))
    importlib.invalidate_caches()
    return f"{package.__name__}.{path.stem}"


def test_five_things_are_shown():
    assert sorted(title.split()[-1] for title in ADDED) == ["effect", "measure", "scheme", "study", "wind"]


@pytest.mark.parametrize("title", ADDED)
def test_worked_example(title, tmp_path, restored):
    body = SECTIONS[title]
    files = {found["file"]: found["code"] for found in FILE.finditer(body)}
    tests = {file: code for file, code in files.items() if file.startswith("tests/")}
    (line,) = LINE.finditer(body)
    assert len(files) == 2 and len(tests) == 1, "a file and its test"
    names = {}
    for file, code in files.items():
        assert not (ROOT / file).exists(), f"{file} is there already: choose another example"
        if file not in tests:
            names |= vars(importlib.import_module(put(tmp_path, file, code)))
    registry = line["file"].removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    exec(line["code"], names | vars(importlib.import_module(registry)))
    for file, code in tests.items():
        names = {"__name__": Path(file).stem}
        exec(compile(code, file, "exec"), names)
        run = [function for name, function in names.items() if name.startswith("test_")]
        assert run
        for function in run:
            function(**({"tmp_path": tmp_path} if "tmp_path" in inspect.signature(function).parameters else {}))
