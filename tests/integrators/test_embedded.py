"""The embedded pair dop853: error against tolerance, dense output, corners, energy, work, and what it says of a stiff motion."""

import itertools
import re
import warnings

import numpy as np
import pytest
from numba import njit
from scipy.integrate import DOP853
from systems import axial_bar, four_cables, loose_cable, shaken_mass, spring_mass

from anet_lumped import Cable, Driven, Fixed, Free, InputError, RunError, Scene, State, equilibrium, simulate
from anet_lumped.effects import Gravity
from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from integrators import schemes
from integrators.marching import embedded_steps, step_control
from integrators.schemes import dop853
from integrators.schemes import embedded_pair as pair
from integrators.step_ends import evaluate_start
from integrators.system import BALANCE, COUNTS, DONE, SUMMED_UP, TAKEN_INSIDE, StepState, words_in_memory

PAIR = dop853.tableau()
SMOOTH = {
    "spring-mass": spring_mass,
    "shaken mass": shaken_mass,  # driven
    "axial bar": lambda: axial_bar(True),
    "axial bar, damped": lambda: axial_bar(True, 0.2),
}


def march(motion, t_end=None, **settings):
    """A run of dop853 on a motion with a closed form."""
    return simulate(motion.scene, t_end or motion.t_end, method="dop853", start=motion.start, **settings)


def errors(motion, run):
    """(k,) largest errors of places and of velocities at every saved time."""
    n = run.model.n_free
    x, v = np.moveaxis([motion.exact(t) for t in run.t], 1, 0)
    return np.abs(run.q[:, :n, 0] - x).max(axis=1), np.abs(run.v[:, :n, 0] - v).max(axis=1)


# --- the tableau --------------------------------------------------------------------------------------------------------


def test_tableau_is_consistent():
    """Rows sum to the times of the stages, weights of errors to zero, of the dense output to theta."""
    assert len(PAIR.c) == dop853.ALL_STAGES and PAIR.end == dop853.STAGES == DOP853.n_stages
    np.testing.assert_allclose(PAIR.A.sum(axis=1), PAIR.c, atol=1e-14)
    assert np.abs([PAIR.fine.sum(), PAIR.coarse.sum()]).max() < 1e-15
    np.testing.assert_allclose(PAIR.dense.sum(axis=0), np.eye(PAIR.dense.shape[1])[0], atol=1e-12)  # of coefficients up to 1e3
    np.testing.assert_allclose(PAIR.dense.sum(axis=1), PAIR.A[PAIR.end], atol=1e-12)


def test_a_step_is_that_of_the_textbook():
    """Stages, error estimates and dense output as scipy's solver has them, in places and velocities of a driven damped net."""
    scene = Scene(
        [Driven("a", paths.harmonic((0, 0, 0), (0.02, 0, 0.05), 2.0)), Free("x", 0.02, at=(0.3, 0.1, -0.9))],
        [Cable("a", "x", length=0.8, mass_per_length=0.1, EA=50.0, zeta=0.2, segments=3)],
        [Gravity()],
    )
    h, rng = 0.01, np.random.default_rng(3)
    kernel = Kernel(scene, equilibrium(scene))
    kernel.v[: kernel.n] += rng.normal(scale=0.3, size=(kernel.n, 3))
    kernel.begin(0.0)
    q, v, f, power = kernel.q.copy(), kernel.v.copy(), np.zeros_like(kernel.q), np.zeros(3)

    def rates(t, y):
        a, b = q.copy(), v.copy()
        a[: kernel.n], b[: kernel.n] = y[:-3].reshape(2, kernel.n, 3)
        kernel.bound.prescribe(t, kernel.net.address, a, b)
        kernel.bound.force(t, a, b, kernel.net.address, f, power)
        return np.concatenate([b[: kernel.n].ravel(), (kernel.bound.per_mass * f)[: kernel.n].ravel(), power])

    y0 = np.append(kernel.row(q, v), [0.0, 0.0, 0.0])
    theirs = DOP853(rates, 0.0, y0, h, first_step=h, rtol=1e3, atol=1e3)
    theirs.step()
    kernel.step(0.0, h)
    assert theirs.t == h
    n = 3 * kernel.n
    # rounding of sums of twelve terms of order one
    np.testing.assert_allclose(kernel.row(kernel.q, kernel.v), theirs.y[:-3], atol=1e-13)
    np.testing.assert_allclose(kernel.balance[list(SUMMED_UP)], theirs.y[-3:], rtol=1e-10)
    fine, coarse = (h * theirs.K[:13].T @ e for e in (DOP853.E5, DOP853.E3))
    fine_q, coarse_q, fine_v, coarse_v = (np.abs(e[s]).max() for s in (slice(n), slice(n, 2 * n)) for e in (fine, coarse))
    of_q, of_v = (a * a / np.hypot(a, 0.1 * b) for a, b in ((fine_q, coarse_q), (fine_v, coarse_v)))
    error, of_places, size, _ = judge(kernel.n, h, kernel.state, kernel.parameters)
    assert of_places == pytest.approx(of_q, rel=1e-6) and error == pytest.approx(max(of_q, of_v), rel=1e-6)
    assert size == np.abs(kernel.q[: kernel.n]).max()
    dense = theirs.dense_output()
    for theta in (0.2, 0.77):
        a, b, balance = kernel.between(0.0, h, theta, q, v)
        expected = dense(theta * h)
        np.testing.assert_allclose(kernel.row(a, b), expected[:-3], atol=1e-12)
        np.testing.assert_allclose(balance[list(SUMMED_UP)], expected[-3:], rtol=1e-9)


