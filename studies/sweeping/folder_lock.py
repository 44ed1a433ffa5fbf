"""A folder that one run at a time writes its results to."""

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from anet_lumped.checks import InputError

LOCK = ".in-use"  # file that holds the number of the process; gone when the folder is free
FAR = 2**30  # byte of it that Windows locks, so that the number can be read


class FolderInUseError(InputError):
    """A folder to which another run writes."""


@contextlib.contextmanager
def locked(folder: Path | None, name: str = LOCK) -> Iterator[None]:
    """Within it, no other process and no other thread holds the folder, which is made if it is not there; None is no folder.

    A lock by another name is one on a share of the folder. The lock is the system's, which frees it however a process ends. On a
    file system that knows no locks there is none.

    Raises
    ------
    FolderInUseError : another run has it
    """
    if folder is None:
        yield
        return
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / name
    while True:
        file = path.open("a+b")
        if not _lock(file):
            with file:
                file.seek(0)
                holder = file.read(20).decode("ascii", "replace")
            by = f"process {holder}" if holder.isdigit() else "another process"
            if name != LOCK:
                raise FolderInUseError(f"One process must do a share of the rows, but this one of {folder} is in use by {by}.")
            raise FolderInUseError(f"Results must go to a folder of their own, but {folder} is in use by {by}; choose another one.")
        with contextlib.suppress(OSError):
            if os.path.samestat(path.stat(), os.fstat(file.fileno())):
                break
        file.close()  # the run that had it has just taken the file away
    with file:
        try:
            file.truncate(0)
            file.write(str(os.getpid()).encode())
            file.flush()
            yield
        finally:
            with contextlib.suppress(OSError):  # Windows keeps a file that is open
                path.unlink()


def _lock(file):
    """Lock an open file at once, and say whether that went; it is unlocked when it is closed."""
    if sys.platform == "win32":
        import msvcrt

        file.seek(FAR)
        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # the file system knows no locks
        pass
    return True
