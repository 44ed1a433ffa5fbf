"""The study of large nets: what it compares is alike, and its answer follows from its rows."""

import numpy as np
import pandas as pd
import pytest

from anet_lumped import Scene, equilibrium, simulate
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity
from studies.peers import mujoco_flex
from studies.questions import nets
from studies.questions.nets import tables
from studies.questions.nets.junctions import OWN, SUPERLU


@pytest.fixture(scope="module")
def rows():
    """Small nets, and no other engine."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tables, "SIZES", (5, 8))
        patch.setattr(tables, "QUICK_MOVED", 4)
        patch.setattr(tables, "PEERS", ())
        return nets.compute(quick=True)


def test_fronts_and_superlu_solve_the_same_system(rows):
    """Both take one matrix and one right side: a wrong sign or a missing term makes them differ in the first digit."""
    solves = rows["solves"]
    assert set(solves["solver"]) == {OWN, *SUPERLU} and (solves["apart"] < 1e-8).all()
    assert (solves[solves["solver"] != OWN]["apart"] > 0.0).all() and (solves["solve_s"] > 0.0).all()
    assert sorted(set(solves["points"])) == [21, 60]


def test_shorter_steps_are_nearer_to_the_reference(rows):
    own = rows["motions"][rows["motions"]["method"] == "edmc"]["error_mm"].to_numpy()
    assert (np.diff(own) < 0.0).all() and own[-1] < 0.1 * own[0]
    assert (rows["motions"]["status"] == "done").all()


def test_the_answer_says_who_is_cheapest(rows):
    assert "nothing is set beside it" in nets.answer(rows) and set(nets.plot(rows)) == {"sizes", "motions"}
    other = pd.DataFrame({
        "engine": "slow", "setting": "", "method": "m", "error_mm": [0.5, 0.05], "cpu_s": [10.0, 30.0], "status": "done",
    })  # fmt: skip
    own = other.assign(engine=tables.OWN, cpu_s=[0.5, 0.6])
    words = nets.answer(rows | {"motions": pd.concat([own, other])})
    assert "within 1 mm this library takes 0.5 s of the processor, slow 10 s: 20 times as much at the least" in words
    assert set(nets.TABLES) == set(rows)


def test_a_flex_of_taut_twines_moves_as_the_net_does():
    """Both explicit methods are far below their limits; a mass, a stiffness or a gravity that is off shows in millimetres."""
    pytest.importorskip("mujoco")
    scene = tables.hung(4, slack=0.0, knot_mass=0.001)
    start = equilibrium(Scene(scene.points, scene.cables, [Gravity(direction=tables.TILT)]))
    own = simulate(scene, 0.2, method="dop853", rtol=1e-9, start=start, save_every=0.05)
    other = mujoco_flex.run(scene, 0.2, 0.05, start, dt=2e-4, integrator="RK4")
    apart = max(np.linalg.norm(own.position(p.name) - other.position[p.name], axis=1).max() for p in scene.points)
    moved = max(np.ptp(own.position(p.name), axis=0).max() for p in scene.points)
    assert own.segment_tension.min() > 0.0 and other.status == "done"
    assert apart < 1e-6 * moved and moved > 0.01


def test_a_flex_refuses_what_it_would_compute_otherwise():
    with pytest.raises(
        InputError, match=r"takes cables of one segment that are as long as they are drawn, but cable \"p0_0-p1_0\" is not"
    ):
        mujoco_flex.run(tables.hung(3), 0.1, 0.05, dt=1e-3, integrator="RK4")
