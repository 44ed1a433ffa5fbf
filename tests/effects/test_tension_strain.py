"""Cables by a curve of tension over strain: the law, statics and motion against closed forms, files, and bad curves."""

import math

import jax
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import Cable, Fixed, Free, Scene, SceneError, State, equilibrium, simulate
from anet_lumped.advice.compare import compare
from anet_lumped.effects import Gravity, LineChange
from anet_lumped.effects.laws import axial
from anet_lumped.files.moordyn_file import read_moordyn
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.model.build import build
from anet_lumped.prescribed import signals
from anet_lumped.results.energy_balance import error_of_steps
from anet_lumped.results.state import segment_tensions
from integrators import schemes

jax.config.update("jax_enable_x64", True)
EPS = np.finfo(float).eps
ROPE = ((0.01, 100.0), (0.03, 900.0), (0.05, 1000.0))  # EA of 1e4, 4e4 and 5e3 N: it stiffens and yields
STABLE = schemes.names(own=True, stable_undamped=True)
STRETCHES = st.floats(-0.02, 0.1).map(lambda x: round(x * 2**40) / 2**40)


def cable(**changes):
    made = dict(length=2.0, mass_per_length=0.1, tension_strain=ROPE, segments=4)
    return Cable("a", "b", **(made | changes))


def spring_of(one, L0=1.0, pushes=0.0):
    """`Spring` of a segment of the length L0."""
    rows = np.array(one.springs)
    return axial.Spring(one.EA_first / L0, pushes, L0, rows, 1, len(rows))


def curve(strain):
    """The curve itself, straight beyond its ends."""
    beyond = np.maximum(np.asarray(strain) - ROPE[-1][0], 0.0)
    return np.interp(strain, *np.transpose([(0.0, 0.0), *ROPE])) + 5e3 * beyond


def test_steepest_slope_is_the_stiffness():
    one = cable(zeta=0.2)
    assert one.EA == pytest.approx(4e4, rel=1e-14) and one.EA_first == pytest.approx(1e4, rel=1e-14)
    assert one.axial_viscosity == pytest.approx(0.2 * 0.5 * math.sqrt(4e4 * 0.1), rel=1e-14)
    assert one.springs == tuple((at, pytest.approx(share, abs=1e-14)) for at, share in ((0.0, 0.25), (0.01, 3.0), (0.03, -3.5)))


@given(st.floats(0.0, 2e3))
def test_strain_of_a_tension(T):
    assert curve(cable().strain(T)) == pytest.approx(T, abs=1e-10)
    assert cable(tension_strain=None, EA=1e4).strain(T) == T / 1e4


@tried()
@given(STRETCHES, st.floats(-1.0, 1.0))
def test_tension_is_the_curve(strain, rate):
    spring = spring_of(cable(), 2.0)
    T, elastic = axial.tension_parts(2.0 * strain, rate, spring, 3.0, 0.0)
    assert elastic == pytest.approx(curve(strain), abs=1e-11)
    assert T == pytest.approx(max(0.0, curve(strain) + 3.0 * rate) if strain > 0.0 else 0.0, abs=1e-11)
    assert axial.tension_slopes(2.0 * strain, rate, spring, 3.0, 0.0)[0] == pytest.approx(T, abs=1e-11)
    pushing = axial.tension_parts(2.0 * strain, 0.0, spring_of(cable(), 2.0, 1.0), 0.0, 1.0)[0]
    assert pushing == pytest.approx(curve(strain) if strain > 0.0 else 1e4 * strain, abs=1e-11)


def test_laws_in_jax():
    """Energy, tension and slopes are each other's derivatives, of the very lines."""
    parts, slopes, energy = (
        axial.with_select(law, jax.numpy.where) for law in (axial.tension_parts, axial.tension_slopes, axial.elastic_energy)
    )
    spring = spring_of(cable())
    x = np.linspace(-0.02, 0.1, 50)
    T = jax.jit(jax.vmap(jax.grad(lambda x: energy(x, spring))))(x)
    np.testing.assert_allclose(T, curve(x), atol=1e-11)
    k = jax.jit(jax.vmap(jax.grad(lambda x: parts(x, 0.2, spring, 3.0, 0.0)[0])))(x)
    np.testing.assert_allclose(k, [axial.tension_slopes(a, 0.2, spring, 3.0, 0.0)[1] for a in x], rtol=1e-14)
    np.testing.assert_allclose(k, jax.jit(lambda x: slopes(x, 0.2, spring, 3.0, 0.0)[1])(x), rtol=1e-14)


