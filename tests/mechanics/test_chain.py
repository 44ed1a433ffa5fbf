"""The linear algebra of a net against a dense solve, and what is solved against the equations of a stage."""

import sys

import naive
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from systems import mesh, nets, scatter
from tried import tried

from anet_lumped import Cable, Fixed, Free, Scene
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.mechanics import residual
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.mechanics.linear import solve
from anet_lumped.mechanics.required_kernels import require_elimination
from anet_lumped.model import fronts, tables
from anet_lumped.model.build import build
from integrators.stage import LAW_AT_END, LAW_BACKWARD, LAW_BETWEEN, Stage

EPS = np.finfo(float).eps
INERTIA = 100.0  # [N/m] of the systems below; 5 g in steps of 10 ms
NETS = {**nets(), "mesh": mesh(6, 7, 2)}
LAWS = {"state": LAW_AT_END, "backward": LAW_BACKWARD, "between": LAW_BETWEEN}


def random_system(model, rng, stiffness, slack=0.2, turn=0.4):
    """A net's arrays with a random linear system: unsymmetric, some segments slack, some without geometric stiffness."""
    net, S = fresh_net(model), model.n_segments
    e = rng.normal(size=(S, 3))
    e /= np.linalg.norm(e, axis=1)[:, None]
    net.segment[:, 0:3], net.segment[:, 3:6] = e, e + rng.uniform(-turn, turn, (S, 3))
    net.segment[:, tables.SEGMENT_GEOMETRIC] = 10.0 ** rng.uniform(-3, 3, S) * rng.integers(0, 2, S)
    net.segment[:, tables.SEGMENT_STIFFNESS] = stiffness * (rng.uniform(size=S) >= slack)
    net.segment[:, tables.SEGMENT_TENSION] = rng.normal(size=S) * (net.segment[:, tables.SEGMENT_STIFFNESS] > 0)
    net.diagonal[:] = INERTIA * (np.eye(3) + rng.uniform(-0.1, 0.1, (model.n_free, 3, 3)))
    net.right_side[: model.n_free] = rng.normal(size=(model.n_free, 3))
    require_elimination(net, 0)
    return net


def check(model, net, stiffness):
    """Solve, and compare with the dense solution.

    An elimination that puts k into a block with the inertia W loses k/W of its digits, so the error may be eps times the
    condition number times 1 + k/W. Measured: at most half of that; four times is allowed.
    """
    right = net.right_side.copy()
    smallest = solve.solve(net.address)
    d, T, condition = naive.dense(model, net, right)
    bound = 4 * EPS * condition * (1 + stiffness / INERTIA)
    np.testing.assert_allclose(net.newton_step, d, rtol=0, atol=bound * np.abs(d).max())
    # a tension is k times a difference of displacements
    np.testing.assert_allclose(net.tension, T, rtol=0, atol=bound * (np.abs(T).max() + stiffness * np.abs(d).max()))
    assert smallest == net.tension.min()


def coupled(model, net, rng, couples, size=3.0):
    """The same system with random blocks [N/m] between nodes that effects join, small against the inertia."""
    S = model.n_segments
    blocks = [size * rng.uniform(-1, 1, (S if couples > reach else 0, 2, 3, 3)) for reach in (0, 1)]
    more = dict(near_blocks=blocks[0], far_blocks=blocks[1], far_factor=np.zeros((len(blocks[1]), 12)))
    net = net._replace(**more, kernels=net.kernels.copy()).addressed()
    require_elimination(net, couples)
    return net


