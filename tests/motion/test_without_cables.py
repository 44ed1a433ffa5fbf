"""Bodies and points alone: scenes without a cable, against closed forms."""

import math
import warnings

import numpy as np
import pytest

from anet_lumped import (
    Body,
    Driven,
    Fixed,
    Free,
    InputError,
    NoRestError,
    Rod,
    Scene,
    SceneError,
    Session,
    equilibrium,
    load_run,
    load_scene,
    paths,
    save_scene,
    simulate,
    simulate_many,
)
from anet_lumped.advice.recommend import recommend
from anet_lumped.effects import Gravity, Ground, Water
from integrators import schemes

G = 9.81
THROUGH = [name for name in schemes.names(takes_rigid_bodies=True) if schemes.scheme(name).own]


def brick(**fields):
    return Body("brick", **({"mass": 2.0, "inertia": (0.1, 0.2, 0.25), "at": (1.0, 2.0, 3.0)} | fields))


def pendulum(angle):
    """A body of 1 kg, 0.02 kg m2 across, with its centre of mass 0.5 m under its pin, turned aside about y."""
    fields = {"inertia": (0.02, 0.02, 0.01), "centre_of_mass": (0.0, 0.0, -0.5), "pinned": ""}
    return Body("bob", mass=1.0, at=(0.0, 0.0, 0.0), rotation=(0.0, angle, 0.0), **fields)


@pytest.mark.parametrize("method", [None, *THROUGH])
def test_a_body_falls(method):
    """z = -g t^2/2, which schemes of order 2 meet to what Newton's method leaves; those of order 1 are off by g h t/2."""
    run = simulate(Scene([], [], [Gravity(G)], bodies=[brick()]), 1.0, method=method, dt=None, start="straight")
    first = method is not None and schemes.scheme(method).order == 1
    off = 0.6 * G * run.dt if first else 1e-8
    assert run.status == "done" or method == "explicit_euler"  # which gains energy by its order
    assert run.position("brick")[-1] == pytest.approx((1.0, 2.0, 3.0 - G / 2), abs=off)
    assert run.velocity("brick")[-1] == pytest.approx((0.0, 0.0, -G), abs=1e-7)
    assert run.segment_tension.shape == (len(run.t), 0) and run.tension_error in (0.0, None)


@pytest.mark.parametrize("method", [None, "verlet", "rk4", "DOP853", "Radau"])
def test_a_point_falls(method):
    run = simulate(Scene([Free("p", 2.0, at=(0, 0, 0))], [], [Gravity(G)]), 1.0, method=method, start="straight")
    assert run.position("p")[-1] == pytest.approx((0.0, 0.0, -G / 2), abs=1e-6)  # of the tolerance of the solvers of scipy


def test_a_clump_sinks_with_its_terminal_velocity():
    """v = v_t tanh(a t/v_t), with v_t^2 = 2 (m - rho V) g/(rho CdA) and the acceleration a from rest of m + Ca rho V."""
    m, V, CdA, Ca, rho = 50.0, 0.01, 0.05, 0.5, 1000.0
    clump = Free("clump", m, at=(0.0, 0.0, -5.0), volume=V, CdA=CdA, Ca=Ca)
    run = simulate(Scene([clump], [], [Gravity(G), Water(density=rho)]), 2.0, start="straight", error=1e-4)
    weight = (m - rho * V) * G
    terminal, a = math.sqrt(2.0 * weight / (rho * CdA)), weight / (m + Ca * rho * V)
    way = terminal**2 / a * np.log(np.cosh(a * run.t / terminal))
    assert np.abs(run.position("clump")[:, 2] + 5.0 + way).max() < 1e-4  # the error that was asked for


