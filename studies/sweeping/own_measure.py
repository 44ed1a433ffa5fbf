"""Measures of a user: a function of a module, asked for as `module:function`."""

import hashlib
import importlib
import os
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from anet_lumped.checks import InputError, nearest, shown


class OwnMeasureError(InputError):
    """A function of one's own that is not there, or cannot be called."""


@dataclass(frozen=True)
class OwnMeasure:
    """A function of a module by its name, found again in every worker; it is given a run, or a state at rest where nothing runs.

    Parameters
    ----------
    module, function : names
    folder : where the module is looked for first
    """

    module: str
    function: str
    folder: str

    def __call__(self, result: Any) -> Any:
        """What the function gives.

        Raises
        ------
        OwnMeasureError : neither a number nor a word
        """
        given = self.load()(result)
        if isinstance(given, str):
            return given
        number = np.asarray(given, None if np.isscalar(given) or hasattr(given, "dtype") else object)
        if number.ndim or number.dtype.kind not in "biuf":  # as a list, None, or a complex number
            what = f"an array of {number.shape}" if number.ndim else shown(given)
            raise OwnMeasureError(f"Measure `{self.module}:{self.function}` must give a number or a word, but it gave {what}.")
        return number.item()

    def load(self):
        """The function.

        Raises
        ------
        OwnMeasureError
        """
        text = f"{self.module}:{self.function}"
        if self.folder not in sys.path:
            sys.path.insert(0, self.folder)
        try:
            module = importlib.import_module(self.module)
        except Exception as error:  # a file of a user raises anything
            raise OwnMeasureError(f"The module of measure `{text}` must import, but: {type(error).__name__}: {error}") from None
        function = getattr(module, self.function, None)
        if not callable(function):
            names = [name for name, value in vars(module).items() if callable(value) and not name.startswith("_")]
            near = nearest(self.function, names) or "."
            raise OwnMeasureError(
                f"Measure `{text}` must be a function, but {self.module} has none called {shown(self.function)}{near}"
            )
        return function

    def stamp(self) -> str:
        """Hash of the text of the module, so that rows of another one are not taken for its."""
        return hashlib.sha256(Path(sys.modules[self.module].__file__).read_bytes()).hexdigest()[:12]


def own_measure(text: str) -> OwnMeasure | None:
    """The measure that "module:function" means, None if there is no such module.

    Raises
    ------
    OwnMeasureError : the module does not import, or has no such function
    """
    module, colon, function = text.partition(":")
    if not (colon and function.isidentifier() and all(map(str.isidentifier, module.split(".")))):
        return None
    folder = os.getcwd()
    if folder not in sys.path:
        sys.path.insert(0, folder)
    try:
        known = find_spec(module) is not None
    except (ImportError, ValueError):
        known = False
    if not known:
        return None
    found = OwnMeasure(module, function, folder)
    found.load()
    return found
