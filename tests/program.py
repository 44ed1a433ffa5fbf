"""The program `anet-lumped`, called in the process of the test."""

from pathlib import Path

import pytest

from studies.command_line import main

OLD_RUN = Path(__file__).parent / "files" / "run_of_version_0_1.nc"
PROGRAM = ["-c", "from studies.command_line import main; main()"]


def call(*arguments):
    """Exit status of the program, called in this process."""
    with pytest.raises(SystemExit) as ended:
        main(list(map(str, arguments)))
    return ended.value.code
