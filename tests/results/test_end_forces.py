"""Forces at the ends of cables and reactions: closed forms at rest, and the rate of momentum in motion."""

import numpy as np
import pytest
from hanging import MU, G, cable, held_net, hung

from anet_lumped import Body, Cable, Driven, Fixed, Free, PayloadChange, Scene, Session, equilibrium, paths, signals, simulate
from anet_lumped.checks import InputError
from anet_lumped.effects import Bending, Gravity, Ground, LineChange, Water
from anet_lumped.results.end_forces import UnknownForceError, end_force, end_forces_at_rest, rows_of_state

DOWN = np.array([0.0, 0.0, -G])
GRAVITY = Gravity(G)


def weight(scene):
    mass = sum(one.mass_per_length * one.length for one in scene.cables) + sum(point.mass for point in scene.free_points)
    return mass * DOWN


def test_a_cable_that_hangs_down_carries_all_of_it_at_the_top_and_nothing_at_its_loose_end():
    scene = Scene([Fixed("top", (0, 0, 0)), Free("end", 0.3)], [cable("end", "top", 2.0, segments=5)], [GRAVITY])
    rest = equilibrium(scene)
    assert rest.end_tension("end-top", "top") == pytest.approx((2.0 * MU + 0.3) * G, rel=1e-12)
    assert rest.end_tension("end-top", "end") == pytest.approx(0.3 * G, rel=1e-12)
    assert rest.reaction("top") == pytest.approx(-weight(scene), rel=1e-12)
    assert rest.tension("end-top")[-1] == pytest.approx((1.8 * MU + 0.3) * G, rel=1e-9)  # half a segment below


def test_the_end_tension_of_a_catenary_converges_from_few_segments():
    """y = a cosh(x/a): the tension at the end is mu g y. Segments are chords: the error falls as their length squared."""
    a, half = 1.0, 0.6
    length, height = 2.0 * a * np.sinh(half / a), a * np.cosh(half / a)
    errors = []
    for segments in (10, 20, 40):
        rest = equilibrium(hung((2.0 * half, 0, 0), length=length, EA=1e9, segments=segments))
        errors.append(rest.end_tension("a-b", "b") / (MU * G * height) - 1.0)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1) and abs(errors[2]) < 1e-3
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)


def test_cables_that_meet_share_nothing():
    """Four alike at a payload: each carries a quarter of the payload, and its own weight to its support."""
    scene = held_net()
    rest = equilibrium(scene)
    for k in range(4):
        assert rest.reaction(f"s{k}")[2] == pytest.approx(0.25 * 0.036 * G + MU * G, rel=1e-9)
        tilted = np.linalg.norm([*rest.reaction(f"s{k}")[:2], 0.25 * 0.036 * G])
        assert rest.end_tension(f"s{k}-p0", "p0") == pytest.approx(tilted, rel=1e-9)


@pytest.mark.parametrize("effects", [(GRAVITY,), (GRAVITY, Water(g=G), Ground(height=-1.9))])
def test_all_end_forces_of_a_rest_at_once_are_those_of_each_cable(effects):
    """Cables of one segment and of several, drawn from either end, in the air and in water on the ground."""
    points = [Fixed("a", (0, 0, -1)), Fixed("b", (1.0, 0, -1.2)), Free("p", 0.02), Free("end", 0.3)]
    cables = [cable("a", "p", 1.0, segments=1, diameter=0.01), cable("p", "b", 0.9, segments=4, diameter=0.01),
              cable("end", "p", 1.5, segments=3, diameter=0.02)]  # fmt: skip
    rest = equilibrium(Scene(points, cables, effects))
    rows = rows_of_state(rest)
    each = [[end_force(rows, rest.scene, one.name, end)[0] for end in (one.start, one.end)] for one in rest.scene.cables]
    assert end_forces_at_rest(rows) == pytest.approx(np.array(each), rel=1e-14, abs=1e-15)
    assert np.linalg.norm(each, axis=2).min() > 0.0 and len({round(float(x), 9) for x in np.ravel(each)}) > 6


def test_reactions_and_the_ground_carry_what_lies_and_hangs_in_water():
    """A chain from the bottom, clamped against bending: wet weight and all reactions are in balance."""
    chain = Cable("anchor", "fair", length=30.0, mass_per_length=20.0, EA=1e6, segments=12, diameter=0.05, EI=500.0)
    points = [Fixed("anchor", (0, 0, -10.001)), Fixed("fair", (25, 0, -1))]
    bending = Bending({"fair": (-1.0, 0.0, -0.4)})
    rest = equilibrium(Scene(points, [chain], [GRAVITY, Ground(height=-10.0), Water(g=G), bending]))
    wet = (20.0 - 1025.0 * np.pi / 4.0 * 0.05**2) * 30.0 * G
    assert rest.reaction("ground")[2] > 0.3 * wet
    total = rest.reaction("ground") + rest.reaction("anchor") + rest.reaction("fair")
    assert total == pytest.approx((0, 0, wet), abs=1e-6 * wet)  # what statics leave of the ground's stiffness


def momentum(run):
    """Momentum of all nodes, (k, 3) [N s]."""
    return np.einsum("i,kix->kx", run.model.mass, run.v)


