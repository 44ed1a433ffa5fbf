"""Rows in the process that asks for them: where another would have no core of its own, it would only load everything once more."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any


class SameProcess(Executor):
    """Does what is submitted at once, one after the other; a fault in compiled code ends this process."""

    def submit(self, function: Callable, /, *arguments: Any, **options: Any) -> Future:
        """What is done already, or has failed; Ctrl-C is not caught."""
        future: Future = Future()
        try:
            future.set_result(function(*arguments, **options))
        except Exception as error:
            future.set_exception(error)
        return future
