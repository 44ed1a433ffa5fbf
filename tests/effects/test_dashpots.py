"""Dashpots between points and the world, against closed forms."""

import math

import numpy as np
import pytest

from anet_lumped import Body, Cable, Fixed, Free, Scene, SceneError, equilibrium, paths, simulate
from anet_lumped.effects import Dashpots, Gravity
from anet_lumped.model.build import build
from anet_lumped.prescribed.turning import matrix_of
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

MASS, g = 4.0, 9.81
TURN = (0.3, -0.4, 0.9)


def scene(dashpots, body=None):
    """A weight, or a body, on a cable so long and light that it moves as if there were none."""
    end = Free("w", MASS, (0.0, 0.0, -5.0)) if body is None else None
    rope = Cable("top", "w", length=900.0, mass_per_length=1e-10, EA=1.0, segments=1)
    return Scene(
        [Fixed("top", (0.0, 0.0, 0.0)), *([end] if end else [])], [rope], [Gravity(g), dashpots], bodies=[body] if body else []
    )


def box(**fields):
    usual = {
        "mass": MASS,
        "inertia": (0.3, 0.4, 0.5),
        "at": (0.0, 0.0, -5.0),
        "rotation": TURN,
        "attachments": {"a": (0.2, 0.1, 0.3)},
    }
    return Body("w", **(usual | fields))


def test_a_weight_falls_against_both_kinds():
    """m dv/dt = m g - b v - c v^2: v = -b/2c + w tanh(c w t/m + C), w^2 = m g/c + (b/2c)^2, tanh C = b/(2 c w). 4 ppm of 2 ms."""
    b, c, t = 3.0, 0.5, 2.0
    run = simulate(scene(Dashpots({"w": (1.0, 1.0, b)}, {"w": (1.0, 1.0, c)})), t, method="edmc", dt=0.002, start="straight")
    w = math.sqrt(MASS * g / c + (b / (2 * c)) ** 2)
    C = math.atanh(b / (2 * c * w))
    speed = w * math.tanh(c * w * t / MASS + C) - b / (2 * c)
    fallen = MASS / c * math.log(math.cosh(c * w * t / MASS + C) / math.cosh(C)) - b / (2 * c) * t
    assert run.velocity("w")[-1, 2] == pytest.approx(-speed, rel=1e-5)
    assert run.position("w")[-1, 2] == pytest.approx(-5.0 - fallen, rel=1e-5)
    balance = run.energy_balance
    assert balance.imbalance < 1e-6
    assert balance.by_effects == pytest.approx(MASS * g * fallen - 0.5 * MASS * speed**2, rel=1e-5)


def test_a_coasting_body_stops_along_its_own_axes():
    """Without weight, v_a = v_a0 exp(-b_a t/m) along each axis of a body whose origin is its centre of mass: nothing turns it."""
    b, v, t = (1.0, 3.0, 9.0), np.array([1.0, 2.0, -0.5]), 1.0
    coasting = scene(Dashpots(linear_in_body={"w": b}), box())
    coasting = Scene(coasting.points, coasting.cables, coasting.effects[1:], bodies=coasting.bodies)
    start = equilibrium_free(coasting, velocity=v)
    run = simulate(coasting, t, method="edmc", dt=0.002, start=start)
    R = matrix_of(TURN)
    expected = R @ (np.exp(-np.array(b) * t / MASS) * (R.T @ v))
    assert np.allclose(run.velocity("w")[-1], expected, rtol=0.0, atol=1e-5)


def equilibrium_free(of, velocity):
    """The body where it is written, with a velocity."""
    from anet_lumped import State

    return State.of(of, shapes={}, points={}).moved("w", velocity=velocity)


def slow(numbers, v, R, two):
    """The law of the module, written out."""
    b, c = numbers
    s = R.T @ v
    if two:
        across = math.hypot(s[0], s[1])
        F = [-(b[0] + c[0] * across) * s[0], -(b[0] + c[0] * across) * s[1], -(b[1] + c[1] * abs(s[2])) * s[2]]
    else:
        F = [-(b[a] + c[a] * abs(s[a])) * s[a] for a in range(3)]
    return R @ F


