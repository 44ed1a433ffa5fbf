"""The compiled functions of a net, handed to an integrator as its `System`."""

import numpy as np

from anet_lumped.mechanics import force, memory, newton_step, observe, prescribe, residual, settle
from integrators.system import System, first_class


def system(model):
    """`System` of a model.

    Returns
    -------
    System
    """
    return System(
        prescribe=first_class(prescribe.prescribe),
        force=first_class(force.force),
        residual=first_class(residual.residual),
        direction=first_class(newton_step.direction),
        correct=first_class(newton_step.correct),
        settle=first_class(settle.settle),
        adopt=first_class(newton_step.adopt),
        forget=first_class(newton_step.forget),
        remember=first_class(memory.remember),
        average=first_class(memory.average),
        observe=first_class(observe.observe),
        energy=first_class(observe.energies),
        margin=first_class(observe.margin),
        per_mass=np.repeat(1.0 / np.where(model.mass > 0.0, model.mass, np.inf), 3).reshape(-1, 3),  # a support may hold nothing
        n_free=model.n_free,
    )
