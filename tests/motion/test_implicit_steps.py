"""What implicit steps cost and how far they are off, whatever the stiffness and the junctions."""

import numpy as np
import pytest
from systems import MU, four_cables, loose_cable

from anet_lumped import (
    Cable,
    Fixed,
    Free,
    Scene,
    State,
    equilibrium,
    load_scene,
    simulate,
)
from anet_lumped.effects import Gravity
from anet_lumped.motion.own_methods import net_and_system
from integrators import schemes
from integrators.marching.fixed_steps import FixedSteps
from integrators.marching.march import March
from integrators.system import HALVINGS, ITERATIONS, STEPS, UNCONVERGED


def test_newton_does_not_feel_stiffness():
    """The loose cable, 10 ms: at most 5 iterations a step at any stiffness, the most at most 1.15 times the fewest."""
    mean = []
    for EA in (1e4, 1e6, 1e8, 1e9):
        run = simulate(loose_cable(EA), 0.6, method="edmc", dt=0.01, start="straight")
        assert run.ok and run.work.halvings == run.work.rejected == 0 and run.work.steps == 60
        mean.append(run.work.newton_iterations / run.work.steps)
    assert max(mean) <= 5.0  # 3.6 measured
    assert max(mean) <= 1.15 * min(mean)


def split_cable(EA):
    """`loose_cable` cut into three cables that meet at free points."""
    made = dict(mass_per_length=MU, EA=EA, zeta=0.05)
    points = [Fixed("a", (0, 0, 0)), *(Free(p, at=(x, 0, 0)) for p, x in (("x", 0.35), ("y", 0.7), ("b", 1.0)))]
    cables = [Cable(p, q, length=0.05 * n, segments=n, **made) for p, q, n in (("a", "x", 7), ("x", "y", 7), ("y", "b", 6))]
    return Scene(points, cables, [Gravity()])


@pytest.mark.parametrize(("EA", "dt"), [(1e4, 0.01), (1e6, 0.01), (1e8, 0.01), (1e9, 0.02)])
def test_free_points_along_a_cable_change_nothing(EA, dt):
    whole, split = (
        simulate(scene, 0.6, method="edmc", dt=dt, save_every=dt, start="straight") for scene in (loose_cable(EA), split_cable(EA))
    )
    shape = np.concatenate([split.shape("a-x"), split.shape("x-y")[:, 1:], split.shape("y-b")[:, 1:]], axis=1)
    assert split.work.newton_iterations <= 1.05 * whole.work.newton_iterations
    # 60 steps of a force error of 1e-6 of the weight, and the whip magnifies
    np.testing.assert_allclose(shape, whole.shape("a-b"), atol=1e-6)


@pytest.mark.parametrize("EA", [1e4, 1e6, 1e8])
def test_many_junctions(EA):
    """A level mesh with loops, held at its corners and let go: no halving at 10 ms, and Newton costs what it does in a cable."""
    at = {(i, j): (i / 3, j / 3, 0.0) for i in range(4) for j in range(4)}
    points = [(Fixed if {*key} <= {0, 3} else Free)(f"{key}", at=x) for key, x in at.items()]
    made = dict(length=0.35, mass_per_length=MU, EA=EA, zeta=0.05, segments=5)
    links = [(a, b) for a in at for b in ((a[0] + 1, a[1]), (a[0], a[1] + 1)) if b in at]
    scene = Scene(points, [Cable(f"{a}", f"{b}", **made) for a, b in links], [Gravity()])
    run = simulate(scene, 0.5, method="edmc", dt=0.01, start="straight")
    assert run.ok and run.work.halvings == 0
    assert run.work.newton_iterations <= 5.0 * run.work.steps  # 4.2 to 4.7 measured


def frame(t):
    """Displacement of the corners: 0.2 m/s after a quintic smoothstep of 1 s."""
    s = np.clip(t, 0.0, 1.0)
    return 0.2 * np.where(t < 1.0, 2.5 * s**4 - 3 * s**5 + s**6, t - 0.5)


