"""What a session keeps to go back to, and how it says that a step failed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, shown
from anet_lumped.results.events import Event


class SessionError(RuntimeError):
    """A step that failed; the session stands where it failed, and may be restored to what was saved before.

    Parameters
    ----------
    status : as of a `Run`
    message : str
    """

    def __init__(self, status: str, message: str) -> None:
        super().__init__(message)
        self.status = status


@dataclass(frozen=True, eq=False)
class Mark:
    """What `Session.save` has kept; only `Session.restore` of the same session reads it."""

    session: int
    t: float
    steps: int
    structure: tuple
    legs: tuple[np.ndarray, ...]
    forces: tuple[np.ndarray, ...]
    arrays: tuple[np.ndarray, ...]
    events: tuple[Event, ...]
    due: tuple[float, ...]


def check_mark(mark: Any, session: Any) -> None:
    """Refuse what is no mark of a session."""
    if not isinstance(mark, Mark) or mark.session != id(session):
        raise InputError(f"Argument `mark` must be what `save` of the same session returned, but it is {shown(mark)}.")


def arrays_of_legs(legs: Any) -> tuple[np.ndarray, ...]:
    """What the legs hold of the state."""
    inner = (array for array in (legs.crept, legs.shedding) if array is not None)
    return legs.q, legs.v, legs.tension, legs.carried, *inner


def own_arrays(value: Any, model: Any) -> list[np.ndarray]:
    """Arrays in a nested tuple that no model holds."""
    held = {id(array) for array in _flat(tuple(vars(model).values()))}
    return [array for array in _flat(value) if array.size and id(array) not in held]


def _flat(value: Any) -> Iterator[np.ndarray]:
    """The arrays in a nested tuple."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _flat(part)
