"""Cables paid out and reeled in: what the tables become, motion, invariants, energy, scene files."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, CableCut, Fixed, Free, Scene, SceneError, State, equilibrium, load_run, simulate
from anet_lumped.effects import Air, AxialDamping, Bending, Gravity, LineChange, ViscousDamping
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.mechanics.changing_lengths import set_lengths
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.model.tables import AXIAL_L0, AXIAL_L0_BEFORE, AXIAL_L0_RATE
from anet_lumped.prescribed import signals
from anet_lumped.results.energy_balance import error_of_steps
from integrators import schemes
from studies.shown.summary import rest_summary, run_summary
from studies.sweeping.measures import MEASURES

G, MU, EA, LENGTH, MASS = 9.81, 0.05, 1e4, 2.0, 1.0
STABLE = schemes.names(own=True, stable_undamped=True)


def hoist(paid_out, mass=MASS, effects=None, points=None, **kwargs):
    made = dict(length=LENGTH, mass_per_length=MU, EA=EA, zeta=0.5, segments=10) | kwargs
    points = points or [Fixed("a", (0, 0, 0)), Free("b", mass)]
    return Scene(points, [Cable("a", "b", **made)], [*([Gravity()] if effects is None else effects), LineChange({"a-b": paid_out})])


def placed(scene, of_b, velocity=(0.0, 0.0, 0.0)):
    """The straight cable of one segment from "a" to `of_b`, moving."""
    model = build(scene)
    q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    q[model.node("b")], v[model.node("b")] = of_b, velocity
    return State(model, 0.0, q, v, np.zeros(model.n_segments))


@pytest.mark.parametrize("zeta", [True, False])
def test_tables_are_those_of_a_longer_cable(zeta):
    """Masses, springs, dampers and the numbers of every effect, at a time and over a step."""
    damper = {"zeta": 0.3} if zeta else {"BA": 7.0}
    points = [Fixed("a", (0, 0, 0)), Free("b", 0.3), Free("c", 0.2, CdA=0.01)]

    def net(length, more=()):
        made = dict(mass_per_length=MU, EA=EA, diameter=0.01) | damper
        cables = [Cable("a", "b", length=length, segments=6, **made), Cable("b", "c", length=1.5, segments=3, **made)]
        effects = [Gravity(), Air(), ViscousDamping(0.2), AxialDamping(0.7), *more]
        return fresh_net(build(Scene(points, cables, effects)))

    changed = net(LENGTH, [LineChange({"a-b": signals.line(0.0, -0.25, 0.0)})])
    set_lengths(changed.address, 2.0, 2.0, 2.0)
    shorter = net(LENGTH - 0.5)
    np.testing.assert_allclose(changed.mass, shorter.mass, rtol=1e-12)
    np.testing.assert_allclose(changed.axial[:, :AXIAL_L0_RATE], shorter.axial[:, :AXIAL_L0_RATE], rtol=1e-12)
    np.testing.assert_allclose(changed.effects.params, shorter.effects.params, rtol=1e-12)
    np.testing.assert_allclose(changed.axial[:, AXIAL_L0_RATE], [-0.25 / 6, 0.0])
    set_lengths(changed.address, 1.0, 2.0, 3.0)
    np.testing.assert_allclose(changed.mass, shorter.mass, rtol=1e-12)
    np.testing.assert_allclose(
        changed.axial[0, [AXIAL_L0_BEFORE, AXIAL_L0]], [(LENGTH - 0.25) / 6, (LENGTH - 0.75) / 6], rtol=1e-14
    )


@pytest.mark.each_once
@pytest.mark.parametrize("rate", [0.3, -0.3])
@pytest.mark.parametrize("method", STABLE)
def test_hoisted_at_the_rate_of_the_winch(method, rate):
    """The payload moves at the rate times 1 + (m + mu L) g/EA, by which material that comes is stretched at the top."""
    dt = {} if schemes.scheme(method).explicit else {"dt": 0.01}
    run = simulate(hoist(signals.line(0.0, rate, 0.5)), 2.0, method=method, save_every=0.1, **dt)
    assert run.ok, run.message
    length = LENGTH + rate * (2.0 - 0.25)
    hung = length + (MASS + 0.5 * MU * length) * G * length / EA  # of the lumped chain too: loads at nodes, the mean of a segment's
    assert run.position("b")[-1, 2] == pytest.approx(-hung, abs=2e-5)  # a bounce of 1.5e-5 m is left of the start
    mean = (run.position("b")[-1, 2] - run.position("b")[10, 2]) / 1.0
    assert mean == pytest.approx(-rate * (1.0 + (MASS + MU * length) * G / EA), abs=1e-4)
    # of schemes with stages each takes the power of its own time: work that grows like a ramp is off by the step
    bound = {"edmc": 1e-9} | dict.fromkeys(("backward_euler", "midpoint", "sdirk2"), 1e-3)
    bound = bound.get(method, 1e-6)
    assert error_of_steps(run) < bound


def test_rest_after_it_is_that_of_the_longer_cable():
    paid = signals.samples((0.0, 1.0), (0.0, 0.5))
    run = simulate(hoist(paid, zeta=5.0), 8.0, method="edmc", dt=0.01)
    longer = Scene(run.scene.points, [Cable("a", "b", length=LENGTH + 0.5, mass_per_length=MU, EA=EA, segments=10)], [Gravity()])
    rest = equilibrium(longer)
    # the bounce that is left of it after 7 s
    np.testing.assert_allclose(run.tension("a-b")[-1], rest.tension("a-b"), rtol=1e-6)
    np.testing.assert_allclose(run.shape("a-b")[-1], rest.shape("a-b"), atol=1e-8)


def test_energy_in_and_out():
    """Work over a slow hoist: the weight lifted, of payload and cable, and the strain energy; nothing else can be in it."""
    paid = signals.samples((0.0, 10.0), (0.0, -1.0))
    run = simulate(hoist(paid, zeta=0.5), 12.0, method="edmc", dt=0.01)
    balance = run.energy_balance
    before, after = (0.5 * MU * x**2 * G + MASS * G * x for x in (LENGTH, 1.0))  # below the support, the strain left out
    # EA=1e4 N: strains of 1e-3, and the strain energy is half of them
    assert balance.work == pytest.approx(before - after, rel=2e-3)
    assert balance.imbalance < 1e-8 and balance.dissipated < 1e-3 * balance.work


@pytest.mark.parametrize("method", ["edmc", "rk4", "generalised_alpha"])
def test_a_swing_reeled_in_keeps_its_action(method):
    """E/omega of a pendulum whose length changes slowly is constant: its angle grows as L^(-3/4) [Landau & Lifshitz, 49]."""
    t_end, angle = 20.0, 0.02
    paid = signals.samples((0.0, t_end), (0.0, -0.5))
    scene = hoist(paid, length=1.0, mass_per_length=1e-6, segments=1, EA=1e4)
    start = placed(scene, (math.sin(angle), 0.0, -math.cos(angle)))
    run = simulate(scene, t_end, method=method, start=start, **({} if method == "rk4" else {"dt": 0.01}), save_every=0.01)
    assert run.ok, run.message
    x, z = run.position("b")[:, 0], run.position("b")[:, 2]
    last = run.t > t_end - 2.0
    # the length changes by less than 0.4 % in the last swing, and 1 - exp(-...) of the invariant is beyond all orders of it
    reached = np.abs(np.arctan2(x, -z))[last].max()
    assert reached == pytest.approx(angle * 0.5 ** (-0.75), rel=0.01)


def test_a_whirl_reeled_in_keeps_its_angular_momentum():
    paid = signals.line(0.0, -0.1, 1.0)
    scene = hoist(paid, effects=[], length=1.0, mass_per_length=1e-9, segments=1)
    start = placed(scene, (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    run = simulate(scene, 5.0, method="edmc", dt=0.005, start=start)
    about = np.cross(run.position("b"), run.velocity("b"))[:, 2]
    np.testing.assert_allclose(about, 2.0, rtol=1e-7)  # but for the segment's own mass, 1e-9 of the payload's, and Newton
    speed = np.linalg.norm(run.velocity("b")[-1])
    radius = np.linalg.norm(run.position("b")[-1])
    assert radius == pytest.approx(0.55 * (1.0 + 2.0**2 / 0.55**3 / EA), rel=1e-3)  # stretched by m v^2/r
    assert speed * radius == pytest.approx(2.0, rel=0.01)  # 0.1 m/s of it is along the cable


def test_order():
    """A pendulum reeled in: edmc tends to the tight answer of dop853 with the square of its step."""
    scene = hoist(signals.harmonic(0.0, -0.3, 0.5, ramp=1.0), segments=4, mass_per_length=0.5)
    start = State(*(getattr(equilibrium(scene), name) for name in ("model", "t", "q", "v", "segment_tension")))
    start.v[: start.model.n_free, 0] = 0.5 * np.linspace(0.25, 1.0, start.model.n_free)
    options = dict(start=start, save_every=0.1)
    exact = simulate(scene, 1.0, method="dop853", rtol=1e-10, atol=1e-13, **options)
    off = []
    for dt in (0.01, 0.005, 0.0025, 0.00125, 0.000625):
        off.append(np.abs(simulate(scene, 1.0, method="edmc", dt=dt, rho_inf=1.0, **options).q - exact.q).max())
    np.testing.assert_allclose(np.diff(np.log(off)) / np.log(0.5), 2.0, atol=0.15)


def test_newton_needs_no_more_than_without():
    still, moving = (
        simulate(hoist(signals.line(0.0, rate, 0.5)), 2.0, method="edmc", dt=0.01, start="equilibrium") for rate in (0.0, 0.3)
    )
    side = State(still.model, 0.0, still.q[0].copy(), still.v[0].copy(), still.segment_tension[0])
    side.v[: still.model.n_free, 0] = 0.5
    swing, wound = (simulate(hoist(signals.line(0.0, rate, 0.5)), 2.0, method="edmc", dt=0.01, start=side) for rate in (0.0, 0.3))
    assert wound.ok and wound.work.newton_iterations <= 1.1 * swing.work.newton_iterations  # longer, the swing is another one
    assert moving.work.newton_iterations <= 4 * moving.work.steps


def test_paid_out_to_slack():
    """A taut line is let go and sags: the default method and its audit take it."""
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (2.01, 0, 0))]
    run = simulate(hoist(signals.samples((0.0, 1.0), (0.0, 0.5)), points=points), 1.0, audit=0.05)  # of a sag of half a metre
    assert run.ok, run.message
    # of verlet, which is the default here, at its own step: its energy swings about one that it keeps
    assert run.tension("a-b").min() < 1.0 and error_of_steps(run) < 1e-3


def test_paid_out_faster_than_the_payload_falls():
    """It falls freely beside a crumpled cable until that is taut again, and hangs in the end."""
    run = simulate(hoist(signals.samples((0.0, 0.25), (0.0, 1.0)), zeta=0.2), 1.0, save_every=0.05)
    assert run.ok, run.message
    z, free = run.position("b")[:, 2], run.t <= 0.4
    # when let go, the stretch of 2 mm throws it up at 2 mm sqrt(k/m) = 0.14 m/s at most, for 0.4 s
    np.testing.assert_allclose(z[free], z[0] - 0.5 * G * run.t[free] ** 2, atol=0.06)
    assert z.min() > -LENGTH - 1.0 - 0.1 and error_of_steps(run) < 1e-6


def test_a_rest_length_that_does_not_stretch():
    """An inextensible cable is paid out like any other, by edmc."""
    run = simulate(hoist(signals.line(0.0, 0.3, 0.5), EA=math.inf, zeta=0.0), 2.0, method="edmc", dt=0.01)
    assert run.ok, run.message
    assert run.position("b")[-1, 2] == pytest.approx(-(LENGTH + 0.3 * 1.75), abs=1e-7)  # of the lengths' own tolerance


def test_files(tmp_path):
    scene = hoist(signals.line(0.0, 0.1, 1.0))
    save_scene(scene, tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == scene
    run = simulate(scene, 0.2)
    run.save(tmp_path / "run.nc")
    again = load_run(tmp_path / "run.nc")
    assert again.scene == scene and np.array_equal(again.q, run.q)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: LineChange({}), "`paid_out` must hold at least one pair of .*, but effect LineChange has none"),
        (lambda: LineChange({"a-b": 0.5}), 'must hold signals of anet_lumped.signals .* has for cable "a-b" paid_out=0.5'),
        (
            lambda: LineChange({"x": signals.line(0, 1, 1)}).length_changes(hoist(signals.line(0, 1, 1))),
            'The scene has no cable "x"',
        ),
        (lambda: simulate(hoist(signals.line(0.0, -1.0, 0.0)), 3.0), "must keep at least 0.001 .* -1 m are left at t=3 s"),
        (lambda: equilibrium(hoist(signals.line(-2.5, 1.0, 0.0))), "must keep at least 0.001 of its length"),
        (
            lambda: build(hoist(signals.line(0.0, 1.0, 0.0), effects=[Bending()], EI=1.0)),
            'Effects beside LineChange must depend on lengths linearly, but Bending does not, of cable "a-b"',
        ),
        (
            lambda: build(hoist(signals.line(0, 1, 1), breaking_tension=9.0)),
            'paid out must have no `breaking_tension`, but cable "a-b" of LineChange has breaking_tension=9.0 N',
        ),
        (lambda: signals.samples((0, 1), ("x", 1)), "`values` of samples must be numbers"),
        (lambda: simulate(hoist(signals.line(0, 1, 1)), 1.0, method="LSODA"), "Lengths that change in time need a method of this"),
    ],
)
def test_messages(make, message):
    with pytest.raises((SceneError, ValueError), match=message):
        make()


def test_what_a_winch_reels_in_is_no_stretch(capsys):
    """Half of the cable is reeled in slowly: it stretches by the mean tension over EA, in tables and measures, too."""
    way = -0.5 * LENGTH
    scene = hoist(signals.samples([0.0, 0.5, 3.5, 4.0, 5.0], [0.0, 0.02 * way, 0.98 * way, way, way]))
    run = simulate(scene, 5.0, method="edmc", dt=5e-3)
    assert run.length("a-b")[-1] == pytest.approx(LENGTH + way, rel=1e-2)
    weight, hanging = MASS * G, 0.5 * MU * (LENGTH + way) * G  # and at the middle of the cable half of what is left of it
    rings = 5e-3  # of the tension, after the winch has stopped
    assert run.stretch("a-b")[-1] == pytest.approx((weight + hanging) / EA, rel=rings)
    assert run.final.stretch("a-b") == pytest.approx(run.stretch("a-b")[-1], rel=1e-9)
    row = run_summary(run)["cables"][0]
    assert row["end_stretch"] == run.stretch("a-b")[-1] == MEASURES["end_stretch"].function(run, "a-b")
    assert row["peak_stretch"] == run.stretch("a-b").max() == MEASURES["peak_stretch"].function(run, "a-b", None)
    longer = hoist(signals.line(0.5, 0.0, 0.0))  # paid out from the start on
    rest = equilibrium(longer)
    assert rest_summary(rest)["cables"][0]["stretch"] == pytest.approx(rest.segment_tension.mean() / EA, rel=1e-6)


def test_what_a_break_takes_away_is_no_stretch():
    """One of ten segments is cut: what is left is slack and falls, and its stretch is over the nine that there are."""
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("b", MASS)],
        [Cable("a", "b", length=LENGTH, mass_per_length=MU, EA=EA, zeta=0.5, segments=10)],
        [Gravity()],
        events=[CableCut("a-b", t=0.1, segment=4)],
    )
    run = simulate(scene, 0.3, method="edmc", dt=1e-3)
    np.testing.assert_allclose(run.stretch("a-b")[run.t > 0.1], run.length("a-b")[run.t > 0.1] / (0.9 * LENGTH) - 1.0, atol=1e-12)
    assert run.stretch("a-b")[0] == pytest.approx(run.length("a-b")[0] / LENGTH - 1.0, abs=1e-12)
    assert run.final.stretch("a-b") == pytest.approx(run.stretch("a-b")[-1], abs=1e-12)
