"""Vortices that cables shed: the lift and its phase against the same equations solved otherwise, and against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from slow import slow

from anet_lumped import (
    Cable,
    CableCut,
    Fixed,
    Free,
    InputError,
    Scene,
    SceneError,
    Session,
    State,
    equilibrium,
    load_run,
    simulate,
    waves,
    wind,
)
from anet_lumped.advice.recommend import recommend
from anet_lumped.effects import Gravity, ViscousDamping, Water
from anet_lumped.effects.laws.shed_lift import frequency
from anet_lumped.effects.vortex_shedding import INNER, VortexShedding
from anet_lumped.model.build import build
from anet_lumped.motion.choice import time_scale
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict
from integrators.schemes.record import EnergyPromise
from studies.sweeping import over_time

RHO, D, U = 1000.0, 0.02, 1.0
ENDS = ((0.0, 0.0, -10.0), (0.0, 0.0, -8.0))


def held(rate=30.0, ends=ENDS, flow=(U, 0.0, 0.0), segments=2, EA=1e6, strain=1e-3, mu=0.5, cuts=(), **fields):
    """A taut cable in a current, damped by rate m v; of two segments one node moves."""
    length = math.dist(*ends) / (1.0 + strain)
    numbers = {"diameter": D, "Cdn": 0.0, "Cdt": 0.0, "zeta": 0.05, "Cl": 0.8} | fields
    cable = Cable("a", "b", length=length, mass_per_length=mu, EA=EA, segments=segments, **numbers)
    points = [Fixed("a", ends[0]), Fixed("b", ends[1])]
    return Scene(points, [cable], [Water(RHO, current=wind.Uniform(flow), g=0.0), ViscousDamping(rate)], cuts)


def straight(scene, shedding=(math.pi, 0.18, 1e-4, 1.0)):
    """On the line between the supports, at rest, with inner states of one's own, the same of all nodes inside."""
    (cable,) = scene.cables
    state, (a, b) = equilibrium(scene), (scene.point(name).at for name in (cable.start, cable.end))
    q, inner, nodes = state.q.copy(), np.zeros((len(state.q), 4)), state.model.nodes("a-b")
    q[nodes] = np.linspace(a, b, len(nodes))
    inner[nodes[1:-1]] = shedding
    return replace(state, q=q, shedding=inner)


def solved(scene, start, t):
    """Place and velocity of the node inside, its phase and mean squares at times t, by DOP853 of the equations as they stand."""
    cable, ends, rate = scene.cables[0], np.array([scene.point(name).at for name in "ab"]), scene.effects[1].rate
    L0, flow, mass = cable.L0, np.array(scene.effects[0].current.velocity), cable.mass_per_length * cable.L0
    along = (ends[1] - ends[0]) / math.dist(*ends)
    of_water, lift, drag = RHO * math.pi / 4.0 * D**2 * L0 * cable.Can, *(0.5 * RHO * D * C * L0 for C in (cable.Cl, cable.Cdn))

    def slopes(_, y):
        q, v, phase, squares = y[:3], y[3:6], y[6], y[7:]
        f, inertia = -rate * mass * v, mass * np.eye(3)
        for end in ends:
            l = np.linalg.norm(q - end)
            n = (q - end) / l
            f -= max(cable.EA * (l / L0 - 1.0) + cable.dashpot * (v @ n), 0.0) * n
            inertia += 0.5 * of_water * (np.eye(3) - np.outer(n, n))
            across = flow - v - ((flow - v) @ n) * n
            f += 0.5 * drag * np.linalg.norm(across) * across
        w = np.cross(along, flow - v)
        speed = np.linalg.norm(w)
        f += lift * speed * math.cos(phase) * w
        a = np.linalg.solve(inertia, f)
        rates = np.array([v @ w, a @ w]) / speed
        sine, cosine = -rates[1] / math.sqrt(squares[1]), rates[0] / math.sqrt(squares[0])
        s = cable.St + cable.St_range * math.sin(math.atan2(sine, cosine) - phase)
        forgets = 1.0 / cable.shedding_window if cable.shedding_window else cable.St * speed / (10.0 * D)
        return np.concatenate([v, a, [2.0 * math.pi * s * speed / D], forgets * (rates**2 - squares)])

    node = start.model.nodes("a-b")[1]
    y = np.concatenate([start.q[node], start.v[node], start.shedding[node, [0, 2, 3]]])
    return solve_ivp(slopes, (0.0, t[-1]), y, method="DOP853", rtol=1e-10, atol=1e-12, t_eval=t).y.T


