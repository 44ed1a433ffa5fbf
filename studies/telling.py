"""What the program says on stderr while it works: one line at a time."""

import logging
import sys
import time

SHORT = 200  # characters that are told as they are
QUIET = 3.0  # seconds, after which a command says what it is doing
FIRST_COMPILING = (
    dict.fromkeys(("equilibrium", "check", "mismatch", "convert", "view"), 7)
    | dict.fromkeys(("simulate", "sweep"), 30)
    | {"fly": 50, "recommend": 55, "effects": 55, "study": 60, "report": 70}
)
"""Seconds of compiling on a core of 3 GHz that does nothing else, where nothing is compiled yet, by the command."""


def tell(line):
    """Say something in one line of bounded length."""
    line = str(line)
    if len(line) > SHORT or not line.isprintable():
        from anet_lumped.checks import one_line  # only here: the library takes seconds to import

        line = one_line(line)
    print(f"anet-lumped: {line}", file=sys.stderr)


def tell_lines(text):
    """Say what has lines of its own, such as all that is refused of a file."""
    for line in str(text).split("\n"):
        tell(line)


def announce_compiling(arguments):
    """Have one line say so, once, if Numba has to compile for what the command line asks for, here or in a worker."""
    command = arguments[0] if arguments else None
    if command in FIRST_COMPILING and "--help" not in arguments:
        from integrators.compiling import NOTICE

        line = (
            f"Compiling what this machine has not compiled yet takes up to about {FIRST_COMPILING[command]} s, longer on a busy "
            "machine; later runs do without."
        )
        NOTICE.prepare(line, tell)


def tell_what_takes_long():
    """What the library logs goes to stderr: warnings at once, the rest once a command has taken `QUIET` seconds."""
    began = time.monotonic()

    class Late(logging.Handler):
        def emit(self, record):
            if record.levelno >= logging.WARNING:
                tell(f"warning: {record.getMessage()}")
            elif time.monotonic() - began > QUIET:
                tell(f"... {record.getMessage()}")

    for log in map(logging.getLogger, ("anet_lumped", "integrators", "studies")):
        log.handlers = [Late()]
        log.setLevel(logging.INFO)
