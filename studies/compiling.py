"""Hears when Numba compiles, here and in worker processes, so that a person is told once why a program takes its time.

Numba is imported when the watch begins, and not before: `--help` does without.
"""

import os
import threading
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

NOTICED_AFTER = 0.5  # [s] of compiling that nobody needs to be told of


def call_when_compiling(call: Callable[[], None]) -> None:
    """Have `call()` called once, from any thread, when Numba has compiled for NOTICED_AFTER in all in this process.

    Nothing is called where all that a program needs is on the disk already.
    """
    from numba.core import event

    class Watch(event.Listener):
        """Adds up the time between the beginning and the end of what is compiled, however deep within each other."""

        def __init__(self):
            self.depth, self.seconds, self.began, self.timer = 0, 0.0, 0.0, None

        def on_start(self, event):
            self.depth += 1
            if self.depth == 1 and self.seconds < NOTICED_AFTER:
                self.began = time.perf_counter()
                self.timer = threading.Timer(NOTICED_AFTER - self.seconds, call)
                self.timer.daemon = True
                self.timer.start()

        def on_end(self, event):
            self.depth -= 1
            if self.depth == 0 and self.seconds < NOTICED_AFTER:
                self.timer.cancel()  # which has called by now if the time is up
                self.seconds += time.perf_counter() - self.began

    event.register("numba:compile", Watch())


def kernels_are_on_disk() -> bool:
    """Whether Numba has kept anything of `anet_lumped` on the disk, as far as a look at its folders tells."""
    folders = [Path(folder) for folder in find_spec("anet_lumped").submodule_search_locations]
    if os.environ.get("NUMBA_CACHE_DIR"):
        folders = [Path(os.environ["NUMBA_CACHE_DIR"])]
    return any(next(folder.rglob("*.nbi"), None) for folder in folders)


class Notice:
    """A line that is told once, whoever compiles first."""

    def __init__(self):
        self._lock, self._line, self._tell = threading.Lock(), "", None

    def watch(self, line: str, tell: Callable[[str], None]) -> None:
        """Have `tell(line)` called once when this process, or a worker of this process, compiles."""
        self._line, self._tell = line, tell
        call_when_compiling(self.give)

    def give(self) -> None:
        """Something is being compiled."""
        with self._lock:
            tell, self._tell = self._tell, None
        if tell:
            tell(self._line)


NOTICE = Notice()
"""What the command line says of compiling."""
