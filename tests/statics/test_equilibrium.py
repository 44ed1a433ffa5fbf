"""Statics: balance and law recomputed from what is shown, closed forms, and what has no rest."""

import math
import warnings

import numpy as np
import pytest
from hanging import CORNERS, ENDS, EPS, MU, STIFFNESSES, G, assorted, cable, check, held_net, hung, mesh, three_supports
from scipy.optimize import brentq

from anet_lumped import Cable, Driven, EquilibriumError, Fixed, Free, NoRestError, Scene, equilibrium
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.prescribed import paths


@pytest.mark.each_once
@pytest.mark.parametrize("segments", [5, 6, 20, 2000])
@pytest.mark.parametrize("EA", STIFFNESSES)
@pytest.mark.parametrize("end", ENDS)
def test_one_cable(end, EA, segments):
    state = check(hung(ENDS[end], EA=EA, segments=segments))
    assert state.shape("a-b")[0] == pytest.approx([0, 0, 0], abs=0) and state.shape("a-b")[-1] == pytest.approx(ENDS[end])


@pytest.mark.parametrize("ratio", [0.0, 1.0, 100.0, 1e4])
@pytest.mark.parametrize("EA", STIFFNESSES)
def test_payload(EA, ratio):
    check(held_net(0.1 * ratio, EA=EA))


@pytest.mark.parametrize("direction", [(0, 0, 1), (1, 0, 0), (-0.3, 2.0, 0.7)])
@pytest.mark.parametrize("g", [1e-3, 9.81, 1e3])
def test_gravity_in_any_direction(direction, g):
    state = check(hung((0.3, 0.4, 0.2), gravity=direction, g=g))
    down = np.array(direction) / np.linalg.norm(direction)
    assert (state.shape("a-b") @ down).max() > max(0.0, np.array((0.3, 0.4, 0.2)) @ down) + 0.2


@pytest.mark.each_once
@pytest.mark.parametrize("EA", STIFFNESSES)
@pytest.mark.parametrize("name", assorted(1.0))
def test_nets(name, EA):
    check(assorted(EA)[name])


@pytest.mark.parametrize("compression", ["none", "damped", "linear"])
def test_taut_cables_rest_alike_under_every_compression_law(compression):
    state = check(held_net(compression=compression))
    assert state.position("p0") == pytest.approx(equilibrium(held_net()).position("p0"), abs=1e-14)


def test_dampers_do_not_act_at_rest():
    scene = held_net()
    damped = Scene(scene.points, scene.cables, [*scene.effects, ViscousDamping(3.0)])
    assert np.array_equal(equilibrium(damped).q, equilibrium(scene).q)


def test_driven_points_rest_where_they_start():
    points = [Driven(f"s{i}", paths.line(at, (0.2, 0.0, 0.0), ramp=1.0)) for i, at in enumerate(CORNERS)]
    scene = held_net()
    state = equilibrium(Scene([*points, Free("p0", 0.036)], scene.cables, scene.effects))
    assert np.array_equal(state.position("p0"), equilibrium(scene).position("p0"))


@pytest.mark.each_once
@pytest.mark.parametrize("segments", [1, 5, 20, 2000])
@pytest.mark.parametrize("EA", [1.0, 50.0, 1e6])
@pytest.mark.parametrize("payload", [0.0, 0.2, 1000.0])
def test_hanging_chain_stretches_by_the_exact_sum(payload, EA, segments):
    """Segment j from the top carries the payload, the nodes below and the half segment at the end."""
    state = equilibrium(three_supports([Free("p", payload)], [cable("a", "p", EA=EA, segments=segments)]))
    below = MU / segments * (segments - 0.5 - np.arange(segments))
    tension = (payload + below) * G
    assert state.tension("a-p") == pytest.approx(tension, rel=1e-12)
    stretched = 1.0 + (tension / EA).mean()
    assert state.position("p") == pytest.approx([0, 0, -stretched], abs=segments * EPS * stretched)
    assert state.length("a-p") == pytest.approx(stretched, rel=segments * EPS)


@pytest.mark.parametrize("segments", [6, 20, 2000])
@pytest.mark.parametrize("EA", [1.0, 1e4])
def test_hairpin_is_two_hanging_strands(EA, segments):
    state = equilibrium(hung((0, 0, 0), EA=EA, segments=segments))
    half = segments // 2
    tension = MU / segments * (half - 0.5 - np.arange(half)) * G
    assert state.tension("a-b") == pytest.approx(np.concatenate([tension, tension[::-1]]), rel=1e-12)
    depth = 0.5 + (tension / EA).sum() / segments
    assert state.shape("a-b")[half] == pytest.approx([0, 0, -depth], abs=segments * EPS)


