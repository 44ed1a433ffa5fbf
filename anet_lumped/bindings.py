"""The compiled functions of a net, handed to an integrator as its `System`."""

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
        forget=first_class(dynamics.forget),
        energy=first_class(dynamics.energies),
        mass=model.mass,
        n_free=model.n_free,
    )
