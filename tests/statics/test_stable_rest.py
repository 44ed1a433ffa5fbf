"""Rests under loads that depend on the shape: stable, or left, or refused; against closed forms, eigenvalues and least energy."""

import math

import numpy as np
import pytest
from scipy.optimize import fsolve, minimize

from anet_lumped import Cable, Fixed, Free, NoRestError, Scene, equilibrium
from anet_lumped.effects import Bending, Gravity, Ground, Water, node_energy
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.statics import descent
from anet_lumped.statics.descent import _forces, descended
from anet_lumped.statics.failure_reasons import reason
from anet_lumped.statics.stability import curvature, tangent

G, RHO, BED = 9.81, 1025.0, -150.0


def lying(length, span, height, mass, diameter, EA, EI, segments, compression="linear"):
    """A cable in water from an anchor on the bed to a point above it."""
    cable = Cable(
        "a", "f", length=length, mass_per_length=mass, EA=EA, EI=EI, segments=segments, diameter=diameter, compression=compression
    )  # fmt: skip
    effects = [Gravity(G), Water(density=RHO, level=1000.0), Ground(height=BED), *([Bending()] if EI else [])]
    return Scene([Fixed("a", (-span, 0, BED)), Fixed("f", (0, 0, BED + height))], [cable], effects)


def bed_catenary(length, span, height, mass, diameter, EA):
    """Horizontal tension and tension at the top of an elastic catenary that lies on a bed without friction, H and T [N]."""
    w = (mass - RHO * math.pi * diameter**2 / 4) * G

    def gaps(logarithms):
        H, V = np.exp(logarithms)
        x = length - V / w + H / w * np.arcsinh(V / H) + H * length / EA
        z = H / w * (np.hypot(1.0, V / H) - 1.0) + V * V / (2.0 * EA * w)
        return (x - span) / length, (z - height) / length

    H, V = np.exp(fsolve(gaps, np.log((0.2 * w * length, 0.7 * w * length)), xtol=1e-12))
    assert V < w * length  # a part of it lies
    return H, math.hypot(H, V)


def turns(shape):
    """Angles between next segments [degrees]."""
    d = np.diff(shape, axis=0)
    unit = d / np.linalg.norm(d, axis=1)[:, None]
    return np.degrees(np.arccos(np.clip((unit[1:] * unit[:-1]).sum(axis=1), -1.0, 1.0)))


RISER = dict(length=400.0, span=300.0, height=136.0, mass=60.0, diameter=0.2, EA=7e8)


@pytest.mark.each_once
@pytest.mark.parametrize("EI", [0.0, 3e4])
@pytest.mark.parametrize("compression", ["none", "linear"])
@pytest.mark.parametrize("segments", [50, 80, 120])
def test_a_riser_that_touches_down_is_a_catenary_on_the_bed(segments, compression, EI):
    """Bending reaches sqrt(EI/H) = 2.4 m from the touchdown, 1 % of the span; it and segments of 3 to 8 m leave 2 % of H."""
    state = equilibrium(lying(**RISER, EI=EI, segments=segments, compression=compression))
    H, T = bed_catenary(**RISER)
    tension = state.tension("a-f")
    assert state.stable and turns(state.shape("a-f")).max() < 30.0
    assert tension[0] == pytest.approx(H, rel=0.02)
    assert tension[-1] + 0.5 * (tension[-1] - tension[-2]) == pytest.approx(T, rel=0.005)


@pytest.mark.parametrize("seed", range(12))
def test_random_cables_partly_on_the_bed(seed):
    """The vertex of the catenary turns over a length a = H/w. With segments of up to a/2, H is known to (L0/a)^2 or 5 %."""
    rng = np.random.default_rng(seed)
    length, EA, diameter = rng.uniform(50, 500), 10 ** rng.uniform(6, 9), 10 ** rng.uniform(-1.7, -0.7)
    height = length * rng.uniform(0.1, 0.6)
    shortest, longest = length - height, math.sqrt(length**2 - height**2)
    span = shortest + (longest - shortest) * rng.uniform(0.2, 0.6)
    mass = math.pi / 4 * diameter**2 * RHO * rng.uniform(1.5, 5.0)
    numbers = dict(length=length, span=span, height=height, mass=mass, diameter=diameter, EA=EA)
    segments, compression = int(rng.integers(30, 100)), ("none", "linear")[seed % 2]
    state = equilibrium(lying(**numbers, EI=0.0, segments=segments, compression=compression))
    H, _ = bed_catenary(**numbers)
    a = H / ((mass - RHO * math.pi * diameter**2 / 4) * G)
    L0 = length / segments
    assert state.stable and state.residual <= 1e-9 and state.tension("a-f").min() >= 0.0
    if L0 < 0.5 * a:
        assert state.tension("a-f")[1] == pytest.approx(H, rel=max(0.05, (L0 / a) ** 2))


