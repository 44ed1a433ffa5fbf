"""A sweep as one page that needs nothing but itself: what was asked, figures, sensitivities, what failed, and the rows."""

import json
import tempfile
from pathlib import Path

import numpy as np

from anet_lumped.checks import InputError, SceneError, shown
from anet_lumped.scene.as_dict import scene_from_dict
from studies.shown.figure_file import save_figure
from studies.shown.page import SHOWN, write_template
from studies.shown.sentences import counted, listed
from studies.shown.sweep_figures import Columns, search_figure, sensitivity_figure, sweep_figures
from studies.sweeping.best import read_constraint, read_objective
from studies.sweeping.measures import MEASURES
from studies.sweeping.rows import read_rows
from studies.sweeping.sensitivity import sensitivities
from studies.sweeping.units import unit_of


class SweepPageError(InputError):
    """A folder that holds no sweep."""


def write_sweep_page(folder: Path, out: Path) -> Path:
    """Write the page of a sweep, which may still run.

    Parameters
    ----------
    folder : of the sweep: its rows and `meta.json`
    out : the file to write, .html

    Returns
    -------
    Path : `out`

    Raises
    ------
    SweepPageError, RowsError : the folder holds no sweep, or `out` is no page
    """
    if out.suffix.lower() not in (".html", ".htm"):
        raise SweepPageError(f"A page must end in .html, but {shown(str(out))} was given.")
    table, meta, asked = read_rows(folder)
    identity = meta["identity"]
    if not {"vary", "measures"} <= identity.keys():
        raise SweepPageError(f"A sweep is shown, but the rows of {folder} are of something else.")
    inputs = list(identity["vary"])
    done = table[table["status"] == "done"]
    measures = [name for name in identity["measures"] if name in done and done[name].dtype.kind in "iufb"]
    done = done.dropna(subset=[name for name in measures if done[name].notna().any()])
    measures = [name for name in measures if done[name].notna().all() and np.isfinite(done[name].astype(float)).all()]
    done = done.astype({name: float for name in measures})
    known = {name: MEASURES[name.partition(":")[0]] for name in identity["measures"] if name.partition(":")[0] in MEASURES}
    columns = Columns(
        inputs, measures, _units_of(identity.get("scene", {}), inputs) | {name: one.unit for name, one in known.items()}
    )
    kind = "search" if "best" in identity else "sample" if "sample" in identity else "grid"
    tables = [
        ("Inputs", _of_inputs(table, identity, columns), ""),
        ("Measures", _of_measures(done, columns, known), f"Of {counted(len(done), 'run')} done."),
    ]
    figures = list(sweep_figures(done, columns, kind))
    if str(identity.get("sample", "")).startswith("saltelli"):
        found = sensitivities(table, inputs, measures)
        if len(found):
            note = "Shares of the variance, with intervals of 95 %."
            tables.append(("Sensitivities", found, note))
            figures.insert(0, sensitivity_figure(found))
    if kind == "search" and read_objective(identity["best"])[0] in measures and len(done):
        objective, largest = read_objective(identity["best"])
        constraints = [read_constraint(text) for text in identity["constraints"]]
        good = np.array([all(one.is_met(line) for one in constraints) for line in done.to_dict("records")], bool)
        figures.insert(0, search_figure(done, columns, objective, largest, good))
        if good.any():
            best = done[good].sort_values(objective, ascending=not largest).head(1)
            tables.insert(0, (f"The best: {identity['best']}", best[[*inputs, *measures]], " and ".join(identity["constraints"])))
    failed = table[table["status"] != "done"]
    if len(failed):
        counts = failed.groupby(["status", "reason"], as_index=False).size().sort_values("size", ascending=False)
        first = failed.drop_duplicates(["status", "reason"])[["status", "reason", *inputs]]
        tables.append(
            ("What failed", counts.merge(first).rename(columns={"size": "rows"}).head(SHOWN), "With the first such inputs.")
        )
    versions = ", ".join(f"{name} {version}" for name, version in meta.get("versions", {}).items())
    missing = 0 if asked is None else asked - len(table)
    with tempfile.TemporaryDirectory() as drawn:
        pictures = [save_figure(one.figure, Path(drawn) / f"figure-{i}", one.caption) for i, one in enumerate(figures)]
        write_template(
            out,
            "sweep.html",
            title=f"{listed(identity['measures'][:4])} by {listed(inputs)}",
            about=_about(table, identity, folder, kind),
            unfinished=f"{counted(missing, 'row is', 'rows are')} still to come." if missing else "",
            tables=[(heading, rows, note) for heading, rows, note in tables if len(rows)],
            pictures=pictures,
            rows=table,
            shown=SHOWN,
            made_with=f"{versions}; {meta.get('made', '')}.",
            identity=json.dumps(identity, indent=1, ensure_ascii=False),
        )
    return out


def _units_of(scene, inputs):
    """Units of inputs by what the scene says of its fields; none of a scene with effects that this process does not know."""
    try:
        loaded = scene_from_dict(scene)
    except SceneError:
        return {}
    return {name: unit_of(loaded, name) for name in inputs}


def _about(table, identity, folder, kind):
    bad = int((table["status"] != "done").sum())
    how = {"grid": "A grid", "sample": f"A sample {identity.get('sample')}, seed {identity.get('seed')}", "search": "A search"}[
        kind
    ]
    settings = ", ".join(f"{name} = {value}" for name, value in identity["settings"].items())
    runs = f"Runs with {settings}." if settings else "Shapes at rest."
    which = f"{bad} of them not" if bad else "all of them"
    return f"{how} of {counted(len(table), 'row')} in {folder.resolve().name}, {which} done. {runs}"


def _of_inputs(table, identity, columns):
    import pandas

    lines = []
    for name, spec in identity["vary"].items():
        told = f"{len(spec)} values" if isinstance(spec, list) and len(spec) > 6 else json.dumps(spec).replace('"', "")
        numbers = table[name].dtype.kind in "iuf" and len(table)
        least, largest = (table[name].min(), table[name].max()) if numbers else (None, None)
        lines.append({"input": columns.label(name), "asked for": told, "least": least, "largest": largest})
    return pandas.DataFrame(lines)


def _of_measures(done, columns, known):
    import pandas

    lines = []
    for name in columns.measures:
        low, middle, high = np.quantile(done[name], [0.05, 0.5, 0.95])
        lines.append(
            {
                "measure": columns.label(name), "what it is": known[name].about if name in known else "a function of one's own",
                "least": done[name].min(), "5 % below": low, "median": middle, "mean": done[name].mean(), "5 % above": high,
                "largest": done[name].max(),
            }
        )  # fmt: skip
    return pandas.DataFrame(lines)
