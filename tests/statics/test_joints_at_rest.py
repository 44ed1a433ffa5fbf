"""Rests of bodies that are pinned to one another: what pulls at each has no moment about its joint."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from anet_lumped import Body, Cable, Driven, Fixed, NoRestError, Scene, equilibrium, paths
from anet_lumped.effects import Gravity

G = 9.81


def bar(name, length, **given):
    """A bar along its x axis from its origin, "root", to its "tip"."""
    m = 2.0 * length
    arguments = dict(
        mass=m, inertia=(0.01, m * length**2 / 12.0, m * length**2 / 12.0), centre_of_mass=(0.5 * length, 0.0, 0.0),
        attachments={"tip": (length, 0.0, 0.0)}, pinned="",
    ) | given  # fmt: skip
    return Body(name, **arguments)


def rope(start, end, **given):
    return Cable(start, end, **dict(length=1.0, mass_per_length=1e-6, EA=1e5, segments=1) | given)


def pull(rest, cable):
    """Pull of a cable of one segment on its end, with the weight of half of it."""
    along = rest.shape(cable)[-2] - rest.shape(cable)[-1]
    return rest.tension(cable)[-1] * along / np.linalg.norm(along) - np.array([0.0, 0.0, 0.5e-6 * G])


@pytest.mark.parametrize("held", ["by a cable and a pin", "by two cables"])
def test_moments_balance_about_each_joint(held):
    first = bar("first", 0.6, at=(0.0, 0.0, 0.0), pinned="" if held.endswith("pin") else None)
    second = bar("second", 0.4, pinned_to="first.tip", rotation=(0.0, 0.3, 0.2))
    points = [Fixed("b", (1.1, 0.1, 1.0))]
    cables = [rope("b", "second.tip")]
    if held == "by two cables":
        points, cables = [*points, Fixed("a", (-0.1, 0.0, 1.0))], [*cables, rope("a", "first")]
    rest = equilibrium(Scene(points, cables, [Gravity(G)], bodies=[first, second]))
    assert rest.stable and rest.residual < 1e-9
    joint, tip, F = rest.position("first.tip"), rest.position("second.tip"), pull(rest, "b-second.tip")
    assert_allclose(rest.position("second"), joint, atol=1e-15)
    weights = {body.name: np.array([0.0, 0.0, -body.mass * G]) for body in (first, second)}
    centre = {body.name: rest.position(body.name) + rest.rotation(body.name) @ body.centre_of_mass for body in (first, second)}
    about_joint = np.cross(tip - joint, F) + np.cross(centre["second"] - joint, weights["second"])
    assert_allclose(about_joint, np.zeros(3), atol=1e-7)  # of moments of 4 N m
    passed_on, root = F + weights["second"], rest.position("first")
    about_root = np.cross(joint - root, passed_on) + np.cross(centre["first"] - root, weights["first"])
    assert_allclose(about_root, np.zeros(3), atol=1e-7)
    if held == "by two cables":
        other = pull(rest, "a-first")
        assert_allclose(passed_on + weights["first"] + other, np.zeros(3), atol=1e-7)


@pytest.mark.parametrize("above", ["driven body", "driven point", "fixed point"])
def test_a_chain_of_bodies_hangs_down_from_what_holds_it(above):
    """Also from a start in which it stands: that rest is not stable."""
    platform = Body("platform", path=paths.external((0.1, 0.2, 1.0)), attachments={"hinge": (0.3, 0.0, -0.1)})
    first = bar("first", 0.6, pinned_to="platform.hinge", rotation=(0.0, -np.pi / 2, 0.0))
    second = bar("second", 0.4, pinned_to="first.tip", rotation=(0.0, -np.pi / 2 + 1e-3, 0.0))
    points, bodies = [Fixed("far", (3.0, 0.0, 0.0))], [platform, first, second]
    hinge = np.array((0.4, 0.2, 0.9))
    if above != "driven body":
        at = Driven("hinge", paths.external(tuple(hinge))) if above == "driven point" else Fixed("hinge", tuple(hinge))
        points, bodies = [*points, at], [replace(first, pinned_to="hinge"), second]
    loose = rope("far", "second.tip", length=4.0, mass_per_length=1e-3, segments=4)
    rest = equilibrium(Scene(points, [loose], [Gravity(G)], bodies=bodies))
    assert rest.stable
    assert_allclose(rest.position("first"), hinge, atol=1e-15)
    assert_allclose(rest.position("first.tip")[2], hinge[2] - 0.6, atol=2e-3)
    assert_allclose(rest.position("second.tip")[2], hinge[2] - 1.0, atol=4e-3)


def test_what_is_pinned_to_a_free_body_has_no_rest_where_nothing_holds_that():
    first, second = bar("first", 0.6, at=(0.0, 0.0, 0.0), pinned=None), bar("second", 0.4, pinned_to="first.tip")
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [rope("a", "b", length=1.1)], [Gravity(G)], bodies=[first, second]
    )
    with pytest.raises(NoRestError, match=r'nothing holds body "first" and the other it is tied to'):
        equilibrium(scene)