@tried(300)
@given(STRETCHES, STRETCHES, st.booleans(), st.floats(0.0, 1e6))
def test_between_two_lengths(a, b, near, damper):
    """The secant of the energy, without cancellation; no step gives energy."""
    b = a + 1e-11 * b if near else b
    spring = spring_of(cable())
    T, slope, secant = axial.tension_between(a, b, spring, damper, 0.0, 0.0)
    change = axial.elastic_energy(b, spring) - axial.elastic_energy(a, spring)
    assert secant * (b - a) == pytest.approx(change, abs=16 * EPS * 4e4 * (a * a + b * b))
    assert secant == pytest.approx(curve(0.5 * (a + b)) if near else secant, abs=1e-6)
    assert (T - secant) * (b - a) >= -16 * EPS * 4e4 * (abs(a) + abs(b)) * abs(b - a)
    assert T >= 0.0 and slope >= -16 * EPS * 4e4


@pytest.mark.parametrize("mass", [5.0, 40.0, 95.0, 130.0])  # on each of the pieces, and beyond the last
def test_hanging_load(mass):
    """Each segment is as long as its tension stretches it."""
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", mass)], [cable(segments=8)], [Gravity(9.81)])
    rest = equilibrium(scene)
    T = 9.81 * (mass + 0.2 * (1.0 - (np.arange(8) + 0.5) / 8))
    np.testing.assert_allclose(rest.tension("a-b"), T, rtol=1e-9)
    assert -rest.position("b")[2] == pytest.approx(0.25 * sum(1.0 + scene.cables[0].strain(t) for t in T), abs=1e-9)


def period(v, m, L0=1.0):
    """Of a mass m on a segment that pushes as its first piece pulls, let go at l = L0 with v, up to the second piece."""
    k1, k2, x1 = 1e4 / L0, 4e4 / L0, 0.01 * L0
    w1, w2 = math.sqrt(k1 / m), math.sqrt(k2 / m)
    v1 = math.sqrt(v * v - (w1 * x1) ** 2)
    y = k1 * x1 / k2  # where the second piece begins, from where it would carry nothing
    return math.pi / w1 + 2.0 * (math.asin(x1 * w1 / v) / w1 + (math.pi / 2 - math.atan2(y, v1 / w2)) / w2)


def test_a_segment_that_nothing_moves():
    """Between two fixed points the tension is the curve's at the strain that they give it."""
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (0.12, 0, 0))]
    cable = Cable("a", "b", length=0.1, mass_per_length=1.0, segments=1, tension_strain=[(0.1, 10.0), (1.0, 11.0)])
    assert equilibrium(Scene(points, [cable], [Gravity()])).tension("a-b") == pytest.approx([10.0 + 0.1 / 0.9], rel=1e-12)


