"""Polyester ropes with working curves: closed forms, an independent integration, the account, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from slow import slow

from anet_lumped import (
    Cable,
    Driven,
    Fixed,
    Free,
    InputError,
    Scene,
    SceneError,
    Session,
    equilibrium,
    load_run,
    paths,
    simulate,
    working_curves,
)
from anet_lumped.effects import Gravity
from anet_lumped.effects.laws import creep as law
from anet_lumped.effects.laws.working_curve import WorkingCurves
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict
from integrators.schemes.record import EnergyPromise

ORIGINAL = ((0.02, 0.8e6), (0.05, 3e6), (0.08, 6e6), (0.11, 9.5e6))
ALPHA, BETA, SLOW_BA, BA, T_MAX = 1.53e8, 23.12, 5e8, 1e5, 1.5e6
LINEAR = working_curves.Linear(permanent=0.25, T_max=T_MAX)
CURVES = (
    LINEAR,
    working_curves.Linear(EA=1.25e8, T_max=2e6),
    working_curves.Quadratic(permanent=0.3, bend=0.6, T_max=T_MAX),
    working_curves.Exponential(permanent=0.25, bend=1.1, T_max=T_MAX),
)
MATERIAL = {
    "tension_strain": ORIGINAL, "EA_dynamic": ALPHA, "EA_dynamic_per_tension": BETA, "BA_creep": SLOW_BA, "BA": BA,
    "working_curve": LINEAR,
}  # fmt: skip


def rope(segments=1, length=10.0, mass_per_length=40.0, **of_rope):
    return Cable("a", "b", length=length, mass_per_length=mass_per_length, segments=segments, **(MATERIAL | of_rope))


def driven(t, strain, **of_rope):
    """A rope of 10 m whose end goes through strains at given times, from rest to rest."""
    x = 10.0 * (1.0 + np.asarray(strain))
    path = paths.samples(t, np.column_stack([x, 0.0 * x, 0.0 * x]))
    return Scene([Fixed("a", (0, 0, 0)), Driven("b", path)], [rope(**of_rope)])


def hung(mass=1e5, **of_rope):
    return Scene([Fixed("a", (0, 0, 0)), Free("b", mass=mass)], [rope(**of_rope)], [Gravity(9.81)])


def original(T):
    """Strain of the original curve."""
    strains, tensions = np.array([(0.0, 0.0), *ORIGINAL]).T
    return np.interp(T, tensions, strains)


def working(T, curve, T_max):
    """Strain of a working curve with its true shape, which the rope takes in straight pieces."""
    top, g = original(T_max), T / T_max
    if isinstance(curve, working_curves.Linear):
        first, xi = (curve.permanent * top if curve.EA is None else top - T_max / curve.EA), g
    else:
        first, b = curve.permanent * top, curve.bend
        if isinstance(curve, working_curves.Exponential):
            xi = np.log1p(g * np.expm1(b)) / b
        else:
            xi = 2.0 * g / (1.0 - b + np.sqrt((1.0 - b) ** 2 + 4.0 * b * g))
    return first + (top - first) * xi


def held(T):
    """Strain of the fast spring under a tension that is held."""
    return np.log1p(BETA * T / ALPHA) / BETA


@pytest.mark.parametrize("curve", CURVES, ids=repr)
def test_a_slow_cycle_follows_the_curves(curve):
    """Stretched beyond T_max along the original curve, back along the working curve of what it held there, and up it again.

    A hundredth of the viscosity and hours of time leave a slow damper of some hundred newtons.
    """
    top, T_max = 0.06, 4e6
    low = working(1e6, curve, T_max)
    hours = 3600.0 * np.arange(4.0)
    scene = driven(hours, [working(1e6, curve, curve.T_max), top, low, top], working_curve=curve, BA_creep=0.01 * SLOW_BA)
    run = simulate(scene, hours[-1], dt=1.0, save_every=60.0)
    strain, T = run.position("b")[:, 0] / 10.0 - 1.0, run.tension("a-b")[:, 0]
    first, back = run.t <= hours[1], run.t > hours[1]
    near = 2e3 if isinstance(curve, working_curves.Linear) else 6e3  # 29 pieces of a curved shape are off by up to 1e-3 T_max
    for k in np.flatnonzero(first):
        reached = max(T[k], curve.T_max)
        exact = working(T[k], curve, curve.T_max) if T[k] < curve.T_max else original(T[k])
        assert strain[k] == pytest.approx(exact, abs=near / 7e7) and run.T_max[k, 0] == pytest.approx(reached, rel=1e-3)
    np.testing.assert_allclose(strain[back], working(T[back], curve, run.T_max[-1, 0]), atol=near / 7e7)
    assert original(run.T_max[-1, 0]) == pytest.approx(strain.max(), abs=near / 7e7) and T[back].min() < 1e6 + 2.0 * near


def test_relaxation():
    """Held at a strain after a jump of the slow stretch: on a straight working curve without BETA, an exponential of one time."""
    material = {"EA_dynamic_per_tension": 0.0, "working_curve": working_curves.Linear(EA=1.25e8, T_max=2e6)}
    scene = driven([0.0, 1.0], [0.03, 0.03], **material)
    rest = equilibrium(scene)
    slow = 1.0 / (1.0 / 1.25e8 - 1.0 / ALPHA)  # EA of the slow spring
    tau, T_held, off, more = (SLOW_BA + BA) / (slow + ALPHA), rest.tension("a-b")[0], [], 0.01
    s = brentq(lambda s: law_of(scene.cables[0], 2e6, s)[0] - T_held, 0.01, 0.4)  # settled
    start = replace(rest, crept=np.array([s - more]), T_max=np.array([2e6]))
    for dt in (0.2, 0.1, 0.05, 0.025):
        run = simulate(scene, 2.0, dt=dt, start=start)
        left = 0.1 * more * np.exp(-run.t / tau)  # strain
        exact = T_held + (SLOW_BA * ALPHA - BA * slow) / (SLOW_BA + BA) * left
        off.append([np.abs(run.crept[:, 0] - (s - 10.0 * left)).max(), np.abs(run.tension("a-b")[:, 0] - exact).max()])
    assert np.polyfit(np.log([8, 4, 2, 1]), np.log(off), 1)[0] == pytest.approx([2.0, 2.0], abs=0.15) and off[-1][1] < 50.0


def law_of(cable, T_max, s):
    """Tension held and its slope at a slow stretch, by the rope's compiled law."""
    return law.slow_part(s, creep_of(cable, T_max))[:2]


