"""Figures on a narrow screen: panels one below the other, each with its own labels, and a caption that says so."""

import numpy as np
import pandas
import pytest
from matplotlib.figure import Figure

from studies.shown.figure_file import save_figure
from studies.shown.narrow_figure import stack_panels
from studies.shown.page import Entry, State, write_page
from studies.study import Part, Record, Study
from studies.sweeping.provenance import provenance


def test_panels_stand_one_below_the_other():
    """Each has its own labels, and its legend is as far below as before."""
    figure = Figure(figsize=(9, 4), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for axes in panels:
        axes.plot([0, 1], [1, 2], label="a line")
        axes.set_xlabel("time [s]")
    panels[0].set_ylabel("place [m]")
    panels[1].legend(loc="upper center", bbox_to_anchor=(0.5, -0.3))
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", title="what")
    figure.draw_without_rendering()
    was = 0.3 * panels[1].bbox.height
    assert stack_panels(figure)
    upper, lower = (axes.get_position() for axes in panels)
    assert upper.y0 > lower.y1 and upper.x0 == pytest.approx(lower.x0) and panels[1].get_ylabel() == "place [m]"
    assert panels[1].bbox.y0 - panels[1].get_legend().get_bbox_to_anchor().y0 == pytest.approx(was, rel=1e-6)
    assert figure.legends[0].get_title().get_text() == "what"
    assert not stack_panels(figure)  # one column now


def test_a_label_is_that_of_the_row_or_the_column():
    figure = Figure(layout="constrained")
    panels = figure.subplots(2, 2)
    for row, name in zip(panels, ("place [m]", "pull [N]"), strict=True):
        row[0].set_ylabel(name)
    for axes, name in zip(panels[1], ("time [s]", "angle [rad]"), strict=True):
        axes.set_xlabel(name)
    assert stack_panels(figure)
    assert [axes.get_ylabel() for axes in panels.ravel()] == ["place [m]"] * 2 + ["pull [N]"] * 2
    assert [axes.get_xlabel() for axes in panels.ravel()] == ["time [s]", "angle [rad]"] * 2


@pytest.mark.parametrize("on_demand", [False, True])
def test_a_page_has_the_picture_and_the_caption_of_the_screen(tmp_path, on_demand):
    figure = Figure(layout="constrained")
    for axes in figure.subplots(1, 2):
        axes.plot(np.arange(3))
    picture = save_figure(figure, tmp_path / "both", "Left: steps. Right: the same.", on_demand)
    assert picture.narrow == tmp_path / "both_narrow.svg" and picture.narrow.exists()
    record, tables = Record("Why?", Part.WHY), {"rows": pandas.DataFrame({"a": [1.0]})}
    found = Study("order", record, False, tables, {"rows": "A line."}, {"both": picture}, ["So."], 1.0)
    entries = [Entry("order", "Why?", Part.WHY, State.DONE, found)]
    write_page(tmp_path / "page.html", entries, [Part.WHY], made=provenance(), command="study")
    page = (tmp_path / "page.html").read_text()
    assert '<source media="(max-width: 48rem)" srcset="data:image/svg+xml' in page
    assert ("<details><summary>both</summary>" in page) == on_demand
    assert ">Left: steps. Right: the same.</span>" in page and ">Above: steps. Below: the same.</span>" in page


def test_one_panel_is_one_picture(tmp_path):
    figure = Figure(layout="constrained")
    figure.subplots().plot([1, 2])
    assert save_figure(figure, tmp_path / "one", "A line.").narrow is None