# What a march calls; a test calls it through a function that Python may call.


@njit(error_model="numpy")
def take_step(system_address, data_address, t, h, state, parameters, counts):
    return pair.step(system_address, data_address, t, h, state, parameters, counts)


@njit(error_model="numpy")
def begin(system_address, data_address, t, state, counts):
    evaluate_start(system_address, data_address, t, state, counts)


@njit(error_model="numpy")
def judge(n_free, h, state, parameters):
    return pair.judge_step(n_free, 1e6, h, state, parameters)


@njit(error_model="numpy")
def state_within(system_address, data_address, t, h, theta, start, memory, parameters, counts, n_free, found):
    pair.prepare_dense_output(system_address, data_address, t, h, start, memory, parameters, counts)
    pair.dense_output(theta, h, start, memory, parameters, n_free, found)


class Kernel:
    """The compiled pair on a scene, one step at a time."""

    def __init__(self, scene, state):
        self.model = build(scene)
        self.net, self.bound, self.n = fresh_net(self.model), system(self.model), self.model.n_free
        scheme, self.words = schemes.scheme("dop853"), words_in_memory(self.bound)
        self.q, self.v, self.parameters = state.q.copy(), state.v.copy(), scheme.parameters()
        self.memory, self.balance = np.zeros((scheme.memory_rows, self.model.n, 3)), np.zeros(BALANCE)
        self.state, self.counts = StepState(self.q, self.v, self.memory, self.balance), np.zeros(COUNTS, np.int64)
        self.addresses = self.words.ctypes.data, self.net.address

    def row(self, q, v):
        """Places and velocities of the moving nodes in one row."""
        return np.concatenate([q[: self.n].ravel(), v[: self.n].ravel()])

    def begin(self, t):
        """Force and powers at t."""
        begin(*self.addresses, t, self.state, self.counts)

    def step(self, t, h):
        """A step."""
        assert take_step(*self.addresses, t, h, self.state, self.parameters, self.counts) == DONE

    def between(self, t, h, theta, q, v):
        """Dense output of the step that began at t with q, v: places, velocities and the work since."""
        start = StepState(q, v, self.memory[:1], self.balance)
        found = StepState(np.zeros_like(q), np.zeros_like(v), self.memory[:1], np.zeros(BALANCE))
        state_within(*self.addresses, t, h, theta, start, self.memory, self.parameters, self.counts, self.n, found)
        return found.q, found.v, found.balance


