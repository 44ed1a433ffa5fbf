"""Largest tensions of all steps, those between saved states included."""

from dataclasses import replace

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, load_run, simulate
from anet_lumped.checks import InputError
from anet_lumped.effects import Gravity
from anet_lumped.results.peaks import hidden_peak, largest_of_cables
from anet_lumped.scene.cable_cut import CableCut
from studies.sweeping import over_time

DROP = 0.3  # [m], of a weight on a slack rope of 1 m


def rope(name, start, end, mass_per_length=0.02, **fields):
    return Cable(start, end, name=name, length=1.0, mass_per_length=mass_per_length, **fields)


def dropped(segments=6, EA=2e3, damping=0.02, names=("rope",), events=()):
    """Weights that fall into their ropes: each peak is over within a tenth of a second."""
    points, ropes = [], []
    for k, name in enumerate(names):
        points += [Fixed(f"hook{k}", (float(k), 0.0, 0.0)), Free(f"weight{k}", mass=1.0 + k, at=(float(k), 0.0, DROP - 1.0))]
        ropes.append(rope(name, f"hook{k}", f"weight{k}", EA=EA, zeta=damping, segments=segments))
    return Scene(tuple(points), tuple(ropes), (Gravity(),), events=events)


@pytest.fixture(scope="module")
def coarse_and_fine():
    """A run that saves three states, and the same one that saves every step."""
    return [simulate(dropped(), 0.6, method="edmc", dt=1e-3, start="straight", save_every=every) for every in (0.2, 1e-3)]


@pytest.mark.parametrize(
    "settings",
    [
        {"method": "edmc", "dt": 1e-3},
        {"method": "tr_bdf2", "dt": 1e-3},
        {"method": "verlet", "dt": 2e-4},
        {"method": "rk4", "dt": 2e-4},
    ],
    ids=lambda settings: settings["method"],
)
def test_a_peak_between_saved_states_is_known(settings):
    """As it is in a run that saves every step; which of them a run saves does not change them."""
    every, some = (
        simulate(dropped(), 0.6, start="straight", save_every=save, **settings) for save in (settings["dt"], 0.2)
    )  # fmt: skip
    np.testing.assert_array_equal(some.q[-1], every.q[-1])
    assert every.largest_tension is None and every.peak_tension() == every.segment_tension.max()
    assert some.segment_tension.max() < 0.5 * every.peak_tension()
    assert some.peak_tension() == pytest.approx(every.peak_tension(), rel=1e-3)
    assert some.peak_tension("rope") == some.peak_tension()


@pytest.mark.parametrize("settings", [{"rtol": 1e-7}, {"method": "dop853", "rtol": 1e-8}], ids=["doubled", "pair"])
def test_chosen_steps_are_looked_at(settings):
    run, fine = (simulate(dropped(), 0.6, start="straight", save_every=save, **settings) for save in (0.2, 2e-4))
    assert run.segment_tension.max() < 0.5 * fine.peak_tension()
    assert run.peak_tension() == pytest.approx(fine.peak_tension(), rel=5e-3)


def test_links_are_looked_at():
    """A pendulum let go from the horizontal: three times its weight at the lowest point."""
    scene = Scene(
        (Fixed("hook", (0.0, 0.0, 0.0)), Free("bob", mass=1.0, at=(1.0, 0.0, 0.0))),
        (rope("rod", "hook", "bob", EA=float("inf"), segments=1, compression="linear", mass_per_length=1e-6),),
        (Gravity(),),
    )
    run = simulate(scene, 1.2, method="links", start="straight", save_every=0.4)
    assert run.peak_tension() == pytest.approx(3.0 * 9.80665, rel=2e-3)
    assert run.segment_tension.max() < 0.9 * run.peak_tension()


