"""Cables that creep: closed forms of one segment, the account of energy, what carries the creep, and what refuses it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.optimize import brentq

from anet_lumped import (
    Cable,
    Driven,
    Fixed,
    Free,
    Run,
    Scene,
    SceneError,
    Session,
    equilibrium,
    load_run,
    load_scene,
    paths,
    signals,
    simulate,
)
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity, LineChange
from anet_lumped.effects.laws import creep as law
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

EA, FAST, SLOW_BA, BA, G = 1e4, 2.5e4, 3e4, 500.0, 9.81
K1 = EA * FAST / (FAST - EA)  # slow spring of a segment of a metre
MATERIAL = {"EA": EA, "EA_dynamic": FAST, "BA_creep": SLOW_BA, "BA": BA}


def rope(segments=1, length=1.0, mass_per_length=1e-3, **of_rope):
    return Cable("a", "b", length=length, mass_per_length=mass_per_length, segments=segments, **(MATERIAL | of_rope))


def held(stretch=0.01, **of_rope):
    """A rope of a metre between two fixed points."""
    return Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0, 0, -1.0 - stretch))], [rope(**of_rope)], [Gravity(G)])


def hung(mass=10.0, at=(0, 0, -1.0), **of_rope):
    return Scene([Fixed("a", (0, 0, 0)), Free("b", at=at, mass=mass)], [rope(**of_rope)], [Gravity(G)])


def uncrept(scene):
    """Its rest, with a rope that has not crept yet."""
    rest = equilibrium(scene)
    return replace(rest, crept=np.zeros(rest.model.n_segments))


def series(x, v, s):
    """Tension at one time, from the equations of both parts."""
    return (SLOW_BA * (FAST * (x - s) + BA * v) + BA * K1 * s) / (SLOW_BA + BA)


def test_relaxation():
    """A length that is held: the slow stretch comes exponentially, with (c_s + c)/(k_1 + k_d), and the tension falls with it."""
    start, tau, off = uncrept(held()), (SLOW_BA + BA) / (K1 + FAST), []
    for dt in (0.2, 0.1, 0.05, 0.025):
        run = simulate(held(), 4.0, dt=dt, start=start)
        s = 0.01 * FAST / (K1 + FAST) * (1.0 - np.exp(-run.t / tau))
        off.append([np.abs(run.crept[:, 0] - s).max(), np.abs(run.tension("a-b")[:, 0] - series(0.01, 0.0, s)).max()])
    assert run.tension("a-b")[-1, 0] == pytest.approx(EA * 0.01, rel=0.01)  # e^-5.5 is left
    slopes = np.polyfit(np.log([8, 4, 2, 1]), np.log(off), 1)[0]
    assert slopes == pytest.approx([2.0, 2.0], abs=0.15) and max(off[-1]) < 0.01


def test_creep_under_a_weight():
    """The rope has not crept, and lets 10 kg go: linear equations of place, velocity and slow stretch, solved exactly."""
    start, off = uncrept(hung()), []
    m = 10.0 + 0.5e-3
    T = np.array([series(*row) for row in np.eye(3)])
    A = np.array([[0.0, 1.0, 0.0], -T / m, (T - [0.0, 0.0, K1]) / SLOW_BA])
    rest = np.array([m * G / EA, 0.0, m * G / K1])
    x0 = rest[0]
    z = np.array([expm(A * t) @ (np.array([x0, 0.0, 0.0]) - rest) + rest for t in np.linspace(0.0, 0.6, 13)])
    for dt in (0.01, 0.005, 0.0025, 0.00125):
        run = simulate(hung(), 0.6, dt=dt, save_every=0.05, start=start, rho_inf=1.0)
        found = np.column_stack([-1.0 - run.position("b")[:, 2], -run.velocity("b")[:, 2], run.crept[:, 0]])
        off.append(np.abs(found - z).max(axis=0))
        balance = run.energy_balance
        assert balance.imbalance < 1e-9 and balance.by_dampers > 0.0 and balance.by_method < 1e-9
    stored = 0.5 * K1 * z[-1, 2] ** 2 + 0.5 * FAST * (z[-1, 0] - z[-1, 2]) ** 2 - 0.5 * FAST * x0**2
    assert balance.elastic == pytest.approx(stored, rel=1e-3)
    assert np.polyfit(np.log([8, 4, 2, 1]), np.log(off), 1)[0] == pytest.approx([2.0] * 3, abs=0.15)


@pytest.mark.parametrize("frequency", [0.02, 0.2, 2.0])  # below, at and above that of the creep, 0.22 Hz
def test_complex_modulus(frequency):
    """A harmonic stretch about a pretension: K* of two Kelvin-Voigt solids in series, its storage and its loss."""
    omega, A = 2.0 * np.pi * frequency, 1e-3
    path = paths.harmonic((0, 0, -1.01), (0, 0, -A), frequency)
    scene = Scene([Fixed("a", (0, 0, 0)), Driven("b", path)], [rope()], [Gravity(G)])
    period = 1.0 / frequency
    run = simulate(scene, 4.0 + 2.0 * period, dt=period / 400, save_every=period / 100)
    late = run.t > run.t[-1] - 1.001 * period
    t, T = run.t[late], run.tension("a-b")[late, 0]
    columns = np.column_stack([np.sin(omega * t), np.cos(omega * t), np.ones_like(t)])
    storage, loss, mean = np.linalg.lstsq(columns, T, rcond=None)[0]
    exact = 1.0 / (1.0 / (K1 + 1j * omega * SLOW_BA) + 1.0 / (FAST + 1j * omega * BA))
    assert complex(storage, loss) / A == pytest.approx(exact, rel=2e-3) and mean == pytest.approx(EA * 0.01, rel=2e-3)


@pytest.mark.parametrize("per_tension", [0.0, 40.0])
def test_energy_never_rises_through_whips_and_snaps(per_tension):
    scene = hung(
        2.0, (0.3, 0.2, 0.5), segments=8, length=2.0, mass_per_length=0.1, EA_dynamic_per_tension=per_tension, BA_creep=3e3
    )
    for dt in (0.01, 0.002):
        run = simulate(scene, 1.5, dt=dt, start="straight")
        tension = run.tension("a-b")
        assert run.ok and (tension == 0.0).any() and tension.max() > 300.0  # slack, and snapped taut
        assert (
            np.diff(run.energy[:, :3].sum(axis=1)).max() < 1e-10 and run.energy_balance.imbalance < 1e-5
        )  # Newton's 1e-6 of a snap
        assert (run.crept >= 0.0).all() and run.energy_balance.by_dampers > 0.0
    assert run.energy_promise.name == ("NONE" if per_tension else "NEVER_RISES")


def test_statics_take_the_static_stiffness_and_a_run_stays_there():
    scene = hung(EA_dynamic_per_tension=30.0)
    rest = equilibrium(scene)
    T = 10.0005 * G
    assert rest.length("a-b") == pytest.approx(1.0 + T / EA, rel=1e-12)
    run = simulate(scene, 0.5, dt=0.01)
    np.testing.assert_allclose(run.crept[-1], T / EA - T / (FAST + 30.0 * T), rtol=1e-9)
    np.testing.assert_allclose(run.tension("a-b"), T, rtol=1e-9)


@pytest.mark.parametrize("per_tension", [0.0, 3.0, 200.0])
def test_slow_spring(per_tension):
    """The fast stiffness by the tension of the slow spring, found as a root; the energy as an integral."""
    made = law.Creep(EA, FAST, per_tension, SLOW_BA, BA)
    for s in (1e-4, 5e-3, 0.2):
        P = brentq(lambda P, s=s: P / EA - P / (FAST + per_tension * P) - s, 0.0, 1e5, xtol=1e-12, rtol=1e-14)
        found, slope = law.slow_tension(s, made)
        assert found == pytest.approx(P, rel=1e-9) and law.fast_stiffness(s, made) == pytest.approx(
            FAST + per_tension * P, rel=1e-9
        )
        assert slope == pytest.approx(
            (law.slow_tension(s * 1.0001, made)[0] - law.slow_tension(s * 0.9999, made)[0]) / (2e-4 * s), rel=1e-6
        )
        assert law.slow_energy(s, made) == pytest.approx(quad(lambda x: law.slow_tension(x, made)[0], 0.0, s)[0], rel=1e-9)


def test_a_session_and_a_restart_carry_the_creep(tmp_path):
    scene = hung()
    start = uncrept(scene)
    run = simulate(scene, 0.2, dt=0.005, start=start)
    with Session(scene, 0.005, start=start) as session:
        mark = None
        for k in range(40):
            mark = session.save() if k == 20 else mark
            session.step()
        assert np.array_equal(session.state.crept, run.crept[-1]) and np.array_equal(session.state.q, run.q[-1])
        session.restore(mark)
        for _ in range(20):
            session.step()
        assert np.array_equal(session.state.crept, run.crept[-1])
    run.save(tmp_path / "run.nc")
    loaded = load_run(tmp_path / "run.nc")
    assert np.array_equal(loaded.crept, run.crept)
    on, again = (simulate(scene, 0.1, dt=0.005, start=state) for state in (run.final, loaded.final))
    assert np.array_equal(on.crept, again.crept) and on.crept[0] == run.crept[-1] and on.crept[-1] > run.crept[-1]


def test_a_rope_that_breaks_keeps_its_account():
    """What both springs hold of the segment that fails is lost; the piece that is left goes on creeping."""
    scene = hung(segments=4, breaking_tension=260.0, BA=0.0)
    start = uncrept(scene)
    start.v[start.model.node("b"), 2] = -0.4
    run = simulate(scene, 0.2, dt=0.001, start=start)
    event = run.events[0]
    held = 0.5 * 260.0**2 * 0.25 / FAST  # of the fast spring of a quarter of the rope, which has hardly crept
    assert event.kind == "broke" and event.lost == pytest.approx(held, rel=0.02) and run.energy_balance.imbalance < 1e-7
    assert run.crept.shape == run.segment_tension.shape and run.crept[-1, event.segment] == 0.0 < run.crept[-1].max()


def test_scene_files_and_names():
    scene = hung(EA_dynamic_per_tension=2.0)
    assert scene_from_dict(scene_to_dict(scene)) == scene
    assert rope(BA=None, zeta=0.2).axial_viscosity == pytest.approx(0.2 * np.sqrt(FAST * 1e-3))  # of the fast stretching
    assert load_scene("net_held").cables[0].EA_fast == load_scene("net_held").cables[0].EA


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"EA_dynamic": None}, '`BA_creep` and `EA_dynamic_per_tension` must come with `EA_dynamic`, but cable "a-b" has none'),
        ({"EA_dynamic": None, "BA_creep": None, "EA_dynamic_per_tension": 1.0}, "must come with `EA_dynamic`"),
        ({"BA_creep": None}, r'must have `BA_creep`, the viscosity of its creep \[N·s\], but cable "a-b" has none'),
        ({"EA_dynamic": EA}, "must be larger than the EA .* has EA_dynamic=10000.0 and EA=10000.0"),
        ({"EA": None, "tension_strain": ((0.1, 10.0),)}, "goes with no `tension_strain`"),
        ({"compression": "damped"}, 'only pulls, compression="none", but cable "a-b" has compression=.damped'),
        ({"BA_creep": 0.0, "BA": None}, 'must have a viscosity, but cable "a-b" has BA_creep=0 and no `BA` or `zeta`'),
    ],
)
def test_what_a_rope_cannot_be(change, says):
    with pytest.raises(SceneError, match=says):
        rope(**change)


def test_what_refuses_it(tmp_path):
    scene = hung()
    rest = equilibrium(scene)
    with pytest.raises(InputError, match=r'that creeps needs method="edmc", but cable "a-b" has .* the method is verlet'):
        simulate(scene, 0.1, method="verlet", dt=1e-4)
    with pytest.raises(InputError, match=r'that creeps needs fixed steps, but cable "a-b" has an `EA_dynamic` and a tolerance is'):
        simulate(scene, 0.1, method="edmc", rtol=1e-5)
    with pytest.raises(SceneError, match=r'creeps keeps its rest length, but that of cable "a-b" is to change in time'):
        equilibrium(replace(scene, effects=[Gravity(G), LineChange({"a-b": signals.line(0.0, 0.1, 1.0)})]))
    with pytest.raises(InputError, match=r'must be given, which no place tells, but those of "a-b" are not'):
        Run(rest.model, np.zeros(1), rest.q[None], rest.v[None], np.zeros((1, 7)), "edmc", 0.1)
    with pytest.raises(InputError, match=r'crept by no less than 0 m, but a segment of cable "a-b" has by -1\.0 m'):
        simulate(scene, 0.1, dt=0.01, start=replace(rest, crept=-np.ones(1)))
    run = simulate(scene, 0.01, dt=0.005)
    replace(run, crept=None).save(tmp_path / "run.nc")
    with pytest.raises(InputError, match="or it does not, and one does"):
        load_run(tmp_path / "run.nc")
    assert "creeps" in run.reason
