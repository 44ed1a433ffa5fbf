"""Every scheme on every motion with a closed form: the errors of places and of velocities fall at the scheme's order."""

import warnings

import numpy as np
import pytest
from naive import segments, top_frequency
from scipy.special import jn_zeros, roots_laguerre
from systems import MOTIONS, axial_bar, bar_matrices, hanging_matrices, spring_mass

from anet_lumped import Cable, simulate
from anet_lumped.model.build import build
from integrators import schemes

OWN = schemes.names(own=True)
SCHEMES = [(name, None) for name in OWN]
SCHEMES += [("edmc", 1.0), ("generalised_alpha", 0.0), ("generalised_alpha", 1.0)]
RATIOS = np.array([1.0, 1.4, 2.0, 2.8, 4.0])  # five numbers of steps


def order_of(name):
    """The order that a scheme must show."""
    return {"explicit_euler": 1, "symplectic_euler": 1, "backward_euler": 1, "rk4": 4, "dop853": 8}.get(name, 2)


def errors(motion, name, rho_inf, steps):
    """Largest error of places and of velocities over the whole run, in a scheme marched with ``steps`` steps."""
    dt = motion.t_end / steps
    with warnings.catch_warnings():  # explicit Euler is unstable at any step, and converges all the same
        warnings.simplefilter("ignore")
        run = simulate(motion.scene, motion.t_end, method=name, dt=dt, save_every=dt, start=motion.start, rho_inf=rho_inf)
    assert run.ok and not run.work.halvings
    n = run.model.n_free
    x, v = np.moveaxis([motion.exact(t) for t in run.t], 1, 0)
    return np.abs(run.q[:, :n, 0] - x).max(), np.abs(run.v[:, :n, 0] - v).max()


# `solve_to` 1e-9 leaves at most 1e-5 of the force of swings of 1e-4 m, whose forces are 1e-4 of the weight, and the errors measured
# are above 1e-4 of the motion. The errors of order 1 are above 1e-3, and their many steps forbid less than 1e-7: rounding of places
# of 1 m leaves m eps/h^2 in the force.

SWINGS = [system for system, make in MOTIONS.items() if not make(1e-6).axial]


