"""The program `anet-lumped`: results on stdout or in a folder, progress and warnings on stderr.

Exit status 0: done; 1: a run failed; 2: bad input; 128 and the signal's number: stopped by a signal, so 130 by Ctrl-C, 143 by
SIGTERM. What a command needs it imports itself, so that `--help` answers at once.
"""

import importlib.metadata
import logging
import os
import sys
import warnings
from pathlib import Path
from typing import Annotated

import typer

from studies.added_effects import Added
from studies.exit_status import exit_status
from studies.options import DAMPER, LENGTH, PLACE, TIME, Changes, Full, Json, Method, Move, Out, Quick, Scene, Start, Step, folder
from studies.quantities import metres, newtons
from studies.scenes import changed, load
from studies.shown.given import give
from studies.stop_signals import stop_signals
from studies.streams import PrintError, standard_streams
from studies.telling import announce_compiling, tell, tell_lines, tell_what_takes_long
from studies.winches import Winches, with_winches

app = typer.Typer(no_args_is_help=True, add_completion=True, rich_markup_mode=None, pretty_exceptions_enable=False)

REPORT = Path("results/report")
SHOWN = 60  # rows of a sweep on the screen


def _save_run(run, out):
    run.save(out / "run.nc")
    run.plot().savefig(out / "run.png", dpi=110)


def main(arguments: list[str] | None = None) -> None:
    """Run the program; whatever the user can put right is one sentence on stderr."""
    with stop_signals() as came, standard_streams():
        try:
            os.environ["MPLBACKEND"] = "agg"  # figures go to files, whatever windows a user's setting asks for
            warnings.showwarning = lambda message, *where: tell_lines(f"warning: {message}")
            tell_what_takes_long()
            status = exit_status(app, arguments)
            sys.stdout.flush()
        except KeyboardInterrupt:
            status = 130
        except PrintError as error:
            status = 1
            if str(error):
                tell(f"What is printed could not be written: {error}.")
    sys.exit(128 + came[0] if came else status)


def _tell_version(asked: bool):
    """Print the version and exit, if it is asked for."""
    if asked:
        print(importlib.metadata.version("anet-lumped"))
        raise typer.Exit


@app.callback(epilog="Example: anet-lumped simulate net_carried --t-end 4 --out results/carried   (4 s of motion)")
def _about(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_tell_version, is_eager=True)
    ] = False,
):
    """Elastic cables and nets as lumped masses: rest, motion, stability, and their distance from the catenary."""


@app.command(epilog="Example: anet-lumped new mine.toml --like tether   (then: anet-lumped equilibrium mine.toml)")
def new(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The file to write; one that is there is left alone.")],
    like: Annotated[
        str, typer.Option(help="The scene to begin from: net_held, net_flown, loose_cable, mooring, tether, ...")
    ] = "net_held",
):
    """Write a commented scene to begin from. It is a copy of one that comes with this."""
    from anet_lumped.files.new_scene import new_scene

    print(new_scene(scene, like))


@app.command(epilog="Example: anet-lumped equilibrium net_held --out results/rest")
def equilibrium(scene: Scene, change: Changes = (), out: Out = None, as_json: Json = False, effect: Added = ()):
    """Find the shape at rest. Stretch [-], sag [m] and tension [N] of each cable, position [m] of each free point.

    With --out also the places of all nodes (nodes.csv) and a picture (rest.png).
    """
    from anet_lumped.statics.equilibrium import equilibrium
    from studies.shown.summary import rest_summary, write_nodes

    state = equilibrium(changed(load(scene, "equilibrium"), change, effect))

    def save():
        write_nodes(state, out / "nodes.csv")
        state.plot().savefig(out / "rest.png", dpi=110)

    give(rest_summary(state), as_json, out, "equilibrium", save)