@pytest.mark.each_once
@pytest.mark.parametrize("stiffness", [0.0, 1e1, 1e4, 1e10])
@pytest.mark.parametrize("name", NETS)
def test_solution_of_nodes_that_have_inertia_alone(name, stiffness):
    """Blocks W m I with a mass for each point, and for the nodes of each cable: those of groups are not read."""
    model = build(NETS[name])
    net = random_system(model, np.random.default_rng(5), stiffness)
    mass, W = INERTIA * (1.0 + np.random.default_rng(6).uniform(size=model.n)), 0.7
    for _, count, node, *_ in model.cable.tolist():
        mass[node : node + count - 1] = mass[node] if count > 1 else 0.0
    net.diagonal[:] = W * mass[: model.n_free, None, None] * np.eye(3)
    net = net._replace(mass=mass).addressed()
    require_elimination(net, 0, stiffened=False)
    net.linearised[tables.LINEARISED_W] = W
    right = net.right_side.copy()
    if len(net.cable_groups) and len(net.single_cables) == net.single_kinds[0]:
        unread = net.diagonal.copy()
        net.diagonal[: model.n_interior] = np.nan
        solve.solve(net.address)
        d = net.newton_step.copy()
        assert np.isfinite(d).all()
        net.diagonal[:], net.right_side[:] = unread, right
    check(model, net, stiffness)


@pytest.mark.each_once
@pytest.mark.parametrize("couples", [1, 2])
@pytest.mark.parametrize("stiffness", [0.0, 1e1, 1e4, 1e10])
@pytest.mark.parametrize("name", NETS)
def test_solution_with_couplings(name, stiffness, couples):
    model = build(NETS[name])
    for seed in range(1 if name == "mesh" else 10):
        rng = np.random.default_rng(seed)
        net = coupled(model, random_system(model, rng, stiffness), rng, couples)
        check(model, net, stiffness)


@pytest.mark.parametrize("name", NETS)
def test_couplings_of_nothing_change_nothing(name):
    model, rng = build(NETS[name]), np.random.default_rng(0)
    net = random_system(model, rng, 1e4)
    wide = coupled(
        model,
        net._replace(right_side=net.right_side.copy(), newton_step=net.newton_step.copy(), tension=net.tension.copy()),
        rng,
        2,
        0.0,
    )
    assert solve.solve(net.address) == pytest.approx(solve.solve(wide.address), rel=1e-9, abs=1e-9)
    # both keep what is as large as inertia and tension: 1e-16 times their condition, some 1e3
    np.testing.assert_allclose(wide.newton_step, net.newton_step, atol=1e-11 * np.abs(net.newton_step).max())
    np.testing.assert_allclose(wide.tension, net.tension, atol=1e-10 * np.abs(net.tension).max())


@pytest.mark.each_once
@pytest.mark.parametrize("stiffness", [0.0, 1e1, 1e4, 1e10])
@pytest.mark.parametrize("name", NETS)
def test_solution(name, stiffness):
    model = build(NETS[name])
    for seed in range(1 if name == "mesh" else 10):
        check(model, random_system(model, np.random.default_rng(seed), stiffness), stiffness)


def by_fronts(scene, monkeypatch):
    """Model of a scene whose points are eliminated by fronts, however few they are."""
    model = laid_out(scene, 1, monkeypatch)
    assert len(model.symbolic.fronts.front) > 0 or model.n_free == model.n_interior
    return model


def laid_out(scene, many, patch):
    """Model of a scene if so many points are eliminated by fronts; of what other scenes share, nothing is taken."""
    patch.setattr(fronts, "MANY", many)
    patch.setattr(sys.modules["anet_lumped.model.build"], "_KNOWN", {})
    return build.__wrapped__(scene)


@pytest.mark.each_once
@pytest.mark.parametrize("stiffness", [1e1, 1e10])
@pytest.mark.parametrize("name", NETS)
def test_solution_by_fronts(name, stiffness, monkeypatch):
    model = by_fronts(NETS[name], monkeypatch)
    for seed in range(1 if name == "mesh" else 10):
        check(model, random_system(model, np.random.default_rng(seed), stiffness), stiffness)


