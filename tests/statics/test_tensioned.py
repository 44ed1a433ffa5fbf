"""Lengths for what is wanted at rest, against the catenary y = a cosh(x/a) and by looking at the rest again."""

import json

import numpy as np
import pytest
from hanging import MU, G, held_net, hung

from anet_lumped import Cable, EquilibriumError, Fixed, Free, Scene, equilibrium, tensioned
from anet_lumped.checks import InputError
from anet_lumped.results.sag import sag
from studies.command_line import main

A, HALF = 1.0, 0.6
LENGTH, SAG = 2.0 * A * np.sinh(HALF / A), A * (np.cosh(HALF / A) - 1.0)
TENSION = MU * G * A * np.cosh(HALF / A)


def rope(length, segments=40, EA=1e7):
    return hung((2.0 * HALF, 0, 0), length=length, EA=EA, segments=segments)


@pytest.mark.parametrize("begin", [0.9 * LENGTH, 1.5 * LENGTH])
@pytest.mark.parametrize("wanted", [{"sag": SAG}, {"lowest": -SAG}, {"end_tension": TENSION}, {"end_tension": TENSION, "at": "a"}])
def test_the_length_of_a_catenary(wanted, begin):
    """40 segments: the sag is off by 40^-2, and so is the length for it; the rest has what is wanted to rounding."""
    found = tensioned(rope(begin), "a-b", **wanted)
    assert found.cables[0].length == pytest.approx(LENGTH, rel=1e-3)
    rest = equilibrium(found)
    has = {"sag": sag(rest, "a-b"), "lowest": rest.shape("a-b")[:, 2].min(), "end_tension": rest.end_tension("a-b", "b")}
    for name in set(wanted) - {"at"}:
        assert has[name] == pytest.approx(wanted[name], rel=1e-9)


def test_of_two_lengths_that_have_a_tension_the_shorter_is_found():
    """From a long rope, whose weight makes the tension at its end: 3 m of it in each half."""
    found = tensioned(rope(8.0), "a-b", end_tension=2.0 * MU * G)
    assert 1.2 < found.cables[0].length < 1.3
    assert equilibrium(found).end_tension("a-b", "b") == pytest.approx(2.0 * MU * G, rel=1e-9)


def test_a_cable_that_does_not_stretch_is_brought_near_its_chord():
    found = tensioned(rope(1.4, EA=np.inf), "a-b", sag=0.01)
    assert found.cables[0].length == pytest.approx(1.2 + 8.0 / 3.0 * 0.01**2 / 1.2, rel=1e-6)  # the parabola


def test_one_cable_of_a_net():
    found = tensioned(held_net(), "s0-p0", lowest=-0.7)
    assert equilibrium(found).shape("s0-p0")[:, 2].min() == pytest.approx(-0.7, abs=1e-9)
    assert found.cables[0].length > 1.0 and found.cables[1:] == held_net().cables[1:]


def test_what_no_length_has_is_said_with_the_nearest():
    """The least tension over all lengths: T = mu g a cosh(b/a) is least at b/a tanh(b/a) = 1, b/a = 1.19968."""
    least = MU * G * HALF / 1.19968 * np.cosh(1.19968)
    with pytest.raises(
        EquilibriumError, match=r'No length of cable "a-b" has end_tension=0.5 N at rest: the nearest found is'
    ) as said:
        tensioned(rope(LENGTH), "a-b", end_tension=0.5)
    nearest = float(str(said.value).split("is ")[1].split(" N")[0])
    assert nearest == pytest.approx(least, rel=2e-3)
    with pytest.raises(EquilibriumError, match=r'No length of cable "a-b" has lowest=1 m at rest: the nearest found is'):
        tensioned(rope(LENGTH, segments=4), "a-b", lowest=1.0)


@pytest.mark.parametrize(
    "wanted, message",
    [
        ({}, r'must be wanted of cable "a-b", but none is given'),
        ({"sag": 1.0, "lowest": 1.0}, r'must be wanted of cable "a-b", but sag and lowest is given'),
        ({"sag": -1.0}, r'Argument `sag` must be positive and finite \[m\], but `tensioned` for cable "a-b" has sag=-1.0'),
        ({"end_tension": 1.0, "at": "c"}, r'is wanted, "a" or "b", but it is "c" for end_tension'),
    ],
)
def test_what_cannot_be_wanted_is_refused(wanted, message):
    with pytest.raises(InputError, match=message):
        tensioned(rope(LENGTH), "a-b", **wanted)


def test_a_sag_needs_gravity():
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=4)
    scene = Scene([Fixed("a", (0, 0, 0)), Free("b")], [cable])
    with pytest.raises(InputError, match=r'A sag is measured along gravity, but the scene of cable "a-b" has none'):
        tensioned(scene, "a-b", sag=0.1)


def test_the_command_line_wants_lengths(capsys):
    with pytest.raises(SystemExit) as left:
        main(["equilibrium", "net_held", "--set", "s0-p0.length=tension:1.5N@s0", "--set", "p0.mass=0.05", "--json"])
    assert not left.value.code
    assert json.loads(capsys.readouterr().out)["cables"][0]["start_tension"] == pytest.approx(1.5, rel=1e-9)
    with pytest.raises(SystemExit) as left:
        main(["equilibrium", "net_held", "--set", "s0-p0.length=sag:1m@s0"])
    assert left.value.code == 2
    assert 'Only a tension is wanted at a point, but "s0-p0.length=sag:1m@s0" wants a sag there' in capsys.readouterr().err
