"""Rainflow counting of a tension over time: the cycles by which a cable fatigues.

With n_i cycles of the range R_i (1/2 for a half cycle), and a curve of fatigue N R^m = const, the same damage is done by one range

    R_eq = (sum n_i R_i^m/(f T))^(1/m)

repeated at a frequency f over the time T: the damage-equivalent range.

Source: ASTM E1049-85 (2017), 5.4.4, by the package `rainflow`; Miner, J. Appl. Mech. 12 (1945) A159.
"""

from typing import NamedTuple

import numpy as np

from anet_lumped.checks import check_number


class Cycles(NamedTuple):
    """Cycles of a quantity over time.

    Parameters
    ----------
    ranges, means : (c,) float64, of each cycle, in the unit of the quantity
    counts : (c,) float64, 1, or 1/2 for a half cycle
    begin, end : (c,) float64 [s], times of the turning points of each
    duration : float [s], of the whole series
    """

    ranges: np.ndarray
    means: np.ndarray
    counts: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    duration: float

    def equivalent(self, exponent: float = 3.0, frequency: float = 1.0) -> float:
        """Damage-equivalent range R_eq, in the unit of the quantity.

        Parameters
        ----------
        exponent : float, m of the fatigue curve; 3 for chain, about 5 for wire rope (DNV-OS-E301)
        frequency : float [Hz], f
        """
        m = check_number("exponent", exponent, "", "`equivalent`", sign="positive")
        f = check_number("frequency", frequency, "Hz", "`equivalent`", sign="positive")
        largest = float(self.ranges.max(initial=0.0))
        if largest == 0.0:
            return 0.0
        damage = float(self.counts @ (self.ranges / largest) ** m) / (f * self.duration)
        return float(largest * damage ** (1.0 / m))


def cycles(t: np.ndarray, values: np.ndarray) -> Cycles:
    """Rainflow cycles of a series.

    Parameters
    ----------
    t : (k,) float64 [s]
    values : (k,) float64

    Returns
    -------
    Cycles
    """
    from rainflow import extract_cycles

    rows = list(extract_cycles(np.asarray(values, float).tolist()))
    size, mean, count, first, last = np.array(rows, float).reshape(-1, 5).T
    return Cycles(size, mean, count, t[first.astype(int)], t[last.astype(int)], float(t[-1] - t[0]))
