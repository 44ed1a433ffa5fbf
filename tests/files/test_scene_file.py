"""Scene files: what is written comes back equal, and what is wrong is named with its place."""

import json
import math
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from tried import tried

from anet_lumped import attach, equilibrium, tensioned
from anet_lumped.effects import Bending, Gravity, ViscousDamping
from anet_lumped.files import scene_file
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.prescribed.paths import harmonic, line, samples
from anet_lumped.scene.as_dict import scene_from_dict, scene_to_dict
from anet_lumped.scene.scene import COMPRESSION, Cable, Driven, Fixed, Free, Scene, SceneError

SCENES = sorted(scene_file.SCENES.glob("*.toml"))

number = st.floats(-1e12, 1e12)
positive = st.floats(1e-12, 1e12)
amount = st.floats(0.0, 1e12)
vector = st.tuples(number, number, number)
ramp = st.just(0.0) | st.floats(1e-6, 1e3)
name = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=6).filter(str.strip)
path = st.one_of(
    st.builds(line, vector, vector, ramp),
    st.builds(harmonic, vector, vector, amount, number, ramp),
    st.lists(vector, min_size=2, max_size=4).map(lambda xyz: samples(range(len(xyz)), xyz)),
)
damping = st.one_of(st.fixed_dictionaries({"zeta": amount}), st.fixed_dictionaries({"BA": amount}))
effect = st.one_of(st.builds(Gravity, amount, st.just((0.0, 3.0, -1.0))), st.builds(ViscousDamping, amount))


@st.composite
def scenes(draw):
    names = draw(st.lists(name, min_size=2, max_size=4, unique=True))
    points = [
        draw(st.one_of(
            st.builds(Fixed, st.just(own), vector),
            st.builds(Driven, st.just(own), path),
            st.builds(Free, st.just(own), amount, st.none() | vector),
        ))
        for own in names
    ]  # fmt: skip
    cables = [
        Cable(
            *pair,
            length=draw(positive),
            mass_per_length=draw(positive),
            EA=draw(positive),
            segments=draw(st.integers(1, 10**6)),
            compression=draw(st.sampled_from(COMPRESSION)),
            name=draw(st.none() | st.just(f"cable {i}")),
            **draw(damping),
        )
        for i, pair in enumerate(zip(names, [*names[1:], names[0]], strict=True))
    ]
    if len({cable.name for cable in cables}) < len(cables):  # names such as "a" and "-a-" can build the same label
        cables = cables[:-1]
    return Scene(points, cables, draw(st.lists(effect, max_size=2, unique_by=type)))


