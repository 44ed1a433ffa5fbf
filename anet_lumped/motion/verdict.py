"""The verdict on a run: whether its method added energy, whether its error is known, what speaks against it, and why it failed."""

from dataclasses import replace

from anet_lumped.results.run import STATUS, Run
from anet_lumped.results.tension_error import highest_axial_mode
from integrators import schemes
from integrators.linear_stability import AmplificationPolynomial
from integrators.marching.error_growth import steps_of_differences, times_seen
from integrators.schemes.record import Scheme
from integrators.system import DIVERGED, UNCONVERGED

from .energy_gain import GAINED, flag_energy_gain
from .failure_messages import with_cause
from .first_step import thrown
from .run_warnings import warnings_of

# Steps that a run must have taken, and differences of velocities that `error_growth` must have formed of them, for an error to be
# seen in them.
LEAST_STEPS, DIFFERENCES = 10, 3
ORDER_AT_KINKS, DIFFERENCES_AT_KINKS = 2, 30  # of any method past a kink of the force, and of one of a higher order
UNSEEN = 30.0  # times as much as differences see of the fastest vibration: beyond it what they see tells nothing


def judged(run: Run, limit: float, adaptive: bool) -> Run:
    """A run with its status, its warnings and the cause of its failure.

    Parameters
    ----------
    run : Run
    limit : float [s], largest stable step that was predicted for its method
    adaptive : bool, whether its steps were chosen by a tolerance
    """
    times = 1.0 if adaptive or run.error_growth is None else _times_seen(run)
    if times > UNSEEN or _knows_no_error(run, adaptive):
        run = replace(run, error_growth=None)
    elif times > 1.0:
        run = replace(run, error_factor=times)
    if run.ok:
        run = flag_energy_gain(run, limit, adaptive)
    if run.ok:
        found = warnings_of(run, adaptive)
        run = replace(run, warnings=run.warnings + found) if found else run
    return with_cause(run) if run.status in (STATUS[DIVERGED], STATUS[UNCONVERGED], GAINED) else run


def _knows_no_error(run: Run, adaptive: bool) -> bool:
    """Whether a run has too few steps for an error to be seen in them, or a start that they do not resolve, and no run beside it.

    Where a segment goes slack or taut the force has a kink, past which no method is of an order above two. What a step across it
    leaves out is not of the order p of the differences, which see it by chance: of a method of higher order they must be many.
    """
    scheme = schemes.scheme(run.method)
    if adaptive or not scheme.own or run.kept or run.extrapolated or run.error_growth is None:
        return False
    if thrown(run) is not None:
        return True
    if run.kept is not None:
        return False
    order = scheme.error_order or scheme.order
    differences = DIFFERENCES_AT_KINKS if order > ORDER_AT_KINKS and _meets_kinks(run) else DIFFERENCES
    return round((run.t[-1] - run.t[0]) / run.dt) < least_steps(scheme, differences)


def least_steps(scheme: Scheme, differences: int = DIFFERENCES) -> int:
    """Steps that a run must take for an error to be seen in them, by so many differences of velocities."""
    return max(LEAST_STEPS, steps_of_differences(scheme, differences))


def _times_seen(run: Run) -> float:
    """How many times what differences of velocities see of it the run's steps leave out of the fastest axial vibration.

    Verlet, which has no amplification polynomial, leaves three times as much at its limit, and less before it.
    """
    scheme = schemes.scheme(run.method)
    if not scheme.own or run.extrapolated or not isinstance(scheme.limit, AmplificationPolynomial) or scheme.keeps_constraints:
        return 1.0
    modes = (highest_axial_mode(cable) for cable in run.scene.cables)
    return max((times_seen(scheme, mode.omega * run.dt, mode.zeta) for mode in modes if mode.zeta < 1.0), default=1.0)


def _meets_kinks(run: Run) -> bool:
    """Whether a segment that cannot push goes slack or taut between two saved states."""
    taut = run.segment_tension > 0.0
    changes = (taut[1:] != taut[:-1]).any(axis=0)
    return any(changes[run.model.segments(cable.name)].any() for cable in run.scene.cables if cable.compression == "none")
