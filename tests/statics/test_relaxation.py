"""Pseudo-steps of a column that is pressed: Newton's method converges in squares, and no step ends where the column is straight."""

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Scene
from anet_lumped.effects import Bending, Gravity
from anet_lumped.mechanics import newton_step, residual
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.mechanics.required_kernels import require
from anet_lumped.model.build import build
from anet_lumped.statics.relaxation import net_at_rest, relaxed
from anet_lumped.statics.stability import curvature
from anet_lumped.statics.starts import straight
from integrators.stage import LAW_BACKWARD, Stage

EI, PRESSED, SEGMENTS = 10.0, 0.05, 20  # [N m2]; shortened by so much of its length, which buckles it; its load is 10 N


def column(aside):
    """A column of 1 m between fixed ends, its nodes ``aside`` of the line between these [m]."""
    rod = Cable("a", "b", length=1.0, mass_per_length=1.0, EA=1e5, EI=EI, segments=SEGMENTS, compression="linear")
    model = build(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0, 0, 1.0 - PRESSED))], [rod], [Gravity(10.0), Bending()]))
    net, q = fresh_net(model, force=False, newton=False), straight(model)
    require(net, model, newton=True)
    q[: model.n_free] += aside * np.random.default_rng(2).normal(size=(model.n_free, 3))
    return model, net, q


def test_newton_steps_of_a_cable_that_pushes_converge_in_squares():
    """In a step that is short enough to have a minimum: without the pushes in the tangent each iteration leaves a third."""
    model, net, q = column(aside=1e-4)
    push = 1e5 * PRESSED
    tau = 0.9 * np.sqrt(10.0 / (model.n_free * 4.0 * push * SEGMENTS))  # m/tau^2 above 4 T/l, by which pushes soften the nodes
    whole = net_at_rest(model, net, 10.0)
    base, stage, left = q.copy(), Stage(LAW_BACKWARD, 0.0, 1.0 / tau**2, 1.0, tau, 0.0), []
    for _ in range(6):
        left.append(residual.residual(stage, base, base, q, whole.address)[0])
        newton_step.direction(stage, whole.address)
        newton_step.correct(whole.address, 1.0, q)
    assert left[4] < 1e-9 * push


def test_no_pseudo_step_ends_where_the_column_is_straight():
    """Next to there, its forces balance to a millionth of the load, and Newton's method leads to the straight column."""
    model, net, q = column(aside=1e-5)
    whole = net_at_rest(model, net, 10.0)
    residual_left = relaxed(model, whole, q, 10.0)
    sag = np.linalg.norm(q[:, :2], axis=1).max()
    assert residual_left < 1e-9
    assert curvature(model, net, q, whole.tension, 10.0).directions_down == 0
    # an arch that is 5 % shorter than its length: 2/pi sqrt(0.05) of it high, if flat
    assert sag == pytest.approx(2.0 / np.pi * np.sqrt(PRESSED), rel=0.05)
