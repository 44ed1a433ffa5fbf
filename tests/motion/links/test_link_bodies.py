"""Rigid bodies on cables that do not stretch: against solutions of their own, other methods, and what has to be kept."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from anet_lumped import Body, Cable, Fixed, Free, Scene, Session, State, signals, simulate
from anet_lumped.effects import Gravity, LineChange, Water
from anet_lumped.model.build import build
from anet_lumped.motion.link_legs import REDUNDANT
from anet_lumped.motion.simulate import straight
from anet_lumped.results.events import BREAK, SLACK, TAUT

G = 9.81
CORNERS = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
RTOL = 1e-12
# Order 8 at a tolerance of 1e-12 a step leaves some 1e-12 m a step, which phase errors add up over a few hundred steps.
CLOSE = 2e-9


def at_rest(scene, **motion):
    """The state with straight cables, and bodies in motion if any is given: by a body's name, what `State.moved` takes."""
    model = build(scene)
    state = State(model, 0.0, straight(model), np.zeros((model.n, 3)), np.zeros(model.n_segments))
    for name, own in motion.items():
        state = state.moved(name, **own)
    return state


def box(EA=math.inf, segments=1, compression="linear", drop=1.5, **more):
    """A box hung on four slanted cables at its upper corners; its centre of mass is below its middle, and beside it."""
    hooks = {f"h{k}": (0.3 * x, 0.2 * y, 0.1) for k, (x, y) in enumerate(CORNERS)}
    body = Body(
        "box", mass=4.0, inertia=(0.09, 0.16, 0.2), at=(0, 0, -drop), attachments=hooks, centre_of_mass=(0.02, -0.01, -0.05)
    )
    points = [Fixed(f"f{k}", (0.8 * x, 0.7 * y, 0.0)) for k, (x, y) in enumerate(CORNERS)]
    length = math.dist((0.8, 0.7, 0.0), (0.3, 0.2, 0.1 - drop))
    cables = [
        Cable(f"f{k}", f"box.h{k}", length=length, mass_per_length=0.2, EA=EA, segments=segments, compression=compression, **more)
        for k in range(4)
    ]
    return Scene(points, cables, [Gravity(G)], bodies=[body])


def swung(scene):
    """The box set off, with the velocities that links leave to it; its places and velocities keep all lengths."""
    begin = at_rest(scene, box=dict(velocity=(0.3, 0.5, 0.1), angular_velocity=(0.2, -0.1, 0.6)))
    rigid = replace(scene, cables=[replace(cable, EA=math.inf) for cable in scene.cables])
    kept = simulate(rigid, 1e-3, method="links", rtol=RTOL, start=replace(begin, model=build(rigid))).state(0)
    return replace(begin, v=kept.v)


def off_length(run):
    """Largest share by which a segment of a run is off its length."""
    d = np.diff(run.q[:, run.model.ends], axis=2)[:, :, 0]
    L = np.array([cable.L0 for cable in run.scene.cables])[run.model.cable_of]
    return np.abs(np.linalg.norm(d, axis=-1) / L - 1.0).max()


def off_shape(run, body):
    """Largest change of a distance between two points of a body [m]."""
    nodes = [run.model.node(point.name) for point in run.scene.body(body).points]
    own = np.array([point.arm for point in run.scene.body(body).points])
    apart = np.linalg.norm(run.q[:, nodes, None] - run.q[:, None, nodes], axis=-1)
    return np.abs(apart - np.linalg.norm(own[:, None] - own, axis=-1)).max()


@pytest.mark.parametrize("segments", [pytest.param(1, marks=pytest.mark.slow), 4])
def test_edmc_converges_to_links_at_order_2(segments):
    """Four steps; the errors of edmc, places and velocities, against links at a tolerance that leaves nothing of that size."""
    scene = box(segments=segments)
    begin, T = swung(scene), 0.512
    exact = simulate(scene, T, method="links", rtol=RTOL, start=begin, save_every=T)
    steps, errors = np.array([8e-3, 4e-3, 2e-3, 1e-3]), []
    for h in steps:
        run = simulate(scene, T, method="edmc", dt=h, start=begin, save_every=T)
        errors.append([np.abs(run.q[-1] - exact.q[-1]).max(), np.abs(run.v[-1] - exact.v[-1]).max()])
    slopes = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert exact.ok and exact.events == () and exact.method == "links"
    np.testing.assert_allclose(slopes, 2.0, atol=0.15)
    assert errors[-1][0] < 1e-5


