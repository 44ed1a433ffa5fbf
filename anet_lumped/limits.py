"""How much one call may take: more of it is refused before anything is computed, and a variable of the environment allows it.

A count that nobody can mean, a step of 1e-300 s or 1e12 segments, would otherwise run until it is killed, or out of memory.
"""

import math
import os
from typing import NamedTuple

from anet_lumped.checks import InputError, shown


class Limit(NamedTuple):
    """The most of something that one call may take, and the variable of the environment that sets another number."""

    what: str
    most: float
    variable: str


STEPS = Limit("steps", 1e8, "ANET_LUMPED_MOST_STEPS")
BYTES = Limit("bytes of memory", 1e9, "ANET_LUMPED_MOST_BYTES")
TEXT = Limit("bytes of text", 4e6, "ANET_LUMPED_MOST_TEXT")
ROWS = Limit("rows", 1e6, "ANET_LUMPED_MOST_ROWS")


def check_most(limit: Limit, number: float, of: str) -> None:
    """Refuse what would take more than a limit.

    Parameters
    ----------
    limit : Limit
    number : float
        How many of it this would take.
    of : str
        What takes them, for the message: "A run of 1 s with dt=1e-300 s".

    Raises
    ------
    InputError : it is more than the limit, or the environment sets the limit to what is no positive number
    """
    most = most_of(limit)
    if not number <= most:
        raise InputError(
            f"{of} would take {min(number, 1e308):.3g} {limit.what}, but must not take more than {most:.3g}; "
            f"the environment variable {limit.variable} sets another limit."
        )


def most_of(limit: Limit) -> float:
    """The number that a limit is set to.

    Raises
    ------
    InputError : the environment sets it to what is no positive number
    """
    given = os.environ.get(limit.variable)
    if not given:
        return limit.most
    try:
        most = float(given)
    except ValueError:
        most = math.nan
    if not most > 0:
        raise InputError(f"The environment variable {limit.variable} must be a positive number, but is {shown(given)}.")
    return most
