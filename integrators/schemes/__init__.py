"""The schemes by name. A scheme is added by a file that holds its record, and by a line here."""

from functools import cache
from importlib import import_module
from typing import Any

from .record import Scheme

MODULES = {  # name of a scheme: module that holds its record, imported when the record is first asked for
    "explicit_euler": "integrators.schemes.explicit_euler",
    "symplectic_euler": "integrators.schemes.symplectic_euler",
    "verlet": "integrators.schemes.verlet",
    "rk4": "integrators.schemes.rk4",
    "dop853": "integrators.schemes.dop853",
    "links": "integrators.schemes.links",
    "links5": "integrators.schemes.links",
    "edmc": "integrators.schemes.edmc",
    "backward_euler": "integrators.schemes.backward_euler",
    "midpoint": "integrators.schemes.midpoint",
    "sdirk2": "integrators.schemes.sdirk2",
    "tr_bdf2": "integrators.schemes.tr_bdf2",
    "generalised_alpha": "integrators.schemes.generalised_alpha",
    "RK45": "integrators.schemes.scipy_schemes",
    "DOP853": "integrators.schemes.scipy_schemes",
    "Radau": "integrators.schemes.scipy_schemes",
    "BDF": "integrators.schemes.scipy_schemes",
    "LSODA": "integrators.schemes.scipy_schemes",
    "Tsit5": "integrators.schemes.diffrax_schemes",
    "Kvaerno3": "integrators.schemes.diffrax_schemes",
    "Kvaerno5": "integrators.schemes.diffrax_schemes",
}


@cache
def scheme(name: str) -> Scheme:
    """The record of the scheme ``name``."""
    module = import_module(MODULES[name])
    return next(one for one in vars(module).values() if isinstance(one, Scheme) and one.name == name)


def names(**wanted: Any) -> tuple[str, ...]:
    """Names of the schemes, in the order of the registry, whose records have all the values wanted.

    ``names(own=True, explicit=False)`` are the implicit schemes of this package. Schemes for systems with constraints, which march
    no others, are among them only if ``keeps_constraints=True`` is wanted.
    """
    return _names(tuple(MODULES), tuple(({"keeps_constraints": False} | wanted).items()))


@cache
def _names(known: tuple[str, ...], wanted: tuple[tuple[str, Any], ...]) -> tuple[str, ...]:
    return tuple(name for name in known if all(getattr(scheme(name), key) == value for key, value in wanted))
