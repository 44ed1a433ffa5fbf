"""Tables in a narrow terminal: no word is broken, and nothing is left out."""

import re

import pytest

from studies.shown.layout import fitted, least_and_natural, side_by_side
from studies.shown.show import show

ENERGY = dict.fromkeys(
    ["kinetic", "elastic", "potential", "work", "dissipated", "by_dampers", "by_effects", "by_method", "in_play", "imbalance"],
    1.2345e-5,
)
ROPE = {"rope": "wire-fibre-core", "what": "six-strand steel wire", "outer_diameter_mm": 19.68, "EA": 6.121e5, "source": "OrcaFlex"}


def printed(result, width, monkeypatch, capsys):
    """Lines of a result as a terminal of so many columns shows it."""
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", str(width))
    monkeypatch.setenv("TERM", "xterm")  # one that is dumb always has 80
    show(result)
    return re.sub("\x1b\\[[0-9;]*m", "", capsys.readouterr().out).splitlines()


def test_a_row_of_many_columns_lies_on_its_side(monkeypatch, capsys):
    lines = printed({"energy": [ENERGY]}, 80, monkeypatch, capsys)
    assert max(map(len, lines)) <= 80 and [line.split()[0] for line in lines[2:] if line.strip(" ─")] == [
        name.split("_")[0] for name in ENERGY
    ]
    assert all("1.234e-5" in line for line in lines[2:] if line.strip(" ─"))


@pytest.mark.parametrize(("width", "tables"), [(80, 1), (60, 1), (44, 2), (30, 4)])
def test_many_rows_of_many_columns_are_tables_below_each_other(width, tables, monkeypatch, capsys):
    rows = [ROPE | {"rope": f"rope-{k}"} for k in range(20)]
    lines = printed({"ropes": rows}, width, monkeypatch, capsys)
    assert max(map(len, lines)) <= width
    words = " ".join(lines).split()
    for word in ("rope-0", "rope-19", "six-strand", "diameter", "OrcaFlex", "19.68", "612100"):
        assert word in words, lines
    assert sum(line.split()[:1] == ["rope-7"] for line in lines) == tables
    assert sum("ropes, continued" in line for line in lines) == tables - 1


def test_widths_are_shared_out():
    heads, lines = ["a", "set by", "note"], [["explicit_euler", "s0", "never stable for swings"]]
    least, natural = least_and_natural(heads, lines)
    assert (least, natural) == ([14, 3, 6], [14, 6, 23])
    assert fitted(least, natural, 60) == natural  # 14 + 6 + 23 + 3 * 3 + 1 = 53
    assert fitted(least, natural, 46) == [14, 6, 16]  # that which lacks least is whole
    assert side_by_side(least, 33) == [[0, 1, 2]] and side_by_side(least, 32) == [[0, 1], [0, 2]]