def test_order_of_the_dense_output():
    """Order 7, so an error of h^8 within a step, of places, velocities and of the work that is dissipated."""
    motion = spring_mass(0.1)
    c, m = motion.scene.cables[0].dashpot, motion.start.model.node("m")
    steps = 0.2 / np.array([1.0, 1.3, 1.7, 2.2, 2.8])
    s, w = np.polynomial.legendre.leggauss(16)  # exact to rounding for c v^2 over a sixth of a turn
    rows = []
    for h in steps:
        off = np.zeros(3)
        # from eight phases of the motion: from one of them the first two terms of an error may cancel
        for t0, theta in itertools.product(np.linspace(0.0, 1.2, 8), (0.15, 0.4, 0.6, 0.85)):
            kernel = Kernel(motion.scene, motion.start)
            kernel.q[m, 0], kernel.v[m, 0] = (x[0] for x in motion.exact(t0))
            q, v = kernel.q.copy(), kernel.v.copy()
            kernel.begin(0.0)
            kernel.step(0.0, h)
            a, b, balance = kernel.between(0.0, h, theta, q, v)
            x, speed = motion.exact(t0 + theta * h)
            speeds = np.array([motion.exact(t0 + 0.5 * theta * h * (1.0 + at))[1][0] for at in s])
            lost = 0.5 * theta * h * c * (w * speeds**2).sum()
            off = np.maximum(off, [abs(a[m, 0] - x[0]), abs(b[m, 0] - speed[0]), abs(balance[TAKEN_INSIDE] - lost)])
        rows.append(off)
    slopes = np.polyfit(np.log(steps), np.log(rows), 1)[0]
    np.testing.assert_allclose(slopes[:2], 8.0, atol=0.15)
    assert slopes[2] > 7.85  # the next term of the work's error still shows: 8.3


# --- error against tolerance --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("system", [name for name in SMOOTH if "damped" not in name])
def test_error_follows_the_tolerance(system):
    """At all saved times, within steps as well: the slope is 1 and the error of a place below the tolerance itself."""
    motion = SMOOTH[system]()
    tolerances = 10.0 ** -np.arange(4, 11)
    runs = [march(motion, 3.0, rtol=rtol, save_every=0.05) for rtol in tolerances]
    assert all(run.ok for run in runs)
    off = np.array([[e.max() for e in errors(motion, run)] for run in runs])
    assert (off[:, 0] < tolerances * np.abs(runs[0].q).max()).all()
    slopes = np.polyfit(np.log(tolerances), np.log(off), 1)[0]
    np.testing.assert_allclose(slopes, 1.0, atol=0.15)
    assert np.all(np.diff([run.work.steps for run in runs]) > 0)


@pytest.mark.parametrize("system", SMOOTH)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8, 1e-10])
def test_estimate_is_a_bound_of_the_error(system, rtol):
    """The estimate is of a lower order than the step, and its sum leaves out that errors cancel or are damped."""
    motion = SMOOTH[system]()
    run = march(motion, 3.0, rtol=rtol)
    off = errors(motion, run)[0][-1]
    assert off < 1.5 * run.error_estimate
    assert run.error_estimate < 300.0 * np.maximum(off, rtol**1.2)


def test_agrees_with_another_code():
    """scipy's DOP853 on the whip of a soft cable at tight tolerances: each is 1e-10 m off."""
    scene = loose_cable(1e3, compression="damped")
    ours, theirs = (simulate(scene, 0.5, method=m, rtol=1e-10, save_every=0.05, start="straight") for m in ("dop853", "DOP853"))
    np.testing.assert_allclose(ours.t, theirs.t, rtol=1e-14)
    np.testing.assert_allclose(ours.q, theirs.q, atol=1e-9)
    np.testing.assert_allclose(ours.v, theirs.v, atol=1e-7)
    np.testing.assert_allclose(ours.energy, theirs.energy, atol=1e-8)
    T = simulate(scene, 0.5, method="rk4", dt=2.5e-5, save_every=0.05, start="straight").segment_tension
    np.testing.assert_allclose(ours.segment_tension, T, atol=1e-5)  # k = 2e4 N/m times 1e-10 m, and c times 1e-7 m/s


