"""Cables that are cut at given times: what falls, the account, sessions, restarts, scene files and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, CableCut, Fixed, Free, PayloadChange, Scene, SceneError, Session, equilibrium, load_run, simulate
from anet_lumped.effects import Gravity
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict

G, T_CUT = 9.81, 0.1


def hung(*cuts, **of_cable):
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, zeta=0.05, segments=4, **of_cable)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", mass=2.0)], [cable], [Gravity(G)], events=cuts)


@pytest.mark.parametrize("method", ["edmc", "verlet"])
def test_a_weight_that_is_cut_off_falls_freely(method):
    """Cut beside the weight: it falls with half a segment, from rest, as t^2/2 (a step of both methods is exact for that)."""
    run = simulate(hung(CableCut("a-b", t=T_CUT, segment=-1)), 0.4, method=method, dt=1e-4)
    (event,) = run.events
    T = 2.0125 * G  # of the last segment
    assert (event.kind, event.t, event.segment) == ("broke", T_CUT, 3) and event.tension == pytest.approx(T, rel=1e-6)
    assert event.lost == pytest.approx(0.5 * T**2 / 4e4, rel=1e-6)  # what the segment held
    fall = np.maximum(run.t - T_CUT, 0.0) ** 2 * 0.5 * G
    np.testing.assert_allclose(run.position("b")[0, 2] - run.position("b")[:, 2], fall, atol=1e-6)
    assert (run.tension("a-b")[run.t > T_CUT, 3] == 0.0).all() and not run.holds("a-b")[-1, 3]
    assert run.ok and run.energy_balance.imbalance < (1e-6 if method == "edmc" else 1e-3)


def test_payloads_change_and_cables_are_cut_at_once():
    scene = hung(PayloadChange("b", T_CUT, 1.0), CableCut("a-b", T_CUT, 0), CableCut("a-b", T_CUT, 2))
    run = simulate(scene, 0.12, method="edmc", dt=1e-3)
    assert [event.kind for event in run.events] == ["payload changed", "broke", "broke"] and run.ok


def test_a_segment_that_has_broken_is_not_cut():
    run = simulate(hung(CableCut("a-b", 0.02, 0), breaking_tension=20.0), 0.03, method="edmc", dt=1e-3)
    assert [event.segment for event in run.events].count(0) == 1 and run.events[0].t == 0.0


def test_a_session_a_saved_run_and_a_restart(tmp_path):
    scene = hung(CableCut("a-b", T_CUT, 1))
    run = simulate(scene, 0.2, method="edmc", dt=0.005)
    with Session(scene, 0.005, method="edmc") as session:
        for _ in range(40):
            session.step()
        assert np.array_equal(session.state.q, run.q[-1]) and session.events == run.events
    run.save(tmp_path / "run.nc")
    assert load_run(tmp_path / "run.nc").events == run.events
    on = simulate(scene, 0.05, method="edmc", dt=0.005, start=run.final)
    assert on.events == run.events  # and no second cut
    late = replace(equilibrium(scene), t=1.0)
    after = simulate(scene, 0.05, method="edmc", dt=0.005, start=late)
    assert [(event.t, event.segment) for event in after.events] == [(T_CUT, 1)]
    assert after.position("b")[-1, 2] < late.position("b")[2]


def test_scene_files():
    scene = hung(CableCut("a-b", 3.0, -1), PayloadChange("b", 1.0, 0.5))
    assert scene_from_dict(scene_to_dict(scene)) == scene
    assert scene_to_dict(scene)["events"][0] == {"kind": "cable_cut", "cable": "a-b", "t": 3.0, "segment": -1}


def test_what_is_refused():
    with pytest.raises(SceneError, match=r'A cut must be of a segment of its cable, but "a-b" has 4, and 4 is cut'):
        hung(CableCut("a-b", 1.0, 4))
    with pytest.raises(SceneError, match=r'A segment may be cut once, but segment 3 of cable "a-b" is twice'):
        hung(CableCut("a-b", 1.0, -1), CableCut("a-b", 2.0, 3))
    with pytest.raises(
        SceneError, match=r'Argument `segment` must be a whole number up to 1e\+09, but the cut of cable "a-b" has segment=0.5'
    ):
        CableCut("a-b", 1.0, 0.5)
    with pytest.raises(SceneError, match=r"must hold PayloadChange, CableCut or Release, but holds 3"):
        hung(3)
    with pytest.raises(SceneError, match="cable"):
        hung(CableCut("c", 1.0))
