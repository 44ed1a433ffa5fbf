"""Make the gallery from a report: each study's question, answer and figures.

    anet-lumped report --out results/report
    python docs/gallery.py results/report

It copies figures to `docs/figures/studies` and writes `docs/gallery.md`, both of which are kept with the source, so that the
pages build without a run of any study.
"""

import json
import shutil
import sys
from pathlib import Path

from studies.study import NAMES, Part

HERE = Path(__file__).parent
MOST = 2  # figures of a study; the report has all of them
HEAVY = 250_000  # bytes: a larger figure is left out

HEAD = """\
# Gallery

What the studies find, as `anet-lumped report` of version {version} shows it. Each study is one command, `anet-lumped study NAME`,
which also writes the rows behind its figures; the report has more figures and tables than are here.

![The carried net at three times, and the sway of its middle at three stiffnesses](../studies/net.png)
"""


def make(report, here=HERE):
    """Write the gallery of a report's folder into the folder of the pages.

    Returns
    -------
    list of str : names of the studies that the report lacks
    """
    figures, lacking, version = here / "figures" / "studies", [], ""
    sections = {part: [f"\n## {part}\n"] for part in Part}
    shutil.rmtree(figures, ignore_errors=True)
    figures.mkdir(parents=True)
    for name in NAMES:
        folder = report / name
        if not (folder / "answer.txt").is_file():
            lacking.append(name)
            continue
        meta = json.loads((folder / "meta.json").read_text(encoding="utf-8"))
        version = meta["versions"]["anet-lumped"]
        sections[meta["part"]].append(section(name, folder, figures, meta))
    parts = [text for texts in sections.values() for text in texts]
    (here / "gallery.md").write_text(
        HEAD.format(version=version) + "".join(parts), encoding="utf-8"
    )
    return lacking


def section(name, folder, figures, meta):
    """Return the text of a study, and copy its figures."""
    look = ", a first look" if meta["quick"] else ""
    title = name.replace("_", " ").capitalize()
    lines = [f"\n### {title}\n", f"\n*{plain(meta['question'])}*\n", f"\nStudy `{name}`{look}.\n"]
    for paragraph in (folder / "answer.txt").read_text(encoding="utf-8").strip().split("\n\n"):
        lines.append(f"\n{plain(' '.join(paragraph.split()))}\n")
    pictures = [file for file in sorted(folder.iterdir()) if file.suffix in (".svg", ".png")]
    drawn = [
        file for file in pictures if file.stem in meta["captions"]
    ]  # others are the same for a narrow screen
    for file in [file for file in drawn if file.stat().st_size <= HEAVY][:MOST]:
        copy = f"{name}-{file.name}"
        shutil.copy(file, figures / copy)
        caption = plain(meta["captions"][file.stem])
        lines.append(f"\n![{caption.split('. ')[0]}](figures/studies/{copy})\n\n{caption}\n")
    return "".join(lines)


def plain(text):
    """Return a paragraph as Markdown takes it for text."""
    for mark in "\\*_$<>[]#":
        text = text.replace(mark, f"\\{mark}")
    return text


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    if without := make(Path(sys.argv[1])):
        raise SystemExit(f"The gallery is without {', '.join(without)}, which the report lacks.")
