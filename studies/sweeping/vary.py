"""What a sweep varies: names of a scene's fields and of a run's settings, the values each takes, and their product."""

import itertools
import math
import re
import types
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache

from anet_lumped.checks import shown
from anet_lumped.limits import ROWS, check_most
from anet_lumped.scene.scene import Scene
from anet_lumped.scene.varied import SETTINGS, Varied, VaryError
from studies.quantities import SIZES, amount
from studies.sweeping.units import unit_of

QUANTITY = re.compile(r"[+-]?[\d.]+(e[+-]?\d+)?\s*[^\W\d_]\S*", re.IGNORECASE)  # a number and a unit
CALL = re.compile(r"([a-z_]+)\((.*)\)")  # a distribution, "lognormal(1e4,0.2)"


def parse_vary(texts: Iterable[str]) -> dict[str, str]:
    """Name -> specification, from ["EA=1e2:1e6:9log", "EA~lognormal(1e4,0.2)", ...]."""
    vary = {}
    for text in texts:
        name, _, spec = map(str.strip, re.sub("[=~]", "=", text, count=1).partition("="))
        if not (name and spec):
            raise VaryError(
                "What is set or varied must be NAME=VALUE, as in EA=1e4, or NAME=SPEC, as in EA=1e2:1e6:9log, but "
                f'"{text}" was given.'
            )
        if name in vary:
            raise VaryError(f"A name must be varied once, but `{name}` is given {vary[name]} and {spec}.")
        vary[name] = spec
    return vary


def parse_values(spec: str, whole: bool = False, sizes: Mapping[str, float] = types.MappingProxyType({})) -> list:
    """Values of a specification: "a:b:n" (evenly spaced), "a:b:nlog" (evenly in the logarithm) or "a,b,c".

    `whole` rounds those of a range, which a list never needs; values that coincide then are given once. `sizes` are those of the
    units that a number may end with.
    """
    if ":" not in spec:
        return list(dict.fromkeys(_number(word.strip(), sizes) for word in spec.split(",")))
    try:
        first, last, count = spec.split(":")
        log = count.endswith("log")
        a, b, n = amount(first, sizes), amount(last, sizes), int(count.removesuffix("log"))
        if n < 1 or not math.isfinite((b / a if a > 0 and b > 0 else math.nan) if log else b - a):
            raise ValueError
    except ValueError:
        raise VaryError(
            "A range must be a:b:n or a:b:nlog, with n at least 1, finite ends and, for log, positive ones, as in 1e2:1e6:9log, "
            f'but "{spec}" was given.'
        ) from None
    check_most(ROWS, n, f"The range {spec:.40}")
    share = [i / max(n - 1, 1) for i in range(n)]
    values = [a * (b / a) ** s if log else a + (b - a) * s for s in share]
    # 12 digits: 100.0 rather than 100.00000000000001, so that a row is found again by its inputs
    values = [round(value) if whole else float(f"{value:.12g}") for value in values]
    return list(dict.fromkeys(values))


def read_values(scene: Scene, vary: dict[str, str | Iterable]) -> dict[str, list]:
    """The values that each name takes.

    Parameters
    ----------
    scene : Scene
    vary : name -> specification ("1e2:1e6:9log") or values; a name is a setting of the run (`dt`), a field of every
        part that has it (`EA`: all cables), of one part by name (`s0-p0.EA`, `p0.mass`, `gravity.g`), a coordinate
        (`p0.at.z`), or an entry of a list, counted from 0 (`air.wind.1.seed`, `s0.path.xyz.2.0`, `events.0.mass`)

    Raises
    ------
    VaryError : an unknown name (with the nearest known one), a specification that cannot be read, or a distribution, of which only
        a sample or a search takes values
    """
    whole = whole_inputs(scene, vary)
    for name, spec in vary.items():
        if isinstance(spec, str) and CALL.fullmatch(spec.strip()):
            raise VaryError(
                f"Values of a grid must be a range or a list, but `{name}` is given the distribution {spec}; with a sample, as "
                "sobol:256, values are drawn from it."
            )
    return {
        name: parse_values(spec, whole[name], sizes_of(scene, name)) if isinstance(spec, str) else listed_values(name, spec)
        for name, spec in vary.items()
    }


def sizes_of(scene: Scene, name: str) -> Mapping[str, float]:
    """Sizes of the units in which a field or a setting may be given; none where its own unit is not known."""
    return SIZES.get(unit_of(scene, name), {})


def whole_inputs(scene: Scene, vary: Mapping) -> dict[str, bool]:
    """Of each name that varies, whether its values are whole numbers.

    Raises
    ------
    VaryError : an unknown name (with the nearest known one)
    """
    if not isinstance(vary, Mapping):
        raise VaryError(f"What is varied must be a dict from names to values, but it is {shown(vary)}.")
    fields = Varied(scene, vary).found
    return {name: name in fields and all(type(field.value) is int for field in fields[name]) for name in vary}


def grid(values: dict[str, list]) -> Iterator[dict]:
    """Every combination of the values, a dict of inputs each, one after the other; the last name varies fastest.

    Raises
    ------
    InputError : they are more than `limits.ROWS`
    """
    check_most(ROWS, math.prod(map(len, values.values())), f"The grid of {', '.join(values)}")
    return (dict(zip(values, point, strict=True)) for point in itertools.product(*values.values()))


def apply(scene: Scene, inputs: dict) -> tuple[Scene, dict]:
    """The scene with these inputs, and the settings of the run among them.

    Raises
    ------
    VaryError : an unknown name
    SceneError : a value that the scene refuses
    """
    settings = {name: value for name, value in inputs.items() if name in SETTINGS}
    return of_names(scene, tuple(name for name in inputs if name not in SETTINGS)).with_values(inputs), settings


@lru_cache(maxsize=4)
def of_names(scene: Scene, names: tuple[str, ...]) -> Varied:
    """`Varied` of a scene, kept from row to row."""
    return Varied(scene, names)


def listed_values(name: str, values: Iterable) -> list:
    """The values, however they come, as a list that is not too long."""
    if not isinstance(values, Iterable):
        raise VaryError(f"The values of `{name}` must be a specification or a list, but they are {shown(values)}.")
    listed = []
    for value in values:
        listed.append(value)
        check_most(ROWS, len(listed), f"The values of `{name}`")
    return listed


def _number(word, sizes):
    for kind in (int, float):
        try:
            value = kind(word)
            beyond = math.isnan(value) or (math.isinf(value) and "inf" not in word.lower())
        except ValueError:
            continue
        except OverflowError:
            beyond = True
        if beyond:
            raise VaryError(f"A number must be one that a float can hold, but it is {word}.")
        return value
    with_unit = amount(word, sizes)
    if math.isfinite(with_unit):
        return float(f"{with_unit:.12g}")  # 12 digits: 0.003 rather than 0.0030000000000000001
    if sizes and QUANTITY.fullmatch(word):
        raise VaryError(f"A number may be given in {', '.join(sizes)} here, but it is {shown(word)}.")
    return word
