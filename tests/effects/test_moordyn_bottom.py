"""MoorDyn's bottom: its law from the equation, derivatives, the energy of a step, and MoorDyn itself beside it."""

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, State, rod_body, simulate
from anet_lumped.effects import Gravity, MoordynBottom, moordyn_bottom
from anet_lumped.files.moordyn_file import deck_from_text
from anet_lumped.model.build import build
from studies.peers.moordyn import silence, state_file
from studies.peers.problem import problem

D, LENGTH, SEGMENTS = 0.01, 1.0, 10
LAW = MoordynBottom(0.1, 1e5, 1e3, 0.7, 30.0)  # mu D = 21 N s/m: half of the nodes below slide at their limit, half do not


def lying(effect, **points):
    """A metre of cable that nothing holds."""
    cable = Cable("a", "b", length=LENGTH, mass_per_length=0.1, EA=1e4, zeta=0.5, segments=SEGMENTS, diameter=D)
    return Scene([points.get("a", Free("a", at=(0, 0, 0))), Free("b", at=(1, 0, 0))], [cable], [Gravity(9.81), effect])


def scattered(seed=0):
    """Model and table of a cable about the plane, places and velocities."""
    scene, rng = lying(LAW), np.random.default_rng(seed)
    model = build(scene)
    return model, *LAW.table(model), 0.08 + 0.02 * rng.normal(size=(model.n, 3)), 3.0 * rng.normal(size=(model.n, 3))


def naive(model, q, v):
    """The forces, from the equation."""
    f = np.zeros_like(q)
    for i in range(model.n):
        ends = 1 if i in (model.node_of["a"], model.node_of["b"]) else 2
        area, s = ends * D * LENGTH / SEGMENTS / 2.0, 0.1 - q[i, 2]
        if s > 0.0:
            f[i, 2] = 1e5 * area * s - 1e3 * area * v[i, 2]
            speed = np.hypot(*v[i, :2])
            f[i, :2] = -0.7 * min(30.0 * speed, abs(f[i, 2])) * v[i, :2] / speed
    return f


@pytest.mark.parametrize("seed", range(3))
def test_law(seed):
    model, index, params, q, v = scattered(seed)
    f = np.zeros_like(q)
    power = moordyn_bottom.force(0.0, q, v, index, params, f)
    expected = naive(model, q, v)
    np.testing.assert_allclose(f, expected, rtol=1e-13, atol=1e-13)  # rounding of a few terms
    assert (f[:, 2] < 0.0).any() and (f[:, 2] > 0.0).any()  # it pulls, too
    spring = 1e5 * D * LENGTH / SEGMENTS * np.maximum(0.1 - q[:, 2], 0.0)
    spring[[model.node_of["a"], model.node_of["b"]]] *= 0.5
    assert power == pytest.approx(-np.sum(f * v) + np.sum(spring * v[:, 2]), rel=1e-12) and power > 0.0


@pytest.mark.parametrize(("ratio", "speeds"), [(1.5, (2.9, 3.1)), (0.5, (0.9, 1.1))], ids=["static above", "static below"])
def test_static_friction(ratio, speeds):
    """-mu D v up to the ratio of the load N = k A s = 60 N, which D = 30 N s/m has at 2 m/s, and -mu N beyond."""
    effect = MoordynBottom(0.1, 1e5, 0.0, 0.7, 30.0, static_ratio=ratio)
    model = build(lying(effect))
    index, params = effect.table(model)
    i = model.nodes("a-b")[4]
    q, v = np.ones((model.n, 3)), np.zeros((model.n, 3))
    q[i, 2] = 0.1 - 60.0 / (1e5 * D * LENGTH / SEGMENTS)
    for speed, expected in zip(speeds, (0.7 * 30.0 * speeds[0], 0.7 * 60.0), strict=True):
        f, v[i, 1] = np.zeros_like(q), speed
        moordyn_bottom.force(0.0, q, v, index, params, f)
        assert f[i] == pytest.approx((0.0, -expected, 60.0), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_derivatives(seed):
    """Taylor's remainder is of order 2, but for nodes that pass a kink, of which there are none within the steps."""
    model, index, params, q, v = scattered(seed)
    rng = np.random.default_rng(seed + 9)
    d = rng.normal(size=(model.n, 3))
    K, near = np.zeros((model.n_free, 3, 3)), np.zeros((0, 2, 3, 3))
    moordyn_bottom.tangent(0.0, q, v, index, params, 0.3, 0.8, K, near, near)
    f, off, steps = naive(model, q, v), [], 10.0 ** -np.arange(4.0, 6.1, 0.5)
    for x in steps:
        change = naive(model, q + 0.3 * x * d, v + 0.8 * x * d) - f
        off.append(np.linalg.norm(change + x * np.einsum("ixy,iy->ix", K, d)))
    assert np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("h", [1e-3, 1e-1])
@pytest.mark.parametrize("damper", [0.0, 0.5])
@pytest.mark.parametrize("seed", range(3))
def test_step_gives_back_no_more_than_the_energy(seed, damper, h):
    model, index, params, base, _ = scattered(seed)
    q = 0.08 + 0.02 * np.random.default_rng(seed + 5).normal(size=(model.n, 3))
    near = np.zeros((0, 2, 3, 3))

    def act(at):
        f, K = np.zeros_like(q), np.zeros((model.n_free, 3, 3))
        return f, K, moordyn_bottom.whole_step(0.0, h, damper, base, at, index, params, f, K, near, near)

    f, K, (taken, by_method) = act(q)
    rise = moordyn_bottom.energy(0.0, q, index, params) - moordyn_bottom.energy(0.0, base, index, params)
    lost = taken + by_method
    assert taken >= 0.0 and (by_method > 0.0 if damper else by_method == 0.0)
    assert rise == pytest.approx(-np.sum(f * (q - base)) - lost, rel=1e-9, abs=1e-12 * lost)  # rounding
    d, off, steps = np.random.default_rng(seed).normal(size=(model.n, 3)), [], 10.0 ** -np.arange(4.0, 6.1, 0.5)
    for x in steps:
        off.append(np.linalg.norm(act(q + x * d)[0] - f + x * np.einsum("ixy,iy->ix", K, d)))
    assert np.polyfit(np.log(steps), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_a_cable_without_a_diameter_is_refused():
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=2)
    with pytest.raises(SceneError, match=r'MoordynBottom needs the `diameter` \[m\] of every cable, but cable "a-b" has none'):
        MoordynBottom().table(build(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable])))


