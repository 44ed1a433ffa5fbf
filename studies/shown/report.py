"""The report: every study's question, figures, tables and answer on one page that needs nothing but itself."""

import base64
import traceback
from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

from studies.shown.show import as_text, column_head
from studies.study import LONG, STUDIES, Study, run_study
from studies.sweeping.provenance import provenance

SHOWN = 40  # rows of a table on the page; the file beside it has all
TYPES = {".svg": "image/svg+xml", ".png": "image/png"}


@dataclass(frozen=True)
class Failure:
    """A study that raised instead of answering."""

    name: str
    reason: str
    traceback: str


def write_report(
    out: str | Path,
    *,
    quick: bool = False,
    executor: Executor | None = None,
    parts: dict[str, Iterable[str]] = STUDIES,
    tell: Callable[[str], None] = lambda line: None,
    full: bool = False,
) -> list[str]:
    """Run the studies and write `out/report.html`, with each study's data in a folder beside it.

    Parameters
    ----------
    out : folder
    quick : less work for each study
    executor : where the studies' rows run
    parts : headings of the report -> names of studies
    tell : is given a line about each study as it ends
    full : all of the studies that take minutes too, of which there is a first look otherwise

    Returns
    -------
    list of str : names of the studies that failed; the page says why
    """
    out = Path(out)
    sections = {}
    for part, names in parts.items():
        sections[part] = [_run(name, out / name, quick or (name in LONG and not full), executor, tell) for name in names]
    studies = [study for part in sections.values() for study in part]
    write_page(out / "report.html", sections, quick, () if full else LONG)
    return [study.name for study in studies if isinstance(study, Failure)]


def write_page(file: Path, sections: dict[str, list[Study | Failure]], quick: bool = False, looks: Iterable[str] = ()) -> None:
    """Write the page for studies that have run; of those in `looks` it says that they are a first look."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {"inline": _inline, "words": _words, "informative": _informative}
    environment.filters |= {"text": as_text, "head": column_head}
    environment.tests["failure"] = lambda study: isinstance(study, Failure)
    template = environment.get_template("report.html")
    page = template.render(sections=sections, quick=quick, looks=looks, made=provenance(), shown=SHOWN)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(page, encoding="utf-8")


def _run(name, out, quick, executor, tell):
    try:
        study = run_study(name, out, quick=quick, executor=executor)
    except Exception as error:
        tell(f"{name}: failed, {type(error).__name__}: {error}")
        return Failure(name, f"{type(error).__name__}: {error}", traceback.format_exc())
    tell(f"{name}: {study.seconds:.1f} s")
    return study


def _inline(figure):
    """A figure's file as a data address, so that the page stands alone."""
    return f"data:{TYPES[figure.suffix]};base64,{base64.b64encode(figure.read_bytes()).decode()}"


def _words(name):
    return str(name).replace("_", " ")


def _informative(table):
    """The table without a status that is "done" everywhere and without reasons that are all empty."""
    same = {"status": "done", "reason": ""}
    return table.drop(columns=[name for name in same if name in table and (table[name] == same[name]).all()])