@pytest.mark.parametrize("fields", [{"shedding_window": 0.4, "Cdn": 1.2, "Can": 0.7}, *slow({})])
def test_order_two(fields):
    """Places, velocities and phases against DOP853 of the same equations, while the vibration builds up."""
    scene = held(**fields)
    start, found = straight(scene), []
    node, exact = start.model.nodes("a-b")[1], solved(scene, start, [0.5])[0]
    steps = (2e-3, 1e-3, 5e-4, 2.5e-4)
    for dt in steps:
        run = simulate(scene, t_end=0.5, dt=dt, method="edmc", start=start)
        found.append([run.q[-1, node], run.v[-1, node], [run.shedding[-1, node, 0]] * 3])
    exact = np.array([exact[:3], exact[3:6], [exact[6]] * 3])
    errors = np.linalg.norm(np.array(found) - exact, axis=2)
    for error, size in zip(errors.T, (0.01, 0.5, 20.0), strict=True):
        assert np.polyfit(np.log(steps), np.log(error), 1)[0] == pytest.approx(2.0, abs=0.15)
        assert error[-1] < 2e-3 * size  # of the vibration of half a diameter, its velocity, and the angle turned


def locked(scene):
    """Circular frequency and amplitude of the velocity of a linear oscillator that the lift shakes, see the docstring below."""
    cable, rate = scene.cables[0], scene.effects[1].rate
    mass, T = cable.mass_per_length * cable.L0, cable.EA * (1.0 / cable.L0 - 1.0)
    k, c, m = 2.0 * T / 1.0, rate * mass, mass + RHO * math.pi / 4.0 * D**2 * cable.L0 * cable.Can
    F = 0.5 * RHO * D * cable.Cl * cable.L0 * U**2

    def lag(omega):
        return math.atan2(k / omega - m * omega, c)

    low, high = (2.0 * math.pi * U / D * (cable.St + sign * cable.St_range) for sign in (-1.0, 1.0))
    omega = brentq(lambda x: 2.0 * math.pi * U / D * (cable.St + cable.St_range * math.sin(lag(x))) - x, low, high)
    return omega, F * math.cos(lag(omega)) / c


@pytest.mark.parametrize("strain", [2e-3, 3e-3, 4.5e-3])
def test_locked_vibration(strain):
    """y' = V cos(theta), lift F cos(theta - delta): c V = F cos(delta), (k/omega - m omega) V = F sin(delta), and the frequency
    omega d/(2 pi U) = St + St_range sin(delta).

    Small against the flow: |u| is that of the flow but for V^2/(4 U^2), 0.1 %.
    """
    scene = held(rate=300.0, strain=strain)
    omega, V = locked(scene)
    run = simulate(scene, t_end=4.0, dt=5e-4, method="edmc", start=straight(scene))
    node, late = run.model.nodes("a-b")[1], run.t > 2.0
    t, velocity = run.t[late], run.v[late, node, 1]
    assert 0.01 < V / U < 0.1
    assert math.sqrt(2.0 * np.mean(velocity**2)) == pytest.approx(V, rel=0.01)
    phase = run.shedding[late, node, 0]
    assert (phase[-1] - phase[0]) / (t[-1] - t[0]) == pytest.approx(omega, rel=0.005)
    crossings = np.flatnonzero((velocity[:-1] < 0.0) & (velocity[1:] >= 0.0))
    found = 2.0 * math.pi * (len(crossings) - 1) / (t[crossings[-1]] - t[crossings[0]])
    assert found == pytest.approx(omega, rel=0.01)  # crossings are known to a saved time of some 80 periods


