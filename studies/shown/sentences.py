"""Pieces of sentences that follow from numbers: a range that is one number, a list of one, none of five."""

import math
from collections.abc import Iterable

from studies.shown.show import as_text


def listed(words: Iterable[str], none: str = "none") -> str:
    """ "a, b and c", each word once, in the order of its first; `none` where there is no word."""
    words = list(dict.fromkeys(words))
    if not words:
        return none
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def counted(number: int, thing: str, things: str = "") -> str:
    """ "no run", "1 run", "5 runs"."""
    number = int(number)
    return f"{number or 'no'} {thing if number in (0, 1) else things or thing + 's'}"


def share(number: int, total: int) -> str:
    """ "none of 5", "3 of 5", "all 5"; "the only one" and "not the only one" of one."""
    number, total = int(number), int(total)
    if total == 1:
        return "the only one" if number else "not the only one"
    return f"none of {total}" if number == 0 else f"all {total}" if number == total else f"{number} of {total}"


def between(values, unit: str = "", digits: int = 3) -> str:
    """ "3 to 5 ms", or "3 ms" where the least and the largest of some numbers read alike; "not known" of none that is finite."""
    finite = [float(value) for value in values if math.isfinite(float(value))]
    if not finite:
        return "not known"
    low, high = power(min(finite), digits), power(max(finite), digits)
    return f"{low if low == high else f'{low} to {high}'}{f' {unit}' if unit else ''}"


def power(value: float, digits: int = 3) -> str:
    """A number whose size counts: with a power of ten from 1e4 on and below a thousandth, as in 2.5e-4, 98.1, 9000, 1e4."""
    if value == 0 or 1e-3 <= abs(value) < 9999.5 or not math.isfinite(value):
        return as_text(float(value), digits)
    mantissa, exponent = f"{float(value):.{digits - 1}e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa}e{int(exponent)}"


def percent(part: float, digits: int = 2) -> str:
    """A share in per cent: "98 %"."""
    return f"{as_text(100.0 * part, digits)} %"


def stiffness(EA: float) -> str:
    """An axial stiffness: "EA = 1e4 N", "EA = ∞"."""
    return f"EA = {power(EA)}" + (" N" if math.isfinite(EA) else "")
