"""What is raised where there is no rest, or none was found."""

from anet_lumped.results.run import State


class EquilibriumError(RuntimeError):
    """A scene that has no static shape, or whose static shape was not found.

    ``state`` is a rest that was found and is not stable, its ``stable`` False; None where there is none.
    """

    def __init__(self, message: str, state: State | None = None) -> None:
        super().__init__(message)
        self.state = state
