"""Flights of scenes: where what is carried shall go, by which controller, and for how long; those of the bundled scenes by name."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, check_number, check_vector, nearest, quoted
from anet_lumped.prescribed import paths
from anet_lumped.prescribed.paths import Path
from anet_lumped.scene.scene import Scene
from anet_lumped.statics.equilibrium import equilibrium
from anet_lumped.statics.held_bodies import with_bodies_held

from .admittance import Admittance
from .geometric import Wrench, follow, geometric
from .hovering import hovering
from .known import known_quadrotors
from .net_guide import NetGuide
from .seen import Seen

Controller = Callable[[Seen], Wrench]
HOLD, NET, ADMITTANCE, PREDICTIVE = "hold", "net", "admittance", "predictive"


@dataclass(frozen=True)
class Scenario:
    """A flight of a scene.

    Parameters
    ----------
    controller : name of one of `CONTROLLERS`
    t_end : float [s]
    stops : sequence of (t, (x, y, z)) [s], [m]
        When the flight rests and how far from its start: between two stops it goes smoothly, with no jump of the acceleration.
        None: it stays.
    rate : float [1/s], of `NetGuide`
    """

    controller: str
    t_end: float
    stops: Sequence[tuple[float, Sequence[float]]] = ()
    rate: float = 0.5


SCENARIOS = {
    "quadrotor_hover": Scenario(HOLD, 4.0),
    "quadrotors_net": Scenario(NET, 7.0, [(0.0, (0, 0, 0)), (4.0, (0, 10, 0))]),  # at up to 4.7 m/s
    "quadrotors_gust": Scenario(NET, 8.0, rate=1.0),
    "quadrotors_break": Scenario(HOLD, 6.0),
    "quadrotors_scoop": Scenario(
        NET, 12.0, [(1.0, (0, 0, 0)), (4.0, (0, 0, -0.6)), (6.0, (0, 0, -0.6)), (9.0, (0, 0, 0))], rate=1.0
    ),
}
"""Flights of the scenes that come with this, by their names."""


def scenario_of(
    scene: Scene, name: str, *, controller: str | None = None, t_end: float | None = None,
    by: Sequence[float] | None = None, within: float = 4.0,
) -> Scenario:  # fmt: skip
    """The flight of a scene: that of the bundled scene of this name, if there is one, changed as asked.

    Parameters
    ----------
    scene : Scene
    name : str, name of a bundled scene, or anything else
    controller : name of one of `CONTROLLERS`, or None; of a scene without a flight of its own "net" where several quadrotors carry
        what `carried_point` finds, else "hold"
    t_end : float or None [s]
    by : (3,) or None [m], how far to go from where the scene starts, in place of the stops
    within : float [s], time in which to go there

    Raises
    ------
    InputError : no `t_end` for a scene without a flight of its own, or a number out of its range
    """
    own = SCENARIOS.get(name)
    if own is None and t_end is None:
        raise InputError(f"A flight needs a `t_end` [s], but {quoted(name)} has no flight of its own and none is given.")
    if own is None:
        several = sum(not body.is_driven for body in scene.bodies) > 1 and len(scene.free_points) > 0
        own = Scenario(NET if several else HOLD, 0.0)
    found = replace(own, controller=controller or own.controller, t_end=own.t_end if t_end is None else t_end)
    if by is None:
        return found
    shift, within = check_vector("by", by, "m", "a flight"), check_number("within", within, "s", "a flight", sign="positive")
    return replace(found, stops=[(0.0, (0.0, 0.0, 0.0)), (within, shift)])


def way_from(start: Any, stops: Sequence[tuple[float, Sequence[float]]]) -> Path:
    """The path that starts at a place (3,) [m] and rests at the stops of a `Scenario`."""
    if len(stops) == 0:
        return paths.line(np.asarray(start, float).tolist(), (0.0, 0.0, 0.0), 0.0)
    times, shifts = [t for t, _ in stops], np.array([shift for _, shift in stops], float)
    places, still = (np.asarray(start, float) + shifts).tolist(), np.zeros_like(shifts).tolist()
    return paths.states(times, places, still, still)


def carried_point(scene: Scene) -> str:
    """The name of the free point that is carried: the only one, or "p0" where there are several.

    Raises
    ------
    InputError : no free point, or several of which none is "p0"
    """
    names = [point.name for point in scene.free_points]
    if len(names) == 1 or "p0" in names:
        return "p0" if "p0" in names else names[0]
    told = f"has {', '.join(map(quoted, names))}" if names else "has none"
    raise InputError(f'What is carried must be the only free point of a scene, or "p0", but the scene {told}.')


def point_at_hover(scene: Scene, point: str) -> np.ndarray:
    """(3,) place [m] of a free point where the quadrotors of a scene hover at their starts."""
    return equilibrium(with_bodies_held(hovering(scene).scene)).position(point)


def _hold(scene: Scene, scenario: Scenario) -> Controller:
    """Each quadrotor keeps its place, moved by the stops."""
    crew = known_quadrotors(scene)
    return geometric(list(crew.values()), _guide(scene, scenario))


def _guide(scene: Scene, scenario: Scenario) -> Any:
    return follow([way_from(body.at, scenario.stops) for body in scene.bodies if not body.is_driven])


def _net(scene: Scene, scenario: Scenario) -> Controller:
    """p0 keeps its place, moved by the stops, and the quadrotors theirs about it."""
    crew, point = known_quadrotors(scene), carried_point(scene)
    way = way_from(point_at_hover(scene, point), scenario.stops)
    return geometric(list(crew.values()), NetGuide(scene, way, point=point, rate=scenario.rate))


def _admittance(scene: Scene, scenario: Scenario) -> Controller:
    """As "hold", but quadrotors give way to pulls other than that of the net at rest."""
    crew = known_quadrotors(scene)
    return geometric(list(crew.values()), Admittance(_guide(scene, scenario), hovering(scene).force))


def _predictive(scene: Scene, scenario: Scenario) -> Controller:
    """The load keeps its place, moved by the stops, by model-predictive control of its one quadrotor."""
    from .predictive import predictive  # which alone needs casadi

    crew = list(known_quadrotors(scene).values())
    return predictive(scene, way_from(point_at_hover(scene, carried_point(scene)), scenario.stops), quadrotor=crew[0])


CONTROLLERS: dict[str, Callable[[Scene, Scenario], Controller]] = {
    HOLD: _hold, NET: _net, ADMITTANCE: _admittance, PREDICTIVE: _predictive,
}  # fmt: skip
"""How a controller of a scene is made, by name."""


def controller_for(scene: Scene, scenario: Scenario) -> Controller:
    """The controller of a scenario.

    Raises
    ------
    InputError : an unknown name, or a scene that the controller cannot fly
    """
    if scenario.controller not in CONTROLLERS:
        known = nearest(scenario.controller, CONTROLLERS) or f"; known are {', '.join(CONTROLLERS)}."
        raise InputError(f"There is no controller {quoted(scenario.controller)}{known}")
    return CONTROLLERS[scenario.controller](scene, scenario)
