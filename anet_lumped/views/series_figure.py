"""What was measured beside a run, over time: a panel for each channel, those that differ most first."""

from typing import Any

import numpy as np

from .palette import BLACK, VERMILION

PANELS = 8  # that a figure has at most


def plot_series(found: Any) -> Any:
    """Figure of a comparison of a run with measured series.

    Parameters
    ----------
    found : MotionMismatch

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    channels = [*found.tensions, *found.markers]
    shown = sorted(channels, key=lambda one: -one.rmse / max(one.measured_peak, 1e-300))[:PANELS]
    figure = Figure(figsize=(9.5, 0.8 + 1.9 * len(shown)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(len(shown), 1, sharex=True))
    for panel, channel in zip(panels, shown, strict=True):
        t, measured, model = found.curves[channel.name]
        marker = measured.shape[1] == 3
        for k in range(measured.shape[1]):
            panel.plot(t, measured[:, k], ".", color=BLACK, ms=2.5, label=None if k else "measured")
            panel.plot(t, model[:, k], color=VERMILION, lw=1.1, label=None if k else "model")
            if marker:
                panel.annotate("xyz"[k], (t[-1], model[-1, k]), xytext=(4, 0), textcoords="offset points", fontsize=8, va="center")
        panel.set_title(channel.name, fontsize=9, loc="left", parse_math=False)
        panel.set_ylabel("place [m]" if marker else "tension [N]")
        panel.spines[["top", "right"]].set_visible(False)
    panels[-1].set_xlabel("time of the run [s]")
    if len(shown) < len(channels):
        panels[-1].set_xlabel(f"time of the run [s]; the {len(shown)} of {len(channels)} channels that differ most")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2, frameon=False, fontsize=9)
    return figure
