"""What a march says of its own error, against the exact motion of a system without cables."""

import numpy as np
import pytest
from duffing import Duffing
from test_boundary import FIRST, OWN, run

from integrators import schemes
from integrators.marching.error_growth import SHORT, SWING, UNSEEN, UNSEEN_EXPLICIT, step_error, times_seen, unseen_steps

T_END = 3.0  # [s], one turn of the fastest motion


@pytest.mark.each_once
@pytest.mark.parametrize("forces", [{}, {"c": 0.3, "g": 1.0, "shake": 0.2}])
@pytest.mark.parametrize("name", [name for name in OWN if name != "dop853"])
def test_the_error_that_a_march_tells_is_that_of_its_places(name, forces):
    """From a third of the time on, from a half to three times of the truth: this swing stiffens, and its dampers forget."""
    duffing, order = Duffing(**forces), schemes.scheme(name).order
    n = FIRST[order] * 8
    out = run(duffing, name, T_END / n, T_END, stride=n // 40)
    exact = duffing.exact(T_END, t_eval=out.saved.t).y.T[:, :6].reshape(-1, 2, 3)
    off = np.maximum.accumulate(np.linalg.norm(out.saved.q[:, :2] - exact, axis=2).max(axis=1))
    late = out.saved.t > T_END / 3
    assert (out.saved.error[0] > 0.0) == (schemes.scheme(name).error_shift > 0.0)
    assert np.all(np.diff(out.saved.error) >= 0.0)
    np.testing.assert_array_less(off[late], 2.0 * out.saved.error[late])
    np.testing.assert_array_less(out.saved.error[late], 3.0 * off[late])


@pytest.mark.parametrize("name", OWN)
def test_it_falls_at_the_order_of_the_scheme(name):
    order, told = schemes.scheme(name).order, []
    for n in (FIRST[order] * 16, FIRST[order] * 32):
        out = run(Duffing(), name, T_END / n, T_END, stride=n)
        told.append(out.saved.error[-1])
    # an explicit march looks at a few of its steps only: of order 8, at nine of 22
    assert np.log2(told[0] / told[1]) == pytest.approx(order, abs=0.15 if order < 4 else 0.5)


def test_the_constant_of_dop853_is_that_of_its_tableau():
    from integrators.schemes.dop853 import amplification

    assert schemes.scheme("dop853").error_constant == pytest.approx(abs(amplification()[9] - 1 / 362880), rel=1e-4)


def test_a_short_march_of_explicit_steps_is_looked_at_as_often_as_an_implicit_one():
    """Otherwise a snap among a hundred steps would mostly be overlooked."""
    assert unseen_steps(False, 1e9) == unseen_steps(True, 100) == UNSEEN
    assert unseen_steps(True, SHORT + 1) == UNSEEN_EXPLICIT > UNSEEN


@pytest.mark.parametrize(("name", "of_means"), [("edmc", 1), ("midpoint", 1), ("backward_euler", 0), ("verlet", 0), ("links", 0)])
def test_means_are_for_implicit_schemes_of_order_two(name, of_means):
    assert step_error(schemes.scheme(name), 10).of_means == of_means


@pytest.mark.parametrize("zeta", [0.0, 0.02])
@pytest.mark.parametrize(
    ("name", "x"), [("rk4", 1.0), ("rk4", 2.5), ("dop853", 1.0), ("dop853", 2.0), ("dop853", 3.0), ("dop853", 4.0)]
)
def test_what_differences_of_a_vibration_do_not_see_is_known(name, x, zeta):
    """Velocities of the exact vibration, their differences, and the error that the steps of the scheme add up to in ten of them.

    Of order 8 and with h omega = 4 differences see a 550th.
    """
    scheme, steps = schemes.scheme(name), np.arange(11)
    z = x * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    off = np.abs(np.polyval(scheme.limit.coefficients[::-1], z) - np.exp(z)) * np.abs(np.exp(z * steps[:-1])).sum()
    differences = np.diff(np.exp(z * np.arange(-scheme.order, 11)), n=scheme.order)[:-1]
    seen = scheme.error_constant * abs(z) * np.abs(differences).sum()
    assert times_seen(scheme, x, zeta) == pytest.approx(max(off / (SWING * seen), 1.0), rel=1e-9)


@pytest.mark.filterwarnings("error")
def test_a_vibration_that_dies_within_a_step_is_seen_without_a_word():
    assert times_seen(schemes.scheme("rk4"), 1e3, 0.9) == 1.0  # exp(900)^4 is more than a float holds
