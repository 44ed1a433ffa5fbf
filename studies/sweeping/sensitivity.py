r"""How much of the variance of a measure each input makes: Sobol' indices of a sample `saltelli:n`, with intervals.

First order: $S_i = \mathrm{Var}(\mathrm{E}(y \mid x_i)) / \mathrm{Var}(y)$, what input i makes alone. Total order:
$S_{Ti} = 1 - \mathrm{Var}(\mathrm{E}(y \mid x_{\sim i})) / \mathrm{Var}(y)$, what it makes in any way, also with others. The
estimators are scipy's.

Source: A. Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, table 2 (b) and (f).
"""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from anet_lumped.checks import InputError
from studies.sweeping.row_log import read_meta
from studies.sweeping.sampling import MATRIX, POINT

RESAMPLES, CONFIDENCE = 500, 0.95
INDICES = ("first", "first_low", "first_high", "total", "total_low", "total_high")
ROUNDED = 1e-12  # of a measure's size: a spread below it is that of rounding


class SensitivityError(InputError):
    """A table that sensitivities cannot be taken from."""


def sensitivities(table, inputs: Iterable[str], measures: Iterable[str], seed: int = 0):
    """Sobol' indices of each measure to each input, with intervals of 95 % by resampling the points.

    Points of which a row has no number for a measure are left out of that measure, and of the others the first 2^k are taken,
    which a Sobol' sequence needs.

    Parameters
    ----------
    table : DataFrame of a sweep with a sample `saltelli:n`
    inputs : names of what was varied
    measures : names of what was measured; those that are words or do not vary are left out
    seed : of the resampling

    Returns
    -------
    DataFrame : a line for each measure and input: `first`, `total` [-], `first_low`, `first_high`, `total_low`, `total_high`,
        and of how many `points`

    Raises
    ------
    SensitivityError : the table is of another sample
    """
    import pandas
    from scipy.stats import sobol_indices

    inputs = list(inputs)
    if MATRIX not in table or POINT not in table:
        raise SensitivityError("Sensitivities are taken from a sample saltelli:n, but these rows are of none.")
    matrices = ["A", "B", *(f"A with {name} of B" for name in inputs)]
    lines = []
    for measure in measures:
        numbers = pandas.to_numeric(table[measure], errors="coerce").where(table["status"] == "done").astype(float)
        by_matrix = pandas.DataFrame({POINT: table[POINT], MATRIX: table[MATRIX], "y": numbers}).pivot(
            index=POINT, columns=MATRIX, values="y"
        )
        y = by_matrix.reindex(columns=matrices).replace([np.inf, -np.inf], np.nan).dropna().sort_index().to_numpy().T
        n = 2 ** int(np.log2(y.shape[1])) if y.shape[1] else 0
        y = y[:, :n]
        if n < 2 or np.ptp(y) <= ROUNDED * np.abs(y).max():
            continue

        def indices(chosen, y=y, n=n):
            at = y[:, chosen]
            found = sobol_indices(func={"f_A": at[:1], "f_B": at[1:2], "f_AB": at[2:, np.newaxis]}, n=n)
            return np.stack([found.first_order.ravel(), found.total_order.ravel()])  # of one measure

        random = np.random.default_rng(seed)
        resampled = np.stack([indices(random.integers(n, size=n)) for _ in range(RESAMPLES)])
        low, high = np.quantile(resampled, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0)
        first, total = indices(np.arange(n))
        for i, name in enumerate(inputs):
            numbers = first[i], low[0, i], high[0, i], total[i], low[1, i], high[1, i]
            lines.append({"measure": measure, "input": name, **dict(zip(INDICES, map(float, numbers), strict=True)), "points": n})
    return pandas.DataFrame(lines, columns=["measure", "input", *INDICES, "points"])


def save_sensitivities(out: Path, table):
    """The sensitivities of a sweep whose folder is `out`, also as `sensitivities.csv` there; None for a sweep of another kind."""
    identity = (read_meta(out / "meta.json") or {}).get("identity", {})
    if not str(identity.get("sample", "")).startswith("saltelli"):
        return None
    found = sensitivities(table, identity["vary"], identity["measures"])
    found.to_csv(out / "sensitivities.csv", index=False)
    return found