@pytest.mark.parametrize(("mu", "strain", "rate", "s"), [(500.0, 1e-4, 8.0, 0.10), (0.02, 0.1, 400.0, 0.26)])
def test_far_from_lock_in(mu, strain, rate, s):
    """A heavy cable lags the lift by a quarter of a turn, and a stiff one leads by as much: f d/U is near St -+ St_range.

    Near, because the phase does not turn steadily there: within a tenth of the range.
    """
    run = simulate(scene := held(rate=rate, mu=mu, strain=strain), t_end=3.0, dt=1e-3, method="edmc", start=straight(scene))
    late = run.shedding[run.t > 2.0, run.model.nodes("a-b")[1], 0]
    turned = (late[-1] - late[0]) / (2.0 * math.pi * U / D * (run.t[-1] - run.t[run.t > 2.0][0]))
    assert turned == pytest.approx(s, abs=0.016)


def test_frequency_of_a_cable_at_rest():
    assert frequency(0.18, 0.08, 1.3, 0.0, 0.0, 0.0, 0.0) == 0.18
    phases = np.linspace(0.0, 6.0, 7)
    found = [frequency(0.18, 0.08, 0.4, 2.0 * math.cos(x), -30.0 * math.sin(x), 2.0, 450.0) for x in phases]
    assert found == pytest.approx(0.18 + 0.08 * np.sin(phases - 0.4))


def drawn(seed=0):
    """Law, numbers, index and two random states of a cable of four segments below and through the surface of a sheared current."""
    current = wind.Sampled(((-2.0, 1.0, 0.4), (1.0, 0.2, -0.3)))
    points = [Fixed("a", (0.0, 0.0, -1.2)), Fixed("b", (0.5, 0.2, 0.3))]
    cable = Cable("a", "b", length=1.6, mass_per_length=0.5, EA=1e5, segments=4, diameter=0.4, Cl=0.7)
    model = build(Scene(points, [cable], [Gravity(), Water(RHO, current=current)]))
    (effect,) = (one for one in model.forces if isinstance(one, VortexShedding))
    index, params = (numbers.copy() for numbers in effect.table(model))
    random = np.random.default_rng(seed)
    inner = effect.inner_states(index, params).reshape(-1, 4)
    params[inner[:, 0]], params[inner[:, 1]] = random.uniform(0.0, 6.0, len(inner)), random.uniform(0.1, 0.3, len(inner))
    straight_q = np.zeros((model.n, 3))
    straight_q[model.nodes("a-b")] = np.linspace(points[0].at, points[1].at, 5)
    base, q = straight_q + 0.1 * random.normal(size=(2, model.n, 3))
    return effect.kernels(), model, index, params, base, q, random.normal(size=(model.n, 3))


def blocks_as_matrix(model, D, near):
    """The blocks that `tangent` writes, as one matrix over all nodes."""
    matrix = np.zeros((model.n, 3, model.n, 3))
    for i in range(model.n_free):
        matrix[i, :, i] += D[i]
    for s, (i, j) in enumerate(model.ends):
        matrix[i, :, j] += near[s, 0]
        matrix[j, :, i] += near[s, 1]
    return matrix


@pytest.mark.parametrize("slot", ["tangent", "whole_step"])
def test_slopes_are_exact(slot):
    """Against central differences of the force, whose error falls with the square of their length: 1e-5 of it here."""
    kernels, model, index, params, base, q, v = drawn()
    h, D, near = 0.01, np.zeros((model.n_free, 3, 3)), np.zeros((model.near_rows, 2, 3, 3))
    far = near[:0]

    def force(q, v):
        f = np.zeros((model.n, 3))
        if slot == "tangent":
            kernels["force"](0.2, q, v, index, params, f)
        else:
            kernels["whole_step"](0.2, h, 0.0, base, q, index, params, f, D.copy(), near.copy(), far)
        return f

    direction = np.random.default_rng(1).normal(size=(2, model.n, 3))
    direction[:, model.n_free :] *= 0.0
    if slot == "tangent":
        kernels["tangent"](0.2, q, v, index, params, 0.7, 0.3, D, near, far)
        along_q, along_v = 0.7 * direction[0], 0.3 * direction[0]
    else:
        kernels["whole_step"](0.2, h, 0.0, base, q, index, params, np.zeros((model.n, 3)), D, near, far)
        along_q, along_v = direction[0], 0.0 * direction[0]
    e = 1e-5
    slope = (force(q + e * along_q, v + e * along_v) - force(q - e * along_q, v - e * along_v)) / (2.0 * e)
    found = -np.einsum("ixjy,jy->ix", blocks_as_matrix(model, D, near), direction[0])
    assert np.abs(slope).max() > 1.0 and np.abs(found - slope)[: model.n_free].max() < 1e-6 * np.abs(slope).max()


