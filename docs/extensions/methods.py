"""The table of methods, from the records of the schemes (`integrators.schemes`)."""

from integrators import schemes

HEADS = (
    "method",
    "from",
    "order",
    "step",
    "energy without input",
    "largest stable step, and what more there is to know",
)


def rows():
    """Return a row for each scheme, in the order of the registry."""
    for name in schemes.MODULES:
        scheme = schemes.scheme(name)
        yield (
            f"`{name}`",
            scheme.origin.value,
            "varies" if scheme.order is None else str(scheme.order),
            "explicit" if scheme.explicit else "implicit",
            scheme.energy.value,
            scheme.note,
        )


def table():
    """Return the table."""
    lines = [HEADS, ["---"] * len(HEADS), *rows()]
    return "\n".join(
        f"| {' | '.join(cell.replace('|', '&#124;') for cell in line)} |" for line in lines
    )
