"""A chain in a tank whose upper end is driven around a circle: its set-up, what was measured, and the lumped chain beside it.

The experiment is J. Lindahl's of 1984. Coefficients are those that an earlier study of the experiment took, on the nominal
diameter.

Source
------
Bergdahl, Palm, Eskilsson & Lindahl, Dynamically scaled model experiment of a mooring cable, J. Mar. Sci. Eng. (2015).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from anet_lumped import Cable, Driven, Fixed, Scene, paths, simulate
from anet_lumped.effects import Gravity
from anet_lumped.prescribed.smoothstep import ramped

PERIODS = (3.5, 1.25)  # [s]
PHASES = 25  # of a period, in which the tension is folded; the first is about phase 0 of the motion
MEASURED = {  # [N] at the fairlead, mean of the cycles
    3.5: (
        40.8, 33.1, 24.0, 14.4, 5.6, 1.5, 1.5, 1.6, 1.9, 2.4, 3.1, 5.5, 9.9,
        15.0, 21.0, 26.8, 31.6, 35.5, 39.9, 44.0, 47.7, 50.3, 51.4, 50.1, 46.4,
    ),
    1.25: (
        49.3, 38.5, 25.0, 11.8, 4.2, 1.5, 0.9, 0.8, 1.1, 1.3, 1.7, 2.9, 6.8,
        11.4, 13.9, 14.7, 20.1, 31.2, 40.2, 55.8, 64.5, 67.4, 70.3, 66.8, 59.0,
    ),
}  # fmt: skip
PEAK = {3.5: 51.52, 1.25: 73.71}  # [N] mean of the peaks of the cycles
SCATTER = {3.5: 0.5, 1.25: 2.5}  # [N] rms from cycle to cycle
TAKEN_UP = slice(9, 12)  # phases 0.36 to 0.44, in which the slack of the faster motion is taken up
PATH_POINTS = 200  # of a period, through which the path of the driven end is laid
START_UP = 2  # periods in which the circle grows to its full size
FINE = 40  # points of a phase over which its mean is taken


@dataclass(frozen=True)
class Chain:
    """The set-up, in SI units; coefficients on the nominal diameter, drag along on d L0.

    `distance` and `height` are those of the middle of the circle from the anchor; `steps` are those of a period; the tension of the
    last `folded` of all `cycles` is folded.
    """

    distance: float = 32.554
    height: float = 3.3
    radius: float = 0.2
    water_level: float = 3.0
    water_density: float = 1000.0
    length: float = 33.0
    mass_per_length: float = 0.0818
    steel_density: float = 7800.0
    nominal_diameter: float = 2.2e-3
    EA: float = 1e4
    zeta: float = 0.0
    Cdn: float = 2.5
    Cdt: float = 0.5
    Can: float = 3.8
    Cat: float = 0.0
    ground_stiffness: float = 1e7
    ground_damping: float = 1e4
    friction: float = 0.3
    slip_speed: float = 1e-3
    compression: str = "none"
    segments: int = 40
    steps: int = 400
    start_up: float = START_UP
    cycles: int = 8
    folded: int = 4

    @property
    def diameter(self) -> float:
        """Diameter of the cylinder that has the volume of the chain [m]."""
        return math.sqrt(4.0 * self.mass_per_length / (math.pi * self.steel_density))

    def scene(self, period: float) -> Scene:
        """The chain between its anchor and the end that is driven around the circle with a period [s]."""
        from anet_lumped.effects import Ground, Water

        wide = self.nominal_diameter / self.diameter
        cable = Cable(
            "anchor", "fairlead",
            length=self.length, mass_per_length=self.mass_per_length, EA=self.EA, zeta=self.zeta, segments=self.segments,
            compression=self.compression, diameter=self.diameter, Cdn=self.Cdn * wide, Cdt=self.Cdt * wide / math.pi,
            Can=self.Can * wide**2, Cat=self.Cat * wide**2,
        )  # fmt: skip
        bottom = Ground(
            stiffness=self.ground_stiffness, damping=self.ground_damping, friction=self.friction, slip_speed=self.slip_speed
        )
        water = Water(density=self.water_density, level=self.water_level)
        return Scene(
            [Fixed("anchor", (0.0, 0.0, 0.0)), Driven("fairlead", self._circle(period))], [cable], [Gravity(9.81), water, bottom]
        )

    def _circle(self, period):
        """Path of the driven end, (distance + r cos wt, 0, height - r sin wt), its r growing over the start-up."""
        t = np.linspace(0.0, self.cycles * period, self.cycles * PATH_POINTS + 1)
        angle = 2.0 * np.pi * t / period
        r = self.radius * np.array([ramped(one, self.start_up * period)[0] if self.start_up else 1.0 for one in t])
        places = np.column_stack([self.distance + r * np.cos(angle), 0.0 * t, self.height - r * np.sin(angle)])
        return paths.samples(t, places)


@dataclass(frozen=True)
class Folded:
    """Tension at the fairlead, folded on the period: its mean in each phase (25,) and the mean of the cycles' peaks [N]."""

    tension: np.ndarray
    peak: float
    status: str
    reason: str


