"""Hears when Numba compiles, here and in worker processes, so that a person is told once why a program takes its time.

Numba is imported when the watch begins, and not before: `--help` does without.
"""

import threading
import time
from collections.abc import Callable

NOTICED_AFTER = 0.5  # [s] of compiling that nobody needs to be told of


def call_when_compiling(call: Callable[[], None], only_cached: bool = False) -> None:
    """Have `call()` called once, from any thread, when Numba has compiled for NOTICED_AFTER in all in this process.

    Nothing is called where all that a program needs is on the disk already. With `only_cached` what Numba does not keep on the
    disk, such as a law of the user's own, does not count.
    """
    from numba.core import event
    from numba.core.caching import NullCache

    class Watch(event.Listener):
        """Adds up the time between the beginning and the end of what is compiled, however deep within each other."""

        def __init__(self):
            self.depth, self.seconds, self.began, self.timer = 0, 0.0, 0.0, None

        def on_start(self, event):
            if only_cached and self.depth == 0 and isinstance(event.data["dispatcher"]._cache, NullCache):
                return
            self.depth += 1
            if self.depth == 1 and self.seconds < NOTICED_AFTER:
                self.began = time.perf_counter()
                self.timer = threading.Timer(NOTICED_AFTER - self.seconds, call)
                self.timer.daemon = True
                self.timer.start()

        def on_end(self, event):
            if self.depth == 0:
                return
            self.depth -= 1
            if self.depth == 0 and self.seconds < NOTICED_AFTER:
                self.timer.cancel()  # which has called by now if the time is up
                self.seconds += time.perf_counter() - self.began

    event.register("numba:compile", Watch())


class Notice:
    """A line that is told once, whoever compiles first."""

    def __init__(self) -> None:
        self._lock, self._line, self.tell, self._only_cached = threading.Lock(), None, None, False

    def prepare(self, line: str, tell: Callable[[str], None], only_cached: bool = False) -> None:
        """Have `tell(line)` called once when something compiles; arguments as above. A program says it before the library does."""
        if self._line is None:
            self._line, self.tell, self._only_cached = line, tell, only_cached

    def listen(self) -> None:
        """Hear what this process compiles; workers are heard by `give`."""
        call_when_compiling(self.give, self._only_cached)

    def give(self) -> None:
        """Something is being compiled."""
        with self._lock:
            tell, self.tell = self.tell, None
        if tell:
            tell(self._line)


NOTICE = Notice()
"""What the command line, or a program that imports the library, says of compiling."""