@app.command(epilog="Example: anet-lumped simulate loose_cable --t-end 0.6 --start straight --method edmc --dt 0.01")
def simulate(
    scene: Scene,
    t_end: Annotated[float, typer.Option(help="How long to run, as in 4s or 4.", **TIME)],
    method: Method = None,
    dt: Step = None,
    rtol: Annotated[float | None, typer.Option(help="Adaptive steps: error of a step over the largest coordinate.")] = None,
    extrapolate: Annotated[bool, typer.Option(help="Combine with a half-step run (order 4).")] = False,
    start: Annotated[str, typer.Option(help="equilibrium, straight, or a CSV of places along cables.")] = "equilibrium",
    save_every: Annotated[float | None, typer.Option(help="Time between saved states.", **TIME)] = None,
    change: Changes = (),
    effect: Added = (),
    move: Move = (),
    winch: Winches = (),
    error: Annotated[float | None, typer.Option(help="Error of places to keep, as in 1mm; chosen if not given.", **LENGTH)] = None,
    tension_error: Annotated[float | None, typer.Option(help="Error of the largest tension to keep, over it; 0.02 is 2 %.")] = None,
    audit: Annotated[bool, typer.Option("--audit", help="Run again with half the step, and estimate the error.")] = False,
    out: Out = None,
    as_json: Json = False,
):
    """Run a scene. Status, work, energy [J], stretch [-] and tension [N] of each cable, positions at the end [m].

    With --out the run is saved there (run.nc), with its account (run.json), a picture (run.png), and the channels that a MoorDyn
    file asks for (.out, .LineN.out). A run that does not reach
    its end, gains energy or fails its audit exits with 1, and says so in all of them.
    """
    from anet_lumped.files.motion_file import moved
    from anet_lumped.files.start_file import read_start
    from anet_lumped.motion.simulate import RunInterrupt, simulate
    from studies.shown.summary import run_summary

    ready = moved(changed(load(scene, "simulate"), change, effect), move, t_end)
    begin = read_start(start, ready) if start.lower().endswith(".csv") else start
    ready = with_winches(ready, winch, t_end, begin)
    try:
        run = simulate(
            ready, t_end, method=method, dt=dt, rtol=rtol, start=begin, save_every=save_every, extrapolate=extrapolate, audit=audit,
            tension_error=tension_error, error=error,
        )  # fmt: skip
    except RunInterrupt as stopped:
        run = stopped.run

    def save():
        from anet_lumped.files.moordyn_channels import write_asked

        _save_run(run, out)
        write_asked(scene, run, out)

    give(run_summary(run), as_json, out, "run", save)
    if not run.ok:
        raise typer.Exit(1)


@app.command(
    epilog="Example: anet-lumped fly quadrotors_net --by 0,10,0 --within 4s --t-end 7s --out results/flown   (10 m in 4 s)"
)
def fly(
    scene: Scene,
    controller: Annotated[str | None, typer.Option(help="hold, net, admittance or predictive; chosen if not given.")] = None,
    t_end: Annotated[
        float | None, typer.Option(help="How long to fly, as in 4s; that of its own of a bundled scene.", **TIME)
    ] = None,
    dt: Annotated[float, typer.Option(help="Step, as in 4ms or 0.004 (s).", **TIME)] = "4ms",
    by: Annotated[tuple | None, typer.Option(help="How far to go, as in 0,10,0 (m).", **PLACE)] = None,
    within: Annotated[float, typer.Option(help="Time in which to go there.", **TIME)] = "4s",
    save_every: Annotated[float | None, typer.Option(help="Time between saved states.", **TIME)] = None,
    change: Changes = (),
    effect: Added = (),
    out: Out = None,
    as_json: Json = False,
):
    """Fly a scene with quadrotors, which start where they hover. Tables and files are those of simulate.

    hold: each quadrotor keeps its place. net: p0 and the shape of the net are kept. admittance: as hold, but quadrotors give way to
    pulls. predictive: one quadrotor brings its load to a place, by model-predictive control (extra mpc). The scenes that come with
    this have flights of their own.
    """
    from anet_lumped.flight.fly import fly
    from anet_lumped.flight.known import known_quadrotors
    from anet_lumped.flight.scenarios import controller_for, scenario_of
    from anet_lumped.results.run import RunInterrupt
    from studies.shown.summary import run_summary

    loaded = changed(load(scene, "fly"), change, effect)
    quadrotors = known_quadrotors(loaded)
    flight = scenario_of(loaded, scene, controller=controller, t_end=t_end, by=by, within=within)
    try:
        run = fly(loaded, controller_for(loaded, flight), flight.t_end, dt=dt, quadrotors=quadrotors, save_every=save_every)
    except RunInterrupt as stopped:
        run = stopped.run
    give(run_summary(run), as_json, out, "run", lambda: _save_run(run, out))
    if not run.ok:
        raise typer.Exit(1)


