"""A run as a film: its pace, its pictures, and what is refused."""

from itertools import pairwise

import numpy as np
import pytest
from looked_at import breaking
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from PIL import Image

from anet_lumped import Cable, Driven, Free, InputError, Scene, paths, simulate
from anet_lumped.effects import Gravity
from anet_lumped.views import colours, film
from anet_lumped.views.film import pictures, write_film
from anet_lumped.views.motion import motion_of


def frames(file):
    """Pictures of a GIF, (frames, height, width, 3), and how long each is shown [ms]."""
    with Image.open(file) as film:
        found, shown = [], []
        for k in range(film.n_frames):
            film.seek(k)
            found.append(np.array(film.convert("RGB")))
            shown.append(film.info["duration"])
    return np.array(found), shown


def is_colour(picture, colour):
    """Which pixels are of a colour, but for what a palette of 256 colours rounds."""
    return np.abs(picture - 255.0 * np.array(to_rgb(colour))).max(axis=-1) < 12


def near(picture, colour):
    """Number of pixels of a colour."""
    return np.count_nonzero(is_colour(picture, colour))


def test_a_film_shows_the_motion(tmp_path):
    film, shown = frames(write_film(breaking(), tmp_path / "run.gif"))
    assert len(film) == 26 and shown == [80] * 26  # 2 s, of a motion of 0.3 s
    assert all((one != other).any() for one, other in pairwise(film))
    for picture in (film[0], film[-1]):
        assert near(picture, colours.POINTS["free"]) > 20 and near(picture, colours.POINTS["fixed"]) > 20
    column = int(np.median(np.nonzero(is_colour(film[0], colours.POINTS["free"]))[1]))
    whole, broken = (np.nonzero(is_colour(film[k][:, column - 2 : column + 3], colours.SLACK))[0] for k in (0, 4))
    assert 13 < broken.min() - whole.min() < 27  # the first segment has gone, 0.1 m of the 1.4 m that are 270 pixels


def test_a_film_keeps_the_pace_of_what_lasts_some_seconds():
    rows, rate = pictures(np.linspace(0.0, 4.0, 401), 12.5)
    assert rate == 12.5 and len(rows) == 51 and rows[0] == 0 and rows[-1] == 400 and set(np.diff(rows)) == {8}


@pytest.mark.parametrize(("span", "seconds"), [(0.1, 2.0), (100.0, 12.0)])
def test_what_is_short_is_slower_and_what_is_long_is_faster(span, seconds):
    rows, rate = pictures(np.linspace(5.0, 5.0 + span, 1001), 25.0)
    assert (len(rows) - 1) / rate == pytest.approx(seconds, abs=1 / rate)  # from the first picture to the last


def test_a_film_of_few_states_shows_each_once():
    rows, rate = pictures(np.array([0.0, 1.0, 1.1, 4.0]), 25.0)
    assert rows.tolist() == [0, 1, 2, 3] and rate == 1.0
    rows, rate = pictures(np.array([2.0]), 25.0)
    assert rows.tolist() == [0] and rate == 1.0


def test_an_mp4_needs_ffmpeg(monkeypatch, tmp_path):
    monkeypatch.setattr(FFMpegWriter, "isAvailable", lambda: False)
    with pytest.raises(InputError, match=r"An MP4 needs the program ffmpeg, which was not found; a \.gif needs none"):
        breaking().view(tmp_path / "run.mp4")


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="needs ffmpeg")
def test_an_mp4_is_written(tmp_path):
    assert breaking().view(tmp_path / "run.mp4").read_bytes()[4:8] == b"ftyp"


def test_another_ending_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"A film must end in \.gif or \.mp4, but it is"):
        write_film(breaking(), tmp_path / "run.avi")


def test_labels_of_a_tall_scene_are_in_the_picture():
    """A bottle that a hook carries along on 2 m of cord: the label of x was cut off below."""
    points = [Driven("hook", paths.line((0, 0, 0), (1.5, 0, 0), 1.0)), Free("bottle", mass=0.5)]
    scene = Scene(points, [Cable("hook", "bottle", length=2.0, mass_per_length=0.05, EA=1e4, segments=5)], [Gravity()])
    run = simulate(scene, 6.0, method="edmc", dt=0.02)
    figure, _, draw = film._drawing(run, motion_of(run))
    draw(0)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    axes = figure.axes[0]
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        label = axis.label.get_window_extent(canvas.get_renderer())
        assert label.x0 >= 0 and label.y0 >= 0 and label.y1 <= figure.bbox.height and axis.label.get_text().endswith("- mean [m]")
