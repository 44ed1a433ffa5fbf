"""Closed forms, extreme references, and the promise that the chord always closes."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tried import tried

from anet_lumped.statics.catenary import Catenary, catenary

CLOSING = 1e-12  # the promised residual, relative to the length; a few 1e-15 is what is measured
ROUND_OFF = 1e-13  # some hundred units in the last place: a dozen operations and a root found to four units


def closing(cable):
    return np.linalg.norm(cable.point(cable.length) - cable.p2) / cable.length


# --- Over the whole range -------------------------------------------------------------------------------------------

exponents = st.floats(-9.0, math.log10(0.5))
slack_ratios = st.one_of(exponents.map(lambda e: 10**e), exponents.map(lambda e: 1 - 10**e))
any_ratios = st.one_of(st.just(0.0), slack_ratios, st.just(1.0), st.floats(-9, 2).map(lambda e: 1 + 10**e))
near_axis = st.floats(-15.0, 0.0).map(lambda e: 10**e)
inclinations = st.one_of(
    st.sampled_from([(1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]),
    st.floats(-math.pi / 2, math.pi / 2).map(lambda angle: (abs(math.cos(angle)), math.sin(angle))),
    near_axis.map(lambda angle: (math.cos(angle), math.sin(angle))),
    near_axis.map(lambda angle: (math.sin(angle), -math.cos(angle))),
)
lengths = st.floats(-3.0, 3.0).map(lambda e: 10**e)
stiffnesses = st.floats(0.0, 12.0).map(lambda e: 10**e)
headings = st.floats(-math.pi, math.pi)


def ends(ratio, inclination, length, heading):
    across, up = (ratio * length * part for part in inclination)
    return (0.0, 0.0, 0.0), (across * math.cos(heading), across * math.sin(heading), up)


@tried(400)
@given(slack_ratios, inclinations, lengths, headings)
def test_inextensible_closes(ratio, inclination, length, heading):
    assert closing(catenary(*ends(ratio, inclination, length, heading), length)) <= CLOSING


@tried(400)
@given(any_ratios, inclinations, lengths, headings, stiffnesses)
def test_elastic_closes(ratio, inclination, length, heading, stiffness):
    cable = catenary(*ends(ratio, inclination, length, heading), length, EA=stiffness * 0.1 * 9.81 * length, mass_per_length=0.1)
    assert closing(cable) <= CLOSING * max(1.0, ratio)  # a chord of 100 lengths has round-off of its own


@tried(200)
@given(any_ratios, inclinations, headings, stiffnesses)
def test_properties_stay_finite_and_ordered(ratio, inclination, heading, stiffness):
    cable = catenary(*ends(ratio, inclination, 1.0, heading), 1.0, EA=stiffness, gravity=1.0)
    points = cable.point(np.linspace(0, 1, 41))
    assert np.isfinite([cable.a, cable.x0, cable.b, cable.sag, cable.stretched_length]).all()
    slop = ROUND_OFF * max(1.0, ratio)
    assert cable.lowest[-1] <= points[:, -1].min() + slop
    polygon = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert max(1.0, polygon) - slop <= cable.stretched_length
    assert cable.sag >= -slop
    np.testing.assert_allclose(cable.end_forces.sum(axis=0), (0, 0, -1), atol=1e-15 * cable.tension([0, 1]).max())


# Solved with 60 digits for exactly these binary64 ends; length, mu and g are 1. Near taut the horizontal force hangs on
# the ninth digit of the chord, so only an exact difference of chord and length reproduces it.
@pytest.mark.parametrize(
    ("p2", "EA", "H", "V1"),
    [
        ((0.5, 0.25), None, 0.11792915997203394703, -0.3713448312291833923),
        ((0.999999999, 0.0), None, 6454.9723262443589711, -0.5),
        ((0.5999999994, -0.7999999992000001), None, 2323.7901164982042878, -3098.8868392108643176),
        ((1e-09, 0.0), None, 2.0308716076033007885e-11, -0.5),
        ((1e-09, 0.3), None, 2.0349343595128652306e-11, -0.35000000000000000555),
        ((1e-09, 0.999999999), None, 3.5603623670045914569e-11, -4.9936617683220710418e-10),
        ((0.5, 0.25), 1.0, 0.084255124493837045129, -0.41586529080428629369),
        ((1.0, 0.0), 1e12, 3466.8063609363017796, -0.5),
        ((0.6000000006, 0.8000000008000001), 1e12, 1709.143761878965089, 2278.3583725754850382),
        ((0.5999999994, 0.7999999992000001), 1e9, 147.7729357771561054, 196.53085172149408824),
        ((3.0, -7.0), 1.0, 2.605587850755344968, -6.5812281055658163789),
        ((1e-09, 1.4), 1.0, 2.0770065967862143779e-11, -0.033333333333333362937),
        ((1e-09, -1.6), 1.0, 2.9429982966380253596e-10, -1.1000000000000000892),
        ((6.0, 8.0), 1e12, 5400000000000.0, 7199999999999.5),
    ],
)
def test_end_force_against_60_digits(p2, EA, H, V1):
    cable = catenary((0, 0), p2, 1.0, EA=EA, gravity=1.0)
    assert pytest.approx(H, rel=ROUND_OFF) == cable.H
    assert abs(cable.V1 - V1) <= ROUND_OFF * max(1.0, math.hypot(H, V1))


# --- Closed forms ---------------------------------------------------------------------------------------------------


def test_thesis_two_cables_of_one_metre():
    shape = catenary((0, 1), (1, 1), length=2.0)
    assert shape.a == pytest.approx(0.2296402151, abs=5e-11)  # ten digits are given
    np.testing.assert_allclose(shape.lowest, (0.5, 0.2036116441), atol=5e-11)
    np.testing.assert_allclose(shape.point(1.0), shape.lowest, atol=1e-15)
    assert shape.x0 == pytest.approx(0.5, abs=1e-15)
    assert shape.a + shape.b == pytest.approx(0.2036116441, abs=5e-11)
    assert shape.sag == pytest.approx(1 - 0.2036116441, abs=5e-11)


@pytest.mark.parametrize("p2", [(2.5, -0.3), (-1.0, 2.0), (0.4, 0.1), (0.2, 2.7)])
def test_inextensible_follows_the_cosh(p2):
    """z = a cosh((x - x0)/a) + b (thesis eq 3.1), T = mu g (z - b) and arc length from the level point a sinh."""
    shape = catenary((-0.2, 0.1), p2, 3.1, mass_per_length=0.3)
    s = np.linspace(0, 3.1, 57)
    x, z = shape.point(s).T
    np.testing.assert_allclose(shape.a * np.cosh((x - shape.x0) / shape.a) + shape.b, z, atol=1e-12)
    np.testing.assert_allclose(0.3 * 9.81 * (z - shape.b), shape.tension(s), rtol=1e-12)
    arc = shape.direction[0] * shape.a * np.sinh((x - shape.x0) / shape.a)
    np.testing.assert_allclose(arc - arc[0], s, atol=1e-12)
    assert shape.stretched_length == 3.1


@pytest.mark.parametrize("EA", [2.0, 50.0])
@pytest.mark.parametrize("p2", [(1.0, 0.4), (1.9, -1.0), (3.0, 1.0)])
def test_elastic_against_quadrature_of_its_strained_tangent(p2, EA):
    """dx/ds = H (1/T + 1/EA), dz/ds = V (1/T + 1/EA), summed by Gauss-Legendre quadrature: the slow twin."""
    cable = catenary((0, 0), p2, 2.2, EA=EA, mass_per_length=0.1)
    node, weight = np.polynomial.legendre.leggauss(150)  # exact to round-off away from hairpins
    for s in (0.3, 1.1, 2.2):
        arc = s * (node + 1) / 2
        V, T = cable.V1 + 0.981 * arc, cable.tension(arc)
        tangent = np.stack([cable.H * (1 / T + 1 / EA), V * (1 / T + 1 / EA)])
        np.testing.assert_allclose(cable.point(s), tangent @ weight * s / 2, atol=1e-11)
    stretched = (1 + T / EA) @ weight * s / 2
    assert cable.stretched_length == pytest.approx(stretched, abs=1e-11)


@pytest.mark.parametrize("EA", [1.0, 1e4, 1e9])
def test_hanging_vertically_stretches_by_half_its_weight(EA):
    stretch = 0.1 * 9.81 * 2.0**2 / (2 * EA)  # mu g L^2/(2 EA)
    hung = Catenary.from_end_force((1, 5), (0, -0.1 * 9.81 * 2), 2.0, EA=EA, mass_per_length=0.1)
    np.testing.assert_allclose(hung.p2, (1, 5 - 2 - stretch), rtol=1e-15)
    held = catenary((1, 5), (1, 5 - 2 - stretch), 2.0, EA=EA, mass_per_length=0.1)
    assert abs(held.tension(2.0)) <= 1e-13 * max(EA, 1.0)  # round-off of the chord, times EA
    assert held.stretched_length == pytest.approx(2 + stretch, rel=1e-15)
    loose_end_first = Catenary.from_end_force((1, 0), (0, 0), 2.0, EA=EA, mass_per_length=0.1)
    np.testing.assert_allclose(loose_end_first.point([0, 2]), [(1, 0), (1, 2 + stretch)], rtol=1e-15)


def test_hairpins():
    folded = catenary((2, 3), (2, 3), 4.0)
    assert (folded.a, folded.x0, folded.b, folded.sag) == (0.0, 2.0, 1.0, 2.0)
    np.testing.assert_allclose(folded.point(range(5)), [(2, 3), (2, 2), (2, 1), (2, 2), (2, 3)], rtol=1e-15)
    uneven = catenary((0, 0, 0), (0, 0, -1), 2.0, EA=10.0)
    arm = 1 + 1 / (2 + 19.62 / 10)  # the fold: s = L/2 + |h|/(2 + mu g L/EA)
    assert uneven.lowest[-1] == pytest.approx(-arm - 9.81 * arm**2 / 20, rel=1e-14)
    assert uneven.sag == pytest.approx(-uneven.lowest[-1] - 1, rel=1e-14)


def test_taut_vertical_cable_and_gap_of_its_tension():
    cable = catenary((0, 0), (0, 3), 2.0, EA=100.0)
    assert cable.tension(2.0) - cable.tension(0.0) == pytest.approx(2 * 9.81)
    assert cable.tension(1.0) == pytest.approx(100.0 * 0.5)  # the mean strain
    assert cable.sag == 0
    np.testing.assert_array_equal(cable.lowest, (0, 0))


def test_without_gravity_a_stretched_cable_is_straight():
    cable = catenary((1, 1, 1), (4, 5, 1), 4.0, EA=8.0, gravity=0.0)
    assert cable.tension([0.0, 4.0]) == pytest.approx(2.0)
    np.testing.assert_allclose(cable.point([0, 2, 4]), [(1, 1, 1), (2.5, 3, 1), (4, 5, 1)], rtol=1e-15)
    assert (cable.a, cable.sag, cable.stretched_length) == (math.inf, 0.0, 5.0)
    assert math.isnan(cable.x0) and math.isnan(cable.b)
    np.testing.assert_allclose(cable.end_forces, [(1.2, 1.6, 0), (-1.2, -1.6, 0)], rtol=1e-15)
    np.testing.assert_array_equal(catenary((0, 3), (1, 0), 2.0, EA=8.0, gravity=0.0).lowest, (1, 0))
    barely = catenary((1, 1, 1), (4, 5, 1), 4.0, EA=8.0, gravity=1e-13)
    np.testing.assert_allclose(barely.end_forces, cable.end_forces, atol=1e-12)


# --- Statics --------------------------------------------------------------------------------------------------------


@tried(60)
@given(any_ratios, inclinations, st.sampled_from([1.0, 30.0, 1e6]), st.floats(0, 1), st.floats(0, 1))
def test_a_piece_of_the_cable_is_in_equilibrium(ratio, inclination, EA, s1, s2):
    """mu g dz = dT + d(T^2)/(2 EA): integrated along the tangent, the weight of a piece balances its end tensions."""
    cable = catenary(*ends(ratio, inclination, 1.0, 0.3), 1.0, EA=EA, gravity=1.0)
    (T1, T2), z = cable.tension([s1, s2]), cable.point([s1, s2])[:, -1]
    rise = (T2 - T1) * (1 + (T1 + T2) / (2 * EA))
    assert rise == pytest.approx(z[1] - z[0], abs=1e-14 * max(1, ratio) * (1 + T1 + T2))


def test_end_forces_point_along_the_cable():
    cable = catenary((0, 0, 0), (1, 2, 0.5), 3.0, EA=50.0, mass_per_length=0.1)
    for force, s, step in zip(cable.end_forces, (0.0, 3.0), (1e-6, -1e-6), strict=True):
        tangent = cable.point(s + step) - cable.point(s)
        direction = tangent / np.linalg.norm(tangent)
        np.testing.assert_allclose(force, cable.tension(s) * direction, atol=2e-6)  # one-sided difference: first order


@pytest.mark.parametrize("EA", [None, 3.0, 1e6])
def test_from_end_force_undoes_catenary(EA):
    cable = catenary((1, 0, 2), (0.5, 0.8, 2.2), 1.3, EA=EA, mass_per_length=0.2, gravity=1.6)
    same = Catenary.from_end_force((1, 0, 2), cable.end_forces[0], 1.3, EA=EA, mass_per_length=0.2, gravity=1.6)
    np.testing.assert_allclose(same.p2, cable.p2, atol=1e-14)
    np.testing.assert_allclose(same.end_forces, cable.end_forces, atol=1e-14)


@pytest.mark.parametrize("EA", [None, 5.0])
@pytest.mark.parametrize("p2", [(0.3, 0.9), (1.2, -0.5), (0.0, 0.4)])
def test_ends_may_be_swapped(p2, EA):
    there, back = catenary((0, 0), p2, 1.5, EA=EA), catenary(p2, (0, 0), 1.5, EA=EA)
    s = np.linspace(0, 1.5, 31)
    np.testing.assert_allclose(there.point(s), back.point(1.5 - s), atol=1e-14)
    np.testing.assert_allclose(there.tension(s), back.tension(1.5 - s), atol=1e-13)
    np.testing.assert_allclose(there.end_forces, back.end_forces[::-1], atol=1e-13)
    assert (there.x0, there.b, there.sag) == pytest.approx((back.x0, back.b, back.sag), rel=1e-12)


def test_translation_and_turning_about_the_vertical():
    flat = catenary((0, 0), (1.3, 0.4), 2.0, EA=40.0)
    shift, heading = np.array([3.0, -7.0, 11.0]), np.array([-0.6, 0.8])
    turned = catenary(shift, shift + np.array([*1.3 * heading, 0.4]), 2.0, EA=40.0)
    x, z = flat.point(np.linspace(0, 2, 21)).T
    expected = shift + np.column_stack([np.outer(x, heading), z])
    np.testing.assert_allclose(turned.point(np.linspace(0, 2, 21)), expected, atol=1e-13)
    assert turned.x0 == pytest.approx(flat.x0, abs=1e-13)
    assert turned.b - 11 == pytest.approx(flat.b, abs=1e-13)


@pytest.mark.parametrize("p2", [(0.7, 0.2), (0.9, 0.0), (0.0, -0.5)])
def test_elastic_tends_to_inextensible(p2):
    limit = catenary((0, 0), p2, 1.0).point(np.linspace(0, 1, 11))
    gaps = [abs(catenary((0, 0), p2, 1.0, EA=EA).point(np.linspace(0, 1, 11)) - limit).max() for EA in (1e4, 1e6, 1e12)]
    assert gaps[0] / gaps[1] == pytest.approx(100, rel=0.02)  # first order in 1/EA
    assert gaps[2] < 1e-11


@pytest.mark.parametrize("EA", [None, 3.0])
def test_sag_and_lowest_against_a_fine_sampling(EA):
    cable = catenary((0, 0), (0.8, 0.5), 1.2, EA=EA, mass_per_length=0.1)
    x, z = cable.point(np.linspace(0, 1.2, 20001)).T
    assert cable.sag == pytest.approx((x * 0.5 / 0.8 - z).max(), abs=1e-8)  # sampling misses a parabola's tip
    assert cable.lowest[1] == pytest.approx(z.min(), abs=1e-8)
    steep = catenary((0, 0), (0.8, 5.0), 5.1, mass_per_length=0.1)
    np.testing.assert_array_equal(steep.lowest, (0, 0))


# --- Arguments ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        (((0, 0), (3, 4), 4.5), {}, r"longer than its chord: the length is 4\.5 m, the chord 5 m; give EA"),
        (((0, 0), (1, 0), 0.9), {}, r"the length is 0\.9 m, the chord 1 m; give EA"),
        (((0, 0), (3, 4), 5.0), {}, r"the length is 5 m, the chord 5 m"),
        (((0, 0), (0, -2), 2.0), {}, r"the length is 2 m, the chord 2 m"),
        (((0, 0), (3, 4), 5.5), {"EA": 9.0, "gravity": 0}, r"chord 5 m must exceed the length 5\.5 m"),
        (((0, 0), (3, 4), 5.5), {"gravity": 0}, r"Without gravity only a stretched cable has a shape"),
        (((0, 0), (1, 2, 3), 5.0), {}, r"same number of coordinates, got 2 for p1 and 3 for p2"),
        (((0, 0, 0, 0), (1, 2), 5.0), {}, r"p1 must hold two or three finite numbers"),
        (((0, 0), (1, math.nan), 5.0), {}, r"p2 must hold two or three finite numbers, got \(1, nan\)"),
        (((0, 0), (1, 2), 0.0), {}, r"length must be positive and finite, got 0\.0"),
        (((0, 0), (1, 2), math.inf), {}, r"length must be positive and finite, got inf"),
        (((0, 0), (1, 2), 3.0), {"EA": -1.0}, r"EA must be positive and finite, got -1\.0"),
        (((0, 0), (1, 2), 3.0), {"mass_per_length": 0}, r"mass_per_length must be positive and finite, got 0"),
        (((0, 0), (1, 2), 3.0), {"gravity": -9.81}, r"gravity must be finite and not negative, got -9\.81"),
    ],
)
def test_wrong_arguments(arguments, options, message):
    with pytest.raises(ValueError, match=message):
        catenary(*arguments, **options)


@pytest.mark.parametrize("s", [-0.1, 2.1, math.nan, [0.5, 3.0]])
@pytest.mark.parametrize("question", ["point", "tension"])
def test_arc_length_off_the_cable(question, s):
    cable = catenary((0, 0), (1, 0), 2.0)
    with pytest.raises(ValueError, match=r"Arc length must lie between 0 and the length 2 m, got"):
        getattr(cable, question)(s)


def test_a_shape_needs_weight_or_force():
    with pytest.raises(ValueError, match="neither weight nor end force"):
        Catenary.from_end_force((0, 0), (0, 0), 1.0, gravity=0.0)
    with pytest.raises(ValueError, match="got 2 for p1 and 3 for force"):
        Catenary.from_end_force((0, 0), (0, 0, 1), 1.0)


def test_the_file_loads_without_scipy():
    """With the errors that it raises; the package itself is left out, since it imports `simulate`."""
    folder = str(Path(sys.modules[Catenary.__module__].__file__).parents[1])
    code = (
        f"import sys, types; package = types.ModuleType('anet_lumped'); package.__path__ = [{folder!r}]\n"
        "sys.modules['anet_lumped'] = package\n"
        "import anet_lumped.statics.catenary\n"
        "print([name for name in ('scipy', 'numba') if name in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "[]\n"