@app.command(epilog="Example: anet-lumped recommend net_carried --error 1mm --at p0 --realtime 5")
def recommend(
    scene: Scene,
    error: Annotated[float, typer.Option(help="Largest error of a position, as in 1mm, 0.05cm or 0.001 (m).", **LENGTH)],
    at: Annotated[str | None, typer.Option(help="The free point whose position counts; all if not given.")] = None,
    t_end: Annotated[float | None, typer.Option(help="How long to simulate; two swings if not given.", **TIME)] = None,
    start: Start = "equilibrium",
    realtime: Annotated[float | None, typer.Option(help="How many times faster than real time it must run.")] = None,
    change: Changes = (),
    effect: Added = (),
    as_json: Json = False,
):
    """Find the cheapest segments, method and step for an error. Its parts, the runner-up, and the command to run."""
    from anet_lumped.advice.recommend import recommend
    from studies.shown.summary import recommendation_summary

    loaded = changed(load(scene, "recommend"), change, effect)
    found = recommend(loaded, error, at=at, t_end=t_end, start=start, realtime=realtime)
    give(recommendation_summary(found, scene, change, effect), as_json)
    if not found.fast_enough:
        pace = found.best.times_real_time
        tell(
            f"within {error:g} m it runs {pace:.3g} times faster than real time, and not {realtime:g} times; allow a larger error."
        )
        raise typer.Exit(1)


@app.command(epilog="Example: anet-lumped effects net_flown --error 1mm --at p0   (or --error 0.05N --tension s0-p0)")
def effects(
    scene: Scene,
    error: Annotated[str, typer.Option(help="Change that matters: of a position, as in 1mm; of a tension, as in 0.1N.")] = "1mm",
    at: Annotated[str | None, typer.Option(help="The free point whose position counts; all if not given.")] = None,
    tension: Annotated[str | None, typer.Option(metavar="CABLE", help="The cable whose tension counts instead.")] = None,
    t_end: Annotated[float | None, typer.Option(help="How long to simulate; two swings if not given.", **TIME)] = None,
    start: Start = "equilibrium",
    water_level: Annotated[float | None, typer.Option(help="Height of still water, if there is any.", **LENGTH)] = None,
    change: Changes = (),
    effect: Added = (),
    out: Out = None,
    as_json: Json = False,
):
    """Judge which effects a scene needs. Of each, its dimensionless number, what it changes, its cost, and a verdict.

    What the scene has is taken away, what it lacks but could have is put in, one at a time; with --out also as effects.csv.
    """
    from anet_lumped.advice.effect_audit import audit_effects
    from studies.shown.summary import effects_summary, write_effects

    limit = newtons(error) if tension else metres(error)
    loaded = changed(load(scene, "effects"), change, effect)
    found = audit_effects(loaded, limit, at=at, tension=tension, t_end=t_end, start=start, water_level=water_level)
    give(effects_summary(found), as_json, out, "effects", lambda: write_effects(found, out / "effects.csv"))


@app.command(epilog="Example: anet-lumped check net_held --dt 1ms")
def check(
    scene: Scene,
    dt: Annotated[float | None, typer.Option(help="A step to judge, as in 1ms.", **TIME)] = None,
    change: Changes = (),
    effect: Added = (),
    as_json: Json = False,
):
    """Predict stretch and stable steps. Before any run: also top frequency, damping, warnings."""
    from studies.shown.summary import prediction_summary

    give(prediction_summary(changed(load(scene, "equilibrium"), change, effect), dt), as_json)