@pytest.mark.parametrize("EA", STIFFNESSES)
@pytest.mark.parametrize("load", [1e-3, 1.0, 1e3])
def test_two_bars_with_a_load(load, EA):
    """2 T h/l = W with T = EA (l/L0 - 1) and l^2 = a^2 + h^2: one equation for the depth h."""
    a, L0 = 0.4, 0.5
    scene = Scene(
        [Fixed("a", (-a, 0, 0)), Fixed("b", (a, 0, 0)), Free("p", load)],
        [cable("a", "p", L0, EA, 1), cable("p", "b", L0, EA, 1)],
        [Gravity()],
    )
    weight = (load + MU * L0) * G

    def sink(tension):
        """What is left of the load's balance, by the tension, which decides the depth and not the other way about."""
        l = L0 * (1 + tension / EA)
        return 2 * tension * math.sqrt(l * l - a * a) - weight * l

    tension = brentq(sink, 0.0, weight + EA, xtol=1e-300, rtol=4 * EPS)
    depth = math.sqrt((L0 * (1 + tension / EA)) ** 2 - a * a)
    state = equilibrium(scene)
    assert state.tension("a-p") == pytest.approx(tension, rel=1e-12)
    assert state.position("p") == pytest.approx([0, 0, -depth], rel=1e-12, abs=1e-14)


def test_taut_without_gravity_is_straight():
    state = equilibrium(hung((1.2, 0.5, 0), g=0.0, segments=7))
    assert state.tension("a-b") == pytest.approx(1e4 * (1.3 - 1.0), rel=1e-13)
    assert state.shape("a-b") == pytest.approx(np.linspace(0, 1, 8)[:, None] * (1.2, 0.5, 0), abs=1e-14)


def test_symmetric_net_hangs_symmetrically():
    state = equilibrium(held_net())
    assert state.position("p0")[:2] == pytest.approx([0, 0], abs=1e-14)
    tensions = np.array([state.tension(f"s{i}-p0") for i in range(4)])
    assert tensions == pytest.approx(np.broadcast_to(tensions[0], tensions.shape), rel=1e-12)


@pytest.mark.parametrize("EA", [1.0, 1e4])
def test_symmetric_mesh_hangs_symmetrically(EA):
    state = equilibrium(mesh("corners", EA=EA, segments=3))
    z = np.array([[state.position(f"{i} {j}")[2] for j in range(10)] for i in range(10)])
    for mirrored in (z.T, z[::-1], z[:, ::-1]):
        assert z == pytest.approx(mirrored, abs=1e-13 * abs(z.min()))


def test_nothing_holds_it():
    scene = Scene(
        [Fixed("a", (0, 0, 0)), Free("p"), Free("x"), Free("y"), Free("z")],
        [cable("a", "p"), cable("x", "y"), cable("y", "z")],
        [Gravity()],
    )
    with pytest.raises(
        NoRestError,
        match=r'nothing holds free point "x" and the 2 others it is tied to; `simulate` moves it from start="straight"',
    ):
        equilibrium(scene)


def test_slack_without_a_load_is_a_mechanism():
    with pytest.raises(NoRestError, match=r'Nothing loads the cables: the scene has no gravity, so that the slack cable "a-b"'):
        equilibrium(hung((0.8, 0, 0), g=0.0))


def test_two_way_springs_that_would_push():
    scene = hung((0, 0, 0), segments=5, compression="linear")
    with pytest.raises(NoRestError, match=r'cable "a-b" with compression="linear" has a slack segment that would push'):
        equilibrium(scene)


def test_a_tolerance_below_rounding_is_not_reached():
    with pytest.raises(
        EquilibriumError,
        match=r"No equilibrium was found in \d+ iterations: imbalance .* of the load, tolerance .*, tolerance 1e-29",
    ) as caught:
        equilibrium(hung((0.8, 0.1, 0)), tolerance=1e-30)
    assert caught.type is EquilibriumError  # a search that failed speaks of no wrong input


def test_a_stiffness_that_cannot_be_meant_is_said():
    """A weight of 1 kg stretches 1 m of a cable of EA = 1 N by 9.81 m, and one of 10 N by 0.981 m."""

    def stretched(EA):
        cord = Cable("top", "end", length=1.0, mass_per_length=1e-6, EA=EA, segments=2)
        return Scene([Fixed("top", (0, 0, 0)), Free("end", mass=1.0)], [cord], [Gravity(9.81)])

    words = r'cable "top-end" stretches by 9.81 of its length: its EA is 1 N, and its tension 9.81 N; check EA'
    with pytest.warns(UserWarning, match=words) as told:
        equilibrium(stretched(1.0))
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        equilibrium(stretched(10.0))
