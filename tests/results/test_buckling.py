"""What buckling makes of errors, beside its closed form, and what runs say of it."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Scene, State, simulate
from anet_lumped.effects import Bending
from anet_lumped.model.build import build
from anet_lumped.results.amplification import amplification
from anet_lumped.results.buckling import TURNS, first_buckled
from anet_lumped.results.saved_motion import SEEN
from studies.catalogue.random_motions import random_motion

ASIDE, L, APART, EA, MU = 1e-6, 1.1, 1.0, 100.0, 0.1


def pushed(length=L, effects=(), EI=1.0, aside=ASIDE):
    """Two segments between supports that are closer than they are long, and the node between them a little aside [m]."""
    cable = Cable("a", "b", length=length, mass_per_length=MU, EA=EA, segments=2, compression="linear", diameter=0.01, EI=EI)
    scene = Scene([Fixed("a", (0.0, 0.0, 0.0)), Fixed("b", (APART, 0.0, 0.0))], [cable], list(effects))
    model = build(scene)
    q = np.zeros((model.n, 3))
    q[model.nodes("a-b")] = [(0.0, 0.0, 0.0), (0.5 * APART, 0.0, aside), (APART, 0.0, 0.0)]
    return scene, State(model, 0.0, q, np.zeros_like(q), np.zeros(model.n_segments))


def test_a_node_between_two_segments_that_push():
    """x = x_0 cosh(rate t) with rate^2 = 2 T/(l m), and twice x_0 by exp(rate t) at ln 2/rate; states are 1 ms apart."""
    scene, start = pushed()
    T, l, m = EA * (1.0 - APART / L), 0.5 * APART, MU * L / 2.0
    rate = math.sqrt(2.0 * T / (l * m))
    run = simulate(scene, 5.0 / rate, method="edmc", dt=1e-4, save_every=1e-3, start=start)
    x = run.shape("a-b")[:, 1, 2]
    np.testing.assert_allclose(x, ASIDE * np.cosh(rate * run.t), rtol=1e-4)  # (rate h)^2/12 of its phase
    since = first_buckled(run)
    assert abs(since - math.log(TURNS) / rate) <= 1e-3


@pytest.mark.parametrize("aside", [ASIDE, 1e-4])
def test_what_pushes_multiplies_errors_across_it(aside):
    """By exp(rate t) with the rate above; of a micrometre so little is left out that it is seen only as it will have grown."""
    scene, start = pushed(aside=aside)
    rate = math.sqrt(2.0 * EA * (1.0 - APART / L) / (0.5 * APART) / (MU * L / 2.0))
    run = simulate(scene, 6.0 / rate, method="edmc", dt=2e-3, save_every=2e-3, start=start)
    grown = amplification(run)
    middle = (grown > 1.0) & (run.t < 5.5 / rate)  # the largest of some rows looks ahead, and ends with the run
    assert np.polyfit(run.t[middle], grown[middle], 1)[0] == pytest.approx(rate, rel=0.01)
    assert run.multiplies > 1.0 or run.error_estimate > run.error_growth[-1]


def test_nothing_is_multiplied_on_a_straight_line():
    """Two segments that push along a line keep to it to the last digit; the run warns of what they may do."""
    scene, start = pushed(aside=0.0)
    start.v[start.model.nodes("a-b")[1], 0] = 0.1
    run = simulate(scene, 0.5, method="edmc", dt=2e-3, save_every=2e-3, start=start)
    assert run.error_growth[-1] > SEEN * scene.longest
    assert not amplification(run).any()
    assert first_buckled(run) is not None


def test_what_pulls_or_bends_does_not_buckle():
    assert first_buckled(simulate(pushed(0.9)[0], 0.2, method="edmc", dt=1e-3, start=pushed(0.9)[1])) is None
    scene, start = pushed(effects=[Bending()], EI=2.0)
    run = simulate(scene, 0.2, method="edmc", dt=1e-3, start=start)
    assert (run.segment_tension < 0.0).any() and first_buckled(run) is None


def test_what_bends_buckles_beyond_its_load():
    """Bending holds the node between two segments with 4 EI/(L0 l^2), l apart: rate^2 = (2 T/l - 4 EI/(L0 l^2))/m.

    Waves of a cable that is cut as coarsely as this tell the rate to some per cent.
    """
    EI, T, l, L0 = 0.5, EA * (1.0 - APART / L), 0.5 * APART, L / 2.0
    scene, start = pushed(effects=[Bending()], EI=EI)
    rate = math.sqrt((2.0 * T / l - 4.0 * EI / (L0 * l**2)) / (MU * L0))
    run = simulate(scene, 5.0 / rate, method="edmc", dt=1e-4, save_every=1e-3, start=start)
    np.testing.assert_allclose(run.shape("a-b")[:, 1, 2], ASIDE * np.cosh(rate * run.t), rtol=1e-3)  # 1e-4 without bending
    assert abs(first_buckled(run) * rate / math.log(TURNS) - 1.0) < 0.1


def test_a_run_at_a_given_step_says_so():
    scene, start = pushed()
    run = simulate(scene, 1.0, method="edmc", dt=4e-3, start=start)
    assert run.multiplies > TURNS
    (text,) = run.warnings
    assert f"cables that push buckle from t={first_buckled(run):.4g} s on, and such a motion may multiply errors" in text
    assert "those of places may be as large as the way of a node" in text  # exp(25) of its errors


def test_a_chain_whose_end_turns_loosely_says_so():
    """Past a whip its last segment pushes a little and turns about the node before it: of 82 mm a run tells 7."""
    motion = random_motion(135)
    every = motion.t_end / 200
    run, fine = (
        simulate(motion.scene, motion.t_end, method="edmc", start=motion.start, dt=every / n, save_every=every) for n in (1, 32)
    )
    off = np.linalg.norm(run.q - fine.q, axis=2).max()
    assert off > 5.0 * run.error_estimate and 1.0 < off / run.error_estimate < run.multiplies
    assert any("cables that push buckle" in text for text in run.warnings)
