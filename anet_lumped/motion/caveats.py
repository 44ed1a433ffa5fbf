"""What a run that is done has to say against itself: energy that nothing took, lengths that no tension holds, a limit far off.

None of it makes the run another than done: a method that damps the motion is asked for by name, and a rest may be right that
was reached by wrong damping. But whoever reads of a swing, or of a stretch, must know. On the catalogue of hard cases
(`studies.catalogue`) every run whose statements are broken, and that is not found to have gained energy, has a caveat.
"""

import numpy as np

from anet_lumped.results.audit import SHARE
from anet_lumped.scene.scene import Driven
from integrators import dirk

from .extrapolation import is_extrapolated
from .gain import MOST

OFF_ITS_TENSION = 0.1  # of a cable's stretch, by which the places may exceed what the tension holds
SHARE_OF_WAY = 0.05  # of the way that a node went: what the finer of two runs may be off by to be extrapolated
TOLERANCE = 1e-7  # of its length: what Newton's tolerance leaves


def caveats(run, adaptive=False):
    """Sentences, each with what was found, how much of it, and what to try.

    Parameters
    ----------
    run : Run, done
    adaptive : bool, whether its steps were chosen by a tolerance

    Returns
    -------
    tuple of str
    """
    step = "a smaller tolerance" if adaptive else f"a smaller step than dt={run.dt:.3g} s"
    return tuple(text for text in (_energy(run, step), _lengths(run, step), _limit(run, step)) if text)


def _energy(run, step):
    """Changes of energy that work and dissipation do not account for, where they are more than `MOST` of what was in play."""
    balance = run.energy_balance
    if balance.imbalance <= MOST:
        return ""
    change = balance.kinetic + balance.elastic + balance.gravitational - balance.work + balance.dissipated
    if any(isinstance(point, Driven) for point in run.scene.points):
        what = "are not accounted for by dampers, drag and the work of driven points"
    elif change < 0.0:
        what = "were lost in its steps, to neither dampers nor drag: the motion is damped too much"
    else:
        what = "were dissipated beyond what was there: its steps put that in, or its dampers took less than their rates say"
    return f'{run.method}: {balance.imbalance:.2g} of the energy in play {what}; take {step}, or method="edmc".'


def _lengths(run, step):
    """A cable that is longer than its tension holds it.

    A damper holds a stretch back and gives it none: k x + c dx/dt = T keeps x below the largest T/k there was. Where the
    largest stretch of a cable, its taut segments' together, is more than that by `OFF_ITS_TENSION` of it, what is too long
    comes from the steps: of a scheme whose reported tension is the mean over its stages, and of an extrapolation, which goes
    straight on where the end of a stiff cable goes round.
    """
    if not (is_extrapolated(run) or run.method in dirk.AVERAGED):
        return ""
    worst, found = 0.0, ""
    for cable in run.scene.cables:
        stretch = np.linalg.norm(np.diff(run.shape(cable.name), axis=1), axis=2) - cable.L0
        longer = float(np.maximum(stretch, 0.0).sum(axis=1).max())
        pulled = np.maximum(run.tension(cable.name), 0.0)
        hardest = pulled[pulled.sum(axis=1).argmax()]
        held = cable.L0 * sum(map(cable.strain, hardest.tolist()))
        excess = longer - max(held, float(np.maximum(stretch[0], 0.0).sum()))
        if excess > OFF_ITS_TENSION * held + TOLERANCE * cable.length and excess / cable.length > worst:
            worst = excess / cable.length
            name, other = (
                ("edmc, extrapolated", "no extrapolation") if is_extrapolated(run) else (run.method, 'method="edmc"')
            )  # fmt: skip
            found = (
                f'{name}: cable "{cable.name}" gets {longer:.2g} m longer than it is unstretched, where its tension stretches it '
                f"by {held:.2g} m; take {step}, or {other}."
            )
    return found


def _limit(run, step):
    """Two runs too far apart for the limit that they tend to: for the cables, or for how far anything moved."""
    length = max(cable.length for cable in run.scene.cables)
    moved = float(np.linalg.norm(run.q - run.q[0], axis=2).max())
    if not is_extrapolated(run) or run.error_estimate <= min(SHARE * length, SHARE_OF_WAY * moved + 1e-3 * TOLERANCE * length):
        return ""
    return (
        f"The two runs that are extrapolated are {3.0 * run.error_estimate:.2g} m apart, which is far from a limit: the result "
        f"need not be any motion; take {step}, or no extrapolation."
    )
