"""The error for a scene that has no rest, or whose rest was not found."""

from anet_lumped.checks import SceneError
from anet_lumped.results.state import State


class EquilibriumError(RuntimeError):
    """A scene that has no static shape, or whose static shape was not found.

    ``state`` is a rest that was found although it is not stable, with ``stable`` False; None if none was found.
    """

    def __init__(self, message: str, state: State | None = None) -> None:
        super().__init__(message)
        self.state = state


class NoRestError(EquilibriumError, SceneError):
    """A scene that cannot have a static shape, for a reason that is known.

    Nothing holds a part of it, nothing loads a cable that is slack, a cable would have to push, one that does not stretch does not
    reach, a support is under the ground, or a law is not finite. Such a scene is a wrong input, and can be put right. Where a
    search finds no rest, the scene may have one: an EquilibriumError that is no SceneError.
    """
