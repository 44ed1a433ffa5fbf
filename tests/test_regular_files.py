"""Files that are read: regular, of a bounded size, and where they are text, UTF-8; files that are written: whole or not at all."""

import errno
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from anet_lumped.advice.markers import MarkerError, read_markers
from anet_lumped.checks import InputError, SceneError
from anet_lumped.effects.flow.wind.recorded import Recorded
from anet_lumped.files.moordyn_file import deck_from_text, read_moordyn
from anet_lumped.files.moordyn_writer import save_moordyn
from anet_lumped.files.scene_file import load_scene, save_scene
from anet_lumped.limits import BYTES, TEXT
from anet_lumped.motion.simulate import simulate
from anet_lumped.regular_files import read_bytes, read_text, whole_file
from anet_lumped.results.loading import load_run

SCENE = load_scene("net_held")
ROW = "chain 0.1 100 {} -1 0 1 1 1 1"
DECK = """--- LINE TYPES ---
n
u
{}
--- POINTS ---
n
u
1 Fixed 0 0 0 0 0 0 0
2 Fixed 9 0 0 0 0 0 0
--- LINES ---
n
u
1 chain 1 2 20 4 -
--- OPTIONS ---
0 rho
0 kBot
0 cBot
"""


def table(path):
    """A tension-strain table in the folder of its deck."""
    deck_from_text(DECK.format(ROW.format(path.name)), folder=path.parent)


READERS = {
    "scene": (load_scene, ".toml", "A scene file"),
    "deck": (read_moordyn, ".txt", "A MoorDyn file"),
    "table": (table, ".tab", "EA|it.tab"),
    "wind": (lambda path: Recorded(str(path)), ".csv", "A recorded wind"),
    "markers": (lambda path: read_markers(path, SCENE), ".csv", "A marker file"),
    "run": (load_run, ".nc", "A saved run"),
}
TEXTS = [name for name in READERS if name != "run"]


def make(kind, path):
    """Make what is no file of a bounded size."""
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "endless":
        path.symlink_to("/dev/zero")
    elif kind == "folder":
        path.mkdir()
    elif kind == "loop":
        path.symlink_to(path.name)
    elif kind == "large":
        with path.open("wb") as file:
            file.truncate(10**12)  # a hole, which takes no place on the disk


@pytest.mark.skipif(os.name == "nt", reason="pipes and devices in folders")
@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("pipe", "must be a regular file, but .* is a pipe or a device"),
        ("endless", "must be a regular file, but .* is a pipe or a device|leads out of it"),
        ("folder", "(must be readable|a readable file), but .*: Is a directory"),
        ("loop", "(must be readable|a readable file), but .*: Too many levels of symbolic links"),
        ("none", "(must be readable|a readable file), but .*: No such file or directory"),
        ("large", r"1e\+12 bytes of .*, but must not take more than .* another limit|It, .* another limit"),
    ],
)
@pytest.mark.parametrize("reader", READERS)
def test_what_is_no_file_of_bounded_size_is_refused_at_once(tmp_path, reader, kind, message):
    read, ending, what = READERS[reader]
    path = tmp_path / f"it{ending}"
    make(kind, path)
    with pytest.raises(InputError, match=f"(?:{what}).*(?:{message})"):
        read(path)


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("name", ["a\0b", "y" * 5000, "a\nb\x1b"], ids=["NUL", "long", "escape"])
def test_paths_that_no_file_has(tmp_path, reader, name):
    read, ending, _ = READERS[reader]
    with pytest.raises(InputError) as refused:
        read(tmp_path / f"{name}{ending}")
    assert str(refused.value).isprintable()


