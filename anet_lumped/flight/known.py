"""Which quadrotor a body of a scene is. A scene file says of a body its mass and inertia, and by these a known one is found."""

import numpy as np

from anet_lumped.checks import InputError, quoted
from anet_lumped.scene.body import Body
from anet_lumped.scene.scene import Scene

from .quadrotor import CRAZYFLIE, THESIS_QUADROTOR, Quadrotor

KNOWN = {"that of the thesis": THESIS_QUADROTOR, "the Crazyflie": CRAZYFLIE}
"""Quadrotors whose rotors are known, by what they are called."""

SAME = 1e-6  # of mass and inertia


def known_quadrotor(body: Body) -> Quadrotor | None:
    """The known Quadrotor that has the mass and the inertia of a body, or None."""
    for one in KNOWN.values():
        close = body.mass is not None and abs(body.mass - one.mass) <= SAME * one.mass
        if close and np.abs(body.inertia_tensor - one.inertia_tensor).max() <= SAME * np.abs(one.inertia_tensor).max():
            return one
    return None


def known_quadrotors(scene: Scene) -> dict[str, Quadrotor]:
    """The known Quadrotor of each body that moves freely, by its name.

    Raises
    ------
    InputError : no body moves freely, or one that does is no known quadrotor
    """
    free = [body for body in scene.bodies if not body.is_driven]
    if not free:
        raise InputError("A flight needs a scene with quadrotors, but no body of this one moves freely.")
    found = {body.name: known_quadrotor(body) for body in free}
    for body in free:
        if found[body.name] is None:
            kinds = " and ".join(f"{name} ({one.mass:g} kg)" for name, one in KNOWN.items())
            raise InputError(
                f"Every body that moves freely must have the mass and inertia of a known quadrotor, {kinds}, but body "
                f"{quoted(body.name)} of {body.whole.total:g} kg has not; fly it from Python, with `quadrotors`."
            )
    return {name: one for name, one in found.items() if one is not None}
