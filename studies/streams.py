"""The standard streams of a command, whatever they are: closed, full, or unable to write a character."""

import contextlib
import errno
import os
import sys
from collections.abc import Iterator


class PrintError(Exception):
    """Stdout cannot be written. The message says why; it is empty where the reader of a pipe has gone, which is no fault."""


class _Stream:
    """A stream whose failures are not those of a file.

    Parameters
    ----------
    stream : text stream
    raises : whether a failure is a PrintError; else what cannot be written is lost in silence
    """

    def __init__(self, stream, raises):
        self._stream, self._raises = stream, raises
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")  # ASCII has no m²

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        with self._caught():
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        with self._caught():
            self._stream.flush()

    @contextlib.contextmanager
    def _caught(self):
        try:
            yield
        except OSError as error:
            with contextlib.suppress(OSError, ValueError):  # what is left of it goes nowhere, when Python ends too
                os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
            if self._raises:
                raise PrintError("" if error.errno == errno.EPIPE else str(error.strerror)) from None


@contextlib.contextmanager
def standard_streams() -> Iterator[None]:
    """Within it, stdin, stdout and stderr are open, and hold any character; a closed one reads or writes nothing.

    Raises
    ------
    PrintError : by a `print` or `flush` within, if stdout cannot be written
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:  # the lowest number that is free is taken, which a file of results would take else
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    stdout, stderr = (
        _Stream(stream or open(number, "w", encoding="utf-8", closefd=False), raises)
        for number, (stream, raises) in enumerate([(sys.stdout, True), (sys.stderr, False)], 1)
    )
    with contextlib.redirect_stdout(stdout), contextlib.redirect_stderr(stderr):
        yield
