"""What `equilibrium` and `simulate` start from: the same words, and the same checks."""

import dataclasses

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, InputError, Scene, equilibrium, simulate
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
    name, at = next(iter(where.items()))
    if name == "t":
        return changed(t=at)
    numbers = getattr(equilibrium(scene()), name).copy()
    numbers[at] = np.inf
    return changed(**{name: numbers})


def changed(**fields):
    """The rest of the scene with fields of a user's own."""
    return dataclasses.replace(equilibrium(scene()), **fields)


@pytest.mark.parametrize("asked", ASKED)
@pytest.mark.parametrize(
    ("start", "message"),
    [
        (
            lambda: "rest",
            '`start` must be "equilibrium", "calm", "straight" or a State, but it is \'rest\'; the shape of each cable',
        ),
        (lambda: with_nan(v=(2, 0)), r'must be finite, but the velocity of node 3 of 5 of cable "a-b" is \(inf, 0, 0\)'),
        (lambda: with_nan(q=(4, 2)), r'must be finite, but the position of point "b" is \(0, 0, inf\)'),
        (lambda: with_nan(segment_tension=1), 'must have finite tensions, but a segment of cable "a-b" has inf N'),
        (lambda: with_nan(t=np.nan), r"must have a finite time \[s\], but it has t=nan"),
        (lambda: with_nan(t="now"), r"must have a finite time \[s\], but it has t='now'"),
        (lambda: changed(q=np.zeros((50, 3))), r"`q` .* must have the shape \(6, 3\), because its scene has 6 nodes, .* \(50, 3\)"),
        (lambda: changed(v=None), r"`v` of a State must have the shape \(6, 3\)"),
        (lambda: changed(q="abc"), "`q` of a State must be an array of numbers, but it is 'abc'"),
        (lambda: changed(q=[[1, 2, 3], [4]]), "`q` of a State must be an array of numbers"),
        (lambda: changed(q=np.full((6, 3), 1j)), "`q` of a State must be an array of numbers"),
        (lambda: changed(q=[[10**400] * 3] * 6), "`q` of a State must be an array of numbers"),
        (lambda: changed(segment_tension=[1.0]), r"`segment_tension` .* \(5,\), because its scene has 5 segments, .* \(1,\)"),
        (lambda: changed(model=None), "`model` of a State must be that of a scene, but it is None"),
        (lambda: np.zeros((6, 3)), '`start` must be "equilibrium", "calm", "straight" or a State'),
        (lambda: {"a-b": "abc"}, 'The shape of cable "a-b" must be an array of numbers'),
        (lambda: {"a-c": np.zeros((6, 3))}, 'must be of a cable of the scene, but "a-c" is none.*"a-b"'),
        (lambda: {}, 'must be given for every cable, but cable "a-b" has none'),
        (lambda: {"a-b": np.zeros((5, 3))}, r"must have the places of its 6 nodes, \(6, 3\), but it is \(5, 3\)"),
        (lambda: {"a-b": np.full((6, 3), np.nan)}, r'the position of node 0 of cable "a-b" is \(nan, nan, nan\)'),
    ],
)
def test_what_is_no_start_is_refused(asked, start, message):
    with pytest.raises(ValueError, match=message):
        ASKED[asked](start())


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (5e5, 5e6, 0.0)])
def test_a_state_of_other_rows_is_refused_wherever_the_scene_is(at):
    moved = dataclasses.replace(scene(), points=[Fixed("a", at), Free("b")])
    for rows in (np.zeros((50, 3)), "abc", [[10**400] * 3] * 6):
        with pytest.raises(InputError, match="`q` of a State must"):
            simulate(moved, 0.01, start=dataclasses.replace(equilibrium(moved), q=rows))


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
