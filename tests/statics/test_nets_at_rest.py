"""Nets at rest: hung by few corners, with slack parts, in water and on a ground; found at once, and balanced as a whole."""

import numpy as np
import pytest

from anet_lumped import EquilibriumError, NoRestError, Scene, equilibrium, nets, simulate, wind
from anet_lumped.effects import Gravity, Ground, Water
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.statics import search
from anet_lumped.statics.relaxation import net_at_rest
from anet_lumped.statics.stability import tangent

FIELD = [(0, 0, -1.0), (0.6, 0, -1.0), (0.6, 0.6, -1.0), (0, 0.6, -1.0)]
TWINE = {"mass_per_length": 0.01, "EA": 1e4, "zeta": 0.05, "diameter": 0.003}
GRAVITY = Gravity(9.81)


def net(held, slack=0.05, **more):
    return nets.grid((6, 6), FIELD, cable=TWINE, held=held, knot_mass=0.002, slack=slack, **more)


def weight(parts):
    return 9.81 * (
        sum(cable.mass_per_length * cable.length for cable in parts.cables)
        + sum(getattr(point, "mass", 0.0) for point in parts.points)
    )


def pull(rest, held):
    return sum(rest.reaction(name)[2] for name in held)


@pytest.mark.parametrize("pattern", ["square", "diagonal"])
@pytest.mark.parametrize("held", [("p0_0", "p6_0", "p6_6", "p0_6"), ("p0_0", "p6_0"), ("p0_0", "p6_6"), ("p0_0",)])
@pytest.mark.parametrize("slack", [0.0, 0.5])
def test_a_net_hangs_by_its_corners(held, slack, pattern):
    parts = net(held, slack) if pattern == "square" else nets.grid(
        (3, 3), FIELD, cable=TWINE, held=held, knot_mass=0.002, slack=slack, pattern=pattern, border=TWINE
    )  # fmt: skip
    rest = equilibrium(Scene(parts.points, parts.cables, [GRAVITY]))
    assert pull(rest, held) == pytest.approx(weight(parts), rel=1e-9)
    assert (rest.segment_tension >= 0.0).all()


def test_the_corners_carry_what_the_ground_does_not():
    """Net pressed on by its own weight: 0.2 longer than its field, on a ground a little below it, so that its middle lies slack."""
    parts = net("corners", slack=0.2)
    rest = equilibrium(Scene(parts.points, parts.cables, [GRAVITY, Ground(height=-1.1, stiffness=1e6)]))
    on_ground = rest.reaction("ground")[2]
    assert 0.3 * weight(parts) < on_ground < weight(parts)
    corners = [f"p{i}_{j}" for i in (0, 6) for j in (0, 6)]
    assert pull(rest, corners) + on_ground == pytest.approx(weight(parts), rel=1e-6)
    assert (rest.segment_tension <= 0.0).any() and rest.stable


@pytest.mark.each_once
@pytest.mark.parametrize("in_water", [False, True])
@pytest.mark.parametrize("held", [("p0_0", "p19_0", "p19_19", "p0_19"), ("p0_0", "p19_0"), ("p0_0",)])
def test_most_of_a_net_lies_slack_on_the_ground(held, in_water):
    """Corners and ground carry the weight less the buoyancy, of 1025 kg/m3 times g times the volume of all twine."""
    field = [(0, 0, -1.0), (3, 0, -1.0), (3, 3, -1.0), (0, 3, -1.0)]
    parts = nets.grid((19, 19), field, cable=TWINE, held=held, knot_mass=1e-3, slack=0.02)
    effects = [GRAVITY, Ground(height=-1.5, stiffness=1e6), *([Water()] if in_water else [])]
    rest = equilibrium(Scene(parts.points, parts.cables, effects))
    volume = sum(np.pi / 4 * cable.diameter**2 * cable.length for cable in parts.cables)
    carried = weight(parts) - (1025 * 9.81 * volume if in_water else 0.0)
    # forces balance to 1e-10 of the load at each of 400 nodes
    assert pull(rest, held) + rest.reaction("ground")[2] == pytest.approx(carried, abs=1e-6)
    assert rest.stable and (len(held) == 4 or (rest.segment_tension <= 0.0).mean() > 0.8)