def test_no_flow_no_lift():
    """To the last bit what it is without a `Cl`, and phases that stand still."""
    still = held(flow=(0.0, 0.0, 0.0))
    start = straight(still)
    start.q[start.model.nodes("a-b")[1], 2] += 0.01  # along the cable, so that no water flows across it
    runs = [
        simulate(scene, t_end=0.5, dt=0.01, method="edmc", start=replace(start, model=build(scene)))
        for scene in (still, held(flow=(0.0, 0.0, 0.0), Cl=0.0))
    ]
    assert np.array_equal(runs[0].q, runs[1].q) and np.ptp(runs[0].q[:, start.model.nodes("a-b")[1], 2]) > 1e-3
    assert (runs[0].shedding[:, :, 0] == runs[0].shedding[0, :, 0]).all() and runs[1].shedding is None


def test_statics_feel_no_lift():
    scenes = [held(segments=6, Cdn=1.2, Cl=Cl) for Cl in (0.8, 0.0)]
    a, b = (equilibrium(scene) for scene in scenes)
    assert np.array_equal(a.q, b.q) and a.shedding is None


def test_phases_start_spread_and_the_account_closes():
    scene = held(rate=1.0, segments=8, Cdn=1.2)
    run = simulate(scene, t_end=2.0, dt=1e-3, method="edmc")
    phases = run.shedding[0, run.model.nodes("a-b"), 0]
    assert phases == pytest.approx([0.0, *(2.0 * math.pi * k / 8.0 for k in range(1, 8)), 0.0])
    balance = run.energy_balance
    assert run.ok and balance.imbalance < 1e-5  # what the tolerance of Newton's method leaves
    assert balance.by_effects < 0.0 < balance.by_dampers  # the flow gives
    assert run.energy_promise is EnergyPromise.NONE
    assert simulate(held(Cl=0.0), t_end=0.1, dt=0.01, method="edmc").energy_promise is EnergyPromise.NEVER_RISES


def turned(angle=0.7):
    """A rotation about (1, 2, 3)."""
    x, y, z = np.array([1.0, 2.0, 3.0]) / math.sqrt(14.0)
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K


def test_all_turned():
    """Supports and current turned about an axis: so is the motion. Rounding grows while the vibration builds up."""
    R, middle = turned(), np.mean(ENDS, axis=0)
    ends = [tuple((R @ (end - middle) + middle).tolist()) for end in ENDS]
    scene, other = held(segments=4, Cdn=1.2), held(segments=4, Cdn=1.2, ends=ends, flow=tuple((R @ (U, 0.0, 0.0)).tolist()))
    runs = [simulate(one, t_end=0.5, dt=1e-3, method="edmc", start=straight(one)) for one in (scene, other)]
    assert np.ptp(runs[0].q[..., 1]) > 1e-3
    assert runs[1].q == pytest.approx((runs[0].q - middle) @ R.T + middle, abs=1e-9)
    assert runs[1].shedding == pytest.approx(runs[0].shedding, rel=1e-6, abs=1e-7)


def test_ends_exchanged():
    """The lift is that of the opposite phase."""
    scene = held(segments=4, Cdn=1.2)
    (cable,) = scene.cables
    other = replace(scene, cables=[replace(cable, start="b", end="a", name="a-b")])
    inner = [(math.pi + turn, 0.18, 1e-4, 1.0) for turn in (0.0, math.pi)]
    starts = straight(scene, inner[0]), straight(other, inner[1])
    runs = [simulate(start.scene, t_end=0.5, dt=1e-3, method="edmc", start=start) for start in starts]
    assert np.ptp(runs[0].q[..., 1]) > 1e-3
    assert runs[1].q[:, runs[1].model.nodes("a-b")] == pytest.approx(runs[0].q[:, runs[0].model.nodes("a-b")][:, ::-1], abs=1e-9)


