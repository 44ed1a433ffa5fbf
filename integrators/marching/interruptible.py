"""A compiled march that Ctrl-C can end: the march runs in a thread of its own while the main thread waits."""

import _thread
import threading

import numpy as np

from integrators.ctrl_c import ctrl_c_later

TOLD_EVERY = 5.0  # [s]


def interruptible(march, *arguments, tell=lambda: None, short=False):
    """Call ``march(*arguments, stop)``, which releases the interpreter's lock and ends soon after ``stop[0]`` is set.

    Python handles Ctrl-C in its main thread, between two lines of Python; a compiled march is one line. Therefore the march runs in
    another thread. Called from any other thread than the main one, it runs in that thread.

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
        Ctrl-C came; the caller has to raise it again.
    """
    stop = np.zeros(1, np.int64)
    if threading.current_thread() is not threading.main_thread():
        return march(*arguments, stop), False
    outcome, ended = [], _thread.allocate_lock()
    if short:
        try:
            with ctrl_c_later():
                outcome.append(march(*arguments, stop))
        except KeyboardInterrupt:
            if not outcome:  # it came before the march began
                raise
            return outcome[0], True
        return outcome[0], False

    def run():
        try:
            outcome.append(march(*arguments, stop))
        finally:
            ended.release()

    def end():
        stop[0] = 1

    try:
        with ctrl_c_later(end):
            ended.acquire()
            _thread.start_new_thread(run, ())  # what `threading` adds to it costs as much as a hundred steps
            while not ended.acquire(timeout=TOLD_EVERY):
                tell()
        return outcome[0], bool(stop[0])
    except KeyboardInterrupt:
        if not outcome:  # it came before the march began
            raise
        return outcome[0], True
    finally:
        end()  # whatever was raised, no march goes on without anyone who waits for it
