"""Commands of the program that write files or list what there is: new, view, convert, ropes. `command_line` registers them."""

from pathlib import Path
from typing import Annotated

import typer

from studies.added_effects import Added
from studies.options import DAMPER, LENGTH, Changes, Json, Step
from studies.scenes import changed, load
from studies.shown.given import give


def new(
    scene: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The file to write; one that is there is left alone.")],
    like: Annotated[
        str, typer.Option(help="The scene to begin from: net_held, net_flown, loose_cable, mooring, tether, ...")
    ] = "net_held",
):
    """Write a commented scene to begin from. It is a copy of one that comes with this."""
    from anet_lumped.files.new_scene import new_scene

    print(new_scene(scene, like))


def ropes(
    diameter: Annotated[float, typer.Option(help="Nominal diameter, as in 24mm or 0.024 (m).", **LENGTH)] = "12mm",
    as_json: Json = False,
):
    """List the ropes that a cable may be made of. Mass, stiffness, strength at one diameter, and where the numbers are from."""
    from studies.shown.summary import ropes_summary

    give(ropes_summary(diameter), as_json)


def view(
    run: Annotated[str, typer.Argument(metavar="RUN", help="A saved run (.nc), or a folder with a run.nc.")],
    out: Annotated[Path | None, typer.Option(help="The file to write: .html (beside the run by default), .gif or .mp4.")] = None,
):
    """Look at a saved run. One page that turns and plays in any browser, without a network, or a film, by the ending of --out."""
    from anet_lumped.files.saved_run import view_saved

    print(view_saved(run, out))


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

    if out.exists() and Path(scene).exists() and out.samefile(scene):
        raise InputError(f"OUT must be another file than SCENE, of which it would keep no comment, but both are {out}.")
    if scene.lower().endswith(ENDING):
        if change or effect:
            raise InputError(f"A saved run is written as it is; --set and --effect change a scene, but {scene} is a run.")
        print(view_saved(scene, out))
        return
    if out.suffix.lower() not in (".toml", *MOORDYN, *ENDINGS):
        raise InputError(f"OUT must end in .toml, {', '.join((*MOORDYN, *ENDINGS))}, but is {out}; .pvd is for a saved run (.nc).")
    ready = changed(load(scene), change, effect)
    if out.suffix.lower() in ENDINGS:
        save_twin(ready, out, dt, links=links, joints=joints, damping=damping or 0.0)
    else:
        save_scene(ready, out)
    print(out)
