"""Scene files to begin from."""

import pytest

from anet_lumped import InputError, load_scene
from anet_lumped.files.new_scene import new_scene
from anet_lumped.files.scene_file import SCENES


@pytest.mark.parametrize("name", sorted(file.stem for file in SCENES.glob("*.toml")))
def test_a_new_scene_is_commented_and_is_the_same(name, tmp_path):
    path = new_scene(tmp_path / "mine.toml", name)
    assert path.read_text(encoding="utf-8").startswith("# ") and load_scene(path) == load_scene(name)


def test_a_file_that_is_there_is_left_alone(tmp_path):
    (tmp_path / "mine.toml").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match=r"A new scene must be a new file, but .*mine.toml. is there already\."):
        new_scene(tmp_path / "mine.toml", "net_held")
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("path", "like", "message"),
    [
        ("mine.toml", "net_hold", r"must be like one that comes with this, but none is called .net_hold., did you mean .net_held."),
        ("mine.toml", "zzzzzz", r"none is called .zzzzzz.; they are loose_cable, mooring, net_carried"),
        ("mine.txt", "net_held", r"A new scene must be a file that ends in \.toml, but it is .*mine\.txt"),
    ],
)
def test_what_is_no_scene_or_no_file(path, like, message, tmp_path):
    with pytest.raises(InputError, match=message):
        new_scene(tmp_path / path, like)
    assert not list(tmp_path.iterdir())
