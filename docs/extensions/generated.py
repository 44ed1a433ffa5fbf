"""Parts of pages that are made of the source, between two comments; they stand in the pages so that these read as they lie here.

<!-- keys anet_lumped:Fixed -->      table of the keys of a scene file that a class or function takes
<!-- commands -->                    a section for each command of the program
<!-- methods -->                     table of the methods
<!-- end -->
"""

import re

import commands
import keys
import methods

PART = re.compile(r"(<!-- (keys|commands|methods) ?(\S*) -->\n).*?(<!-- end -->)", re.DOTALL)


def filled(text):
    """Return a page with these parts made anew."""

    def made(found):
        begin, what, thing, end = found.groups()
        part = {
            "keys": lambda: keys.table(thing),
            "commands": commands.sections,
            "methods": methods.table,
        }[what]()
        return f"{begin}\n{part}\n\n{end}"

    return PART.sub(made, text)
