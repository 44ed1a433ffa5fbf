"""Examples in a document: code that is run, and what it prints.

A block of ``python`` is run in the names of those before it; a block of ``console`` is a command of the program behind `$ `, and
what it prints; a block of ``text`` right after code is what that prints. A comment `<!-- timed -->` above a block says that what it
prints depends on how fast the machine is.
"""

import contextlib
import io
import math
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

FENCE = re.compile(
    r"^```(?P<kind>python|console|text)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL
)
TIMED_BLOCK = "<!-- timed -->"
CLOSE, SMALL = 1e-2, 1e-7  # of a number, or in all: what another machine may print differently
TIMED = (
    "wall time",
    "times faster",
    "cost [%]",
    "rows, figures and answer in",
)  # words of a line of numbers that no two runs share


@dataclass
class Block:
    """A fenced block of a document: its kind, its text, where that begins and ends, and whether it depends on timings."""

    kind: str
    body: str
    begin: int
    end: int
    is_timed: bool


@dataclass
class Example:
    """Code or a command, what the document says that it prints, where that is said, and whether it is said at all.

    What a timed one prints is said as it once was.
    """

    code: str
    said: str
    begin: int
    end: int
    is_command: bool
    is_said: bool
    is_timed: bool


def blocks(text):
    """Return the fenced blocks of a document that are code, commands or what they print."""
    return [
        Block(
            found["kind"],
            found["body"],
            *found.span("body"),
            TIMED_BLOCK in text[: found.start()].rpartition("\n\n")[2],
        )
        for found in FENCE.finditer(text)
    ]


def examples(text):
    """Return the examples of a document in order."""
    made, found = [], blocks(text)
    for k, block in enumerate(found):
        if block.kind == "text":
            continue
        if block.kind == "console":
            command, _, said = block.body.partition("\n")
            made.append(
                Example(
                    command.removeprefix("$ "),
                    said,
                    block.begin + len(command) + 1,
                    block.end,
                    True,
                    True,
                    block.is_timed,
                )
            )
            continue
        after = found[k + 1] if k + 1 < len(found) else None
        if (
            after is not None
            and after.kind == "text"
            and not text[block.end + len("```") : after.begin - len("```text\n")].strip()
        ):
            made.append(
                Example(block.body, after.body, after.begin, after.end, False, True, block.is_timed)
            )
        else:
            made.append(Example(block.body, "", block.end, block.end, False, False, block.is_timed))
    return made


def transcript(text):
    """Return the commands of a record in order, each with what the record says that it prints.

    A command stands behind `$ ` at the start of a line.
    """
    parts = re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]
    return [(command, said) for command, _, said in (part.partition("\n") for part in parts)]


def run(example, names, folder, file="document"):
    """Run an example and return what it prints.

    Parameters
    ----------
    example : Example
    names : dict, of the code that has been run before it, and then of its own
    folder : path, where commands run and code writes
    file : str, for tracebacks
    """
    if example.is_command:
        return run_command(example.code, folder)
    printed, here = io.StringIO(), Path.cwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(printed):
            exec(compile(example.code, file, "exec"), names)
    finally:
        os.chdir(here)
    return printed.getvalue()


def in_a_process(words, folder):
    """Return the exit status of the program, and what it writes on stdout and on stderr."""
    program = [sys.executable, "-c", "from studies.command_line import main; main()", *words]
    done = subprocess.run(program, capture_output=True, text=True, cwd=folder)
    return done.returncode, done.stdout, done.stderr


def run_command(command, folder, call=in_a_process):
    """Return what `anet-lumped ...` prints, without progress and the line that it compiles; SystemError if it fails.

    Parameters
    ----------
    command : str
    folder : path, where it runs
    call : function like `in_a_process`
    """
    words = command.split()
    if words[0] != "anet-lumped":
        raise ValueError(
            f"A command of a document must begin with anet-lumped, but it is {command!r}."
        )
    status, printed, complaints = call(words[1:], folder)
    if status:
        raise SystemError(f"{command} ended with {status}:\n{printed}{complaints}")
    told = [line for line in complaints.splitlines() if line.startswith("anet-lumped: ")]
    for passing in (
        "Compiling",
        "... ",
    ):  # what the first run on a machine alone says, and progress
        told = [line for line in told if not line.startswith(f"anet-lumped: {passing}")]
    lines = [line.rstrip() for line in [*printed.splitlines(), *told]]
    return "".join(
        f"{line}\n" for line, after in zip(lines, [*lines[1:], "end"], strict=True) if line or after
    )


def alike(one, other):
    """Return whether two printed texts have the same words, and numbers that are close."""
    first, second = (
        [line.split() for line in text.splitlines() if line.strip(" ─")] for text in (one, other)
    )
    if [len(line) for line in first] != [len(line) for line in second]:
        return False
    table_of_times = False
    for words, others in zip(first, second, strict=True):
        numbers = any(_number(word) is not None for word in words)
        if not numbers:
            table_of_times = any(name in " ".join(words) for name in TIMED)
        if table_of_times or any(name in " ".join(words) for name in TIMED):
            continue
        if not all(_alike(word, another) for word, another in zip(words, others, strict=True)):
            return False
    return True


def _alike(word, other):
    a, b = _number(word), _number(other)
    if a is None or b is None:
        return word == other
    return math.isclose(a, b, rel_tol=CLOSE, abs_tol=SMALL) or (math.isnan(a) and math.isnan(b))


def _number(word):
    try:
        return float(word.strip("[](),;=").rpartition("=")[2])
    except ValueError:
        return None
