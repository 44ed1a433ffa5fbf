"""What a user asks for by a name: the version, what there is, and what was meant by a name that is not quite right."""

import importlib.metadata

import pytest

import anet_lumped
from anet_lumped import Cable, Fixed, Free, Scene, SceneError, effects
from anet_lumped.checks import nearest
from studies.command_line import main


def test_version(capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["--version"])
    assert stopped.value.code == 0
    assert capsys.readouterr().out.strip() == anet_lumped.__version__ == importlib.metadata.version("anet-lumped")


def test_what_the_package_offers_is_listed():
    assert set(effects.__all__) <= set(dir(effects)) and set(anet_lumped.__all__) <= set(dir(anet_lumped))


@pytest.mark.parametrize(
    ("asked", "known", "meant"),
    [
        ("p0-s0", ("s0-p0", "s1-p0"), ', did you mean "s0-p0"?'),
        ("Cd", ("Cdn", "Cdt", "EA"), ', did you mean "Cdn" or "Cdt"?'),
        ("Ea", ("EA", "EI"), ', did you mean "EA"?'),
        ("xyz", ("EA", "EI"), ""),
    ],
)
def test_suggestions(asked, known, meant):
    assert nearest(asked, known) == meant


def test_an_effect_without_brackets_and_a_cable_from_its_other_end():
    points, cables = [Fixed("a", (0, 0, 0)), Free("b")], [Cable("a", "b", length=1, mass_per_length=0.1, EA=1e3, segments=2)]
    with pytest.raises(SceneError, match=r"must hold effects, such as Gravity\(\.\.\.\), but holds the class Gravity"):
        Scene(points, cables, [effects.Gravity])
    with pytest.raises(SceneError, match='no cable "b-a", did you mean "a-b"'):
        Scene(points, cables).cable("b-a")