def test_a_path_with_a_null_byte_is_named():
    with pytest.raises(InputError, match=r"A file must be given by the path of a file, but a\\x00: embedded null"):
        read_bytes("a\0", "A file", BYTES)
    with pytest.raises(InputError, match=r"A file must be given by its path, but it is 3\."):
        read_bytes(3, "A file", BYTES)
    with pytest.raises(SceneError, match=r"EA must be a number or the name of a file, but is .a\\x00"):
        deck_from_text(DECK.format(ROW.format("a\0")))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("a = 1".encode("utf-16"), "must be UTF-8 text, but .* is UTF-16"),
        ("a = 1".encode("utf-16-be"), "must be UTF-8 text, but .* is binary"),
        (b"a\0", "must be UTF-8 text, but .* is binary"),
    ],
)
@pytest.mark.parametrize("reader", TEXTS)
def test_text_is_utf_8(tmp_path, reader, content, message):
    read, ending, what = READERS[reader]
    path = tmp_path / f"it{ending}"
    path.write_bytes(content)
    with pytest.raises(InputError, match=f"(?:{what}).* {message}"):
        read(path)


def test_bytes_that_are_no_text(tmp_path):
    """They are refused with their line, but for MoorDyn's files, whose remarks are often of other encodings."""
    path = tmp_path / "it.toml"
    path.write_bytes(b"a = 1\nb = '\xb5'\n")
    with pytest.raises(SceneError, match=r"A scene file must be UTF-8 text, but line 2 of .*it.toml is not\."):
        load_scene(path)
    assert read_text(path, "A file", errors="replace") == "a = 1\nb = '\ufffd'\n"


def test_byte_order_marks_and_line_ends_are_read_past(tmp_path):
    (tmp_path / "it.txt").write_bytes(b"\xef\xbb\xbfa\r\nb\rc\n")
    assert read_text(tmp_path / "it.txt", "A file") == "a\nb\nc\n"


def test_the_environment_allows_more_text(tmp_path, monkeypatch):
    (tmp_path / "it.txt").write_text("12345")
    monkeypatch.setenv(TEXT.variable, "4")
    with pytest.raises(InputError, match=r"A file, .*it.txt, would take 5 bytes of text, but must not take more than 4; the env"):
        read_text(tmp_path / "it.txt", "A file")
    monkeypatch.setenv(TEXT.variable, "5")
    assert read_text(tmp_path / "it.txt", "A file") == "12345"


@pytest.mark.skipif(not os.path.exists("/proc/self/maps"), reason="files without a size")
def test_files_without_a_size_are_bounded_too(monkeypatch):
    monkeypatch.setenv(TEXT.variable, "10")
    with pytest.raises(InputError, match="would take 11 bytes of text"):
        read_text("/proc/self/maps", "A file")


def test_a_refusal_is_of_the_kind_that_is_asked_for(tmp_path):
    with pytest.raises(MarkerError, match="A marker file must be readable"):
        read_markers(tmp_path / "none.csv", SCENE)
    (tmp_path / "it.csv").write_text('x,y,z\n"' + "1" * 200_000)
    with pytest.raises(MarkerError, match=r"A marker file must be a table in CSV, but .*it.csv, line 2, is not: field larger than"):
        read_markers(tmp_path / "it.csv", SCENE)


@pytest.mark.parametrize("name", ["../it.tab", "{folder}/../it.tab", "link.tab"])
def test_a_deck_names_tables_in_its_folder_alone(tmp_path, name):
    folder = tmp_path / "decks"
    folder.mkdir()
    (tmp_path / "it.tab").write_text("strain tension\n(-) (N)\n0.1 1e5\n0.2 3e5\n")
    (folder / "link.tab").symlink_to(tmp_path / "it.tab")
    deck = folder / "deck.txt"
    deck.write_text(DECK.format(ROW.format(name.format(folder=folder))))
    with pytest.raises(SceneError, match=r'deck.txt, line 4, .*: a table must be in the folder of its deck, but "(.*it|link).tab"'):
        read_moordyn(deck)
    assert read_moordyn(deck, outside=True).scene.cables[0].tension_strain == ((0.1, 1e5), (0.2, 3e5))


@pytest.fixture(scope="module")
def run():
    return simulate(SCENE, 0.02, method="edmc", dt=0.01)


