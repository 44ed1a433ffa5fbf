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

from studies import file_commands
from studies.added_effects import Added
from studies.exit_status import exit_status
from studies.options import (
    LENGTH,
    PLACE,
    TIME,
    At,
    Audit,
    Changes,
    Full,
    Json,
    Method,
    Move,
    Out,
    Quick,
    Scene,
    Start,
    Step,
    Tension,
    Whole,
    folder,
)
from studies.quantities import largest_error
from studies.scenes import changed, load
from studies.shown.given import give
from studies.stop_signals import stop_signals
from studies.streams import PrintError, standard_streams
from studies.sweep_commands import add_sweep_commands
from studies.telling import announce_compiling, tell, tell_lines, tell_what_takes_long
from studies.winches import Winches, with_winches

app = typer.Typer(no_args_is_help=True, add_completion=True, rich_markup_mode=None, pretty_exceptions_enable=False)

REPORT = Path("results/report")


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
            announce_compiling(sys.argv[1:] if arguments is None else arguments)
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


app.command(epilog="Example: anet-lumped new mine.toml --like tether   (then: anet-lumped equilibrium mine.toml)")(
    file_commands.new
)


@app.command(epilog="Example: anet-lumped equilibrium net_held --out results/rest")
def equilibrium(
    scene: Scene, change: Changes = (), out: Out = None, as_json: Json = False, effect: Added = (), whole: Whole = False
):
    """Find the shape at rest. Stretch [-], sag [m] and tension [N] of each cable, position [m] of each free point.

    With --out also the places of all nodes (nodes.csv) and a picture (rest.png).
    """
    from anet_lumped.statics.equilibrium import equilibrium
    from studies.shown.summary import rest_summary, write_nodes

    state = equilibrium(changed(load(scene), change, effect))

    def save():
        write_nodes(state, out / "nodes.csv")
        state.plot().savefig(out / "rest.png", dpi=110)

    give(rest_summary(state), as_json, out, "equilibrium", save, whole)


@app.command(epilog="Example: anet-lumped simulate loose_cable --t-end 0.6 --start straight --method edmc --dt 0.01")
def simulate(
    scene: Scene,
    t_end: Annotated[float, typer.Option(help="How long to run, as in 4s or 4.", **TIME)],
    method: Method = None,
    dt: Step = None,
    rtol: Annotated[float | None, typer.Option(help="Adaptive steps: error of a step over the largest coordinate.")] = None,
    extrapolate: Annotated[bool, typer.Option(help="Combine with a half-step run (order 4).")] = False,
    start: Annotated[
        str, typer.Option(help="equilibrium, calm (without turbulence and waves), straight, or a CSV of places along cables.")
    ] = "equilibrium",
    save_every: Annotated[float | None, typer.Option(help="Time between saved states.", **TIME)] = None,
    change: Changes = (),
    effect: Added = (),
    move: Move = (),
    winch: Winches = (),
    error: Annotated[float | None, typer.Option(help="Error of places to keep, as in 1mm; chosen if not given.", **LENGTH)] = None,
    tension_error: Annotated[float | None, typer.Option(help="Error of the largest tension to keep, over it; 0.02 is 2 %.")] = None,
    audit: Audit = False,
    out: Out = None,
    as_json: Json = False,
    whole: Whole = False,
):
    """Run a scene. Status, work, energy [J], stretch [-] and tension [N] of each cable, positions at the end [m].

    With --out the run is saved there (run.nc), with its account (run.json), a picture (run.png), and the channels that a MoorDyn
    file asks for. A run that does not reach its end, gains energy or fails its audit exits with 1, and says so in all of them.
    """
    from anet_lumped.files.motion_file import moved
    from anet_lumped.files.start_file import read_start
    from anet_lumped.motion.simulate import RunInterrupt, simulate
    from studies.shown.summary import run_summary

    ready = moved(changed(load(scene), change, effect), move, t_end)
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

    give(run_summary(run), as_json, out, "run", save, whole)
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
    audit: Audit = False,
    out: Out = None,
    as_json: Json = False,
    whole: Whole = False,
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

    loaded = changed(load(scene), change, effect)
    quadrotors = known_quadrotors(loaded)
    flight = scenario_of(loaded, scene, controller=controller, t_end=t_end, by=by, within=within)
    try:
        run = fly(
            loaded, controller_for(loaded, flight), flight.t_end, dt=dt, quadrotors=quadrotors, save_every=save_every, audit=audit
        )
    except RunInterrupt as stopped:
        run = stopped.run
    give(run_summary(run), as_json, out, "run", lambda: _save_run(run, out), whole)
    if not run.ok:
        raise typer.Exit(1)


