"""The schemes by name: where each one's step lives, its order, and what it needs to be marched."""

from dataclasses import dataclass
from functools import cache
from importlib import import_module

import numpy as np

from . import dirk
from .system import SCHEME, STEP, compiled, first_class

NEWTON_TOLERANCE = 1e-6  # of the largest force on a node
NEWTON_ITERATIONS = 60
RHO_INF = {"edmc": 0.0, "generalised_alpha": 0.8}

_MODULES = {
    "explicit_euler": "explicit_euler",
    "symplectic_euler": "symplectic_euler",
    "verlet": "verlet",
    "rk4": "rk4",
    "dop853": "dop853",
    "edmc": "edmc",
    "backward_euler": "backward_euler",
    "midpoint": "dirk",
    "sdirk2": "dirk",
    "tr_bdf2": "dirk",
    "generalised_alpha": "generalised_alpha",
}
EXPLICIT = ("explicit_euler", "symplectic_euler", "verlet", "rk4", "dop853")
EMBEDDED = ("dop853",)  # those with an error estimate of their own
IMPLICIT = tuple(name for name in _MODULES if name not in EXPLICIT)


@dataclass(frozen=True)
class Scheme:
    """A scheme ready to be marched.

    Parameters
    ----------
    name : str
    step : compiled function, see `system.STEP`
    order : int
    memory : rows of (n, 3) that a step needs
    kept : rows of them that it carries from step to step; -1 for an explicit scheme, which never has to go back
    stiff : h |lambda| of its last stages above which stability holds a step, of a scheme in `EMBEDDED`
    """

    name: str
    step: object
    order: int
    memory: int
    kept: int
    stiff: float = np.inf

    def options(self, rho_inf=None, tolerance=NEWTON_TOLERANCE):
        """Numbers for its steps: Newton's tolerance and iterations, then rho_inf or the tableau."""
        if self.name in RHO_INF:
            own = [RHO_INF[self.name] if rho_inf is None else rho_inf]
        elif self.name in dirk.TABLEAUS:
            own = dirk.options(self.name)
        elif self.name in EMBEDDED:
            own = _module(self.name).options()
        else:
            own = []
        options = np.concatenate([[tolerance, NEWTON_ITERATIONS], own])
        assert len(options) >= SCHEME
        return options


@cache
def scheme(name):
    """The scheme ``name``, compiled (or loaded from the cache) when it is first asked for."""
    module = _module(name)
    step, kept = first_class(compiled(module.step, STEP)), getattr(module, "KEPT", -1)
    return Scheme(name, step, module.ORDER, module.MEMORY, kept, getattr(module, "STIFF", np.inf))


def order(name):
    """Order of the scheme ``name``, without compiling it."""
    return _module(name).ORDER


def _module(name):
    return import_module(f".{_MODULES[name]}", __package__)
