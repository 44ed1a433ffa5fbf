"""Whether a run that reached its end holds more energy than it was given: a method that pumps a net must not end as "done".

Dampers, drag and the scheme's own dissipation only take from K + E + P - W, the kinetic, elastic and potential energy less the
work of driven points; a physical motion never raises it. A run is found to have gained energy if that rises by more than
`MOST` of the largest energy in play. On the catalogue of hard cases, 52 motions with 9 methods (`studies.catalogue`), runs whose
statements hold rise by 0.03 at most, and what is pumped by 0.15 and more, often by all that is in play.
"""

from dataclasses import replace

import numpy as np

from anet_lumped.model.tables import AXIAL_STIFFNESS

from .choice import CALM, OF_LIMIT_SLACK, SWINGS_ABOUT

GAINED = "energy gained"  # the status
MOST = 0.1  # of the energy in play
BLOCKS = 20  # of a run, whose least energies are compared where energy oscillates by itself
SLOP = 1e-9, 1e-15  # of the weight's work over the reach, and of k reach^2: energies that Newton's tolerance and rounding leave


def gain(run, adaptive=False):
    """Largest rise of kinetic, elastic and potential energy less work put in, over the energy in play.

    Where a symplectic scheme keeps an energy of its own, about which the true one oscillates within the step's bound, it is the
    rise of the least energy of a block of states. Of an adaptive run the first state is compared with the last: the states
    between are interpolated, and the energy of a stiff cable is lost in that.

    Parameters
    ----------
    run : Run
    adaptive : bool

    Returns
    -------
    float
    """
    rows, model = run.energy, run.model
    own = rows[:, :3].sum(axis=1) - rows[:, 3]
    if not all(effect.passive for effect in run.scene.effects):
        own = own + rows[:, 4]  # a wind gives energy: the account of what effects took and gave has to close instead
    if adaptive:
        own = own[[0, -1]]
    elif run.method in SWINGS_ABOUT:
        own = np.array([block.min() for block in np.array_split(own, min(BLOCKS, len(own)))])
    reach = np.abs(run.q).max()
    weight = model.mass[: model.n_free].sum() * np.linalg.norm(run.scene.gravity)
    rounding = SLOP[0] * weight * reach + SLOP[1] * model.axial[:, AXIAL_STIFFNESS].max(initial=0.0) * reach**2
    in_play = max(rows[:, 0].max(), rows[:, 1].max(), np.ptp(rows[:, 2]), np.abs(rows[:, 3]).max()) + rounding
    return float((own - np.minimum.accumulate(own)).max() / in_play) if in_play else 0.0


def weighed(run, limit, adaptive=False):
    """A run that reached its end; its status is `GAINED` if it holds more than it was given.

    Parameters
    ----------
    run : Run
    limit : float [s], predicted for its method
    adaptive : bool

    Returns
    -------
    Run
    """
    risen = gain(run, adaptive)
    if risen <= MOST:
        return run
    small = OF_LIMIT_SLACK * limit
    if not adaptive and run.dt > limit:
        why = f'; its step is beyond the largest stable one, {limit:.3g} s: take a smaller one or method="edmc"'
    elif run.method in SWINGS_ABOUT and run.dt > small:
        why = (
            "; such a step pumps an undamped cable that goes slack and snaps taut: take at most an eighth of the predicted limit, "
            f'{small:.3g} s, a damping ratio of {CALM:g} or more, or method="edmc"'
        )
    else:
        why = '; try method="edmc", which never gains any, or a smaller step'
    message = (
        f"{run.method} with dt={run.dt:.3g} s reached t={run.t[-1]:.4g} s, but its energy rose by {risen:.2g} of the energy in "
        f"play that nothing put in, where {MOST:g} is allowed{why}."
    )
    return replace(run, status=GAINED, message=message)
