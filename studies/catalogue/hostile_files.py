"""Scene files, MoorDyn files and saved runs that are changed at random, as a typing error, a torn disk or malice would.

What is changed and how is drawn with a `Pick`, so that tests draw the same changes from another source of chance.
"""

import copy
import datetime
import math
import tomllib

import tomli_w

from anet_lumped import Cable, Driven, Fixed, Free, Scene, paths
from anet_lumped.effects import Gravity, Ground, Water
from anet_lumped.files.moordyn_writer import moordyn_text

SCENE = """
[[points]]
name = "a"
kind = "fixed"
at = [0, 0, 0]
[[points]]
name = "d"
kind = "driven"
path = {kind = "line", start = [2, 0, 0], velocity = [0.1, 0, 0], ramp = 1.0}
[[points]]
name = "e"
kind = "driven"
path = {kind = "samples", t = [0, 1, 2.0], xyz = [[0, 1, 0], [0, 1.1, 0], [0, 1, 0]]}
[[points]]
name = "p"
kind = "free"
mass = 0.1
at = [1, 0, -0.5]
[cable_defaults]
segments = 4
diameter = 0.01
[[cables]]
start = "a"
end = "p"
length = 1.5
mass_per_length = 0.1
EA = 1e4
zeta = 0.1
[[cables]]
start = "d"
end = "p"
length = 1.6
mass_per_length = 0.1
tension_strain = [[0.01, 10.0], [0.02, 30.0]]
compression = "damped"
[[cables]]
start = "e"
end = "p"
name = "third"
length = 3.0
rope = "nylon"
[[events]]
kind = "payload_change"
point = "p"
t = 1.5
mass = 0.0
[effects.gravity]
g = 9.81
[effects.air]
wind = [{kind = "uniform", velocity = [1, 0, 0]}, {kind = "sampled", samples = [[0, 1, 0], [9, 2, 0]]}]
[effects.water]
level = -1.0
wave = {kind = "airy", height = 0.1, period = 3.0, direction = [1, 0, 0]}
[effects.axial_damping]
rate = {a-p = 0.1, third = 0.2}
[effects.load]
per_length = [0, 1, 0]
cables = ["a-p"]
[effects.temperature]
expansion = 1e-5
change = {kind = "harmonic", center = 1.0, amplitude = 2.0, frequency = 0.1}
[effects.line_change]
paid_out = {third = {kind = "line", start = 0.0, rate = 0.01, ramp = 1.0}}
"""
ENTRIES = tomllib.loads(SCENE)


def nested(depth, wrap):
    """A value that is wrapped so many times."""
    inner = wrap(1)
    for _ in range(depth):
        inner = wrap(inner)
    return inner


VALUES = (
    True, 0, 1, -1, 2**63, 10**400, math.nan, math.inf, -math.inf, 0.0, 1e308, -1e308, 5e-324, 1e-200, 1e100, 1e-100, "", " ", "p",
    "line", "a\nb\x1b[31m\u202e\0", "y" * 5000, [], {}, [1], [1, 2, 3], [1e308] * 3, [5e-324, 0, 0], [[1e-300, 1e300]], ["a", "a"],
    {"kind": "line"}, {"kind": 3}, {"a": {"kind": "line"}}, [{"kind": "uniform"}], datetime.datetime(2020, 1, 1), datetime.time(1),
    nested(20, lambda inner: [inner]), nested(60, lambda inner: [inner]), nested(60, lambda inner: {"a": inner}),
)  # fmt: skip
"""What a key of a scene file is set to."""

KEYS = ("x", "", "kind", "name", "EA", "a\nb\x1b", "z" * 3000)
"""What a key is renamed to."""

TEXTS = (
    "", "[", "]", '"', "\n", "=", ".", "\0", "\ufeff", "[[cables]]\n", "[effects]\n", "\x1b", "---", '! name: "\\x"', "9" * 5000,
    "\n\n",
)  # fmt: skip
"""What is put in place of some characters of a text."""

WORDS = (
    "", "nan", "inf", "-1", "0", "2", "99", "1e308", "5e-324", "1e400", "1" * 5000, "x", "a|b", "none.dat", "../it.txt",
    "/dev/zero", ".", "Fixed", "Free", "Body1", "R1A", "P2", "²", "\x1b[31m", "\0", "y" * 3000, "---", "!", '! name: "a\\x"',
    '! name: "\\ud800"', "rho",
)  # fmt: skip
"""What is put in place of a word of a MoorDyn file."""

