"""A run as a page: it needs nothing but itself, stays small, and holds the numbers of the run; and which endings there are."""

import base64
import json
import re
import shutil
import subprocess
import webbrowser
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from looked_at import breaking
from systems import loose_cable

from anet_lumped import Body, Cable, Fixed, Free, InputError, Scene, load_scene, simulate, waves, wind
from anet_lumped.effects import Air, Gravity, Ground, Water
from anet_lumped.views.motion import motion_of
from anet_lumped.views.page import page_text
from anet_lumped.views.surroundings import surroundings

MOST = 3_000_000  # bytes
SINGLE = 2.0**-24  # relative rounding of float32


class Page(HTMLParser):
    """Elements of a page with their attributes, its text, and the content of its scripts."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.elements, self.scripts, self.text, self.inside = [], [], "", ""
        self.feed(text)
        self.content = json.loads(self.scripts[0])

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        self.inside = tag
        if tag == "script":
            self.scripts.append("")

    def handle_data(self, data):
        if self.inside == "script":
            self.scripts[-1] += data
        elif self.inside != "style":
            self.text += data

    def handle_endtag(self, tag):
        self.inside = ""

    def array(self, name):
        return np.frombuffer(base64.b64decode(self.content["states"][name]), "<f4")


@pytest.fixture(scope="module")
def carried():
    return simulate(load_scene("net_carried"), 4.0, method="edmc", dt=0.01, save_every=0.01)


@pytest.fixture(scope="module")
def page(carried):
    return page_text(carried, "carried")


def test_a_page_of_four_hundred_states_is_small_and_says_that_all_are_shown(page, carried):
    assert len(carried.t) == 401 and len(page.encode()) < MOST
    assert "All 401 saved states are shown." in Page(page).text


def test_a_page_loads_nothing(page):
    found = Page(page)
    for tag, attributes in found.elements:
        assert tag not in ("link", "img", "iframe", "object", "embed", "base", "form"), tag
        assert not {"src", "href", "srcset", "action", "data"} & set(attributes), (tag, attributes)
    (policy,) = [a["content"] for tag, a in found.elements if a.get("http-equiv") == "Content-Security-Policy"]
    assert policy.startswith("default-src 'none';") and "http" not in policy
    assert set(re.findall(r"\w+://[^\s\"'`)]*", page)) <= {"http://www.w3.org/1999/xhtml"}  # the name of a kind of elements
    assert "@import" not in page and "url(" not in page
    for word in ("fetch(", "XMLHttpRequest", "WebSocket", "import("):
        assert word not in found.scripts[2], word


def test_a_page_holds_the_licence_of_what_draws_it(page):
    assert "The MIT License" in page and "three.js authors" in page


def test_the_numbers_of_a_run_are_on_its_page(page, carried):
    found = Page(page)
    q = found.array("q").reshape(carried.q.shape) + found.content["middle"]
    np.testing.assert_allclose(q, carried.q, atol=SINGLE * np.abs(carried.q).max())
    np.testing.assert_allclose(found.array("t"), carried.t, rtol=SINGLE)
    tension = found.array("tension").reshape(carried.segment_tension.shape)
    np.testing.assert_allclose(tension, carried.segment_tension, rtol=SINGLE)
    assert found.content["ends"] == carried.model.ends.tolist()
    named = {one["name"]: (one["kind"], one["node"]) for one in found.content["points"]}
    assert named == {p.name: ("driven" if p.name != "p0" else "free", carried.model.node(p.name)) for p in carried.scene.points}
    assert found.content["full_scale"] == carried.segment_tension.max()


def test_states_are_thinned_to_what_a_page_may_take(carried):
    text = page_text(carried, "carried", most=900_000)
    found = Page(text)
    t = found.array("t")
    each = 4 / 3 * 4 * (1 + carried.q[0].size + carried.segment_tension[0].size)
    assert 900_000 - 2 * each < len(text.encode()) <= 900_000  # one more would be too much
    assert t[0] == 0.0 and t[-1] == 4.0 and np.ptp(np.diff(t)) < 0.0101  # evenly, but for the times that are saved
    assert f"{len(t)} of 401 saved states are shown, evenly thinned" in found.text
    k = np.searchsorted(carried.t, t - 1e-6)
    q = found.array("q").reshape(len(t), -1, 3) + found.content["middle"]
    np.testing.assert_allclose(q, carried.q[k], atol=SINGLE * np.abs(carried.q).max())


def test_a_run_whose_states_are_too_large_is_refused(carried):
    with pytest.raises(
        InputError, match=r"A page must not have more than 6e[+]05 bytes, but two states of this run of 81 nodes take"
    ):
        page_text(carried, "carried", most=600_000)  # what draws them takes that already


def test_peaks_of_the_tension_outlast_thinning():
    """Of a run of more times than the curves have, whose largest tension is in one state alone."""
    run = simulate(loose_cable(segments=1), 2.0, method="edmc", dt=1e-3, save_every=1e-3)
    tension = run.segment_tension.copy()
    tension[778] = 99.0
    content = Page(page_text(replace(run, segment_tension=tension), "peak")).content
    curve = np.frombuffer(base64.b64decode(content["curves"]["tension"]), "<f4")
    assert len(curve) == 1200 and np.count_nonzero(curve == 99.0) == 1
    assert content["full_scale"] < 99.0  # one state of 2001 does not take the colours from all the others


def test_a_break_is_on_the_page():
    run = breaking()
    (event,) = run.events
    found = Page(page_text(run, "break"))
    gone = [t for t in found.content["broken_at"] if t is not None]
    assert gone == [event.t] and found.content["broken_at"][run.model.segments("rope")][event.segment] == event.t
    assert found.content["events"] == [{"t": event.t, "text": str(event)}] and "A segment that broke is gone." in found.text


def test_strange_names_are_text():
    name = "</script><script>alert(1)</script>\n<!--"
    found = Page(page_text(breaking(name), name))
    assert len(found.scripts) == 3 and found.content["points"][1]["name"] == name.replace("\n", "\\n")
    assert "alert(1)" not in "".join(found.scripts[1:])


@pytest.mark.filterwarnings("ignore::anet_lumped.motion.simulate.StabilityWarning")
def test_a_run_that_failed_says_so(carried):
    run = simulate(carried.scene, 1.0, method="verlet", dt=0.01)
    found = Page(page_text(run, "bad"))
    assert (
        "p",
        {"class": "bad"},
    ) in found.elements and f"DIVERGED (verlet, t = 0 to {run.t[-1]:.4g} s): {run.message}" in found.text
    assert f"Warning: {run.warnings[0]}" in found.text
    q = run.q.copy()
    q[-1] = np.nan
    assert "1 states are not finite, and left out." in Page(page_text(replace(run, q=q), "bad")).text
    with pytest.raises(InputError, match="must have a finite state"):
        page_text(replace(run, q=np.full_like(q, np.inf)), "bad")


def test_the_box_of_a_fall_without_cables_has_all_of_it():
    """What falls for a second goes g/2, however small it is, and has its own size."""
    body = Body("stone", mass=1.0, inertia=(1e-4,) * 3, at=(0.0, 0.0, 0.0))
    run = simulate(Scene([], [], [Gravity(9.81)], bodies=[body]), 1.0, start="straight")
    assert np.ptp(motion_of(run).box, axis=0) == pytest.approx((0.0, 0.0, 0.5 * 9.81), abs=2.0 * body.radius)


def test_nodes_that_a_run_has_thrown_away_do_not_make_the_rest_small():
    run = breaking()
    q = run.q.copy()
    q[-1, :5] *= 1e7
    box = np.ptp(motion_of(replace(run, q=q)).box, axis=0)
    assert box[:2].tolist() == [0.0, 0.0] and 10.0 < box[2] < 25.0  # m, of a metre of cable


def test_a_run_far_from_its_origin_keeps_its_digits():
    """In coordinates of a map, where float32 has steps of half a metre."""
    far = np.array([5e5, 4e6, 0.0])
    points = [Fixed("a", far), Free("b", at=far + np.array([1.0, 0.0, 0.0]))]
    run = simulate(Scene(points, loose_cable().cables, [Gravity()]), 0.1, start="straight", method="edmc", dt=0.01)
    content = Page(page_text(run, "far")).content
    q = np.frombuffer(base64.b64decode(content["states"]["q"]), "<f4").reshape(run.q.shape)
    lengths = np.linalg.norm(np.diff(q[:, run.model.nodes("a-b")], axis=1), axis=2)
    near = np.linalg.norm(np.diff(run.q_near[:, run.model.nodes("a-b")], axis=1), axis=2)
    np.testing.assert_allclose(lengths, near, atol=4 * SINGLE)  # of coordinates up to 1 m
    np.testing.assert_allclose(content["middle"], run.q.reshape(-1, 3).min(axis=0) / 2 + run.q.reshape(-1, 3).max(axis=0) / 2)


def test_what_is_around_a_scene():
    points = [Fixed("a", (0, 0, 0)), Free("b", volume=1e-3)]
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e4, segments=2, diameter=0.01)
    wave = waves.Airy(height=1.0, period=4.0, direction=(0, 2, 0), phase=0.5, ramp=2.0)
    effects = [
        Gravity(), Ground(height=-3.0, normal=(0, 3, 4)), Water(level=-1.0, wave=wave, current=wind.Uniform((0, 0.5, 0))),
        Air(wind=[wind.Uniform((3, 0, 0)), wind.Uniform((0, 4, 0))]),
    ]  # fmt: skip
    found = surroundings(Scene(points, [cable], effects), np.array([10.0, 5.0, 2.0]))
    assert found.ground.normal.tolist() == [0.0, 0.6, 0.8] and found.ground.height == pytest.approx(
        -3.0 - 0.6 * 5 - 0.8 * 2, abs=1e-12
    )
    assert (found.water.normal.tolist(), found.water.height) == ([0.0, 0.0, 1.0], -3.0)
    assert found.wind.tolist() == [3.0, 4.0, 0.0] and found.current.tolist() == [0.0, 0.5, 0.0]
    k = (2 * np.pi / 4.0) ** 2 / 9.81  # in deep water
    assert (found.wave.amplitude, found.wave.k, found.wave.ramp) == (0.5, pytest.approx(k), 2.0)
    assert np.cos(found.wave.phase) == pytest.approx(np.cos(0.5 + 5.0 * k), abs=1e-12)  # at the new origin
    profile = wind.PowerLaw(5.0, 10.0, 0.2)
    other = surroundings(Scene(points, [cable], [Gravity(), Air(wind=[profile, wind.Uniform((1, 0, 0))])]), np.zeros(3))
    assert (other.ground, other.water, other.wave, other.wind, other.current) == (None,) * 5  # a profile has no one velocity


def test_without_a_path_a_page_is_opened(monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    file = breaking().view()
    assert opened == [file.as_uri()] and file.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    shutil.rmtree(file.parent)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("run.htm", "A view of a run must end in .html, .pvd, .gif, .mp4, but it is 'run.htm'"),
        ("run", "A view of a run must end in"),
        ("", "A view must be given the path of the file to write"),
        (3, "A view must be given the path of the file to write, but it is 3"),
        (".", "A view must be written to a regular file, but . is a folder"),
    ],
)
def test_an_ending_that_is_not_known_is_refused(path, message, carried):
    with pytest.raises(InputError, match=re.escape(message)):
        carried.view(path)


@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs chromium")
def test_a_browser_draws_the_page(tmp_path):
    """Its scripts run to their end: the time, the scale and the names of points are written."""
    breaking().view(tmp_path / "run.html")
    flags = (
        "--headless --no-sandbox --no-first-run --disable-background-networking --disable-component-update --disable-sync".split()
    )
    flags += [
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--virtual-time-budget=4000",
        f"--user-data-dir={tmp_path}/user",
    ]
    done = subprocess.run(
        ["chromium", *flags, "--dump-dom", (tmp_path / "run.html").as_uri()], capture_output=True, text=True, timeout=120
    )
    assert '<p id="time" aria-live="off">t = 0.0000 s</p>' in done.stdout
    assert '<span id="full">' in done.stdout and '<p id="nothing" hidden="">' in done.stdout
    assert re.search(r'<span class="" style="transform: [^"]*">b</span>', done.stdout)