@pytest.mark.parametrize("numbers", [((1.0, 2.0, 3.0), (0.5, 0.7, 0.2)), ((2.0, 3.0), (0.5, 0.8))], ids=["three", "two"])
@pytest.mark.parametrize("in_body", [False, True], ids=["world", "body"])
def test_force_and_slope(numbers, in_body):
    """The force is the law, and its slope that by central differences, 1e-6 m/s apart: both to 1e-8 of 10 N."""
    b, c = numbers
    fields = (
        {"linear_in_body": {"w.a": b}, "quadratic_in_body": {"w.a": c}}
        if in_body
        else {"linear": {"w.a": b}, "quadratic": {"w.a": c}}
    )
    effect = Dashpots(**fields)
    model = build(scene(effect, box()))
    index, params = effect.table(model)
    q, v = np.zeros((model.n, 3)), np.zeros((model.n, 3))
    for point in model.scene.all_points:
        q[model.node_of[point.name]] = point.at
    i, kernels = model.node_of["w.a"], effect.kernels()
    v[i] = 1.2, -0.4, 2.3

    def force(v):
        f = np.zeros((model.n, 3))
        power = kernels["force"](0.0, q, v, index, params, f)
        return f[i], power

    f, power = force(v)
    R = matrix_of(TURN) if in_body else np.eye(3)
    assert np.allclose(f, slow(numbers, v[i], R, len(b) == 2), rtol=1e-12)
    assert power == pytest.approx(-f @ v[i], rel=1e-12) and power > 0.0
    D, none = np.zeros((model.n_free, 3, 3)), np.zeros((0, 2, 3, 3))
    kernels["tangent"](0.0, q, v, index, params, 0.0, 1.0, D, none, none)
    for x in range(3):
        h = np.zeros_like(v)
        h[i, x] = 1e-6
        assert np.allclose(-D[i][:, x], (force(v + h)[0] - force(v - h)[0]) / 2e-6, atol=1e-7)


def test_it_holds_nothing_at_rest():
    rope = Cable("top", "w", length=2.0, mass_per_length=0.1, EA=1e6, segments=4)
    points = [Fixed("top", (0.0, 0.0, 0.0)), Free("w", MASS)]
    with_it, without = (Scene(points, [rope], [Gravity(g), *more]) for more in ([Dashpots({"w": (5.0, 5.0, 5.0)})], []))
    assert np.array_equal(equilibrium(with_it).position("w"), equilibrium(without).position("w"))


def test_it_is_written_and_read_back():
    of = scene(Dashpots({"w.a": (1.0, 2.0, 3.0)}, quadratic_in_body={"w": (4.0, 5.0)}), box())
    assert scene_from_dict(scene_to_dict(of)) == of


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"linear": {"w": (1.0,)}}, r'Argument `linear` must be three or two numbers \[N s/m\], but effect Dashpots of "w" has'),
        ({"quadratic": {"w": 3.0}}, r"Argument `quadratic` must be three or two numbers"),
        ({"quadratic": {"w": (1.0, -2.0, 3.0)}}, r"Argument `quadratic` must be non-negative"),
    ],
)
def test_refusals(fields, message):
    with pytest.raises(SceneError, match=message):
        Dashpots(**fields)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (
            {"linear": {"top": (1.0, 1.0, 1.0)}},
            'A dashpot must be at a point or body that moves freely, but "top" of effect Dashpots',
        ),
        ({"linear_in_body": {"top": (1.0, 1.0, 1.0)}}, 'in the axes of a body must be on one that moves, but "top"'),
        ({"linear": {"wo": (1.0, 1.0, 1.0)}}, 'did you mean "w"'),
    ],
)
def test_points_that_do_not_do(fields, message):
    with pytest.raises(SceneError, match=message):
        simulate(scene(Dashpots(**fields), box()), 0.1, dt=0.01, start="straight")


def test_a_driven_body_has_none():
    driven = box(at=None, path=paths.line((0, 0, -5), (0, 0, 0), 1.0))
    with pytest.raises(SceneError, match="must be at a point or body that moves freely"):
        simulate(scene(Dashpots({"w": (1.0, 1.0, 1.0)}), driven), 0.1, dt=0.01, start="straight")
