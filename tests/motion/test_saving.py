"""What a run saves and counts, what it chooses, and that it is the same from a disk."""

import math

import numpy as np
import pytest
from small_net import small_net
from systems import four_cables, loose_cable

from anet_lumped import (
    load_run,
    load_scene,
    simulate,
)
from anet_lumped.motion.choice import _cheaper
from anet_lumped.motion.simulate import StabilityWarning
from integrators import schemes
from integrators.schemes import dirk, edmc


def test_saving():
    net = loose_cable(1e2)
    run = simulate(net, 0.1, method="edmc", dt=0.03, start="straight")
    np.testing.assert_allclose(run.t, [0.0, 0.03, 0.06, 0.09, 0.1], rtol=1e-15)  # the last step is shortened
    assert run.work.steps == 4
    run = simulate(net, 0.1, method="edmc", dt=0.01, save_every=0.04, start="straight")
    np.testing.assert_allclose(run.t, [0.0, 0.04, 0.08, 0.1], rtol=1e-15)
    run = simulate(net, 1.0, method="verlet", dt=1e-4, start="straight")
    assert 390 <= len(run.t) <= 410 and run.t[-1] == 1.0 and run.work.steps == 10_000
    assert run.q.shape == (len(run.t), 21, 3) == run.v.shape and run.energy.shape == (len(run.t), 7)
    run = simulate(net, 0.3, save_every=0.1, start="straight")  # a step that fits what is saved
    np.testing.assert_allclose(run.t, [0.0, 0.1, 0.2, 0.3], rtol=1e-12)


def test_work_counts():
    """Forces and factorisations are counted where they are made; a wrong count would hide a wrong Jacobian."""
    net, n = loose_cable(1e2), 50
    explicit = ("symplectic_euler", "verlet", "rk4", "dop853")
    work = {m: simulate(net, n * 1e-3, method=m, dt=1e-3, start="straight").work for m in explicit}
    assert [w.force_evaluations for w in work.values()] == [n + 1, n + 1, 4 * n + 1, 12 * n + 1]
    assert all(w.steps == n and w.newton_iterations == w.factorisations == w.rejected == 0 for w in work.values())
    for method in schemes.names(own=True, explicit=False):
        work = simulate(net, n * 1e-3, method=method, dt=1e-3, start="straight").work
        stages = 2 if method in ("sdirk2", "tr_bdf2") else 1
        account = {dirk.step: n * stages, edmc.step: 0}.get(
            schemes.scheme(method).step, n
        )  # of powers: at each stage, or at the end
        forces = 1 + n * stages + account  # one for the first residual of each
        again = work.force_evaluations - forces  # one after each iteration that is not known to leave nothing
        assert work.steps == n and work.halvings == 0 and 0 <= again <= work.newton_iterations
        if method not in ("edmc", "backward_euler"):
            assert again == work.newton_iterations
        assert 1 * n * stages <= work.newton_iterations <= 4 * n * stages  # small steps: two each, and a few slack ones
        assert work.newton_iterations <= work.factorisations <= 2 * work.newton_iterations


def test_method_and_step_are_chosen():
    soft, stiff = (simulate(four_cables(EA), 0.02) for EA in (2e1, 1e9))
    assert (soft.method, stiff.method) == ("verlet", "edmc")
    for run in (soft, stiff):
        assert run.ok and run.reason.startswith(run.method) and "times cheaper" in run.reason and "stable to" in run.reason
    assert simulate(four_cables(1e2), 0.02, dt=1e-4).method == "verlet"
    beyond = simulate(four_cables(1e3), 0.02, dt=1e-2)
    assert beyond.method == "edmc" and "beyond the stable step of verlet" in beyond.reason
    assert simulate(four_cables(1e3), 0.02, rtol=1e-4).method == "edmc"


def test_shapes_and_points_of_a_run():
    scene = small_net()
    run = simulate(scene, 0.05, method="edmc", dt=0.01, start="straight")
    last = run.final
    for cable in scene.cables:
        shape = run.shape(cable.name)
        assert shape.shape == (len(run.t), cable.segments + 1, 3)
        np.testing.assert_array_equal(shape[:, 0], run.position(cable.start))
        np.testing.assert_array_equal(shape[:, -1], run.position(cable.end))
        np.testing.assert_array_equal(last.tension(cable.name), run.tension(cable.name)[-1])
        assert last.length(cable.name) == pytest.approx(run.length(cable.name)[-1], rel=1e-15)  # sums in another order
    assert last.t == run.t[-1] and last.scene == scene
    np.testing.assert_array_equal(last.velocity("x"), run.velocity("x")[-1])


@pytest.mark.parametrize("kind", ["fixed", "adaptive", "diverged"])
def test_a_run_on_disk(tmp_path, kind):
    if kind == "diverged":
        with pytest.warns(StabilityWarning):
            run = simulate(small_net(), 1.0, method="verlet", dt=0.03, start="straight")
        assert run.status == "diverged"
    else:
        run = simulate(small_net(), 0.2, start="straight", **({"rtol": 1e-5} if kind == "adaptive" else {"dt": 1e-3}))
    run.save(tmp_path / "run.nc")
    again = load_run(tmp_path / "run.nc")
    for field in ("t", "q", "v", "energy"):
        np.testing.assert_array_equal(getattr(again, field), getattr(run, field))
    for field in (
        "method", "dt", "reason", "status", "message", "work", "error_estimate", "wall_time", "warnings", "scene", "ok",
        "energy_balance",
    ):  # fmt: skip
        assert getattr(again, field) == getattr(run, field), field
    np.testing.assert_array_equal(again.error, run.error)
    np.testing.assert_array_equal(again.tension("a-x"), run.tension("a-x"))
    np.testing.assert_array_equal(again.final.q, run.final.q)


def test_a_reason_says_which_is_cheaper_and_why_a_step_was_shortened():
    run = simulate(load_scene("net_carried"), 0.04, save_every=0.02)
    assert "edmc: about 15 times cheaper than verlet here (edmc with steps of 0.00998 s" in run.reason
    assert "; shortened to 6.67 ms to meet save_every" in run.reason and run.dt <= 0.02 / 3 * (1 + 1e-12)
    costs = {"verlet": 2.0, "edmc": 6.0}
    assert _cheaper("verlet", costs) == "about 3 times cheaper than edmc here"
    assert _cheaper("edmc", costs) == "verlet is about 3 times cheaper here"
    assert _cheaper("edmc", costs | {"verlet": math.inf}) == "verlet has no stable step here"
