"""Parts of pages that are made of the source, between two comments; they stand in the pages so that these read as they lie here.

<!-- keys anet_lumped:Fixed -->      table of the keys of a scene file that a class or function takes
<!-- commands -->                    a section for each command of the program
<!-- end -->
"""

import re

from commands import commands
from keys import table

PART = re.compile(r"(<!-- (keys|commands) ?(\S*) -->\n).*?(<!-- end -->)", re.DOTALL)


def filled(text):
    """Return a page with these parts made anew."""

    def made(found):
        begin, what, thing, end = found.groups()
        return f"{begin}\n{table(thing) if what == 'keys' else commands()}\n\n{end}"

    return PART.sub(made, text)