def test_saves_do_not_steer():
    """The dense output is beside the march: many saves or one give the same end, bit by bit."""
    net = four_cables(1e3, carried=True)
    few, many = (simulate(net, 0.5, method="dop853", rtol=1e-6, save_every=s) for s in (0.5, 1e-3))
    assert len(few.t) == 2 and len(many.t) == 501
    np.testing.assert_array_equal(few.q[-1], many.q[-1])
    assert few.work.steps == many.work.steps


# --- landing ------------------------------------------------------------------------------------------------------------


def corner_scene(path):
    """A cable hung from a point that is driven, damped so that a jump of its velocity is a jump of force."""
    made = dict(length=0.5, mass_per_length=0.1, EA=200.0, zeta=0.5, segments=5, compression="linear")
    return Scene([Driven("a", path), Free("b", mass=0.01, at=(0, 0, -0.52))], [Cable("a", "b", **made)], [Gravity()])


def test_lands_on_corners():
    """A line through a corner at t = 0, entered from the rest before: as two runs, one of them on a path without the corner."""
    moving, still = paths.line((0, 0, 0), (0.3, 0.2, 0), ramp=0.0), paths.line((0, 0, 0), (0, 0, 0), ramp=0.0)
    # one run from before the corner, which a state's own time makes possible
    rest = equilibrium(corner_scene(still))
    swing = np.zeros_like(rest.q)
    swing[: rest.model.n_free, 0] = 0.1

    def run(path, start, **settings):
        return simulate(corner_scene(path), method="dop853", rtol=1e-10, start=start, save_every=0.05, **settings)

    early = {path: State(build(corner_scene(path)), -0.25, rest.q, swing, rest.segment_tension) for path in (moving, still)}
    whole = run(moving, early[moving], t_end=0.5)
    assert whole.ok and whole.t[0] == -0.25 and whole.t[-1] == 0.25 and 0.0 in np.round(whole.t, 12)
    before = run(still, early[still], t_end=0.25)
    second = run(moving, before.final, t_end=0.25)
    # both are accurate to 1e-10 of half a metre
    np.testing.assert_allclose(whole.q[-1], second.q[-1], atol=1e-10)
    np.testing.assert_allclose(whole.v[-1], second.v[-1], atol=1e-8)
    # a step whose last stages looked past the corner would be tried again a dozen times
    assert whole.work.rejected <= before.work.rejected + second.work.rejected + 2
    # the jump is in the row at the corner, which is the limit from the right
    at = int(np.argmin(np.abs(whole.t)))
    np.testing.assert_allclose(whole.velocity("a")[at - 1 : at + 1], [(0, 0, 0), (0.3, 0.2, 0)], atol=1e-15)


@pytest.mark.parametrize("t_end", [0.1, 0.3, 1 / 3])
def test_lands_on_the_end_and_on_saves(t_end):
    run = march(shaken_mass(), t_end, rtol=1e-7, save_every=0.07)
    times = np.arange(0.0, t_end, 0.07)
    np.testing.assert_allclose(run.t, [*times, t_end], rtol=1e-14)
    assert run.t[-1] == t_end
    for t, q, v in zip(run.t, run.q, run.v, strict=True):  # driven points are evaluated, not interpolated
        x, speed, _ = run.scene.point("a").path.at(t)
        np.testing.assert_allclose([q[run.model.node("a")], v[run.model.node("a")]], [x, speed], rtol=1e-13, atol=1e-15)


def test_a_step_given_is_kept():
    """With dt alone the steps are fixed, with a tolerance too it is the first; with neither the tolerance is 1e-6 and 1e-9 m."""
    motion = spring_mass()
    fixed = march(motion, dt=0.05)
    assert fixed.work.steps == 20 and fixed.work.rejected == 0
    assert fixed.work.force_evaluations == 1 + 12 * 20
    chosen, asked, first = march(motion), march(motion, rtol=1e-6, atol=1e-9), march(motion, rtol=1e-6, dt=0.01)
    np.testing.assert_array_equal(chosen.q, asked.q)
    assert chosen.error_estimate > 0 and first.dt == 0.01 and first.ok
    assert march(motion, atol=1e-6).ok


# --- work ---------------------------------------------------------------------------------------------------------------