@pytest.mark.parametrize("method", ["links", "links5"])
def test_stiff_elastic_cables_tend_to_links(method):
    """Cables that start unstretched ring about their stretch, T/EA: the difference is of that size, and falls with EA."""
    scene, T = box(), 0.5
    options = dict(rtol=RTOL) if method == "links" else dict(dt=1e-3)
    exact = simulate(scene, T, method=method, start=swung(scene), save_every=0.1, **options)
    apart = []
    for EA in (1e6, 1e8):
        elastic = box(EA=EA)
        run = simulate(elastic, T, method="dop853", rtol=1e-9, start=swung(elastic), save_every=0.1)
        apart.append(np.abs(run.q - exact.q).max())
    stretch = exact.segment_tension.max() / np.array([1e6, 1e8]) * scene.cables[0].length
    assert exact.ok and np.all(apart < 10.0 * stretch) and apart[1] < apart[0] / 30.0


@pytest.mark.parametrize("method", ["links", "links5"])
def test_lengths_shape_and_energy_are_kept(method):
    scene = box(segments=3)
    options = dict(rtol=1e-9) if method == "links" else dict(dt=2e-3)
    run = simulate(scene, 2.0, method=method, start=swung(scene), save_every=0.02, **options)
    assert run.ok and off_length(run) < 1e-13 and off_shape(run, "box") < 1e-14
    assert abs(run.energy_balance.by_method) < 1e-8 * run.energy_balance.in_play and run.warnings == ()


def pendulum(a, b, rate_a, rate_b, pinned=False):
    """A cable of l, and a body hung from its end by a hook at c above the centre of mass, in the plane of x and z.

    Its state at the angles a and b from the vertical, and its own equations in these.
    """
    l, c, M, J, mu = 0.8, 0.35, 1.7, 0.06, 0.3
    hook = np.array([l * math.sin(a), 0.0, -l * math.cos(a)])
    centre = hook + c * np.array([math.sin(b), 0.0, -math.cos(b)])
    body = Body("bob", mass=M, inertia=(0.05, J, 0.04), at=centre, rotation=(0.0, -b, 0.0), attachments={"hook": (0, 0, c)})
    cable = Cable("o", "bob.hook", length=l, mass_per_length=mu, EA=math.inf, segments=1, compression="linear")
    scene = Scene([Fixed("o", (0, 0, 0))], [cable], [Gravity(G)], bodies=[body])
    rate = rate_a * l * np.array([math.cos(a), 0, math.sin(a)]) + rate_b * c * np.array([math.cos(b), 0, math.sin(b)])
    begin = at_rest(scene, bob=dict(velocity=tuple(rate), angular_velocity=(0.0, -rate_b, 0.0)))
    m = M + 0.5 * mu * l  # half of the cable hangs at the hook

    def equations(t, y):
        a, b, da, db = y
        s, k = math.sin(a - b), math.cos(a - b)
        mass = np.array([[m * l * l, M * l * c * k], [M * l * c * k, M * c * c + J]])
        force = [-M * l * c * s * db**2 - m * G * l * math.sin(a), M * l * c * s * da**2 - M * G * c * math.sin(b)]
        return [da, db, *np.linalg.solve(mass, force)]

    return scene, begin, equations


@pytest.mark.parametrize("start", [(0.5, 0.9, 0.0, 0.0), (1.2, -1.0, 0.7, 2.0)])
def test_double_pendulum_of_a_cable_and_a_body(start):
    scene, begin, equations = pendulum(*start)
    run = simulate(scene, 2.0, method="links", rtol=RTOL, start=begin, save_every=0.1)
    own = solve_ivp(equations, (0.0, 2.0), start, method="DOP853", rtol=1e-13, atol=1e-13, t_eval=run.t)
    hook, R = run.position("bob.hook"), run.rotation("bob")
    np.testing.assert_allclose(hook[:, [0, 2]], 0.8 * np.stack([np.sin(own.y[0]), -np.cos(own.y[0])], axis=1), atol=CLOSE)
    np.testing.assert_allclose(R[:, [0, 2], 2], np.stack([-np.sin(own.y[1]), np.cos(own.y[1])], axis=1), atol=CLOSE)
    np.testing.assert_allclose(run.angular_velocity("bob")[:, 1], -own.y[3], atol=10 * CLOSE)
    assert run.ok and np.abs(hook[:, 1]).max() < 1e-13


