"""Scene files and MoorDyn files that are changed at random: each ends in a scene or in one sentence."""

import copy
import datetime
import math
import tomllib
import warnings

import pytest
import tomli_w
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from test_moordyn_file import DECK

from anet_lumped import InputError, SceneError, load_scene, read_moordyn
from anet_lumped.checks import LONGEST
from anet_lumped.scene.as_dict import DEEPEST

SCENE = """
[[points]]
name = "a"
kind = "fixed"
at = [0, 0, 0]
[[points]]
name = "d"
kind = "driven"
path = {kind = "line", start = [2, 0, 0], velocity = [0.1, 0, 0], ramp = 1.0}
[[points]]
name = "e"
kind = "driven"
path = {kind = "samples", t = [0, 1, 2.0], xyz = [[0, 1, 0], [0, 1.1, 0], [0, 1, 0]]}
[[points]]
name = "p"
kind = "free"
mass = 0.1
at = [1, 0, -0.5]
[cable_defaults]
segments = 4
diameter = 0.01
[[cables]]
start = "a"
end = "p"
length = 1.5
mass_per_length = 0.1
EA = 1e4
zeta = 0.1
[[cables]]
start = "d"
end = "p"
length = 1.6
mass_per_length = 0.1
tension_strain = [[0.01, 10.0], [0.02, 30.0]]
compression = "damped"
[[cables]]
start = "e"
end = "p"
name = "third"
length = 3.0
rope = "nylon"
[[events]]
kind = "payload_change"
point = "p"
t = 1.5
mass = 0.0
[effects.gravity]
g = 9.81
[effects.air]
wind = [{kind = "uniform", velocity = [1, 0, 0]}, {kind = "sampled", samples = [[0, 1, 0], [9, 2, 0]]}]
[effects.water]
level = -1.0
wave = {kind = "airy", height = 0.1, period = 3.0, direction = [1, 0, 0]}
[effects.axial_damping]
rate = {a-p = 0.1, third = 0.2}
[effects.load]
per_length = [0, 1, 0]
cables = ["a-p"]
[effects.temperature]
expansion = 1e-5
change = {kind = "harmonic", center = 1.0, amplitude = 2.0, frequency = 0.1}
[effects.line_change]
paid_out = {third = {kind = "line", start = 0.0, rate = 0.01, ramp = 1.0}}
"""
ENTRIES = tomllib.loads(SCENE)


def nested(depth, wrap):
    inner = wrap(1)
    for _ in range(depth):
        inner = wrap(inner)
    return inner


VALUES = [
    True, 0, 1, -1, 2**63, 10**400, math.nan, math.inf, -math.inf, 0.0, 1e308, -1e308, 5e-324, 1e-200, 1e100, 1e-100, "", " ", "p",
    "line", "a\nb\x1b[31m\u202e\0", "y" * 5000, [], {}, [1], [1, 2, 3], [1e308] * 3, [5e-324, 0, 0], [[1e-300, 1e300]], ["a", "a"],
    {"kind": "line"}, {"kind": 3}, {"a": {"kind": "line"}}, [{"kind": "uniform"}], datetime.datetime(2020, 1, 1), datetime.time(1),
    nested(20, lambda inner: [inner]), nested(60, lambda inner: [inner]), nested(60, lambda inner: {"a": inner}),
]  # fmt: skip
KEYS = ["x", "", "kind", "name", "EA", "a\nb\x1b", "z" * 3000]


def places(value, above=()):
    """Keys to everything within tables and arrays."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in inner:
        yield (*above, key)
        yield from places(entry, (*above, key))


PLACES = list(places(ENTRIES))
change = st.tuples(st.sampled_from(["set", "set", "delete", "rename", "double"]), st.sampled_from(PLACES), st.integers(0, 10**6))


def changed(entries, change):
    kind, (*above, key), number = change
    holder = entries
    try:
        for one in above:
            holder = holder[one]
        if kind == "set":
            holder[key] = copy.deepcopy(VALUES[number % len(VALUES)])
        elif kind == "delete":
            del holder[key]
        elif kind == "rename":
            holder[KEYS[number % len(KEYS)]] = holder.pop(key)
        else:
            holder.insert(key, holder[key])
    except (KeyError, IndexError, TypeError, AttributeError):
        pass  # what an earlier change took away, or what no array or table can do


# Of the text: where over its length, how many characters go, and what comes.
TEXTS = [
    "", "[", "]", '"', "\n", "=", ".", "\0", "\ufeff", "[[cables]]\n", "[effects]\n", "\x1b",
    "---", '! name: "\\x"', "9" * 5000, "\n\n",
]  # fmt: skip
edit = st.tuples(st.floats(0.0, 1.0, exclude_max=True), st.integers(0, 30), st.sampled_from(TEXTS))


def edited(text, edits):
    for where, gone, put in edits:
        at = int(where * len(text))
        text = text[:at] + put + text[at + gone :]
    return text


def read(path, reader):
    """Read a file that may be wrong."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the diameter of a rope
        try:
            reader(path)
        except InputError as refused:
            assert str(refused).isprintable() and len(str(refused)) <= LONGEST


OFTEN = settings(deadline=None, max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])


@OFTEN
@given(changes=st.lists(change, min_size=1, max_size=3), edits=st.lists(edit, max_size=1))
def test_a_changed_scene_file_is_a_scene_or_refused(tmp_path, changes, edits):
    entries = copy.deepcopy(ENTRIES)
    for one in changes:
        changed(entries, one)
    (tmp_path / "it.toml").write_text(edited(tomli_w.dumps(entries), edits), encoding="utf-8")
    read(tmp_path / "it.toml", load_scene)


