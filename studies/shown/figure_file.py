"""A figure on disk: one way to write the powers of ten of its axes, and a file that is not too heavy for a page."""

from pathlib import Path

from studies.shown.sentences import power

HEAVY = 400_000  # bytes of an SVG above which a figure of thousands of marks becomes a PNG


def save_figure(figure, stem: Path) -> Path:
    """Write a figure as SVG, or as PNG where an SVG would make a page heavy; return the file."""
    from matplotlib import pyplot

    _write_powers_of_ten(figure)
    file = stem.with_name(stem.name + ".svg")
    figure.savefig(file, bbox_inches="tight")
    if file.stat().st_size > HEAVY:
        file.unlink()
        file = stem.with_name(stem.name + ".png")
        figure.savefig(file, bbox_inches="tight", dpi=160)
    pyplot.close(figure)
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