def fold(chain: Chain, period: float) -> Folded:
    """Run a chain and fold the tension of its upper segment over the last cycles.

    The mean of a phase is taken over 1/25 of the period about it.
    """
    dt = period / chain.steps
    run = simulate(chain.scene(period), chain.cycles * period, method="edmc", dt=dt, save_every=dt)
    t = (chain.cycles - chain.folded + (np.arange(chain.folded * PHASES * FINE) + 0.5) / (PHASES * FINE)) * period
    tension = np.interp(t, run.t, run.tension("anchor-fairlead")[:, -1])
    phase = np.floor(t / period % 1.0 * PHASES + 0.5).astype(int) % PHASES
    means = np.bincount(phase, tension, PHASES) / np.bincount(phase, minlength=PHASES)
    return Folded(means, float(tension.reshape(chain.folded, -1).max(axis=1).mean()), run.status, run.message)


def beside_measured(folded: Folded, period: float) -> dict:
    """What a folded tension differs by from the measured one: rms, peak, mean, and the tension where slack is taken up [N]."""
    measured = np.array(MEASURED[period])
    error = folded.tension - measured
    return {
        "rms_N": float(np.sqrt(np.mean(error**2))),
        "peak_N": folded.peak,
        "peak_error_percent": 100.0 * (folded.peak / PEAK[period] - 1.0),
        "mean_N": float(folded.tension.mean()),
        "mean_error_percent": 100.0 * float(folded.tension.mean() / measured.mean() - 1.0),
        "taken_up_N": float(folded.tension[TAKEN_UP].mean()),
        "taken_up_measured_N": float(measured[TAKEN_UP].mean()),
        "status": folded.status,
        "reason": folded.reason,
    }


@dataclass(frozen=True)
class Fit:
    """A chain whose numbers were fitted to the measured tension of one period, and standard errors of the numbers."""

    chain: Chain
    errors: dict[str, float]


def fit(chain: Chain, steps: dict[str, float], period: float, rounds: int) -> Fit:
    """Fit numbers of a chain to the folded tension of one period, by Gauss and Newton's method with differences.

    Parameters
    ----------
    chain : where the search starts
    steps : for each number that is fitted, the difference by which its slopes are taken
    period : float [s]
    rounds : of the method; the tension is nearly linear in these numbers
    """
    measured, names = np.array(MEASURED[period]), list(steps)
    for _ in range(rounds):
        now = fold(chain, period).tension
        slopes = np.column_stack(
            [
                (fold(replace(chain, **{name: getattr(chain, name) + step}), period).tension - now) / step
                for name, step in steps.items()
            ]
        )
        change, *_ = np.linalg.lstsq(slopes, measured - now, rcond=None)
        chain = replace(chain, **{name: float(getattr(chain, name) + one) for name, one in zip(names, change, strict=True)})
    left = measured - now - slopes @ change
    variance = left @ left / (len(measured) - len(names)) * np.diag(np.linalg.inv(slopes.T @ slopes))
    return Fit(chain, dict(zip(names, np.sqrt(variance).tolist(), strict=True)))
