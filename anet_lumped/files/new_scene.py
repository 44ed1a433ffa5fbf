"""A scene file to begin from: a copy of a commented scene that comes with this package."""

import pathlib
from os import PathLike

from anet_lumped.checks import InputError, nearest, shown
from anet_lumped.regular_files import check_target

from .scene_file import SCENES


def new_scene(path: str | PathLike[str], like: str) -> pathlib.Path:
    """Write a copy of a scene that comes with this package, never over a file that is there.

    Parameters
    ----------
    path : str or pathlib.Path, of the file to write, which ends in .toml
    like : str, name of the scene

    Returns
    -------
    path : pathlib.Path

    Raises
    ------
    InputError : another ending, a file that is there, no such scene
    """
    check_target(path, "A scene")
    known = {file.stem: file for file in SCENES.glob("*.toml")}
    if like not in known:
        hint = nearest(str(like), known) or f"; they are {', '.join(sorted(known))}."
        raise InputError(f"A new scene must be like one that comes with this, but none is called {shown(like)}{hint}")
    path = pathlib.Path(path)
    if path.suffix.lower() != ".toml":
        raise InputError(f"A new scene must be a file that ends in .toml, but it is {shown(str(path))}.")
    text = known[like].read_text(encoding="utf-8")
    try:
        with open(path, "x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(f"A new scene must be a new file, but {shown(str(path))} is there already.") from None
    return path
