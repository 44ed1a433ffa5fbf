"""One solve of the system of a net's junctions, by the library's fronts and by SuperLU, on the same matrix and the same right side.

The library chooses the order of elimination once for a scene, its set-up; SuperLU, as scipy offers it, in each factorisation.
"""

import time

import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import splu

from anet_lumped.mechanics import newton_step, residual
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.mechanics.linear import solve
from anet_lumped.mechanics.required_kernels import require
from anet_lumped.model.body_order import order_of_points
from anet_lumped.statics.relaxation import net_at_rest
from anet_lumped.statics.stability import tangent
from integrators.stage import LAW_BACKWARD, Stage

OWN, COLAMD, SYMMETRIC = "this library", "SuperLU, COLAMD", "SuperLU, symmetric mode"
SUPERLU = {
    COLAMD: {"permc_spec": "COLAMD"},
    SYMMETRIC: {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}},
}
TAU = 0.1  # [s] of the pseudo-step whose system is solved: weak inertia
ASIDE = 1e-4  # [m] by how much the nodes are out of place, which makes the right side


def solve_rows(rest, repeats):
    """A row for each way to solve: the processor's times [s], and how far its solution is from the library's, over its size.

    Parameters
    ----------
    rest : State of a net whose cables have one segment each
    repeats : times that each is timed; the median counts
    """
    model, load = rest.model, 1.0
    net = fresh_net(model, force=False, newton=False)
    require(net, model, newton=True)
    net, q = net_at_rest(model, net, load), rest.q.copy()
    net.tension[:] = rest.segment_tension
    base = q.copy()
    base[: model.n_free] += ASIDE * np.random.default_rng(0).standard_normal((model.n_free, 3))
    stage = Stage(LAW_BACKWARD, 0.0, 1.0 / TAU**2, 1.0, TAU, 0.0)

    def linearised():
        residual.residual(stage, base, base, q, net.address)

    linearised()
    newton_step.direction(stage, net.address)
    own = net.newton_step[: model.n_free].ravel().copy()
    net.tension[:] = rest.segment_tension
    K = tangent(model, net, q, rest.segment_tension)
    inertia = np.repeat(net.mass[: model.n_free], 3) / TAU**2
    K = (K + diags_array(inertia)).tocsc()
    right = inertia * (base - q)[: model.n_free].ravel()
    solutions, factors = {}, {}
    taken = {name: [] for name in (OWN, *SUPERLU)}
    for _ in range(repeats):
        linearised()
        taken[OWN].append((_seconds(lambda: solve.solve(net.address)), 0.0))
        for name, how in SUPERLU.items():
            first = _seconds(lambda name=name, how=how: factors.update({name: splu(K, **how)}))
            second = _seconds(lambda name=name: solutions.update({name: factors[name].solve(right)}))
            taken[name].append((first, second))
    set_up = min(_seconds(lambda: order_of_points(model.scene)) for _ in range(2))
    rows = []
    for name, seconds in taken.items():
        factored, solved = np.median(seconds, axis=0)
        apart = 0.0 if name == OWN else float(np.abs(solutions[name] - own).max() / np.abs(own).max())
        rows.append(
            {
                "solver": name, "points": model.n_free, "set_up_s": set_up if name == OWN else 0.0, "solve_s": factored + solved,
                "apart": apart,
            }
        )  # fmt: skip
    return rows


def _seconds(function):
    """The processor's time of one call [s]."""
    began = time.process_time()
    function()
    return time.process_time() - began
