"""What a run knows of the errors of its places, as far as its steps, its method and its lost energy tell.

What the steps leave out adds up in the march (`integrators.marching.error_growth`), and nodes that fly keep what their velocity is
off by (`free_flight`). A break comes too early or too late by what is off before it, and that goes on (`break_errors`).

Errors of steps and flights fade as the motion does: dampers and drag that take the power D of a motion of the energy E let its
amplitude, and the errors in it, fade at the rate D/2E. E is kinetic energy and what springs hold beyond their least, that of a
ground too: a net that is let go stretched many times, or a weight deep inside the ground, gives dampers far more than it moves
with, and forgets little of where it went meanwhile.

Where tensions that change pump what is across the motion, errors grow by more than what is added to them (`amplification`).

Besides, energy that the method took is missing in the motion, and what it gave is too much: of an amplitude A, which goes with the
square root of the energy, a share E_lost/2E. A swing that starts at rest goes 2A. Where all is lost the motion is off by its whole
way 2A, and so it is by its share of 2A where a weight flies as high as its energy takes it. What a method took of stretching alone,
as `edmc` does, lifts the weight W of all that moves by E_lost/W at most, less what the dampers of the cable would have taken, which
act half of the time if it goes slack in between.

A force that comes and goes within a step leaves no trace in it; where one may be, it is looked for (`unseen_forces`).

All else together is not more than the longest way that a node goes. How far this is from the truth, the study `error_estimate`
shows.
"""

from typing import Any

import numpy as np

from anet_lumped.results.energy_balance import BY_METHOD, ELASTIC, KINETIC, POTENTIAL, moved_share
from anet_lumped.scene.scene import Driven
from integrators import schemes

from .amplification import multiply
from .break_errors import break_errors
from .place_rows import BASE, DRIVEN, LEFT, LOST, MOTION, MOVED, RATE, WAYS, WEIGHT
from .saved_motion import SavedMotion, look_at
from .tension_error import lowest_axial_mode


def place_errors(run: Any) -> np.ndarray:
    """Largest error of a place up to each saved time, as far as it is known.

    Parameters
    ----------
    run : Run
        Of which `error_growth` is not None.

    Returns
    -------
    error : (k,) float64 [m]
    """
    if run.extrapolated or run.energy.shape[1] <= BY_METHOD:  # two runs have been compared; a file of version 0.1
        return run.error_growth
    columns = look_at_errors(run).rows.columns
    told = columns[LEFT] + columns[LOST]
    if run.events:
        told += break_errors(run, columns[LEFT])
    told *= run.error_factor
    told = np.minimum(np.maximum.accumulate(told), max(float(columns[WAYS].max()), float(run.error_growth[0])))
    return told + run.error_factor * _unseen(run)  # which is a way that no node went


def _unseen(run: Any) -> np.ndarray | float:
    """Largest error up to each saved time by forces that steps did not see, (k,) [m]; 0 where there are none of that kind."""
    if schemes.scheme(run.method).embedded or not any(effect.sudden for effect in run.model.forces):
        return 0.0
    from .unseen_forces import unseen_forces  # compiled on first use

    return unseen_forces(run)


def look_at_errors(run: Any) -> SavedMotion:
    """The saved states of a run after all passes over them: `PlaceRows.columns` has what is left of errors, and what is lost."""
    from .fading import fade_errors  # compiled on first use

    seen, scene, n_free = look_at(run, grows=True), run.scene, run.model.n_free
    multiply(seen)
    numbers, columns = seen.rows.numbers, seen.rows.columns
    columns[MOTION] = run.energy[:, KINETIC] + _stored(run)
    if any(isinstance(point, Driven) for point in scene.all_points):
        numbers[DRIVEN] = True
        mean = np.einsum("kix->xk", run.q[:, n_free:]) / (run.model.n - n_free)  # a third of the time of `mean`
        columns[BASE : BASE + 3] = mean - mean[:, :1]
    if schemes.scheme(run.method).books_its_losses:
        numbers[WEIGHT] = float(np.linalg.norm(scene.gravity)) * float(run.model.mass[:n_free].sum())
        modes = [lowest_axial_mode(scene, cable) for cable in scene.cables]
        numbers[RATE] = min((mode.zeta * mode.omega for mode in modes), default=0.0)
    else:
        columns[MOVED] = moved_share(run.energy)
    fade_errors(seen.address)
    return seen


def _stored(run: Any) -> np.ndarray:
    """Energy beyond its least that springs hold, and of a scene with a ground what its effects hold besides gravity, (k,) [J].

    Of moving nodes with the masses that they have at first.
    """
    stored = run.energy[:, ELASTIC]
    if any(effect.is_ground for effect in run.scene.effects):
        n_free = run.model.n_free
        stored = stored + run.energy[:, POTENTIAL] + (run.q[:, :n_free] @ run.scene.gravity) @ run.model.mass[:n_free]
    return stored - stored.min()
