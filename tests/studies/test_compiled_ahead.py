"""What is compiled ahead: by two processes at once, of which one that fails takes nothing with it."""

import os
import time
from pathlib import Path

import pytest

from studies.sweeping import compiled_ahead
from studies.sweeping.compiled_ahead import compile_ahead

FOLDER = "FOLDER_OF_HALVES"  # environment variable


def meet(name, other):
    """Say that a half has begun, and wait for the other."""
    folder, began = Path(os.environ[FOLDER]), time.monotonic()
    (folder / name).write_text(str(os.getpid()))
    while not (folder / other).exists():
        assert time.monotonic() < began + 60.0
        time.sleep(0.01)


def one_half():
    meet("one", "other")


def other_half():
    meet("other", "one")


def lost_half():
    os._exit(1)


@pytest.mark.slow
def test_both_halves_run_at_once_in_processes_of_their_own(monkeypatch, tmp_path):
    monkeypatch.setenv(FOLDER, str(tmp_path))
    compile_ahead((one_half, lost_half, other_half))
    assert len({os.getpid(), *(int(file.read_text()) for file in tmp_path.iterdir())}) == 3


def test_the_halves_run():
    """All that they name is there; what they compile is on the disk."""
    compiled_ahead.compile_effects()
    compiled_ahead.compile_effects_of_studies()
    compiled_ahead.compile_motions()