def test_a_driven_point_gives_the_net_its_momentum():
    """R + weight = dP/dt, by central differences of half a millisecond, with the half segments at the driven point."""
    points = [Driven("hand", paths.harmonic((0, 0, 0), (0.1, 0, 0.02), 1.0, ramp=0.5)), Free("end", 0.05)]
    scene = Scene(points, [cable("hand", "end", EA=100.0, segments=4, zeta=0.3)], [GRAVITY])
    run = simulate(scene, 0.5, method="edmc", dt=5e-4, save_every=5e-4)
    rate = (momentum(run)[2:] - momentum(run)[:-2]) / (run.t[2:] - run.t[:-2])[:, None]
    force = run.reaction("hand")[1:-1] + weight(scene)
    assert force[2:] == pytest.approx(rate[2:], abs=2e-3 * np.abs(run.reaction("hand")).max())  # order 2 in the step
    acceleration = np.gradient(run.velocity("end"), run.t, axis=0)[4:-4]
    pull = np.linalg.norm(0.05 * (DOWN - acceleration), axis=1)
    assert run.end_tension("hand-end", "end")[4:-4] == pytest.approx(pull, abs=2e-3 * pull.max())


def test_a_body_is_pulled_by_what_accelerates_it():
    """m a = m g + pull, of a body on one hook off its centre, by central differences of its centre of mass."""
    body = Body("box", mass=0.4, inertia=(2e-3, 3e-3, 4e-3), at=(0.1, 0, -1.05), attachments={"hook": (0.02, 0.05, 0.04)})
    scene = Scene([Fixed("top", (0, 0, 0))], [cable("top", "box.hook", EA=300.0, segments=3, mu=0.3)], [GRAVITY], bodies=[body])
    run = simulate(scene, 0.1, start="straight", method="edmc", dt=2e-4, save_every=2e-4)
    acceleration = np.gradient(run.velocity("box"), run.t, axis=0)[6:-6]
    pull = np.linalg.norm(0.4 * (acceleration - DOWN), axis=1)
    assert run.end_tension("top-box.hook", "box.hook")[6:-6] == pytest.approx(pull, abs=5e-3 * pull.max())


def test_a_pinned_body_swings_about_its_pivot():
    """The pull on its hook turns it: moments about the pivot, with the angular acceleration by central differences."""
    body = Body("arm", mass=0.4, inertia=(2e-3, 2e-3, 2e-3), at=(0, 0, 0), attachments={"tip": (0.2, 0, 0)}, pinned="")
    scene = Scene([Fixed("top", (0.2, 0, 1.02))], [cable("top", "arm.tip", EA=300.0, segments=3, mu=0.3)], [GRAVITY], bodies=[body])
    run = simulate(scene, 0.012, start="straight", method="edmc", dt=2e-4, save_every=2e-4)
    moment = 2e-3 * np.gradient(run.angular_velocity("arm")[:, 1], run.t)[6:-6]
    pull = run.end_tension("top-arm.tip", "arm.tip")[6:-6]  # nearly straight up, at 0.2 m
    arm = run.position("arm.tip")[6:-6]
    assert moment == pytest.approx(-pull * arm[:, 0], abs=0.01 * np.abs(pull * arm[:, 0]).max())


def test_a_line_that_is_paid_out_hangs_with_its_weight_of_now():
    scene = Scene([Fixed("top", (0, 0, 0)), Free("end", 0.5)], [cable("top", "end", EA=1e4, segments=4)], [
        GRAVITY, LineChange({"top-end": signals.line(0.0, 0.2, 0.5)})
    ])  # fmt: skip
    run = simulate(scene, 2.0, method="edmc", dt=0.01)
    length = 1.0 + 0.2 * (run.t[-1] - 0.25)
    assert run.end_tension("top-end", "top")[-1] == pytest.approx((0.5 + length * MU) * G, rel=2e-3)  # it still swings a little


def test_what_has_broken_does_not_pull():
    one = cable("top", "end", 1.0, EA=1e3, segments=2, breaking_tension=6.0)
    scene = Scene([Fixed("top", (0, 0, 0)), Free("end", 0.3)], [one], [GRAVITY], events=[PayloadChange("end", 0.02, 1.0)])
    run = simulate(scene, 0.1, method="edmc", dt=0.005)
    event = run.events[-1]
    end = "top" if event.segment == 0 else "end"
    assert run.end_tension("top-end", end)[-1] == 0.0 and run.end_tension("top-end", end)[0] > 0.29 * G
    other = "end" if end == "top" else "top"
    assert run.end_tension("top-end", other)[-1] < 1.0  # what hangs there still


def test_what_has_no_end_tension_or_reaction_is_refused():
    rest = equilibrium(held_net())
    with pytest.raises(InputError, match=r'an end tension where it ends, at "s0" or "p0" for cable "s0-p0", but "s1" was given'):
        rest.end_tension("s0-p0", "s1")
    with pytest.raises(
        InputError, match=r'the force of a fixed or driven point, of a driven body, of the pin .* but "p0" moves freely'
    ):
        rest.reaction("p0")
    with pytest.raises(InputError, match=r'There is no ground that could have a reaction, and no point "ground", in this scene'):
        rest.reaction("ground")


def test_a_point_driven_from_outside_has_no_known_acceleration():
    scene = Scene([Driven("hand", paths.external((0, 0, 0))), Free("end", 0.05)], [cable("hand", "end")], [GRAVITY])
    session = Session(scene, dt=0.01)
    session.step()
    with pytest.raises(UnknownForceError, match=r'needs the acceleration there, but "hand" is driven from outside, by a Session'):
        session.state.end_tension("hand-end", "hand")


def test_forces_from_outside_are_not_known_afterwards():
    session = Session(held_net(), dt=0.01)
    session.step()
    assert session.state.end_tension("s0-p0", "p0") > 0.1
    session.push("p0", (0.0, 0.0, 0.5))
    session.step()
    assert session.state.reaction("s0")[2] > 0.1
    with pytest.raises(UnknownForceError, match=r'all forces there, but "p0" moves freely, and forces from outside act'):
        session.state.end_tension("s0-p0", "p0")
