"""The law of a user's own effect: what it must look like, and how it is compiled."""

import dis
import inspect
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

from numba import float64, types
from numba.core.errors import NumbaError

from anet_lumped.checks import SceneError, shown
from anet_lumped.compiled.dual import NAMES
from anet_lumped.compiled.jit import njit
from integrators.compile_once import compiling, once

_vector = types.UniTuple(float64, 3)


class Kind(NamedTuple):
    """A kind of law: its first arguments, those that are filled in, what it returns in words, and its kernels' maker."""

    first: tuple[str, ...]
    filled: tuple[str, ...]
    returns: str
    is_right: Callable  # of Numba's type of what a law returns
    make: Callable


class Law(NamedTuple):
    """A function in plain Python that is a law of a kind, and the names of its further arguments."""

    function: Callable
    kind: Kind
    further: tuple[str, ...]

    @property
    def parameters(self):
        """Names of the arguments that the effect has for its own."""
        return tuple(name for name in self.further if name not in self.kind.filled)

    @property
    def fills(self):
        """Names of the arguments that are filled in for each element."""
        return tuple(name for name in self.further if name in self.kind.filled)


def is_number(kind):
    """Whether Numba's type is one number."""
    return isinstance(kind, types.Integer | types.Float)


def is_vector(kind):
    """Whether Numba's type is a tuple of three numbers."""
    return isinstance(kind, types.BaseTuple) and len(kind) == 3 and all(map(is_number, kind))


def is_pair(kind):
    """Whether Numba's type is a tuple of two tuples of three numbers."""
    return isinstance(kind, types.BaseTuple) and len(kind) == 2 and all(map(is_vector, kind))


def read_law(function, kind, base):
    """Return a Law and the arguments of its function.

    Parameters
    ----------
    function : in plain Python or compiled by Numba
    kind : Kind
    base : type
        Of the effect; no argument may have the name of one of its members.

    Raises
    ------
    SceneError : no function, or one that has other arguments
    """
    function = getattr(function, "py_func", function)
    if not inspect.isfunction(function):
        raise SceneError(f"The law of an effect must be a function, but it is {shown(function)}.")
    name, arguments = function.__name__, inspect.signature(function, eval_str=True).parameters
    plain = all(argument.kind == argument.POSITIONAL_OR_KEYWORD for argument in arguments.values())
    if tuple(arguments)[: len(kind.first)] != kind.first or not plain:
        raise SceneError(
            f"The law of such an effect must have the arguments ({', '.join(kind.first)}, ...), each by a name of its own, but "
            f"`{name}` has ({', '.join(map(str, arguments.values()))})."
        )
    law = Law(function, kind, tuple(arguments)[len(kind.first) :])
    taken = next((key for key in law.further if key in ("self", "law", base.where) or hasattr(base, key)), None)
    if taken is not None:
        raise SceneError(f"An argument of a law must not be called `{taken}`, as every effect has that, but `{name}` has it.")
    return law, arguments


@lru_cache
def reads_time(law):
    """Whether a law reads its first argument, the time."""
    read = (one.argval for one in dis.get_instructions(law.function) if one.opname.startswith(("LOAD_FAST", "LOAD_DEREF")))
    return any("t" in (names if isinstance(names, tuple) else (names,)) for names in read)  # some load two at once


@once
def compiled(law, shapes):
    """The law, compiled for numbers.

    Parameters
    ----------
    law : Law
    shapes : tuple of int, how many numbers each parameter is, 0 for one that is no tuple

    Raises
    ------
    SceneError : Numba does not compile it; it returns something else than a law of its kind does
    """
    name, function, shapes_left = law.function.__name__, njit(error_model="numpy")(law.function), iter(shapes)
    kinds = [float64 if key == "t" else _vector for key in law.kind.first]
    for key in law.further:
        n = 0 if key in law.kind.filled else next(shapes_left)
        kinds.append(types.UniTuple(float64, n) if n else float64)
    try:
        with compiling():
            function.compile(tuple(kinds))
    except NumbaError as error:
        raise SceneError(f"The law of an effect must compile with Numba, but `{name}` does not: {_why(error, law)}") from error
    found = function.nopython_signatures[0].return_type
    if not law.kind.is_right(found):
        raise SceneError(f"The law of such an effect must return {law.kind.returns}, but `{name}` returns {found}.")
    return function


@once
def kernels(law, shapes):
    """The compiled functions of an effect, by their slot in `effects.signatures`; parameters as in `compiled`.

    Raises
    ------
    SceneError : as `compiled`; a function in it whose derivative is not known
    """
    function, in_parameters, in_elements, sources, shapes_left = compiled(law, shapes), 0, 0, [], iter(shapes)
    for key in law.further:
        if key in law.kind.filled:
            sources.append(f"params[begin + {in_elements}]")
            in_elements += 1
        else:
            n = next(shapes_left)
            sources.append(f"({''.join(f'params[{in_parameters + i}], ' for i in range(n))})" if n else f"params[{in_parameters}]")
            in_parameters += n or 1
    numbers = njit()(eval(f"lambda params, begin: ({''.join(f'{text}, ' for text in sources)})"))
    try:
        return law.kind.make(function, numbers, in_parameters, in_elements)
    except NumbaError as error:
        raise SceneError(
            f"The law of an effect must be made of arithmetic and of {', '.join(NAMES)}, but "
            f"`{law.function.__name__}` is not: {_why(error, law)}"
        ) from error


def _why(error, law):
    """What Numba says first, and the line of the law that it is about."""
    lines = [line.strip() for line in str(error).splitlines()]
    first_line = next(
        (line for line in lines if line and not line.startswith(("Failed in nopython", "During"))), type(error).__name__
    )
    if first_line.startswith("No implementation of function"):
        call = next((line.removeprefix(">>> ") for line in lines if line.startswith(">>> ")), "")
        first_line = f"there is no {call}"
    file = law.function.__code__.co_filename.replace("\\", "/").split("/")[-1]
    location = next((line for line in lines if line.startswith("File ") and file in line), "")
    where = location.rstrip(":").rpartition("line ")[2]
    return first_line.rstrip(".:") + (f", in line {where}." if where.isdigit() else ".")
