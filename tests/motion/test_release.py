"""Cables that part from a point together: what falls, when, the account, sessions, restarts, files and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import (
    Body,
    Cable,
    CableCut,
    Driven,
    Fixed,
    Free,
    InputError,
    PayloadChange,
    Release,
    Scene,
    SceneError,
    Session,
    State,
    equilibrium,
    load_run,
    paths,
    simulate,
)
from anet_lumped.effects import Gravity
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

G, T_LET_GO = 9.81, 0.1
LAW = {"mass_per_length": 0.1, "EA": 1e4, "zeta": 0.05}


def hung(*events, holder=None, **of_cable):
    """A weight of 2 kg on a cable whose upper end is held at a point."""
    cable = Cable("end", "b", length=1.0, segments=4, **(LAW | of_cable))
    points = [holder or Fixed("a", (0, 0, 0)), Free("end"), Free("b", mass=2.0)]
    return Scene(points, [cable], [Gravity(G)], events=events)


def bridle(*events, holder=None, **of_cables):
    """Two cables that hang together from one point, a third one that stays there, and weights below."""
    points = [holder or Fixed("a", (0, 0, 0)), Free("end"), Fixed("side", (1.0, 0, -0.5)), Free("b", mass=1.0), Free("c", mass=0.5)]
    made = LAW | of_cables
    cables = [
        Cable("end", "b", length=0.8, segments=4, **made), Cable("side", "end", length=1.3, segments=5, **made),
        Cable("a", "c", length=0.5, segments=3, **LAW),
    ]  # fmt: skip
    return Scene(points, cables, [Gravity(G)], events=events)


@pytest.mark.parametrize("method", ["edmc", "verlet"])
def test_a_weight_that_is_let_go_falls_freely_with_its_whole_cable(method):
    """The centre of mass falls as t^2/2, of which a step of both methods is exact; nothing stays at the support."""
    scene = hung(Release("end", "a", t=T_LET_GO))
    run = simulate(scene, 0.3, method=method, dt=1e-4)
    (event,) = run.events
    assert (event.kind, event.where, event.t, event.tension, event.lost) == ("released", "end", T_LET_GO, None, 0.0)
    moved = run.q[:, : run.model.n_free, 2] - run.q[0, : run.model.n_free, 2]
    fall = moved @ run.model.mass[: run.model.n_free] / run.model.mass[: run.model.n_free].sum()
    np.testing.assert_allclose(-fall, np.maximum(run.t - T_LET_GO, 0.0) ** 2 * 0.5 * G, atol=1e-9 if method == "edmc" else 1e-6)
    before = run.t <= T_LET_GO
    assert (run.position("end")[before] == 0.0).all() and (run.position("end")[~before, 2] < 0.0).all()
    np.testing.assert_allclose(run.reaction("a")[run.t < T_LET_GO, 2], 2.1 * G, rtol=1e-6)
    assert (run.reaction("a")[~before] == 0.0).all() and np.abs(run.end_tension("end-b", "a")[~before]).max() < 1e-9
    assert run.end_tension("end-b", "a")[0] == run.end_tension("end-b", "end")[0] == pytest.approx(2.1 * G)
    assert run.ok and run.energy_balance.imbalance < (1e-6 if method == "edmc" else 1e-3)


def test_cables_that_part_together_stay_joined():
    """As a scene without the release goes on from the same state, in which the point moves freely from the start."""
    scene = bridle(Release("end", "a", t=T_LET_GO))
    rest = equilibrium(scene)
    assert (rest.position("end") == 0.0).all()
    run = simulate(scene, 0.4, dt=1e-3)
    loose = replace(scene, events=())
    start = State(equilibrium_model(loose), 0.0, rest.q, rest.v, rest.segment_tension)
    other = simulate(loose, 0.3, dt=1e-3, start=start)
    k = int(np.flatnonzero(run.t >= T_LET_GO - 1e-9)[0])
    np.testing.assert_allclose(run.position("end")[k:], other.position("end"), atol=1e-9)  # rests are to 1e-12
    np.testing.assert_allclose(run.position("b")[k:], other.position("b"), atol=1e-9)
    np.testing.assert_allclose(run.position("c"), np.tile(rest.position("c"), (len(run.t), 1)), atol=1e-9)
    assert run.position("end")[-1, 2] < -0.1 and run.ok and run.energy_balance.imbalance < 1e-6


def equilibrium_model(scene):
    return State.of(scene, points={"end": (0, 0, 0), "b": (0, 0, -1), "c": (0, 0, -1)}).model


def pulled(*events):
    """A cable from a point below, whose end is held there, to one that moves up at 0.5 m/s; taut after 0.1 s."""
    points = [Fixed("low", (0, 0, 0)), Free("end"), Driven("top", paths.line((0, 0, 0.95), (0, 0, 1.45), 1.0))]
    return Scene(points, [Cable("end", "top", length=1.0, segments=5, **LAW)], [Gravity(G)], events=events)


def test_a_cable_parts_from_its_lower_end_at_a_tension():
    """When the tension of the lowest segment of a run without release gets there."""
    limit = 30.0
    whole = simulate(pulled(Release("end", "low", t=9.0)), 0.5, dt=1e-3, method="edmc", save_every=1e-3)
    lowest = whole.tension("end-top")[:, 0]
    k = int(np.flatnonzero(lowest > limit)[0])
    when = np.interp(limit, lowest[k - 1 : k + 1], whole.t[k - 1 : k + 1])
    run = simulate(pulled(Release("end", "low", tension=limit)), 0.5, dt=1e-3, method="edmc")
    (event,) = run.events
    assert event.kind == "released" and event.t == pytest.approx(when, abs=1e-3)  # a step
    assert event.tension == pytest.approx(limit, rel=1e-3) and event.t > 0.1
    assert run.position("end")[-1, 2] > 0.05 and (run.reaction("low")[-1] == 0.0).all()


def test_any_of_several_cables_parts_them_all_and_a_weaker_one_breaks_itself():
    T = equilibrium(bridle(Release("end", "a", t=1.0))).tension("end-b").max()
    run = simulate(bridle(Release("end", "a", tension=0.99 * T)), 0.05, dt=1e-3)
    assert [(event.kind, event.where) for event in run.events] == [("released", "end")] and run.events[0].t == 0.0
    weak = simulate(bridle(Release("end", "a", tension=0.99 * T), breaking_tension=0.9 * T), 0.02, dt=1e-3)
    assert (weak.events[0].kind, weak.events[0].where) == ("broke", "end-b")


def test_a_free_holder_goes_its_own_way():
    """A clump between three cables: two part from it, and the pendulum that is left swings as one that was never joined."""
    clump = Free("a", mass=3.0, at=(0, 0, 0))
    scene = bridle(Release("end", "a", t=T_LET_GO), holder=clump)
    scene = replace(
        scene,
        points=[*scene.points, Fixed("up", (-0.2, 0, 1.0))],
        cables=[*scene.cables, Cable("up", "a", length=1.0, segments=4, **LAW)],
    )
    run = simulate(scene, 0.4, dt=1e-3)
    assert run.ok and run.energy_balance.imbalance < 1e-6
    k = int(np.flatnonzero(run.t >= T_LET_GO - 1e-9)[0])
    assert (run.position("end")[: k + 1] == run.position("a")[: k + 1]).all()
    assert np.abs(run.position("end")[-1] - run.position("a")[-1]).max() > 0.05


def test_a_driven_holder_gives_what_is_let_go_its_velocity():
    scene = hung(Release("end", "a", t=T_LET_GO), holder=Driven("a", paths.line((0, 0, 0), (0.2, 0, 0), 0.2)))
    run = simulate(scene, 0.3, dt=1e-3, method="edmc")
    k = int(np.flatnonzero(run.t >= T_LET_GO - 1e-9)[0])
    momentum = run.v[k + 1 :, : run.model.n_free, 0] @ run.model.mass[: run.model.n_free]
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-9)
    assert run.velocity("end")[k, 0] == run.velocity("a")[k, 0] > 0.05 and run.energy_balance.imbalance < 1e-6


def test_a_body_lets_go():
    body = Body("buoy", mass=50.0, inertia=(3, 3, 3), attachments={"eye": (0, 0, -0.3)}, at=(0, 0, 0), hull=None)
    points = [Fixed("up", (0, 0, 2.0)), Free("end"), Free("b", mass=2.0)]
    cables = [Cable("up", "buoy", length=2.0, segments=3, **(LAW | {"EA": 1e5})), Cable("end", "b", length=1.0, segments=4, **LAW)]
    scene = Scene(points, cables, [Gravity(G)], [Release("end", "buoy.eye", t=T_LET_GO)], [body])
    run = simulate(scene, 0.3, dt=1e-3)
    assert run.ok and run.events[0].kind == "released" and run.energy_balance.imbalance < 1e-6
    k = int(np.flatnonzero(run.t >= T_LET_GO - 1e-9)[0])
    heights, mass = run.shape("end-b")[:, :, 2], np.array([0.0125, 0.025, 0.025, 0.025, 2.0125])
    fall = (heights[k] - heights[-1]) @ mass / mass.sum()  # of the centre of mass, with the velocity that it had
    along = run.v[k, run.model.nodes("end-b"), 2] @ mass / mass.sum()
    assert fall == pytest.approx(0.5 * G * 0.2**2 - along * 0.2, rel=1e-6)
    assert np.allclose(run.position("end")[:k], run.position("buoy.eye")[:k])


def test_a_session_a_saved_run_and_a_restart(tmp_path):
    scene = bridle(Release("end", "a", t=T_LET_GO))
    run = simulate(scene, 0.2, method="edmc", dt=0.005)
    with Session(scene, 0.005, method="edmc") as session:
        mark = session.save()
        with pytest.raises(InputError, match=r'"end" is held by another one at first'):
            session.push("end", (1, 0, 0))
        assert (session.position("end") == 0.0).all()
        for _ in range(40):
            session.step()
        assert np.array_equal(session.state.q, run.q[-1]) and session.events == run.events
        session.restore(mark)
        assert session.events == ()
        for _ in range(40):
            session.step()
        assert np.array_equal(session.state.q, run.q[-1])
    run.save(tmp_path / "run.nc")
    saved = load_run(tmp_path / "run.nc")
    assert saved.events == run.events and saved.scene == scene
    on = simulate(scene, 0.05, method="edmc", dt=0.005, start=run.final)
    assert on.events == run.events  # and no second time
    late = replace(equilibrium(scene), t=1.0)
    after = simulate(scene, 0.05, method="edmc", dt=0.005, start=late)
    assert [(event.t, event.where) for event in after.events] == [(T_LET_GO, "end")]
    assert after.position("end")[-1, 2] < 0.0


def test_scene_files_and_cuts_beside():
    scene = bridle(Release("end", "a", 3.0, 50.0), CableCut("end-b", 0.05), PayloadChange("b", 0.1, 0.5))
    assert scene_from_dict(scene_to_dict(scene)) == scene
    assert scene_to_dict(scene)["events"][0] == {"kind": "release", "point": "end", "holder": "a", "t": 3.0, "tension": 50.0}
    run = simulate(scene, 0.12, dt=1e-3)
    assert run.ok and [event.kind for event in run.events][:2] == ["broke", "payload changed"]
    assert str(simulate(bridle(Release("end", "a", t=0.01)), 0.02, dt=1e-3).events[0]) == 't=0.01 s: point "end" was released'


@pytest.mark.parametrize(
    ("events", "message"),
    [
        ([Release("a", "side", 1.0)], r'A point that is held must be free, but "a" of a release is not'),
        ([Release("end", "a", 1.0), Release("end", "side", 1.0)], r'A point may be held by one other, but "end" is by two'),
        ([Release("end", "a", 1.0), Release("b", "end", 1.0)], r'must be held by one that is not held itself, but "b" is by "end"'),
        ([Release("end", "b", 1.0)], r'both ends of "end-b" are held at one'),
        ([Release("end", "a", 1.0), PayloadChange("end", 1.0, 2.0)], r'at a point that is not held, but one is to change at "end"'),
        ([Release("nd", "a", 1.0)], r'did you mean "end"'),
    ],
)
def test_what_is_refused(events, message):
    with pytest.raises(SceneError, match=message):
        bridle(*events)


def test_numbers_that_are_refused():
    with pytest.raises(SceneError, match=r'must have a time `t` or a `tension`, but the release of point "end" has neither'):
        Release("end", "a")
    with pytest.raises(SceneError, match=r"Argument `tension` must be positive"):
        Release("end", "a", tension=0.0)
    with pytest.raises(SceneError, match=r'lets go of all its cables must have a mass, but "a" has none'):
        hung(Release("end", "a", 1.0), holder=Free("a"))
    with pytest.raises(InputError, match=r'A release at a tension needs a method other than .* but point "end" has one'):
        simulate(hung(Release("end", "a", tension=1e9)), 0.1, dt=1e-3, extrapolate=True)
    away = State.of(hung(Release("end", "a", 1.0)), points={"end": (0.1, 0, 0), "b": (0, 0, -1)})
    with pytest.raises(InputError, match=r'must start at its holder, but "end" is 0.1 m from "a"'):
        simulate(away.scene, 0.1, dt=1e-3, start=away)
