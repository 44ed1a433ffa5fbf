"""The table of methods, from the records of the schemes (`integrators.schemes`)."""

from sphinx.util.docutils import SphinxDirective

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


class Methods(SphinxDirective):
    """Write the table."""

    def run(self):
        """Return the table."""
        lines = ["```{list-table}", ":header-rows: 1", ":widths: 18 12 8 10 22 30", ""]
        for row in (HEADS, *rows()):
            lines += [f"{'* -' if k == 0 else '  -'} {cell}" for k, cell in enumerate(row)]
        return self.parse_text_to_nodes("\n".join([*lines, "```"]))


def setup(app):
    """Offer the directive `methods`."""
    app.add_directive("methods", Methods)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
