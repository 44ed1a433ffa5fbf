"""The boundary of the integrators: every scheme of this package on a system that has no cables."""

import numpy as np
import pytest
from duffing import MASS, START, Duffing, parameters
from scipy.optimize import brentq

from integrators import schemes
from integrators.marching.adaptive_steps import AdaptiveSteps
from integrators.marching.fixed_steps import FixedSteps
from integrators.marching.march import march
from integrators.schemes.record import EnergyPromise
from integrators.system import DIVERGED, DONE, EVENT, HALVINGS, KINETIC, NEWTON, PUT_IN, STEPS, TAKEN_INSIDE, UNCONVERGED

OWN = schemes.names(own=True)
RATIOS = np.array([1.0, 1.4, 2.0, 2.8, 4.0])  # five numbers of steps
FIRST = {1: 400, 2: 60, 4: 40, 8: 12}  # steps in 1.5 s, half a turn of the fastest motion: the coarsest, by the order


def run(duffing, name, dt, t_end, stride=1, start=START, **options):
    """A march with fixed steps from `START`."""
    rows = int(np.ceil(t_end / dt)) // stride + 2
    times = FixedSteps(0.0, t_end, dt, 0.0, stride)
    return march(schemes.scheme(name), duffing.system, duffing.address, times, *start, (rows, 2), parameters(name, **options))


def run_adaptive(duffing, name, t_end, rtol, atol=0.0, count=31):
    """A march that chooses its steps."""
    times = AdaptiveSteps(0.0, t_end, 1e-2, rtol, atol, np.zeros(0))
    saves = np.linspace(0.0, t_end, count), 2
    return march(schemes.scheme(name), duffing.system, duffing.address, times, *START, saves, parameters(name))


def own_energy(out):
    """Kinetic, elastic and potential energy at every saved time [J]."""
    return out.saved.energy[:, KINETIC:PUT_IN].sum(axis=1)


def angular_momentum(out):
    """About the support, at every saved time [kg m^2/s]."""
    return np.einsum("i,kix->kx", MASS, np.cross(out.saved.q[:, :2], out.saved.v[:, :2]))


@pytest.mark.parametrize("name", OWN)
def test_order(name):
    """Of places, velocities and of the energy that is not accounted for, with a damper and a support that shakes."""
    duffing, order, t_end, off = Duffing(c=0.3, g=1.0, shake=0.2), schemes.scheme(name).order, 1.5, []
    steps = np.round(FIRST[order] * RATIOS).astype(int)
    for n in steps:
        out = run(duffing, name, t_end / n, t_end)
        assert out.status == DONE and out.counts[STEPS] == n and len(out.saved.t) == n + 1
        exact = duffing.exact(t_end, t_eval=out.saved.t).y.T
        of_q, of_v = (x[:, :2].reshape(n + 1, 6) for x in (out.saved.q, out.saved.v))
        account = own_energy(out) - out.saved.energy[:, PUT_IN] + out.saved.energy[:, TAKEN_INSIDE:].sum(axis=1)
        off.append([np.abs(x).max() for x in (of_q - exact[:, :6], of_v - exact[:, 6:12], account - account[0])])
    slopes = -np.polyfit(np.log(steps), np.log(off), 1)[0]
    np.testing.assert_allclose(slopes[:2], order, atol=0.15)
    if name == "edmc":  # exact, whatever the step: rounding and Newton's tolerance of some joules are left
        assert np.max(off, axis=0)[2] < 1e-12
    else:  # powers are integrated by the trapezoidal rule, but for dop853
        assert slopes[2] > min(order, 2) - 0.15 if order != 8 else slopes[2] > 7.5


