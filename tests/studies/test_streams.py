"""Standard streams that are closed, full, or cannot write a character: what is printed never ends in a traceback."""

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

from studies.streams import PrintError, standard_streams

ROOT = Path(__file__).parents[2]
PRINTS = """
import sys
from studies.streams import standard_streams
with standard_streams():
    print("m² to stdout")
    print("m² to stderr", file=sys.stderr)
"""
needs_shell = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is full")


class Full(io.StringIO):
    def write(self, text):
        raise OSError(28, "No space left on device")


@pytest.mark.parametrize("name", ["stdout", "stderr"])
def test_a_full_stream_is_an_error_where_results_go_and_none_where_words_go(name, monkeypatch):
    monkeypatch.setattr(sys, name, Full())
    if name == "stderr":
        with standard_streams():
            print("anything", file=sys.stderr)
        return
    with pytest.raises(PrintError, match="No space left on device"), standard_streams():
        print("anything")


def test_a_pipe_whose_reader_has_gone_is_an_error_without_words(monkeypatch):
    class Gone(io.StringIO):
        def flush(self):
            raise BrokenPipeError(32, "Broken pipe")

    monkeypatch.setattr(sys, "stdout", Gone())
    with pytest.raises(PrintError, match=r"^$"), standard_streams():
        print("anything", flush=True)


def test_what_a_stream_has_not_is_written_by_its_number(monkeypatch):
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    stream = sys.stdout
    with standard_streams():
        print("m²", flush=True)
    assert stream.buffer.getvalue() == b"m\\xb2\n"


@needs_shell
@pytest.mark.parametrize(
    ("redirected", "stdout", "stderr"),
    [
        (">&-", "", "m² to stderr\n"),
        ("2>&-", "m² to stdout\n", ""),
        ("2>/dev/full", "m² to stdout\n", ""),
        ("<&- >&- 2>&-", "", ""),
    ],
)
def test_closed_streams_take_what_is_printed(redirected, stdout, stderr):
    call = ["sh", "-c", f'"$0" -c "$1" {redirected}', sys.executable, PRINTS]
    done = subprocess.run(call, capture_output=True, text=True, encoding="utf-8", cwd=ROOT)
    assert (done.returncode, done.stdout, done.stderr) == (0, stdout, stderr)


@pytest.mark.slow
@needs_shell
def test_a_full_device_is_told_once_and_not_again_as_python_ends():
    """Python's own exit status would be 120. It keeps what is printed until then, as it is not told to write at once."""
    code = "from studies.command_line import main; main(['ropes'])"
    with open("/dev/full", "w") as full:
        buffered = os.environ | {"PYTHONUNBUFFERED": ""}
        both = subprocess.run([sys.executable, "-c", code], stdout=full, stderr=full, cwd=ROOT, env=buffered)
        done = subprocess.run([sys.executable, "-c", code], stdout=full, stderr=subprocess.PIPE, text=True, cwd=ROOT, env=buffered)
    assert both.returncode == 1
    assert (done.returncode, done.stderr) == (1, "anet-lumped: What is printed could not be written: No space left on device.\n")
