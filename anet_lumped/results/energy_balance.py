"""The account of energy of a run: where it went, and what of that a method took that no force took."""

import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from integrators import schemes

KINETIC, ELASTIC, POTENTIAL, WORK, BY_DAMPERS, BY_EFFECTS, BY_METHOD = range(7)  # columns of `Run.energy`
COLUMNS = ("kinetic", "elastic", "potential", "work", "by dampers", "by effects", "by method")
SWINGS = 16  # parts of a run, in one of which a swing is taken to come to its largest kinetic energy at least once
UNDIVIDED = ("kinetic", "elastic", "potential", "work", "dissipated")  # in files of version 0.1


@dataclass(frozen=True)
class EnergyBalance:
    """Changes of energy over a run [J]: kinetic + elastic + potential = work - dissipated.

    Parameters
    ----------
    kinetic, elastic, potential : float
        Of the moving nodes, of the cables' springs, and of all effects: gravity, bending, buoyancy, ground, laws of one's own.
    work : float
        Done by driven points and by what changes rest lengths, and what payloads bring or take with them.
    dissipated : float
        All that was taken: by dampers, effects and the method.
    by_dampers : float or None
        Taken by the dampers of cables. None in runs saved by version 0.1, which does not tell the three apart.
    by_effects : float or None
        Taken by drag, friction and other effects, by pick-ups and by breaks; negative where they give energy, as a wind does.
    by_method : float or None
        Taken by the method, or given by it if negative; no part of the physics. Of `edmc` it is what its numerical damping took,
        of the other methods of this package all that no force accounts for, see `book_remainder`. Of other packages' methods 0.
    in_play : float
        The largest energy that was moved between its forms, put in or dissipated.
    imbalance : float
        What does not add up, over ``in_play``.
    """

    kinetic: float
    elastic: float
    potential: float
    work: float
    dissipated: float
    by_dampers: float | None
    by_effects: float | None
    by_method: float | None
    in_play: float
    imbalance: float

    @staticmethod
    def of(rows: np.ndarray) -> "EnergyBalance":
        """Balance of saved rows, with the columns `COLUMNS`, or `UNDIVIDED` of a run saved by version 0.1 [J]."""
        divided = rows.shape[1] == len(COLUMNS)
        change = (rows[-1] - rows[0]).tolist()
        kinetic, elastic, potential, work = change[:BY_DAMPERS]
        dissipated = 0.0
        for taken in change[BY_DAMPERS:]:  # `sum` rounds in another way from Python 3.12 on
            dissipated += taken
        in_play = energy_in_play(rows)
        off = abs(kinetic + elastic + potential - work + dissipated)
        by_dampers, by_effects, by_method = change[BY_DAMPERS:] if divided else (None, None, None)
        return EnergyBalance(
            kinetic,
            elastic,
            potential,
            work,
            dissipated,
            by_dampers,
            by_effects,
            by_method,
            in_play=in_play,
            imbalance=off / in_play if in_play else 0.0,
        )

    @property
    def gravitational(self) -> float:
        """The name of `potential` in version 0.1."""
        warnings.warn("EnergyBalance.gravitational is called potential since version 0.2.", DeprecationWarning, stacklevel=2)
        return self.potential

    @property
    def unaccounted(self) -> float:
        """Change of energy that neither work nor what was taken accounts for [J]; negative where energy was lost in the steps."""
        return self.kinetic + self.elastic + self.potential - self.work + self.dissipated

    @property
    def lost_to_method(self) -> float:
        """What the method took [J]: what it booked, and what its steps lost that nothing accounts for."""
        return max(self.by_method or 0.0, 0.0) + max(-self.unaccounted, 0.0)

    @property
    def method_share(self) -> float:
        """What the steps took or gave, booked or not, over ``in_play``: the error of a method that means to keep the energy."""
        return abs((self.by_method or 0.0) - self.unaccounted) / self.in_play if self.in_play else 0.0


