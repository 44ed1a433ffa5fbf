"""How one study is run. A study is a module of this package, one question each, that provides

    QUESTION                                       the question, one sentence
    compute(quick=False, executor=None, out=None)  the rows: a DataFrame, or a dict of them by name; runs go through
                                                   `rows.run_rows`, with `executor` and a folder of its own under `out`
    plot(rows)                                     the figures: a dict of matplotlib Figures by name
    answer(rows)                                   the answer with numbers from the rows: paragraphs, an empty line
                                                   between two; the first is the finding that the report's summary takes

and whose name stands in STUDIES. `quick` is for tests and a first look: the same columns from less work. Names of
tables and figures become file names and captions. Constants in capitals are the study's parameters (a SEED too) and go
to `meta.json`.
"""

import importlib
import json
import shutil
import time
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

from studies.sweeping.provenance import provenance
from studies.sweeping.rows import save_table

STUDIES = {
    "What the thesis found": ("thesis_tables", "length_error", "model_mismatch"),
    "Why": ("stability_map",),
    "What cures it": ("energy_rise", "order", "hard_cases", "speed"),
    "What accuracy costs": ("work_precision", "effects_cost"),
}
"""Names of the studies, by the part of the report that each belongs to, in its order."""
LONG = ("hard_cases", "work_precision", "effects_cost")  # minutes each: the report takes a first look unless it is asked for all
UNFINISHED = "unfinished"  # rows of a study that is still running, or was killed
HEAVY = 400_000  # bytes


class StudyError(ValueError):
    """A study that does not exist."""


@dataclass(frozen=True)
class Study:
    """What came out of one study: tables (DataFrames), figures (files) and paragraphs of the answer."""

    name: str
    question: str
    tables: dict
    figures: dict[str, Path]
    answer: list[str]
    seconds: float


def study_names() -> list[str]:
    """Names of all studies, in the order of the report."""
    return [name for part in STUDIES.values() for name in part]


def run_study(name: str, out: str | Path, *, quick: bool = False, executor: Executor | None = None) -> Study:
    """Run a study; its tables (parquet and CSV), figures, `answer.txt` and `meta.json` go to the folder `out`.

    Raises
    ------
    StudyError : an unknown name
    """
    if name not in study_names():
        from anet_lumped.checks import nearest

        known = nearest(name, study_names()) or f"; known are {', '.join(study_names())}."
        raise StudyError(f'There is no study "{name}"{known}')
    import matplotlib

    matplotlib.use("Agg")
    module = importlib.import_module(f"studies.questions.{name}")
    out = Path(out)
    shutil.rmtree(out / UNFINISHED, ignore_errors=True)
    begin = time.perf_counter()
    rows = module.compute(quick=quick, executor=executor, out=out / UNFINISHED)
    tables = rows if isinstance(rows, dict) else {"rows": rows}
    for table_name, table in tables.items():
        save_table(table, out / table_name)
    shutil.rmtree(out / UNFINISHED, ignore_errors=True)
    figures = {title: _save_figure(figure, out / title) for title, figure in module.plot(rows).items()}
    answer = module.answer(rows)
    (out / "answer.txt").write_text(answer.strip() + "\n", encoding="utf-8")
    seconds = time.perf_counter() - begin
    parameters = {key: value for key, value in vars(module).items() if key.isupper() and key != "QUESTION"}
    meta = {"study": name, "quick": quick, "seconds": round(seconds, 1), "parameters": parameters, **provenance()}
    (out / "meta.json").write_text(json.dumps(meta, indent=1, default=str), encoding="utf-8")
    return Study(name, module.QUESTION, tables, figures, [" ".join(p.split()) for p in answer.split("\n\n")], seconds)


def _save_figure(figure, stem):
    """Write a figure as SVG, or as PNG where its thousands of marks would make a page heavy; return the file."""
    from matplotlib import pyplot

    file = stem.with_name(stem.name + ".svg")
    figure.savefig(file, bbox_inches="tight")
    if file.stat().st_size > HEAVY:
        file.unlink()
        file = stem.with_name(stem.name + ".png")
        figure.savefig(file, bbox_inches="tight", dpi=160)
    pyplot.close(figure)
    return file
