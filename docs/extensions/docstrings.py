"""Docstrings as the code writes them, made ready for reStructuredText.

In this code `name : type [unit], meaning` is one line, an indented paragraph is an equation, and a bar or a star is what it is in
arithmetic.
"""

import inspect
import re

SECTION = re.compile(r"-{3,}$")
NAMED = re.compile(r"(?P<name>[*\w][\w*., ]*?) : (?P<rest>.+)$")
WRAPPED = 90  # characters: a longer line goes on in the next one, a shorter one is what an argument is, and its meaning follows
WITH_NAMES = ("Parameters", "Attributes", "Returns", "Raises")


def prepare(lines):
    """Return the lines of a docstring with equations set apart, entries on lines of their own and bars and stars escaped."""
    made, section, literal = [], "", False
    for k, line in enumerate(lines):
        if k + 1 < len(lines) and line.strip() and SECTION.fullmatch(lines[k + 1].strip()):
            section, literal = line.strip(), False
        indented = line.startswith(" ") and bool(line.strip())
        if literal and line.strip() and not indented:
            literal = False
            made.append("")
        if not section and indented and not literal and made and not made[-1].strip():
            made += ["::", ""]
            literal = True
        entry = (
            NAMED.match(line)
            if section in WITH_NAMES and not SECTION.fullmatch(line.strip())
            else None
        )
        if literal or ">>>" in line:
            made.append(line)
        elif entry:
            goes_on = k + 1 < len(lines) and lines[k + 1].startswith(" ") and len(line) > WRAPPED
            made += [
                entry["name"],
                f"    {_escaped(entry['rest'])}{'' if goes_on or entry['rest'].endswith('.') else '.'}",
            ]
        elif section == "Sources" and line.startswith("["):
            made.append(f"* {_escaped(line)}")
        else:
            made.append(_escaped(line))
    return made


def _escaped(line):
    """Escape what reStructuredText would take for markup, outside of what is quoted by backquotes and but for a list's bullet."""
    bullet = "* " if line.startswith("* ") else ""
    parts = re.split(r"(``.*?``|`.*?`)", line.removeprefix(bullet))
    return bullet + "".join(
        part if part.startswith("`") else re.sub(r"(?<!\\)([|*])", r"\\\1", part) for part in parts
    )


def process(app, what, name, thing, options, lines):
    """Prepare a docstring before napoleon reads its sections."""
    lines[:] = prepare(lines)


def process_property(app, what, name, thing, options, lines):
    """Take back what napoleon makes of a property, whose first words it takes for a type if a colon follows them."""
    if what in ("attribute", "property"):
        lines[:] = [*prepare((inspect.getdoc(thing) or "").splitlines()), ""]


def setup(app):
    """Connect to autodoc, ahead of napoleon and behind it."""
    app.setup_extension("sphinx.ext.autodoc")
    app.connect("autodoc-process-docstring", process, priority=100)
    app.connect("autodoc-process-docstring", process_property, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
