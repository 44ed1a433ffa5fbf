"""The page of a sweep: what it shows of which sweep, and that it needs nothing but itself."""

import re
from concurrent.futures import ThreadPoolExecutor
from html.parser import HTMLParser

import numpy as np
import pandas
import pytest

from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from studies.command_line import main
from studies.shown.sweep_figures import Columns, search_figure, sensitivity_figure, sweep_figures
from studies.shown.sweep_page import SweepPageError, write_sweep_page
from studies.sweeping.parts import Shard
from studies.sweeping.row_log import RowsError
from studies.sweeping.rows import run_rows
from studies.sweeping.sweep import sweep


@pytest.fixture(scope="module")
def hanging():
    cable = Cable("top", "end", length=2.0, mass_per_length=0.1, EA=1e3, segments=5)
    return Scene([Fixed("top", (0.0, 0.0, 0.0)), Free("end", mass=0.5)], [cable], [Gravity(9.81)])


def done(hanging, out, vary, **options):
    with ThreadPoolExecutor(1) as executor:
        return sweep(hanging, vary, ["stretch", "tension:top"], out=out, executor=executor, **options)


class Page(HTMLParser):
    """Headings, pictures and addresses of a page."""

    def __init__(self, file):
        super().__init__()
        self.headings, self.addresses, self.captions, self.within = [], [], [], ""
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        self.within = tag
        self.addresses += [value for name, value in attributes if name in ("src", "href")]

    def handle_data(self, data):
        if self.within in ("h1", "h2") and data.strip():
            self.headings.append(data.strip())
        if self.within == "figcaption" and data.strip():
            self.captions.append(data.strip())


def test_the_page_of_a_grid_stands_alone_and_has_its_figures_rows_and_failures(hanging, tmp_path, capsys):
    done(hanging, tmp_path, {"EA": [-1.0, 1e3, 1e4, 1e5], "end.mass": [0.1, 0.2, 0.3]})
    with pytest.raises(SystemExit) as ended:
        main(["show", str(tmp_path)])
    file = tmp_path / "sweep.html"
    assert ended.value.code == 0 and capsys.readouterr().out.strip() == str(file)
    page = Page(file)
    assert page.headings[0] == "stretch and tension:top by EA and end.mass"
    assert {"Inputs", "Measures", "What failed", "What the inputs do", "The rows"} <= set(page.headings)
    assert page.addresses and all(address.startswith("data:image/") for address in page.addresses)
    assert not re.search(r"https?://(?!www\.w3\.org)", file.read_text(encoding="utf-8").split("What it was made with")[0])
    assert page.captions == ["Stretch and tension:top over EA and end.mass. White: no run that is done."]
    text = file.read_text(encoding="utf-8")
    assert "Argument `EA` must be positive" in text and "EA [N]" in text and "end.mass [kg]" in text


def test_the_page_of_a_sample_has_sensitivities_distributions_and_a_matrix(hanging, tmp_path):
    done(hanging, tmp_path, {"end.mass": "0.1:0.3", "length": "1:2", "EA": "1e3:2e3"}, sample="saltelli:8")
    page = Page(write_sweep_page(tmp_path, tmp_path / "page.html"))
    assert "Sensitivities" in page.headings
    beginnings = [
        "What share of the variance",
        "Stretch and tension:top over each of",
        "Each run as a line",
        "How often each value",
    ]
    assert len(page.captions) == len(beginnings)
    assert all(caption.startswith(words) for caption, words in zip(page.captions, beginnings, strict=True))


def test_the_page_of_a_sweep_that_still_runs_says_what_is_to_come(tmp_path):
    rows = [{"x": x} for x in range(10)]
    with ThreadPoolExecutor(1) as executor:
        run_rows(square, rows, executor=executor, out=tmp_path, shard=Shard(1, 2), identity=IDENTITY)
    assert "5 rows are still to come" in write_sweep_page(tmp_path, tmp_path / "page.html").read_text(encoding="utf-8")
    with ThreadPoolExecutor(1) as executor:
        run_rows(square, rows, executor=executor, out=tmp_path / "log", identity=IDENTITY)
    log = tmp_path / "log" / "rows.jsonl"
    log.write_bytes(log.read_bytes() + b'{"x": 1')  # a line that is being written
    assert Page(write_sweep_page(tmp_path / "log", tmp_path / "page.html")).captions == ["Y over x. Each mark is a run."]


IDENTITY = {"vary": {"x": list(range(10))}, "measures": ["y"], "settings": {}}


def square(row):
    return {"y": row["x"] ** 2}


