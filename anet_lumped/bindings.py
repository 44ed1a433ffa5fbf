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
        calm=first_class(dynamics.calm),
        observe=first_class(dynamics.observe),
        energy=first_class(dynamics.energies),
        per_mass=np.repeat(1.0 / model.mass, 3).reshape(-1, 3),
        n_free=model.n_free,
    )