SIZES = (b"\x7f\xff\xff\xff", b"\xff\xff\xff\xff", bytes(4), b"\x80\0\0\0", b"\0\x0f\xff\xff")
"""Sizes that the header of a saved run is made to claim."""


def places(value, above=()):
    """Yield the keys to everything within tables and arrays."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in inner:
        yield (*above, key)
        yield from places(entry, (*above, key))


PLACES = tuple(places(ENTRIES))


def changed_scene_file(pick):
    """Text of the scene file with one to three entries changed, and perhaps its text."""
    entries = copy.deepcopy(ENTRIES)
    for _ in range(pick.integer(1, 3)):
        _change_entry(pick, entries)
    return _edited(pick, tomli_w.dumps(entries))


def mooring():
    """A chain and a rope in water and on the ground, that MoorDyn's format can hold."""
    shared = {"zeta": 0.5, "compression": "damped"}
    still = paths.line((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    return Scene(
        [Fixed("anchor", (-50.0, 0.0, -20.0)), Free("clump", mass=20.0, volume=0.01, CdA=0.1), Driven("ship", still)],
        [
            Cable("anchor", "clump", length=35.0, mass_per_length=15.0, EA=1e7, segments=8, diameter=0.05, **shared),
            Cable("clump", "ship", length=25.0, mass_per_length=2.0, EA=1e6, segments=6, diameter=0.03, **shared),
        ],
        [Gravity(9.81), Water(level=0.0), Ground(height=-20.0)],
    )


def changed_moordyn_file(pick):
    """Text of a MoorDyn file with one to three words changed, and perhaps its text."""
    lines = moordyn_text(mooring()).split("\n")
    for _ in range(pick.integer(1, 3)):
        row = pick.integer(0, len(lines) - 1)
        words, word, kind = lines[row].split() or [""], pick.one_of(WORDS), pick.one_of(("set", "add", "drop", "double"))
        column = pick.integer(0, len(words) - 1)
        if kind == "set":
            words[column] = word
        elif kind == "add":
            words.append(word)
        elif kind == "drop":
            del words[column:]
        lines[row : row + 1] = [" ".join(words)] * (2 if kind == "double" else 1)
    return _edited(pick, "\n".join(lines))


def changed_bytes(pick, content):
    """Content of a file with some bits or bytes changed, cut, put in, or copied from elsewhere."""
    kind = pick.one_of(("bit", "byte", "cut", "take", "put", "copy", "size"))
    content, at, number = bytearray(content), pick.integer(0, len(content) - 1), pick.integer(0, 255)
    size = number % 9 + 1
    if kind == "bit":
        content[at] ^= 1 << number % 8
    elif kind == "byte":
        content[at] = number
    elif kind == "cut":
        del content[at:]
    elif kind == "take":
        del content[at : at + size]
    elif kind == "put":
        content[at:at] = bytes([number] * size)
    elif kind == "copy":
        begin = pick.integer(0, len(content) - 1)
        content[at : at + size] = content[begin : begin + size]
    else:
        at -= at % 4
        content[at : at + 4] = SIZES[number % len(SIZES)]
    return bytes(content)


def _change_entry(pick, entries):
    kind, (*above, key) = pick.one_of(("set", "set", "delete", "rename", "double")), pick.one_of(PLACES)
    value, name, holder = pick.one_of(VALUES), pick.one_of(KEYS), entries
    try:
        for one in above:
            holder = holder[one]
        if kind == "set":
            holder[key] = copy.deepcopy(value)
        elif kind == "delete":
            del holder[key]
        elif kind == "rename":
            holder[name] = holder.pop(key)
        else:
            holder.insert(key, holder[key])
    except (KeyError, IndexError, TypeError, AttributeError):
        pass  # what an earlier change took away, or what no array or table can do


def _edited(pick, text):
    """The text, every second time with some characters replaced."""
    if pick.integer(0, 1):
        at, gone = pick.integer(0, len(text)), pick.integer(0, 30)
        text = text[:at] + pick.one_of(TEXTS) + text[at + gone :]
    return text
