"""The one place where a worker runs rows, whatever it is: a process of this machine, a node of a cluster, a thread.

What a row raises becomes a status and a reason here, so that it need not travel.
"""

import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from anet_lumped.checks import check_number
from anet_lumped.results.run import RunInterrupt
from integrators.deadline import deadline, time_left

OVER_BUDGET, CRASHED = "over budget", "crashed"  # statuses of rows that did not come to their end
BUDGET = "row_budget"  # [s], that such a row had: in lines on the disk, and in no table
_USED = threading.Event()  # whether this process has run a row


@dataclass(frozen=True)
class BatchRunner:
    """What runs a batch of rows in a worker: rows -> (a result for each, the time that they took [s]).

    Parameters
    ----------
    function : of a row, picklable
    budget : float or None [s], that a row may take
    """

    function: Callable[[dict], dict]
    budget: float | None = None

    def __call__(self, rows: Iterable[dict]) -> tuple[list[dict], float]:
        """Results of the rows, and their time [s]."""
        began = time.perf_counter()
        return [run_row(self.function, self.budget, row) for row in rows], time.perf_counter() - began


def run_row(function: Callable[[dict], dict], budget: float | None, row: dict) -> dict:
    """Result of a row; one that raises is a failed one, one that takes longer than its budget [s] says how far it came.

    The first row of a process also imports what it needs, which is no fault of its own: if that takes it over its budget, it has
    another one.
    """
    try:
        with deadline(budget):
            try:
                return dict(function(row))
            except RunInterrupt as error:
                if budget is None or time_left():  # Ctrl-C, and not the budget
                    raise
                stopped = error
        if not _USED.is_set():
            _USED.set()
            return run_row(function, budget, row)
        reached = f"the run had reached t={stopped.run.t[-1]:.4g} s"
        return {"status": OVER_BUDGET, "reason": f"It took longer than its budget of {budget:g} s: {reached}.", BUDGET: budget}
    except Exception as error:
        return failed(error)
    finally:
        _USED.set()


def failed(error: Exception) -> dict[str, Any]:
    """The result of a row that raised an error."""
    return {"status": "failed", "reason": f"{type(error).__name__}: {error}"}


def check_budget(budget: float | None) -> float | None:
    """Refuse a budget that is no time.

    Raises
    ------
    InputError
    """
    return None if budget is None else check_number("budget", budget, "s", "the sweep", sign="positive")
