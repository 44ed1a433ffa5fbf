"""A flight that nothing holds up: quadrotors without thrust, or with a load that is too heavy, fall."""

from typing import Any

import numpy as np

FREE = 0.5  # of gravity: quadrotors that sink faster from the start on are not flown, they fall
FAST = 1.0  # [m/s]


def fallen(run: Any) -> str:
    """Warning that the quadrotors of a flight fall; "" where they fly.

    Looked at where they sink fastest on average: v/t there, from the start on, over gravity.

    Parameters
    ----------
    run : Run
    """
    g = float(np.linalg.norm(run.scene.gravity))
    names = [body.name for body in run.scene.bodies if not body.is_driven]
    if g == 0.0 or len(run.t) < 2:
        return ""
    down = np.mean([run.velocity(name) for name in names], axis=0) @ (run.scene.gravity / g)
    k = int(down.argmax())
    share = float(down[k] - down[0]) / (g * max(float(run.t[k] - run.t[0]), 1e-300))
    if share <= FREE or down[k] <= FAST:
        return ""
    return (
        f"The quadrotors fall, at {down[k]:.3g} m/s at t={run.t[k]:.3g} s, by {share:.0%} of gravity from the start on: the "
        "controller gives no thrust, or less than what they and their load weigh, so that nothing holds them up."
    )