def test_forces_are_counted():
    """Twelve a step tried, one at the start, three more in a step that holds saves."""
    run = march(spring_mass(), 3.0, rtol=1e-6, save_every=3.0)
    assert run.work.force_evaluations == 1 + 12 * (run.work.steps + run.work.rejected)
    dense = march(spring_mass(), 3.0, rtol=1e-6, save_every=1e-3)
    assert dense.work.force_evaluations == 1 + 15 * dense.work.steps + 12 * dense.work.rejected
    assert dense.work.steps <= 40  # 2.4 turns: 1.2 times what order 8 needs at this tolerance


def test_rejections_are_few():
    """At the limit of stability and in the whip, where the law has kinks."""
    for scene, t_end, rtol in ((four_cables(1e3, carried=True), 1.0, 1e-4), (loose_cable(1e4), 0.7, 1e-6)):
        start = "straight" if len(scene.cables) == 1 else "equilibrium"
        work = simulate(scene, t_end, method="dop853", rtol=rtol, start=start).work
        assert work.rejected <= 0.25 * work.steps


def test_less_work_than_step_doubling():
    """rk4 with step doubling needs more than twice the forces for a hundred times the error."""
    motion = axial_bar(True)
    ours = march(motion, 3.0, rtol=1e-8, save_every=3.0)
    other = simulate(motion.scene, 3.0, method="rk4", rtol=1e-9, start=motion.start, save_every=3.0)
    assert ours.work.force_evaluations < 0.5 * other.work.force_evaluations
    assert errors(motion, ours)[0][-1] < 1e-2 * errors(motion, other)[0][-1]


# --- energy -------------------------------------------------------------------------------------------------------------


def test_work_and_dissipation_are_of_the_order_of_the_motion():
    """Powers are integrated with the weights of the step: the balance closes at order 8, what was put in and lost included."""
    motion = shaken_mass()
    steps = np.array([6, 8, 11, 15, 20])
    exact = march(motion, dt=motion.t_end / 200).energy_balance
    off = []
    for n in steps:
        balance = march(motion, dt=motion.t_end / n).energy_balance
        off.append([abs(balance.work - exact.work), abs(balance.by_dampers - exact.by_dampers), balance.method_share])
    assert exact.work > 0.05 and exact.dissipated > 0.04 and exact.method_share < 1e-14
    slopes = -np.polyfit(np.log(steps), np.log(off), 1)[0]
    assert (slopes > 7.5).all()


def test_energy_within_steps():
    """Rows saved within long steps are as accurate as those at their ends."""
    motion = shaken_mass()
    coarse, fine = march(motion, 2.0, rtol=1e-8, save_every=0.02), march(motion, 2.0, rtol=1e-13, save_every=0.02)
    assert coarse.work.steps < 50
    np.testing.assert_allclose(coarse.energy, fine.energy, atol=1e-7)  # joules in play, 1e-8 of places and a force of 10 N
    own = coarse.energy[:, :3].sum(axis=1) - coarse.energy[:, 3] + coarse.energy[:, 4:].sum(axis=1)
    assert np.ptp(own) < 1e-7


