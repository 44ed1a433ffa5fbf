"""Newton iterations of the search for a rest grow with nothing."""

import pytest
from hanging import ENDS, STIFFNESSES, assorted, held_net, hung

from anet_lumped import Scene, equilibrium, nets, wind
from anet_lumped.effects import Gravity, Water
from anet_lumped.mechanics import newton_step
from anet_lumped.statics import hanging_chains


@pytest.fixture
def iterations(monkeypatch):
    """Newton iterations of every search, as they come."""
    counts = []

    def counted(*arguments, solve=hanging_chains.solve):
        result = solve(*arguments)
        counts.append(result[3])
        return result

    monkeypatch.setattr(hanging_chains, "solve", counted)
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


@pytest.mark.parametrize("current, most", [((0.3, 0.0, 0.0), 25), ((0.1, 0.3, 0.6), 150)])
def test_eliminations_of_a_net_in_a_current(monkeypatch, current, most):
    """The first current carries the net along by a third of its side; the second one lifts it, so that all of it turns over."""
    eliminations = []

    def counted(*arguments, direction=newton_step.direction):
        result = direction(*arguments)
        eliminations.append(result[0])
        return result

    monkeypatch.setattr(newton_step, "direction", counted)
    field = [(0, 0, -1), (3, 0, -1), (3, 3, -1), (0, 3, -1)]
    net = nets.grid((19, 19), field, cable={"mass_per_length": 0.01, "EA": 1e3, "diameter": 2e-3}, slack=0.02)
    rest = equilibrium(Scene(net.points, net.cables, [Gravity(), Water(current=wind.Uniform(current))]))
    assert rest.stable and sum(eliminations) <= most
