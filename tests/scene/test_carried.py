"""What sits at points of a body: its mass is one of the body, and air and water act on it where it sits."""

import math

import numpy as np
import pytest

from anet_lumped import Body, Cable, Carried, Fixed, Scene, SceneError, equilibrium, paths, simulate
from anet_lumped.effects import Air, Gravity, Water
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict
from anet_lumped.scene.varied import Varied

g, rho = 9.81, 1000.0
CORNERS = {"a": (1.0, 0.0, 0.0), "b": (0.0, 2.0, 0.0), "c": (0.0, 0.0, 3.0)}


def crate(**fields):
    return Body("crate", **({"at": (0.0, 0.0, -50.0), "mass": 4.0, "inertia": (5.0, 6.0, 7.0), "attachments": CORNERS} | fields))


def scene(body, *effects):
    """The body alone: a cable that stays slack and weighs nothing beside it only makes the scene one of cables."""
    cable = Cable("far", "crate", length=200.0, mass_per_length=1e-9, EA=1.0, segments=1, diameter=1e-6)
    return Scene([Fixed("far", (0.0, 0.0, -100.0))], [cable], effects, bodies=[body])


def test_mass_and_inertia_are_those_of_all_parts():
    """Steiner's theorem, written out: 4 kg at the origin with its own inertia, and 2 kg at (1, 0, 0)."""
    whole = crate(carried={"a": Carried(mass=2.0)}).whole
    x = 2.0 / 6.0
    about = 4.0 * x * x + 2.0 * (1.0 - x) ** 2
    assert whole.total == 6.0 and np.allclose(whole.centre, (x, 0.0, 0.0), rtol=1e-15)
    assert np.allclose(whole.inertia, np.diag([5.0, 6.0 + about, 7.0 + about]), rtol=1e-14)


def test_masses_alone_are_a_body():
    """Three masses, each of 1 kg, at the corners: sums over them."""
    whole = crate(mass=None, inertia=None, carried=dict.fromkeys(CORNERS, Carried(mass=1.0))).whole
    arms = np.array(list(CORNERS.values())) - np.mean(list(CORNERS.values()), axis=0)
    assert np.allclose(whole.inertia, sum((d @ d) * np.eye(3) - np.outer(d, d) for d in arms), rtol=1e-14)


def test_inertia_without_a_mass_counts():
    """It was left out beside rods with a mass, in silence."""
    whole = crate(mass=None, carried={"a": Carried(mass=2.0)}).whole
    assert whole.total == 2.0 and np.allclose(whole.inertia, np.diag([5.0, 6.0, 7.0]), atol=1e-15)


def test_floats_on_both_sides_rise_by_the_closed_form():
    """u = u_inf tanh(F t/(m' u_inf)), with F = rho g V - m g, u_inf^2 = F/(rho CdA/2) and the added mass in m'.

    Both are as far from the centre of mass, so that nothing turns. Steps of 2 ms, of second order, leave 1e-5 of the way.
    """
    one, arms = Carried(mass=1.0, volume=0.01, CdA=0.2, Ca=0.5), {"l": (1.0, 0.0, 0.0), "r": (-1.0, 0.0, 0.0)}
    body = crate(attachments=arms, carried=dict.fromkeys(arms, one))
    run = simulate(scene(body, Gravity(g), Water(rho)), 1.5, method="edmc", dt=0.002, start="straight")
    F, C, m = rho * g * 0.02 - 6.0 * g, 0.5 * rho * 0.4, 6.0 + 0.5 * rho * 0.02
    u = math.sqrt(F / C)
    risen = m / C * math.log(math.cosh(F * run.t[-1] / (m * u)))
    assert run.energy_balance.imbalance < 1e-6
    assert run.position("crate")[-1, 2] + 50.0 == pytest.approx(risen, rel=1e-5)


def test_air_resists_what_a_body_carries():
    """Fall with drag from rest: the same closed form, in air."""
    arms = {"l": (1.0, 0.0, 0.0), "r": (-1.0, 0.0, 0.0)}
    body = crate(attachments=arms, carried=dict.fromkeys(arms, Carried(CdA=0.5)))
    run = simulate(scene(body, Gravity(g), Air(density=1.2)), 1.5, method="edmc", dt=0.002, start="straight")
    C, m = 0.5 * 1.2 * 1.0, 4.0
    u = math.sqrt(m * g / C)
    fallen = m / C * math.log(math.cosh(g * run.t[-1] / u))
    assert -50.0 - run.position("crate")[-1, 2] == pytest.approx(fallen, rel=1e-5)


def test_a_body_hangs_with_all_of_its_weight_and_lift_under_its_rope():
    """Moments about the rope's end: (4 g, at 0), (2 g - rho g V, at the arm), so that the resultant passes through it."""
    body = Body(
        "crate", mass=4.0, inertia=(0.5, 0.6, 0.7), at=(0, 0, -2), attachments={"eye": (0.0, 0.0, 0.5), "side": (0.6, 0.0, 0.0)},
        carried={"side": Carried(mass=2.0, volume=0.0005)},
    )  # fmt: skip
    rope = Cable("top", "crate.eye", length=1.5, mass_per_length=1e-6, EA=1e6, segments=4, diameter=1e-4)
    rest = equilibrium(Scene([Fixed("top", (0, 0, 0))], [rope], [Gravity(g), Water(rho, level=5.0)], bodies=[body]))
    lift = 1.5 * g * rest.position("crate.side") + 4.0 * g * rest.position("crate")
    assert lift[0] == pytest.approx(0.0, abs=1e-6) and abs(rest.rotation("crate")[0, 2]) > 0.2
    assert rest.tension("top-crate.eye")[-1] == pytest.approx(5.5 * g, rel=1e-5)


def test_what_a_driven_body_carries_counts_in_its_reaction():
    """2 kg and 3 l under water weigh 2 g - 3 g; the acceleration of the path is 0."""
    body = crate(mass=None, inertia=None, at=None, path=paths.line((0, 0, -50), (0, 0, 0), 1.0),
                 carried={"b": Carried(mass=2.0, volume=0.003)})  # fmt: skip
    run = simulate(scene(body, Gravity(g), Water(rho)), 0.1, method="edmc", dt=0.01)
    assert run.reaction("crate")[-1, 2] == pytest.approx(-1.0 * g, rel=1e-6)  # the cable weighs 1e-9 of it


def test_it_is_written_and_read_back_and_varied():
    one = Carried(mass=1.0, volume=0.01, CdA=0.2, Ca=0.5)
    of = scene(crate(carried={"a": one, "": Carried(mass=3.0)}), Gravity(g))
    assert scene_from_dict(scene_to_dict(of)) == of
    (body,) = Varied(of, ["crate.carried.a.mass"]).with_values({"crate.carried.a.mass": 9.0}).bodies
    assert dict(body.carried)["a"].mass == 9.0 and body.whole.total == 16.0


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"carried": {"d": Carried(mass=1.0)}}, r'must name attachments, or "" for the origin, but body "crate" has \'d\''),
        ({"carried": {"a": 3.0}}, r'Argument `carried` must hold Carried, but body "crate" has 3.0 at "a"'),
        ({"carried": {"a": Carried(mass=1.0)}, "mass": None, "inertia": None}, r"Masses on one line have no inertia about it"),
    ],
)  # fmt: skip
def test_refusals(fields, message):
    with pytest.raises(SceneError, match=message):
        crate(**fields)


def test_nothing_is_negative():
    with pytest.raises(SceneError, match=r"Argument `volume` must be non-negative .* but what a body carries has volume=-1.0"):
        Carried(volume=-1.0)