@app.command(epilog="Example: anet-lumped sweep net_held --vary EA=1e2:1e6:9log --vary segments=5,10  (EA in N)")
def sweep(
    scene: Scene,
    vary: Annotated[
        list[str],
        typer.Option(
            metavar="NAME=SPEC",
            help="What varies: EA (all cables), s0-p0.EA, p0.mass, p0.at.z, gravity.g, air.wind.1.seed, method, dt ...; "
            "over a:b:n (evenly), a:b:nlog (in the logarithm) or a,b,c. Again for a grid.",
        ),
    ],
    measure: Annotated[list[str], typer.Option(metavar="NAME", help="What is measured; `anet-lumped measures` lists all.")] = [],  # noqa: B006 (typer's way to say "any number")
    t_end: Annotated[float | None, typer.Option(help="How long each variant runs; without, it only rests.", **TIME)] = None,
    method: Method = None,
    dt: Step = None,
    start: Annotated[str | None, typer.Option(help="equilibrium (default) or straight.")] = None,
    since: Annotated[float | None, typer.Option("--from", help="From when on measures over time look at a run.", **TIME)] = None,
    change: Changes = (),
    effect: Added = (),
    out: Annotated[Path | None, typer.Option(help="Folder for the rows; results/sweep-SCENE by default.", callback=folder)] = None,
    workers: Annotated[int | None, typer.Option(help="Processes; one a core by default.", min=1)] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Keep the rows in the folder and do the rest.")] = False,
    as_json: Json = False,
):
    """Measure a scene over a grid of inputs. Runs in parallel; rows are on disk as they finish."""
    from studies.sweeping.workers import start_early

    start_early()
    from studies.sweeping.sweep import sweep
    from studies.sweeping.vary import parse_vary

    out = out or Path("results") / f"sweep-{Path(scene).stem}"
    settings = {"t_end": t_end, "method": method, "dt": dt, "start": start, "since": since}
    try:
        loaded = changed(load(scene, "simulate" if t_end else "equilibrium"), change, effect)
        table = sweep(loaded, parse_vary(vary), measure, **settings, out=out, resume=resume, workers=workers, label="sweep")
    except KeyboardInterrupt as stopped:
        tell(f"{str(stopped) or 'Stopped.'} The same command with --resume does the rest.")
        raise typer.Exit(130) from None
    give({"rows": (table if as_json else table.head(SHOWN)).to_dict("records")}, as_json)
    bad = int((table["status"] != "done").sum())
    tell(f"{len(table)} rows in {out}/rows.parquet and .csv" + (f", {bad} of them not done." if bad else "."))
    if bad:
        raise typer.Exit(1)


@app.command()
def measures():
    """List what a sweep can measure. Those "from" look at a run from --from on; of several segments or ends the worst counts."""
    from studies.sweeping.measures import MEASURES

    rows = [{"measure": name} | measure._asdict() for name, measure in MEASURES.items()]
    for row in rows:
        del row["function"], row["of_ground"]
        row["source"] += ", from" if row.pop("over_time") else ""
    give({"measures": rows})


@app.command(epilog="Example: anet-lumped study length_error --quick --out results/length_error")
def study(
    name: Annotated[str | None, typer.Argument(help="Name of the study; lists them and their questions if not given.")] = None,
    quick: Quick = False,
    out: Annotated[Path | None, typer.Option(help="Folder for rows and figures; results/NAME by default.", callback=folder)] = None,
    data: Annotated[Path | None, typer.Option(help="Folder of data, which the studies measured and moorings take.")] = None,
):
    """Run one study. Writes its rows and figures, prints its answer."""
    from studies.study import NAMES, question_of, run_study

    if name is None:
        for one in NAMES:
            print(f"{one:{max(map(len, NAMES))}}  {question_of(one)}")
        return
    announce_compiling("study")
    logging.getLogger("anet_lumped").setLevel(logging.WARNING)  # of a study its rows are told, not their runs
    found = run_study(name, out := out or Path("results") / name, quick=quick, data=data)
    print(found.record.question, *found.answer, sep="\n\n")
    tell(f"{found.seconds:.1f} s; rows, figures and answer in {out}")


@app.command(epilog="Example: anet-lumped mismatch net_held --markers run1.csv   (columns x, y, z in m or mm)")
def mismatch(
    scene: Scene,
    markers: Annotated[Path | None, typer.Option(help="Measured positions (CSV), or tracks over time (CSV, NPZ, TRC).")] = None,
    tension: Annotated[Path | None, typer.Option(help="Measured tensions over time, by the names of cables (CSV, NPZ).")] = None,
    shift: Annotated[float | None, typer.Option(help="Time of the run at the first sample; sought if not given.", **TIME)] = None,
    change: Changes = (),
    effect: Added = (),
    out: Out = None,
    as_json: Json = False,
):
    """Compare with the catenary or with markers. RMSE [m], R², length [m], sag [m] and tension [N] of each cable.
    With tensions or tracks over time the scene is run from its rest and aligned with them: RMSE, peak and phase error of each.
    """
    from studies.shown.mismatch_summary import compared

    scene = changed(load(scene, "equilibrium"), change, effect)
    found, save, ok = compared(scene, markers, tension, shift, out)
    give(found, as_json, out, "mismatch", save)
    raise typer.Exit(0 if ok else 1)


