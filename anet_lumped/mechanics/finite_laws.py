"""Which effect of a scene has a force, a slope of it or an energy that is not finite.

Asked after a failure, so that no loop has to check.
"""

import numpy as np

FAR = 100.0  # times the size of a scene: farther out every law overflows, and none is to blame
FAST = 1e6  # [m/s], likewise


def name_law_that_is_not_finite(model, states):
    """Sentence that names the first effect whose force, its slope or energy is not finite in one of several states, and where.

    Parameters
    ----------
    model : Model
    states : iterable of (t [s], q (n, 3) [m], v (n, 3) [m/s])
        States that are not finite themselves, or farther out than `FAR` or faster than `FAST`, are left out.

    Returns
    -------
    str
        Ends with a blank; empty if every law is finite.
    """
    size = None
    for t, q, v in states:
        size = size or np.abs(q).max() + (sum(cable.length for cable in model.scene.cables) or model.scene.longest)
        if not (np.abs(q).max() <= FAR * size and np.abs(v).max() <= FAST):
            continue
        for e, effect in enumerate(model.forces):
            kernels, numbers, f = effect.kernels(), model.effects.numbers(e), np.zeros_like(q)
            kernels["force"](t, q, v, *numbers, f)
            wrong = np.flatnonzero(~np.isfinite(f[: model.n_free]).all(axis=1))
            if len(wrong):
                row = ", ".join(f"{x:.3g}" for x in f[wrong[0]])
                return f"The force of effect {type(effect).__name__} is ({row}) N at t={t:.4g} s at {model.where(wrong[0])}. "
            energy = kernels["energy"](t, q, *numbers)
            if not np.isfinite(energy):
                return f"The energy of effect {type(effect).__name__} is {energy:.3g} J at t={t:.4g} s. "
            if "tangent" in kernels:  # none of a dead load
                D = np.zeros((model.n_free, 3, 3))
                near, far = np.zeros((max(model.near_rows, 1), 2, 3, 3)), np.zeros((max(model.n_segments, 1), 2, 3, 3))
                kernels["tangent"](t, q, v, *numbers, -1.0, 0.0, D, near, far)
                wrong = np.flatnonzero(~np.isfinite(D).all(axis=(1, 2)))
                if len(wrong):
                    where = f"t={t:.4g} s at {model.where(wrong[0])}"
                    return f"The force of effect {type(effect).__name__} has a slope that is not finite at {where}. "
    return ""
