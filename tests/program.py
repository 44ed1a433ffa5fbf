"""The program `anet-lumped`, called in the process of the test."""

import pytest

from studies.command_line import main


def call(*arguments):
    """Exit status of the program, called in this process."""
    with pytest.raises(SystemExit) as ended:
        main(list(map(str, arguments)))
    return ended.value.code
