"""Metrics against hand-made numbers; the lumped model against the catenary: second order, known sags, invariance."""

import numpy as np
import pytest

from anet_lumped.advice.compare import compare, project, r_squared, rmse
from anet_lumped.effects import Gravity
from anet_lumped.results.sag import below_chord
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.catenary import catenary
from anet_lumped.statics.equilibrium import equilibrium

UP = np.array([0.0, 0.0, 1.0])


def level_cable(segments, EA=1e6, span=0.8, down=(0.0, 0.0, -1.0), end=None, g=9.81):
    return Scene(
        points=[Fixed("a", (0, 0, 0)), Fixed("b", end or (span, 0, 0))],
        cables=[Cable("a", "b", length=1.0, mass_per_length=0.1, EA=EA, segments=segments)],
        effects=[Gravity(g, down)],
    )


def net(segments):
    corners = [(-0.5, -0.5, 0.0), (0.5, -0.5, 0.0), (0.5, 0.5, 0.2), (-0.5, 0.5, 0.0)]
    return Scene(
        points=[Fixed(f"s{i}", at) for i, at in enumerate(corners)] + [Free("p0", mass=0.036)],
        cables=[Cable(f"s{i}", "p0", length=1.0, mass_per_length=0.1, EA=1e4, segments=segments) for i in range(4)],
        effects=[Gravity()],
    )


def test_rmse_of_values_and_of_points():
    assert rmse([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 6.0]) == 1.0
    assert rmse(np.zeros((2, 3)), [[3.0, 4.0, 0.0], [0.0, 0.0, 0.0]]) == pytest.approx(np.sqrt(12.5))
    assert np.isnan(rmse([], []))


def test_r_squared_takes_the_mean_of_the_observations():
    observed, predicted = np.array([1.0, 2.0, 3.0]), np.array([2.0, 3.0, 4.0])
    assert r_squared(observed, predicted) == 1 - 3 / 2
    assert r_squared(predicted, observed) == 1 - 3 / 2
    assert r_squared(observed, [1.0, 2.0, 6.0]) == 1 - 9 / 2  # with the mean of the predicted ones it would be 1 - 9/3
    assert r_squared(observed, observed) == 1.0


def test_r_squared_of_what_does_not_vary():
    assert np.isnan(r_squared([0.3, 0.1 + 0.2, 0.3], [0.3, 0.3, 0.4]))
    assert np.isnan(r_squared([], []))


def test_pooled_r_squared_follows_the_origin():
    """The same misfit in a frame whose origin is further away looks better; Y of one coordinate does not mind."""
    rng = np.random.default_rng(0)
    points = rng.uniform(0, 0.5, (50, 3))
    misfit = rng.normal(0, 0.03, (50, 3))
    pooled = [r_squared(points + z * UP, points + z * UP + misfit) for z in (0.0, 1.0, 2.0)]
    assert pooled[0] < 0.96 < 0.99 < pooled[1] < pooled[2] < 1
    height = [r_squared(points[:, 2] + z, points[:, 2] + z + misfit[:, 2]) for z in (0.0, 1.0, 2.0)]
    assert height == pytest.approx(height[:1] * 3, abs=1e-12)


def test_project_on_a_corner():
    curve = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 2.0, 0.0)])
    points = np.array([(0.25, 0.0, 0.3), (1.5, 1.0, 0.0), (2.0, -1.0, 0.0), (-3.0, 0.0, 4.0)])
    distance, place, nearest = project(points, curve)
    assert distance == pytest.approx([0.3, 0.5, np.sqrt(2), 5.0])
    assert place == pytest.approx([0.25, 1.5, 1.0, 0.0])
    assert nearest == pytest.approx(np.array([(0.25, 0, 0), (1, 1, 0), (1, 0, 0), (0, 0, 0)]))


def test_project_on_segments_without_length():
    distance, _, nearest = project(np.array([(1.0, 0.0, 0.0)]), np.zeros((4, 3)))
    assert distance == [1.0]
    assert nearest == pytest.approx(np.zeros((1, 3)))


@pytest.mark.parametrize("end", [(0.6, 0.3, 0.4), (0.6, 0.3, -0.4), (0.0, 0.0, 0.5), (0.0, 0.0, 0.0)])
def test_below_chord_is_the_sag_of_a_catenary(end):
    exact = catenary((0, 0, 0), end, 1.0)
    points = exact.point(np.linspace(0, 1, 20001))
    # The lowest of the points is within (1/20000)^2 times the hairpin's curvature, or half a spacing at its fold.
    assert below_chord(points, points[0], points[-1], UP).max() == pytest.approx(exact.sag, abs=3e-5)


