"""How the columns of a table fit into a terminal: how wide each is, and which of them stand side by side."""

from collections.abc import Sequence

from rich.cells import cell_len

GAP, EDGE = 3, 1  # characters between two columns, and those that are left of a table


def least_and_natural(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> tuple[list[int], list[int]]:
    """Width of each column in which no word is broken, and in which no text is."""
    columns = list(zip(heads, *lines, strict=True))
    least = [max(cell_len(word) for text in column for word in text.split() or [""]) for column in columns]
    return least, [max(map(cell_len, column)) for column in columns]


def side_by_side(least: Sequence[int], width: int) -> list[list[int]]:
    """Which columns make up a table each, so that none is wider than a terminal; the first column is in all of them."""
    found = [[0]]
    for i in range(1, len(least)):
        if len(found[-1]) > 1 and _total(least[k] for k in (*found[-1], i)) > width:
            found.append([0])
        found[-1].append(i)
    return found


def fitted(least: Sequence[int], natural: Sequence[int], width: int) -> list[int]:
    """Widths of the columns of a table: the natural ones, those first that lack least of it, as far as the terminal goes."""
    given, spare = list(least), width - _total(least)
    for i in sorted(range(len(least)), key=lambda i: natural[i] - least[i]):
        more = max(0, min(spare, natural[i] - least[i]))
        given[i] += more
        spare -= more
    return given


def _total(widths):
    return sum(one + GAP for one in widths) + EDGE
