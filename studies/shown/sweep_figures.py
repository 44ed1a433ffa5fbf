"""Figures of a sweep: curves over one input, heat maps over two, a matrix and parallel coordinates over more, distributions of
samples, sensitivities, and how a search went."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.views.palette import BLUE, GREY, ORANGE, SKY, look
from studies.shown.sentences import listed, power

MOST_PANELS, MOST_LINES = 6, 1000  # measures and inputs of a matrix; lines of parallel coordinates
FEW = 8  # values of an input that are told apart by colours
SCALE = "viridis"  # which grey prints and colour-blind readers keep in order


class SweepFigure(NamedTuple):
    """A figure and what it shows, in a sentence or two."""

    figure: Any
    caption: str


class Columns(NamedTuple):
    """Columns of a sweep's table: names of inputs, of measures that are numbers, and the units that are known."""

    inputs: Sequence[str]
    measures: Sequence[str]
    units: dict[str, str]

    def label(self, name: str) -> str:
        """Label of an axis."""
        unit = self.units.get(name)
        return f"{name} [{unit}]" if unit else name


def sweep_figures(table, columns: Columns, kind: str) -> Iterator[SweepFigure]:
    """The figures that suit the rows which are done.

    Parameters
    ----------
    table : DataFrame, rows with numbers
    columns : Columns
    kind : "grid", "sample" or "search"
    """
    varied = [name for name in columns.inputs if table[name].nunique() > 1]
    measures = columns.measures[:MOST_PANELS]
    if not varied or not measures or len(table) < 2:
        return
    numeric = [name for name in varied if table[name].dtype.kind in "iuf"]
    if len(varied) == 1 and numeric:
        yield _curves(table, columns, measures, numeric[0], None, kind)
    elif len(varied) == 2 and kind == "grid" and numeric:
        few = min(varied, key=lambda name: (name in numeric, table[name].nunique()))
        if few not in numeric or table[few].nunique() <= 2:
            yield _curves(table, columns, measures, next(name for name in reversed(numeric) if name != few), few, kind)
        else:
            yield _heat_maps(table, columns, measures, *numeric)
    elif len(varied) == 2 and len(numeric) == 2:
        yield _clouds(table, columns, measures, *numeric)
    else:
        yield from _of_many(table, columns, measures, numeric or varied)
    if kind == "sample":
        yield _distributions(table, columns, measures)


def _of_many(table, columns, measures, inputs):
    """A matrix of measures over inputs, and the rows as lines through all inputs, for the first measures."""
    if all(table[name].dtype.kind in "iuf" for name in inputs):
        yield _matrix(table, columns, measures, inputs[:MOST_PANELS])
        yield _parallel(table, columns, inputs, measures[0])


