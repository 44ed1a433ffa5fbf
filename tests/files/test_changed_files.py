"""Scene files and MoorDyn files that are changed at random: each ends in a scene or in one sentence."""

import warnings

import pytest
from drawn import Drawn
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from test_moordyn_file import DECK
from tried import tried

from anet_lumped import InputError, SceneError, load_scene, read_moordyn
from anet_lumped.checks import LONGEST
from anet_lumped.scene.as_dict import DEEPEST
from studies.catalogue.hostile_files import SCENE, changed_moordyn_file, changed_scene_file


def read(path, reader):
    """Read a file that may be wrong."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the diameter of a rope
        try:
            reader(path)
        except InputError as refused:
            assert all(line.isprintable() and len(line) <= LONGEST for line in str(refused).split("\n"))


OFTEN = tried(75, suppress_health_check=[HealthCheck.function_scoped_fixture])


@OFTEN
@given(st.data())
def test_a_changed_scene_file_is_a_scene_or_refused(tmp_path, data):
    (tmp_path / "it.toml").write_text(changed_scene_file(Drawn(data)), encoding="utf-8")
    read(tmp_path / "it.toml", load_scene)


@OFTEN
@given(st.data())
def test_a_changed_moordyn_file_is_a_scene_or_refused(tmp_path, data):
    (tmp_path / "it.txt").write_text(changed_moordyn_file(Drawn(data)), encoding="utf-8")
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
        (SCENE.replace("1.5\nmass", "1" + "0" * 400 + "\nmass"), r"cable .a-p.: key `length` has the wrong type: .* 1000"),
        (SCENE.replace("[[0.01, 10.0]", "[[1e-300, 1e300]"), r"`tension_strain` must be pairs of a finite strain"),
        (SCENE.replace("[[0.01, 10.0], [0.02, 30.0]]", "[[1e-90, 1e20]]"), "`slope of tension_strain` must be positive"),
        (SCENE.replace('"nylon"', '"nylon"\ndiameter = 1' + "0" * 400), "`diameter` must be positive and finite"),
        (SCENE.replace("ramp = 1.0}\n[[", "ramp = 1e90}\n[[", 1), r"`ramp` must be zero or at least 1e-06 s and up to 1e\+12"),
        (SCENE.replace('start = "a"', 'name = "c\\n"\nstart = "b"', 1), r'cable "c\\n" has start="b"\.'),
        ('["a\\n\\u001b"]', r"it.toml: unknown key `a\\n\\x1b`; known: `points`"),
        (f"[{'z' * 10**5}]", "it.toml: unknown key `zzz.* ... .*zzz`; known: `points`, `bodies`, `cables`, .*`events`"),
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
        ("1e8 ", "1e8|" + "y" * 5000, r"EA must be up to 3 numbers between bars, but is 1e8\|y"),
    ],
)
def test_long_and_strange_decks(tmp_path, old, new, message):
    assert old in DECK
    (tmp_path / "it.txt").write_text(DECK.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(SceneError, match=message) as refused:
        read_moordyn(tmp_path / "it.txt")
    lines = str(refused.value).split("\n")
    assert all(line.startswith("it.txt, line ") and len(line) <= LONGEST for line in lines)
