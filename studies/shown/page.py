"""The report's page: every study's question, figures, tables and answer in one file that needs nothing but itself."""

import base64
import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from anet_lumped.regular_files import write_text
from studies.shown.show import as_text, column_head

SHOWN = 40  # rows of a table on the page; the file beside the page has all
TYPES = {".svg": "image/svg+xml", ".png": "image/png"}


class State(StrEnum):
    """How far a study has come."""

    TO_COME = "to come"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"


@dataclass(frozen=True)
class Entry:
    """A study on the page.

    Parameters
    ----------
    name, question, part : of the study
    state : how far the study has come
    study : `Study`, once it is done
    first_look : of a study that is shortened, what it takes of the whole; empty for a whole one
    on_one_core : whether it timed runs on a core of its own, while other studies ran on others
    reason, traceback : of a study that failed
    """

    name: str
    question: str
    part: str
    state: State = State.TO_COME
    study: Any = None
    first_look: str = ""
    on_one_core: bool = False
    reason: str = ""
    traceback: str = ""


def write_page(file: Path, entries: Iterable[Entry], parts: Iterable[str], *, made: dict, command: str, stopped: str = "") -> None:
    """Write the page as it stands; a reader who has it open while the report runs loads it anew.

    Parameters
    ----------
    file : Path
    entries : the studies in the order of the page within each part
    parts : headings of the page, in order; those without a study are left out
    made : `provenance()`
    command : line that makes this page
    stopped : a sentence that says why studies are still to come though nothing runs any more; empty while the report runs
    """
    entries = list(entries)
    sections = {part: [entry for entry in entries if entry.part == part] for part in parts}
    write_template(
        file,
        "report.html",
        sections={part: of_part for part, of_part in sections.items() if of_part},
        to_come=[entry.name for entry in entries if entry.state in (State.TO_COME, State.RUNNING)],
        State=State,
        made=made,
        command=command,
        stopped=stopped,
        shown=SHOWN,
    )


def write_template(file: Path, template: str, **values: object) -> None:
    """Write a page that needs nothing but itself, of a template of this package and its values."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {"inline": _inline, "words": _words, "informative": _informative}
    environment.filters |= {"text": as_text, "head": column_head, "first_sentence": _first_sentence, "prose": _prose}
    page = environment.get_template(template).render(**values)
    file.parent.mkdir(parents=True, exist_ok=True)
    write_text(file, page, "A page")


def _inline(file):
    """A picture's file as a data address, so that the page stands alone."""
    return f"data:{TYPES[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"


def _words(name):
    return str(name).replace("_", " ")


def _first_sentence(caption):
    """The first sentence of a caption, which is the picture's alternative text."""
    return caption.split(". ")[0].rstrip(".") + "."


def _prose(text):
    """The text whose equations, units and powers of ten stay on one line: EA = 1e4 N, 10 ms, 1e-4."""
    text = re.sub(r"(?<=\de-)(?=\d)", "\u2060", text)
    return re.sub(r"(?<=[\d∞]) (?=(?:N|m|mm|cm|s|ms|ns|J|kg|g|%|times|N/m)\b|%)", "\u00a0", text.replace(" = ", "\u00a0=\u00a0"))


def _informative(table):
    """The table without a status that is "done" everywhere and without reasons that are all empty."""
    same = {"status": "done", "reason": ""}
    return table.drop(columns=[name for name in same if name in table and (table[name] == same[name]).all()])