@pytest.mark.parametrize("couples", [1, 2])
def test_solution_by_fronts_with_couplings(couples, monkeypatch):
    model, rng = by_fronts(NETS["mesh"], monkeypatch), np.random.default_rng(0)
    check(model, coupled(model, random_system(model, rng, 1e4), rng, couples), 1e4)


def test_fronts_of_a_large_mesh(monkeypatch):
    """A mesh of 30 x 30 points has fronts of a hundred columns and more; blocks one by one are the second method."""
    scene, steps = mesh(30, 30, 1), []
    for many in (1, 10**9):
        model, rng = laid_out(scene, many, monkeypatch), np.random.default_rng(0)
        net = random_system(model, np.random.default_rng(1), 1e3)
        right = dict(zip(sorted(model.node_of), rng.normal(size=(len(model.node_of), 3)), strict=True))
        for name, node in model.node_of.items():
            if node < model.n_free:
                net.right_side[node], net.diagonal[node] = right[name], INERTIA * np.eye(3)
        solve.solve(net.address)
        steps.append(np.array([net.newton_step[model.node_of[name]] for name in sorted(model.node_of)]))
    assert len(model.symbolic.fronts.front) == 0
    np.testing.assert_allclose(steps[0], steps[1], atol=1e-12 * np.abs(steps[1]).max())  # condition of this system: some 1e2


def test_all_segments_slack():
    """Nothing couples the nodes: d = D^-1 r."""
    model = build(NETS["wheel"])
    net = random_system(model, np.random.default_rng(0), 1.0, slack=1.0)
    net.segment[:, tables.SEGMENT_GEOMETRIC] = 0.0
    d = np.linalg.solve(net.diagonal, net.right_side[: model.n_free, :, None])[..., 0]
    solve.solve(net.address)
    np.testing.assert_allclose(net.newton_step[: model.n_free], d, rtol=1e-13)  # 3x3 systems of condition below 2
    assert np.all(net.tension == 0.0)


@st.composite
def random_scenes(draw):
    """Connected or not, with loops, parallel cables and any number of supports."""
    n_points = draw(st.integers(2, 6))
    fixed = draw(st.lists(st.booleans(), min_size=n_points, max_size=n_points))
    ends = st.tuples(st.integers(0, n_points - 1), st.integers(0, n_points - 1)).filter(lambda e: e[0] != e[1])
    links = draw(st.lists(st.tuples(ends, st.integers(1, 4)), min_size=1, max_size=9))
    reached = {p for (a, b), _ in links for p in (a, b)}
    points = [
        Fixed(f"{p}", (0, 0, 0)) if fixed[p] else Free(f"{p}", mass=0.01) for p in range(n_points) if fixed[p] or p in reached
    ]
    cables = [
        Cable(f"{a}", f"{b}", length=1.0, mass_per_length=0.1, EA=1e3, segments=s, name=f"{i}")
        for i, ((a, b), s) in enumerate(links)
    ]
    return Scene(points, cables)


@tried(100)
@given(random_scenes(), st.integers(0, 2**31), st.sampled_from([1.0, 1e3]))
def test_solution_of_any_net(scene, seed, stiffness):
    for many in (fronts.MANY, 1):
        with pytest.MonkeyPatch.context() as patch:
            model = laid_out(scene, many, patch)
        if model.n_free:
            check(model, random_system(model, np.random.default_rng(seed), stiffness), stiffness)


def random_stage(model, law, rng):
    """A stage and its places: segments slack and taut, all nodes moved by up to a fifth of a segment's length."""
    base = scatter(model, rng)
    q, target = (base + rng.normal(size=base.shape) * 0.02 for _ in range(2))
    q[model.n_free :] = base[model.n_free :] + 0.003
    tau = 0.01
    return Stage(LAWS[law], 0.0, 2e4, 0.5 if law == "between" else 1.0, tau, 0.3), base, target, q