def test_a_rope_with_bending_from_the_bed_to_a_buoy():
    """It touches the bed at its anchor only: what the anchor holds is the lift of the buoy less the wet weight, in closed form."""
    d, mu, g, V = 0.008, 0.08, 9.80665, 0.05
    rope = Cable("anchor", "buoy", length=100.0, mass_per_length=mu, EA=7.6e6, EI=30.0, segments=100, diameter=d)
    points = [Fixed("anchor", (0, 0, -300)), Free("buoy", mass=20.0, volume=V, at=(0, 0, -199.97))]
    state = equilibrium(Scene(points, [rope], [Gravity(g), Water(), Ground(height=-300.0), Bending()]))
    wet = (mu - RHO * math.pi * d * d / 4) * g
    lift = (RHO * V - 20.0) * g
    below_buoy = lift - wet * rope.L0 * 0.5  # half of its segment hangs on the buoy
    assert state.stable and state.tension("anchor-buoy")[-1] == pytest.approx(below_buoy, rel=1e-6)
    assert state.tension("anchor-buoy")[0] == pytest.approx(below_buoy - 99 * wet * rope.L0, rel=1e-6)


def column(EI, segments=40):
    """A rod that stands on a clamped foot under its own weight, 9.81 N/m over 1 m."""
    rod = Cable("foot", "top", length=1.0, mass_per_length=1.0, EA=1e6, EI=EI, segments=segments, compression="linear")
    points = [Fixed("foot", (0, 0, 0)), Free("top", at=(0, 0, 1))]
    return Scene(points, [rod], [Gravity(G), Bending(clamped={"foot": (0, 0, 1)})])


GREENHILL = 7.8373  # w L^3/EI at which a standing column buckles


def test_a_column_stands_as_long_as_greenhill_says():
    """The load at which 40 segments buckle is that of the rod to n^-2, far below the 2 % of this test."""
    state = equilibrium(column(1.02 * G / GREENHILL), start="straight")
    assert state.stable and state.position("top") == pytest.approx((0, 0, 1), abs=1e-4)
    below = equilibrium(column(0.95 * G / GREENHILL), start="straight")
    assert below.stable and 0.5 < below.position("top")[2] < 0.95  # it has bent over, by no little


def test_directions_down_are_the_negative_eigenvalues():
    """Sylvester's law against numpy's eigenvalues, in shapes with folds, contact, bending and segments that push."""
    scene, found = lying(20.0, 12.0, 3.0, 2.0, 0.05, 1e4, 50.0, 12), []
    model = build(scene)
    net = fresh_net(model, force=False, newton=False)
    rng = np.random.default_rng(3)
    for _ in range(20):
        q = rng.normal((-6.0, 0.0, BED + 0.5), 1.0, (model.n, 3))
        _, tension = _forces(model, net, q)
        K = tangent(model, net, q, tension)
        values = np.linalg.eigvalsh(K.toarray())
        judged = curvature(model, net, q, tension, 100.0)
        assert judged.directions_down == (values < 0.0).sum()
        found.append(judged.directions_down)
        if judged.direction is not None:
            assert judged.stiffness == pytest.approx(values[0], rel=1e-2)  # what the search for the lowest one asks for
            y = judged.direction.ravel() / np.linalg.norm(judged.direction)
            assert y @ (K @ y) == pytest.approx(values[0], rel=1e-2)
    assert len(set(found)) > 3  # folded by all degrees


def test_the_tangent_is_the_slope_of_the_forces():
    scene = lying(20.0, 12.0, 3.0, 2.0, 0.05, 1e4, 50.0, 12)
    model = build(scene)
    net = fresh_net(model, force=False, newton=False)
    rng = np.random.default_rng(4)
    q = rng.normal((-6.0, 0.0, BED + 0.5), 2.0, (model.n, 3))
    K = tangent(model, net, q, _forces(model, net, q)[1])
    y = rng.normal(size=(model.n_free, 3))
    errors = []
    for h in (1e-3, 0.5e-3, 0.25e-3):
        ahead, behind = q.copy(), q.copy()
        ahead[: model.n_free] += h * y
        behind[: model.n_free] -= h * y
        slope = -(_forces(model, net, ahead)[0] - _forces(model, net, behind)[0]) / (2.0 * h)
        errors.append(np.abs(slope.ravel() - K @ y.ravel()).max())
    assert errors[0] < 1e-2 * np.abs(K @ y.ravel()).max()
    assert np.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(2.0, abs=0.2)  # central differences


