"""Decks of the study: those in a folder, or small ones that are written here."""

import warnings
from pathlib import Path

from anet_lumped import Cable, Driven, Fixed, Free, Scene, SceneError, paths, read_moordyn
from anet_lumped.checks import InputError
from anet_lumped.files.moordyn_writer import moordyn_text
from anet_lumped.model.build import build

CHAIN = {"mass_per_length": 113.0, "EA": 7.5e8, "zeta": 0.8, "diameter": 0.09, "compression": "damped"}
COEFFICIENTS = {"Cdn": 1.6, "Cdt": 0.1, "Can": 1.0, "Cat": 0.0}
ROPE = {"mass_per_length": 22.0, "EA": 1.4e8, "zeta": 0.5, "diameter": 0.14, "compression": "damped"}
DEPTH, SEGMENTS = 80.0, 20
OWN_NAMES = ("catenary", "taut", "two_legs")


def files(folder: str | Path | None, out: Path) -> list[Path]:
    """Decks of a folder in the order of their names, or those that are written into `out`.

    Raises
    ------
    InputError : a folder without decks
    """
    if folder is None:
        out.mkdir(parents=True, exist_ok=True)
        return [_written(name, out) for name in OWN_NAMES]
    found = sorted(file for ending in ("*.txt", "*.dat") for file in Path(folder).glob(ending))
    if not found:
        raise InputError(f"The folder of MoorDyn files must hold files *.txt or *.dat, but {folder} has none.")
    return found


def read(file: str | Path):
    """A deck with MoorDyn's laws, or, of bodies that move by themselves, with this library's; and which laws those are."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        deck = read_moordyn(file, like_moordyn=True)
        try:
            build(deck.scene)
        except SceneError as error:
            if "MoordynBottom" not in str(error):
                raise
            return read_moordyn(file), "own"
        return deck, "MoorDyn's"


def _written(name, folder):
    file = folder / f"{name}.txt"
    file.write_text(moordyn_text(own_scene(name)), encoding="utf-8")
    return file


def own_scene(name: str) -> Scene:
    """A mooring line that lies on the bottom, a taut one, or two lines that meet at a free point below a fairlead."""
    from anet_lumped.effects import Gravity, MoordynBottom, Water  # a list of the studies does without their kernels

    effects = [Gravity(9.80665), Water(points_float=False), MoordynBottom(-DEPTH, 3e6, 3e5)]
    fairlead = Driven("fairlead", paths.external((0.0, 0.0, -10.0)))
    if name == "catenary":
        cables = [Cable("anchor", "fairlead", name="line1", length=245.0, segments=SEGMENTS, **CHAIN, **COEFFICIENTS)]
        return Scene([Fixed("anchor", (230.0, 0.0, -DEPTH)), fairlead], cables, effects)
    if name == "taut":
        cables = [Cable("anchor", "fairlead", name="line1", length=196.0, segments=SEGMENTS, **ROPE, **COEFFICIENTS)]
        return Scene([Fixed("anchor", (185.0, 0.0, -DEPTH)), fairlead], cables, effects)
    points = [Fixed("a", (180.0, 60.0, -DEPTH)), Fixed("b", (180.0, -60.0, -DEPTH)), Free("joint", at=(90.0, 0.0, -40.0)), fairlead]
    legs = [
        Cable(end, "joint", name=f"line{k}", length=118.0, segments=SEGMENTS // 2, **CHAIN, **COEFFICIENTS)
        for k, end in enumerate("ab", start=1)
    ]
    tail = Cable("joint", "fairlead", name="line3", length=96.0, segments=SEGMENTS // 2, **ROPE, **COEFFICIENTS)
    return Scene(points, [*legs, tail], effects)
