"""A figure for a narrow screen: the panels that stand side by side one below the other, each with its own labels."""

WIDTH, HEIGHT = 4.6, 3.3  # [inch] of a figure, and of each panel
LEGEND_LINE = 0.19  # [inch]
LONG = 26  # characters of a legend's entry beside which no other one fits


def stack_panels(figure) -> bool:
    """Put the panels of a figure one below the other; False, and nothing is done, where it has one column or another layout.

    Parameters
    ----------
    figure : matplotlib Figure, of one grid of panels, with a constrained layout
    """
    panels = [axes for axes in figure.axes if axes.axison]
    grids = {axes.get_gridspec() for axes in figure.axes}
    if len(grids) != 1 or None in grids or next(iter(grids)).ncols == 1 or len(panels) < 2:
        return False
    for axes in figure.axes:
        if axes not in panels:
            axes.remove()
    below = [(axes, *_anchor(axes)) for axes in panels]
    labels = [(_label(axes, panels, "x"), _label(axes, panels, "y")) for axes in panels]
    grid = figure.add_gridspec(len(panels), 1)
    lines = sum(_lines(legend) for legend in figure.legends)
    figure.set_size_inches(WIDTH, HEIGHT * len(panels) + LEGEND_LINE * lines)
    for axes, place, (x, y) in zip(panels, grid, labels, strict=True):
        axes.set_subplotspec(place)
        axes.tick_params(labelleft=True, labelbottom=True)
        axes.set(xlabel=x, ylabel=y)
    for legend in list(figure.legends):
        handles, words = legend.legend_handles, [text.get_text() for text in legend.get_texts()]
        looks = {"title": legend.get_title().get_text() or None, "frameon": False, "fontsize": 8}
        legend.remove()
        figure.legend(handles, words, loc="outside lower center", ncols=_columns(words), **looks)
    below = [one for one in below if one[2] < 0.0]
    if below:  # whose legends lie so far below them as they did; to lay out takes as long as to draw
        figure.get_layout_engine().execute(figure)
    for axes, x, distance in below:
        axes.get_legend().set_bbox_to_anchor((x, distance / axes.bbox.height), transform=axes.transAxes)
    return True


def _anchor(axes):
    """Where a panel's legend is anchored: x over the width of the panel, and y from its bottom in points of the screen."""
    legend = axes.get_legend()
    if legend is None:
        return 0.0, 0.0
    anchor = legend.get_bbox_to_anchor()
    return (anchor.x0 - axes.bbox.x0) / axes.bbox.width, anchor.y0 - axes.bbox.y0


def _label(axes, panels, x):
    """Label of an axis of a panel: its own, or the one below the last panel of its column or beside the first of its row."""
    place, getter = axes.get_subplotspec(), f"get_{x}label"
    along, towards = ("colspan", "rowspan") if x == "x" else ("rowspan", "colspan")
    fellows = [other for other in panels if getattr(other.get_subplotspec(), along) == getattr(place, along)]
    fellows.sort(key=lambda other: getattr(other.get_subplotspec(), towards).start, reverse=x == "x")
    return getattr(axes, getter)() or getattr(fellows[0], getter)()


def _columns(labels):
    return 1 if any(len(label) > LONG for label in labels) else 2


def _lines(legend):
    labels = [text.get_text() for text in legend.get_texts()]
    return -(-len(labels) // _columns(labels))
