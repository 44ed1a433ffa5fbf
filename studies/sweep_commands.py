"""The commands of the program around sweeps: `sweep`, `gather`, `show` and `measures`."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from studies.added_effects import Added
from studies.options import TIME, Changes, Json, Method, Scene, Step, Whole, folder
from studies.scenes import changed, load
from studies.shown.given import give
from studies.telling import tell

JOBS = 16  # of Slurm by default


def add_sweep_commands(app: typer.Typer) -> None:
    """Give a program the commands of this file."""
    grid = "anet-lumped sweep net_held --vary EA=1e2:1e6:9log --vary segments=5,10"
    sampled = "anet-lumped sweep net_held --vary 'EA~lognormal(1e4,0.2)' --vary p0.mass=0.02:0.05 --sample saltelli:64"
    app.command(epilog=f"Example: {grid}   (EA in N), or {sampled}")(sweep)
    app.command(epilog="Example: anet-lumped gather results/sweep-net_held   (after sweep ... --shard 1/2 and --shard 2/2)")(gather)
    app.command(epilog="Example: anet-lumped show results/sweep-net_held   (then open results/sweep-net_held/sweep.html)")(show)
    app.command()(measures)


def sweep(
    scene: Scene,
    vary: Annotated[
        list[str],
        typer.Option(
            metavar="NAME=SPEC",
            help="What varies: EA (all cables), s0-p0.EA, p0.mass, p0.at.z, gravity.g, air.wind.1.seed, method, dt ...; "
            "over a:b:n (evenly), a:b:nlog (in the logarithm) or a,b,c. Again for a grid. Of a sample or a search: a:b, a:b:log, "
            "a,b,c, or NAME~lognormal(1e4,0.2), normal, uniform, loguniform, triangular, weibull.",
        ),
    ],
    measure: Annotated[
        list[str],
        typer.Option(metavar="NAME", help="What is measured; `anet-lumped measures` lists all. Your own: module:function."),
    ] = [],  # noqa: B006 (typer's way to say "any number")
    t_end: Annotated[float | None, typer.Option(help="How long each variant runs; without, it only rests.", **TIME)] = None,
    method: Method = None,
    dt: Step = None,
    start: Annotated[str | None, typer.Option(help="equilibrium (default), calm or straight.")] = None,
    since: Annotated[float | None, typer.Option("--from", help="From when on measures over time look at a run.", **TIME)] = None,
    sample: Annotated[
        str | None, typer.Option(help="Instead of a grid: sobol:1024, lhs:200, or saltelli:256, which gives sensitivities.")
    ] = None,
    best: Annotated[
        str | None,
        typer.Option(metavar="MEASURE", help="Instead of a grid: search the inputs for which a measure is least, or max MEASURE."),
    ] = None,
    constraint: Annotated[
        list[str], typer.Option(metavar="MEASURE<=NUMBER", help="What the best must keep, as in 'sag<=0.1'; again for more.")
    ] = [],  # noqa: B006
    seed: Annotated[int, typer.Option(help="Of a sample or a search, which are the same for the same seed.", min=0)] = 0,
    budget: Annotated[float | None, typer.Option(help="Time that one variant may take.", **TIME)] = None,
    change: Changes = (),
    effect: Added = (),
    out: Annotated[Path | None, typer.Option(help="Folder for the rows; results/sweep-SCENE by default.", callback=folder)] = None,
    workers: Annotated[int | None, typer.Option(help="Processes; one a core by default. Of Slurm, jobs.", min=1)] = None,
    on: Annotated[
        str | None, typer.Option(metavar="MACHINES", help="Other machines: dask:tcp://node:8786, mpi, or slurm:PARTITION.")
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(metavar="I/N", help="Do the I-th of N shares of the rows; `anet-lumped gather` puts them together."),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Keep the rows in the folder and do the rest.")] = False,
    as_json: Json = False,
    whole: Whole = False,
):
    """Measure a scene over a grid or a sample of inputs, or search the best.

    Runs in parallel; rows are on disk as they finish, a picture at the end.
    With --on and --shard what is done is kept without --resume, and the folder must be one that all machines see.
    """
    _check_together(sample, best, constraint, on, shard)
    if on is None:
        from studies.sweeping.workers import start_early

        start_early()
    from studies.shown.sweep_figure import save_sweep
    from studies.sweeping.parts import read_shard
    from studies.sweeping.sweep import sweep
    from studies.sweeping.units import with_units
    from studies.sweeping.vary import parse_vary

    out = out or Path("results") / f"sweep-{Path(scene).stem}"
    settings = {"t_end": t_end, "method": method, "dt": dt, "start": start, "since": since, "budget": budget, "seed": seed}
    varied = parse_vary(vary)
    try:
        loaded = changed(load(scene), change, effect)
        if best is not None:
            _search(loaded, varied, best, constraint, measure, settings, out, workers, on, resume, as_json)
            return
        kept = {"sample": sample, "out": out, "label": "sweep"}
        call = partial(sweep, loaded, varied, measure, **settings, **kept)
        if on is not None:
            table = _on_machines(on, call, workers, out)
            if table is None:
                return
        else:
            table = call(resume=resume, workers=workers, shard=None if shard is None else read_shard(shard))
    except KeyboardInterrupt as stopped:
        again = "The same command" if on or shard else "The same command with --resume"
        tell(f"{str(stopped) or 'Stopped.'} {again} does the rest.")
        raise typer.Exit(130) from None
    if shard is None or read_shard(shard).count == 1:
        heads = with_units(loaded, table.columns)
        save_sweep(table, list(varied), heads, out)
        more = _sensitivities(out, table)
        _give_rows(table, as_json, f"{out}/rows.parquet and .csv, drawn in sweep.png", more, heads=heads, whole=whole)
    else:
        _give_rows(table, as_json, f"{out}/parts; when all shards are done, anet-lumped gather {out} puts them together")


def gather(
    sweep: Annotated[Path, typer.Argument(metavar="FOLDER", help="The folder of a sweep whose rows were done in parts.")],
    as_json: Json = False,
):
    """Put the parts of a sweep together: rows.parquet, which pandas, polars and DuckDB read, and rows.csv.

    Rows that lack are counted and named; the command that makes them does what is left of them.
    """
    from studies.shown.sentences import counted
    from studies.sweeping.rows import gather

    table, missing, torn = gather(sweep)
    for path in torn:
        tell(f"warning: the part {path} is torn; the same sweep does its rows again.")
    if missing:
        first = ", ".join(map(str, missing[:5])) + (", ..." if len(missing) > 5 else "")
        tell(
            f"{counted(len(missing), 'row')} of {len(table) + len(missing)} lack, of the numbers {first}: the same sweep does them."
        )
    _give_rows(table, as_json, f"{sweep}/rows.parquet and .csv", {} if missing else _sensitivities(sweep, table), bool(missing))


def show(
    sweep: Annotated[Path, typer.Argument(metavar="FOLDER", help="The folder of a sweep, which may still run.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="The page to write; sweep.html in the folder by default.")
    ] = None,
):
    """Draw a sweep as one page to hand on: curves, heat maps, scatter, parallel coordinates, sensitivities, failures."""
    from studies.shown.sweep_page import write_sweep_page

    print(write_sweep_page(sweep, out or sweep / "sweep.html"))


def measures():
    """List what a sweep can measure. Those "from" look at a run from --from on; of several segments or ends the worst counts."""
    from studies.sweeping.measures import MEASURES

    rows = [{"measure": name} | measure._asdict() for name, measure in MEASURES.items()]
    for row in rows:
        del row["function"], row["of_ground"]
        row["source"] += ", from" if row.pop("over_time") else ""
    give({"measures": rows}, whole=True)


def _check_together(sample, best, constraint, on, shard):
    """Refuse options that exclude each other."""
    given = [name for name, value in (("--sample", sample), ("--best", best), ("--shard", shard)) if value is not None]
    if best is not None and (sample is not None or shard is not None):
        raise typer.BadParameter(f"{given[0]} and {given[1]} exclude each other.")
    if constraint and best is None:
        raise typer.BadParameter("--constraint is for --best.")
    if on is not None and shard is not None:
        raise typer.BadParameter("--on and --shard exclude each other.")
    if best is not None and on is not None and on.startswith("slurm"):
        raise typer.BadParameter("--best runs on dask or mpi; the jobs of Slurm know nothing of each other.")


def _on_machines(on, call, workers, out):
    """Table of a sweep on other machines; None for a rank of MPI that only serves."""
    from studies.sweeping.machines import machines_on, read_on, through_slurm
    from studies.sweeping.rows import gather

    kind, address = read_on(on)
    if kind == "slurm":
        through_slurm(address, call, workers or JOBS, out / "slurm")
        return gather(out)[0]
    with machines_on(kind, address) as machines:
        if machines.executor is None:
            return None
        return call(executor=machines.executor, workers=machines.workers)


def _search(scene, varied, objective, constraint, measure, settings, out, workers, on, resume, as_json):
    """Search the best, and give it."""
    from contextlib import nullcontext

    from studies.sweeping.best import best
    from studies.sweeping.machines import Machines, machines_on, read_on

    with nullcontext(Machines(None, workers)) if on is None else machines_on(*read_on(on)) as machines:
        if on is not None and machines.executor is None:
            return
        found = best(
            scene, varied, objective, constraints=constraint, measures=measure, **settings, executor=machines.executor,
            workers=machines.workers if on is None else None, out=out, resume=resume,
        )  # fmt: skip
    give({"best": [] if found.row is None else [found.row]}, as_json)
    tell(f"{len(found.table)} rows in {out}/rows.parquet and .csv.")
    if found.row is None:
        tell(f"No row that is done meets {' and '.join(constraint) or 'the question'}.")
        raise typer.Exit(1)


def _sensitivities(out, table):
    from studies.sweeping.sensitivity import save_sensitivities

    found = save_sensitivities(out, table)
    return {} if found is None else {"sensitivities": found.to_dict("records")}


def _give_rows(table, as_json, where, more=None, failed=False, heads=None, whole=False):
    """Print the rows, with units in the ``heads`` of columns, and say where they are; exit with 1 if some are not done."""
    rows = {"rows": (table if as_json else table.rename(columns=heads or {})).to_dict("records")}
    give(
        rows | (more or {}) if as_json or not more else more, as_json, whole=whole
    )  # the rows of a sample say nothing that these do not
    bad = int((table["status"] != "done").sum())
    tell(f"{len(table)} rows in {where}" + (f", {bad} of them not done." if bad else "."))
    if bad or failed:
        raise typer.Exit(1)