def test_largest_tensions_do_not_fall_and_are_those_of_states_at_least(coarse_and_fine):
    run, fine = coarse_and_fine
    assert (np.diff(run.largest_tension, axis=0) >= 0.0).all()
    assert (run.largest_tension >= largest_of_cables(run.model, run.segment_tension)).all()
    assert run.to_xarray()["largest_tension"].values[-1] == pytest.approx(fine.to_xarray()["largest_tension"].values[-1], rel=1e-3)


def test_a_cable_that_is_cut_keeps_its_peak():
    """Its pieces are that cable; the other one has a peak of its own."""
    scene = dropped(names=("rope", "other"), events=(CableCut("rope", 0.45, 2),))
    run, fine = (simulate(scene, 0.6, method="edmc", dt=1e-3, start="straight", save_every=save) for save in (0.2, 1e-3))
    assert run.events[-1].where == "rope"
    for name in ("rope", "other"):
        assert run.peak_tension(name) == pytest.approx(fine.peak_tension(name), rel=1e-3)
    assert run.peak_tension("other") > 1.2 * run.peak_tension("rope")


def test_a_default_run_knows_a_peak_that_it_does_not_save():
    """Within what it keeps of the largest tension, 2 %; its word of that is no less than it is off."""
    scene = dropped(segments=1, damping=0.2)
    reference = simulate(scene, 0.6, method="edmc", dt=2e-5, start="straight").peak_tension()
    run = simulate(scene, 0.6, start="straight", save_every=0.2)
    off = abs(run.peak_tension() / reference - 1.0)
    assert run.kept and off <= 0.02 and off <= 1.5 * run.tension_error + 1e-3
    assert run.peak_at_most >= run.peak_tension() > 2.0 * run.segment_tension.max()


def test_a_run_of_given_steps_says_what_a_hidden_peak_may_lack():
    """Steps of a quarter of the bounce: the peak is wrong by a tenth and more, and the run says a fourth of that at least."""
    reference = simulate(dropped(1), 0.6, method="edmc", dt=2e-5, start="straight").peak_tension()
    run = simulate(dropped(1), 0.6, method="edmc", dt=0.04, start="straight", save_every=0.2)
    off = abs(run.peak_tension() / reference - 1.0)
    assert off > 0.1 and run.tension_error > 0.25 * off


def test_a_peak_that_no_state_shows_is_a_warning(coarse_and_fine):
    run, fine = coarse_and_fine
    found = hidden_peak(run)
    assert found.tension == run.peak_tension() and found.shown == run.segment_tension.max() and hidden_peak(fine) is None
    at = fine.t[fine.segment_tension.max(axis=1).argmax()]
    assert run.t[found.row - 1] < at < run.t[found.row]
    (text,) = (text for text in run.warnings if "largest tension" in text)
    assert f"{run.peak_tension():.4g} N" in text and "save_every" in text
    assert not any("largest tension" in text for text in fine.warnings)


def test_a_saved_run_keeps_it(coarse_and_fine, tmp_path):
    run = replace(coarse_and_fine[0], peak_at_most=123.0)
    run.save(tmp_path / "run.nc")
    again = load_run(tmp_path / "run.nc")
    np.testing.assert_array_equal(again.largest_tension, run.largest_tension)
    assert again.peak_at_most == 123.0 and again.peak_tension() == run.peak_tension()


def test_it_has_a_column_for_each_cable(coarse_and_fine):
    run = coarse_and_fine[0]
    with pytest.raises(InputError, match=r"`largest_tension` of a Run must be of the shape \(4, 1\)"):
        replace(run, largest_tension=np.zeros((len(run.t), 2)))


def test_a_window_after_the_peak_does_not_have_it(coarse_and_fine):
    run, fine = coarse_and_fine
    whole, late = (over_time.peak_tension(run, "rope", since) for since in (None, 0.4))
    assert whole == run.peak_tension() and late == over_time.window(run, 0.4).segment_tension.max() < whole
    assert over_time.peak_tension(fine, "rope", 0.4) < fine.peak_tension()
