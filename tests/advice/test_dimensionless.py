"""The dimensionless numbers: computed by hand, and where a formula stands behind one, against the mechanics that it sums up."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from anet_lumped import Cable, Fixed, Scene, equilibrium
from anet_lumped.advice import dimensionless
from anet_lumped.effects import Gravity


@pytest.mark.parametrize(
    ("number", "by_hand"),
    [
        # w l/H = 0.2; L_e = 100 (1 + 0.04/8) = 100.5; 0.04 1e6 100/(5000 100.5)
        (dimensionless.irvine(10.0, 100.0, 0.0, 5000.0, 1e6), 4e6 / 502_500.0),
        # cos 60 degrees = 1/2: w l/H = 0.1; L_e = 100 (1 + 0.01/8) = 100.125; 0.01 1e6 100/(5000 100.125)
        (dimensionless.irvine(10.0, 100.0, math.pi / 3, 5000.0, 1e6), 1e6 / 500_625.0),
        (dimensionless.irvine(10.0, 100.0, math.pi / 2, 5000.0, 1e6), 0.0),
        # 3 mm at 5 m/s in air, 100 g/m: 0.5 1.225 0.003 1.2 25 = 0.055125 N/m over 0.981 N/m
        (dimensionless.drag_over_weight(1.225, 5.0, 0.003, 1.2, 0.981), 0.055125 / 0.981),
        (dimensionless.bending_over_segment(4e-4, 1.0, 0.05), 0.4),
        (dimensionless.damping_ratio(0.5, 2.0), 0.125),
        # omega = pi sqrt(1e4/0.1) = 993.459 rad/s; 10 993.459/(2 1e4)
        (dimensionless.axial_damping_ratio(10.0, 1e4, 0.1, 1.0), 0.4967294),
        (dimensionless.froude(5.0, 1.0, 9.81), 1.5963766),
        (dimensionless.keulegan_carpenter(2.0, 3.0, 0.01), 600.0),
        (dimensionless.payload_over_cables(0.036, 0.4), 0.09),
        # pi/4 1e-4 m2 of sea water weigh 0.0805033 kg/m
        (dimensionless.buoyancy_over_weight(1025.0, 0.01, 0.1), 0.805033),
        # 0.981 N/m on 3e6 Pa/m 3 mm = 9000 Pa: 0.109 mm of 3 mm
        (dimensionless.penetration(0.981, 3e6, 0.003), 0.036333),
    ],
)
def test_by_hand(number, by_hand):
    assert number == pytest.approx(by_hand, rel=1e-5, abs=1e-15)  # to the digits written; cos(pi/2) is 6e-17


@pytest.mark.parametrize("wanted", [2.0, 4 * math.pi**2, 150.0])
def test_irvine_governs_the_first_symmetric_frequency(wanted):
    """tan(x) = x - (4/lambda^2) x^3 with x = omega l/2 sqrt(mu/H) (Irvine & Caughey, 1974), of a chain of the library's.

    A sag of 1/80 leaves some (8/80)^2 = 1 %, of which half in a frequency; 80 segments less than a thousandth.
    """
    mu, g, span, slope = 0.1, 9.81, 10.0, 0.1
    H = mu * g * span / slope
    EA = wanted * H * (1 + slope**2 / 8) / slope**2  # of the formula, solved for EA
    arc = span * (1 + slope**2 / 24)
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Fixed("b", (span, 0, 0))],
        [Cable("a", "b", length=arc / (1 + H / EA), mass_per_length=mu * (1 + H / EA), EA=EA, segments=80)],
        [Gravity(g)],
    )
    rest = equilibrium(scene)
    segments = np.diff(rest.shape("a-b"), axis=0)
    along = float(np.mean(rest.tension("a-b") * segments[:, 0] / np.linalg.norm(segments, axis=1)))
    parameter = dimensionless.irvine(mu * g, span, 0.0, along, EA)
    assert parameter == pytest.approx(wanted, rel=0.05)  # H is what the elastic cable makes of the wanted one
    x = _first_symmetric(parameter)
    assert _symmetric_frequencies(rest)[0] == pytest.approx(2 * x / span * math.sqrt(along / mu), rel=0.01)


def _first_symmetric(parameter):
    """The first root of tan(x) = x - (4/lambda^2) x^3, which lies between pi/2 and 3 pi/2; the poles are multiplied out."""

    def f(x):
        return math.sin(x) - math.cos(x) * (x - 4 / parameter * x**3)

    return brentq(f, math.pi / 2 + 1e-9, 1.5 * math.pi - 1e-9)


def _symmetric_frequencies(rest):
    """Frequencies [rad/s] of the modes in the plane of a chain between level supports that mirror it."""
    shape, tension, cable = rest.shape("a-b")[:, [0, 2]], rest.tension("a-b"), rest.scene.cables[0]
    n = cable.segments
    K = np.zeros((n + 1, 2, n + 1, 2))
    for s in range(n):
        d = shape[s + 1] - shape[s]
        l = np.linalg.norm(d)
        nn = np.outer(d, d) / l**2
        G = cable.stiffness * nn + tension[s] / l * (np.eye(2) - nn)
        for i, j, sign in ((s, s, 1), (s + 1, s + 1, 1), (s, s + 1, -1), (s + 1, s, -1)):
            K[i, :, j] += sign * G
    K = K[1:-1, :, 1:-1].reshape(2 * (n - 1), -1)
    square, modes = eigh(K / (cable.mass_per_length * cable.L0))
    vertical = modes.T.reshape(-1, n - 1, 2)[:, :, 1]
    even = np.abs(vertical - vertical[:, ::-1]).max(axis=1) < 1e-6 * np.abs(vertical).max(axis=1)
    return np.sqrt(square[even])
