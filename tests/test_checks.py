"""Messages and numbers: one line of bounded length, whatever a user gave; a float, whatever kind of number it was."""

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from anet_lumped.checks import (
    LARGEST,
    LONGEST,
    NAMED,
    SHOWN,
    SMALLEST,
    InputError,
    SceneError,
    check_count,
    check_direction,
    check_name,
    check_number,
    check_vector,
    number,
    one_line,
    printable,
    quoted,
    shown,
)


def nested(depth):
    """Lists within each other."""
    inner = []
    for _ in range(depth):
        inner = [inner]
    return inner


class Odd:
    def __repr__(self):
        return "odd \x1b[31m\n" * 100


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("µ [m/s²] \\n", "µ [m/s²] \\n"),
        ("a\nb\r\x1b[31m\0", r"a\nb\r\x1b[31m\x00"),
        ("\u202ea\u2028\ud800\x85\U000e0001", r"\u202ea\u2028\ud800\x85\U000e0001"),
    ],
)
def test_control_characters_are_shown_as_such(text, seen):
    assert printable(text) == seen == printable(seen) and seen.isprintable()


@pytest.mark.parametrize("size", [0, LONGEST, LONGEST + 1, 10**7])
def test_a_long_message_keeps_its_start_and_its_end(size):
    text = f"What is wrong, {'x' * size}; and what to do."
    line = one_line(text)
    assert len(line) <= LONGEST and line.startswith("What is wrong, ") and line.endswith("; and what to do.")
    assert (" ... " in line) == (len(text) > LONGEST)
    assert one_line(line) == line


@pytest.mark.parametrize("kind", [InputError, SceneError])
def test_every_refusal_is_one_line(kind):
    said = str(kind(f"Name {'x' * 10**6}\n\x1b[31m is unknown."))
    assert said.isprintable() and len(said) <= LONGEST and said.endswith(r"\n\x1b[31m is unknown.")


LARGE = {
    "text": "x" * 10**6,
    "400 digits": 10**400,
    "5000 digits": -(10**5000),
    "deep": nested(10**5),
    "odd": Odd(),
    "odds": [Odd()] * 9,
    "controls": "\x1b\0",
    "fraction": Fraction(10**6000, 7),
}


@pytest.mark.parametrize("value", LARGE.values(), ids=LARGE)
def test_any_value_is_shown_in_short(value):
    assert shown(value).isprintable() and len(shown(value)) <= SHOWN + len("...")


def test_names_are_quoted_in_short_and_what_is_no_name_is_shown():
    assert quoted("s0-p0") == '"s0-p0"' and quoted("key", "`") == "`key`" and quoted("a\n\x1b") == r'"a\n\x1b"'
    assert len(quoted("y" * 5000)) <= NAMED + 2 and quoted(3) == "3" and quoted(None) == "None"


@pytest.mark.parametrize(
    ("value", "found"),
    [
        (3, 3.0), (Fraction(1, 4), 0.25), (np.float32(0.5), 0.5), (np.int64(7), 7.0), (np.array(1.5), 1.5), (math.inf, math.inf),
        (Fraction(1, 10**400), 0.0), (np.longdouble(2.0), 2.0),
    ],
)  # fmt: skip
def test_real_numbers_become_floats(value, found):
    assert number(value) == found and type(number(value)) is float


@pytest.mark.parametrize(
    "value",
    [
        10**400, Fraction(10**400), Decimal("1.5"), 1j, np.complex128(1j), np.array(1j), "1.5", b"1", None, True, np.bool_(True),
        np.array(True), np.array([1.5]), np.array("x"), [], {}, math.nan, np.timedelta64(3, "s"), object(),
    ],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_what_is_no_number_is_nan(value):
    assert math.isnan(number(value))
    with pytest.raises(SceneError, match=r"^Argument `g` must be a finite number \[m/s2\], but gravity has g=.*\.$"):
        check_number("g", value, "m/s2", "gravity")


@pytest.mark.parametrize("value", [1e308, -1e308, 1.01 * LARGEST])
def test_numbers_too_large_to_compute_with_are_refused(value):
    for check, given in ((check_number, value), (check_vector, (0.0, value, 0.0))):
        with pytest.raises(SceneError, match=r"must be a finite number, of a size from 1e-100 to 1e\+100 \[m\], but it has a="):
            check("a", given, "m", "it")


@pytest.mark.parametrize("value", [5e-324, 0.99 * SMALLEST])
def test_positive_numbers_too_small_to_divide_by_are_refused(value):
    assert check_number("a", value, "", "it", sign="non-negative") == value
    with pytest.raises(SceneError, match=r"must be positive and finite, of a size from 1e-100 to 1e\+100 \[m\], but it has a="):
        check_number("a", value, "m", "it", sign="positive")
    with pytest.raises(SceneError, match="Argument `a` must not be zero, but it has a="):
        check_direction("a", (value, 0.0, -value), "it")


@pytest.mark.parametrize("value", [10**400, 2**63, np.uint64(2**63)], ids=["400 digits", "int", "uint64"])
def test_counts_have_64_bits(value):
    assert check_count("segments", 2**63 - 1, "it") == 2**63 - 1 and check_count("segments", np.array(3), "it") == 3
    with pytest.raises(SceneError, match=r"`segments` must be an integer of at least 1 and below 2\^63, but it has segments="):
        check_count("segments", value, "it")


def test_names_are_text_that_a_file_can_hold():
    assert check_name("a\n\0", "point") == "a\n\0"
    with pytest.raises(SceneError, match=r'The name of a point must be text that UTF-8 can hold, but is "a\\ud800"\.'):
        check_name("a\ud800", "point")