@pytest.mark.parametrize("name", OWN)
def test_energy_is_what_the_record_promises(name):
    """Undamped and let alone. Never: at steps far too long for the motion too. About: for a thousand turns."""
    duffing, promise = Duffing(), schemes.scheme(name).energy
    if promise is EnergyPromise.NEVER_RISES:
        for dt in (0.02, 0.3, 3.0):
            E = own_energy(run(duffing, name, dt, 200 * dt))
            assert np.diff(E).max() < 1e-11 * E[0]  # what Newton's tolerance of 1e-13 leaves in a step
    elif promise is EnergyPromise.SWINGS_ABOUT:
        E = own_energy(run(duffing, name, 0.05, 2000.0))
        early, late = E[: len(E) // 2], E[len(E) // 2 :]
        assert 1e-3 < np.ptp(early) / E[0] < 0.5 and np.ptp(late) < 1.1 * np.ptp(early)
    else:
        E = own_energy(run(duffing, name, 0.05, 2.0))
        assert np.diff(E).max() > 1e-14 * E[0]  # it does rise somewhere


@pytest.mark.parametrize("name", OWN)
def test_angular_momentum_is_kept_by_those_whose_record_says_so(name):
    out = run(Duffing(), name, 0.05, 5.0)
    off = np.abs(angular_momentum(out) - angular_momentum(out)[0]).max()
    if schemes.scheme(name).keeps_angular_momentum:
        assert off < 1e-11
    else:
        assert off > (1e-5 if name != "dop853" else 1e-12)  # the error of the motion, of order 8


@pytest.mark.parametrize("name", [name for name in OWN if schemes.scheme(name).observes_mean_over_stages])
def test_stages_share_the_mean_over_a_step(name):
    out = run(Duffing(), name, 0.05, 0.5)
    np.testing.assert_allclose(out.saved.observed[1:, 1], 1.0, rtol=1e-14)
    np.testing.assert_array_equal(out.saved.observed[:, 0], out.saved.q[:, 1, 0] - out.saved.q[:, 0, 0])


@pytest.mark.parametrize("name", OWN)
def test_chosen_steps_keep_a_tolerance(name):
    """By step doubling, and by the embedded pair's own estimate: the errors of the steps add up to the error of the motion."""
    duffing, t_end = Duffing(c=0.1, shake=0.2), 3.0
    exact = duffing.exact(t_end).y[:6, -1]
    off = []
    for rtol in (1e-4, 1e-6):
        out = run_adaptive(duffing, name, t_end, rtol)
        assert out.status == DONE and out.t == t_end and len(out.saved.t) == 31 and out.error > 0.0
        off.append(np.abs(out.saved.q[-1, :2].ravel() - exact).max())
        assert off[-1] < 1.5 * out.error < 1.5 * rtol * out.counts[STEPS]  # a metre at most, and errors of steps hardly grow
    assert off[1] < 0.15 * off[0]  # a step of order 1 has the square of its length as error: a tenth


@pytest.mark.each_once
@pytest.mark.parametrize("name", ["symplectic_euler", "verlet", "rk4", "dop853", "edmc", "sdirk2"])
@pytest.mark.parametrize("adaptive", [False, True])
def test_an_event_ends_the_march(name, adaptive):
    """Node 1 gets to a level from below, when scipy's solution does, to the error of the scheme."""
    level, t0, t_end = 0.2, 2.0, 6.0
    solution = Duffing().exact(t_end, dense_output=True).sol
    when = brentq(lambda t: solution(t)[3] - level, 3.5, 4.5, xtol=1e-14)
    q, v = (np.vstack([solution(t0)[i : i + 6].reshape(2, 3), np.zeros(3)]) for i in (0, 6))
    duffing, scheme = Duffing(level=level), schemes.scheme(name)
    times = AdaptiveSteps(t0, t_end, 1e-2, 1e-8, 0.0, np.zeros(0)) if adaptive else FixedSteps(t0, t_end, 1e-3, t0, 50)
    saves = (np.linspace(t0, t_end, 11), 2) if adaptive else (90, 2)
    out = march(scheme, duffing.system, duffing.address, times, q, v, saves, parameters(name))
    assert out.status == EVENT and out.t == out.saved.t[-1] < t_end
    allowed = {1: 2e-3, 2: 1e-5}.get(scheme.order, 1e-7)  # the error of the motion at 1 ms, or of some hundred steps of 1e-8
    assert out.t == pytest.approx(when, abs=2e-4 if adaptive and scheme.order == 1 else allowed)
    assert 0.0 <= out.saved.q[-1, 1, 0] - level < 1e-7


def test_a_march_that_diverges_says_where():
    """Explicit Euler at a step that doubles the motion each time."""
    out = run(Duffing(k=100.0), "explicit_euler", 0.5, 50.0)
    assert out.status == DIVERGED and out.node in (0, 1) and out.t < 50.0


@pytest.mark.parametrize("name", schemes.names(own=True, explicit=False))
def test_a_step_that_is_not_solved_is_halved_and_then_given_up(name):
    """Newton's method may take no iteration: the step is cut to 1/4096, twelve times."""
    duffing, given = Duffing(), parameters(name)
    given[1] = 0.0
    times = FixedSteps(0.0, 1.0, 0.1, 0.0, 1)
    out = march(schemes.scheme(name), duffing.system, duffing.address, times, *START, (12, 2), given)
    assert out.status == UNCONVERGED and out.t == 0.0 and out.counts[HALVINGS] == 13 and out.counts[NEWTON] == 0
    np.testing.assert_array_equal(out.saved.q[-1], START[0])  # as it was


@pytest.mark.parametrize("name", schemes.names(own=True, explicit=False))
def test_newton_converges_quadratically(name):
    """With an exact tangent a smooth motion needs few iterations: a wrong one converges too, but slowly."""
    out = run(Duffing(c=0.3, shake=0.2), name, 0.05, 2.0, tolerance=1e-10)
    stages = {"sdirk2": 2, "tr_bdf2": 2}.get(name, 1)
    assert out.counts[NEWTON] <= 3.6 * stages * out.counts[STEPS]


def test_what_a_march_is_given_is_not_changed():
    q, v = (x.copy() for x in START)
    run(Duffing(), "verlet", 0.01, 0.1, start=(q, v))
    np.testing.assert_array_equal([q, v], START)


@pytest.mark.parametrize(("look_every", "looked"), [(0, 0), (1, 29), (4, 7)])
def test_states_that_are_not_saved_are_looked_at(look_every, looked):
    """What is noticed is the largest so far of the states between those that are saved, every one or some of them."""
    duffing, scheme = Duffing(c=0.1, shake=0.2), schemes.scheme("verlet")
    every, some = (
        march(scheme, duffing.system, duffing.address, FixedSteps(0.0, 0.3, 0.01, 0.0, stride, look), *START, (40, 2))
        for stride, look in ((1, 0), (30, look_every))
    )
    assert every.saved.noticed.shape == (31, 0) and some.saved.noticed.shape == (2, 1 if look_every else 0)
    if look_every:
        apart = (every.saved.q[:, 1, 0] - every.saved.q[:, 0, 0])[1:-1]
        assert (
            some.saved.noticed[-1, 0] == max(apart[look_every - 1 :: look_every].max(), 0.0) and looked == len(apart) // look_every
        )
