"""A run as whatever the ending of a file says: a page, a film, a series for ParaView; or as a page in the browser at once."""

import os
import pathlib
from os import PathLike
from typing import Any

from anet_lumped.checks import InputError, shown
from anet_lumped.regular_files import check_target

from .film import RATE, write_film
from .page import write_page
from .vtk_writer import write_pvd

WRITERS = {".html": write_page, ".pvd": write_pvd} | dict.fromkeys(RATE, write_film)


def view(run: Any, path: str | PathLike[str] | None = None) -> pathlib.Path:
    """Write a run as a page (.html), a film (.gif, .mp4) or a VTK series (.pvd).

    Parameters
    ----------
    run : Run
    path : str, pathlib.Path or None
        The file to write; None writes a page where files do not last, and opens it in the browser.

    Returns
    -------
    path : pathlib.Path, of the file

    Raises
    ------
    InputError : another ending, no file can be there, or the run is too large for a page
    """
    if path is None:
        import tempfile
        import webbrowser

        file = write_page(run, pathlib.Path(tempfile.mkdtemp(prefix="anet-lumped-")) / "run.html")
        webbrowser.open(file.as_uri())
        return file
    check_target(path, "A view")
    ending = pathlib.Path(os.fsdecode(path)).suffix.lower()
    if ending not in WRITERS:
        raise InputError(f"A view of a run must end in {', '.join(WRITERS)}, but it is {shown(os.fsdecode(path))}.")
    return WRITERS[ending](run, path)