def test_a_body_that_nothing_turns_keeps_its_momentum_and_energy():
    """Euler's equations: about its middle axis it tumbles, and R J w and w J w/2 stay what they are."""
    J = np.array([0.1, 0.2, 0.25])
    scene = Scene([], [], [], bodies=[brick(inertia=J)])
    spins = simulate(scene, 1e-3, start="straight", dt=1e-3).final.moved("brick", angular_velocity=(0.02, 3.0, 0.01))
    run = simulate(scene, 5.0, start=spins, dt=2e-3)
    rotations, turns = run.rotation("brick"), run.angular_velocity("brick")
    own = np.einsum("kji,kj->ki", rotations, turns)
    momentum = np.einsum("kij,kj->ki", rotations, J * own)
    energy = 0.5 * (own * J * own).sum(axis=1)
    assert np.abs(own[:, 1]).min() < 0.5 * own[0, 1]  # it has turned over
    assert momentum == pytest.approx(np.broadcast_to(momentum[0], momentum.shape), abs=1e-9)  # what Newton's method leaves
    assert energy == pytest.approx(energy[0], rel=1e-9)


def test_a_box_heaves_with_its_period():
    """T = 2 pi sqrt((m + m_a)/(rho g A)), about the draught at which it floats, with m_a = Ca m: of the water that it displaces."""
    rho, m = 1025.0, 500.0
    box = brick(mass=m, inertia=(200.0,) * 3, hull=(2.0, 2.0, 1.0), Ca=(0.1,) * 3, at=(0.0, 0.0, 0.4))
    scene = Scene([], [], [Gravity(G), Water(density=rho)], bodies=[box])
    rest = equilibrium(scene)
    draught = m / (rho * 4.0)
    assert rest.stable and rest.position("brick")[2] == pytest.approx(0.5 - draught, abs=1e-9)
    run = simulate(scene, 6.0, start=rest.moved("brick", at=(*rest.position("brick")[:2], 0.5 - draught + 0.02)), error=1e-5)
    z = run.position("brick")[:, 2] - 0.5 + draught
    crossings = np.flatnonzero((z[:-1] > 0.0) & (z[1:] <= 0.0))
    t = run.t[crossings] + z[crossings] / (z[crossings] - z[crossings + 1]) * np.diff(run.t)[crossings]
    period = 2.0 * math.pi * math.sqrt(1.1 * m / (rho * G * 4.0))
    assert np.diff(t).mean() == pytest.approx(period, rel=2e-3)  # the error asked for, over the amplitude, in two periods


def test_a_rod_swings_about_its_pin():
    """A physical pendulum of small angle: w^2 = m g c/J about the pin."""
    run = simulate(Scene([], [], [Gravity(G)], bodies=[pendulum(0.01)]), 4.0, start="straight", error=1e-5)
    omega = math.sqrt(1.0 * G * 0.5 / (0.02 + 0.25))
    turned = 2.0 * run.quaternion("bob")[:, 2]
    assert turned == pytest.approx(0.01 * np.cos(omega * run.t), abs=1e-4)  # 1 % of the amplitude: the error asked for over 0.1 m


def test_a_held_body_comes_to_rest_under_its_pin():
    rest = equilibrium(Scene([Fixed("o", (0, 0, 0))], [], [Gravity(G)], bodies=[pendulum(0.3)]))
    assert rest.stable and rest.rotation("bob") == pytest.approx(np.eye(3), abs=1e-9)


def test_a_body_hangs_on_a_driven_point():
    driven = Driven("d", paths.line((0, 0, 0), (1, 0, 0), 1.0))
    bob = Body("bob", mass=1.0, inertia=(0.02,) * 3, centre_of_mass=(0, 0, -0.5), pinned="", pinned_to="d")
    run = simulate(Scene([driven], [], [Gravity(G)], bodies=[bob]), 2.0)
    assert run.ok and run.position("bob")[-1] == pytest.approx((1.5, 0.0, 0.0), abs=1e-9)  # 0.5 m in its ramp


