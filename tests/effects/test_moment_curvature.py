"""Bending by curves of moment over curvature: derivatives, the energy of a step, beams in closed form, and what is refused."""

import numpy as np
import pytest
from test_bending import EI, MU, arrays, bent_net, cantilever, matrix, random_places

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, State, attach, equilibrium, simulate
from anet_lumped.effects import Bending, Gravity, MomentCurvature, moment_curvature
from anet_lumped.model.build import build
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

STRAIGHT = ((1.0, EI),)
CURVE = ((2.0, 2.0 * EI), (6.0, 3.0 * EI), (9.0, 5.0 * EI))  # softer, stiffer, and level beyond


def with_curve(scene, curve):
    """The scene with a curve in place of the EI of each cable."""
    cables = [Cable(**{**vars(cable), "EI": 0.0, "zeta": 0.0}) for cable in scene.cables]
    bends = next(effect for effect in scene.effects if isinstance(effect, Bending))
    effect = MomentCurvature({cable.name: curve for cable in cables}, bends.clamped)
    return Scene(scene.points, cables, [effect, *(one for one in scene.effects if one is not bends)])


def of(effect, model):
    """As `test_bending.arrays`, of another effect."""
    _, _, *blocks = arrays(build(bent_net()))
    return *effect.table(model), *(np.zeros_like(block) for block in blocks)


def curved(curve=CURVE):
    scene = with_curve(bent_net(), curve)
    return build(scene), scene.effects[0]


@pytest.mark.parametrize("seed", range(2))
def test_a_straight_curve_is_an_EI(seed):
    """Force, slope, energy and step, to rounding; the level end of the curve is never reached."""
    model, effect = curved(((1e3, 1e3 * EI),))
    old = build(bent_net())
    base, q = random_places(model, seed), random_places(model, seed + 50)
    index, params, f, D, near, far = arrays(old)
    from anet_lumped.effects import bending

    new = of(effect, model)
    lost = bending.whole_step(0.0, 0.01, 0.5, base, q, index, params, f, D, near, far)
    assert moment_curvature.whole_step(0.0, 0.01, 0.5, base, q, *new) == pytest.approx(lost, rel=1e-12)
    for ours, theirs in zip(new[2:], (f, D, near, far), strict=True):
        assert np.allclose(ours, theirs, rtol=1e-10, atol=1e-12 * np.abs(theirs).max())
    assert moment_curvature.energy(0.0, q, *new[:2]) == pytest.approx(bending.energy(0.0, q, index, params), rel=1e-12)


