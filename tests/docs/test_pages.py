"""The pages: their examples print what they say, their files are there, nothing that exists is left out."""

import json
import re
import tomllib
from pathlib import Path

import gallery
import pytest
import typer.main
from generated import filled

import anet_lumped
from anet_lumped import Scene, simulate
from anet_lumped.effects import REGISTRY
from anet_lumped.files.scene_file import scene_of_entries
from examples import alike, examples, run, run_command, transcript
from studies.command_line import app, main
from studies.study import NAMES, Part

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
LONG = ("recommend", "effects", "report")  # commands whose answers depend on timings, or that take minutes
ALONE = [ROOT / name for name in ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")]


def text_of(page):
    return page.read_text(encoding="utf-8")


def name_of(page):
    return page.relative_to(ROOT).as_posix()


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if examples(text_of(page))], ids=name_of)
def test_examples_print_what_the_page_says(page, tmp_path, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names = {"__name__": "document"}
    for example in examples(text_of(page)):
        if example.is_timed and example.is_command:
            continue
        printed = run(example, names, tmp_path, page.name)
        assert example.is_timed or alike(printed, example.said), (
            f"{example.code}\nprinted\n{printed}\nbut the page says\n{example.said}"
        )
    for figure in re.findall(r"\]\((?:\.\./)?figures/(\w+\.\w+)\)", text_of(page)):
        assert (tmp_path / figure).is_file(), f"no code on the page writes {figure}"


def test_the_example_of_the_readme_runs(tmp_path):
    (example,) = examples(text_of(ROOT / "README.md"))
    printed = run(example, {"__name__": "document"}, tmp_path, "README.md")
    assert printed.startswith("done edmc: about ") and len(printed.splitlines()) == 4


def test_the_scene_of_the_readme_swings():
    (text,) = re.findall(r"```toml\n(.*?)```", text_of(ROOT / "README.md"), re.DOTALL)
    swung = simulate(scene_of_entries(tomllib.loads(text), "page"), t_end=6.0, method="edmc", dt=0.01)
    behind = swung.position("bottle")[:, 0] - swung.position("hook")[:, 0]
    assert swung.ok and swung.position("hook")[-1, 0] == pytest.approx(8.25, rel=1e-9)  # 1.5 m/s, half of it in the first second
    after = behind[swung.t > 1.0]
    # a pendulum of omega^2 = g/L, whose hook gains v within a ramp: by less than v/omega to either side, and by as much to both
    assert 0.3 < after.max() < 1.5 * (2.0 / 9.81) ** 0.5 and after.max() == pytest.approx(-after.min(), rel=0.02)


def test_alike_tells_numbers_and_words_apart():
    assert alike("a  1.000 m\n", "a 1.005 m") and alike("imbalance 4e-09", "imbalance 7e-10")
    assert not alike("a 1.0 m", "a 1.1 m") and not alike("a 1.0 m", "b 1.0 m") and not alike("a 1.0", "a 1.0 m")
    assert alike("wall time [s]: 0.2", "wall time [s]: 0.9") and not alike("steps: 2", "steps: 9")


@pytest.fixture
def in_this_process(monkeypatch, capsys):
    """A call of the program, as `examples.in_a_process` without a process to start."""
    monkeypatch.setenv("MPLBACKEND", "agg")  # which the program sets

    def call(words, folder):
        monkeypatch.chdir(folder)
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main(words)
        return ended.value.code, *capsys.readouterr()

    return call


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(typer.main.get_command(app).commands))
def test_command_prints_what_its_record_says(name, tmp_path, in_this_process):
    recorded = transcript(text_of(DOCS / "recorded" / f"{name}.txt"))
    assert recorded[-1][0].split()[:2] == ["anet-lumped", name]
    for command, said in recorded:
        assert said.strip() if name in LONG else alike(run_command(command, tmp_path, in_this_process), said)


@pytest.mark.parametrize("page", [page for page in PAGES if "<!-- end -->" in text_of(page)], ids=name_of)
def test_parts_made_of_the_source_are_those_of_now(page):
    assert filled(text_of(page)) == text_of(page), f"run python docs/record.py {page.stem}"


def test_pages_that_are_linked_as_they_lie_here_have_no_directive_for_the_site_alone():
    for page in ("scene-file.md", "command-line.md", "choosing.md"):
        assert "```{" not in text_of(DOCS / page)