def period(run):
    """Mean sway period of p0 about the moving frame once that moves steadily, between the first and the last zero [s]."""
    x = run.position("p0")[:, 0] - frame(run.t)
    k = np.flatnonzero((np.sign(x[:-1]) != np.sign(x[1:])) & (run.t[:-1] > 1.0))
    zeros = run.t[k] - x[k] * (run.t[k + 1] - run.t[k]) / (x[k + 1] - x[k])
    assert len(zeros) >= 5
    return 2 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)


def test_carried_net():
    """The sway period of p0 is the same at 20, 5, 1 and 0.5 ms; at 10 ms its place is right within 0.1 mm for all 4 s."""
    net = four_cables(1e4, carried=True)
    exact = simulate(net, 4.0, method="verlet", dt=5e-5, save_every=0.02)  # 1e-8 m off
    runs = {dt: simulate(net, 4.0, method="edmc", dt=dt, save_every=0.02) for dt in (2e-2, 1e-2, 5e-3, 1e-3, 5e-4)}
    np.testing.assert_allclose([period(run) for run in runs.values()], period(exact), rtol=0.01)  # 0.0014 at most measured
    assert period(exact) == pytest.approx(1.02, abs=0.01)
    off = [np.linalg.norm(run.position("p0") - exact.position("p0"), axis=1).max() for run in runs.values()]
    assert off[1] <= 1e-4  # [m]
    # order 2 in smooth motion: 0.35, 0.087, 0.022 and 0.001 mm; the last one is near Newton's tolerance
    slope = np.polyfit(np.log(list(runs)[:4]), np.log(off[:4]), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize(("share", "left"), [(0.0, 0.0), (0.1, 0.0), (0.4, 0.0), (1.0, 1.0 / 3.0)])
@pytest.mark.parametrize("compression", ["linear", "none", "damped"])
def test_a_stretch_that_the_step_does_not_resolve_is_gone_after_one(compression, share, left):
    """(a - 1/2)/(a + 1/2) of it is left, a = max(share, 1/2): the numerical damper fills c/h = share k up to k/2."""
    h, k, stretch = 0.01, 1e8, 1e-4
    law = dict(length=1.0, mass_per_length=1e-3, EA=k, BA=share * k * h, segments=1, compression=compression)
    scene = Scene([Fixed("top", (0, 0, 0)), Free("tip", mass=1.0)], [Cable("top", "tip", **law)])
    start = State.of(scene, points={"tip": (0.0, 0.0, -1.0 - stretch)})
    run = simulate(scene, h, method="edmc", dt=h, start=start)
    after = -run.position("tip")[-1, 2] - 1.0
    assert after == pytest.approx(left * stretch, abs=1e-3 * stretch)  # 4/(h omega)^2 = 4e-4: what the step resolves


def test_a_failed_step_leaves_the_state_as_it_was():
    """Then a march need not copy each state before a step: of Newton's method without an iteration all parts of a step fail."""
    scene, scheme, dt = load_scene("net_carried"), schemes.scheme("edmc"), 0.01
    assert scheme.undoes_failed_steps and not scheme.needs_copied_start
    rest = equilibrium(scene)
    net, bound = net_and_system(rest.model, scheme, rest.segment_tension)
    parameters, times = scheme.parameters(), FixedSteps(0.0, dt, dt, 0.0, 1)
    parameters[ITERATIONS] = 0.0
    march = March(scheme, bound, net.address, times, rest.model.n, (2, rest.model.n_segments), parameters)
    v = np.random.default_rng(1).normal(size=rest.q.shape) * (np.arange(rest.model.n) < rest.model.n_free)[:, None]
    out = march.march(rest.q, v)
    assert out.status == UNCONVERGED and out.counts[HALVINGS] > 10 and out.counts[STEPS] == 0
    assert np.array_equal(march.state.q, rest.q) and np.array_equal(march.state.v, v)
    assert not march.state.memory[: scheme.carried_rows].any()
