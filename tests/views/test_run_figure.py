"""The picture of a run: it says what became of the run, and whatever is wrong with it in red."""

from dataclasses import replace

import matplotlib.image
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from systems import four_cables, loose_cable

from anet_lumped import simulate
from anet_lumped.views.run_figure import BAD, mark_failures, plot_run
from anet_lumped.views.verdict import as_length, verdict
from studies.shown import picture


def words(figure):
    """What stands above a figure, in one line, and whether it is in red in a red frame."""
    title = figure.get_suptitle().replace("\n", " ")
    red = figure._suptitle is not None and figure._suptitle.get_color() == BAD
    framed = figure.patch.get_linewidth() > 0 and figure.patch.get_edgecolor()[:3] == to_rgb(BAD)
    assert red == framed
    return title, red


def test_a_failed_audit_is_in_the_figure(tmp_path):
    run = simulate(loose_cable(1e4), 0.6, method="edmc", dt=0.02, start="straight", audit=1e-3)
    figure = plot_run(run)
    said, red = words(figure)
    assert red and said.startswith("AUDIT FAILED (edmc") and run.audit.where in said and "m are allowed" in said
    figure.savefig(tmp_path / "run.png")
    pixels = matplotlib.image.imread(tmp_path / "run.png")
    for edge in (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]):  # the frame is there, all round
        np.testing.assert_allclose(edge[:, :3], np.broadcast_to(to_rgb(BAD), edge[:, :3].shape), atol=0.02)


def test_a_passed_audit_gives_its_error_and_unit():
    run = simulate(four_cables(carried=True), 1.0, method="edmc", dt=0.01, audit=True)
    said, red = words(plot_run(run))
    assert not red and said.startswith("audit passed (edmc") and f"positions to {as_length(run.audit.error)} (estimate" in said
    assert "5 mm allowed" in said and f"energy accounted for to {run.audit.imbalance:.1g}" in said


def test_a_run_without_an_audit_gives_what_it_estimates():
    """The errors that the run tells, and whether two runs were compared for them; only where it tells none they are not known."""
    run = simulate(four_cables(carried=True), 1.0, method="edmc", dt=0.01)
    said = f"places {as_length(run.error_estimate)}, largest tension {100.0 * run.tension_error:.2g} % ("
    assert run.error_estimate > 0.0 and verdict(run) == (
        f"finished (edmc, t = 0 to 1 s); estimated errors: {said}from its own steps, not audited)"
    )
    assert words(plot_run(run)) == (verdict(run), False)
    assert verdict(replace(run, kept=True)).endswith(f"{said}two runs compared)")
    assert verdict(replace(run, kept=False)).endswith("(two runs compared, more than wanted)")
    assert "; estimated errors: places not known (--audit tells), largest" in verdict(replace(run, error_growth=None))
    flown = replace(run, error_growth=None, pushed=True)  # of a flight there is no audit
    assert "places not known (--audit tells), largest" in verdict(flown)
    whip = simulate(loose_cable(1e4), 0.6, method="edmc", dt=0.005, start="straight")
    assert f"places {as_length(whip.error_estimate)}, perhaps {whip.multiplies:.2g} times that" in verdict(whip)


def test_swings_between_saved_states_are_told():
    """The net swings in 1.3 s: states 0.1 s apart show that, those 3 s apart show a slow motion that is none."""
    run = simulate(four_cables(carried=True), 30.0, method="edmc", dt=0.01, save_every=0.1)
    seldom = simulate(four_cables(carried=True), 30.0, method="edmc", dt=0.01, save_every=3.0)
    assert "saved" not in verdict(run)
    assert verdict(seldom).endswith("; states are saved 3 s apart and do not show its swings, a smaller save_every does")
    assert words(plot_run(seldom))[0] == verdict(seldom)
    hanging = simulate(four_cables(), 30.0, method="edmc", dt=0.01, save_every=3.0)  # nothing moves but by rounding
    assert "saved" not in verdict(hanging)


@pytest.mark.filterwarnings("ignore::anet_lumped.motion.simulate.StabilityWarning")
@pytest.mark.parametrize(("method", "dt", "word"), [("midpoint", 0.01, "ENERGY GAINED"), ("verlet", 1e-3, "DIVERGED")])
def test_whatever_is_wrong_with_a_run_is_in_the_figure(method, dt, word):
    run = simulate(loose_cable(1e4), 2.0, method=method, dt=dt, start="straight")
    said, red = words(plot_run(run))
    assert red and said.startswith(f"{word} ({method}") and " ".join(run.message.split()[-3:]) in said


def test_a_figure_of_several_runs_is_marked_by_those_that_failed():
    good = simulate(four_cables(), 0.1, method="edmc", dt=0.01)
    bad = simulate(loose_cable(1e4), 0.6, method="edmc", dt=0.02, start="straight", audit=1e-3)
    figure = Figure()
    mark_failures(figure, good)
    assert words(figure) == ("", False)
    mark_failures(figure, good, bad)
    said, red = words(figure)
    assert red and said == verdict(bad)


def test_the_readmes_picture_is_of_runs_that_pass_their_audit(monkeypatch):
    audited = []

    def kept(*args, **kwargs):
        audited.append(simulate(*args, **kwargs))
        return audited[-1]

    monkeypatch.setattr(picture, "simulate", kept)
    assert words(picture.draw()) == ("", False)
    assert len(audited) == 3 and all(run.audit.passed for run in audited)
    monkeypatch.setattr(picture, "simulate", lambda *args, **kwargs: simulate(*args, **(kwargs | {"audit": 1e-6})))
    said, red = words(picture.draw())
    assert red and said.startswith("AUDIT FAILED")


@pytest.mark.parametrize(
    ("metres", "text"), [(0.2094, "209 mm"), (1.3e-4, "130 µm"), (2.5, "2.5 m"), (0.0, "0 nm"), (4.7e-10, "0.47 nm")]
)
def test_lengths(metres, text):
    assert as_length(metres) == text