def energy_in_play(rows: np.ndarray) -> float:
    """The largest energy that was moved between its forms, put in or dissipated [J].

    Of rows with the columns `COLUMNS` or `UNDIVIDED`.
    """
    columns = np.ascontiguousarray(rows.T)  # of many rows, a sum along a row of seven takes ten times as long
    largest, least = columns[: WORK + 1].max(axis=1).tolist(), columns[: WORK + 1].min(axis=1).tolist()
    work, potential = float(columns[WORK, 0]), largest[POTENTIAL] - least[POTENTIAL]
    dissipated = float(np.abs((columns[BY_DAMPERS:] - columns[BY_DAMPERS:, :1]).sum(axis=0)).max())
    moved = largest[KINETIC], largest[ELASTIC], potential, largest[WORK] - work, work - least[WORK], dissipated
    return math.nan if any(map(math.isnan, moved)) else max(moved)  # NaN of a run that diverged, if one is


def energies_in_play(rows: np.ndarray) -> np.ndarray:
    """As `energy_in_play` up to each saved time, (k,) [J]."""
    columns = np.ascontiguousarray(rows.T)  # of many rows, a sum along a row of seven takes ten times as long
    potential = np.maximum.accumulate(columns[POTENTIAL]) - np.minimum.accumulate(columns[POTENTIAL])
    largest = np.maximum(columns[KINETIC], columns[ELASTIC])
    dissipated = (columns[BY_DAMPERS:] - columns[BY_DAMPERS:, :1]).sum(axis=0)
    for other in (potential, np.abs(columns[WORK] - columns[WORK, 0]), np.abs(dissipated)):
        np.maximum(largest, other, out=largest)
    return np.maximum.accumulate(largest)


def lost_share(energy: np.ndarray) -> float:
    """Share of the energy in play that the method took and that nothing accounts for."""
    with np.errstate(invalid="ignore"):  # infinite energies of a run that diverged
        change = energy[-1] - energy[0]
    unaccounted = change[: POTENTIAL + 1].sum() - change[WORK] + change[BY_DAMPERS:].sum()
    lost = float(max(change[BY_METHOD], 0.0) + max(-unaccounted, 0.0))
    return min(lost / max(energy_in_play(energy), 1e-300), 1.0) if lost > 0.0 else 0.0


def moved_share(energy: np.ndarray) -> np.ndarray:
    """Largest share of the energy in play that the steps have taken or given, and not given back soon, up to each saved time, (k,).

    The energy of a symplectic method swings with the motion; what it has at all of some saved times in a row is no such swing.
    """
    from scipy.ndimage import minimum_filter1d  # a third of a second to import

    change = energy - energy[0]
    gained = change[:, : POTENTIAL + 1].sum(axis=1) - change[:, WORK] + change[:, BY_DAMPERS : BY_EFFECTS + 1].sum(axis=1)
    width = 2 * max(1, len(energy) // SWINGS) + 1
    moved = np.maximum(minimum_filter1d(gained, width, mode="nearest"), minimum_filter1d(-gained, width, mode="nearest"))
    share = np.where(moved > 0.0, np.minimum(moved / np.maximum(energies_in_play(energy), 1e-300), 1.0), 0.0)
    return np.maximum.accumulate(share)


def book_remainder(rows: np.ndarray) -> None:
    """Book to the method what neither work nor forces account for since the first row; ``rows`` (k, 7) [J] are changed."""
    rows[:, BY_METHOD] = 0.0
    gained = rows[:, :WORK].sum(axis=1) - rows[:, WORK] + rows[:, BY_DAMPERS:].sum(axis=1)
    rows[:, BY_METHOD] = gained[0] - gained


def error_of_steps(run: Any) -> float:
    """Energy of a run that its steps took or gave although its method means to take none, over the energy in play.

    What `edmc` books it means to take.
    """
    balance = run.energy_balance
    return balance.imbalance if schemes.scheme(run.method).books_its_losses else balance.method_share