def _panels(count, width=4.2, height=3.4, across=3):
    from matplotlib.figure import Figure

    down = -(-count // across)
    figure = Figure(figsize=(width * min(count, across), height * down), layout="constrained")
    axes = figure.subplots(down, min(count, across), squeeze=False).ravel()
    for panel in axes:
        panel.spines[["top", "right"]].set_visible(False)
        panel.ticklabel_format(useOffset=False)  # 1.1815, and not 0.0005 with +1.181 in a corner
    for panel in axes[count:]:
        panel.remove()
    return figure, axes[:count]


def _is_wide(values):
    """Whether numbers want a logarithmic axis: all positive, over nearly two powers of ten, as samples of two are, or more."""
    values = np.asarray(values, float)
    return bool(values.min() > 0 and values.max() >= 50 * values.min())


def _scale(axis_of, values):
    if _is_wide(values):
        axis_of("log")


def _curves(table, columns, measures, over, by, kind):
    figure, axes = _panels(len(measures))
    for panel, measure in zip(axes, measures, strict=True):
        groups = [("", table)] if by is None else list(table.groupby(by))
        for i, (value, rows) in enumerate(groups):
            rows = rows.sort_values(over)
            style = look(i) if len(groups) > 1 else {"color": BLUE, "marker": "o", "linestyle": "-"}
            if kind != "grid":
                style["linestyle"] = ""
            panel.plot(rows[over], rows[measure], **style, ms=4, lw=1.2, label=f"{by} = {value}")
        _scale(panel.set_xscale, table[over])
        panel.set(xlabel=columns.label(over), ylabel=columns.label(measure))
        if 1 < len(groups) <= FEW:
            panel.legend(frameon=False, fontsize=8)
    by_which = f", a line for each {by}" if by is not None else ""
    return SweepFigure(figure, f"{_sentence(measures)} over {over}{by_which}. Each mark is a run.")


def _heat_maps(table, columns, measures, x, y):
    figure, axes = _panels(len(measures), 4.6, 3.6)
    for panel, measure in zip(axes, measures, strict=True):
        grid = table.pivot_table(index=y, columns=x, values=measure)
        image = panel.pcolormesh(_edges(grid.columns), _edges(grid.index), grid.to_numpy(), cmap=SCALE)
        _scale(panel.set_xscale, grid.columns)
        _scale(panel.set_yscale, grid.index)
        panel.set(xlabel=columns.label(x), ylabel=columns.label(y))
        figure.colorbar(image, ax=panel, label=columns.label(measure))
    return SweepFigure(figure, f"{_sentence(measures)} over {x} and {y}. White: no run that is done.")


def _edges(values):
    """Edges of cells (n + 1,) about n values, half way between them on the axis that `_scale` gives."""
    values = values.to_numpy(float)
    wide = _is_wide(values)
    at = np.log(values) if wide else values
    steps = np.diff(at) if len(at) > 1 else np.ones(1)
    edges = np.concatenate([[at[0] - 0.5 * steps[0]], at[:-1] + 0.5 * np.diff(at), [at[-1] + 0.5 * steps[-1]]])
    return np.exp(edges) if wide else edges


def _clouds(table, columns, measures, x, y):
    figure, axes = _panels(len(measures), 4.6, 3.6)
    for panel, measure in zip(axes, measures, strict=True):
        image = panel.scatter(table[x], table[y], c=table[measure], cmap=SCALE, s=14)
        _scale(panel.set_xscale, table[x])
        _scale(panel.set_yscale, table[y])
        panel.set(xlabel=columns.label(x), ylabel=columns.label(y))
        figure.colorbar(image, ax=panel, label=columns.label(measure))
    return SweepFigure(figure, f"{_sentence(measures)} over {x} and {y}. Each mark is a run.")


def _matrix(table, columns, measures, inputs):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(2.6 * len(inputs) + 0.6, 2.2 * len(measures) + 0.4), layout="constrained")
    axes = figure.subplots(len(measures), len(inputs), squeeze=False, sharex="col", sharey="row")
    for row, measure in zip(axes, measures, strict=True):
        for panel, name in zip(row, inputs, strict=True):
            panel.plot(table[name], table[measure], ".", color=BLUE, ms=3, alpha=0.6)
            panel.spines[["top", "right"]].set_visible(False)
        row[0].set_ylabel(columns.label(measure))
    for panel, name in zip(axes[-1], inputs, strict=True):
        _scale(panel.set_xscale, table[name])
        panel.set_xlabel(columns.label(name))
    return SweepFigure(
        figure, f"{_sentence(measures)} over each of {listed(inputs)}. Each mark is a run, whatever its other inputs."
    )


def _parallel(table, columns, inputs, measure):
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import LineCollection
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    names = [*inputs, measure]
    rows = table.sort_values(measure)
    rows = rows.iloc[np.unique(np.linspace(0, len(rows) - 1, min(len(rows), MOST_LINES)).astype(int))]
    values = np.column_stack([np.log10(rows[name]) if _is_wide(table[name]) else rows[name] for name in names]).astype(float)
    low, high = values.min(axis=0), values.max(axis=0)
    heights = (values - low) / np.where(high > low, high - low, 1.0)
    figure = Figure(figsize=(1.7 * len(names) + 1.4, 3.8), layout="constrained")
    axes = figure.subplots()
    scale = Normalize(rows[measure].min(), rows[measure].max())
    lines = np.stack([np.broadcast_to(np.arange(len(names)), heights.shape), heights], axis=2)
    axes.add_collection(LineCollection(lines, colors=colormaps[SCALE](scale(rows[measure])), lw=0.7, alpha=0.6))
    for i, name in enumerate(names):
        axes.axvline(i, color="k", lw=0.8)
        for end, y, at in ((table[name].min(), -0.02, "top"), (table[name].max(), 1.02, "bottom")):
            axes.text(i, y, power(float(end)), ha="center", va=at, fontsize=8)
    axes.set_xticks(range(len(names)), [columns.label(name) for name in names], fontsize=9)
    axes.tick_params(length=0, pad=14)
    axes.set(xlim=(-0.3, len(names) - 0.7), ylim=(-0.08, 1.08), yticks=[])
    axes.spines[:].set_visible(False)
    figure.colorbar(ScalarMappable(scale, SCALE), ax=axes, label=columns.label(measure))
    shown = f" {MOST_LINES} of {len(table)} runs are drawn." if len(rows) < len(table) else ""
    return SweepFigure(figure, f"Each run as a line through its inputs to its {measure}, which colours it.{shown}")


