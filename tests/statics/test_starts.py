"""What `equilibrium` and `simulate` start from: the same words, and the same checks."""

import dataclasses

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, equilibrium, simulate
from anet_lumped.effects import Gravity


def scene():
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=5)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", at=(0.6, 0, -0.8))], [cable], [Gravity()])


ASKED = {
    "equilibrium": lambda start: equilibrium(scene(), start=start),
    "simulate": lambda start: simulate(scene(), 0.01, start=start),
}


def with_nan(**where):
    """The rest of the scene with a number that is none."""
    rest = equilibrium(scene())
    name, at = next(iter(where.items()))
    if name == "t":
        return dataclasses.replace(rest, t=at)
    numbers = getattr(rest, name).copy()
    numbers[at] = np.inf
    return dataclasses.replace(rest, **{name: numbers})


@pytest.mark.parametrize("asked", ASKED)
@pytest.mark.parametrize(
    ("start", "message"),
    [
        (lambda: "rest", '`start` must be "equilibrium", "straight" or a State, but it is \'rest\'; the shape of each cable'),
        (lambda: with_nan(v=(2, 0)), r'must be finite, but the velocity of node 3 of 5 of cable "a-b" is \(inf, 0, 0\)'),
        (lambda: with_nan(q=(4, 2)), r'must be finite, but the position of point "b" is \(0, 0, inf\)'),
        (lambda: with_nan(segment_tension=1), 'must have finite tensions, but a segment of cable "a-b" has inf N'),
        (lambda: with_nan(t=np.nan), "must have a finite time, but it has t=nan s"),
        (lambda: {"a-c": np.zeros((6, 3))}, 'must be of a cable of the scene, but "a-c" is none.*"a-b"'),
        (lambda: {}, 'must be given for every cable, but cable "a-b" has none'),
        (lambda: {"a-b": np.zeros((5, 3))}, r"must have the places of its 6 nodes, \(6, 3\), but it is \(5, 3\)"),
        (lambda: {"a-b": np.full((6, 3), np.nan)}, r'the position of node 0 of cable "a-b" is \(nan, nan, nan\)'),
    ],
)
def test_what_is_no_start_is_refused(asked, start, message):
    with pytest.raises(ValueError, match=message):
        ASKED[asked](start())


def test_shapes_are_a_start_of_a_run():
    shape = np.linspace((0, 0, 0), (0.8, 0, -0.6), 6)
    run = simulate(scene(), 0.01, start={"a-b": shape})
    assert run.ok and np.array_equal(run.shape("a-b")[0], shape)  # as given
    assert np.array_equal(run.q[0], simulate(scene(), 0.01, start=run.state(0)).q[0])


def test_prescribed_points_are_where_the_scene_has_them():
    shape = np.linspace((0.1, 0, 0), (0.8, 0, -0.6), 6)
    assert np.array_equal(simulate(scene(), 0.01, start={"a-b": shape}).position("a")[0], (0, 0, 0))


@pytest.mark.parametrize("start", [None, "equilibrium", "straight"])
def test_dead_loads_have_one_rest_whatever_the_guess(start):
    state = equilibrium(scene(), start=start)
    assert np.array_equal(state.q, equilibrium(scene()).q) and state.stable is True


def test_states_of_a_run_are_not_judged():
    assert simulate(scene(), 0.01).final.stable is None
