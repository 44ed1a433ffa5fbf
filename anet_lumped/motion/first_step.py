"""Starts that the first step does not resolve: deep inside a stiff obstacle, or with cables that are stretched many times.

The forces f at the start would change velocities by h f/m in a step of h. Where they do so by far less, because the force has ended
or turned round within the step, nothing that is seen at the ends of steps tells what it gave: a stage that takes the force at the
start throws a node off with some share of h f/m, and differences of what follows see a smooth flight. `edmc` and backward Euler
raise no energy, so that no node becomes faster than what is stored allows; but how fast one is where such a force has ended is
known to some per cent only, and a node that flies keeps what its velocity is off by.

An explicit step that is stable resolves springs. Dampers c are stable up to h c/m = 2 and more, but from 1.5 on a first step gives
h f/m to a node that should creep with f/c: it goes to and fro about that, and one that a ground presses out flies off. Such a start
shows where the force has all but ended at half of that velocity.
"""

from typing import Any

import numpy as np

from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.motion.inner_states import inner_of
from integrators import schemes
from integrators.schemes.record import EnergyPromise
from integrators.system import BALANCE

TIMES = 2.0  # by which h f/m is larger than what the step changes velocities by where it is not resolved
ENDED = 0.25  # of the force at the start, which is left half way to the velocity that an explicit step gives: h c/m = 1.5
LOOKS = 16  # saved states that are looked at before all are
OF_FASTEST = 0.5  # of the largest velocity of the run, that such a step changes the velocity by


def thrown(run: Any) -> float | None:
    """Change of a node's velocity in a first step that is not resolved, if most of the velocities come from it [m/s]; or None.

    Parameters
    ----------
    run : Run
        At fixed steps, of a scheme of this package. Of one that never raises the energy None, see `unresolved_start`.
    """
    return None if schemes.scheme(run.method).energy is EnergyPromise.NEVER_RISES else unresolved_start(run)


def unresolved_start(run: Any) -> float | None:
    """As `thrown`, of any scheme; of one that never raises the energy only of nodes that no cable holds, which fly."""
    scheme, n_free = schemes.scheme(run.method), run.model.n_free
    if scheme.keeps_constraints or len(run.t) < 2 or run.extrapolated or run.model.has_bodies:
        return None
    if scheme.energy is EnergyPromise.NEVER_RISES and run.segment_tension[1].all() and run.model.node_segments[:n_free].all():
        return None  # cables hold every node
    change = np.linalg.norm(run.v[1, :n_free] - run.v[0, :n_free], axis=1)
    some = run.v[:: max(1, len(run.t) // LOOKS)]  # of most runs they show that it resolves its start
    for velocities in (some, run.v):
        least = OF_FASTEST * np.linalg.norm(velocities[:, :n_free], axis=2).max(initial=0.0)
        if change.max(initial=0.0) <= least:
            return None  # without a look at the forces
    if scheme.explicit:
        thrown_by = run.dt * _accelerations(run)
        half_way = np.einsum("ix,ix->i", run.dt * _accelerations(run, 0.5 * thrown_by), thrown_by)
        speed = np.linalg.norm(thrown_by, axis=1)
        largest = float(speed.max(initial=0.0, where=half_way < ENDED * speed**2))
        return largest if largest > least else None
    counts = run.dt * np.linalg.norm(_accelerations(run), axis=1) > TIMES * change
    if scheme.energy is EnergyPromise.NEVER_RISES:
        held = run.model.ends[(run.segment_tension[:2] != 0.0).any(axis=0)].ravel()
        counts[held[held < n_free]] = False
    largest = float(change.max(initial=0.0, where=counts))
    return largest if largest > least else None


def _accelerations(run: Any, faster: Any = 0.0) -> np.ndarray:
    """Accelerations of the moving nodes at the start of a run, were they ``faster`` [m/s], (n_free, 3) [m/s2]."""
    from anet_lumped.mechanics.bindings import system  # compiled on first use

    inner = inner_of(run)
    crept, shedding = None if inner is None else inner[:, 0], None if run.shedding is None else run.shedding[0]
    net = fresh_net(run.model, force=True, newton=False, crept=crept, shedding=shedding)
    bound, f, v = system(run.model, force=True, newton=False), np.zeros_like(run.q[0]), run.v[0].copy()
    v[: run.model.n_free] += faster
    bound.force(run.t[0], run.q[0].copy(), v, net.address, f, np.zeros(BALANCE))
    return f[: run.model.n_free] * bound.per_mass[: run.model.n_free]