@tried(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(scene=scenes())
def test_round_trip(tmp_path, scene):
    save_scene(scene, tmp_path / "scene.toml")
    assert load_scene(tmp_path / "scene.toml") == scene
    assert scene_from_dict(json.loads(json.dumps(scene_to_dict(scene)))) == scene


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_bundled_scene(file, tmp_path):
    scene = load_scene(file)
    save_scene(scene, tmp_path / "again.toml")
    assert load_scene(tmp_path / "again.toml") == scene
    assert file.read_text().startswith("# ")
    assert scene.gravity.tolist() == [0.0, 0.0, -9.81]
    for cable in scene.cables:
        if cable.name not in ("line1", "tether"):
            assert (cable.length, cable.mass_per_length, cable.EA, cable.segments) == (1.0, 0.1, 1e4, 20)


def test_the_scenes_that_are_bundled():
    names = [
        "loose_cable",
        "mooring",
        "net_carried",
        "net_flown",
        "net_held",
        "quadrotor_hover",
        "quadrotors_break",
        "quadrotors_gust",
    ]
    names += ["quadrotors_net", "quadrotors_scoop", "tether", "thesis_single_cable", "thesis_two_cables"]
    assert [file.stem for file in SCENES] == names


def test_the_mooring_hangs_from_the_bottom_as_a_catenary():
    """T = H + w z at the height z above the bottom, where a part of it lies and carries H."""
    rest = equilibrium(load_scene("mooring"))
    T, z = rest.tension("line1"), rest.shape("line1")[:, 2] + 200.0
    w = (113.35 - 1025.0 * math.pi / 4 * 0.0766**2) * 9.81
    assert T[5] == pytest.approx(T[0], rel=1e-6)  # it lies there, sunk in by next to nothing, and rubs on nothing at rest
    assert T[-1] - T[0] == pytest.approx(w * (z[-2] + z[-1]) / 2, rel=5e-3)  # of a chain that does not stretch: here by 1e-3


def test_a_bundled_scene_is_read_by_its_name_and_a_file_of_that_name_goes_first(tmp_path, monkeypatch):
    assert load_scene("net_held") == load_scene(scene_file.SCENES / "net_held.toml")
    with pytest.raises(SceneError, match='There is no scene and no file "net_hel", did you mean "net_held"'):
        load_scene("net_hel")
    (tmp_path / "net_held").write_text((scene_file.SCENES / "loose_cable.toml").read_text())
    monkeypatch.chdir(tmp_path)
    assert load_scene("net_held") == load_scene("loose_cable")


def test_carried_net_is_the_held_one_set_in_motion():
    held, carried = (load_scene(SCENES[0].with_stem(stem)) for stem in ("net_held", "net_carried"))
    assert held.cables == carried.cables and held.effects == carried.effects
    for still, moving in zip(held.points[:4], carried.points[:4], strict=True):
        assert moving.path == line(still.at, (0.2, 0.0, 0.0), 1.0)
    assert held.point("p0") == carried.point("p0") == Free("p0", mass=0.036)


def test_flown_net_is_the_carried_one_at_the_speed_of_the_thesis():
    carried, flown = (load_scene(SCENES[0].with_stem(stem)) for stem in ("net_carried", "net_flown"))
    assert [replace(cable, diameter=None) for cable in flown.cables] == list(carried.cables) and flown.effects == carried.effects
    for slow, fast in zip(carried.points[:4], flown.points[:4], strict=True):
        assert fast.path == line(slow.path.at(0.0)[0], (0.0, 5.0, 0.0), 2.0)


def test_saved_vectors_stay_on_one_line(tmp_path):
    save_scene(load_scene("net_carried"), tmp_path / "net.toml")
    assert "\nvelocity = [0.2, 0.0, 0.0]\n" in (tmp_path / "net.toml").read_text()


HEAD = """
points = [{name = "s0", kind = "fixed", at = [0, 0, 0]}, {name = "p0", kind = "free"}]
[cable_defaults]
length = 1
EA = 1e4
segments = 20
"""
CABLE = '[[cables]]\nstart = "s0"\nend = "p0"\nmass_per_length = 0.1\n'


def test_defaults_are_expanded_and_overruled(tmp_path):
    (tmp_path / "net.toml").write_text(HEAD + CABLE + "EA = 5\n" + CABLE + 'name = "second"\n')
    scene = load_scene(tmp_path / "net.toml")
    assert [cable.EA for cable in scene.cables] == [5.0, 1e4] and scene.effects == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            HEAD + CABLE * 2 + CABLE + "lenght = 1",
            r"^net.toml, cables\[2\]: unknown key `lenght`, did you mean `length`",
        ),
        (HEAD + CABLE + "wind = 1", r"cable .s0-p0.: unknown key `wind`; known: `start`, `end`, `length`"),
        (HEAD + "mas_per_length = 1\n" + CABLE, r"cable_defaults: unknown key .*, did you mean `mass_per_length`\?"),
        (HEAD + 'name = "x"\n' + CABLE, r"net.toml, cable_defaults: unknown key `name`"),
        (HEAD + "[[cable]]", r"net.toml: unknown key `cable`, did you mean `cables`\?"),
        (HEAD + CABLE.replace("mass_per_length = 0.1", ""), r"cable .s0-p0.: key `mass_per_length` is missing\."),
        (HEAD + CABLE + 'EA = "1e4"', r"cable .s0-p0.: key `EA` has the wrong type: .*number, but it is '1e4'"),
        (HEAD + CABLE + "segments = 2.5", r"cable .s0-p0.: key `segments` has the wrong type: .*integer, but it is 2.5"),
        (HEAD + CABLE + "EA = -inf", r"cable .s0-p0.: Argument `EA` must be positive and finite \[N\], .* has EA=-inf"),
        (HEAD + CABLE + 'compression = "nome"', r"cable .s0-p0.: .*`compression` must be .* did you mean \"none\"\?"),
        (HEAD + CABLE.replace("p0", "p1"), r'net.toml: Argument `end` must name a point .* did you mean "p0"\?'),
        (HEAD + CABLE * 2, r'net.toml: Names of cables must be unique, but two cables are named "s0-p0"'),
        (HEAD, r"net.toml: `cables` must be an array of at least one table, \[\[cables\]\], but is missing"),
        ("points = 3", r"net.toml: `points` must be an array of at least one table, \[\[points\]\], but is 3"),
        ("points = [3]", r"net.toml, points\[0\]: must be a table of keys and values, but is 3"),
        ('points = [{name = "a"}]', r'point .a.: key `kind` is missing; a point is one of "fixed", "driven", "free"'),
        ('points = [{kind = "fixd"}]', r"points\[0\]: unknown kind of point 'fixd', did you mean \"fixed\"\?"),
        ('points = [{kind = "bolted"}]', r"points\[0\]: unknown kind of point 'bolted'; known: \"fixed\", \"driven\""),
        ('points = [{kind = "fixed", name = "a", at = [0, 0]}]', r"point .a.: Argument `at` must be three .* has at=\(0, 0\)"),
        (
            'points = [{kind = "fixed", name = "a", at = [0, 0, "1"]}]',
            r"`at\[2\]` has the wrong type: .* but it is '1'",
        ),
        (
            'points = [{kind = "fixed", name = "a", at = [0, 0, 1, 2]}]',
            r"point .a.: Argument `at` must be three finite numbers \(x, y, z\) \[m\], .* has at=\(0, 0, 1, 2\)",
        ),
        ('points = [{kind = "fixed", name = "a", at = [0, 0, nan]}]', r"point .a.: Argument `at` must be three"),
        ('points = [{kind = "driven", name = "a"}]', r"point .a.: key `path` is missing"),
        ('points = [{kind = "driven", path = 3}]', r"points\[0\].path: must be a table of keys and values, but is 3"),
        (
            'points = [{kind = "driven", path = {kind = "lin"}}]',
            r"\[0\].path: unknown kind of path 'lin', did you mean \"line\"",
        ),
        ('points = [{kind = "driven", path = {kind = "line", sart = 1}}]', r"path: unknown key `sart`, did .*`start`"),
        (
            'points = [{kind = "driven", path = {kind = "line", start = [0, 0, 0], velocity = [1, 0, 0], ramp = -1}}]',
            r"net.toml, points\[0\].path: Argument `ramp` must be non-negative",
        ),
        (HEAD + CABLE + "[effects.gravty]", r"effects.gravty: unknown effect 'gravty', did you mean \"gravity\"\?"),
        (HEAD + CABLE + "[effects.gravity]\nG = 9", r"net.toml, effects.gravity: unknown key `G`, did you mean `g`\?"),
        (
            HEAD + CABLE + "[effects.xyz]",
            r"unknown effect 'xyz'; known: .* An effect of your own is known in Python, once",
        ),
        (HEAD.replace("EA", "Ea") + CABLE, r"cable_defaults: unknown key `Ea`, did you mean `EA`\?"),
        (HEAD + CABLE + "[effects.gravity]\ng = -9", r"net.toml, effects.gravity: Argument `g` must be"),
        (HEAD + CABLE + "[effects.viscous_damping]", r"net.toml, effects.viscous_damping: key `rate` is missing"),
        ("points = ", r"scene file must be valid TOML, but .*net.toml: Invalid value"),
    ],
)
def test_messages(tmp_path, text, message):
    (tmp_path / "net.toml").write_text(text)
    with pytest.raises(SceneError, match=message):
        load_scene(tmp_path / "net.toml")


