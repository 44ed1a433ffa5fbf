"""The state that a motion begins from: a rest, a line between the points, or what a user gives."""

from dataclasses import replace

from anet_lumped.model.build import build
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Scene

from .equilibrium import calm, equilibrium, spread
from .starts import Start, start_state


def first_state(scene: Scene, start: Start, straight_between: bool = False) -> State:
    """Return the state that a ``start``, as `simulate` takes it, means.

    Parameters
    ----------
    scene : Scene
    start : "equilibrium", "calm", "straight", State or dict
        "calm" is the rest without turbulence and waves, which then set in at once.
    straight_between : bool, see `starts.start_state`

    Raises
    ------
    EquilibriumError : no rest
    InputError : see `starts.start_state`
    """
    if isinstance(start, str) and start == "equilibrium":
        return equilibrium(scene)
    if isinstance(start, str) and start == "calm":
        return replace(equilibrium(calm(scene)), model=build(scene), residual=None, stable=None)
    if scene.releases and not isinstance(start, State):
        return spread(scene, lambda held: start_state(build(held), start, straight_between))
    return start_state(build(scene), start, straight_between)
