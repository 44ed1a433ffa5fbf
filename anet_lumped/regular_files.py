"""Files that are read and written whole: regular ones of a bounded size, and never a pipe or a device, which might not end."""

import codecs
import contextlib
import os
import pathlib
import shutil
import stat
import uuid
from collections.abc import Iterator
from os import PathLike
from typing import Any, Literal

from anet_lumped.checks import NAMED, InputError, one_line, shown
from anet_lumped.limits import TEXT, Limit, check_most, most_of


def read_bytes(path: str | PathLike[str], what: str, limit: Limit, refusal: type[InputError] = InputError) -> bytes:
    """Return the content of a file.

    Parameters
    ----------
    path : str or pathlib.Path
    what : str
        What it is, for messages: "A scene file".
    limit : Limit
        On its bytes.
    refusal : class of errors
        Raised where the file is no such file.

    Raises
    ------
    InputError : no path, no such file, one that is not regular, may not be read or is larger than the limit
    """
    if not isinstance(path, str | PathLike):
        raise refusal(f"{what} must be given by its path, but it is {shown(path)}.")
    named = one_line(os.fsdecode(path), NAMED)
    try:
        with open(path, "rb", opener=_open_at_once) as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise refusal(f"{what} must be a regular file, but {named} is a pipe or a device.")
            check_most(limit, os.fstat(file.fileno()).st_size, f"{what}, {named},")
            content = file.read(int(min(most_of(limit), 2.0**62)) + 1)  # a file without a size, as in /proc, might not end
    except OSError as error:
        raise refusal(f"{what} must be readable, but {named}: {error.strerror}.") from None
    except InputError:
        raise
    except ValueError as error:  # a path with a character that no path may have
        raise refusal(f"{what} must be given by the path of a file, but {named}: {error}.") from None
    check_most(limit, len(content), f"{what}, {named},")
    return content


def read_text(
    path: str | PathLike[str],
    what: str,
    refusal: type[InputError] = InputError,
    errors: Literal["strict", "replace"] = "strict",
) -> str:
    """Return the text of a UTF-8 file, without its byte-order mark and with line ends as \\n; arguments as in `read_bytes`.

    Parameters
    ----------
    errors : "strict" or "replace"
        What becomes of bytes that are no UTF-8: refused, or read as the replacement character.

    Raises
    ------
    InputError : as `read_bytes`; UTF-16 or binary, or no UTF-8
    """
    content = read_bytes(path, what, TEXT, refusal)
    named = one_line(os.fsdecode(path), NAMED)
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise refusal(f"{what} must be UTF-8 text, but {named} is UTF-16.")
    if b"\0" in content:
        raise refusal(f"{what} must be UTF-8 text, but {named} is binary.")
    try:
        text = content.decode("utf-8-sig", errors)
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise refusal(f"{what} must be UTF-8 text, but line {line} of {named} is not.") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def check_target(path: Any, what: str) -> None:
    """Refuse a place that a file cannot be written to: no path, or a folder, a pipe or a device.

    Parameters
    ----------
    path : str or pathlib.Path
    what : str
        What is to be written, for messages: "A run".

    Raises
    ------
    InputError
    """
    if not isinstance(path, str | PathLike) or not os.fspath(path):
        raise InputError(f"{what} must be given the path of the file to write, but it is {shown(path)}.")
    named = one_line(os.fsdecode(path), NAMED)
    try:
        mode = os.stat(path).st_mode
    except OSError:  # there is nothing yet; what else is wrong shows when the file is opened
        return
    except ValueError as error:  # a path with a character that no path may have
        raise InputError(f"{what} must be given the path of the file to write, but {named}: {error}.") from None
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a pipe or a device"
        raise InputError(f"{what} must be written to a regular file, but {named} is {kind}.")


@contextlib.contextmanager
def whole_file(path: Any, what: str) -> Iterator[pathlib.Path]:
    """Give the place of a new file that takes the name ``path`` once the block under `with` has written it.

    Whoever reads ``path`` finds all of the new file or what was there before, also if the disk is full, the process is killed, or
    another thread or process writes the same file at the same time: then the last one stays.

    Parameters
    ----------
    path : str or pathlib.Path
    what : str
        What is to be written, for messages: "A run".

    Yields
    ------
    half : pathlib.Path, in the same folder and with the same ending

    Raises
    ------
    InputError : as `check_target`, or a folder that is not there
    OSError : what the system says, of the file ``path``
    """
    check_target(path, what)
    named = os.fsdecode(path)
    target = pathlib.Path(os.path.realpath(named))  # the file that a link leads to, so that the link stays one
    if not target.parent.is_dir():
        folder = one_line(os.path.dirname(named) or os.fspath(target.parent), NAMED)
        raise InputError(f"{what} must be written to a folder that is there, but {folder} is none.")
    half = target.with_name(f".{uuid.uuid4().hex}{target.suffix}")
    try:
        if target.exists():
            target.open("ab").close()  # a file that may not be changed is not replaced either
        yield half
        if target.exists():
            shutil.copymode(target, half)
        half.replace(target)
    except OSError as error:
        if error.filename not in (None, os.fspath(half), os.fspath(target)):  # of another file
            raise
        raise OSError(error.errno, error.strerror, named) from None
    finally:
        with contextlib.suppress(OSError):
            half.unlink()


def write_text(path: Any, text: str, what: str) -> None:
    """Write a UTF-8 file, which is there whole or not at all; arguments and errors as of `whole_file`."""
    with whole_file(path, what) as half:
        half.write_text(text, encoding="utf-8")


def _open_at_once(path: Any, flags: int) -> int:
    """Open a file; if it is a pipe, without waiting for another process to write into it."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