def test_goes_on_where_it_was(tmp_path):
    """From a State, from a file and in a session, to the last bit."""
    scene = held(segments=4, Cdn=1.2)
    whole = simulate(scene, t_end=0.4, dt=1e-3, save_every=0.1, method="edmc")
    half = simulate(scene, t_end=0.2, dt=1e-3, method="edmc")
    half.save(tmp_path / "run.nc")
    loaded = load_run(tmp_path / "run.nc")
    assert np.array_equal(loaded.shedding, half.shedding)
    rest = simulate(scene, t_end=0.2, dt=1e-3, save_every=0.1, method="edmc", start=loaded.final)
    assert rest.shedding[-1] == pytest.approx(whole.shedding[-1], rel=1e-4)  # Newton's first guess has another history
    session = Session(scene, dt=1e-3, method="edmc")
    for _ in range(200):
        session.step()
    mark, state = session.save(), session.state
    assert np.array_equal(state.shedding, half.shedding[-1]) and np.array_equal(state.q, half.q[-1])
    for _ in range(200):
        session.step()
    end = session.state.shedding
    assert np.array_equal(end, whole.shedding[-1])
    session.restore(mark)
    for _ in range(200):
        session.step()
    assert np.array_equal(session.state.shedding, end)


def test_states_from_a_time_on_and_extrapolated():
    scene = held(segments=4, Cdn=1.2)
    coarse, fine = (simulate(scene, t_end=0.2, dt=dt, save_every=0.01, method="edmc") for dt in (2e-3, 1e-3))
    late = over_time.window(fine, 0.1)
    assert np.array_equal(late.shedding, fine.shedding[-len(late.t) :]) and len(late.t) < len(fine.t)
    found = simulate(scene, t_end=0.2, dt=2e-3, save_every=0.01, extrapolate=True)
    assert found.shedding[..., 0] == pytest.approx((4.0 * fine.shedding[..., 0] - coarse.shedding[..., 0]) / 3.0)
    assert (found.shedding[..., 2:] >= 0.0).all()


def test_phases_go_on_through_a_break():
    """After 0.2 s the cable is cut at its middle: nodes of both pieces keep their phases, those at the cut bear no lift."""
    scene = held(segments=6, Cdn=1.2, cuts=[CableCut("a-b", t=0.2, segment=2)])
    run = simulate(scene, t_end=0.3, dt=1e-3, save_every=0.01, method="edmc")
    nodes = run.model.nodes("a-b")
    before, after = (run.shedding[np.searchsorted(run.t, t - 1e-9), nodes] for t in (0.2, 0.21))
    assert run.ok and (before[1:-1, 1] > 0.0).all()
    assert (after[[2, 3], 1] == 0.0).all() and (after[[1, 4, 5], 0] > before[[1, 4, 5], 0]).all()
    assert (after[[1, 4, 5], 0] - before[[1, 4, 5], 0] < 2.0 * math.pi * 0.3 / D * 0.02).all()


def test_a_segment_that_breaks_takes_its_step_again():
    """The step in which it breaks is shortened: phases are those of the time of the break."""
    unbroken = held(segments=4, rate=1.0)
    tension = simulate(unbroken, t_end=0.5, dt=2e-3, method="edmc").segment_tension
    scene = held(segments=4, rate=1.0, breaking_tension=0.5 * float(tension[0].max() + tension.max()))
    run = simulate(scene, t_end=0.5, dt=2e-3, method="edmc")
    t = run.events[0].t
    row, whole = int(np.searchsorted(run.t, t)), run.shedding[:, run.model.nodes("a-b"), 0]
    turns, k = np.diff(whole[row - 1 : row + 1], axis=0)[0] / (2.0 * math.pi * U / D * (run.t[row] - run.t[row - 1])), np.arange(5)
    left = (whole[row] > 0.0) & (k > 0) & (k < 4)
    assert 0.01 < t < 0.5 and t % 2e-3 > 1e-5 and left.any()
    assert ((0.09 < turns[left]) & (turns[left] < 0.27)).all()  # f d/U; a step that counts twice has 0.36


