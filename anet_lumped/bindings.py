"""The compiled functions of a net, handed to an integrator as its `System`."""

import numpy as np

from integrators.system import System, first_class

from . import dynamics


def system(model):
    """`System` of a model.

    Returns
    -------
    System
    """
    return System(
        prescribe=first_class(dynamics.prescribe),
        force=first_class(dynamics.force),
        residual=first_class(dynamics.residual),
        direction=first_class(dynamics.direction),
        correct=first_class(dynamics.correct),
        settle=first_class(dynamics.settle),
        adopt=first_class(dynamics.adopt),
        forget=first_class(dynamics.forget),
        remember=first_class(dynamics.remember),
        average=first_class(dynamics.average),
        observe=first_class(dynamics.observe),
        energy=first_class(dynamics.energies),
        margin=first_class(dynamics.margin),
        per_mass=np.repeat(1.0 / np.where(model.mass > 0.0, model.mass, np.inf), 3).reshape(-1, 3),  # a support may hold nothing
        n_free=model.n_free,
    )
