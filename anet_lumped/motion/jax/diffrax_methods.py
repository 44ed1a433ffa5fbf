"""A leg of a run with one of diffrax's solvers.

Importing this module has JAX compute in float64 in the whole process (``jax_enable_x64``).
"""

from anet_lumped.motion.other_packages import prepare, run_of
from integrators.adapters import diffrax_adapter

from .net import jax_net


def march(model, choice, leg, start, settings):
    """March a leg with one of diffrax's solvers.

    The error of a step is kept below atol + rtol times the largest coordinate for places [m], and below the same numbers a
    second for velocities, in the mean square over all nodes. Saved states lie on the solver's interpolation between its
    steps, the last one on a step. JAX compiles once for a method and the shapes of a net, some seconds that ``Run.wall_time``
    leaves out; the environment variable JAX_COMPILATION_CACHE_DIR has it keep what it compiled for other processes.

    Parameters
    ----------
    model : Model
    choice : Choice
        ``dt`` is the first step.
    leg : Leg
    start : Start
    settings : Settings

    Returns
    -------
    Run
    """
    prepared = prepare(model, choice, leg, start, settings)
    return run_of(model, choice, settings, prepared, diffrax_adapter.march(jax_net(model), prepared.task))