def test_the_step_resolves_the_vortices():
    """A hundredth of their shortest period, or less."""
    run = simulate(held(), t_end=0.01)
    assert run.method == "edmc" and "sheds vortices" in run.reason and run.dt < 0.01 * D / (0.26 * U)
    wave = waves.Airy(0.4, 2.0)
    for flow, U_max in ((wind.Uniform((0.0, 0.5, 0.0)), 0.5), (wind.Sampled(((-9.0, 0.5, 0.0), (-8.0, 0.7, 0.0))), 0.7)):
        scene = replace(held(), effects=[Gravity(), Water(RHO, current=flow)])
        assert time_scale(scene) == pytest.approx(D / (math.pi * 0.26 * U_max))
    points = [Fixed("a", (0.0, 0.0, -1.0)), Fixed("b", (0.0, 0.0, 0.1))]
    scene = Scene(points, held().cables, [Gravity(), Water(RHO, wave=wave)])
    assert time_scale(scene) == pytest.approx(D / (math.pi * 0.26 * 0.2 * math.pi), rel=0.02)  # the speed at the surface


def test_in_a_scene_file():
    scene = held(shedding_window=0.3, St=0.2, St_range=0.1)
    entries = scene_to_dict(scene)
    assert entries["cables"][0]["Cl"] == 0.8 and scene_from_dict(entries) == scene


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"Cl": -1.0}, "`Cl` must be non-negative"),
        ({"St": 0.0}, "`St` must be positive"),
        ({"St_range": -0.1}, "`St_range` must be non-negative"),
        ({"St_range": 0.18}, r"`St_range` must be less than `St`, but cable .a-b. has St_range=0\.18 and St=0\.18"),
        ({"shedding_window": 0.0}, "`shedding_window` must be positive"),
    ],
)
def test_refused_numbers(fields, says):
    with pytest.raises(SceneError, match=says):
        held(**fields)


@pytest.mark.parametrize(
    ("how", "says"),
    [
        ({"method": "verlet"}, r'needs method="edmc", but cable .a-b. has a `Cl` and the method is verlet'),
        ({"method": "edmc", "rtol": 1e-4}, "A cable that sheds vortices needs fixed steps, but cable .a-b. has a `Cl` and a t"),
    ],
)
def test_refused_methods(how, says):
    with pytest.raises(InputError, match=says):
        simulate(held(), t_end=0.1, **how)


def test_refused_starts():
    scene = held()
    start = straight(scene)
    with pytest.raises(InputError, match="A start must have finite phases of vortices"):
        simulate(scene, t_end=0.1, start=straight(scene, (0.0, 0.18, -1.0, 1.0)))
    with pytest.raises(InputError, match=r"`shedding` of a State must have the shape \(3, 4\)"):
        simulate(scene, t_end=0.1, start=replace(start, shedding=start.shedding[:, :3]))


def test_a_file_without_its_phases(tmp_path):
    import xarray as xr

    run = simulate(held(), t_end=0.01, dt=1e-3, method="edmc")
    run.save(tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc", engine="scipy") as data:
        other = data.load().drop_vars("shedding")
    other.attrs.pop("format")
    other.attrs.pop("checksum")
    other.to_netcdf(tmp_path / "other.nc", engine="scipy")
    with pytest.raises(InputError, match="it tells the phases of vortices, and no cable sheds any, or it does not, and one does"):
        load_run(tmp_path / "other.nc")


def test_other_states_begin_anew():
    """Of a cable that had no `Cl`."""
    start = equilibrium(held(Cl=0.0))
    bare = State(start.model, 0.0, start.q, start.v, start.segment_tension)
    run = simulate(held(), t_end=0.01, dt=1e-3, method="edmc", start=bare)
    assert run.shedding[0, run.model.nodes("a-b")[1], 1] == 0.18 and INNER == 7


def test_cables_that_do_not_stretch():
    """By `edmc`, where others without a method given go by links, which carry no phases."""
    points = [Fixed("a", (0.0, 0.0, -10.0)), Free("b", mass=20.0)]
    cable = Cable("a", "b", length=4.0, mass_per_length=0.5, EA=float("inf"), segments=6, diameter=D, Cl=0.8)
    water = Water(RHO, current=wind.Uniform((U, 0.0, 0.0)))
    run = simulate(Scene(points, [cable], [Gravity(), water]), t_end=0.2, error=0.01)
    assert run.ok and run.method == "edmc" and (run.shedding[-1, run.model.nodes("a-b")[1:-1], 0] > 2.0).all()


def test_recommended_are_fixed_steps():
    """Of edmc, which alone carries the phases; other methods and tolerances are left out."""
    found = recommend(held(Cdn=1.2), 1e-3, t_end=0.3)
    assert found.best.method == "edmc" and "dt" in found.best.stepping
