"""A compiled march that Ctrl-C or a deadline can end: the march runs in a thread of its own while the main thread waits."""

import _thread
import contextlib
import threading
import time

import numpy as np

from integrators.ctrl_c import ctrl_c_later
from integrators.deadline import time_left

TOLD_EVERY = 5.0  # [s]


def interruptible(march, *arguments, tell=lambda: None, short=False):
    """Call ``march(*arguments, stop)``, which releases the interpreter's lock and ends soon after ``stop[0]`` is set.

    Python handles Ctrl-C in its main thread, between two lines of Python; a compiled march is one line. Therefore the march runs in
    another thread. Called from any other thread than the main one, it runs in that thread. A `deadline` ends it in any thread.
    Whatever is raised meanwhile, by `tell` or the handler of a signal, is raised once the march has ended: it works on arrays by
    their addresses, which nobody may let go before.

    Parameters
    ----------
    march : compiled function
    arguments : of it
    tell : called every `TOLD_EVERY` while it marches
    short : bool
        Whether it takes so little time that Ctrl-C may wait for its end: then it runs in this thread. A thread of its own takes as
        long as twenty steps of eighty nodes.

    Returns
    -------
    result : what the march returns
    interrupted : bool
        Ctrl-C came, or the deadline is over; the caller has to raise it again.
    """
    stop = np.zeros(1, np.int64)
    left = time_left()
    if threading.current_thread() is not threading.main_thread():
        return _in_this_thread(march, arguments, stop, left)
    outcome, over, ended = [], [], _thread.allocate_lock()
    if short and left is None:
        try:
            with ctrl_c_later():
                outcome.append(march(*arguments, stop))
        except KeyboardInterrupt:
            if not outcome:  # it came before the march began
                raise
            return outcome[0], True
        return outcome[0], False
    due = None if left is None else time.monotonic() + left

    def run():
        try:
            outcome.append(march(*arguments, stop))
        finally:
            over.append(True)
            ended.release()

    def end():
        stop[0] = 1

    try:
        with ctrl_c_later(end):
            ended.acquire()
            _thread.start_new_thread(run, ())  # what `threading` adds to it costs as much as a hundred steps
            try:
                while not ended.acquire(timeout=TOLD_EVERY if due is None else min(TOLD_EVERY, max(0.0, due - time.monotonic()))):
                    if due is not None and time.monotonic() >= due:
                        end()
                        due = None
                    else:
                        tell()
            except BaseException:
                end()
                _wait(over)
                raise
        return outcome[0], bool(stop[0])
    except KeyboardInterrupt:
        if not outcome:  # it came before the march began
            raise
        return outcome[0], True


def _wait(over):
    """Wait until the list holds something, whatever is raised meanwhile: what was raised first is what is told."""
    while not over:
        with contextlib.suppress(BaseException):
            time.sleep(0.001)


def _in_this_thread(march, arguments, stop, left):
    """The march, and whether its deadline ended it: `left` [s] is the time until then, None for none."""
    if left is None:
        return march(*arguments, stop), False
    timer = threading.Timer(left, stop.fill, (1,))
    timer.start()
    try:
        return march(*arguments, stop), bool(stop[0])
    finally:
        timer.cancel()
