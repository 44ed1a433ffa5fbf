"""What a compiled function was made of: the text of its file, and of the files that this file imports, one after the other.

Constants and functions of other files are compiled into a function. Therefore it is out of date when any of these files changes.
Files of other packages, such as NumPy, are left out: only those are read that are in a package with compiled functions of its own.
"""

import hashlib
import re
import sys
from functools import cache

PACKAGES = {__name__.partition(".")[0]}
"""Names of the packages whose files are read."""

_IMPORT = re.compile(r"^(?:from[ \t]+(\S+)[ \t]+import[ \t]+(\([^)]*\)|.*)|import[ \t]+(.*))", re.MULTILINE)


def source_stamp(name: str) -> bytes:
    """Hash of the text of a module and of all modules of `PACKAGES` that it imports; empty where its text is not to be had."""
    PACKAGES.add(name.partition(".")[0])
    if _read(name) is None:
        return b""
    found, waiting = {}, [name]
    while waiting:
        one = waiting.pop()
        if one not in found and (text := _read(one)) is not None:
            found[one], imported = text
            waiting.extend(imported)
    return hashlib.sha256(b"".join(found[one] for one in sorted(found))).digest()


@cache
def _read(name):
    """Hash of a module's text, and the modules of `PACKAGES` that it imports, or None; a process reads each file once.

    Only imports at the beginning of a line count: a compiled function cannot see what a function in Python imports.
    """
    module = sys.modules.get(name)
    try:
        with open(module.__file__, "rb") as file:
            text = file.read()
    except (AttributeError, TypeError, OSError):
        return None
    imported = [one for one in _imported(module, text.decode(errors="replace")) if one.partition(".")[0] in PACKAGES]
    return hashlib.sha256(text).digest(), imported


def _imported(module, text):
    """Names of the modules that a text imports; they are loaded, as the functions of a module are made after its imports."""
    for base, names, modules in _IMPORT.findall(text):
        if modules:
            yield from _first_words(modules)
            continue
        level = len(base) - len(base.lstrip("."))
        if level:
            package = (module.__package__ or "").split(".")
            base = ".".join([*package[: len(package) - level + 1], *([base[level:]] if base[level:] else [])])
        for name in _first_words(names.strip("()")):
            yield f"{base}.{name}" if f"{base}.{name}" in sys.modules else base


def _first_words(names):
    """Names in a list of what is imported, without their comments and without what they are called."""
    names = re.sub(r"#.*", "", names)
    return [name.split()[0] for name in names.split(",") if name.split()]