def test_descent_ends_where_no_direction_leads_down():
    scene = lying(20.0, 12.0, 3.0, 2.0, 0.05, 1e4, 50.0, 12)
    model = build(scene)
    net = fresh_net(model, force=False, newton=False)
    q = np.random.default_rng(5).normal((-6.0, 0.0, BED + 2.0), 2.0, (model.n, 3))
    for point in scene.points:
        q[model.node(point.name)] = point.at
    tension, residual = descended(model, net, q, 100.0)
    assert residual <= 1e-4
    assert curvature(model, net, q, tension, 100.0).directions_down == 0


def test_a_descent_leaves_nodes_that_nothing_holds_some_stiffness(monkeypatch):
    """A rope that cannot push falls to the ground for 200 steps: m fell to 1e-16 N/m, and to 1e-33 where a pivot was zero then."""
    rope = Cable("a", "b", length=44.0, mass_per_length=0.5, EA=1e3, segments=40, diameter=0.01)
    model = build(Scene([Fixed("a", (0, 0, 40)), Free("b", at=(1, 0, 40))], [rope], [Gravity(G), Ground()]))
    net, q = fresh_net(model, force=False, newton=False), np.full((model.n, 3), (0.0, 0.0, 40.0))
    q[model.nodes("a-b"), 0] = np.linspace(0.0, 1.0, 41)
    shifts, pivots_of = [], descent.pivots_of
    monkeypatch.setattr(descent, "pivots_of", lambda K, shift: (shifts.append(shift), pivots_of(K, shift))[1])
    _, residual = descended(model, net, q, 22.0 * G)
    assert residual <= 1e-4 and min(shifts) == pytest.approx(1e-9 * 1e-3 * 22.0 * G / (model.n_free * 1.1), rel=1e-9)


@node_energy
def obstacle(t, q, k, R, cz, roundness):
    """A ball of radius R with its centre at cz for a roundness of 1, a roll along y for 0."""
    x, y, z = q[0], q[1], q[2] - cz
    p = R - (x * x + roundness * y * y + z * z) ** 0.5
    return 0.5 * k * p * p if p > 0 else 0.0 * p


def rope_over(roundness):
    rope = Cable("a", "b", length=5.0, mass_per_length=4.0, EA=1e5, segments=20)
    thing = obstacle(k=1e5, R=0.5, cz=-0.9, roundness=roundness)
    return Scene([Fixed("a", (-2, 0, 0)), Fixed("b", (2, 0, 0))], [rope], [Gravity(G), thing])


def least_energy(q, aside):
    """Places of least energy next to a shape of the rope that is moved aside, by scipy."""
    k, m, L0 = 1e5 / 0.25, 4.0 * 0.25 * G, 0.25

    def energy(x):
        q = np.vstack([[-2.0, 0, 0], x.reshape(-1, 3), [2.0, 0, 0]])
        d = np.diff(q, axis=0)
        l = np.linalg.norm(d, axis=1)
        taut, c = np.maximum(l - L0, 0.0), q[1:-1] - (0, 0, -0.9)
        r = np.linalg.norm(c, axis=1)
        deep, pull, slope = np.maximum(0.5 - r, 0.0), (k * taut / l)[:, None] * d, np.zeros_like(q)
        slope[1:] += pull
        slope[:-1] -= pull
        slope[1:-1] += (0, 0, m) - (1e5 * deep / r)[:, None] * c
        return 0.5 * k * taut @ taut + m * q[1:-1, 2].sum() + 0.5e5 * deep @ deep, slope[1:-1].ravel()

    begin = np.add(q[1:-1], (0.0, aside, 0.0))
    options = dict(maxiter=20000, maxfun=40000, ftol=1e-16, gtol=1e-8)
    return minimize(energy, begin.ravel(), jac=True, method="L-BFGS-B", options=options).x.reshape(-1, 3)


@pytest.mark.slow
def test_a_rope_laid_across_a_ball_says_that_it_would_slip_off():
    """Least energy in the plane of the rope agrees; from 1 mm beside that plane it ends at the stable rest."""
    laid = equilibrium(rope_over(1.0), start="straight")
    assert laid.stable is False and laid.residual <= 1e-9
    assert laid.shape("a-b")[10, 2] == pytest.approx(least_energy(laid.shape("a-b"), 0.0)[9, 2], abs=1e-4)  # L-BFGS: 1e-5
    assert laid.shape("a-b")[10, 2] == pytest.approx(-0.4003, abs=1e-4)
    hung = equilibrium(rope_over(1.0))
    assert hung.stable is True
    assert hung.shape("a-b")[10, 2] == pytest.approx(least_energy(laid.shape("a-b"), 1e-3)[9, 2], abs=1e-4)


