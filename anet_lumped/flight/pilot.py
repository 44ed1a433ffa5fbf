"""The pilot of a flight: what it asks controllers at their rates, and what rotors make of it, at the start of each step.

All of that is compiled. Python is asked only where a controller has no compiled law: then the pilot returns to it, and goes on with
its answer. Rates, holds and delays are those of `timing.Held`, to the last bit.
"""

from typing import Any

import numpy as np

from anet_lumped.checks import InputError, quoted, shown
from anet_lumped.compiled.addresses import address
from anet_lumped.motion.given_forces import BODY
from anet_lumped.motion.law_steps import LAW_AT_START
from anet_lumped.motion.readings import sight_of
from integrators.addresses import words_of
from integrators.compile_once import compile_for

from .compiled_law import GIVES, NOTHING, CompiledLaw, law_of
from .geometric import Cascade
from .pilot_kernel import (
    ACTING,
    ASK_ATTITUDE,
    CLOCK,
    DELAY,
    LAST_CALL,
    NOT_FINITE,
    PERIOD,
    Cockpit,
    Stage,
    book_call,
    pilot,
    slot_of_call,
)
from .rotors import Rotors, told
from .seen import Seen, Sensors
from .timing import Held


class Pilot:
    """A `StepLaw` of a controller.

    Parameters
    ----------
    controller : as of `fly`
    sensors : Sensors or None; with them, the controller is called in Python in every step
    rotors : Rotors
    points : int, free points of the scene
    """

    def __init__(self, controller: Any, sensors: Sensors | None, rotors: Rotors, points: int) -> None:
        self.rotors, self.count, self._points = rotors, len(rotors.quadrotors), points
        self._whole = sensors is not None or type(controller) is not Cascade
        if sensors is not None:
            self._controllers: list[Any] = [None, lambda seen: controller(sensors(seen))]
        elif self._whole:
            self._controllers = [None, controller]
        else:
            self._controllers = [controller.position, controller.attitude]
        self._stages = [self._stage(one, gives) for one, gives in zip(self._controllers, ("force", "wrench"), strict=True)]
        self._sight, self._state = sight_of(self.count, points), np.zeros(1, np.int64)
        self.address = address(compile_for(pilot, LAW_AT_START))

    def _stage(self, controller: Any, gives: str) -> Stage:
        """The stage of a controller, at its start."""
        held = controller if type(controller) is Held else None
        law = law_of(controller if held is None else held.controller)
        if law is not None and law.gives != gives:
            raise InputError(f"A controller that is to give a {quoted(gives)} must not give a {quoted(law.gives)}.")
        clock = np.zeros(CLOCK)
        clock[[PERIOD, DELAY, LAST_CALL]] = (0.0, 0.0, np.nan) if held is None else (held.period, held.delay, np.nan)
        pending = 3 + (0 if held is None else int(held.delay / held.period))
        guide = None if law is None else law.guide
        if law is not None:
            law.check(self.count)
            if law.needs_given and law.guide is None and (self._whole or gives == "force"):
                raise InputError(
                    "A control of attitudes needs the forces of a position control, but it is given none; use a Cascade."
                )
        return Stage(
            0 if guide is None else guide.address, 0 if law is None else law.address, _numbers(guide), _numbers(law),
            np.zeros((3 * self.count, 3)), clock, np.zeros(pending), np.zeros((pending, self.count, GIVES[gives][1])),
        )  # fmt: skip

    def attach(self, session: Any) -> int:
        """Take what the session works on."""
        rotors, forces = self.rotors, session._forces
        forces.axes[0, forces._origins] = forces.axes[1, : self.count] = BODY
        self._cockpit = Cockpit(
            self._sight, self._stages[0], self._stages[1], int(self._whole), self._state, NOTHING, rotors.speed, rotors.command,
            rotors.limits, rotors.mixing, rotors.sharing, rotors.lags, rotors.drag, rotors.acting, forces._origins, forces.force,
            forces.torque, session.readable,
        )  # fmt: skip
        self._words = np.array(words_of(self._cockpit), np.int64)
        return int(self._words.ctypes.data)

    def ask(self, t: float, reason: int) -> None:
        """Call the controller that has no compiled law.

        Raises
        ------
        InputError : an answer that is not finite, or of another shape
        """
        if reason == NOT_FINITE:
            wrench = shown(self._acting(self._stages[1]))
            raise InputError(f"A controller must give finite thrusts and torques, but at t = {t:g} s it gives {wrench}.")
        attitude = reason == ASK_ATTITUDE
        stage, controller = self._stages[attitude], self._controllers[attitude]
        seen = Seen(t, *(x.copy() for x in self._sight))
        given = () if not attitude or self._whole else (self._acting(self._stages[0]).copy(),)
        answer = (controller.controller if type(controller) is Held else controller)(seen, *given)
        slot = slot_of_call(stage.clock, stage.times, t)
        stage.answers[slot] = _rows_of_wrench(answer, self.count) if attitude else _rows_of_force(answer, self.count)
        book_call(stage.clock, stage.times, t, slot)

    def _acting(self, stage: Stage) -> np.ndarray:
        """The answer of a stage that acts."""
        return stage.answers[int(stage.clock[ACTING])]


def _numbers(law: CompiledLaw | None) -> np.ndarray:
    """Numbers of a law, none of none."""
    return np.zeros(0) if law is None else law.numbers


def _rows_of_wrench(answer: Any, count: int) -> np.ndarray:
    """Thrusts and torques (m, 4) of an answer that is a `Wrench`."""
    try:
        thrust, torque = (np.asarray(part, float) for part in answer)
        fits = thrust.shape == (count,) and torque.shape == (count, 3)
    except (TypeError, ValueError):
        fits = False
    if not fits:
        raise InputError(
            f"A controller must give a Wrench, thrusts ({count},) [N] and torques ({count}, 3) [N m], but it gives {shown(answer)}."
        )
    return told(thrust, torque)


def _rows_of_force(answer: Any, count: int) -> np.ndarray:
    """Forces (m, 3) of an answer."""
    if np.shape(answer) != (count, 3):
        raise InputError(f"A position control must give forces ({count}, 3) [N], but it gives {shown(answer)}.")
    return np.asarray(answer, float)
