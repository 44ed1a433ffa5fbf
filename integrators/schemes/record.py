"""The record of a scheme: all that is known of it, from its label in figures to the rows of memory that its step needs.

A scheme of this package has its record beside its step, in one file; the solvers of other packages have theirs in `scipy_schemes`
and `diffrax_schemes`. `schemes` finds a record by its scheme's name. Importing a record compiles nothing.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from integrators.linear_stability import StepLimit

NEWTON_TOLERANCE = 1e-6  # of the largest force on a node
NEWTON_ITERATIONS = 60


class Origin(Enum):
    """Whose a scheme is."""

    OWN = "this package"
    SCIPY = "scipy"
    DIFFRAX = "diffrax"


class Family(Enum):
    """Schemes that are alike; figures draw a family in colours of its own."""

    SYMPLECTIC = "symplectic"
    EXPLICIT_RUNGE_KUTTA = "explicit Runge-Kutta"
    ENERGY_MOMENTUM = "energy-momentum"
    DIAGONALLY_IMPLICIT = "diagonally implicit Runge-Kutta"
    COLLOCATION = "collocation"
    ALPHA = "alpha method"
    MULTISTEP = "multistep"
    CONSTRAINED = "explicit, with constraints"


class EnergyPromise(Enum):
    """What a scheme promises of the energy of a motion into which nothing puts any."""

    NEVER_RISES = "never rises, at any step, for springs that do not push"
    SWINGS_ABOUT = "swings about an energy that the scheme keeps; no step is damped"
    NONE = "no promise"


class Stepping(Enum):
    """Who chooses the steps of a scheme."""

    FIXED = "fixed steps; with a tolerance, steps chosen by comparing one step with two of half its length"
    EMBEDDED = "steps chosen by an error estimate of its own; fixed ones if a step is given without a tolerance"
    ADAPTIVE = "always steps chosen by an error estimate of its own"


def no_coefficients():
    """Coefficients of a scheme whose step has none."""
    return np.zeros(0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Scheme:
    """What is known of a scheme.

    Parameters
    ----------
    name : str, by which it is asked for
    label : str, by which figures and texts call it
    origin : Origin
    family : Family
    order : int or None, of places and velocities; None if it varies during a run
    explicit : bool, whether a step needs no solution of equations
    limit : StepLimit
        Largest stable step for a linear mode, see `linear_stability`.
    note : str
        That limit in words, and what the linear statement leaves open.
    stepping : Stepping
    energy : EnergyPromise
    keeps_angular_momentum : bool
        To the tolerance of its equations; the others to the error of the motion.
    error_constant : float
        C of what a step leaves out of a place, C h^(p+1) |d^(p+1) q/dt^(p+1)|; of a scheme of this package. See `error_growth`.
    error_order : int or None
        p of that, if it is not the order: an error of a lower order that does not grow is left out of it.
    error_shift : float
        That other error: places are off as if those of a motion so many steps earlier or later.
    damps_the_motion : bool
        It takes a large share of the energy out of a motion that its steps resolve.
    observes_mean_over_stages : bool
        The internal forces observed after a step are the mean of those of its stages, because those of a single stage mislead
        where the step does not resolve the stretching; the places at the end of a step need not be those that they balance.
    extrapolated_order : int or None
        Order of what two runs, with a step and with its half, extrapolate to; None if they are not to be extrapolated.
    options : mapping of str to float
        Names of the numbers that a user may set, with their defaults.
    books_its_losses : bool
        Its steps find out what they take from the motion themselves. Of other schemes that is what no force accounts for.
    takes_rigid_springs : bool, springs that do not stretch, whose forces are unknowns of the step
    keeps_constraints : bool
        For systems whose springs all are rigid: forces are what keeps their lengths, which each step gives back (`System.project`).
    with_given_steps : str, name of the scheme that takes its place where steps are given; "" for itself
    takes_changing_rest_lengths : bool, springs whose rest lengths change in time
    takes_rigid_bodies : bool, nodes that move as one piece: its steps ask `System.project` for that, or solve for their motion
    takes_inner_states : bool, springs and forces whose state is more than places and velocities, in steps of `LAW_BETWEEN`
    stops_at_events : bool, a march that ends within a step where a margin of the system turns positive

    Of the schemes of this package alone:

    step : function for Numba, see `system.STEP`
    memory_rows : int, rows of (n, 3) numbers that a step works in
    carried_rows : int, the first rows of these, which a step leaves to the next
    evaluates_force : bool, whether its steps ask a system for the force at one time
    undoes_failed_steps : bool, whether a step whose equations are not solved leaves the state as it was
    force_evaluations : int, of an explicit step
    stiff_beyond : float
        h |lambda| of the last stages of an embedded pair above which stability holds the step.
    coefficients : function that returns the coefficients that the step is given, such as a tableau; (k,) float64
    """

    name: str
    label: str
    origin: Origin
    family: Family
    order: int | None
    explicit: bool
    limit: StepLimit
    note: str
    stepping: Stepping = Stepping.FIXED
    energy: EnergyPromise = EnergyPromise.NONE
    keeps_angular_momentum: bool = False
    error_constant: float = np.nan
    error_order: int | None = None
    error_shift: float = 0.0
    damps_the_motion: bool = False
    observes_mean_over_stages: bool = False
    extrapolated_order: int | None = None
    options: Mapping[str, float] = field(default_factory=dict)
    books_its_losses: bool = False
    takes_rigid_springs: bool = False
    keeps_constraints: bool = False
    with_given_steps: str = ""
    takes_changing_rest_lengths: bool = False
    takes_rigid_bodies: bool = False
    takes_inner_states: bool = False
    stops_at_events: bool = True
    step: Callable | None = None
    memory_rows: int = 0
    carried_rows: int = 1
    evaluates_force: bool = True
    undoes_failed_steps: bool = False
    force_evaluations: int = 1
    stiff_beyond: float = np.inf
    coefficients: Callable[[], np.ndarray] = no_coefficients

    @property
    def own(self) -> bool:
        """Whether it is a scheme of this package."""
        return self.origin is Origin.OWN

    @property
    def embedded(self) -> bool:
        """Whether it is a pair of this package with an error estimate of its own."""
        return self.stepping is Stepping.EMBEDDED

    @property
    def needs_copied_start(self) -> bool:
        """Whether the state before each step has to be copied, because the step may fail and leave another one."""
        return (not self.explicit or self.keeps_constraints) and not self.undoes_failed_steps

    @property
    def stable_undamped(self) -> bool:
        """Whether some step is stable for a mode without damping, such as a swing, on which no axial damper acts."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return bool(self.limit.largest_step(np.ones(1), np.zeros(1))[0] > 0.0)

    def chooses_steps(self, dt: float | None) -> bool:
        """Whether it chooses its steps by itself although no tolerance is given, with or without a step dt [s]."""
        return self.stepping is Stepping.ADAPTIVE or (self.embedded and dt is None)

    def parameters(self, tolerance: float = NEWTON_TOLERANCE, **options: float | None) -> np.ndarray:
        """Numbers that its steps are given: Newton's tolerance and iterations, its options, its coefficients.

        An option that is None has its default.
        """
        own = [default if options.get(name) is None else options[name] for name, default in self.options.items()]
        return np.concatenate([[tolerance, NEWTON_ITERATIONS], own, self.coefficients()]).astype(float)


def own_scheme(**known) -> Scheme:
    """The record of a scheme of this package."""
    return Scheme(origin=Origin.OWN, takes_changing_rest_lengths=True, **known)