def test_a_body_lies_on_the_ground_and_a_point_floats():
    """The body is as deep as its weight presses it, m g = k A s; the point is under water with its mass over the density."""
    rod = Rod("pipe", (-0.5, 0, 0), (0.5, 0, 0), segments=4, mass_per_length=3.0, diameter=0.1)
    scene = Scene([], [], [Gravity(G), Ground(height=0.0, stiffness=1e5)], bodies=[Body("lying", at=(0, 0, 1), rods=[rod])])
    with pytest.raises(SceneError):
        Ground(height=0.0, stiffness=-1.0)
    rest = equilibrium(scene)
    assert rest.position("lying")[2] == pytest.approx(-3.0 * G / (1e5 * 0.1), rel=1e-6)
    float_ = Scene([Free("buoy", 5.0, at=(0, 0, 3), volume=0.01)], [], [Gravity(G), Water(density=1000.0)])
    assert equilibrium(float_).position("buoy")[2] == pytest.approx(0.0, abs=1e-9)  # half of its volume carries it


def test_nothing_holds_what_falls_or_sinks():
    falling = Scene([], [], [Gravity(G)], bodies=[brick()])
    sinking = Scene([Free("clump", 50.0, at=(0, 0, -5), volume=0.01, CdA=0.1)], [], [Gravity(G), Water()])
    heavy = Scene([], [], [Gravity(G), Water()], bodies=[brick(volume=1e-4)])
    for scene, what in ((falling, 'body "brick"'), (sinking, 'free point "clump"'), (heavy, 'body "brick"')):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with pytest.raises(NoRestError, match=f"nothing holds {what}; `simulate` moves it"):
                equilibrium(scene)


def test_results_are_written_and_drawn(tmp_path):
    scene = Scene([Free("p", 2.0, at=(0, 0, 0))], [], [Gravity(G)], bodies=[brick()])
    save_scene(scene, tmp_path / "alone.toml")
    assert load_scene(tmp_path / "alone.toml") == scene
    run = simulate(scene, 0.1, start="straight", dt=0.01)
    run.save(tmp_path / "alone.nc")
    back = load_run(tmp_path / "alone.nc")
    assert np.array_equal(back.q, run.q) and back.segment_tension.shape == run.segment_tension.shape == (len(run.t), 0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for draw in (run.plot, run.plot_tension, run.final.plot, run._repr_html_, run.final._repr_html_):
            assert draw()
    assert run.to_xarray()["tension"].shape == (len(run.t), 0, 0) and "p z [m]" in run.to_frame()
    session = Session(scene, 0.01, start="straight")
    session.step()
    assert np.array_equal(session.state.position("p"), run.position("p")[1])
    both = simulate_many([scene, scene], 0.1, dt=0.01, start="straight")
    assert np.array_equal(both["position"].values[0], both["position"].values[1])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: Scene([Free("p", 1.0)], []),
            "`cables` of a scene must hold at least one Cable, but is empty; without any, only bodies",
        ),
        (lambda: Scene([Fixed("o", (0, 0, 0))], []), "`cables` of a scene must hold at least one Cable, but is empty"),
        (
            lambda: Scene([Free("p", at=(0, 0, 0))], [], bodies=[brick()]),
            r'must have a mass and a place, but "p" has mass=0 and at=',
        ),
        (lambda: Scene([], []), "`points` of a scene must hold Fixed, Driven or Free points, but is empty"),
        (
            lambda: simulate(Scene([], [], [Gravity(G), Ground(0.0, 1e5)], bodies=[brick()]), 1.0, start="straight"),
            "The effect Ground acts on cables, on rods and on bodies with a `contact_area`, but the scene has none",
        ),
    ],
)
def test_what_cannot_move_is_refused(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_segments_are_recommended_for_cables():
    with pytest.raises(InputError, match="Segments are recommended for cables, but the scene has none"):
        recommend(Scene([], [], [Gravity(G)], bodies=[brick()]), 1e-3)