WORDS = [
    "", "nan", "inf", "-1", "0", "2", "99", "1e308", "5e-324", "1e400", "1" * 5000, "x", "a|b", "none.dat", "../it.txt",
    "/dev/zero", ".", "Fixed", "Free", "Body1", "R1A", "P2", "²", "\x1b[31m", "\0", "y" * 3000, "---", "!",
    '! name: "a\\x"', '! name: "\\ud800"',
    "rho",
]  # fmt: skip
word = st.tuples(st.integers(0, 60), st.integers(0, 12), st.sampled_from(WORDS), st.sampled_from(["set", "add", "drop", "double"]))


@OFTEN
@given(words=st.lists(word, min_size=1, max_size=3), edits=st.lists(edit, max_size=1))
@example(words=[(16, 6, '! name: "a\\x"', "add")], edits=[])
def test_a_changed_moordyn_file_is_a_scene_or_refused(tmp_path, words, edits):
    lines = DECK.split("\n")
    for row, column, given_word, kind in words:
        row %= len(lines)
        columns = lines[row].split() or [""]
        column %= len(columns)
        if kind == "set":
            columns[column] = given_word
        elif kind == "add":
            columns.append(given_word)
        elif kind == "drop":
            del columns[column:]
        lines[row : row + 1] = [" ".join(columns)] * (2 if kind == "double" else 1)
    (tmp_path / "it.txt").write_text(edited("\n".join(lines), edits), encoding="utf-8")
    read(tmp_path / "it.txt", read_moordyn)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = " + "[" * 900 + "]" * 900, rf"must not nest deeper than {DEEPEST} tables and arrays, but .*it.toml does\."),
        ("points = " + "[" * 100 + "]" * 100, rf"it.toml: tables and arrays must not nest deeper than {DEEPEST}, but some do\."),
        ("points = " + "{a = " * 100 + "1" + "}" * 100, rf"it.toml: tables and arrays must not nest deeper than {DEEPEST}, but"),
        ("a." * 10**5 + "b = 1", rf"must not nest deeper than {DEEPEST} tables, but .*it.toml has a key of more parts\."),
        ("['" + "'. 'a'.\"b\" . c.'" * 50 + "']", "has a key of more parts"),
        ("x = 1" + "0" * 5000, "A scene file must hold numbers, but .*it.toml has an integer of thousands of digits"),
        (SCENE.replace("1.5\nmass", "1" + "0" * 400 + "\nmass"), r"cables\[0\]: key `length` has the wrong type: .* 1000"),
        (SCENE.replace("[[0.01, 10.0]", "[[1e-300, 1e300]"), r"`tension_strain` must be pairs of a finite strain"),
        (SCENE.replace("[[0.01, 10.0], [0.02, 30.0]]", "[[1e-90, 1e20]]"), "`slope of tension_strain` must be positive"),
        (SCENE.replace('"nylon"', '"nylon"\ndiameter = 1' + "0" * 400), "`diameter` must be positive and finite"),
        (SCENE.replace("ramp = 1.0}\n[[", "ramp = 1e90}\n[[", 1), r"`ramp` must be zero or at least 1e-06 s and up to 1e\+12"),
        (SCENE.replace('start = "a"', 'name = "c\\n"\nstart = "b"', 1), r'cable "c\\n" has start="b"\.'),
        ('["a\\n\\u001b"]', r"it.toml: unknown key `a\\n\\x1b`; known: `points`"),
        (f"[{'z' * 10**5}]", "it.toml: unknown key `zzz.* ... .*zzz`; known: `points`, `cables`, .*`events`"),
        (f"[effects]\n{'z' * 10**5} = 1", r"\[\[points\]\]|it.toml: `points` must be an array"),
    ],
)  # fmt: skip
def test_deep_long_and_strange_scene_files(tmp_path, text, message):
    (tmp_path / "it.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=message):
        load_scene(tmp_path / "it.toml")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "20       p",
            r'20  p ! name: "a\x"',
            r'line 17, "1 +chain .*": a name must be a string as in JSON',
        ),
        ("20       p", r'20  p ! name: "\ud800"', r'The name of a cable must be text that UTF-8 can hold, but is "\\ud800"'),
        ("20       p", "1" * 5000 + " p", r"NumSegs must be an integer of at least 1, but is 111.* \.\.\. .*111\."),
        ("1     Fixed", "1" * 5000 + " Fixed", "the number of a point must be an integer of at least 1, but is 111"),
        ("1        2", "1        P" + "2" * 5000, r"a line must end at a point in POINTS, but point P222.*; known: 1, 2, 3\."),
        ("2        3     ", "2        " + "x" * 10**5, "a line must end at the number of a point, but xxx"),
        ("chain      0.1", "chain \x1b[31m", r"Diam must be a finite number, but is \\x1b\[31m\."),
        ("1e8 ", "1e8|" + "y" * 5000, "EA must be one number; 1e8|y.*, a viscoelastic line, is not supported"),
    ],
)
def test_long_and_strange_decks(tmp_path, old, new, message):
    assert old in DECK
    (tmp_path / "it.txt").write_text(DECK.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(SceneError, match=message) as refused:
        read_moordyn(tmp_path / "it.txt")
    assert str(refused.value).startswith("it.txt, line ") and len(str(refused.value)) <= LONGEST
