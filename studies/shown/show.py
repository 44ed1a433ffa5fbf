"""A result as a person reads it (tables) or as a program does (JSON): a dict of values and of lists of dicts."""

import json
import math
import sys
from collections import Counter
from numbers import Integral, Real

from anet_lumped.checks import printable

UNITS = {
    "m": "x y z sag length rmse gap largest covered",
    "N": "tension force EA",
    "s": "dt step time reached",
    "rad/s": "frequency",
    "J": "energy kinetic elastic potential work dissipated",
    "-": "stretch imbalance residual",
    "": "evaluations",
}
UNIT = {word: unit for unit, words in UNITS.items() for word in words.split()}  # by the last such word of a name
OF_NAMES = dict.fromkeys(("by_dampers", "by_effects", "by_method", "in_play"), "J")
SUFFIXES = "m mm um cm kg g s ms us ns N J Hz percent degrees".split()  # that are the unit of a name that ends so
COMPOUND_UNITS = {"_Ns_per_m": "N·s/m", "_N_per_m": "N/m", "_rad_per_s": "rad/s", "_m_per_s": "m/s", "_per_s": "1/s"}
MOST_DIGITS = 7  # of a number in a column whose values hardly differ
LEAST_CHANGE = 1e-5  # of the largest number of a column: a smaller change is none
MOST_ROWS, MOST_WORDS = 60, 4  # of a table that is printed in full, and words of a column that are counted in its summary
WIDE = 10  # columns; a wider table of few rows is shown on its side


def as_json(result: dict) -> str:
    """The result as one JSON object; NaN and infinity, which JSON has not, are null."""
    return json.dumps(_strict(result), indent=1)


def show(result: dict, whole: bool = False) -> None:
    """Print a result on stdout: lists of dicts as tables, other values as lines.

    Of a table of more than MOST_ROWS rows a summary is printed, unless all of it is asked for.
    """
    from rich.console import Console

    # A file or pipe has no width of its own; 80 columns would break every table.
    console = Console(width=None if sys.stdout.isatty() else 160, highlight=False, markup=False, emoji=False)
    for title, value in result.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            short = len(value) > MOST_ROWS and not whole
            named, rows = (f"{title}, {len(value)} rows; --all prints them", summed_up(value)) if short else (title, value)
            for table in _tables(named, rows, console.width):
                console.print(table)
        elif isinstance(value, list):
            lines = value if whole or len(value) <= MOST_ROWS else value[:MOST_WORDS]
            for line in lines:
                print(f"{_words(title)}: {printable(str(line))}")
            if len(lines) < len(value):
                print(f"{_words(title)}: {len(value) - len(lines)} more like these; --all prints them")
        else:
            print(f"{_head(title)}: {as_text(value)}")


def column_head(name) -> str:
    """Words of a column's name, its unit in brackets: "sag error [mm]" for sag_error_mm."""
    name = str(name)
    for ending, unit in COMPOUND_UNITS.items():
        if name.endswith(ending):
            return f"{_words(name.removesuffix(ending))} [{unit}]"
    *words, last = name.split("_")
    return f"{' '.join(words)} [{last.replace('percent', '%')}]" if words and last in SUFFIXES else _words(name)


def as_text(value, digits: int = 4) -> str:
    """Text of a value: a number with so many digits, and with a power of ten (1e-5) where they would be lost among zeros."""
    if isinstance(value, list | tuple):
        return " ".join(as_text(one, digits) for one in value)
    if isinstance(value, bool) or not isinstance(value, Real):
        return "" if value is None else printable(str(value))
    if isinstance(value, Integral) or value == 0:
        return f"{value:.0f}"
    if not math.isfinite(value):
        return "–" if math.isnan(value) else f"{value}".replace("inf", "∞")
    rounded = float(f"{value:.{digits - 1}e}")
    mantissa, power = f"{rounded:.{digits - 1}e}".split("e")
    mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    round_and_large = abs(rounded) >= 1e4 and len(mantissa.lstrip("-")) <= len("2.5")
    if round_and_large or not 1e-3 <= abs(rounded) < 1e6:
        return f"{mantissa}e{int(power)}"
    text = f"{value:.{max(0, digits - 1 - math.floor(math.log10(abs(rounded))))}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def column_texts(values, digits: int = 4) -> list[str]:
    """Texts of the values of a column, its numbers in one format, with enough digits to tell them apart."""
    numbers = [abs(value) for value in values if _is_fraction(value)]
    if len(numbers) < 2 or not all(value is None or (isinstance(value, Real) and not isinstance(value, bool)) for value in values):
        return [as_text(value, digits) for value in values]
    low, high = min(numbers), max(numbers)
    signed = [value for value in values if _is_fraction(value)]
    spread = (max(signed) - min(signed)) / high
    if LEAST_CHANGE < spread < 10.0 ** (1 - digits):  # so that two digits of it show
        digits = min(2 - math.floor(math.log10(spread)), MOST_DIGITS)
    scientific = high >= 1e6 or high < 1e-3 or low < 1e-4 or high >= 1e5 * low
    decimals = digits - 1
    if not scientific:
        decimals = max(0, digits - 1 - math.floor(math.log10(high)), 2 - math.floor(math.log10(low)))
    texts = [f"{value:.{decimals}{'e' if scientific else 'f'}}" if _is_fraction(value) else as_text(value) for value in values]
    return _shortened([text.replace("e+0", "e").replace("e-0", "e-").replace("e+", "e") for text in texts])


