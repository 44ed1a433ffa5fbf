"""Tensions as pictures: over time, and the least, mean and largest along each cable."""

from typing import Any

import numpy as np

from anet_lumped.checks import printable

from .palette import look, width

CABLES = 8  # that a panel shows at most: those with the largest tensions
ROOM = 36  # letters of four names in a legend, which a panel has room for
Loaded = list[tuple[str, np.ndarray]]


def plot_tension(run: Any) -> Any:
    """Figure of tensions: their range along each cable, and where each is largest over time.

    Parameters
    ----------
    run : Run

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.2), layout="constrained")
    along, over_time = figure.subplots(1, 2)
    cables = most_loaded(run)
    draw_range(along, run, cables)
    draw_over_time(over_time, run, cables)
    for panel in (along, over_time):
        panel.spines[["top", "right"]].set_visible(False)
    return figure


def draw_range(axes: Any, run: Any, cables: Loaded) -> None:
    """Draw the least, mean and largest tension of each segment over all saved times, along some cables."""
    for k, (name, T) in enumerate(cables):
        own, middles = look(k), _middles(run.scene.cable(name))
        axes.fill_between(middles, T.min(axis=0), T.max(axis=0), color=own["color"], alpha=0.15, lw=0)
        for edge in (T.min(axis=0), T.max(axis=0)):
            axes.plot(middles, edge, color=own["color"], lw=0.8, ls=own["linestyle"])
        axes.plot(middles, T.mean(axis=0), color=own["color"], lw=width(k, len(cables)), ls=own["linestyle"], label=name)
    axes.set(xlabel="length along the cable, not stretched [m]", ylabel="least, mean and largest tension [N]")
    _name_cables(axes, run)


def draw_over_time(axes: Any, run: Any, cables: Loaded) -> None:
    """Draw the tension of the segment of each of some cables where it becomes largest over time."""
    for k, (name, T) in enumerate(cables):
        own, largest = look(k), T[:, np.unravel_index(np.argmax(T), T.shape)[1]]
        axes.plot(run.t, largest, color=own["color"], lw=width(k, len(cables)), ls=own["linestyle"], label=name)
    for event in run.events:
        axes.axvline(event.t, color="0.8", lw=1, zorder=0)
    axes.set(xlabel="t [s]", ylabel="largest tension [N]")
    _name_cables(axes, run)


def _middles(cable: Any) -> np.ndarray:
    """(segments,) where the middles of the segments of a cable are along it [m]."""
    return cable.length * (np.arange(cable.segments) + 0.5) / cable.segments


def most_loaded(run: Any) -> Loaded:
    """Names of the cables with the largest tensions, in the order of the scene, and those tensions (k, segments) [N]."""
    finite = np.where(np.isfinite(run.segment_tension), run.segment_tension, 0.0)
    peaks = {cable.name: finite[:, run.model.segments(cable.name)].max() for cable in run.scene.cables}
    chosen = sorted(peaks, key=lambda name: -peaks[name])[:CABLES]
    return [(cable.name, run.tension(cable.name)) for cable in run.scene.cables if cable.name in chosen]


def _name_cables(axes: Any, run: Any) -> None:
    if not run.scene.cables:
        return
    columns = 4 if sum(map(len, axes.get_legend_handles_labels()[1][:4])) <= ROOM else 2
    axes.legend(frameon=False, fontsize=8, ncols=columns, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    for text in axes.get_legend().get_texts():
        text.set(text=printable(text.get_text()), parse_math=False)  # names may hold $
    if len(run.scene.cables) > CABLES:
        axes.annotate(
            f"the {CABLES} of {len(run.scene.cables)} cables with the largest tensions", (0.99, 0.01), xycoords="axes fraction",
            ha="right", va="bottom", fontsize=7, color="0.4",
        )  # fmt: skip