@app.command(epilog="Example: anet-lumped report --out results/report")
def report(
    full: Full = False,
    out: Annotated[Path, typer.Option(help="Folder for the page and its data.", callback=folder)] = REPORT,
):
    """Run the studies and write one page. What the thesis found, why, and what cures it.

    The page is there from the start and grows with every study. Without --full it takes some minutes, and a first look of the
    studies that are long.
    """
    announce_compiling("report")
    for log in map(logging.getLogger, ("anet_lumped", "studies")):  # a report tells its studies
        log.setLevel(logging.WARNING)
    from studies.report import PAGE, ReportInterrupt, most_at_once, write_report
    from studies.shown.progress import report_progress

    try:
        with report_progress(tell) as tell_study:
            failed = write_report(out, full=full, at_once=most_at_once(), tell=tell_study)
    except ReportInterrupt as stopped:
        tell(str(stopped))
        raise typer.Exit(130) from None
    print(out / PAGE)
    if failed:
        raise typer.Exit(1)


@app.command(epilog="Example: anet-lumped ropes --diameter 24mm   (nominal)")
def ropes(
    diameter: Annotated[float, typer.Option(help="Nominal diameter, as in 24mm or 0.024 (m).", **LENGTH)] = "12mm",
    as_json: Json = False,
):
    """List the ropes that a cable may be made of. Mass, stiffness, strength at one diameter, and where the numbers are from."""
    from studies.shown.summary import ropes_summary

    give(ropes_summary(diameter), as_json)


@app.command(epilog="Example: anet-lumped view results/carried --out carried.gif   (at its own pace, if it lasts 2 to 12 s)")
def view(
    run: Annotated[str, typer.Argument(metavar="RUN", help="A saved run (.nc), or a folder with a run.nc.")],
    out: Annotated[Path | None, typer.Option(help="The file to write: .html (beside the run by default), .gif or .mp4.")] = None,
):
    """Look at a saved run. One page that turns and plays in any browser, without a network, or a film, by the ending of --out."""
    announce_compiling("equilibrium")
    from anet_lumped.files.saved_run import view_saved

    print(view_saved(run, out))


@app.command(epilog="Example: anet-lumped convert mooring.txt mooring.toml   (lengths in m, forces in N)")
def convert(
    scene: Annotated[str, typer.Argument(metavar="SCENE", help="A scene, as of the other commands, or a saved run (.nc).")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="The file to write, whose ending says what it is to be.")],
    change: Changes = (),
    effect: Added = (),
    links: Annotated[str, typer.Option(help="Of a twin: cylinder or lumped.")] = "cylinder",
    joints: Annotated[str, typer.Option(help="Of a twin: ball or revolute.")] = "ball",
    damping: Annotated[float | None, typer.Option(help="Of a twin: damper of each joint, as in 1e-4 (N m s).", **DAMPER)] = None,
    dt: Step = None,
):
    """Write a scene as TOML (.toml), for MoorDyn (.txt, .dat, .moordyn), as its twin of rigid links for MuJoCo (.xml) or Gazebo
    (.sdf); or a saved run as a VTK series for ParaView (.pvd)."""
    from anet_lumped.checks import InputError
    from anet_lumped.files.saved_run import ENDING, view_saved
    from anet_lumped.files.scene_file import MOORDYN, save_scene
    from anet_lumped.files.twin_file import ENDINGS, save_twin

    if scene.lower().endswith(ENDING):
        if change or effect:
            raise InputError(f"A saved run is written as it is; --set and --effect change a scene, but {scene} is a run.")
        print(view_saved(scene, out))
        return
    if out.suffix.lower() not in (".toml", *MOORDYN, *ENDINGS):
        raise InputError(f"OUT must end in .toml, {', '.join((*MOORDYN, *ENDINGS))}, but is {out}; .pvd is for a saved run (.nc).")
    ready = changed(load(scene, "equilibrium"), change, effect)
    if out.suffix.lower() in ENDINGS:
        save_twin(ready, out, dt, links=links, joints=joints, damping=damping or 0.0)
    else:
        save_scene(ready, out)
    print(out)