@pytest.mark.slow
def test_a_net_in_a_stream_leaves_a_rest_that_has_no_energy_to_fall():
    """Held by two corners along the stream, it sinks to the ground in one plane, where a push across the stream leads away.

    The rest that it leaves to is stable: no eigenvalue of the tangent of its forces has a negative real part.
    """
    field = [(0, 0, -1.0), (3, 0, -1.0), (3, 3, -1.0), (0, 3, -1.0)]
    parts = nets.grid((19, 19), field, cable=TWINE, held=("p0_0", "p19_0"), knot_mass=1e-3, slack=0.02)
    stream = Water(current=wind.Uniform((0.3, 0.0, 0.0)))
    scene = Scene(parts.points, parts.cables, [GRAVITY, Ground(height=-1.5, stiffness=1e6), stream])
    rest = equilibrium(scene)
    assert rest.stable and rest.residual < 1e-9
    model = rest.model
    net = net_at_rest(model, fresh_net(model, force=False, newton=False), weight(parts))
    K = tangent(model, net, rest.q, rest.segment_tension).toarray()
    assert np.linalg.eigvals(K).real.min() > -1e-9 * np.abs(K).max()


def test_a_stream_carries_a_net_that_is_held_at_one_side():
    upright = [(0, 0, -1), (0.6, 0, -1), (0.6, 0, -1.6), (0, 0, -1.6)]
    parts = nets.grid((6, 6), upright, cable=TWINE, held="first side", knot_mass=0.002)
    rest = equilibrium(Scene(parts.points, parts.cables, [GRAVITY, Water(current=wind.Uniform((0.0, 0.5, 0.0)))]))
    side = [rest.reaction(f"p{i}_0") for i in range(7)]
    assert sum(force[1] for force in side) < 0.0 < rest.position("p3_6")[1]
    assert rest.residual < 1e-9 and rest.stable


@pytest.mark.parametrize("vast", [False, True])
def test_no_long_search_for_a_vast_net(monkeypatch, vast):
    """A search that fails goes on to slow and exact ones, but for a net so large that each of them would take minutes."""
    tried = []

    def fails(model, net, attempt, load, leaves):
        tried.append(attempt.long)
        return search.Found(attempt.shape, 1.0, None)

    monkeypatch.setattr(search, "VAST", 10 if vast else search.VAST)
    monkeypatch.setattr(search, "_try", fails)
    parts = net(("p0_0",))
    with pytest.raises(EquilibriumError, match="No equilibrium was found with Gravity, Ground: imbalance"):
        equilibrium(Scene(parts.points, parts.cables, [GRAVITY, Ground(height=-1.1, stiffness=1e6)]))
    assert len(tried) > 0 and any(tried) != vast


def test_a_net_that_nothing_holds_has_no_rest():
    parts = net(())
    with pytest.raises(NoRestError, match=r'nothing holds free point "p0_0" and the 48 others it is tied to'):
        equilibrium(Scene(parts.points, parts.cables, [GRAVITY]))


def test_a_net_without_weight_has_no_shape():
    parts = net("corners")
    with pytest.raises(NoRestError, match="Nothing loads the cables"):
        equilibrium(Scene(parts.points, parts.cables, []))


def test_a_net_let_go_from_flat_eliminates_no_more_than_twice_in_a_newton_step():
    """Slack at first, then whipped taut: 49 junctions, of which each elimination costs more than the residual that it saves."""
    parts = net("corners")
    run = simulate(Scene(parts.points, parts.cables, [GRAVITY]), t_end=0.3, start="straight", method="edmc", dt=5e-3)
    work = run.work
    assert run.ok and work.newton_iterations < work.factorisations <= 2 * work.newton_iterations
    assert work.newton_iterations < 5 * work.steps  # 3.5 of a net of 12 x 12