def creep_of(cable, T_max):
    rows = np.array(cable.working_rows)
    n, L0 = len(cable.tension_strain), cable.L0
    curves = WorkingCurves(L0, rows, 0, n, len(rows), *cable.working_curve.numbers, T_max)
    return law.Creep(cable.creep[0], ALPHA / L0, cable.EA_dynamic_per_tension / L0, SLOW_BA / L0, BA / L0, curves)


@pytest.mark.parametrize("per_tension", [BETA, *slow(0.0)])
def test_order_against_an_independent_integration(per_tension):
    """Waves about a growing and then a falling mean: the slow stretch by DOP853, from the equations as they are written."""
    t = np.linspace(0.0, 12.0, 25)
    strain = 0.03 + 0.012 * (1.0 - np.cos(2.0 * np.pi * t / 12.0)) + 0.002 * np.sin(2.0 * np.pi * t / 3.0)
    scene = driven(t, strain, EA_dynamic_per_tension=per_tension)
    driven_end = scene.points[1]
    start = equilibrium(scene)

    def static(T, T_max):
        y = np.log1p(per_tension * T / ALPHA) / per_tension if per_tension else T / ALPHA
        return (original(T) if T > T_max else working(T, LINEAR, T_max)) - y

    def held_tension(s, T_max):
        return brentq(lambda T: static(T, T_max) - s, 0.0, 9.5e6, xtol=1e-6)

    def rate(t, state, T_max):
        x, v = (rows[0] for rows in driven_end.path.at(t)[:2])
        P = held_tension(state[0], T_max)
        K = ALPHA + per_tension * P
        s_rate = K * (x / 10.0 - 1.0 - (state[0] + (np.log1p(per_tension * P / ALPHA) / per_tension if per_tension else P / ALPHA)))
        return [(s_rate + BA * v / 10.0) / (SLOW_BA + BA)]

    # T_max grows with P while the slow stretch does: along the original curve, which any T_max below P stands for
    T0 = start.tension("a-b")[0]
    begin = max(T_MAX, T0)
    turning = solve_ivp(rate, (0.0, 12.0), [static(T0, begin)], "DOP853", args=(begin,), rtol=1e-11, atol=1e-14, dense_output=True)
    peak = max(np.linspace(4.0, 10.0, 6001), key=lambda t: turning.sol(t)[0])
    s_peak = turning.sol(peak)[0]
    T_max = held_tension(s_peak, begin)
    fall = solve_ivp(rate, (peak, 12.0), [s_peak], "DOP853", args=(T_max,), rtol=1e-11, atol=1e-14)
    off = []
    for dt in (0.08, 0.04, 0.02, 0.01):
        run = simulate(scene, 12.0, dt=dt, start=start)
        assert run.ok and run.energy_balance.imbalance < 1e-12
        assert np.diff(run.energy[:, 4]).min() >= 0.0  # what is taken never comes back
        off.append(abs(run.crept[-1, 0] / 10.0 - fall.y[0, -1]))
        assert run.T_max[-1, 0] == pytest.approx(T_max, rel=2e-3 * (dt / 0.08) ** 2 + 1e-6)
    assert np.polyfit(np.log([8, 4, 2, 1]), np.log(off), 1)[0] == pytest.approx(2.0, abs=0.15) and off[-1] < 1e-6
    assert (np.diff(run.T_max[:, 0]) >= 0.0).all() and run.energy_promise is EnergyPromise.NONE


