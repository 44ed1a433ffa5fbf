"""The commands of the program for the page of the command line: what each is for, and a table of its arguments and options."""

import inspect
import typing

from keys import escaped

from studies.command_line import app


def sections():
    """Return a section for each command, in the program's own order."""
    return "\n\n".join(section(command.callback) for command in app.registered_commands)


def section(callback):
    """Return what a command is for, its arguments and options, and a link to an example with what it prints."""
    name = callback.__name__.strip("_")
    said = [f"## {name}", escaped(inspect.getdoc(callback))]
    rows = [row(argument) for argument in inspect.signature(callback).parameters.values()]
    if rows:
        said.append("\n".join(["| argument | default | meaning |", "|---|---|---|", *rows]))
    return "\n\n".join([*said, f"[An example, and what it prints](recorded/{name}.txt)"])


def row(argument):
    """Return a line of the table: how an argument or option is written, its default and what it is."""
    kind, about = typing.get_args(argument.annotation)[:2]
    if type(about).__name__ == "ArgumentInfo":
        written = about.metavar or argument.name.upper()
    else:
        named = (
            about.default if isinstance(about.default, str) else None
        )  # where typer keeps the name of an annotated option
        option = named or f"--{argument.name.replace('_', '-')}"
        value = "" if kind is bool else f" {about.metavar or argument.name.upper()}"
        written = option + value
    default = argument.default
    shown = (
        "required"
        if default is argument.empty
        else ""
        if default in (None, False, (), [])
        else f"`{default}`"
    )
    return f"| `{written}` | {shown} | {escaped(about.help)} |"
