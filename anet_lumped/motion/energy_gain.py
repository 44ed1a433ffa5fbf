"""Energy that a method has added to a motion: such a run must not end as "done".

Dampers, drag and the scheme's own dissipation only take from K + E + P - W, the kinetic, elastic and potential energy less the
work of driven points; a physical motion never raises it. A run has gained energy if that sum rises by more than `ALLOWED_GAIN` of
the largest energy in play. On the catalogue of hard cases, 52 motions with 9 methods (`studies.catalogue`), the sum rises by 0.03
at most in runs whose statements hold, and by 0.15 and more, often by all that is in play, in runs to which the method adds energy.
"""

from dataclasses import replace

import numpy as np

from anet_lumped.model.tables import AXIAL_STIFFNESS
from anet_lumped.results.energy_balance import BY_DAMPERS, BY_METHOD, ELASTIC, KINETIC, POTENTIAL, WORK
from integrators import schemes
from integrators.schemes.record import EnergyPromise

from .choice import CALM_DAMPING_RATIO, SHARE_OF_LIMIT_SLACK

GAINED = "energy gained"  # the status
ALLOWED_GAIN = 0.1  # of the energy in play
BLOCKS = 20  # of a run, whose least energies are compared where energy oscillates by itself
WEIGHT_TOLERANCE = 1e-9  # of the weight's work over the reach: energy that Newton's tolerance leaves
STIFFNESS_TOLERANCE = 1e-15  # of k reach^2: energy that rounding leaves
PLACE_TOLERANCE = 16.0 * np.finfo(float).eps  # of the reach: what rounding moves a node by in a step
LENGTH_TOLERANCE = 1e-8  # of a length that must not change: a hundred times what Newton's tolerance leaves of it


def energy_gain(run, adaptive=False):
    """Largest rise of kinetic, elastic and potential energy less work put in, over the energy in play.

    With a scheme whose energy swings about one that it keeps, the least energies of blocks of states are compared. Of an adaptive
    run the first state is compared with the last: the states between are interpolated, and that loses energy of a stiff cable.

    Parameters
    ----------
    run : Run
    adaptive : bool

    Returns
    -------
    float
    """
    columns = np.ascontiguousarray(run.energy.T)
    in_play = _in_play(columns) + rounding(run)
    return _rise(run, columns, adaptive) / in_play if in_play else 0.0


def _rise(run, columns, adaptive):
    """Largest rise of what `energy_gain` looks at [J]; ``columns`` are those of the energy of the run."""
    own = columns[:WORK].sum(axis=0) - columns[WORK]
    if not all(effect.passive for effect in run.scene.effects):
        # add what was taken: a wind gives energy, and a step may pump a stiff effect while dampers take the energy again
        own = own + columns[BY_DAMPERS:BY_METHOD].sum(axis=0)
    swings = schemes.scheme(run.method).energy is EnergyPromise.SWINGS_ABOUT
    if adaptive:
        own = own[[0, -1]]
    elif swings:
        own = np.array([block.min() for block in np.array_split(own, min(BLOCKS, len(own)))])
    return float((own - np.minimum.accumulate(own)).max())


def _in_play(columns):
    """The largest kinetic or elastic energy, change of potential energy or work put in, of columns of energy [J]."""
    largest, least = columns.max(axis=1), columns.min(axis=1)
    potential, work = largest[POTENTIAL] - least[POTENTIAL], max(largest[WORK], -least[WORK])
    return float(max(largest[KINETIC], largest[ELASTIC], potential, work))


def rounding(run):
    """Energy that Newton's tolerance and rounding may leave in a run [J]; of one at rest there is no other."""
    model = run.model
    reach = max(run.q.max(), -run.q.min())
    weight = model.mass[: model.n_free].sum() * np.linalg.norm(run.scene.gravity)
    left = WEIGHT_TOLERANCE * weight * reach + STIFFNESS_TOLERANCE * model.axial[:, AXIAL_STIFFNESS].max(initial=0.0) * reach**2
    if run.dt:
        left += 0.5 * model.mass[: model.n_free].sum() * (PLACE_TOLERANCE * reach / run.dt) ** 2
    for cable in run.scene.cables:
        if cable.inextensible:
            left += LENGTH_TOLERANCE * cable.length * float(run.tension(cable.name)[0].max())
    return float(left)


def flag_energy_gain(run, limit, adaptive=False):
    """Give a run that reached its end the status `GAINED`, with a message, if its method added energy.

    Parameters
    ----------
    run : Run
    limit : float [s], largest stable step that was predicted for its method
    adaptive : bool

    Returns
    -------
    Run
        The same one if it gained no more than `ALLOWED_GAIN`.
    """
    columns = np.ascontiguousarray(run.energy.T)
    if _rise(run, columns, adaptive) <= ALLOWED_GAIN * _in_play(columns):
        return run  # whatever rounding adds to what is in play, for which all places would have to be looked at
    gained = energy_gain(run, adaptive)
    if gained <= ALLOWED_GAIN:
        return run
    small = SHARE_OF_LIMIT_SLACK * limit
    swings = schemes.scheme(run.method).energy is EnergyPromise.SWINGS_ABOUT
    if not adaptive and run.dt > limit:
        why = f'; its step is beyond the largest stable one, {limit:.3g} s: take a smaller one or method="edmc"'
    elif swings and run.dt > small:
        why = (
            "; such a step adds energy to an undamped cable that goes slack and snaps taut: take at most an eighth of the "
            f'predicted limit, {small:.3g} s, a damping ratio of {CALM_DAMPING_RATIO:g} or more, or method="edmc"'
        )
    elif run.method == "edmc":
        why = "; try a smaller step"
        loose = [type(effect).__name__ for effect in run.model.forces if not effect.keeps_energy]
        if loose:
            why = f"{why}, or an energy in place of the force of {' and '.join(loose)}, of which nothing says that it is kept"
    else:
        kept = all(effect.keeps_energy for effect in run.model.forces)
        why = f'; try method="edmc"{", which never gains any," if kept else ""} or a smaller step'
    message = (
        f"{run.method} with dt={run.dt:.3g} s reached t={run.t[-1]:.4g} s, but its energy rose by {gained:.2g} of the energy in "
        f"play that nothing put in, where {ALLOWED_GAIN:g} is allowed{why}."
    )
    return replace(run, status=GAINED, message=message)