@pytest.mark.parametrize("curve", CURVES, ids=repr)
def test_slow_spring_and_its_energy(curve):
    """Tension by the slow stretch as a root of the curves in straight pieces; the energy as an integral along the working curve."""
    cable, T_max = rope(working_curve=curve), 3.5e6
    made, xi = creep_of(cable, T_max), np.array([(0.0, 0.0), *curve.shape])
    top = original(T_max)
    first = curve.first_strain(top, T_max)

    def strain(T):
        return first + (top - first) * np.interp(T / T_max, xi[:, 1], xi[:, 0]) if T < T_max else original(T)

    for T in (1e3, 4e5, 1.7e6, 3.4e6, 3.6e6, 8e6):
        s = 10.0 * (strain(T) - held(T))
        part = law.slow_part(s, made)
        assert part.tension == pytest.approx(T, rel=1e-9) and part.fast_stiffness == pytest.approx((ALPHA + BETA * T) / 10.0)
        around = [law.slow_part(s * (1.0 + e), made).tension for e in (1e-6, -1e-6)]
        assert part.slope == pytest.approx((around[0] - around[1]) / (2e-6 * s), rel=1e-3)
        if T < T_max:
            y = held(T) * 10.0
            area = (
                T * 10.0 * strain(T)
                - 10.0 * quad(strain, 0.0, T, limit=200, points=T_max * xi[1:-1, 1][T_max * xi[1:-1, 1] < T])[0]
            )
            assert law.stored_energy(y, s, made) == pytest.approx(area, rel=1e-6)
            z = 0.3 * y  # beyond: P z + k_d z^2/2
            more = T * z + 0.5 * part.fast_stiffness * z * z
            assert law.stored_energy(y + z, s, made) == pytest.approx(area + more, rel=1e-6)


def test_statics_take_the_curves_and_a_run_stays_there():
    for mass, T_max in ((1e5, T_MAX), (3e5, 3e5 * 9.81)):  # below the largest tension, and beyond it
        scene = hung(mass, segments=2, mass_per_length=1e-3)
        rest = equilibrium(scene)
        T = mass * 9.81
        exact = working(T, LINEAR, T_MAX) if T < T_MAX else original(T)
        assert rest.length("a-b") == pytest.approx(10.0 * (1.0 + exact), rel=1e-7)
        assert scene.cables[0].strain(T) == pytest.approx(exact, rel=1e-12)
        run = simulate(scene, 0.5, dt=0.01)
        np.testing.assert_allclose(run.tension("a-b"), T, rtol=1e-7)
        np.testing.assert_allclose(run.T_max, T_max, rtol=1e-7)
    slack = equilibrium(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (9.0, 0, 0))], [rope(8)], [Gravity(9.81)]))
    assert slack.length("a-b") == pytest.approx(10.0 * (1.0 + 0.25 * original(T_MAX)), rel=1e-4)  # weight stretches it by 2e-5


def test_a_load_that_is_dropped_snaps_and_takes():
    """Thrown up, slack, and caught: nothing is given back, and the account closes."""
    scene = hung(5e4, segments=6, mass_per_length=20.0, BA_creep=1e7)
    start = equilibrium(scene)
    start.v[start.model.node("b"), 2] = 3.0
    for dt in (0.01, 0.0025):
        run = simulate(scene, 3.0, dt=dt, start=start)
        assert run.ok and (run.tension("a-b") == 0.0).any() and run.tension("a-b").max() > 1.5e6
        assert run.energy_balance.imbalance < 1e-6 and np.diff(run.energy[:, :3].sum(axis=1)).max() < 1e-6 * 5e4 * 9.0
        assert run.work.newton_iterations < 2 * run.work.steps and run.work.halvings == 0  # 1.5 a step; a wrong slope takes 5