def tables(page):
    """Blocks of TOML of a page."""
    return re.findall(r"^```toml\n(.*?)^```$", text_of(page), re.MULTILINE | re.DOTALL)


def test_every_scene_file_in_the_pages_is_read():
    """Those that show an effect or an event alone, as a part of the net that is held."""
    whole = tomllib.loads(text_of(ROOT / "anet_lumped" / "scenes" / "net_held.toml"))
    whole["cable_defaults"] |= {"diameter": 0.003, "EI": 1e-4}
    found = 0
    for page in PAGES:
        for entries in map(tomllib.loads, tables(page)):
            found += 1
            if "points" not in entries:
                entries = whole | entries | {"effects": whole["effects"] | entries.get("effects", {})}
            assert isinstance(scene_of_entries(entries, page.name), Scene)
    assert found >= len(REGISTRY.library)


@pytest.mark.parametrize("name", REGISTRY.library)
def test_every_effect_has_a_page_with_its_equation_and_its_source(name):
    page = text_of(DOCS / "effects" / f"{name.replace('_', '-')}.md")
    assert "$$" in page and "## Source" in page and "## Example" in page
    assert f"autoclass:: anet_lumped.effects.{REGISTRY[name].__name__}" in page
    assert f"### `[effects.{name}]`" in text_of(DOCS / "scene-file.md")
    assert f".. autoclass:: {REGISTRY[name].__name__}\n" in text_of(DOCS / "api" / "effects.md")


@pytest.mark.parametrize("name", anet_lumped.__all__)
def test_every_public_name_has_its_docstring_on_a_page(name):
    pages = "".join(map(text_of, (DOCS / "api").glob("*.md")))
    assert re.search(rf"auto\w+:: (anet_lumped\.)?([\w.]+\.)?{name}$|^## `{name}`", pages, re.MULTILINE)


@pytest.mark.parametrize("page", [*PAGES, *ALONE], ids=name_of)
def test_links_and_pictures_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#\s]+)", re.sub(r"^```.*?^```$", "", text_of(page), flags=re.MULTILINE | re.DOTALL)):
        if not target.startswith("https://"):
            assert (page.parent / target).exists(), target


def test_files_that_the_architecture_names_are_there():
    named = re.findall(r"`([\w/.]+\.(?:py|toml))`", text_of(ROOT / "ARCHITECTURE.md"))
    assert named
    for file in named:
        assert any((ROOT / package / file).is_file() for package in (".", "anet_lumped", "integrators")), file


def test_the_gallery_has_every_study():
    page = text_of(DOCS / "gallery.md")
    for name in NAMES:
        assert f"Study `{name}`" in page


def test_a_gallery_is_made_of_what_a_report_has(tmp_path):
    folder = tmp_path / "report" / "order"
    folder.mkdir(parents=True)
    (folder / "answer.txt").write_text("It is *2*.\n\nLeft out:\nmuch.\n")
    meta = {"quick": True, "versions": {"anet-lumped": "9.9"}, "question": "Is it 2?", "part": Part.CURE}
    meta["captions"] = {"all_errors": "Errors of all. They fall."}
    (folder / "meta.json").write_text(json.dumps(meta))
    (folder / "all_errors.svg").write_text("<svg/>")
    (folder / "heavy.svg").write_text(" " * (gallery.HEAVY + 1))
    lacking = gallery.make(tmp_path / "report", tmp_path)
    assert lacking == [name for name in NAMES if name != "order"]
    page = (tmp_path / "gallery.md").read_text()
    assert "version 9.9" in page and "Study `order`, a first look" in page and all(f"## {part}" in page for part in Part)
    assert "It is \\*2\\*.\n\nLeft out: much.\n" in page
    assert "![Errors of all](figures/studies/order-all_errors.svg)\n\nErrors of all. They fall.\n" in page and "heavy" not in page
    assert [file.name for file in (tmp_path / "figures" / "studies").iterdir()] == ["order-all_errors.svg"]


def test_one_version():
    version = tomllib.loads(text_of(ROOT / "pyproject.toml"))["project"]["version"]
    assert f"\nversion: {version}\n" in text_of(ROOT / "CITATION.cff")
    assert re.search(r"^## \[(.+?)\]", text_of(ROOT / "CHANGELOG.md"), re.MULTILINE)[1] == version
