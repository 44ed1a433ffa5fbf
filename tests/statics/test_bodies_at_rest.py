"""Rests of rigid bodies: forces and moments balance, and the rest is stable."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from anet_lumped import Body, Cable, Fixed, Free, NoRestError, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity, Ground, ViscousDamping, Water

G = 9.81


def box(**given):
    arguments = dict(mass=2.0, inertia=(0.02, 0.03, 0.04), at=(0.0, 0.0, -1.1), attachments={"eye": (0.1, 0.0, 0.1)}) | given
    return Body("box", **arguments)


def rope(start, end, **given):
    return Cable(start, end, **dict(length=1.0, mass_per_length=0.1, EA=1e4, segments=10) | given)


@pytest.mark.parametrize("EA", [1e3, 1e6, np.inf])
def test_on_one_cable_the_centre_of_mass_hangs_under_the_eye(EA):
    rest = equilibrium(Scene([Fixed("a", (0, 0, 0))], [rope("a", "box.eye", EA=EA)], [Gravity(G)], bodies=[box()]))
    eye, arm = rest.position("box.eye"), np.hypot(0.1, 0.1)
    assert_allclose(rest.position("box") - eye, (0.0, 0.0, -arm), atol=1e-9)
    assert_allclose(rest.tension("a-box.eye")[-1], (2.0 + 0.05 * 0.1) * G, rtol=1e-9)  # and half of the last segment
    assert rest.residual < 1e-9 and rest.stable


def test_forces_and_moments_balance_on_four_unlike_cables():
    corners = {"a": (0.2, 0.15, 0.05), "b": (-0.2, 0.15, 0.05), "c": (-0.2, -0.15, 0.05), "d": (0.2, -0.15, 0.05)}
    body = box(attachments=corners, centre_of_mass=(0.05, 0.02, -0.01))
    points = [Fixed(name, (2.0 * x, 2.0 * y, 1.0 + 0.2 * x)) for name, (x, y, _) in corners.items()]
    cables = [rope(name, f"box.{name}", length=1.9 + 0.1 * i, segments=4) for i, name in enumerate(corners)]
    rest = equilibrium(Scene(points, cables, [Gravity(G)], bodies=[body]))
    check_balanced(rest, body)


def check_balanced(rest, body, weight=2.0 * G):
    """Forces and moments of all cables that end at a body balance with its weight less its buoyancy [N] at its centre of mass."""
    centre = rest.position(body.name) + rest.rotation(body.name) @ body.centre_of_mass
    force, moment, most = np.array([0.0, 0.0, -weight]), np.zeros(3), weight
    for cable in rest.scene.cables:
        shape, half = rest.shape(cable.name), 0.5 * cable.L0 * cable.mass_per_length * G
        along = shape[-2] - shape[-1]
        pull = rest.tension(cable.name)[-1] * along / np.linalg.norm(along) - np.array([0.0, 0.0, half])
        force += pull
        moment += np.cross(shape[-1] - centre, pull)
        most = max(most, np.linalg.norm(pull))
    assert_allclose(force, np.zeros(3), atol=4e-9 * most)
    assert_allclose(moment, np.zeros(3), atol=4e-9 * most)


@pytest.mark.parametrize("seed", range(12))
def test_a_body_hangs_on_random_cables_that_stretch_or_not(seed):
    """Of 110 such scenes 12 were refused: pseudo-steps of cables that do not stretch came to 1e-7 of the load and no nearer."""
    rng = np.random.default_rng(seed)
    eyes = {f"e{i}": rng.normal(size=3) for i in range(rng.integers(2, 5))}
    body = Body("box", mass=2.0, inertia=(1.0, 1.0, 1.0), at=(0, 0, -5), attachments=eyes, centre_of_mass=0.2 * rng.normal(size=3))
    points = [Fixed(f"s{name}", (*(3.0 * at[:2]), 5.0 * rng.uniform(0, 0.3))) for name, at in eyes.items()]
    cables = [
        rope(f"s{name}", f"box.{name}", length=rng.uniform(5, 7.5), mass_per_length=10 ** rng.uniform(-2, 0),
             EA=rng.choice([np.inf, 1e5]), segments=int(rng.integers(1, 20)))
        for name in eyes
    ]  # fmt: skip
    rest = equilibrium(Scene(points, cables, [Gravity(G)], bodies=[body]))
    assert rest.stable and rest.residual < 1e-9
    check_balanced(rest, body)


def test_it_is_where_a_damped_motion_ends():
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0.6, 0.1, 0.0))], [rope("a", "box.eye"), rope("b", "box.other")],
                  [Gravity(G), ViscousDamping(3.0)],
                  bodies=[box(attachments={"eye": (0.1, 0.0, 0.1), "other": (-0.1, 0.05, 0.1)})])  # fmt: skip
    rest = equilibrium(scene)
    run = simulate(scene, 40.0, method="edmc", dt=0.02, start=rest.moved("box", velocity=(0.2, 0.1, 0.0)))
    assert_allclose(run.final.q, rest.q, atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_a_float_too_small_for_its_moorings_lies_with_them_on_the_ground(seed):
    """Their slack segments push and fold: 13 of 14 such scenes were refused, because no descent knew how bodies turn."""
    rng = np.random.default_rng(seed)
    at = {f"f{i}": np.array([np.cos(angle), np.sin(angle), 0.0]) for i, angle in enumerate(np.pi / 3 * np.arange(6))}
    eyes = {name: 0.5 * a for name, a in at.items()}
    body = Body("buoy", mass=660.0, inertia=(92.0, 92.0, 92.0), at=(0, 0, -30), attachments=eyes, volume=1.0)
    lines = [
        Cable(f"s{name}", f"buoy.{name}", length=rng.uniform(403, 445), mass_per_length=12.0, EA=1e7,
              segments=int(rng.integers(10, 30)), diameter=0.05, compression="linear")
        for name in at
    ]  # fmt: skip
    anchors = [Fixed(f"s{name}", (*(380.0 * a[:2]), -140.0)) for name, a in at.items()]
    water = Water(density=1025.0)
    rest = equilibrium(Scene(anchors, lines, [Gravity(G), water, Ground(height=-140.0)], bodies=[body]))
    assert rest.stable and rest.residual < 1e-9
    wet = (12.0 - 1025.0 * np.pi / 4 * 0.05**2) * G * sum(line.length for line in lines)
    held = rest.reaction("ground")[2] + sum(rest.reaction(anchor.name)[2] for anchor in anchors)
    assert held == pytest.approx(wet - (1025.0 - 660.0) * G, rel=1e-7)
    assert rest.position("buoy")[2] == pytest.approx(-140.0, abs=0.01)


def test_a_pinned_body_turns_until_its_moments_balance():
    body = box(at=(0.0, 0.0, 0.0), centre_of_mass=(0.3, 0.0, 0.0), attachments={"eye": (0.6, 0.0, 0.0)}, pinned="")
    rest = equilibrium(Scene([Free("w", mass=0.2)], [rope("box.eye", "w", length=0.5, segments=4)], [Gravity(G)], bodies=[body]))
    assert_allclose(rest.position("box.eye"), (0.0, 0.0, -0.6), atol=1e-9)
    assert_allclose(rest.position("box"), np.zeros(3), atol=1e-12)


def test_a_body_between_a_pin_and_a_cable_by_the_lever():
    """A bar of length b pinned at one end and held level by a vertical cable at the other carries half of its weight there."""
    body = box(at=(0.0, 0.0, 0.0), centre_of_mass=(0.3, 0.0, 0.0), attachments={"eye": (0.6, 0.0, 0.0)}, pinned="")
    cable = rope("a", "box.eye", EA=1e7, mass_per_length=1e-6, segments=1)
    rest = equilibrium(Scene([Fixed("a", (0.6, 0.0, 1.0))], [cable], [Gravity(G)], bodies=[body]))
    assert_allclose(rest.tension("a-box.eye")[0], 0.5 * 2.0 * G, rtol=1e-5)


def test_what_nothing_holds_has_no_rest():
    points, cable = [Free("w", mass=0.2)], rope("box.eye", "w")
    with pytest.raises(NoRestError, match=r'nothing holds free point "w"|nothing holds body "box"'):
        equilibrium(Scene(points, [cable], [Gravity(G)], bodies=[box()]))


def test_no_start_in_words():
    scene = Scene([Fixed("a", (0, 0, 0))], [rope("a", "box.eye")], [Gravity(G)], bodies=[box()])
    given = equilibrium(scene, start="straight")
    assert_allclose(given.position("box"), equilibrium(scene).position("box"), atol=1e-8)