def test_bodies_that_move_by_themselves_are_refused():
    """They have no contact with it, and would sink through."""
    rod = rod_body("can", (0, 0, 1), (1, 0, 1), mass_per_length=1.0, diameter=0.1, segments=2)
    cable = Cable("a", "can.a", length=2.0, mass_per_length=0.1, EA=1e4, segments=2, diameter=0.01)
    scene = Scene([Fixed("a", (0, 0, 2))], [cable], [Gravity(9.81), LAW], bodies=[rod])
    with pytest.raises(SceneError, match=r'acts on cables alone, so that no body may move by itself, but "can" does; Ground'):
        build(scene)


def test_its_plane_moves_with_the_origin():
    assert MoordynBottom(-3.0).seen_from((5.0, 6.0, -2.0), None) == MoordynBottom(-1.0)
    assert MoordynBottom(friction=0.4).at_rest().friction == 0.0


DECK = """\
a chain on a bottom whose friction and damper count
--- LINE TYPES ---
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
chain 0.05 40 4e6 -0.8 0 1.5 1 0.3 0
--- POINTS ---
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m3) (m2) (-)
1 Fixed 0 0 -20 0 0 0 0
2 Free 50 0 -20 0 0 0 0
--- LINES ---
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 chain 1 2 50 25 -
--- OPTIONS ---
0.0005 dtM
rk4 tScheme
0 rho
20 WtrDpth
2e5 kBot
2e4 cBot
0.6 FrictionCoefficient
3000 FricDamp
0 writeLog
1 disableOutput
--- OUTPUTS ---
--- need this line ---
"""


def of_moordyn(folder, start, t_end, dt):
    """Places [m] of the nodes of the line at the end of MoorDyn's march from a Problem's start."""
    moordyn = pytest.importorskip("moordyn", exc_type=ImportError)
    with silence():
        engine = moordyn.Create(str(folder / "chain.txt"))
        try:
            moordyn.Init_NoIC(engine, [], [])
            (folder / "state").write_bytes(state_file(start))
            moordyn.LoadState(engine, str(folder / "state"))
            for k in range(round(t_end / dt)):
                moordyn.Step(engine, [], [], k * dt, dt)
            line = moordyn.GetLine(engine, 1)
            return np.array([moordyn.GetLineNodePos(line, node) for node in range(moordyn.GetLineNumberNodes(line))])
        finally:
            moordyn.Close(engine)


def test_moordyn_moves_as_this_does(tmp_path):
    """A chain on the bottom, thrown up and sideways, for 0.4 s, without water. The law of `Ground` is 100 times farther off.

    Both march by a fourth-order step of 0.1 ms with forces that jump where a node leaves the bottom, which one step resolves:
    0.1 ms at 1 m/s.
    """
    (tmp_path / "chain.txt").write_text(DECK)
    like, ours = (deck_from_text(DECK, like_moordyn=like).scene for like in (True, False))
    model, s = build(like), np.linspace(0.0, 1.0, 26)
    line = model.nodes("line1")
    q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    q[line] = np.column_stack([50.0 * s, 0.0 * s, -20.01 + 0.0 * s])
    q[line[0], 2] = -20.0
    v[line] = np.column_stack([0.2 * s, np.sin(3.0 * s), 0.8 * np.sin(9.0 * s) * s])

    def begun(scene):
        return State(build(scene), 0.0, q, v, np.zeros(model.n_segments))

    theirs = of_moordyn(tmp_path, problem(like, 0.4, 0.4, begun(like)), 0.4, 1e-4)
    ends = [simulate(scene, 0.4, method="rk4", dt=1e-4, start=begun(scene)).final.q[line] for scene in (like, ours)]
    off_like, off_ours = (np.abs(end - theirs).max() for end in ends)
    assert np.abs(theirs - q[line]).max() > 0.08
    assert off_like < 1e-4 and off_ours > 100.0 * off_like, (off_like, off_ours)