@pytest.mark.parametrize("effect", [Bending(), MomentCurvature({"a-b": ((1.0, 20.0),)})], ids=["EI", "curve"])
def test_tensions_of_a_stiff_rod_that_spins(effect):
    """mu w^2 L^2/8 in the middle, of nodes on a line too; bending does not pull along a segment that turns by 2 degrees a step.

    EI/L0^2 times the square of half of the turn is 1.8 N, three times this tension.
    """
    made = dict(length=1.0, mass_per_length=0.1, EA=1e6, EI=20.0 if isinstance(effect, Bending) else 0.0, segments=20, zeta=0.02)
    scene = Scene([Free("a"), Free("b")], [Cable("a", "b", compression="linear", **made)], [effect])
    x, w = np.linspace(-0.5, 0.5, 21), 7.0
    places, velocities = np.outer(x, (1.0, 0, 0)), np.outer(w * x, (0, 1.0, 0))
    start = State.of(scene, shapes={"a-b": places}, velocities={"a-b": velocities})
    run = simulate(scene, 0.5, start=start, method="edmc", dt=0.005)
    tension = 0.1 * w**2 / 8.0
    late = run.tension("a-b")[len(run.t) // 2 :, 9:11]  # the axial vibration that the start sets off is over
    assert late.min() == pytest.approx(tension, rel=2e-3) and late.max() == pytest.approx(tension, rel=2e-3)  # (w h)^2 is 1.2e-3


def slope_of(force, q, d, n_free):
    """Change of the force by a small step of the moving nodes, central."""
    ends = []
    for h in (1e-7, -1e-7):
        moved = q.copy()
        moved[:n_free] += h * d
        ends.append(force(moved))
    return (ends[0] - ends[1])[:n_free].ravel() / 2e-7


@pytest.mark.parametrize("seed", range(4))
def test_force_and_tangent_are_the_derivatives_of_the_energy(seed):
    model, effect = curved()
    index, params, f, D, near, far = of(effect, model)
    q, d = random_places(model, seed), np.random.default_rng(seed).normal(size=(model.n_free, 3))

    def force(at):
        g = np.zeros_like(f)
        moment_curvature.force(0.0, at, at, index, params, g)
        return g

    moment_curvature.tangent(0.0, q, q, index, params, 1.0, 0.0, D, near, far)
    expected = -matrix(model, D, near, far) @ d.ravel()
    assert np.allclose(slope_of(force, q, d, model.n_free), expected, atol=1e-5 * np.abs(expected).max())
    work = slope_of(lambda at: np.full((model.n, 3), moment_curvature.energy(0.0, at, index, params)), q, d, model.n_free)[0]
    assert work == pytest.approx(-np.sum(force(q)[: model.n_free] * d), rel=1e-5)


@pytest.mark.parametrize("h", [1e-5, 1e-2])
@pytest.mark.parametrize("seed", range(4))
def test_step_gives_the_energy_back_but_for_what_it_dissipates(seed, h):
    model, effect = curved()
    index, params, f, D, near, far = of(effect, model)
    base, q = random_places(model, seed), random_places(model, seed + 50)
    base[model.n_free :] = q[model.n_free :]
    if h < 1e-3:
        q = base + 1e-6 * (q - base)  # a step over which curvatures change little
    taken, lost = moment_curvature.whole_step(0.0, h, 0.5, base, q, index, params, f, D, near, far)
    rise = moment_curvature.energy(0.0, q, index, params) - moment_curvature.energy(0.0, base, index, params)
    assert lost >= 0.0 and taken == 0.0
    assert rise == pytest.approx(-np.sum(f * (q - base)) - lost, abs=1e-13)  # rounding of energies of some 0.1 J
    d = np.random.default_rng(seed).normal(size=(model.n_free, 3))

    def force(at):
        g, *blocks = (np.zeros_like(block) for block in (f, D, near, far))
        moment_curvature.whole_step(0.0, h, 0.5, base, at, index, params, g, *blocks)
        return g

    if h > 1e-3:  # over less, the step of the differences would be as long
        expected = -matrix(model, D, near, far) @ d.ravel()
        assert np.allclose(slope_of(force, q, d, model.n_free), expected, atol=1e-5 * np.abs(expected).max())


def test_a_cantilever_beyond_the_knee():
    """Small deflections by int kappa(M) (L - x) dx, M = P (L - x), over a knee at half of the moment; of order 2 in segments."""
    P, knee = 1e-5, 0.5e-5
    curve = ((knee / EI, knee), (knee / EI + 1.0, knee + 0.2 * EI))  # a fifth as stiff beyond
    s = np.linspace(0.0, 1.0, 20001)
    M = P * (1.0 - s)
    kappa = np.where(M < knee, M / EI, knee / EI + (M - knee) / (0.2 * EI))
    expected = np.trapezoid(kappa * (1.0 - s), s)
    off = []
    for n in (20, 40):
        scene = with_curve(cantilever(n, EA=1e3, compression="linear"), curve)
        light = [Cable(**{**vars(cable), "mass_per_length": 1e-12, "zeta": 0.0}) for cable in scene.cables]
        loaded = Scene([scene.points[0], Free("b", mass=P / 9.81, at=(1, 0, 0))], light, [scene.effects[0], Gravity(9.81)])
        off.append(-equilibrium(loaded).position("b")[2] / expected - 1.0)
    assert abs(off[1]) < 1e-3 and abs(off[1]) < 0.3 * abs(off[0])


def test_a_beam_that_swings_over_its_knees_keeps_its_energy():
    scene = with_curve(cantilever(10, compression="linear", effects=[Bending({"a": (1, 0, 0)}), Gravity(9.81)]), CURVE)
    run = simulate(scene, 0.5, method="edmc", dt=1e-3, start="straight")
    assert run.ok and error_of_steps(run) < 1e-6


def test_a_point_on_such_a_cable_is_refused():
    scene = with_curve(cantilever(4), CURVE)
    with pytest.raises(SceneError, match='passes no bending moment, but cable "a-b" has a curve of moments'):
        attach(scene, "a-b", {0.5: Free("w", 1.0)})


def test_what_is_left_of_a_broken_cable_has_its_curve():
    scene = with_curve(bent_net(), CURVE)
    effect, cables = scene.effects[0], list(scene.cables)
    piece = Cable(**{**vars(cables[0]), "name": "piece", "start": "y"})
    left = effect.after_break({"x-a": [piece]}, [piece, *cables[1:]])
    assert set(dict(left.curves)) == {"piece", "x-y", "y-z", "c-y"} and dict(left.clamped).keys() == {"a", "c"}
    assert effect.after_break({cable.name: [] for cable in cables}, []) is None


def test_it_is_written_and_read_back():
    scene = with_curve(bent_net(), CURVE)
    assert scene_from_dict(scene_to_dict(scene)) == scene


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"curves": {"a-b": ((1.0,),)}}, "must be rows of a curvature and a moment, but effect MomentCurvature of cable"),
        ({"curves": {"a-b": 3.0}}, "must be rows of a curvature and a moment"),
        ({"curves": {"a-b": ((1.0, 2.0), (1.0, 3.0))}}, "must increase from 0 on, and moments rise at first and never fall"),
        ({"curves": {"a-b": ((1.0, 2.0), (2.0, 1.0))}}, "never fall"),
        ({"curves": {"a-b": ((1.0, 0.0), (2.0, 1.0))}}, "rise at first"),
        ({"curves": {}}, "must hold at least one pair"),
    ],
)
def test_refusals(fields, message):
    with pytest.raises(SceneError, match=message):
        MomentCurvature(**fields)


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        (MomentCurvature({"a-c": STRAIGHT}), "no cable"),
        (MomentCurvature({"a-b": STRAIGHT}, {"b": (1, 0, 0)}), 'must be at a fixed or driven point, .* clamps free point "b"'),
        (
            MomentCurvature({"a-b": STRAIGHT}, {"c": (1, 0, 0)}),
            'must hold one cable that has a curve, but 0 of them end at point "c"',
        ),
    ],
)
def test_scenes_that_do_not_do(effect, message):
    cable = Cable("a", "b", length=1.0, mass_per_length=MU, EA=1e5, segments=4)
    with pytest.raises(SceneError, match=message):
        build(Scene([Fixed("a", (0, 0, 0)), Free("b"), Fixed("c", (9, 0, 0))], [cable], [effect]))
