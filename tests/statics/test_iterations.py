"""Newton iterations of the search for a rest grow with nothing."""

import pytest
from hanging import ENDS, STIFFNESSES, assorted, held_net, hung

from anet_lumped import Scene, equilibrium, nets, wind
from anet_lumped.effects import Gravity, Water
from anet_lumped.mechanics import newton_step
from anet_lumped.statics import hanging_chains


def counts_of(monkeypatch, module, name, entry):
    """What a function of a module returns in an entry of its result, call by call, as they come."""
    counts, original = [], getattr(module, name)

    def counted(*arguments):
        result = original(*arguments)
        counts.append(result[entry])
        return result

    monkeypatch.setattr(module, name, counted)
    return counts


@pytest.fixture
def iterations(monkeypatch):
    """Newton iterations of every search, as they come."""
    return counts_of(monkeypatch, hanging_chains, "solve", 3)


@pytest.mark.parametrize("EA", [1.0, 1e4, 1e9])
@pytest.mark.parametrize("segments", [5, 20, 200, 2000])
def test_iterations_do_not_grow_with_segments_or_stiffness(iterations, EA, segments):
    equilibrium(held_net(EA=EA, segments=segments))
    assert iterations[0] <= 10


@pytest.mark.each_once
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


@pytest.mark.parametrize(
    "squares, current, most", [(19, (0.3, 0.0, 0.0), 25), (29, (0.3, 0.0, 0.0), 40), (19, (0.1, 0.3, 0.6), 150)]
)
def test_eliminations_of_a_net_in_a_current(monkeypatch, squares, current, most):
    """The first current carries the net along by a third of its side; the second one lifts it, so that all of it turns over."""
    eliminations = counts_of(monkeypatch, newton_step, "direction", 0)
    field = [(0, 0, -1), (3, 0, -1), (3, 3, -1), (0, 3, -1)]
    net = nets.grid((squares, squares), field, cable={"mass_per_length": 0.01, "EA": 1e3, "diameter": 2e-3}, slack=0.02)
    rest = equilibrium(Scene(net.points, net.cables, [Gravity(), Water(current=wind.Uniform(current))]))
    assert rest.stable and sum(eliminations) <= most