@pytest.mark.each_once
@pytest.mark.parametrize("compression", ["none", "damped", "linear"])
@pytest.mark.parametrize("law", LAWS)
def test_residual(law, compression):
    for name, scene in nets(compression=compression, effects=[Gravity(), ViscousDamping(0.7)]).items():
        model = build(scene)
        net = fresh_net(model)
        stage, base, target, q = random_stage(model, law, np.random.default_rng(len(name)))
        norm, scale, noise, _ = residual.residual(stage, base, target, q, net.address)
        r = naive.residual(model, stage, base, target, q)
        # round-off of a sum of forces of up to k L0 and m W L0, a few hundred newtons each
        np.testing.assert_allclose(naive.out_of_balance(model, net), r, atol=1e-12 * 1e3, err_msg=name)
        np.testing.assert_allclose(norm, np.abs(r).max(), rtol=1e-12)
        assert 0 < noise < 1e-9 * scale


def exact_tangent(model, net, law):
    """`naive.operator` with the exact geometric stiffness, T (I - e n^T)/l in place of a I.

    The code takes two liberties that keep every block positive definite: a compressed segment has no geometric stiffness, and
    a e n^T, the strain's part of the axial stiffness, is left out at one time.
    Newton's method then contracts the axial error by T/(k l), the strain, at each iteration instead of quadratically.
    """
    K = np.zeros((model.n, 3, model.n, 3))
    K[: model.n_free, :, : model.n_free] = naive.operator(model, net)
    for s, (i, j) in enumerate(model.ends):
        e, g, a, k, T = naive.segment_law(net, s)
        n = g if law == "between" else e
        per_l = a / net.tension[s] if net.tension[s] > 0 else 0.0
        G = T * per_l * (np.eye(3) - np.outer(e, n)) - a * np.eye(3)
        if law != "state" and k != 0.0:
            G += a * np.outer(e, n)
        for p, q, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
            K[p, :, q] += sign * G
    return K[: model.n_free, :, : model.n_free]


@pytest.mark.each_once
@pytest.mark.parametrize("compression", ["none", "damped", "linear"])
@pytest.mark.parametrize("law", LAWS)
def test_tangent(law, compression):
    """Taylor's remainder |r(q + h d) - r(q) + h K d| falls with h^2, at states that do not change between slack and taut."""
    slopes = []
    for name, scene in nets(compression=compression, effects=[Gravity(), ViscousDamping(0.7)]).items():
        model = build(scene)
        for seed in range(40):
            rng, net = np.random.default_rng(seed), fresh_net(model)
            stage, base, target, q = random_stage(model, law, rng)
            if compression != "none":  # taut, so that no tension is negative where the damper is two-way
                base, q = 3.5 * base, 3.5 * q
            d = rng.normal(size=(model.n_free, 3))
            residual.residual(stage, base, target, q, net.address)
            net.tension[:] = net.segment[:, tables.SEGMENT_TENSION]
            residual.residual(stage, base, target, q, net.address)
            r, K = naive.out_of_balance(model, net), exact_tangent(model, net, law)
            if compression != "none" and net.tension.min() < 0:
                continue

            def state():
                return net.segment[:, tables.SEGMENT_STRETCH] > 0, net.segment[:, tables.SEGMENT_TENSION] > 0  # noqa: B023

            before, remainders, h = state(), [], 10.0 ** -np.arange(3.5, 5.6, 0.5)
            for x in h:
                moved = q.copy()
                moved[: model.n_free] += x * d
                residual.residual(stage, base, target, moved, net.address)
                if not np.array_equal(before, state()):
                    break
                r_x = naive.out_of_balance(model, net)
                remainders.append(np.linalg.norm(r_x - r + x * np.einsum("ixjy,jy->ix", K, d)))
            else:
                slopes.append(np.polyfit(np.log(h), np.log(remainders), 1)[0])
                break
        else:
            raise AssertionError(f"no smooth state found for {name}")
    np.testing.assert_allclose(slopes, 2.0, atol=0.1)
