"""The page of the command line: each command's own help, and an example with what it printed (`docs/recorded`)."""

from pathlib import Path

import typer.main
from docutils import nodes
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

from studies.command_line import app as program

RECORDED = Path(__file__).parents[1] / "recorded"
WIDTH = 100  # characters of a line of help
logger = logging.getLogger(__name__)


def commands():
    """Return the commands of the program by name, in its own order."""
    return typer.main.get_command(program).commands


def help_of(name, command):
    """Return the help of a command as `anet-lumped NAME --help` prints it."""
    settings = {"terminal_width": WIDTH, "max_content_width": WIDTH}
    return command.get_help(
        command.context_class(command, info_name=f"anet-lumped {name}", **settings)
    )


class Commands(SphinxDirective):
    """Write a section for each command of the program."""

    def run(self):
        """Return the sections."""
        return [self._section(name, command) for name, command in commands().items()]

    def _section(self, name, command):
        section = nodes.section(ids=[f"command-{name}"], names=[f"command-{name}"])
        section += nodes.title(text=name)
        section += _block(help_of(name, command), "text")
        recorded = RECORDED / f"{name}.txt"
        self.env.note_dependency(str(recorded))
        if recorded.is_file():
            section += _block(recorded.read_text(encoding="utf-8").rstrip(), "console")
        else:
            logger.warning(
                "There is no recorded example of `anet-lumped %s`; run docs/record.py.",
                name,
                location=self.get_location(),
            )
        return section


def _block(text, language):
    block = nodes.literal_block(text, text)
    block["language"] = language
    return block


def setup(app):
    """Offer the directive `commands`."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