@pytest.mark.parametrize(
    "write", [lambda run, path: run.save(path), lambda run, path: save_scene(run.scene, path)], ids=["run", "scene"]
)
@pytest.mark.parametrize(
    ("path", "message"),
    [
        (None, "must be given the path of the file to write, but it is None"),
        ("", "must be given the path of the file to write, but it is ''"),
        (5, "must be given the path of the file to write, but it is 5"),
        ("a\0b", "must be given the path of the file to write, but a.*b: .*embedded null"),
        (".", "must be written to a regular file, but . is a folder"),
        ("/dev/null", "must be written to a regular file, but /dev/null is a pipe or a device"),
    ],
)
def test_nothing_is_written_to_what_is_no_file(write, path, message, run):
    with pytest.raises(InputError, match=message):
        write(run, path)


def test_nothing_waits_for_a_pipe_to_be_read(tmp_path, run):
    os.mkfifo(tmp_path / "run.nc")
    with pytest.raises(InputError, match=r"must be written to a regular file, but .*run.nc is a pipe or a device"):
        run.save(tmp_path / "run.nc")


def test_a_file_is_replaced_only_once_all_of_it_is_written(tmp_path):
    file = tmp_path / "run.nc"
    file.write_text("old")
    with whole_file(file, "A run") as half:
        half.write_text("ne")
        assert file.read_text() == "old"
        assert half.suffix == ".nc"  # programs that go by the ending write the same format
        half.write_text("new")
    assert file.read_text() == "new" and os.listdir(tmp_path) == ["run.nc"]


@pytest.mark.parametrize("there", [True, False])
def test_a_full_disk_leaves_what_was_there_and_nothing_else(tmp_path, there):
    file = tmp_path / "run.nc"
    if there:
        file.write_text("old")
    with pytest.raises(OSError, match="No space left on device") as found, whole_file(file, "A run") as half:
        half.write_text("ne")
        raise OSError(errno.ENOSPC, "No space left on device")
    assert found.value.errno == errno.ENOSPC and found.value.filename == str(file)
    assert [path.read_text() for path in tmp_path.iterdir()] == (["old"] if there else [])


def test_an_error_of_another_file_names_that_one(tmp_path):
    with pytest.raises(FileNotFoundError) as found, whole_file(tmp_path / "film.mp4", "A film"):
        open(tmp_path / "ffmpeg")
    assert found.value.filename == str(tmp_path / "ffmpeg") and not os.listdir(tmp_path)


def test_a_link_stays_a_link_and_a_mode_stays(tmp_path):
    file, link = tmp_path / "run.nc", tmp_path / "latest.nc"
    file.write_text("old")
    file.chmod(0o640)
    link.symlink_to(file)
    with whole_file(link, "A run") as half:
        half.write_text("new")
    assert link.is_symlink() and file.read_text() == "new" and file.stat().st_mode & 0o777 == 0o640


def test_threads_that_save_one_file_leave_the_whole_of_one_run(tmp_path):
    run = simulate(SCENE, 0.1, dt=0.05)
    file = tmp_path / "run.nc"
    run.save(file)

    def save_and_read(_):
        run.save(file)
        return np.array_equal(load_run(file).q, run.q)

    with ThreadPoolExecutor(4) as threads:
        assert all(threads.map(save_and_read, range(40)))


WRITERS = {
    "scene": lambda path: save_scene(SCENE, f"{path}.toml"),
    "deck": lambda path: save_moordyn(SCENE, f"{path}.dat"),
    "run": lambda path: simulate(SCENE, 0.1, dt=0.05).save(f"{path}.nc"),
    "page": lambda path: simulate(SCENE, 0.1, dt=0.05).view(f"{path}.html"),
    "film": lambda path: simulate(SCENE, 0.1, dt=0.05).view(f"{path}.gif"),
}


@pytest.mark.parametrize("write", WRITERS.values(), ids=WRITERS)
@pytest.mark.filterwarnings("ignore:MoorDyn's dampers")
def test_a_folder_that_is_not_there_is_refused(tmp_path, write):
    with pytest.raises(InputError, match=r"must be written to a folder that is there, but .*nowhere is none"):
        write(tmp_path / "nowhere" / "it")
