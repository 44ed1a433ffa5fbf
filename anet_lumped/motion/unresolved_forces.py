"""Energy that forces without an energy give because they change faster than steps resolve, such as a stiff contact of one's own.

A force is taken at the middle of a step. A node that a step carries deep into a contact meets another force on the way in than on
the way out, so that it leaves with more energy than it came with. That is booked to the effect, not to the method.
"""

import numpy as np

RESOLVED = 1.0  # of h omega of a node on the slope of the force: a sixth of a turn in a step


def unresolved_force(run):
    """Name of the first effect without an energy whose force changes faster than the steps of a run resolve, or "".

    Looked at halfway through the step after each saved state, where the force is taken: (h omega)^2 = h^2 |df/dq|/m of a node.

    Parameters
    ----------
    run : Run
    """
    model, h = run.model, run.dt
    for e, effect in enumerate(model.forces):
        kernels, numbers = effect.kernels(), model.effects.numbers(e)
        if effect.keeps_energy or "tangent" not in kernels:
            continue
        for t, q, v in zip(run.t, run.q, run.v, strict=True):
            D = np.zeros((model.n_free, 3, 3))
            near, far = np.zeros((max(model.near_rows, 1), 2, 3, 3)), np.zeros((max(model.n_segments, 1), 2, 3, 3))
            kernels["tangent"](t + 0.5 * h, q + 0.5 * h * v, v, *numbers, 1.0, 0.0, D, near, far)
            if (h**2 * np.abs(D).max(axis=(1, 2)) > RESOLVED**2 * model.mass[: model.n_free]).any():
                return type(effect).__name__
    return ""