# --- what it says -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("EA", "zeta", "rtol"), [(1e6, 0.05, 1e-4), (1e6, 0.05, 1e-5), (1e4, 3.0, 1e-4)])
def test_a_stiff_motion_is_called_so(EA, zeta, rtol):
    """The run goes on; the warning has the step it is held to, near the predicted limit, and that the tolerance is not why."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing is raised beside
        run = simulate(loose_cable(EA, zeta), 0.1, method="dop853", rtol=rtol, start="straight")
    assert run.ok and len(run.warnings) == 1
    found = re.fullmatch(
        r"The motion is stiff for dop853: stability, whose predicted limit is ([\d.e-]+) s, held at least (\d+) of (\d+) steps to "
        rf'([\d.e-]+) s, where rtol={re.escape(f"{rtol:.3g}")} allows longer ones; method="edmc" has no such limit.',
        run.warnings[0],
    )
    assert found, run.warnings
    limit, held, steps, step = map(float, found.groups())
    assert 0.1 * steps < held <= steps == run.work.steps
    assert 0.5 < step / limit < 1.5 and run.work.rejected < 0.1 * steps
    looser = simulate(loose_cable(EA, zeta), 0.1, method="dop853", rtol=100 * rtol, start="straight")
    # order 8 alone would make it 100^(-1/8) = 0.56 times as many
    assert looser.work.steps > 0.75 * steps


@pytest.mark.parametrize("motion", [spring_mass(), shaken_mass(), axial_bar(True)])
def test_a_soft_motion_is_not_called_stiff(motion):
    """A bar that pushes may say that what pushes buckles."""
    run = march(motion, 3.0, rtol=1e-6)
    assert run.ok and all("push buckle" in told for told in run.warnings)


def test_work_is_bounded(monkeypatch):
    monkeypatch.setattr(embedded_steps, "MOST_WORK", 50)
    run = simulate(loose_cable(1e6), 1.0, method="dop853", start="straight")
    assert run.status == "out of steps" and not run.ok and 0 < run.t[-1] < 1.0
    assert run.work.steps + run.work.rejected == 50 and len(run.t) == 2  # the start and the state it reached
    assert re.fullmatch(
        r"dop853 with rtol=1e-06, atol=1e-09 m was at t=[\d.e-]+ s when it had tried all 50 steps that a run may take "
        r'\(\d+ rejected; the predicted limit is [\d.e-]+ s\); try method="edmc", a larger tolerance or a shorter run.',
        run.message,
    )
    with pytest.raises(RunError, match="tried all 50 steps"):
        simulate(loose_cable(1e6), 1.0, method="dop853", start="straight", check=True)


def test_a_tolerance_out_of_reach():
    """Below rounding no step is good enough; after 41 in a row the run ends."""
    run = march(spring_mass(), atol=1e-300)
    assert run.status == "unconverged" and run.work.rejected == step_control.MOST_REJECTIONS + 1 and run.work.steps == 0
    assert re.fullmatch(
        r"dop853 with atol=1e-300 m found no step at t=0 s whose error it allows \(41 of 41 were rejected\); try a larger "
        r'tolerance or method="edmc".',
        run.message,
    )


def test_a_state_that_is_not_finite():
    motion = spring_mass()
    q = motion.q0.copy()
    q[motion.start.model.node("m"), 1] = np.nan
    start = State(motion.start.model, 0.0, q, motion.v0, np.zeros(1))
    with pytest.raises(InputError, match=r'A start must be finite, but the position of point "m" is \(.*nan'):
        simulate(motion.scene, 0.1, method="dop853", start=start)


def test_audit_and_state(tmp_path):
    """An audit runs again with a tenth of the tolerance; a run goes on from its own state."""
    motion = axial_bar(True)
    run = march(motion, 0.5, rtol=1e-6, audit=True)
    assert run.ok and run.audit.passed
    off = errors(motion, run)[0].max()
    assert 0.5 < run.audit.error / off < 1.5  # a tenth of the error is left in the finer run
    whole, half = march(motion, 0.5, rtol=1e-9), march(motion, 0.25, rtol=1e-9)
    rest = simulate(motion.scene, 0.25, method="dop853", rtol=1e-9, start=half.final)
    np.testing.assert_allclose(rest.q[-1], whole.q[-1], atol=1e-9)


def test_a_motion_without_free_nodes():
    cable = Cable("a", "b", length=0.9, mass_per_length=0.1, EA=10.0, segments=1)
    run = simulate(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0))], [cable]), 1.0, method="dop853", start="straight")
    assert run.ok and run.work.rejected == 0
    assert run.work.steps < 40


def test_symmetry_of_flips():
    """A cable reversed is the same motion."""
    made = dict(length=0.5, mass_per_length=0.1, EA=100.0, zeta=0.1, segments=4, name="c")
    points = [Fixed("a", (0, 0, 0)), Free("b", at=(0.5, 0, 0))]
    a, b = (
        simulate(Scene(points, [Cable(*ends, **made)], [Gravity()]), 0.5, method="dop853", rtol=1e-9, start="straight")
        for ends in ("ab", "ba")
    )
    np.testing.assert_allclose(b.shape("c")[:, ::-1], a.shape("c"), atol=1e-12)  # rounding
