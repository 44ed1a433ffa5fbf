"""A figure on disk: one way to write the powers of ten of its axes, and a file that is not too heavy for a page."""

from dataclasses import dataclass
from pathlib import Path

from studies.shown.narrow_figure import stack_panels
from studies.shown.sentences import power

MARGIN = 0.1  # [inch] around what is drawn
HEAVY = 400_000  # bytes of an SVG above which a figure of thousands of marks becomes a PNG


@dataclass(frozen=True)
class Picture:
    """A figure's file, its caption, its file for a narrow screen if that is another, and whether a page shows it only on demand."""

    file: Path
    caption: str
    narrow: Path | None = None
    on_demand: bool = False


def save_figure(figure, stem: Path, caption: str, on_demand: bool = False) -> Picture:
    """Write a figure as SVG, or as PNG where an SVG would make a page heavy."""
    from matplotlib import pyplot

    _write_powers_of_ten(figure)
    file = _saved(figure, stem)
    narrow = _saved(figure, stem.with_name(f"{stem.name}_narrow")) if stack_panels(figure) else None
    pyplot.close(figure)
    return Picture(file, caption, narrow, on_demand)


def _saved(figure, stem):
    layout = figure.get_layout_engine()
    if layout is not None:  # once: each draw would lay out anew, and with an engine, even one that does nothing, two are made
        layout.execute(figure)
        figure.set_layout_engine(None)
    box = figure.get_tightbbox().padded(MARGIN)
    file = stem.with_name(stem.name + ".svg")
    figure.savefig(file, bbox_inches=box)
    if file.stat().st_size > HEAVY:
        file.unlink()
        file = stem.with_name(stem.name + ".png")
        figure.savefig(file, bbox_inches=box, dpi=160)
    figure.set_layout_engine(layout)
    return file


def _write_powers_of_ten(figure):
    """Have logarithmic axes say 1e-4, as the tables and sentences do."""
    from matplotlib.ticker import LogFormatter, LogFormatterSciNotation

    class PowerFormatter(LogFormatterSciNotation):
        """The ticks that matplotlib would label, in our way."""

        def __call__(self, value, position=None):
            return power(value, 2) if super().__call__(value, position) else ""

    children = [child for axes in figure.axes for child in axes.child_axes]
    for axis in (axis for axes in [*figure.axes, *children] for axis in (axes.xaxis, axes.yaxis)):
        if isinstance(axis.get_major_formatter(), LogFormatter):
            axis.set_major_formatter(PowerFormatter())
        if isinstance(axis.get_minor_formatter(), LogFormatter):
            axis.set_minor_formatter(PowerFormatter(labelOnlyBase=False))
