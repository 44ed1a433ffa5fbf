"""What a study is, which studies there are, and how one is run. A study is a module or folder of `studies.questions` that provides

    STUDY                                          a `Record`: question, part of the report, what a first look takes
    TABLES                                         names of its tables, and a sentence on each: what a line is
    compute(quick=False, executor=None, out=None)  the rows: a dict of DataFrames by the names of TABLES; runs go through
                                                   `rows.run_rows`, with `executor` and a folder of its own under `out`; `data`,
                                                   a folder, besides for a study whose Record says what data it takes
    plot(rows)                                     a dict of `Drawing`s by name
    answer(rows)                                   the answer, every number and every claim from the rows: paragraphs, an
                                                   empty line between two; the first is the finding that the report's
                                                   summary takes

and whose name stands in NAMES. `quick` takes a first look: the same columns from less work. Names of tables and drawings
become file names. Constants in capitals are the study's parameters (a SEED too) and go to `meta.json`.
"""

import ast
import importlib.util
import json
import shutil
import sys
import time
from concurrent.futures import Executor
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from anet_lumped.checks import InputError, nearest
from studies.shown.figure_file import Picture, save_figure
from studies.sweeping.folder_lock import locked
from studies.sweeping.provenance import provenance
from studies.sweeping.rows import save_table

NAMES = [
    "thesis_tables",
    "model_mismatch",
    "order",
    "length_error",
    "stability_map",
    "energy_rise",
    "speed",
    "work_precision",
    "without_stretch",
    "nets",
    "three_models",
    "flight",
    "hard_cases",
    "effects_cost",
    "hostile_input",
    "error_estimate",
    "measured",
    "moorings",
]
"""Names of the studies in the order in which the report runs them: what is soon there and tells most comes first."""

UNFINISHED = "unfinished"  # folder of the rows of a study that is still running, or was killed


class Part(StrEnum):
    """Parts of the report, in its order."""

    FOUND = "What the thesis found"
    WHY = "Why"
    CURE = "What cures it"
    COST = "What accuracy costs"
    MEASURED = "How far from the real thing"


@dataclass(frozen=True)
class Record:
    """What a study says of itself before it runs.

    Parameters
    ----------
    question : one sentence
    part : of the report
    first_look : what a first look takes of the study, as the end of "A first look: ..."; empty for a study that is short, of
        which the report takes all
    data : what measured data the study takes besides, as the end of "--data is the folder ..."; empty for a study that takes none
    compares_times : whether its tables or its answer compare times that runs took, so that nothing else may run meanwhile
    """

    question: str
    part: Part
    first_look: str = ""
    compares_times: bool = False
    data: str = ""


class StudyError(InputError):
    """A study that does not exist."""


@dataclass(frozen=True)
class Drawing:
    """A matplotlib Figure and what it shows: a caption of one sentence or more; whether a page shows it only when asked to."""

    figure: Any
    caption: str
    on_demand: bool = False


@dataclass(frozen=True)
class Study:
    """What came out of one study: tables (DataFrames) and a sentence on each, pictures, and paragraphs of the answer."""

    name: str
    record: Record
    quick: bool
    tables: dict
    about_tables: dict[str, str]
    pictures: dict[str, Picture]
    answer: list[str]
    seconds: float


def module_of(name: str):
    """The module of a study.

    Raises
    ------
    StudyError : an unknown name
    """
    if name not in NAMES:
        known = nearest(name, NAMES) or f"; known are {', '.join(NAMES)}."
        raise StudyError(f'There is no study "{name}"{known}')
    return importlib.import_module(f"studies.questions.{name}")


def question_of(name: str) -> str:
    """The question of a study: the first line of its file, which is read without an import of what the study needs."""
    file = importlib.util.find_spec(f"studies.questions.{name}").origin
    return ast.get_docstring(ast.parse(Path(file).read_text(encoding="utf-8"))).splitlines()[0]


def run_study(
    name: str, out: str | Path, *, quick: bool = False, executor: Executor | None = None, data: str | Path | None = None
) -> Study:
    """Run a study; its tables (parquet and CSV), figures, `answer.txt` and `meta.json` go to the folder `out`.

    `data` is a folder of measured data, for a study that takes one.

    Raises
    ------
    StudyError : an unknown name, or data for a study that takes none
    FolderInUseError : another run writes to `out`
    """
    module, out = module_of(name), Path(out)
    if data is not None and not module.STUDY.data:
        raise StudyError(f'The study "{name}" takes no measured data, but --data gives it {data}.')
    with locked(out):
        return _run(name, module, out, quick, executor, {} if data is None else {"data": data})


def _run(name, module, out, quick, executor, data):
    """`run_study` in a folder that nobody else writes to."""
    shutil.rmtree(out / UNFINISHED, ignore_errors=True)
    begin = time.perf_counter()
    tables = module.compute(quick=quick, executor=executor, out=out / UNFINISHED, **data)
    for table_name, table in tables.items():
        save_table(table, out / table_name)
    shutil.rmtree(out / UNFINISHED, ignore_errors=True)
    pictures = {
        title: save_figure(drawing.figure, out / title, drawing.caption, drawing.on_demand)
        for title, drawing in module.plot(tables).items()
    }
    answer = module.answer(tables)
    (out / "answer.txt").write_text(answer.strip() + "\n", encoding="utf-8")
    seconds = time.perf_counter() - begin
    parameters = _parameters(module)
    about = {
        "study": name,
        "question": module.STUDY.question,
        "part": module.STUDY.part,
        "quick": quick,
        "seconds": round(seconds, 1),
    }
    about["captions"] = {title: picture.caption for title, picture in pictures.items()}
    meta = about | {"parameters": parameters, **provenance()}
    (out / "meta.json").write_text(json.dumps(meta, indent=1, default=str), encoding="utf-8")
    paragraphs = [" ".join(paragraph.split()) for paragraph in answer.strip().split("\n\n")]
    return Study(name, module.STUDY, quick, tables, module.TABLES, pictures, paragraphs, seconds)


def _parameters(module):
    """Constants in capitals of a study's module, or of all modules of its folder."""
    modules = [part for name, part in sys.modules.items() if name == module.__name__ or name.startswith(f"{module.__name__}.")]
    return {key: value for part in modules for key, value in vars(part).items() if key.isupper() and key not in ("STUDY", "TABLES")}