@pytest.mark.parametrize("method", [*STABLE, "Radau"])
def test_swings_between_two_pieces(method):
    """The period of a mass on a spring of two slopes, and its energy."""
    one = cable(length=1.0, mass_per_length=1e-6, segments=1, compression="linear")
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 1.0)], [one])
    model, v = build(scene), 3.0
    T = period(v, float(model.mass[0]))
    start = State(model, 0.0, np.array([[1.0, 0, 0], [0, 0, 0]]), np.array([[v, 0, 0], [0, 0, 0]]), np.zeros(1))
    steps = 50000 if method in ("symplectic_euler", "backward_euler") else 2000
    how = {"rtol": 1e-8, "atol": 1e-10} if method == "Radau" else {"dt": T / steps}
    run = simulate(scene, T, method=method, start=start, save_every=T / 50, **how, **({"rho_inf": 1.0} if method == "edmc" else {}))
    assert run.ok, run.message
    largest = (run.position("b")[:, 0] - 1.0).max()
    x = 0.01 - 0.0025 + math.hypot(0.0025, math.sqrt(v * v - 1.0) / 200.0)
    off = 2e-2 if method == "backward_euler" else 2e-3
    assert 0.02 < x < 0.03 and largest == pytest.approx(x, rel=off)
    assert run.position("b")[-1, 0] - 1.0 == pytest.approx(0.0, abs=off * x)
    if method not in ("backward_euler", "sdirk2", "tr_bdf2", "generalised_alpha"):
        assert run.v[-1, 0, 0] == pytest.approx(v, rel=1e-3)


def test_energy_of_a_net_that_snaps():
    """The energy-decaying scheme never gains any, and accounts for all of it: slack, on each piece and beyond the last."""
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 3.0, at=(0.5, 0, -0.2))], [cable(segments=6, zeta=0.1)], [Gravity(9.81)])
    for method, bound in (("edmc", 1e-7), ("verlet", 1e-2), ("dop853", 1e-4)):  # edmc: of what Newton's tolerance leaves
        run = simulate(scene, 3.0, method=method, start="straight", **({"dt": 0.01} if method == "edmc" else {}))
        assert run.ok, run.message
        assert run.tension("a-b").max() > 900.0
        assert error_of_steps(run) < bound
        assert run.work.newton_iterations < 5 * run.work.steps and run.work.halvings == 0


def test_a_straight_curve_is_a_stiffness():
    """With knots on the way that bend nothing, and none."""
    ends = [Fixed("a", (0, 0, 0)), Free("b", 0.5, at=(1, 0, -0.5))]
    knots = tuple((x, 1e4 * x) for x in (0.001, 0.01, 0.02))
    for method in ("edmc", "verlet"):
        runs = [
            simulate(Scene(ends, [cable(zeta=0.05, **law)], [Gravity()]), 1.0, method=method, dt=1e-4, start="straight")
            for law in ({"tension_strain": None, "EA": 1e4}, {"tension_strain": knots[-1:]}, {"tension_strain": knots})
        ]
        for run in runs[1:]:
            np.testing.assert_allclose(run.q, runs[0].q, atol=1e-8)


@pytest.mark.parametrize("method", ["edmc", "verlet", "backward_euler"])
def test_paid_out(method):
    """A load on a curve hangs as deep as the longer line, and the account closes: pieces begin at their strain of what there is."""
    line = cable(zeta=0.3, mass_per_length=0.05)
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("b", 40.0)], [line], [Gravity(9.81), LineChange({"a-b": signals.line(0.0, 0.2, 0.5)})]
    )
    run = simulate(scene, 1.5, method=method, **({} if method == "verlet" else {"dt": 0.005}))
    assert run.ok, run.message
    length = 2.0 + 0.2 * 1.25
    T = 9.81 * (40.0 + 0.05 * length * (1.0 - (np.arange(4) + 0.5) / 4))
    assert -run.position("b")[-1, 2] == pytest.approx(length / 4 * sum(1.0 + line.strain(t) for t in T), abs=5e-4)
    assert error_of_steps(run) < {"edmc": 1e-9, "verlet": 1e-5, "backward_euler": 2e-3}[method]


