"""The arrows of the design: studies -> anet_lumped -> integrators, and what an import must not load."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from anet_lumped.effects import REGISTRY

ROOT = Path(__file__).parents[1]
PACKAGES = ("studies", "anet_lumped", "integrators")  # each may import those after it
SHARED = {"effect", "signatures", "laws", "flow", "fluid_on_bodies", "vortex_shedding", "shapes"}  # what effects may share
OUTSIDE = {"effects", "checks", "compiled", "prescribed", "regular_files"}  # what they may import of the rest


def modules(package):
    return sorted(path for path in (ROOT / package).rglob("*.py"))


def imported(path):
    """Absolute names of all modules that a file imports, anywhere in it."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            module = ".".join([*base, *([node.module] if node.module else [])])
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)


def test_every_package_is_installed():
    """The build takes every folder whose name fits and that has an `__init__.py`."""
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]["find"]["include"]
    assert set(listed) == {f"{package}*" for package in PACKAGES}
    for path in (path for package in PACKAGES for path in modules(package)):
        assert (path.parent / "__init__.py").exists(), f"{path.parent} needs an __init__.py"


@pytest.mark.parametrize("package", PACKAGES)
def test_arrows(package):
    forbidden = PACKAGES[: PACKAGES.index(package)]
    assert modules(package)
    for path in modules(package):
        for name in imported(path):
            assert name.split(".")[0] not in forbidden, f"{path.relative_to(ROOT)} imports {name}"


@pytest.mark.parametrize("package", PACKAGES)
def test_all_that_is_compiled_goes_through_one_decorator(package):
    """`integrators.jit.njit`, which minds threads, Ctrl-C and what is on the disk."""
    for path in modules(package):
        if path.relative_to(ROOT).as_posix() != "integrators/jit.py":
            assert not {"numba.njit", "numba.jit", "numba.cfunc", "numba.vectorize"} & {*imported(path)}, path


def test_refused_inputs_are_told_by_their_class():
    """What raises a bare ValueError could not be told from a mistake in the code."""
    for path in modules("anet_lumped"):
        raised = (node.exc for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Raise))
        assert "ValueError" not in [getattr(getattr(error, "func", error), "id", None) for error in raised], path.name


@pytest.mark.parametrize("word", ["cable", "scene", "tension", "gravity"])
def test_integrators_know_nothing_of_cables(word):
    """No name in their code, beyond what docstrings and comments say."""
    for path in modules("integrators"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [getattr(node, field, None) for field in ("id", "attr", "name", "arg")]
            assert not any(isinstance(name, str) and word in name.lower() for name in names), f"{path.name}: {names}"


def test_no_effect_knows_another():
    """Nor the scene, the model or the integrator; nor do the laws and flows that effects share, and what effects have in common."""
    files = [path for path in modules("anet_lumped/effects") if "own" not in path.parts and path.name != "__init__.py"]
    assert {path.stem for path in files} >= {*REGISTRY.library, *SHARED - {"laws", "flow", "shapes"}}
    for path in files:
        for name in imported(path):
            parts = name.split(".")
            assert parts[0] != "integrators", f"{path.name} imports {name}"
            if parts[:2] == ["anet_lumped", "effects"] and len(parts) > 2:
                assert parts[2] in SHARED or (path.stem == "effect" and parts[2] == "kernel_checks"), f"{path.name} imports {name}"
            elif parts[0] == "anet_lumped":
                assert parts[1] in OUTSIDE, f"{path.name} imports {name}"


def test_the_contract_of_effects_needs_no_compiler():
    """Nor does an effect without compiled functions. The package itself is left out: it imports `simulate`."""
    code = (
        "import sys, types; package = types.ModuleType('anet_lumped'); package.__path__ = ['anet_lumped']\n"
        "sys.modules['anet_lumped'] = package\n"
        "from dataclasses import dataclass\n"
        "from anet_lumped.effects import REGISTRY, Effect\n"
        "from anet_lumped.effects.effect import STRAIN, LengthChange\n"
        "class Shrinking(Effect):\n"
        "    def length_changes(self, scene):\n"
        "        return [LengthChange('a-b', STRAIN, 1.0, -1e-3)]\n"
        "REGISTRY['shrinking'] = dataclass(frozen=True)(Shrinking)\n"
        "assert REGISTRY.name_of(Shrinking()) == 'shrinking'\n"
        "print([name for name in ('numba', 'llvmlite', 'numpy', 'scipy', 'pandas') if name in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert out.stdout.strip() == "[]"


STATEMENTS = (  # each may have imported what those before it have
    "import anet_lumped",
    "from anet_lumped import *",
    "import anet_lumped.effects, anet_lumped.prescribed.paths, anet_lumped.motion.simulate, anet_lumped.motion.stability",
)
HEAVY = ("jax", "diffrax", "matplotlib", "pandas", "xarray", "jinja2", "typer", "pyarrow", "pytest", "studies")


@pytest.fixture(scope="module")
def loaded():
    """Packages among `HEAVY` that one process has loaded after each of `STATEMENTS`."""
    code = "".join(f"{statement}\nprint([m for m in {HEAVY} if m in sys.modules])\n" for statement in STATEMENTS)
    out = subprocess.run([sys.executable, "-c", f"import sys\n{code}"], capture_output=True, text=True, check=True, cwd=ROOT)
    return dict(zip(STATEMENTS, out.stdout.splitlines(), strict=True))


@pytest.mark.parametrize("statement", STATEMENTS)
def test_what_an_import_loads(loaded, statement):
    """None of the heavy packages that nothing needs before it is asked for."""
    assert loaded[statement] == "[]"


def test_public_face():
    import anet_lumped

    for name in ("Cable", "Driven", "Fixed", "Free", "Scene", "catenary", "equilibrium", "simulate"):
        assert name in anet_lumped.__all__ and callable(getattr(anet_lumped, name))