def test_a_session_a_restart_and_a_file_carry_both_states(tmp_path):
    t = np.linspace(0.0, 8.0, 9)
    scene = driven(t, [0.03, 0.04, 0.06, 0.05, 0.03, 0.05, 0.07, 0.06, 0.05], segments=2)
    run = simulate(scene, 8.0, dt=0.02)
    with Session(scene, 0.02, start=equilibrium(scene)) as session:
        mark = None
        for k in range(400):
            mark = session.save() if k == 150 else mark
            session.step()
        assert np.array_equal(session.state.T_max, run.T_max[-1]) and np.array_equal(session.state.crept, run.crept[-1])
        session.restore(mark)
        for _ in range(250):
            session.step()
        assert np.array_equal(session.state.T_max, run.T_max[-1]) and np.array_equal(session.state.crept, run.crept[-1])
    run.save(tmp_path / "run.nc")
    loaded = load_run(tmp_path / "run.nc")
    assert np.array_equal(loaded.T_max, run.T_max) and np.array_equal(loaded.state(7).T_max, run.state(7).T_max)
    half = run.state(np.searchsorted(run.t, 4.0 - 1e-9))
    again = simulate(scene, 4.0, dt=0.02, start=half)
    np.testing.assert_allclose(again.tension("a-b")[-1], run.tension("a-b")[-1], rtol=1e-9)


def test_a_rope_that_breaks_keeps_its_account():
    """What its springs hold of the segment that fails is lost; the piece that is left has held what it had."""
    scene = hung(8e4, segments=4, mass_per_length=1e-3, breaking_tension=1.2e6)
    start = equilibrium(scene)
    start.v[start.model.node("b"), 2] = -1.5
    run = simulate(scene, 0.6, dt=0.005, start=start)
    event = run.events[0]
    assert event.kind == "broke" and event.lost > 0.0 and run.energy_balance.imbalance < 1e-7
    assert run.T_max[-1, event.segment] == 0.0 and np.delete(run.T_max[-1], event.segment).min() == T_MAX


def test_scene_files():
    for curve in CURVES:
        scene = hung(working_curve=curve)
        assert scene_from_dict(scene_to_dict(scene)) == scene
    assert scene_to_dict(scene)["cables"][0]["working_curve"] == {
        "kind": "exponential", "permanent": 0.25, "bend": 1.1, "T_max": T_MAX,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"working_curve": "linear"}, "`working_curve` must be one of anet_lumped.working_curves, but cable"),
        ({"EA_dynamic": None}, 'original curve, and `EA_dynamic`, but cable "a-b" has no `EA_dynamic`'),
        ({"tension_strain": None, "EA": 1e7}, 'original curve, and `EA_dynamic`, but cable "a-b" has no `tension_strain`'),
        ({"BA_creep": 0.0}, "must have a positive `BA_creep`, but"),
        ({"EA_dynamic": 5e7}, r"tension_strain of a polyester rope must be less steep than its fast spring, .* at T=8e\+05 N"),
        ({"working_curve": replace(LINEAR, permanent=0.7)}, r"The working curve of .* that of cable \"a-b\" for T_max=1.5e\+06 N"),
        ({"working_curve": working_curves.Linear(EA=4e7, T_max=T_MAX)}, "must begin at no negative strain, but that of cable"),
        (
            {"working_curve": working_curves.Linear(permanent=0.0, T_max=T_MAX)},
            "must give back no more work than the original curve",
        ),
    ],
)
def test_what_a_rope_cannot_be(change, says):
    with pytest.raises(SceneError, match=says):
        rope(**change)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: working_curves.Linear(), "must have one of `permanent` and `EA`, but has permanent=None"),
        (lambda: working_curves.Linear(permanent=1.0), "`permanent` must be less than 1, but working curve has permanent=1.0"),
        (lambda: working_curves.Quadratic(0.2, 1.1), "`bend` must be up to 1, but"),
        (lambda: working_curves.Exponential(0.2, 0.0), "`bend` must be positive"),
        (lambda: working_curves.Exponential(0.2, 101.0), "`bend` must be up to 100, but"),
        (lambda: working_curves.Exponential(0.2, 1.0, T_max=-1.0), "`T_max` must be non-negative"),
    ],
)
def test_what_a_working_curve_cannot_be(make, says):
    with pytest.raises(SceneError, match=says):
        make()


def test_what_refuses_it(tmp_path):
    scene = hung()
    rest = equilibrium(scene)
    with pytest.raises(
        InputError, match='must have both `crept` and `T_max` or none, but that of "a-b" has `crept` and no `T_max`'
    ):
        simulate(scene, 0.1, dt=0.01, start=replace(rest, crept=np.zeros(1)))
    with pytest.raises(InputError, match=r"held a `T_max` of no less than 0 N, but a segment of cable \"a-b\" has -1\.0 N"):
        simulate(scene, 0.1, dt=0.01, start=replace(rest, crept=np.zeros(1), T_max=-np.ones(1)))
    run = simulate(scene, 0.02, dt=0.01)
    replace(run, T_max=None).save(tmp_path / "run.nc")
    with pytest.raises(InputError, match="largest tensions held"):
        load_run(tmp_path / "run.nc")
