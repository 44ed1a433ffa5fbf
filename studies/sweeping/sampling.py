"""Samples of inputs that have a distribution each: Sobol' points, Latin hypercubes, and what sensitivities are taken from.

Sources: I. M. Sobol', USSR Comput. Math. Math. Phys. 7 (1967) 86, scrambled by A. B. Owen, J. Complexity 14 (1998) 466; M. D.
McKay, R. J. Beckman and W. J. Conover, Technometrics 21 (1979) 239; A. Saltelli et al., Comput. Phys. Commun. 181 (2010) 259,
section 5.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from anet_lumped.checks import nearest, shown
from anet_lumped.limits import ROWS, check_most
from anet_lumped.scene.scene import Scene
from studies.quantities import amount
from studies.sweeping.vary import CALL, VaryError, listed_values, parse_values, sizes_of, whole_inputs

POINT, MATRIX = "sample", "matrix"  # columns of a row beside its inputs: the number of its point; of which of Saltelli's matrices
KINDS = {
    "sobol": "n points that fill the box evenly, n a power of two",
    "lhs": "n points of a Latin hypercube",
    "saltelli": "n (d + 2) rows for sensitivities to d inputs, n a power of two",
}
RANGE = re.compile(r"([^:]+):([^:]+?)(:?log)?")


class Input(NamedTuple):
    """An input that is sampled: its values from shares of its probability, (n,) in [0, 1] -> list, and its least and largest."""

    values: Callable
    low: float
    high: float


class Distribution(NamedTuple):
    """A distribution by name: what makes it of its parameters, their names, and what must hold of them."""

    of: Callable
    parameters: tuple[str, ...]
    holds: Callable
    must: str


def _distributions():
    from scipy import stats

    return {
        "uniform": Distribution(lambda a, b: stats.uniform(a, b - a), ("a", "b"), lambda a, b: a < b, "a < b"),
        "loguniform": Distribution(stats.loguniform, ("a", "b"), lambda a, b: 0 < a < b, "0 < a < b"),
        "normal": Distribution(stats.norm, ("mean", "deviation"), lambda m, s: s > 0, "deviation > 0"),
        "lognormal": Distribution(
            lambda m, s: stats.lognorm(s, scale=m), ("median", "deviation of the logarithm"), lambda m, s: m > 0 < s, "both > 0"
        ),
        "triangular": Distribution(
            lambda a, m, b: stats.triang((m - a) / (b - a), a, b - a), ("a", "mode", "b"), lambda a, m, b: a < b and a <= m <= b,
            "a <= mode <= b",
        ),
        "weibull": Distribution(lambda c, k: stats.weibull_min(k, scale=c), ("scale", "shape"), lambda c, k: c > 0 < k, "both > 0"),
    }  # fmt: skip


def read_sample(text: str) -> tuple[str, int]:
    """Kind and number of points of "sobol:1024".

    Raises
    ------
    VaryError
    """
    kind, _, count = text.partition(":")
    if kind not in KINDS or not count.isdecimal() or int(count) < 2:
        known = "; ".join(f"{name}:n, {about}" for name, about in KINDS.items())
        raise VaryError(f"A sample must be one of {known}; but {shown(text)} was given.")
    number = int(count)
    if kind != "lhs" and number & (number - 1):
        power = 2 ** round(math.log2(number))
        raise VaryError(f"The points of a sample {kind} must be a power of two, as {power}, but they are {number}.")
    return kind, number


def read_inputs(scene: Scene, vary: Mapping) -> dict[str, Input]:
    """What each name is sampled from.

    Parameters
    ----------
    scene : Scene
    vary : name -> "a:b" (uniform), "a:b:log" (uniform in the logarithm), a distribution "lognormal(1e4,0.2)" or one of
        `scipy.stats` with its parameters, or "a,b,c" or a list, each value of which is as likely

    Raises
    ------
    VaryError : an unknown name, or what is none of these
    """
    return {name: _input(name, vary[name], whole, sizes_of(scene, name)) for name, whole in whole_inputs(scene, vary).items()}


def _input(name, spec, whole, sizes):
    call, ends = (pattern.fullmatch(spec) if isinstance(spec, str) else None for pattern in (CALL, RANGE))
    if call:
        return _from(_distribution(name, sizes, *call.groups()), whole)
    if ends:
        low, high, log = ends.groups()
        return _from(_distribution(name, sizes, "loguniform" if log else "uniform", f"{low},{high}"), whole)
    if hasattr(spec, "ppf"):
        return _from(spec, whole)
    listed = parse_values(spec, sizes=sizes) if isinstance(spec, str) else listed_values(name, spec)
    return Input(lambda shares: [listed[min(int(share * len(listed)), len(listed) - 1)] for share in shares], math.nan, math.nan)


def _distribution(name, sizes, called, words):
    known = _distributions()
    if called not in known:
        near = nearest(called, known) or f"; known are {', '.join(known)}."
        raise VaryError(f"There is no distribution called {called} for `{name}`{near}")
    found = known[called]
    numbers = [amount(word, sizes) for word in words.split(",")]
    if len(numbers) != len(found.parameters) or not all(map(math.isfinite, numbers)) or not found.holds(*numbers):
        wanted = ", ".join(found.parameters)
        raise VaryError(f"The distribution {called}({wanted}) of `{name}` must have {found.must}, but ({words}) was given.")
    return found.of(*numbers)


def _from(distribution, whole):
    """Input of a distribution; whole numbers are as likely as the reals that are rounded to them."""

    def values(shares):
        found = distribution.ppf(shares)
        return [round(value) if whole else float(f"{value:.12g}") for value in found.tolist()]

    low, high = (float(end) for end in distribution.support())
    return Input(values, low, high)


def sampled(text: str, inputs: Mapping[str, Input], seed: int) -> Iterator[dict]:
    """Rows of a sample, one after the other: inputs, number of the point as `POINT`, and of Saltelli's the matrix as `MATRIX`.

    Parameters
    ----------
    text : "sobol:1024", "lhs:200" or "saltelli:256"
    inputs : of each name
    seed : of the scrambling

    Raises
    ------
    VaryError, InputError : an unknown kind, more rows than `limits.ROWS`, or a distribution that gives a number without bounds
    """
    from scipy.stats import qmc

    kind, number = read_sample(text)
    d = len(inputs)
    check_most(ROWS, number * (d + 2 if kind == "saltelli" else 1), f"The sample {text}")
    random = np.random.default_rng(seed)
    if kind == "lhs":
        return _rows(_columns(inputs, qmc.LatinHypercube(d, rng=random).random(number)))
    if kind == "sobol":
        return _rows(_columns(inputs, qmc.Sobol(d, rng=random).random(number)))
    both = qmc.Sobol(2 * d, bits=64, rng=random).random(number)
    first, second = both[:, :d], both[:, d:]
    of_a, of_b = _columns(inputs, first), _columns(inputs, second)
    mixed = {f"A with {name} of B": of_a | {name: of_b[name]} for name in inputs}
    matrices = {"A": of_a, "B": of_b} | mixed
    return (row | {MATRIX: matrix} for matrix, columns in matrices.items() for row in _rows(columns))


def _columns(inputs, shares):
    columns = {name: found.values(shares[:, i]) for i, (name, found) in enumerate(inputs.items())}
    for name, column in columns.items():
        if any(isinstance(value, float) and not math.isfinite(value) for value in column):
            raise VaryError(f"A sample must be of finite numbers, but that of `{name}` is not.")
    return columns


def _rows(columns):
    return ({POINT: j, **dict(zip(columns, values, strict=True))} for j, values in enumerate(zip(*columns.values(), strict=True)))


def inputs_of(row: Mapping) -> dict:
    """The inputs of a row, without the columns that only say which it is."""
    return {name: value for name, value in row.items() if name not in (POINT, MATRIX)}


def as_told(spec) -> object:
    """What a name is sampled from, as JSON may hold it: a distribution of `scipy.stats` by its name and parameters."""
    if not hasattr(spec, "ppf"):
        return spec if isinstance(spec, str) else list(spec)
    return {"distribution": spec.dist.name, "parameters": [*spec.args, spec.kwds]}