def test_coarse_steps_leave_bodies_in_one_piece():
    """A step that is wrong by far more than rounding leaves neither shape nor velocities with a share of that."""
    scene, begin, _ = pendulum(1.2, -1.0, 0.0, 8.0)
    run = simulate(scene, 0.4, method="links", dt=0.02, start=begin, save_every=0.04)
    exact = simulate(scene, 0.4, method="links", rtol=RTOL, start=begin, save_every=0.04)
    nodes = [run.model.node(point.name) for point in scene.bodies[0].points]
    d, rate = (x[:, nodes, None] - x[:, None, nodes] for x in (run.q, run.v))
    assert run.ok and run.method == "links5" and off_length(run) < 1e-13 and off_shape(run, "bob") < 1e-14
    assert np.abs((d * rate).sum(axis=-1)).max() < 1e-13
    assert np.abs(run.q[-1] - exact.q[-1]).max() > 1e-5


def test_bifilar_pendulum():
    """A bar on two parallel cables turns about the vertical, omega^2 = m g b^2/(J L), with half of each cable's mass on the bar.

    What is left out of small angles is of the third order in the angle.
    """
    L, b, m, J, mu, angle = 1.2, 0.25, 2.0, 0.07, 0.1, 1e-3
    body = Body("bar", mass=m, inertia=(0.02, 0.06, J), at=(0, 0, -L), attachments={"l": (-b, 0, 0), "r": (b, 0, 0)})
    points = [Fixed("l", (-b, 0, 0)), Fixed("r", (b, 0, 0))]
    cables = [Cable(p, f"bar.{p}", length=L, mass_per_length=mu, EA=math.inf, segments=1) for p in "lr"]
    scene = Scene(points, cables, [Gravity(G)], bodies=[body])
    omega = math.sqrt((m + mu * L) * G * b**2 / ((J + mu * L * b**2) * L))
    begin = at_rest(scene, bar=dict(angular_velocity=(0, 0, omega * angle)))
    run = simulate(scene, 2.5 * 2.0 * math.pi / omega, method="links", rtol=RTOL, start=begin, save_every=0.05)
    turned = np.arctan2(run.rotation("bar")[:, 1, 0], run.rotation("bar")[:, 0, 0])
    # the frequency is off by a share of about angle^2, over 16 rad of swinging
    np.testing.assert_allclose(turned, angle * np.sin(omega * run.t), atol=30.0 * angle**3)
    assert run.ok and run.events == () and np.ptp(turned) > 1.9 * angle


def test_free_fall_keeps_momenta():
    """A body between two cables with balls at their ends, thrown with spin."""
    body = Body("box", mass=1.5, inertia=(0.05, 0.08, 0.1), at=(0, 0, 0), attachments={"l": (-0.3, 0.1, 0), "r": (0.3, 0, 0.1)})
    points = [Free("a", mass=0.4, at=(-1.3, 0.1, 0)), Free("b", mass=0.7, at=(1.0, 0.7, 0.1))]
    own = dict(mass_per_length=0.2, EA=math.inf, segments=3, compression="linear")
    cables = [Cable("a", "box.l", length=1.0, **own), Cable("b", "box.r", length=0.7 * math.sqrt(2.0), **own)]
    scene = Scene(points, cables, [Gravity(G)], bodies=[body])
    model = build(scene)
    spin, drift, q = np.array([0.4, -1.0, 2.0]), np.array([1.0, 0.3, 2.0]), at_rest(scene).q
    begin = replace(
        at_rest(scene), v=drift + np.cross(spin, q) * (1.0 + 0.3 * np.isin(np.arange(model.n), model.nodes("a-box.l")))[:, None]
    )
    begin = begin.moved("box", velocity=tuple(drift), angular_velocity=tuple(spin))
    run = simulate(scene, 1.0, method="links", rtol=RTOL, start=begin, save_every=0.1)
    m, t = model.mass[:, None], run.t[:, None]
    momentum, centre = (m * run.v).sum(axis=1), (m * run.q).sum(axis=1) / m.sum()
    angular = np.cross(run.q - centre[:, None], m * (run.v - momentum[:, None] / m.sum())).sum(axis=1)
    weight = m.sum() * G * np.array([0, 0, -1.0])
    assert run.ok and off_length(run) < 1e-13
    np.testing.assert_allclose(
        momentum - weight * t, np.tile((m * begin.v).sum(axis=0), (len(t), 1)), rtol=0.0, atol=1e-12 * np.abs(momentum).max()
    )
    np.testing.assert_allclose(angular, np.tile(angular[0], (len(t), 1)), rtol=0.0, atol=1e-12 * np.abs(angular).max())
    at_start = np.cross(begin.q - centre[0], m * (begin.v - momentum[0] / m.sum())).sum(axis=0)
    np.testing.assert_allclose(angular[0], at_start, rtol=1e-12)  # the impulse that begins the motion keeps it, too