def test_unreadable_files(tmp_path):
    with pytest.raises(SceneError, match=r"must be readable, but .*none.toml: No such file"):
        load_scene(tmp_path / "none.toml")
    (tmp_path / "net.toml").write_bytes(b"\xff")
    with pytest.raises(SceneError, match=r"must be UTF-8 text, but .*net.toml"):
        load_scene(tmp_path / "net.toml")


def test_dict_names_its_source():
    with pytest.raises(SceneError, match=r"^scene: unknown key `point`, did you mean `points`\?"):
        scene_from_dict({"point": []})


def test_none_is_accepted_where_the_argument_may_be_none():
    entries = {
        "points": [{"kind": "fixed", "name": "a", "at": [0, 0, 0]}, {"kind": "free", "name": "b", "at": None}],
        "cables": [{"start": "a", "end": "b", "length": 1.0, "mass_per_length": 0.1, "EA": 1e3, "segments": 2, "diameter": 0.1}],
        "effects": {"gravity": {}, "air": {"wind": None}},
    }
    scene = scene_from_dict(entries)
    assert scene.point("b").at is None and scene.effects[1].wind is None
    for key, kind in (("EA", "number"), ("name", "string")):  # their default None stands for what is found elsewhere
        with pytest.raises(
            SceneError, match=rf"(cable .a-b.|cables\[0\]): key `{key}` has the wrong type: .*{kind}, but it is None"
        ):
            scene_from_dict(entries | {"cables": [entries["cables"][0] | {key: None}]})


def test_clamps_of_a_scene_file_may_be_a_table():
    entries = scene_to_dict(
        Scene(
            [Fixed("a", [0, 0, 0]), Free("b")],
            [Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1.0, EI=1.0, segments=2)],
            [Bending({"a": [0, 0, 1]})],
        )
    )
    assert scene_from_dict(entries | {"effects": {"bending": {"clamped": {"a": [0, 0, 1]}}}}) == scene_from_dict(entries)
    with pytest.raises(SceneError, match=r"effects.bending: key `clamped\[2\]` has the wrong type: .*number, but it is 'x'"):
        scene_from_dict(entries | {"effects": {"bending": {"clamped": {"a": [0, 0, "x"]}}}})


