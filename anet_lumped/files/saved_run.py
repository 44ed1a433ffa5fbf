"""Saved run → what it is looked at with."""

import os
import pathlib
from os import PathLike

from anet_lumped.results.loading import load_run

ENDING = ".nc"
IN_FOLDER = "run.nc"


def view_saved(source: str | PathLike[str], out: str | PathLike[str] | None = None) -> pathlib.Path:
    """Write a saved run as a page, a film or a VTK series, as `Run.view`.

    Parameters
    ----------
    source : str or pathlib.Path
        What `Run.save` wrote, or a folder with a `run.nc`.
    out : str, pathlib.Path or None
        The file to write, by its ending; a page beside the run if None.

    Returns
    -------
    path : pathlib.Path, of the file

    Raises
    ------
    InputError : no saved run, or as `Run.view`
    """
    file = pathlib.Path(source, IN_FOLDER) if os.path.isdir(source) else pathlib.Path(source)
    return load_run(file).view(file.with_suffix(".html") if out is None else out)