def _distributions(table, columns, measures):
    figure, axes = _panels(len(measures), 3.6, 2.8)
    for panel, measure in zip(axes, measures, strict=True):
        panel.hist(table[measure], bins="auto" if table[measure].nunique() > 1 else 1, color=SKY, edgecolor="white", lw=0.4)
        low, middle, high = np.quantile(table[measure], [0.05, 0.5, 0.95])
        for value, dashes in ((low, ":"), (middle, "-"), (high, ":")):
            panel.axvline(value, color=ORANGE, ls=dashes, lw=1.4)
        panel.set(xlabel=columns.label(measure), ylabel="runs")
    return SweepFigure(
        figure, f"How often each value of {listed(measures)} occurs. Lines: median, and what 5 % are below and above."
    )


def sensitivity_figure(found) -> SweepFigure:
    """Tornado of sensitivities: of each measure the inputs by their total order, with intervals."""
    measures = list(dict.fromkeys(found["measure"]))[:MOST_PANELS]
    inputs = found["input"].nunique()
    figure, axes = _panels(len(measures), 4.6, 0.5 * inputs + 1.3)
    for panel, measure in zip(axes, measures, strict=True):
        rows = found[found["measure"] == measure].sort_values("total")
        place = np.arange(len(rows))
        for index, shift, colour, words in (("total", 0.2, SKY, "total order"), ("first", -0.2, BLUE, "first order")):
            # resampled intervals may leave out the value itself by a hair
            error = np.abs(np.stack([rows[index] - rows[f"{index}_low"], rows[f"{index}_high"] - rows[index]]))
            panel.barh(place + shift, rows[index], 0.36, color=colour, label=words, xerr=error, error_kw={"lw": 1, "ecolor": "k"})
        panel.set_yticks(place, rows["input"])
        panel.set(xlabel="share of the variance [-]", title=measure, xlim=(min(0.0, rows["first_low"].min()), None))
    axes[0].legend(frameon=False, fontsize=8, loc="lower right")
    caption = (
        "What share of the variance of each measure each input makes: alone (first order), and also with others (total order). "
        "The thin bars hold 95 % of what other points would give."
    )
    return SweepFigure(figure, caption)


def search_figure(table, columns: Columns, objective: str, largest: bool, good) -> SweepFigure:
    """How a search went: the objective of each row, and the best so far of those that meet the constraints.

    Parameters
    ----------
    table : DataFrame in the order of the search
    columns : Columns
    objective : name of the measure
    largest : whether it is to be large
    good : (rows,) bool, which rows meet all constraints
    """
    figure, axes = _panels(1, 6.5, 3.4)
    numbers, values = np.arange(1, len(table) + 1), table[objective].to_numpy(float)
    axes[0].plot(numbers[~good], values[~good], ".", color=GREY, ms=3, label="do not meet the constraints")
    axes[0].plot(numbers[good], values[good], ".", color=BLUE, ms=3, label="runs")
    best = (np.maximum if largest else np.minimum).accumulate(np.where(good, values, -np.inf if largest else np.inf))
    axes[0].plot(numbers, np.where(np.isfinite(best), best, np.nan), color=ORANGE, lw=1.6, label="best so far")
    axes[0].set(xlabel="row", ylabel=columns.label(objective))
    axes[0].legend(frameon=False, fontsize=8)
    return SweepFigure(figure, f"How the search for the {'largest' if largest else 'least'} {objective} went.")


def _sentence(measures):
    text = listed(measures)
    return text[0].upper() + text[1:]
