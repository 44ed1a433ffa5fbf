"""Tables of the keys of a scene file, from the docstrings and the signatures of the classes that take them."""

import importlib
import inspect
import operator
import re

from docstrings import NAMED


def parameters(thing):
    """Return each argument of a class or function with what its docstring says of it."""
    found, section, names, begun = {}, "", (), False
    for line in inspect.cleandoc(thing.__doc__).splitlines():
        if not line.strip():
            section = section if section == "Parameters" else ""
        elif line == "Parameters":
            section = line
        elif section == "Parameters" and not line.startswith((" ", "-")):
            entry = NAMED.match(line)
            if entry is None:
                break
            names, begun = [name.strip() for name in entry["name"].split(",")], False
            found |= dict.fromkeys(names, entry["rest"])
        elif section == "Parameters" and line.startswith(" "):
            joined = (
                ""
                if begun
                or found[names[-1]].endswith((",", ";", "(", "."))
                or line.strip()[0].islower()
                else "."  # after the type, where a sentence follows
            )
            begun = True
            found |= dict.fromkeys(names, f"{found[names[-1]]}{joined} {line.strip()}")
    return found


def rows(thing):
    """Return (key, default, meaning) of each key that a table of this kind may have."""
    said = parameters(thing)
    for argument in inspect.signature(thing).parameters.values():
        if argument.default is argument.empty:
            default = "required"
        elif argument.default is None:
            default = ""
        else:
            default = as_toml(argument.default)
        yield argument.name, default, in_a_file(said[argument.name])


IN_A_FILE = {
    "(3,) array_like": "three numbers", "(k,) array_like": "numbers", "(k, 3) array_like": "rows of three numbers",
    "float or None": "number", "float": "number", "int,": "whole number,", "str,": "text,", "bool;": "true or false;",
    "sequence of str or None": "names", "dict or pairs of str and": "table of names and", "dict of str and": "table of names and",
    "tuple of 3 number": "three numbers", "Signal": "function of time",
}  # fmt: skip
"""Words of docstrings, and what that is in a scene file."""


def in_a_file(text):
    """Return what a docstring says of an argument in the words of a scene file."""
    for word, other in IN_A_FILE.items():
        text = re.sub(rf"(?<!\w){re.escape(word)}", other, text)
    return text


def as_toml(value):
    """Return a default as a scene file has it."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(as_toml, value))}]"
    return (
        str(value).lower()
        if isinstance(value, bool)
        else f'"{value}"'
        if isinstance(value, str)
        else f"{value:g}"
    )


def table(thing):
    """Return the table of keys of a class or function, given as `module:name` or `module:room.name`."""
    module, name = thing.split(":")
    lines = ["| key | default | meaning |", "|---|---|---|"]
    for key, default, meaning in rows(operator.attrgetter(name)(importlib.import_module(module))):
        default = f"`{default}`" if default not in ("", "required") else default
        lines.append(f"| `{key}` | {default} | {escaped(meaning)} |")
    return "\n".join(lines)


def escaped(text):
    """Return a sentence of a docstring as Markdown takes it for text; what it quotes stays code."""
    parts = text.replace("``", "`").split("`")
    for k in range(0, len(parts), 2):
        for mark in "\\*_$[]<>{}|":
            parts[k] = parts[k].replace(mark, f"\\{mark}")
    return "`".join(parts)