def test_what_is_no_sweep_or_no_page_is_refused(tmp_path):
    with pytest.raises(RowsError, match=r"must hold meta\.json, but .* does not"):
        write_sweep_page(tmp_path, tmp_path / "page.html")
    with pytest.raises(SweepPageError, match=r"A page must end in \.html"):
        write_sweep_page(tmp_path, tmp_path / "page.pdf")
    with ThreadPoolExecutor(1) as executor:
        run_rows(square, [{"x": 1}], executor=executor, out=tmp_path, identity={"study": "order"})
    with pytest.raises(SweepPageError, match=r"the rows of .* are of something else"):
        write_sweep_page(tmp_path, tmp_path / "page.html")
    (tmp_path / "rows.jsonl").write_bytes(b"")
    with pytest.raises(RowsError, match="holds no rows"):
        write_sweep_page(tmp_path, tmp_path / "page.html")
    (tmp_path / "rows.jsonl").write_bytes(b"no row\n")
    with pytest.raises(RowsError, match=r"Rows must be whole to be read, but .*line 1, is no JSON"):
        write_sweep_page(tmp_path, tmp_path / "page.html")


# Figures --------------------------------------------------------------------------------------------------------------


def table_of(**columns):
    return pandas.DataFrame(columns)


def test_a_heat_map_has_each_value_where_its_inputs_are():
    x, y = (values.ravel() for values in np.meshgrid([1.0, 10.0, 100.0], [1.0, 2.0, 3.0, 4.0]))
    figure = next(sweep_figures(table_of(a=x, b=y, m=x * y), Columns(["a", "b"], ["m"], {"m": "N"}), "grid")).figure
    panel, bar = figure.axes
    mesh = panel.collections[0].get_array()
    np.testing.assert_array_equal(mesh, np.outer([1.0, 2.0, 3.0, 4.0], [1.0, 10.0, 100.0]))
    assert (panel.get_xscale(), panel.get_yscale()) == ("log", "linear")
    edges = panel.collections[0].get_coordinates()  # half way between the inputs, as the axes have them
    np.testing.assert_allclose(np.log10(edges[0, :, 0]), [-0.5, 0.5, 1.5, 2.5])
    np.testing.assert_allclose(edges[:, 0, 1], [0.5, 1.5, 2.5, 3.5, 4.5])
    assert (panel.get_xlabel(), bar.get_ylabel()) == ("a", "m [N]")


def test_words_are_lines_of_their_own():
    table = table_of(dt=[1.0, 2.0, 1.0, 2.0], method=["edmc", "edmc", "verlet", "verlet"], m=[1.0, 2.0, 3.0, 4.0])
    found = next(sweep_figures(table, Columns(["dt", "method"], ["m"], {"dt": "s"}), "grid"))
    assert [line.get_label() for line in found.figure.axes[0].lines] == ["method = edmc", "method = verlet"]
    assert found.figure.axes[0].get_xlabel() == "dt [s]" and "a line for each method" in found.caption


def test_nothing_is_drawn_of_nothing():
    assert not list(sweep_figures(table_of(a=[1.0], m=[1.0]), Columns(["a"], ["m"], {}), "grid"))
    assert not list(sweep_figures(table_of(a=[1.0, 2.0]), Columns(["a"], [], {}), "grid"))


def test_a_tornado_has_its_largest_bar_at_the_top():
    lines = [
        {"measure": "m", "input": name, "first": total / 2, "first_low": 0.0, "first_high": total, "total": total,
         "total_low": total / 2, "total_high": 2 * total, "points": 8}
        for name, total in (("a", 0.1), ("b", 0.7), ("c", 0.2))
    ]  # fmt: skip
    panel = sensitivity_figure(pandas.DataFrame(lines)).figure.axes[0]
    assert [label.get_text() for label in panel.get_yticklabels()] == ["a", "c", "b"]
    assert [bar.get_width() for bar in panel.patches[:3]] == [0.1, 0.2, 0.7]


def test_the_best_so_far_leaves_out_what_breaks_a_constraint():
    table, good = table_of(a=[1, 2, 3, 4], m=[5.0, 1.0, 4.0, 6.0]), np.array([True, False, True, True])
    lines = search_figure(table, Columns(["a"], ["m"], {}), "m", False, good).figure.axes[0].lines
    np.testing.assert_array_equal(lines[2].get_ydata(), [5.0, 5.0, 4.0, 4.0])


def test_a_sample_of_two_powers_of_ten_has_a_logarithmic_axis_and_numbers_are_written_in_full():
    """A sample of 1e3:1e5 misses its ends: marks crowded at one side. Tensions of 1.1815 N were 0.0005 with 1.181 in a corner."""
    EA = np.geomspace(1.02e3, 0.97e5, 30)
    columns = Columns(["EA"], ["tension"], {"tension": "N"})
    panel = next(sweep_figures(table_of(EA=EA, tension=1.181 + 1e-9 * EA), columns, "sample")).figure.axes[0]
    assert panel.get_xscale() == "log" and not panel.yaxis.get_major_formatter().get_useOffset()
    panel.figure.canvas.draw()
    assert not panel.yaxis.get_offset_text().get_text()