def motions_of_schemes():
    """Every scheme on every motion; by default on two of them, and each motion with two schemes or more."""
    for k, (name, rho_inf) in enumerate(SCHEMES):
        # a step of dop853 that is stable for the stretching of the chain leaves rounding alone in its swings
        motions = [system for system in MOTIONS if name != "dop853" or system not in SWINGS]
        for i, system in enumerate(motions):
            marks = () if (i - k) % len(motions) in (0, len(motions) // 2) else pytest.mark.slow
            yield pytest.param(name, rho_inf, system, marks=marks)


@pytest.mark.parametrize(("name", "rho_inf", "system"), motions_of_schemes())
def test_order(name, rho_inf, system, solve_to):
    # explicit schemes need no Newton iteration and bear smaller swings, whose nonlinear part is below rounding
    motion = MOTIONS[system](1e-6 if schemes.scheme(name).explicit else 1e-4)
    order = order_of(name)
    # schemes of order 1 reach the slope only where the next term of the error, h omega of the first, is below 0.1
    # and of order 8 those above rounding
    implicit = 2 if motion.axial else 0.75
    first = motion.steps * ({1: 16, 8: 0.2}.get(order) or (1 if schemes.scheme(name).explicit else implicit))
    steps = np.round(first * RATIOS).astype(int)
    solve_to(1e-7 if order == 1 else 1e-9)
    slopes = -np.polyfit(np.log(steps), np.log([errors(motion, name, rho_inf, n) for n in steps]), 1)[0]
    np.testing.assert_allclose(slopes, order, atol=0.15)


@pytest.mark.parametrize("system", SWINGS)
def test_swings_of_dop853_are_exact(system):
    """At 16 steps, four fifths of the limit that stretching sets: places of 1 m hold 1e-16 m, their velocities some 1e-14."""
    of_places, of_velocities = errors(MOTIONS[system](1e-6), "dop853", None, 16)
    assert of_places < 3e-15 and of_velocities < 1e-13


def test_schemes_state_their_order():
    for name in OWN:
        assert schemes.scheme(name).order == order_of(name)


@pytest.mark.parametrize("make", [spring_mass, lambda zeta: axial_bar(True, zeta)])
@pytest.mark.parametrize("rho_inf", [0.0, 0.5])
def test_edmc_is_the_conserving_step_with_an_axial_damper(make, rho_inf, solve_to):
    """The numerical damper is alpha k h s^2/(1 + s^2) beside c: that much more zeta gives the same motion at rho_inf = 1."""
    solve_to(1e-9)
    motion, steps = make(0.1), 40
    h, alpha = motion.t_end / steps, 0.5 * (1 - rho_inf) / (1 + rho_inf)
    cable, model = motion.scene.cables[0], build(motion.scene)
    s = max(top_frequency(model, a, b, cable) for _, a, b in segments(model)) * h / 2
    stiffer = make(0.1 + alpha * s**2 / (1 + s**2) * h * cable.omega_max / 2)  # c = 2 zeta k/omega_max
    # a single step: at its end its velocities are freed from what it does not resolve
    a = simulate(motion.scene, h, method="edmc", dt=h, start=motion.start, rho_inf=rho_inf)
    b = simulate(stiffer.scene, h, method="edmc", dt=h, start=stiffer.start, rho_inf=1.0)
    # the same arithmetic but for how c/h + alpha k is summed, solved to 1e-9 of the force
    np.testing.assert_allclose(a.q, b.q, atol=1e-10)


def test_midpoint_and_conserving_step_agree_on_linear_springs(solve_to):
    """On a line the secant of a quadratic energy is its slope at the midpoint."""
    solve_to(1e-9)
    motion = axial_bar(True, 0.2)
    a, b = (
        simulate(motion.scene, motion.t_end, method=m, dt=0.005, start=motion.start, rho_inf=r)
        for m, r in (("midpoint", None), ("edmc", 1.0))
    )
    np.testing.assert_allclose(a.q, b.q, atol=1e-10)  # both solved to 1e-9 of the force


def test_frequencies_of_the_bar():
    """The closed form's own matrices against 2 sqrt(k/m) sin(j pi/2N) and sin((2j - 1) pi/4N)."""
    N = 6
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=10.0, segments=N)
    for loose, angle in ((False, np.arange(1, N) * np.pi / (2 * N)), (True, (2 * np.arange(1, N + 1) - 1) * np.pi / (4 * N))):
        mass, K = bar_matrices(N, loose, cable)
        omega = np.sqrt(np.linalg.eigvalsh(K / np.sqrt(np.outer(mass, mass))))
        np.testing.assert_allclose(omega, cable.omega_max * np.sin(angle), rtol=1e-12)  # an eigenvalue solver's round-off


def test_frequencies_of_the_hanging_chain():
    """Equal masses on stiff links swing at the zeros of a Laguerre polynomial, a fine chain at those of J0."""
    g = 9.81

    def omega(segments, payload):
        cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e9, segments=segments)
        mass, K, _ = hanging_matrices(cable, g, payload)
        return np.sqrt(np.linalg.eigvalsh(K / np.sqrt(np.outer(mass, mass))))

    # half a segment's mass more at the end makes all masses equal; links stretch by 1e-9 of their length
    np.testing.assert_allclose(omega(8, 0.1 / 16), np.sqrt(g * 8 * roots_laguerre(8)[0]), rtol=1e-8)
    exact = jn_zeros(0, 3) * np.sqrt(g / 1.0) / 2
    coarse, fine = (np.abs(omega(n, 0.0)[:3] - exact) for n in (40, 80))
    np.testing.assert_allclose(np.log2(coarse / fine), 2.0, atol=0.05)  # half a mass at the end: second order
