"""Controllers that act at a rate of their own: called, held and delayed."""

import math
from collections import deque
from collections.abc import Callable
from typing import Any

from anet_lumped.checks import InputError, check_number

SAME_TIME = 1e-6  # of the time between two calls


class Held:
    """A controller that is called ``rate`` times a second, whose answer acts ``delay`` later and until the next one acts.

    Parameters
    ----------
    controller : callable, of what is seen and whatever else
    rate : float [1/s]
    delay : float [s]; the very first answer acts at once
    """

    def __init__(self, controller: Callable[..., Any], rate: float, delay: float = 0.0) -> None:
        self.controller = controller
        self.period = 1.0 / check_number("rate", rate, "1/s", "Held", sign="positive")
        self.delay = check_number("delay", delay, "s", "Held", sign="non-negative")
        self.reset()

    def reset(self) -> None:
        """Forget what was answered, here and in the controller."""
        self._calls, self._begin, self._t, self._answers = 0, 0.0, -math.inf, deque[tuple[float, Any]]()
        if hasattr(self.controller, "reset"):
            self.controller.reset()

    def __call__(self, seen: Any, *given: Any) -> Any:
        """The answer that acts at the time ``seen.t``.

        Raises
        ------
        InputError : a time before that of the last call
        """
        slack = SAME_TIME * self.period
        if seen.t < self._t - slack:
            raise InputError(
                f"A controller must be called in the order of times, or be reset, but t = {seen.t:g} s comes after {self._t:g} s."
            )
        self._t = seen.t
        if self._calls == 0:
            self._begin = seen.t
        if seen.t >= self._begin + self._calls * self.period - slack:
            answer = self.controller(seen, *given)
            self._answers.append((seen.t + self.delay if self._calls else seen.t, answer))
            self._calls = max(self._calls + 1, int((seen.t - self._begin) / self.period + SAME_TIME) + 1)
        while len(self._answers) > 1 and self._answers[1][0] <= seen.t + slack:
            self._answers.popleft()
        return self._answers[0][1]
