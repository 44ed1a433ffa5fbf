"""The error for a scene that has no rest, or whose rest was not found."""

from anet_lumped.results.run import State


class EquilibriumError(RuntimeError):
    """A scene that has no static shape, or whose static shape was not found.

    ``state`` is a rest that was found although it is not stable, with ``stable`` False; None if none was found.
    """

    def __init__(self, message: str, state: State | None = None) -> None:
        super().__init__(message)
        self.state = state
