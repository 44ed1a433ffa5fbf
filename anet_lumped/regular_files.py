"""Files that are read whole: regular ones of a bounded size, and never a pipe or a device, which might not end."""

import codecs
import os
import stat
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


def _open_at_once(path: Any, flags: int) -> int:
    """Open a file; if it is a pipe, without waiting for another process to write into it."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