@pytest.mark.parametrize(("segments", "sag_error_mm"), [(4, 9.4), (10, 1.43), (20, 0.354), (40, 0.088)])
def test_known_sag_errors(segments, sag_error_mm):
    """docs/thesis.md: span 0.8 m, cable 1 m; EA = 1e6 N adds less than 1e-3 mm."""
    (found,) = compare(equilibrium(level_cable(segments))).cables
    assert 1e3 * found.sag_error == pytest.approx(sag_error_mm, rel=0.01)


@pytest.mark.each_once
@pytest.mark.parametrize("reference", ["net", "ends"])
@pytest.mark.parametrize("measure", ["rmse", "rmse_height", "rmse_curve", "length_error", "tension_error", "end_force_error"])
def test_errors_fall_as_segments_squared(reference, measure):
    numbers = np.array([10, 20, 40, 80])
    errors = []
    for segments in numbers:
        found = compare(equilibrium(net(int(segments))), reference=reference)
        errors.append(max(abs(getattr(cable, measure)) for cable in found.cables))
    assert np.polyfit(np.log(numbers), np.log(errors), 1)[0] == pytest.approx(-2, abs=0.15)


def test_error_of_the_junction_falls_as_segments_squared():
    numbers = np.array([10, 20, 40, 80])
    errors = [np.linalg.norm(compare(equilibrium(net(int(n)))).points["p0"]) for n in numbers]
    assert np.polyfit(np.log(numbers), np.log(errors), 1)[0] == pytest.approx(-2, abs=0.15)


def test_soft_cable_against_elastic_and_inextensible():
    """At EA = 5 N the lumped cable is long by 10 %: so is the elastic catenary, and the inextensible one is not."""
    state = equilibrium(level_cable(40, EA=5.0))
    (elastic,), (stiff,) = compare(state).cables, compare(state, elastic=False).cables
    assert 0.05 < elastic.stretch < 0.2
    assert abs(elastic.length_error) < 1e-3 * elastic.stretch
    assert stiff.length_error == pytest.approx(elastic.stretch, rel=1e-4)
    assert elastic.rmse < 2e-4 < 0.02 < stiff.rmse


def test_r_squared_of_a_cable():
    (found,) = compare(equilibrium(level_cable(20))).cables
    nodes = equilibrium(level_cable(20)).shape("a-b")
    exact = catenary((0, 0, 0), (0.8, 0, 0), 1.0, EA=1e6, mass_per_length=0.1).point(np.linspace(0, 1, 21))
    spread = ((exact[:, 2] - exact[:, 2].mean()) ** 2).sum()
    assert found.r_squared_vertical == pytest.approx(1 - ((nodes - exact)[:, 2] ** 2).sum() / spread, abs=1e-12)
    assert found.segments == 20
    assert found.rmse_curve <= found.rmse <= found.largest


def test_gravity_may_point_anywhere():
    upright = compare(equilibrium(level_cable(10))).cables[0]
    turned = compare(equilibrium(level_cable(10, down=(0.0, 1.0, 0.0)))).cables[0]
    for measure in ("rmse", "rmse_height", "sag", "sag_error", "length_error", "tension_error", "end_force_error"):
        # Statics converge to 1e-10 of the weight.
        assert getattr(turned, measure) == pytest.approx(getattr(upright, measure), rel=1e-5, abs=1e-9)


def test_loose_end():
    """A hanging cable's segments carry the weight below their middle in both models."""
    scene = Scene(
        points=[Fixed("a", (0, 0, 0)), Free("tip", mass=0.02)],
        cables=[Cable("a", "tip", length=1.0, mass_per_length=0.1, EA=50.0, segments=10)],
        effects=[Gravity()],
    )
    found = compare(equilibrium(scene))
    (cable,) = found.cables
    assert cable.tension_error == pytest.approx(0, abs=1e-8)
    assert cable.end_force_error == pytest.approx(0, abs=1e-8)
    assert found.points["tip"] == pytest.approx((0, 0, 0), abs=1e-8)  # the mean tension, so the stretch, is the same
    assert cable.sag == pytest.approx(0, abs=1e-8)


def test_unknown_reference():
    with pytest.raises(ValueError, match='The reference must be "net" or "ends", but reference=\'parabola\' was given'):
        compare(equilibrium(level_cable(4)), reference="parabola")


def test_no_gravity():
    state = equilibrium(level_cable(4, end=(1.1, 0, 0), g=0.0))
    with pytest.raises(ValueError, match="A catenary needs gravity"):
        compare(state)
