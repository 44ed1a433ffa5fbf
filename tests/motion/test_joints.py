"""Bodies that are pinned to other bodies: against an integration of their own, closed forms and what has to be kept."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from slow import slow
from test_bodies import ELSEWHERE, G, thrown

from anet_lumped import (
    Body,
    Cable,
    Fixed,
    Free,
    InputError,
    Scene,
    SceneError,
    Session,
    equilibrium,
    load_run,
    load_scene,
    paths,
    rod_body,
    save_scene,
    simulate,
)
from anet_lumped.effects import Gravity, Water
from anet_lumped.prescribed.turning import matrix_of

UPPER = dict(mass=1.2, inertia=(0.02, 0.025, 0.01), at=(0.0, 0.0, 0.0), rotation=(0.5, 0.2, 0.0), centre_of_mass=(0.0, 0.0, -0.3))
LOWER = dict(mass=0.8, inertia=(0.01, 0.012, 0.004), rotation=(1.0, -0.3, 0.2), centre_of_mass=(0.0, 0.01, -0.2))
LOW, TOP = (0.02, 0.0, -0.6), (0.0, 0.0, 0.05)
SPINS = np.array([0.5, -1.0, 2.0]), np.array([-2.0, 1.5, -3.0])


def pair(*effects, **upper):
    """Two bodies, the lower one pinned to the upper one, listed first to show that the order is of no concern."""
    one = Body("upper", **UPPER | dict(pinned="", attachments={"low": LOW}) | upper)
    other = Body("lower", **LOWER, attachments={"top": TOP}, pinned="top", pinned_to="upper.low")
    points, cables = ELSEWHERE
    return Scene(points, cables, effects, bodies=[other, one])


def across(x):
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def double_pendulum(t_end, spins):
    """Rotations and angular velocities of `pair` at t_end, by the principle of virtual power.

    With the centres c_1 = R_1 r_1 and c_2 = R_1 l + R_2 r_2 and the angular velocities W as unknowns, v_i = B_i W, sum over both of
    B_i^T m (B_i W' + b_i) + J_i w_i' + w_i x J_i w_i = sum of B_i^T m g. Source: T. R. Kane, Dynamics (1968).
    """
    m, J = np.array([UPPER["mass"], LOWER["mass"]]), [np.diag(UPPER["inertia"]), np.diag(LOWER["inertia"])]
    r1, joint = np.array(UPPER["centre_of_mass"]), np.array(LOW)
    r2 = np.array(LOWER["centre_of_mass"]) - TOP

    def rates(t, y):
        (R1, R2), (w1, w2) = y[:18].reshape(2, 3, 3), y[18:].reshape(2, 3)
        c1, l, c2 = R1 @ r1, R1 @ joint, R2 @ r2
        B = [np.hstack([-across(c1), np.zeros((3, 3))]), np.hstack([-across(l), -across(c2)])]
        b = [np.cross(w1, np.cross(w1, c1)), np.cross(w1, np.cross(w1, l)) + np.cross(w2, np.cross(w2, c2))]
        M, right = np.zeros((6, 6)), np.zeros(6)
        for i, (R, w) in enumerate(((R1, w1), (R2, w2))):
            own, inertia = slice(3 * i, 3 * i + 3), R @ J[i] @ R.T
            M += m[i] * B[i].T @ B[i]
            M[own, own] += inertia
            right += m[i] * B[i].T @ (np.array([0.0, 0.0, -G]) - b[i])
            right[own] -= np.cross(w, inertia @ w)
        return np.concatenate([(across(w1) @ R1).ravel(), (across(w2) @ R2).ravel(), np.linalg.solve(M, right)])

    start = [matrix_of(body["rotation"]).ravel() for body in (UPPER, LOWER)]
    exact = solve_ivp(rates, (0.0, t_end), np.concatenate([*start, *spins]), method="DOP853", rtol=1e-12, atol=1e-13)
    return exact.y[:18, -1].reshape(2, 3, 3), exact.y[18:, -1].reshape(2, 3)


def spun(scene):
    return thrown(scene).moved("upper", angular_velocity=SPINS[0]).moved("lower", angular_velocity=SPINS[1])


@pytest.mark.parametrize("method", ["edmc", "dop853", *slow("verlet", "rk4", "backward_euler")])
def test_a_double_pendulum_against_an_integration_of_its_own(method):
    rotations, rates = double_pendulum(1.0, SPINS)
    scene = pair(Gravity(G))
    start, errors = spun(scene), []
    steps = [{"rtol": 1e-11, "atol": 1e-12}] if method == "dop853" else [{"dt": dt} for dt in (0.004, 0.002, 0.001)]
    for step in steps:
        run = simulate(scene, 1.0, method=method, start=start, **step)
        assert np.abs(run.position("lower.top") - run.position("upper.low")).max() < 1e-14
        found = [run.rotation(name)[-1] - R for name, R in zip(("upper", "lower"), rotations, strict=True)]
        of_rates = [run.angular_velocity(name)[-1] - w for name, w in zip(("upper", "lower"), rates, strict=True)]
        errors.append((np.abs(found).max(), np.abs(of_rates).max()))
    if method == "dop853":
        assert max(errors[0]) < 1e-10
    else:
        order = {"edmc": 2, "verlet": 2, "rk4": 4, "backward_euler": 1}[method]
        assert_allclose(np.log2(np.divide(errors[-2], errors[-1])), order, atol=0.15)


def momenta(run):
    """Momentum (k, 3) and angular momentum (k, 3) of the bodies of a run."""
    nodes = [run.model.node_of[point.name] for body in run.scene.bodies for point in body.points]
    m = run.model.mass[nodes]
    return np.einsum("i,kix->kx", m, run.v[:, nodes]), np.einsum("i,kix->kx", m, np.cross(run.q[:, nodes], run.v[:, nodes]))


def chain(count, **first):
    """A chain of unlike bodies, each pinned to the one before, thrown and spun."""
    bodies = [Body("b0", **UPPER | dict(attachments={"low": LOW}) | first)]
    for k in range(1, count):
        turned = dict(LOWER, rotation=(0.4 * k, -0.3, 0.2 * k), attachments={"top": TOP, "low": (0.03, -0.02, -0.45)})
        bodies.append(Body(f"b{k}", **turned, pinned="top", pinned_to=f"b{k - 1}.low"))
    points, cables = ELSEWHERE
    scene = Scene(points, cables, bodies=bodies)
    start = thrown(scene).moved("b0", velocity=(1.0, -2.0, 0.5), angular_velocity=(4.0, -3.0, 5.0))
    for k in range(1, count):
        start = start.moved(f"b{k}", angular_velocity=(-3.0, 2.0 * k, 1.0))
    return scene, start


@pytest.mark.parametrize("rho_inf", [0.0, 1.0])
def test_a_chain_in_free_flight_keeps_its_momenta_and_gains_no_energy(rho_inf):
    scene, start = chain(4)
    run = simulate(scene, 2.0, method="edmc", dt=0.01, start=start, rho_inf=rho_inf)
    P, L = momenta(run)
    assert np.abs(P - P[0]).max() < 1e-10 * np.abs(P[0]).max()
    assert np.abs(L - L[0]).max() < 1e-10 * np.abs(run.position("b0")).max() * np.abs(P).max()
    energy = run.energy[:, 0]
    assert np.max(energy - np.minimum.accumulate(energy)) < 1e-8 * energy[0]  # what Newton's method leaves out of balance
    assert energy[-1] > (0.99 if rho_inf == 0.0 else 1.0 - 1e-8) * energy[0]  # what velocities at joints lose is of third order
    for k in range(1, 4):
        assert np.abs(run.position(f"b{k}.top") - run.position(f"b{k - 1}.low")).max() < 1e-13
    assert run.work.newton_iterations <= 6.0 * run.work.steps


@pytest.mark.each_once
@pytest.mark.parametrize("EA", [1e2, 1e5, 1e9])
@pytest.mark.parametrize("dt", [0.02, 0.005])
def test_hard_starts_do_not_raise_the_energy(EA, dt):
    """Overstretched cables on both of two bodies, spun at 50 rad/s."""
    scene, _ = chain(2, attachments={"low": LOW, "eye": (0.1, 0.1, 0.0)})
    points = [Fixed("a", (0.3, 0.2, 1.0)), Fixed("b", (-0.5, 0.1, -2.0))]
    ends, length = (("a", "b0.eye"), ("b", "b1.low")), 0.7
    cables = [Cable(*pair, length=length, mass_per_length=0.02, EA=EA, zeta=0.05, segments=4) for pair in ends]
    scene = Scene(points, cables, [Gravity(G)], bodies=scene.bodies)
    start = thrown(scene, angular_velocity=(20.0, -30.0, 35.0)).moved("b1", angular_velocity=(-35.0, 20.0, 30.0))
    run = simulate(scene, 1.0, method="edmc", dt=dt, start=start, save_every=dt)
    energy = run.energy[:, :3].sum(axis=1)
    assert run.status == "done"
    assert np.max(energy - np.minimum.accumulate(energy)) < 1e-9 * energy[0]


DECK = Body(
    "deck",
    attachments={"hinge": (0.3, 0.1, 0.0)},
    path=paths.line((0.0, 0.0, 1.0), (0.3, 0.1, 0.1), ramp=0.6),
    turning=paths.line((0.0, 0.0, 0.0), (0.5, -0.3, 0.8), ramp=0.7),
)


def carried(*effects, deck=DECK):
    """A pole that hangs at a driven deck, and a cable with a weight at the pole."""
    start, of_rod = deck.points[1].path.at(0.0)[0], dict(diameter=0.03, mass_per_length=0.6, segments=3)
    pole = rod_body("pole", start, start + np.array((0.1, 0.0, -0.8)), **of_rod, pinned="a", pinned_to="deck.hinge")
    cable = Cable("pole.b", "w", length=0.5, mass_per_length=0.05, EA=1e4, zeta=0.1, segments=4, diameter=0.01)
    return Scene([Free("w", mass=0.2)], [cable], [Gravity(G), *effects], bodies=[pole, deck])


@pytest.mark.parametrize("effects", [(), pytest.param((Water(),), marks=pytest.mark.slow)], ids=["dry", "in water"])
def test_a_pole_at_a_driven_deck_tends_to_dop853(effects):
    scene = carried(*effects)
    start = equilibrium(scene)
    exact = simulate(scene, 1.0, method="dop853", rtol=1e-10, start=start)
    errors = []
    for dt in (0.004, 0.002):
        run = simulate(scene, 1.0, method="edmc", dt=dt, start=start)
        errors.append(np.abs(run.q[-1] - exact.q[-1]).max())
        assert run.energy_balance.imbalance < 1e-6
    assert errors[1] < 3e-6 and errors[0] / errors[1] > 3.6
    assert abs(exact.energy_balance.imbalance) < 1e-7
    assert_allclose(exact.position("pole.a"), exact.position("deck.hinge"), atol=1e-14)
    assert run.energy_balance.work == pytest.approx(exact.energy_balance.work, rel=1e-6)  # of what drives the deck


def test_a_deck_that_moves_at_once_strikes_what_hangs_at_it():
    """The impulse moves the pole as one that turns about the hinge: J w = -m c x v about it, with the place c of its middle."""
    deck = replace(DECK, path=paths.harmonic((0.0, 0.0, 1.0), (0.1, 0.0, 0.0), frequency=0.5), turning=None)
    scene = carried(deck=deck)
    run = simulate(scene, 0.01, method="edmc", dt=0.01, start=equilibrium(scene))
    assert_allclose(run.velocity("pole.a")[0], run.velocity("deck.hinge")[0], atol=1e-14)
    pole, v = scene.body("pole"), run.velocity("deck.hinge")[0]
    nodes = [run.model.node_of[point.name] for point in pole.points]
    m, arms = run.model.mass[nodes], run.q[0, nodes] - run.position("pole.a")[0]
    inertia = np.eye(3) * (m @ (arms**2).sum(axis=1)) - (m[:, None] * arms).T @ arms
    assert m.sum() == pytest.approx(pole.whole.total + 0.5 * 0.05 * 0.5 / 4)  # with half of the cable's first segment
    assert_allclose(inertia @ run.angular_velocity("pole")[0], -np.cross(m @ arms, v), atol=1e-12)
    with pytest.raises(InputError, match=r'must start where it is pinned, but "pole" starts 0\.1 m from it; State\.moved takes'):
        simulate(carried(deck=replace(deck, path=paths.external((0.1, 0.0, 1.0)))), 0.1, start=run.state(0))


def test_the_force_of_a_joint_is_what_changes_the_momentum_behind_it():
    scene, start = chain(3, at=(0.0, 0.0, 0.0))
    run = simulate(scene, 0.03, method="dop853", rtol=1e-11, start=start, save_every=5e-4)
    for k in (1, 2):
        behind = [run.model.node_of[point.name] for j in range(k, 3) for point in scene.body(f"b{j}").points]
        rate = np.gradient(np.einsum("i,kix->kx", run.model.mass[behind], run.v[:, behind]), run.t, axis=0)[1:-1]
        assert_allclose(run.reaction(f"b{k}")[1:-1], rate, atol=1e-4 * np.abs(rate).max())


def test_a_session_takes_the_steps_of_a_run_and_pulls_what_hangs_at_a_deck():
    deck = replace(DECK, path=paths.external((0.0, 0.0, 1.0)), turning=None)
    scene = carried(deck=deck)
    with Session(carried(), dt=0.01, method="edmc") as session:
        for _ in range(20):
            session.step()
        run = simulate(carried(), 0.2, method="edmc", dt=0.01)
        assert np.array_equal(session.state.q, run.q[-1])
    with Session(scene, dt=0.01, method="edmc") as session:
        for k in range(1, 6):
            session.drive("deck", (0.0, 0.002 * k, 1.0), (0.0, 0.2, 0.0))
            session.push("pole", (0.0, 0.0, 0.1))
            session.step()
        mark, q = session.save(), session.state.q.copy()
        session.step()
        session.restore(mark)
        assert np.array_equal(session.state.q, q)
        assert_allclose(session.position("pole.a"), (0.3, 0.11, 1.0), atol=1e-14)


def test_scenes_and_runs_are_saved_with_joints(tmp_path):
    scene = pair(Gravity(G))
    save_scene(scene, tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == scene
    run = simulate(scene, 0.1, method="edmc", dt=0.01, start=spun(scene))
    run.save(tmp_path / "run.nc")
    again = load_run(tmp_path / "run.nc")
    assert np.array_equal(again.q, run.q) and again.scene == scene
    assert_allclose(Rotation.from_matrix(again.rotation("lower")[0]).as_rotvec(), LOWER["rotation"], atol=1e-12)


def test_far_from_the_origin_joints_are_as_near_it():
    far = np.array([5e5, -3e5, 0.0])
    points, cables = (
        [
            replace(ELSEWHERE[0][0], at=tuple(far + np.array((5, 0, 0)))),
            replace(ELSEWHERE[0][1], at=tuple(far + np.array((6, 0, 0)))),
        ],
        ELSEWHERE[1],
    )
    near = simulate(pair(Gravity(G)), 0.5, method="edmc", dt=0.005, start="straight")
    scene = replace(pair(Gravity(G), at=tuple(far)), points=points, cables=cables)
    run = simulate(scene, 0.5, method="edmc", dt=0.005, start="straight")
    assert_allclose(run.position("lower") - far, near.position("lower"), atol=1e-8)


def test_a_cable_breaks_at_a_body_that_is_pinned_to_another():
    scene = carried()
    brittle = replace(scene, cables=[replace(scene.cables[0], breaking_tension=2.3)])
    run = simulate(brittle, 1.0, method="edmc", dt=0.005)
    assert run.events and run.status == "done"
    assert_allclose(run.position("pole.a"), run.position("deck.hinge"), atol=1e-14)


def test_what_joints_cannot_be_is_said():
    points, cables = ELSEWHERE
    one, other = pair().bodies[::-1]

    def made(*bodies):
        return Scene(points, cables, bodies=bodies)

    with pytest.raises(SceneError, match=r"Argument `pinned` must be given with `pinned_to`.*has pinned_to='upper.low' alone"):
        replace(other, pinned=None)
    with pytest.raises(SceneError, match=r'must name a fixed or driven point.*has pinned_to="upper.lo", did you mean "upper.low"'):
        made(one, replace(other, pinned_to="upper.lo"))
    with pytest.raises(
        SceneError, match=r'`at` is left out, but body "lower" has at=\(1.0, 0.0, 0.0\) where pinned_to="upper.low"'
    ):
        made(one, replace(other, at=(1.0, 0.0, 0.0)))
    with pytest.raises(SceneError, match=r"pinned to one another in a circle, but .*are"):
        made(replace(one, at=None, pinned_to="lower.top"), replace(other, at=None))
    with pytest.raises(SceneError, match="must name a fixed or driven point"):
        made(one, replace(other, at=None, pinned_to="tip"))
    with pytest.raises(InputError, match=r'has its place and its velocity from that, but "lower" is pinned to "upper.low"'):
        spun(made(one, other)).moved("lower", at=(0.0, 0.0, 0.0))
    rigid = Scene(points, [replace(cables[0], EA=np.inf)], bodies=[one, other])
    with pytest.raises(InputError, match='Method "links" takes no body that is pinned to a point which may move, but "lower"'):
        simulate(rigid, 0.1, method="links")
