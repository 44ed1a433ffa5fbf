"""Figures of states and of tensions: what is drawn is what there is."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from systems import four_cables, loose_cable

from anet_lumped import Cable, Fixed, Free, Scene, State, equilibrium, nets, paths, simulate
from anet_lumped.effects import Gravity
from anet_lumped.scene.scene import Driven
from anet_lumped.views.planes import along_with, planes_of
from anet_lumped.views.tension_figure import CABLES


def grid(size):
    """(size**2, 3) places on a level square."""
    return np.array([(x, y, 0.0) for x in range(size) for y in range(size)])


@pytest.mark.parametrize(
    ("extent", "planes"),
    [((2.0, 0.0, 1.0), [(0, 2)]), ((1.0, 2.0, 0.5), [(1, 2), (0, 2)]), ((3.0, 1.0, 0.01), [(0, 1)]), ((0.0, 0.0, 1.0), [(0, 2)])],
    ids=["upright", "in space", "level", "hanging"],
)
def test_planes_show_what_there_is(extent, planes):
    assert planes_of(np.array([np.zeros(3), extent])) == planes


def test_a_picture_goes_along_with_what_travels():
    q = grid(3)[None] + np.linspace(0.0, 40.0, 5)[:, None, None]
    moved, travels = along_with(q)
    assert travels and np.ptp(moved[..., 0]) == pytest.approx(2.0)
    same, travels = along_with(grid(3)[None] + np.linspace(0.0, 4.0, 5)[:, None, None])
    assert not travels and np.ptp(same[..., 0]) == 6.0


def test_the_lines_of_a_large_net_are_a_bitmap_of_its_vector_graphic(tmp_path):
    sizes = {}
    for meshes in (20, 40):  # 840 cables and 3280
        net = nets.grid((meshes, meshes), [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], cable={"mass_per_length": 0.1, "EA": 1e4})
        figure = State.of(Scene(net.points, net.cables)).plot()
        drawn = [lines for axes in figure.axes for lines in axes.findobj(LineCollection) if len(lines.get_paths()) > 100]
        assert len(drawn) > 0 and {lines.get_rasterized() for lines in drawn} == {meshes == 40}
        figure.savefig(tmp_path / "net.svg")
        sizes[meshes] = (tmp_path / "net.svg").stat().st_size
    assert sizes[40] < sizes[20]  # a bitmap does not grow with the lines


def test_a_rest_is_drawn_in_two_planes_coloured_by_tension():
    rest = equilibrium(four_cables())
    side, end, scale = rest.plot().axes
    pulling, slack = side.collections
    assert len(pulling.get_segments()) == rest.model.n_segments and len(slack.get_segments()) == 0
    np.testing.assert_allclose(pulling.get_segments()[0], rest.shape("s0-p0")[:2][:, [0, 2]], rtol=1e-12)
    assert (side.get_xlabel(), end.get_xlabel(), scale.get_ylabel()) == ("x [m]", "y [m]", "tension [N]")
    brightest = np.argmax(np.ravel(rest.segment_tension))
    assert pulling.get_colors()[brightest][0] == pytest.approx(0xF4 / 255, abs=0.01)  # the end of the scale


def test_slack_segments_are_grey_and_dotted():
    run = simulate(loose_cable(1e4), 0.05, method="edmc", dt=0.01, start="straight")
    pulling, slack = run.state(0).plot().axes[0].collections
    assert len(slack.get_segments()) == run.model.n_segments and len(pulling.get_segments()) == 0


def test_the_range_of_tensions_along_a_cable():
    run = simulate(loose_cable(1e4), 0.3, method="edmc", dt=0.01, start="straight")
    along, over_time = run.plot_tension().axes
    name = run.scene.cables[0].name
    T = run.tension(name)
    least, largest, mean = (line.get_ydata() for line in along.lines)
    np.testing.assert_array_equal(least, T.min(axis=0))
    np.testing.assert_array_equal(largest, T.max(axis=0))
    np.testing.assert_allclose(mean, T.mean(axis=0))
    assert along.lines[0].get_xdata()[0] == pytest.approx(0.5 / run.scene.cables[0].segments)
    assert over_time.lines[0].get_ydata().max() == T.max()


def test_many_cables_are_too_many_to_name():
    points = [Fixed("top", (0.0, 0.0, 0.0)), *(Free(f"$p{i}$", mass=1.0 + i) for i in range(CABLES + 2))]
    cables = [Cable("top", f"$p{i}$", length=1.0, mass_per_length=0.1, EA=1e4, segments=2) for i in range(CABLES + 2)]
    run = simulate(Scene(points, cables, [Gravity()]), 0.02, method="edmc", dt=0.01)
    along, _ = run.plot_tension().axes
    named = [text.get_text() for text in along.get_legend().get_texts()]
    assert named == [f"top-$p{i}$" for i in range(2, CABLES + 2)]
    assert along.texts[0].get_text() == f"the {CABLES} of {CABLES + 2} cables with the largest tensions"


def test_a_run_that_travels_is_drawn_about_its_mean():
    points = [Driven("a", paths.line((0, 0, 0), (20.0, 0, 0), 0.1)), Free("b", mass=1.0)]
    scene = Scene(points, [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=4)], [Gravity()])
    side = simulate(scene, 0.5, method="edmc", dt=0.01).plot().axes[0]
    assert side.get_xlabel() == "x - mean [m]" and np.ptp(side.dataLim.intervalx) < 2.0