def test_a_guess_decides_on_which_side_of_an_obstacle_a_rope_rests():
    scene = rope_over(0.0)
    above = equilibrium(scene)  # let down from above
    assert above.stable and above.shape("a-b")[10, 2] == pytest.approx(-0.4, abs=2e-3)  # 100 N on 1e5 N/m: 1 mm deep
    hanging = equilibrium(Scene(scene.points, scene.cables, [Gravity(G)]))
    for guess in (hanging, {"a-b": hanging.shape("a-b")}):
        below = equilibrium(scene, start=guess)
        assert below.stable and below.shape("a-b")[10, 2] < -1.3


def test_a_fold_that_is_given_is_left():
    """Two segments folded back on the bed balance with tensions of the other sign, and are no rest."""
    scene = lying(**RISER, EI=0.0, segments=50)
    right = equilibrium(scene)
    shape = right.shape("a-f").copy()
    d = np.diff(shape, axis=0)
    d[2] *= -1.0
    folded = shape[0] + np.vstack([np.zeros(3), np.cumsum(d, axis=0)])
    folded[-1] = shape[-1]
    state = equilibrium(scene, start={"a-f": folded})
    assert state.stable and turns(state.shape("a-f")).max() < 30.0
    assert state.tension("a-f")[0] == pytest.approx(right.tension("a-f")[0], rel=1e-6)


@pytest.mark.parametrize("segments", [20, 21])
def test_a_hairpin_that_is_stiff_in_bending_opens_to_a_loop(segments):
    rod = Cable("a", "b", length=1.0, mass_per_length=1.0, EA=1e6, EI=1.0, segments=segments, compression="linear")
    state = equilibrium(Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0.05, 0, 0))], [rod], [Gravity(G), Bending()]))
    assert state.stable and turns(state.shape("a-b")).max() < 40.0  # a fold would be 180
    assert np.ptp(state.shape("a-b")[:, 0]) > 0.2


# Refusals ------------------------------------------------------------------------------------------------------------


def test_bending_without_pushing_is_refused_with_its_reason():
    rod = Cable("a", "b", length=1.0, mass_per_length=1.0, EA=1e6, EI=1.0, segments=20)
    scene = Scene([Fixed("a", (0, 0, 0)), Fixed("b", (0.05, 0, 0))], [rod], [Gravity(G), Bending()])
    with pytest.raises(NoRestError, match=r'2 directions lead down.* must push, but cable "a-b" with compression="none"') as caught:
        equilibrium(scene)
    assert caught.value.state.stable is False and caught.value.state.residual <= 1e-9


def test_reasons_name_what_is_wrong():
    under = lying(20.0, 12.0, 3.0, 2.0, 0.05, 1e4, 0.0, 12)
    under = Scene([Fixed("a", (-12, 0, BED - 2.5)), under.points[1]], under.cables, under.effects)
    model = build(under)
    straight = np.linspace((-12.0, 0, 0), (0, 0, 0), model.n)
    assert 'support "a" must not be under the ground, but it is at a height of -152.5 m and the ground at -150 m' in reason(
        model, straight
    )
    model = build(lying(20.0, 12.0, 3.0, 2.0, 0.05, 1e4, 0.0, 12))
    nodes, q = model.nodes("a-f"), np.zeros((model.n, 3))
    q[nodes] = np.linspace((-12.0, 0, 0), (0, 0, 0), model.n)
    q[nodes[5]] = q[nodes[3]]
    assert 'finer than its segments, but cable "a-f" turns by 180 degrees at node 4' in reason(model, q)
    q[nodes] = np.linspace((-12.0, 0, 0), (0, 0, 0), model.n)
    assert reason(model, q) == 'try `simulate` from start="straight", or another `start` of `equilibrium`'


@pytest.mark.parametrize("EA", [1e6, math.inf])
def test_a_rest_is_the_same_each_time(EA):
    """Of cables that push and may turn about the vertical all turns are rests: which one is found is no matter of chance."""
    like = dict(mass_per_length=0.03, EA=EA, compression="linear", diameter=0.01)
    points = [Free("p0", 1.0, at=(-1.0, 1.0, 0.0)), Free("p1", at=(0.0, 0.5, 1.0)), Fixed("p2", (-1.0, 0.0, 1.0))]
    cables = [
        Cable("p0", "p1", length=2.0, segments=2, **like), Cable("p0", "p2", length=1.485, segments=6, **like),
        Cable("p1", "p2", length=2.0, segments=6, **like),
    ]  # fmt: skip
    scene = Scene(points, cables, [Gravity(G), Water(density=RHO, level=-2.0)])
    first = equilibrium(scene)
    assert all((equilibrium(scene).q == first.q).all() for _ in range(12))