def test_cables_that_would_push_are_left_to_edmc():
    """A box thrown up leaves its cables slack, falls, and is taken back by links; until it is caught, edmc has the same motion.

    Catching takes the energy of the fall, and edmc takes another share of it at each step.
    """
    scene = box(compression="none", segments=4)
    begin = at_rest(scene, box=dict(velocity=(0, 0, 1.0)))
    run = simulate(scene, 0.6, method="links", rtol=1e-9, start=begin, save_every=0.02)
    alone = simulate(scene, 0.6, method="edmc", dt=2.5e-4, start=begin, save_every=0.02)
    slack, taut = (next(event for event in run.events if event.kind == kind) for kind in (SLACK, TAUT))
    assert run.ok and slack.t == 0.0 and 0.2 < taut.t < 0.6
    free = run.t < 0.15
    np.testing.assert_allclose(run.q[free], alone.q[free], atol=1e-4)
    assert off_length_beyond(run) < 1e-5 and abs(run.energy_balance.imbalance) < 1e-5
    assert run.segment_tension[run.t > taut.t + 0.02].min() > 0.0


def off_length_beyond(run):
    """Largest share by which a segment is longer than it is."""
    d = np.diff(run.q[:, run.model.ends], axis=2)[:, :, 0]
    L = np.array([cable.L0 for cable in run.scene.cables])[run.model.cable_of]
    return (np.linalg.norm(d, axis=-1) / L - 1.0).max()


def hung_beneath_an_arm():
    """A ball on a cable at the tip of an arm that is pinned at its root."""
    arm = Body(
        "arm",
        mass=2.0,
        inertia=(0.05, 0.06, 0.03),
        at=(0, 0, 0),
        attachments={"tip": (0.5, 0, 0)},
        centre_of_mass=(0.2, 0, 0),
        pinned="",
    )
    cable = Cable("arm.tip", "m", length=0.8, mass_per_length=0.2, EA=math.inf, segments=4, compression="linear")
    return Scene([Free("m", mass=1.0, at=(0.5, 0, -0.8))], [cable], [Gravity(G)], bodies=[arm])


def in_water():
    """The box and its cables deep in water, whose inertia is another one along a cable than across."""
    return replace(box(segments=2, diameter=0.03), effects=[Gravity(G), Water(level=10.0)])


def reeled_in():
    """The box, one of whose cables is reeled in, with its mass."""
    scene = box(segments=2)
    length = signals.harmonic(-0.01, 0.01, 1.0, phase=0.5 * math.pi)  # as it is at first, with no rate
    return replace(scene, effects=[Gravity(G), LineChange({"f0-box.h0": length})])


@pytest.mark.parametrize("made", [in_water, hung_beneath_an_arm, reeled_in])
def test_edmc_converges_to_links_with(made):
    """A fluid that nodes carry along, a pivot, a length that changes: from rest, with straight cables."""
    scene, T = made(), 0.256
    begin = at_rest(scene)
    exact = simulate(scene, T, method="links", rtol=1e-10, start=begin, save_every=T)
    steps = np.array([4e-3, 2e-3, 1e-3])
    errors = [np.abs(simulate(scene, T, method="edmc", dt=h, start=begin, save_every=T).q[-1] - exact.q[-1]).max() for h in steps]
    assert exact.ok and exact.events == ()
    np.testing.assert_allclose(np.diff(np.log(errors)) / np.diff(np.log(steps)), 2.0, atol=0.15)


def test_explicit_steps_in_water():
    """Elastic cables: dop853 and edmc agree to the error of edmc, of order 2, where the body carries along what its nodes do."""
    scene = in_water()
    scene = replace(scene, cables=[replace(cable, EA=1e4, zeta=0.05) for cable in scene.cables])
    begin = at_rest(scene, box=dict(velocity=(0.3, 0.5, 0.1), angular_velocity=(0.2, -0.1, 0.6)))
    exact = simulate(scene, 0.2, method="dop853", rtol=1e-10, start=begin, save_every=0.1)
    apart = [
        np.abs(simulate(scene, 0.2, method="edmc", dt=h, start=begin, save_every=0.1).q - exact.q).max() for h in (5e-4, 2.5e-4)
    ]
    assert apart[1] < 1e-5 and 3.5 < apart[0] / apart[1] < 5.0


