"""Settings of the environment under which nothing works are refused in one line, and those that do not matter are not heeded."""

import os
import re
import subprocess
import sys

import pytest

from anet_lumped.checks import InputError
from anet_lumped.environment import check_environment

PROGRAM = [sys.executable, "-c", "from studies.command_line import main; main()"]
REFUSED = {
    "NUMBA_DISABLE_JIT=1": "NUMBA_DISABLE_JIT of the environment must be 0 or not set, .*, but it is 1.",
    "NUMBA_NUM_THREADS=0": "NUMBA_NUM_THREADS of the environment must be at least 1 or not set, but it is 0.",
    "NUMBA_NUM_THREADS=-2": "NUMBA_NUM_THREADS of the environment must be at least 1 or not set, but it is -2.",
}


@pytest.mark.parametrize("setting", REFUSED)
def test_what_nothing_works_with_is_refused(setting):
    with pytest.raises(InputError, match=REFUSED[setting]):
        check_environment(dict([setting.split("=")]))


@pytest.mark.parametrize("setting", ["NUMBA_DISABLE_JIT=0", "NUMBA_NUM_THREADS=1", "NUMBA_NUM_THREADS=many", "NUMBA_DISABLE_JIT="])
def test_what_numba_takes_is_left_to_it(setting):
    check_environment(dict([setting.split("=")]))


@pytest.mark.parametrize("setting", ["NUMBA_DISABLE_JIT=1", "NUMBA_NUM_THREADS=0"])
def test_the_program_says_so_in_one_line(setting):
    ended = subprocess.run(
        [*PROGRAM, "check", "loose_cable"], env=os.environ | dict([setting.split("=")]), capture_output=True, text=True
    )
    assert ended.returncode == 2 and ended.stdout == ""
    assert re.fullmatch(f"anet-lumped: The variable {REFUSED[setting]}\n", ended.stderr)


@pytest.mark.slow
def test_figures_need_no_backend_of_the_user(tmp_path):
    command = ["simulate", "loose_cable", "--t-end", "0.01", "--method", "edmc", "--dt", "0.005", "--start", "straight"]
    ended = subprocess.run(
        [*PROGRAM, *command, "--out", str(tmp_path)], env=os.environ | {"MPLBACKEND": "foo"}, capture_output=True, text=True
    )
    assert ended.returncode == 0 and (tmp_path / "run.png").stat().st_size > 0, ended.stderr