def _is_fraction(value):
    """Whether a value is a number that may need a format: neither a count, nor zero, nor without end."""
    return isinstance(value, Real) and not isinstance(value, Integral) and value != 0 and math.isfinite(value)


def _shortened(texts):
    """Numbers without the zeros that all of them end with behind the point."""
    parts = [text.partition("e") if "." in text else None for text in texts]
    ends = [part[0] for part in parts if part]
    spare = min((len(end) - len(end.rstrip("0").rstrip(".")) for end in ends), default=0)
    if any(end[len(end) - spare :].startswith("0") and end[: len(end) - spare].endswith(".") for end in ends):
        spare -= 1
    return [
        text if part is None else part[0][: len(part[0]) - spare] + part[1] + part[2]
        for text, part in zip(texts, parts, strict=True)
    ]


def summed_up(rows: list[dict]) -> list[dict]:
    """A row for each column of a long table: the minimum, mean and maximum of its numbers, or how often which word."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    label = next((name for name in names if _tells_apart([row.get(name) for row in rows])), None)
    found = []
    for name in names:
        values = [row.get(name) for row in rows]
        numbers = [(value, k) for k, value in enumerate(values) if _is_number(value)]
        if numbers and all(value is None or _is_number(value) or value != value for value in values):
            (low, first), (high, last) = min(numbers), max(numbers)
            where = [f"{rows[k][label]}" if label else f"row {k + 1}" for k in (first, last)]
            mean = sum(value for value, _ in numbers) / len(numbers)
            found.append({"": _head(name), "minimum": low, "at": where[0], "mean": mean, "maximum": high, "at ": where[1]})
        elif name != label:
            counts = Counter(as_text(value) for value in values).most_common(MOST_WORDS)
            found.append({"": _head(name), "at": ", ".join(f"{word or 'none'} ({count})" for word, count in counts)})
    return found


def _tells_apart(values):
    """Whether values are words, each another one."""
    return all(isinstance(value, str) for value in values) and len(set(values)) == len(values)


def _is_number(value):
    if not isinstance(value, float | int):  # which are found at once; tables of nets have a hundred thousand values
        return isinstance(value, Real) and math.isfinite(value)
    return not isinstance(value, bool) and math.isfinite(value)


def _tables(title, rows, width):
    """Tables of rich: one, or where a terminal is not wide enough, some below each other that have the first column each."""
    from rich import box
    from rich.table import Table

    from .layout import fitted, least_and_natural, side_by_side

    names = list(dict.fromkeys(name for row in rows for name in row))
    of_one_kind = "minimum" not in names  # and not a summary, whose rows are of several quantities
    columns = [[row.get(name) for row in rows] for name in names]
    lines = list(zip(*(column_texts(own) if of_one_kind else [as_text(one) for one in own] for own in columns), strict=True))
    heads = [_head(name) for name in names]
    right = [all(isinstance(row.get(name), Real | None) for row in rows) for name in names]
    turned = [*zip(heads, *lines, strict=True)]
    too_wide = len(side_by_side(least_and_natural(heads, lines)[0], width)) > 1
    if len(names) > WIDE > len(rows) or (too_wide and len(side_by_side(least_and_natural(turned[0], turned[1:])[0], width)) == 1):
        heads, *lines = turned
        right = [i > 0 for i in range(len(heads))]
    least, natural = least_and_natural(heads, lines)
    for k, group in enumerate(side_by_side(least, width)):
        table = Table(
            title=_words(title) + (", continued" if k else ""), title_justify="left", title_style="bold", box=box.SIMPLE_HEAD
        )
        widths = fitted([least[i] for i in group], [natural[i] for i in group], width)
        for i, own in zip(group, widths, strict=True):
            table.add_column(heads[i], justify="right" if right[i] else "left", overflow="fold", width=own)
        for line in lines:
            table.add_row(*(line[i] for i in group))
        yield table


def _words(name):
    return str(name).replace("_", " ")


def _head(name):
    if name.endswith("]"):  # it has its unit
        return _words(name)
    if name in OF_NAMES:
        return f"{_words(name)} [{OF_NAMES[name]}]"
    if name.split("_")[-1] in SUFFIXES and "_" in name:
        return column_head(name)
    unit = next((UNIT[word] for word in reversed(name.split("_")) if word in UNIT), "")
    return f"{_words(name)} [{unit}]" if unit else column_head(name)


def _strict(value):
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): _strict(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_strict(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
