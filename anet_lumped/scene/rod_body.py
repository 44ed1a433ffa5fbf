"""A body that is one rod: a spar, a pole, a log."""

from typing import Any

import numpy as np

from anet_lumped.checks import SceneError, Vector, check_vector, quoted

from .body import Body
from .rod import Rod


def rod_body(
    name: str, start: Vector, end: Vector, *, pinned: str | None = None, pinned_to: str | None = None, **of_rod: Any
) -> Body:
    """A body that is one rod with its mass, at whose ends "name.a" and "name.b" cables are tied.

    Its origin is at the start, and its third axis runs along the rod.

    Parameters
    ----------
    name : name of the body
    start, end : (3,) array_like [m], where its ends start
    pinned : "a" or "b" for an end that stays where it is, None for a free rod
    pinned_to : point at which that end stays, "platform.hinge" of another body, or a driven or fixed point; it must start there
    of_rod : `diameter`, `mass_per_length`, `segments` and the coefficients of a `Rod`

    Raises
    ------
    SceneError : as of `Rod` and `Body`
    """
    owner = f"rod {quoted(name)}"
    start, end = check_vector("start", start, "m", owner), check_vector("end", end, "m", owner)
    along = np.subtract(end, start)
    length = float(np.linalg.norm(along))
    if not length > 0.0:
        raise SceneError(f"A rod must have a length, but {owner} starts and ends at {start} m.")
    across = np.array([-along[1], along[0], 0.0])  # the third axis turns about it towards the rod
    sine = float(np.linalg.norm(across))
    axis = across / sine if sine > 0.0 else np.array([1.0, 0.0, 0.0])
    turn = axis * np.arctan2(sine, along[2])
    top = (0.0, 0.0, length)
    rod = Rod("rod", (0.0, 0.0, 0.0), top, **of_rod)
    ends = {"a": (0.0, 0.0, 0.0), "b": top}
    return Body(name, at=start, rotation=tuple(turn.tolist()), attachments=ends, rods=[rod], pinned=pinned, pinned_to=pinned_to)