def test_a_strut_within_a_body_carries_nothing():
    """A cable of one segment between two attachments of a body neither slackens nor is told to be redundant."""
    hooks = {"a": (0.3, 0.2, 0.1), "b": (-0.3, 0.2, 0.1)}
    body = Body("box", mass=4.0, inertia=(0.09, 0.16, 0.2), at=(0, 0, -1.5), attachments=hooks)
    top, at = (0.5, 0.2, 0.0), (0.3, 0.2, -1.4)
    own = dict(mass_per_length=0.2, EA=math.inf, segments=1, compression="none")
    cables = [Cable("f", "box.a", length=math.dist(top, at), **own), Cable("box.a", "box.b", length=0.6, **own)]
    scene = Scene([Fixed("f", top)], cables, [Gravity(G)], bodies=[body])
    run = simulate(scene, 0.5, method="links", rtol=1e-10, start=at_rest(scene), save_every=0.01)
    edmc = simulate(scene, 0.5, method="edmc", dt=1e-3, start=at_rest(scene), save_every=0.01)
    assert run.ok and run.events == () and run.warnings == () and np.all(run.tension("box.a-box.b") == 0.0)
    np.testing.assert_allclose(run.q, edmc.q, atol=2e-5)


def test_lengths_at_a_body_that_follow_from_others():
    """Two cables side by side share the pull of one with the mass of both, and the motion is that of this one."""
    scene = box()
    first = scene.cables[0]
    second = replace(first, name="beside", mass_per_length=0.1)
    both = replace(scene, cables=[*scene.cables, second])
    one = replace(scene, cables=[replace(first, mass_per_length=0.3), *scene.cables[1:]])
    motion = dict(velocity=(0.3, 0.5, 0.1))
    run, single = (simulate(s, 0.4, method="links", rtol=1e-10, start=at_rest(s, box=motion), save_every=0.1) for s in (both, one))
    assert run.ok and REDUNDANT in run.warnings
    for point in scene.bodies[0].points:
        np.testing.assert_allclose(run.position(point.name), single.position(point.name), atol=1e-9)
    together = run.tension(first.name) + run.tension("beside")
    np.testing.assert_allclose(together, single.tension(first.name), rtol=1e-6)


def test_a_cable_of_a_body_breaks():
    """At its strength, within a step; afterwards the box goes on as edmc has it."""
    scene = box()
    begin, intact = swung(scene), simulate(scene, 0.5, method="links", rtol=1e-9, start=swung(scene), save_every=0.01)
    pulls = intact.segment_tension
    worst = int((pulls.max(axis=0) / pulls[0]).argmax())  # the cable whose pull rises most
    strength = 0.5 * (pulls[0, worst] + pulls[:, worst].max())
    name = scene.cables[intact.model.cable_of[worst]].name
    brittle = replace(scene, cables=[replace(c, breaking_tension=strength) if c.name == name else c for c in scene.cables])
    start = replace(begin, model=build(brittle))
    run = simulate(brittle, 0.4, method="links", rtol=1e-10, start=start, save_every=0.1)
    alone = simulate(brittle, 0.4, method="edmc", dt=2.5e-4, start=start, save_every=0.1)
    (event,) = [event for event in run.events if event.kind == BREAK]
    assert run.ok and event.where == name and event.tension == pytest.approx(strength, rel=1e-6)
    np.testing.assert_allclose(run.q, alone.q, atol=1e-4)


def test_a_session_takes_the_steps_of_a_run():
    scene = box()
    session = Session(scene, 1e-3, method="links", start=swung(scene))
    for _ in range(50):
        session.step()
    run = simulate(scene, 0.05, method="links", dt=1e-3, start=swung(scene))
    np.testing.assert_allclose(session.state.q, run.q[-1], rtol=0.0, atol=1e-13)


def test_an_impulse_begins_a_run_of_edmc():
    """Velocities that would change lengths are those of links from the first step on, with the energy that this takes told."""
    scene = box()
    begin = at_rest(scene, box=dict(velocity=(0.3, 0.5, 0.1)))
    run = simulate(scene, 0.05, method="edmc", dt=1e-3, start=begin)
    linked = simulate(scene, 0.05, method="links", rtol=1e-9, start=begin)
    np.testing.assert_allclose(run.v[0], linked.v[0], atol=1e-13)
    assert np.abs(run.v[0] - begin.v).max() > 1e-3


def test_small_steps_of_edmc_converge():
    """The turns of a body by which the last iterations correct it are smaller than the rounding of its arms."""
    scene = box(compression="none")
    begin = at_rest(scene, box=dict(velocity=(0, 0, 1.0)))
    run = simulate(scene, 0.3, method="edmc", dt=2.5e-4, start=begin)
    assert run.ok and run.work.halvings == 0
