"""A sweep as a picture: each measure over the input with most values, a curve for each value of the others; seeds: a histogram.

Of a sample, in which every row has other values of all inputs: marks over the input that each measure goes with most.
"""

import numpy as np

from anet_lumped.views.palette import BLACK, BLUE, VERMILION, look
from studies.sweeping.sampling import MATRIX, POINT

PANELS, CURVES = 6, 8  # that a figure shows at most
EVEN = 0.05  # of the mean: how much steps between the logarithms of values may differ for a logarithmic axis
BINS = 20
WITHOUT = ("status", "reason", POINT, MATRIX)


def plot_sweep(table, inputs, heads=None):
    """Figure of a sweep.

    Parameters
    ----------
    table : pandas.DataFrame, as `sweep` returns it
    inputs : names of the columns that were varied
    heads : names of columns with their units, or None

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    heads = heads or {}
    done = table[table["status"] == "done"]
    numbers = [name for name in table if name not in (*inputs, *WITHOUT) and _is_numeric(done[name])]
    varied = [name for name in inputs if _is_numeric(table[name]) and table[name].nunique() > 1]
    along = max(varied, key=lambda name: table[name].nunique(), default=None)
    shown = [name for name in numbers if done[name].notna().any()][:PANELS]
    rows, columns = max(1, -(-len(shown) // 2)), min(2, max(1, len(shown)))
    figure = Figure(figsize=(5.2 * columns, 0.6 + 3.2 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel in panels[len(shown) :]:
        panel.set_visible(False)
    for panel, name in zip(panels, shown, strict=False):
        panel.ticklabel_format(useOffset=False)
        if along is None or along.rpartition(".")[2] == "seed":
            _histogram(panel, done[name].dropna())
            panel.set(xlabel=_words(heads.get(name, name)), ylabel="rows")
        else:
            over = _goes_with(done, name, varied) if POINT in table else along
            if POINT in table:
                panel.plot(done[over], done[name], ".", color=BLUE)
            else:
                _curves(panel, done, name, along, [other for other in inputs if other != along])
            panel.set(xlabel=_words(heads.get(over, over)), ylabel=_words(heads.get(name, name)))
            panel.set_xscale("log" if _is_logarithmic(table[over]) else "linear")
        panel.spines[["top", "right"]].set_visible(False)
    handles, labels = panels[0].get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside upper left", ncols=4, frameon=False, fontsize=8)
    told = [f"{len(table) - len(done)} of {len(table)} rows are not done"] if len(done) < len(table) else []
    told += [f"{len(shown)} of {len(numbers)} measures are drawn"] if len(shown) < len(numbers) else []
    if told:
        figure.supxlabel("; ".join(told), fontsize=8, color=VERMILION if len(done) < len(table) else "0.4", x=0.99, ha="right")
    return figure


def save_sweep(table, inputs, heads, folder):
    """Write the figure of a sweep into a folder, as sweep.png."""
    from anet_lumped.regular_files import check_target

    check_target(folder / "sweep.png", "A figure")
    plot_sweep(table, inputs, heads).savefig(folder / "sweep.png", dpi=110)


def _is_numeric(column):
    from pandas.api.types import is_bool_dtype, is_numeric_dtype

    return is_numeric_dtype(column) and not is_bool_dtype(column)


def _is_logarithmic(column):
    values = np.unique(column[np.isfinite(column)])
    if len(values) < 3 or values[0] <= 0.0:
        return False
    steps = np.diff(np.log(values))
    return values[-1] / values[0] > 10.0 and bool(np.ptp(steps) < EVEN * steps.mean() * len(steps))


def _histogram(panel, values):
    panel.hist(values, bins=min(BINS, max(1, len(values) // 3)), color=BLUE, edgecolor="white")
    panel.axvline(values.mean(), color=BLACK, ls="--", lw=1.2, label="mean")
    panel.axvline(values.max(), color=VERMILION, ls=":", lw=1.6, label="largest")


def _curves(panel, done, name, along, others):
    groups = list(done.groupby(others, sort=False)) if others else [((), done)]
    for k, (values, rows) in enumerate(groups[:CURVES]):
        rows = rows.sort_values(along)
        label = ", ".join(f"{other} = {_short(value)}" for other, value in zip(others, values, strict=True)) if others else None
        style = look(k)
        panel.plot(rows[along], rows[name], label=label, ms=4, lw=1.2, **style)
    if len(groups) > CURVES:
        words, place = f"{CURVES} of {len(groups)} curves", {"xycoords": "axes fraction", "ha": "right", "va": "bottom"}
        panel.annotate(words, (0.99, 0.01), fontsize=7, color="0.4", **place)


def _goes_with(done, name, inputs):
    """The input with which a measure goes up or down most, by the correlation of their ranks."""
    ranks = done[[*inputs, name]].rank()
    with np.errstate(invalid="ignore"):  # of a measure that is the same in all rows
        return max(inputs, key=lambda one: np.nan_to_num(abs(ranks[one].corr(ranks[name]))))


def _short(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _words(name):
    return name.replace("_", " ")
