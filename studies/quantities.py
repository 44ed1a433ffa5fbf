"""Quantities of the command line: a number with or without a unit, in SI units: "10ms" is 0.01 [s]."""

import math

TIMES = {"ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0, "h": 3600.0, "s": 1.0}
LENGTHS = {"mm": 1e-3, "cm": 1e-2, "um": 1e-6, "µm": 1e-6, "km": 1e3, "m": 1.0}
SPEEDS = {"mm/s": 1e-3, "cm/s": 1e-2, "km/h": 1.0 / 3.6, "m/s": 1.0}
FORCES = {"MN": 1e6, "kN": 1e3, "mN": 1e-3, "N": 1.0}
DAMPERS = {"mNms": 1e-3, "Nms": 1.0}  # of a joint that turns
SIZES = {
    "s": TIMES,
    "m": LENGTHS,
    "m/s": SPEEDS,
    "N": FORCES,
    "kg": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "kg/m": {"kg/m": 1.0, "g/m": 1e-3},
    "rad": {"mrad": 1e-3, "rad": 1.0, "deg": math.radians(1.0)},
}
"""Sizes of the units in which a number may be given, by the unit of the scene's field."""


def seconds(text: str) -> float:
    """Seconds in a text such as 10ms, 0.01 s or 0.01."""
    return _amount(text, TIMES, "a time such as 10ms, 0.01s or 0.01")


def metres(text: str) -> float:
    """Metres in a text such as 1mm, 0.05 cm, 20um or 0.001."""
    return _amount(text, LENGTHS, "a length such as 1mm, 0.05cm or 0.001")


def metres_per_second(text: str) -> float:
    """Metres per second in a text such as 0.2m/s, 5 cm/s or 0.2."""
    return _amount(text, SPEEDS, "a speed such as 0.2m/s, 5cm/s or 0.2")


def newtons(text: str) -> float:
    """Newtons in a text such as 0.1N, 2 kN or 0.1."""
    return _amount(text, FORCES, "a force such as 0.1N, 2kN or 0.1")


def largest_error(text: str, of_tension: bool) -> float:
    """The largest error that is wanted: newtons of a tension, or metres of a position."""
    like = "a force such as 0.1N" if of_tension else "a length such as 1mm, or a force together with --tension CABLE"
    return _amount(text, FORCES if of_tension else LENGTHS, like, "'--error'")


def newton_metre_seconds(text: str) -> float:
    """Newton metre seconds in a text such as 0.1mNms or 1e-4."""
    return _amount(text, DAMPERS, "a damper such as 0.1mNms or 1e-4")


def vector_in_metres(text: str) -> tuple[float, float, float]:
    """Three lengths [m] in a text such as 0,10,0 or 0,50cm,0."""
    parts = text.split(",")
    if len(parts) != 3:
        raise _refused("three lengths such as 0,10,0 or 0,50cm,0", text)
    x, y, z = map(metres, parts)
    return x, y, z


def amount(text: str, units: dict[str, float]) -> float:
    """The number in a text, times the size of the first of the units that it ends with; NaN where it is no number."""
    number = text.strip()
    unit = next((unit for unit in units if number.endswith(unit)), "")
    try:
        return float(number.removesuffix(unit)) * units.get(unit, 1.0)
    except ValueError:
        return math.nan


def _amount(text, units, like, option=None):
    found = amount(text, units)
    if not math.isfinite(found):
        raise _refused(like, text, option)
    return found


def _refused(like, text, option=None):
    import typer

    from anet_lumped.checks import quoted

    return typer.BadParameter(f"must be {like}, but it is {quoted(text)}.", param_hint=option)
