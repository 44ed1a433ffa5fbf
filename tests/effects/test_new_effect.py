"""An effect added to the library by its file and one line of the registry: a toy one, from statics to the studies."""

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from anet_lumped import Cable, Driven, Fixed, Free, Scene, SceneError, equilibrium, load_scene, paths, save_scene, simulate
from anet_lumped.effects import REGISTRY, Gravity
from anet_lumped.model.build import build
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.results.events import BREAK
from studies.questions import effects_cost

G, FILE = 9.81, Path(__file__).parent / "tether.py"


@pytest.fixture
def Tether(monkeypatch):
    """The class of the toy effect, as if its file lay in the library and its line stood in the registry."""
    spec = importlib.util.spec_from_file_location("anet_lumped.effects.tether", FILE)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)
    monkeypatch.setattr(REGISTRY, "classes", REGISTRY.classes | {"tether": "Tether"})
    return REGISTRY["tether"]


def hung(effect, EA=1e3, segments=1, mass=0.2, zeta=0.1, end=None):
    """A metre of cable that hangs from the origin, with a mass at its end and an effect besides its weight."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=EA, zeta=zeta, segments=segments)
    return Scene([end or Fixed("a", (0, 0, 0)), Free("b", mass=mass, at=(0, 0, -1))], [cable], [Gravity(G), effect])


@pytest.mark.parametrize("k", [0.5, 20.0])
def test_statics(Tether, k):
    """A taut cable shares the weight with the tether; with a stiff tether it is slack, and z = -M g/k."""
    rest = equilibrium(hung(Tether(k, points=("b",))))
    weight = 0.25 * G  # of the mass and half of the cable
    taut, slack = -(weight + 1e3) / (k + 1e3), -weight / k
    assert rest.position("b")[2] == pytest.approx(taut if k == 0.5 else slack, abs=1e-9)
    run = simulate(rest.scene, 1.0, method="edmc", dt=0.01, start=rest)
    assert np.abs(run.position("b") - rest.position("b")).max() < 1e-7 and run.ok  # what is at rest stays there


def test_methods_agree_and_the_account_closes(Tether):
    scene = hung(Tether(0.5, anchor=(0.2, 0, -1)), segments=5, end=Driven("a", paths.line((0, 0, 0), (0.3, 0, 0), 0.2)))
    ways = {"edmc": 2e-3, "verlet": 2e-5, "generalised_alpha": 2e-3}
    runs = {way: simulate(scene, 0.6, method=way, dt=dt, save_every=0.02) for way, dt in ways.items()}
    for way, run in runs.items():
        assert run.ok and error_of_steps(run) < 1e-4, way
        np.testing.assert_allclose(run.position("b"), runs["verlet"].position("b"), atol=1e-4)  # of second order at 2 ms
    assert np.ptp(runs["verlet"].position("b")[:, 0]) > 0.05


def test_a_force_that_says_it_is_linear_is_not_looked_at_again(Tether, monkeypatch):
    """A taut cable: the same motion, for fewer evaluations of the forces."""
    scene = hung(Tether(0.5, anchor=(0.2, 0, -1)), segments=5, end=Driven("a", paths.line((0, 0, 0), (0.3, 0, 0), 0.2)))
    linear = simulate(scene, 0.2, method="edmc", dt=1e-3)
    monkeypatch.setattr(Tether, "linear_in_node_state", False)
    build.cache_clear()
    looked = simulate(scene, 0.2, method="edmc", dt=1e-3)
    build.cache_clear()
    np.testing.assert_allclose(looked.q, linear.q, atol=1e-10)  # Newton's tolerance
    assert linear.work.force_evaluations < 0.8 * looked.work.force_evaluations


def test_in_a_scene_file(Tether, tmp_path):
    scene = hung(Tether(2.0, (0.5, 0, 0), ("b",)))
    save_scene(scene, tmp_path / "hung.toml")
    assert "[effects.tether]" in (tmp_path / "hung.toml").read_text() and load_scene(tmp_path / "hung.toml") == scene
    with pytest.raises(SceneError, match=r"`stiffness` must be non-negative and finite \[N/m\], but effect Tether has"):
        Tether(-1.0)


def test_breaks(Tether):
    """The part that falls off goes on with its tether, about its anchor: a mass on a spring."""
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=2, breaking_tension=1.0)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass=0.5)], [cable], [Gravity(G), Tether(20.0, (0, 0, -1), ("b",))])
    start = equilibrium(replace(scene, cables=[replace(cable, breaking_tension=None)]))
    run = simulate(scene, 0.3, method="edmc", dt=1e-3, start=start)
    assert run.ok and run.events[0].kind == BREAK and error_of_steps(run) < 1e-3
    assert run.position("b")[-1, 2] < run.position("b")[0, 2] - 0.05


@pytest.mark.slow
def test_the_study_of_costs_takes_it_up(Tether, monkeypatch):
    monkeypatch.setattr(REGISTRY, "classes", {"gravity": "Gravity", "tether": "Tether"})
    monkeypatch.setattr(effects_cost, "TIMES", {"verlet": 2, "newton": 2})
    table = {row["effect"]: row for row in effects_cost.marginal(1, REGISTRY)[0]}
    assert set(table) == {"none", "gravity", effects_cost.OWN, "tether", "all together"}
    row = table["tether"]
    assert row["entries"] == 3 * 77 and row["more_bytes"] == 8 * (77 + 4 + 2 + 6)  # nodes, numbers, where they are, functions
    assert row["verlet_ns"] > 0 and row["newton_ns"] > 0
