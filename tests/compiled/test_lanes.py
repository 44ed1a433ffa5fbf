"""Four cables at once against one at a time, and the arithmetic of lanes against that of NumPy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numba import njit

from anet_lumped import Cable, Driven, Fixed, Free, Scene, equilibrium
from anet_lumped.compiled import lanes
from anet_lumped.compiled.lanes import select
from anet_lumped.effects import Gravity
from anet_lumped.mechanics import force, newton_step, residual, settle
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.prescribed import paths
from integrators.stage import LAW_AT_END, LAW_BACKWARD, LAW_BETWEEN, Stage

EPS = np.finfo(float).eps


@njit
def _formula(a, b):
    c = select((a > b) & (b < 1.0) | (a == b), a * b + 1.0, -math.sqrt(abs(a))) / 2.0
    c += 1.0
    c *= b
    return max(c, 0.25) + min(a, 2 - b) - select(a != b, a, 0.0)


@njit
def _by_lanes(x, y, out):
    a, b = lanes.load_four(x, (0, 4, 8, 12)), lanes.load_four(y, (0, 4, 8, 12))
    lanes.store_four(out, (0, 4, 8, 12), (_formula(a[0], b[0]), _formula(a[1], b[1]), _formula(a[2], b[2]), _formula(a[3], b[3])))
    d = lanes.load(out, (3, 7, 11, 15))
    lanes.store(x, lanes.shifted((0, 1, 2, 3), 2, 2, 1), d)
    return lanes.max_of_lanes(d), lanes.sum_of_lanes(d), lanes.lane(d, 2)


@njit
def _one_by_one(x, y, out):
    for i in range(16):
        out[i] = _formula(x[i], y[i])


def test_lanes_compute_what_numbers_do():
    rng = np.random.default_rng(1)
    x, y = rng.normal(size=(2, 16)).round(1)
    by_lanes, one_by_one = np.zeros((2, 16))
    most, total, third = _by_lanes(x.copy(), y, by_lanes)
    _one_by_one(x, y, one_by_one)
    np.testing.assert_array_equal(by_lanes, one_by_one)
    last = one_by_one[3::4]
    assert (most, third) == (last.max(), last[2])
    assert total == pytest.approx(last.sum(), rel=4 * EPS)
    _by_lanes(x, y, by_lanes)
    np.testing.assert_array_equal(x[5:13:2], last)


@njit
def _all_are_below(x, bound):
    return lanes.all_of(lanes.load(x, (0, 1, 2, 3)) < bound), lanes.all_of(x[0] < bound)


def test_all_answers_of_a_choice():
    assert _all_are_below(np.array([1.0, 2.0, 3.0, 4.0]), 4.5) == (True, True)
    for k in range(4):
        x = np.ones(4)
        x[k] = 9.0
        assert _all_are_below(x, 4.5) == (False, k > 0)


def _net(count, segments=(6,), **kwargs):
    """Cables of several lengths and stiffnesses from a ring of supports to a payload and a free end."""
    angle = 2 * np.pi * np.arange(count) / count
    points = [Fixed(f"s{i}", (math.cos(a), math.sin(a), 0.0)) for i, a in enumerate(angle[:-1])]
    points.append(Driven(f"s{count - 1}", paths.line((math.cos(angle[-1]), math.sin(angle[-1]), 0.0), (0.3, 0.1, 0.0), ramp=0.0)))
    cables = [
        Cable(f"s{i}", "p0" if i % 3 else "p1", length=1.2 + 0.1 * i, mass_per_length=0.1, segments=segments[i % len(segments)],
              **({"EA": 500.0 * (i + 1), "zeta": 0.1} | kwargs))
        for i in range(count)
    ]  # fmt: skip
    return Scene([*points, Free("p0", mass=0.05), Free("p1", at=(0.2, 0.1, -1.0))], cables, [Gravity()])


def _both(scene):
    """A net that takes its cables by fours, and the same that takes one at a time."""
    model = build(scene)
    single = replace(
        model, cable_groups=model.cable_groups[:0], single_cables=np.arange(len(model.cable)), single_kinds=np.zeros(2, int)
    )
    assert len(model.cable_groups) > 0
    return model, fresh_net(model), fresh_net(single)


LAWS = {"state": LAW_AT_END, "backward": LAW_BACKWARD, "between": LAW_BETWEEN}
NETS = {
    "two": _net(2),
    "three": _net(3),
    "seven": _net(7),
    "of two lengths": _net(6, (5, 9)),
    "damped both ways": _net(4, compression="damped"),
    "of springs": _net(4, compression="linear"),
    "inextensible": _net(5, EA=math.inf, zeta=0.0),
    "one segment": _net(5, (1,)),
}


def test_cables_alike_are_taken_by_fours():
    model = build(_net(7))
    np.testing.assert_array_equal(model.cable_groups, [[0, 1, 2, 3, 4], [4, 5, 6, 6, 3]])
    assert len(model.single_cables) == 0
    assert list(build(NETS["of two lengths"]).single_cables) == []
    assert len(build(NETS["one segment"]).cable_groups) == 0


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("net", [name for name in NETS if name != "one segment"])
def test_a_stage_is_the_same_by_fours_and_one_by_one(net, law):
    # sums over cables are taken in another order, so rounding may differ: by the condition of the system, 1e5 here
    scene = NETS[net]
    model, *nets = _both(scene)
    rng, h, found = np.random.default_rng(3), 0.01, []
    rest = equilibrium(scene)
    q, v = rest.q + rng.normal(scale=0.02, size=(model.n, 3)), rng.normal(scale=0.3, size=(model.n, 3))
    base = rest.q + rng.normal(scale=0.02, size=(model.n, 3))
    target, stage = base + h * v, Stage(LAWS[law], 0.0, 2 / h**2, 0.5, h, 0.5)
    for one in nets:
        one.tension[:] = rest.segment_tension
        parts = [residual.residual(stage, base, target, q, one.address)]
        solves, left = newton_step.direction(stage, one.address)
        f, power, at_end, energy = np.zeros((model.n, 3)), np.zeros(2), v.copy(), np.zeros(4)
        force.force(0.0, q, v, one.address, f, power)
        parts += [one.newton_step.copy(), one.tension.copy(), f, power, [left if left < 1e300 else 0.0], [solves]]
        if law == "between":
            settle.settle(stage, base, q, at_end, one.address, energy)
            parts += [at_end, energy, one.tension.copy(), one.linearised.copy()]
        found.append(parts)
    for by_fours, one_by_one in zip(*found, strict=True):
        scale = np.abs(one_by_one).max()
        np.testing.assert_allclose(by_fours, one_by_one, rtol=0, atol=1e5 * EPS * scale)