def test_breaks_and_alike_cables():
    """Two cables of one curve beside one of another and one without: taken together or alone, the same motion."""
    ends = [Fixed(name, (x, y, 0)) for name, x, y in (("n", 0, 1), ("e", 1, 0), ("s", 0, -1), ("w", -1, 0))]
    laws = [{"tension_strain": ROPE}, {"tension_strain": ROPE}, {"tension_strain": ((0.02, 50.0),)}, {"EA": 1e4}]
    cables = [
        Cable(end.name, "p", length=1.05, mass_per_length=0.1, zeta=0.1, segments=5, **law)
        for end, law in zip(ends, laws, strict=True)
    ]
    scene = Scene([*ends, Free("p", 20.0)], cables, [Gravity()])
    model = build(scene)
    assert model.cable_groups.tolist() == [[0, 1, 1, 1, 2]] and len(model.springs) == 4
    rest = equilibrium(scene)
    for one in cables:
        strain = np.linalg.norm(np.diff(rest.shape(one.name), axis=0), axis=1) / one.L0 - 1.0
        np.testing.assert_allclose([one.strain(t) for t in rest.tension(one.name)], strain, atol=1e-10)
    run = simulate(scene, 0.5, method="edmc", dt=0.01)
    np.testing.assert_allclose(run.q[-1], rest.q, atol=1e-8)


def test_scene_file_and_moordyn(tmp_path):
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b", 1.0, at=(0, 0, -2))], [cable(compression="damped", diameter=0.01)], [Gravity()])
    for name in ("scene.toml", "deck.txt"):
        save_scene(scene, tmp_path / name)
        assert load_scene(tmp_path / name).cables == scene.cables
    assert "\nEA =" not in (tmp_path / "scene.toml").read_text()
    assert (tmp_path / "deck_curve1.txt").read_text().splitlines()[2:4] == ["0 0", "0.01 100.0"]
    (tmp_path / "deck_curve1.txt").write_text("title\nstrain tension\n0 0\n0.1 what\n")
    with pytest.raises(SceneError, match=r'line 6, .*must be a strain and a tension, but one is "0.1 what"'):
        read_moordyn(tmp_path / "deck.txt")


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"EA": 1e4}, 'Only one of `EA` and `tension_strain` may be given, but cable "a-b" has both'),
        ({"tension_strain": None}, 'must have `EA` or `tension_strain`, but cable "a-b" has neither'),
        ({"tension_strain": ()}, "there must be some"),
        ({"tension_strain": [(0.1, 5.0), (0.1, 6.0)]}, "must grow from"),
        ({"tension_strain": [(0.1, 5.0), (0.2, 5.0)]}, "must grow from"),
        ({"tension_strain": [(0.1, math.nan)]}, "pairs of a finite strain and tension"),
        ({"tension_strain": 3.0}, "pairs of a finite strain and tension"),
        ({"compression": "damped", "EA_compression": 2e4}, "must not exceed a finite EA"),
    ],
)
def test_bad_curve(wrong, words):
    with pytest.raises(SceneError, match=words):
        cable(**wrong)


def test_no_elastic_catenary():
    rest = equilibrium(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1.5, 0, 0))], [cable()], [Gravity()]))
    with pytest.raises(ValueError, match='A cable with a tension-strain curve, such as "a-b", has no catenary in closed form'):
        compare(rest)
    assert compare(rest, elastic=False).cables[0].rmse < 0.02


def test_a_curve_of_several_pieces_beside_a_cable_without_one():
    """A weight on a rope with a curve, on a plain rope below it: each stretches by its own law."""
    curve, load = ((0.01, 10.0), (0.03, 20.0), (0.05, 60.0)), 25.0
    common = {"length": 1.0, "mass_per_length": 1e-6, "segments": 2}
    cables = [Cable("a", "b", tension_strain=curve, **common), Cable("b", "c", EA=1e3, **common)]
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b"), Free("c", mass=load / 9.81)], cables, [Gravity(9.81)])
    rest = equilibrium(scene)
    assert rest.length("a-b") == pytest.approx(
        1.0 + np.interp(load, (0, 10, 20, 60), (0, 0.01, 0.03, 0.05)), rel=1e-6
    )  # its own weight
    assert rest.length("b-c") == pytest.approx(1.025, rel=1e-6)
    run = simulate(scene, 0.02, method="edmc", dt=1e-3, start=rest)
    np.testing.assert_allclose(run.segment_tension, load, rtol=1e-5)
    again = State(rest.model, 0.0, rest.q, rest.v, segment_tensions(rest.model, rest.q, rest.v))
    np.testing.assert_allclose(again.segment_tension, rest.segment_tension, rtol=1e-9)
