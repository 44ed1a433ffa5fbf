"""diffrax's solvers on a Model: tolerances, the times that no step may cross, and the account of the run.

Importing this module has JAX compute in float64 in the whole process (``jax_enable_x64``).
"""

import numpy as np

from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.motion.other_packages import finished, scaled
from anet_lumped.motion.times import stops
from integrators import diffrax_adapter

from .net import jax_net


def march(model, choice, leg, q, v, tension, adaptive, tolerances, rho_inf):
    """March with one of diffrax's solvers.

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
    q, v : (n, 3) float64 [m], [m/s]
    tension, adaptive, rho_inf
        Not used; every scheme of `simulate` is marched with the same arguments.
    tolerances : (rtol, atol)

    Returns
    -------
    Run
    """
    net, compiled, free = fresh_net(model), system(model), model.n_free
    times = leg.times()
    rtol, atol = scaled(model, q, tolerances)
    out = diffrax_adapter.march(
        choice.method, jax_net(model), leg.begin, leg.end, stops(model.scene), q[:free], v[:free], times, choice.dt,
        rtol, atol,
    )  # fmt: skip
    whole_q, whole_v, energy = np.tile(q, (len(out.t), 1, 1)), np.zeros((len(out.t), *q.shape)), np.zeros((len(out.t), 5))
    whole_q[:, :free], whole_v[:, :free] = out.q, out.v
    energy[:, 3], energy[:, 4] = out.put_in, out.dissipated
    for k, t in enumerate(out.t):
        compiled.prescribe(t, net.address, whole_q[k], whole_v[k])
        compiled.energy(t, whole_q[k], whole_v[k], net.address, energy[k])
    return finished(model, choice, tolerances, out, whole_q, whole_v, energy, out.wall_time)
