"""What effects cost: every effect has an example, one that a scene lacks is not even imported, and the study counts right."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from anet_lumped.effects import REGISTRY
from studies.questions import effects_cost
from studies.questions.effects_cost import OWN, entries, memory, plain

ROOT = Path(__file__).parents[2]
SCENES = ((), ("Gravity",), ("Gravity", "Air"))  # each has the effects of the one before it and another one
FEWER = {"QUICK_TURNS": 2, "QUICK_PROCESSES": 1, "TURNS_A_PROCESS": 2, "TIMES": {"verlet": 200, "newton": 5}}
CODE = f"""
import json, sys
import anet_lumped, anet_lumped.effects
from anet_lumped import Cable, Fixed, Free, Scene, simulate

def tell():
    print(json.dumps([name for name in sys.modules if name.startswith("anet_lumped.")]))

tell()
cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=4, diameter=0.01, zeta=0.05)
for names in {SCENES}:
    effects = [getattr(anet_lumped.effects, name)() for name in names]
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", at=(1, 0, 0))], [cable], effects)
    for method, dt in (("edmc", 0.01), ("verlet", 1e-4)):
        assert simulate(scene, 0.05, start="equilibrium" if names else "straight", method=method, dt=dt).ok
    tell()
"""


@pytest.fixture(scope="module")
def imported():
    """Names of the library's modules that one process has imported: at first, and after runs of each of `SCENES`."""
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return dict(zip(("library", *SCENES), map(json.loads, done.stdout.splitlines()), strict=True))


def effects_among(modules):
    """Effects of the library whose modules are among these."""
    return {name for name in REGISTRY.library if f"anet_lumped.effects.{name}" in modules}


@pytest.mark.parametrize("names", SCENES)
def test_a_scene_imports_no_effect_that_it_lacks(imported, names):
    """Through statics, an implicit and an explicit run; nor what effects of one's own and the audit of effects need."""
    assert effects_among(imported[names]) == {name.lower() for name in names}
    others = {"anet_lumped.effects.own.decorators", "anet_lumped.compiled.dual", "anet_lumped.advice.effect_audit"}
    assert others.isdisjoint(imported[names])


def test_the_library_imports_no_effect(imported):
    assert effects_among(imported["library"]) == set()


@pytest.fixture(scope="module")
def rows():
    """The quick study, from few turns and processes, as what is timed is no matter here."""
    known = REGISTRY.classes
    with pytest.MonkeyPatch.context() as patch:
        for name, fewer in FEWER.items():
            patch.setattr(effects_cost, name, fewer)
        found = effects_cost.compute(quick=True)
    assert REGISTRY.classes is known
    return found


@pytest.mark.slow
def test_each_effect_alone_and_all_together(rows, monkeypatch):
    """Two turns of all effects, as what is timed is no matter here; the quick study has some effects."""
    monkeypatch.setattr(effects_cost, "TIMES", FEWER["TIMES"])
    assert set(effects_cost.QUICK_EFFECTS) < set(rows["marginal"]["effect"])
    table = pd.DataFrame(effects_cost.marginal(2, REGISTRY.library)[0]).set_index("effect")
    assert list(table.index) == ["none", "gravity", OWN, *[name for name in REGISTRY.library if name != "gravity"], "all together"]
    assert (table[["verlet_ns", "newton_ns"]] > 0).all(axis=None) and np.isfinite(table.memory_bytes).all()
    more, together = table.more_bytes, table.loc["all together"]
    assert (more.drop("none") > 0).all() and together.memory_bytes == max(table.memory_bytes)
    # g and the masses of 77 moving nodes, what tells where they are, and the addresses of six functions
    assert more["gravity"] == 8 * (3 + 77 + 2 + 6)
    # a rate of every moving node's mass on the diagonal; weight changes nothing of the matrix
    assert table.entries["viscous_damping"] == 3 * 77 and table.entries["gravity"] == table.entries[OWN] == 0
    # what all touch is what each does
    assert together.entries == table.entries.drop("all together").sum()
    assert 0 < table.entries["ground"] < 9 * 77 and table.entries["air"] > 9 * 77


@pytest.mark.slow
def test_a_library_without_other_effects_is_the_same(rows):
    table = rows["libraries"].groupby("library").first()
    assert set(table.index) == set(effects_cost.QUICK_LIBRARIES) and rows["libraries"].memory_bytes.nunique() == 1
    assert (rows["libraries"]["effects_imported"] == "gravity").all()
    assert all(found.pairs == FEWER["QUICK_PROCESSES"] for found in effects_cost.ratios(rows["libraries"]).values())


@pytest.mark.slow
def test_a_library_whose_effects_are_all_imported():
    (row, *_) = [row for row in effects_cost.libraries(1, ("imported",))]
    assert row["effects_imported"].split() == list(REGISTRY.library) and row["verlet_ns"] > 0 and row["newton_ns"] > 0


def test_a_library_that_dies_is_told(monkeypatch):
    dies = [sys.executable, "-c", "input(); raise SystemExit(1)"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    monkeypatch.setattr(effects_cost, "_process", lambda library: subprocess.Popen(dies, **pipes))
    with pytest.raises(RuntimeError, match="The process with the whole library ended; its error is above"):
        effects_cost.libraries(1, ("whole",))


@pytest.mark.slow
def test_answer_and_figure(rows, tmp_path):
    words = effects_cost.answer(rows)
    assert "takes the same memory with the whole library and none of the other effects" in words
    assert "imports gravity only" in words and "viscous damping" in words
    for drawing in effects_cost.plot(rows).values():
        drawing.figure.savefig(tmp_path / "figure.svg")


def test_nothing_is_kept_for_an_effect_that_is_not_there():
    scene = plain()
    from dataclasses import replace

    bare = replace(scene, effects=())
    with_air = replace(scene, effects=(*scene.effects, REGISTRY["air"].example(scene)))
    assert memory(bare) < memory(scene) < memory(with_air)
    assert entries(scene, scene.effects[0]) == 0