@app.command(
    epilog="Example: anet-lumped recommend net_carried --error 1mm --at p0 --realtime 5   (or --error 50kN --tension line1)"
)
def recommend(
    scene: Scene,
    error: Annotated[str, typer.Option(help="Largest error: of a position, as in 1mm; of a tension, as in 50kN.")],
    at: At = None,
    tension: Tension = None,
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

    loaded = changed(load(scene), change, effect)
    limit = largest_error(error, of_tension=tension is not None)
    found = recommend(loaded, limit, at=at, tension=tension, t_end=t_end, start=start, realtime=realtime)
    give(recommendation_summary(found, scene, change, effect), as_json)
    if found.left_out:
        raise typer.Exit(130)
    if not found.fast_enough:
        pace = found.best.times_real_time
        tell(f"within {error} it runs {pace:.3g} times faster than real time, and not {realtime:g} times; allow a larger error.")
        raise typer.Exit(1)


@app.command(epilog="Example: anet-lumped effects net_flown --error 1mm --at p0   (or --error 0.05N --tension s0-p0)")
def effects(
    scene: Scene,
    error: Annotated[str, typer.Option(help="Change that matters: of a position, as in 1mm; of a tension, as in 0.1N.")] = "1mm",
    at: At = None,
    tension: Tension = None,
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

    limit = largest_error(error, of_tension=tension is not None)
    loaded = changed(load(scene), change, effect)
    found = audit_effects(loaded, limit, at=at, tension=tension, t_end=t_end, start=start, water_level=water_level)
    give(effects_summary(found), as_json, out, "effects", lambda: write_effects(found, out / "effects.csv"))
    if found.left_out:
        raise typer.Exit(130)


@app.command(epilog="Example: anet-lumped check net_held --dt 1ms")
def check(
    scene: Scene,
    dt: Annotated[float | None, typer.Option(help="A step to judge, as in 1ms.", **TIME)] = None,
    change: Changes = (),
    effect: Added = (),
    as_json: Json = False,
    whole: Whole = False,
):
    """Predict stretch and stable steps. Before any run: also top frequency, damping, warnings."""
    from studies.shown.summary import prediction_summary

    give(prediction_summary(changed(load(scene), change, effect), dt), as_json, whole=whole)


add_sweep_commands(app)


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
    logging.getLogger("anet_lumped").setLevel(logging.WARNING)  # of a study its rows are told, not their runs
    found = run_study(name, out := out or Path("results") / name, quick=quick, data=data)
    print(found.record.question, *found.answer, sep="\n\n")
    tell(f"{found.seconds:.1f} s; rows, figures and answer in {out}")


@app.command(epilog="Example: anet-lumped mismatch net_held --markers run1.csv   (columns x, y, z in m or mm)")
def mismatch(
    scene: Scene,
    markers: Annotated[Path | None, typer.Option(help="Positions (CSV), or tracks (CSV, NPZ, TRC; of Motive, of Nexus).")] = None,
    tension: Annotated[Path | None, typer.Option(help="Measured tensions over time, by the names of cables (CSV, NPZ).")] = None,
    shift: Annotated[float | None, typer.Option(help="Time of the run at the first sample; sought if not given.", **TIME)] = None,
    up: Annotated[str | None, typer.Option(help="Axis of tracks that points up, y or z; y of Motive, z of others.")] = None,
    change: Changes = (),
    effect: Added = (),
    out: Out = None,
    as_json: Json = False,
    whole: Whole = False,
):
    """Compare with the catenary or with markers. RMSE [m], R², length [m], sag [m] and tension [N] of each cable.

    Markers are of one shape, or tracks, of which medians are taken where no name is one of the scene's. With --out also a picture,
    the distance of each marker (markers.csv) and the scene with its fitted lengths (fitted.toml). With tensions, or with tracks
    named as points or places on cables (s0-p0@0.25), the scene is run from its rest: RMSE, peak and phase error of each.
    """
    from studies.shown.mismatch_summary import compared

    scene = changed(load(scene), change, effect)
    found, save, ok = compared(scene, markers, tension, shift, up, out)
    give(found, as_json, out, "mismatch", save, whole)
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


app.command(epilog="Example: anet-lumped ropes --diameter 24mm   (nominal)")(file_commands.ropes)


app.command(epilog="Example: anet-lumped view results/carried --out carried.gif   (at its own pace, if it lasts 2 to 12 s)")(
    file_commands.view
)


app.command(epilog="Example: anet-lumped convert mooring.txt mooring.toml   (lengths in m, forces in N)")(file_commands.convert)
