"""Newton iterations of the search for a rest grow with nothing."""

import sys

import pytest
from hanging import ENDS, STIFFNESSES, assorted, held_net, hung

from anet_lumped import equilibrium


@pytest.fixture
def iterations(monkeypatch):
    """Newton iterations of every search, as they come."""
    module, counts = sys.modules["anet_lumped.statics.hanging_chains"], []

    def counted(*arguments, solve=module.solve):
        result = solve(*arguments)
        counts.append(result[3])
        return result

    monkeypatch.setattr(module, "solve", counted)
    return counts


@pytest.mark.parametrize("EA", [1.0, 1e4, 1e9])
@pytest.mark.parametrize("segments", [5, 20, 200, 2000])
def test_iterations_do_not_grow_with_segments_or_stiffness(iterations, EA, segments):
    equilibrium(held_net(EA=EA, segments=segments))
    assert iterations[0] <= 10


@pytest.mark.parametrize("EA", STIFFNESSES)
@pytest.mark.parametrize("name", assorted(1.0))
def test_iterations_of_nets(iterations, name, EA):
    """A slack cable costs a few for each rounding of its kink."""
    equilibrium(assorted(EA)[name])
    assert iterations[0] <= 40


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("EA", STIFFNESSES)
def test_iterations_of_one_cable(iterations, end, EA):
    equilibrium(hung(ENDS[end], EA=EA, segments=20))
    assert iterations[0] <= 40