def test_what_all_cables_have_alike_is_said_once(tmp_path):
    alike = {"length": 1.2, "mass_per_length": 0.1, "segments": 2, "BA": 3.0}
    points = [Fixed("a", (0, 0, 0)), Fixed("b", (1, 0, 0)), Free("c")]
    scene = Scene(points, [Cable("a", "c", EA=1e4, **alike), Cable("b", "c", EA=2e4, **alike)], [Gravity()])
    save_scene(scene, tmp_path / "net.toml")
    text = (tmp_path / "net.toml").read_text()
    assert (text.count("mass_per_length"), text.count("BA"), text.count("EA =")) == (1, 1, 2)
    assert load_scene(tmp_path / "net.toml") == scene


SPAN = """
[effects.gravity]
[[points]]
name = "a"
kind = "fixed"
at = [0, 0, 0]
[[points]]
name = "b"
kind = "fixed"
at = [40, 0, 0]
[[cables]]
start = "a"
end = "b"
length = 41.0
mass_per_length = 0.5
EA = 1e6
segments = 20
"""
CLUMP = '[[attach]]\ncable = "a-b"\nlength = 10.0\nname = "clump"\nmass = 3.0\n'


def read(tmp_path, text):
    file = tmp_path / "span.toml"
    file.write_text(text, encoding="utf-8")
    return load_scene(file)


def test_points_on_a_cable_and_a_wanted_sag_are_those_of_python(tmp_path):
    event = '[[events]]\nkind = "payload_change"\npoint = "clump"\nt = 1.0\nmass = 0.0\n'
    second = '[[attach]]\ncable = "a-b"\nlength = 4\nname = "float"\n'
    found = read(tmp_path, SPAN + CLUMP + second + event)
    plain = read(tmp_path, SPAN)
    same = attach(plain, "a-b", {10.0: Free("clump", mass=3.0), 4.0: Free("float")})
    assert found.cables == same.cables and found.points == same.points and found.events[0].point == "clump"
    assert read(tmp_path, SPAN + '[[tensioned]]\ncable = "a-b"\nsag = 2.0\n') == tensioned(plain, "a-b", sag=2.0)
    both = read(tmp_path, SPAN + CLUMP + '[[tensioned]]\ncable = "a-b[2]"\nend_tension = 200.0\nat = "b"\n')
    assert equilibrium(both).end_tension("a-b[2]", "b") == pytest.approx(200.0, rel=1e-9)
    save_scene(both, tmp_path / "again.toml")
    assert load_scene(tmp_path / "again.toml") == both


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[[attach]]\ncable = "a-b"\nname = "c"\n', r"attach\[0\]: key `length` is missing"),
        ('[[attach]]\ncable = "a-b"\nlength = "10"\nname = "c"\n', r"attach\[0\]: key `length` has the wrong type"),
        (CLUMP.replace("mass", "mas"), r"attach\[0\]: unknown key `mas`, did you mean `mass`"),
        (CLUMP + CLUMP.replace("clump", "other"), r"attach\[1\]: points on a cable must be apart, but there is one at 10 m"),
        (CLUMP.replace("10.0", "50.0"), "span.toml: Points on a cable must be apart, between its ends"),
        (CLUMP.replace("a-b", "a-c"), 'span.toml: .*"a-c"'),
        ('[attach]\ncable = "a-b"\n', "`attach` must be an array of at least one table"),
        ('[[tensioned]]\nsag = 2.0\n', r"tensioned\[0\]: key `cable` is missing"),
        ('[[tensioned]]\ncable = "a-b"\nsags = 2.0\n', r"tensioned\[0\]: unknown key `sags`, did you mean `sag`"),
        ('[[tensioned]]\ncable = "a-b"\n', r"tensioned\[0\]: Exactly one of `sag`, `end_tension` and `lowest`"),
        ('[[tensioned]]\ncable = "a-b"\nend_tension = 0.1\n', r"tensioned\[0\]: No length of cable \"a-b\" has end_tension=0.1 N"),
        ('tensioned = 3\n', "`tensioned` must be an array of at least one table"),
    ],
)  # fmt: skip
def test_what_cannot_be_attached_or_wanted(tmp_path, text, message):
    with pytest.raises(SceneError, match=message):
        read(tmp_path, text + SPAN if text.startswith("tensioned =") else SPAN + text)
