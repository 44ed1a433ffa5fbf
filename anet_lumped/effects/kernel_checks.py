"""The compiled functions of an effect must fit their slots: checked when it is made, before an address of theirs is taken."""

import re
from collections.abc import Iterable, Mapping
from typing import Any

from numba.core.dispatcher import Dispatcher

from anet_lumped.checks import SceneError, nearest, shown
from anet_lumped.compiled.exceptions import may_raise

from .signatures import SIGNATURES, SLOTS

DEAD_LOAD_SLOTS = ("force", "energy")
LIVE_FORCE_SLOTS = ("force", "energy", "tangent")


def check_kernels(effect: Any) -> None:
    """Refuse an effect whose compiled functions are missing, unknown, of another signature or able to raise.

    Raises
    ------
    SceneError : names the effect, the function and what must hold
    """
    kernels, called = effect.kernels(), f"effect {type(effect).__name__}"
    if not isinstance(kernels, Mapping):
        raise SceneError(
            f"`kernels` of an effect must return a dict of compiled functions, but that of {called} is {shown(kernels)}."
        )
    for slot in kernels:
        if slot not in SLOTS:
            hint = nearest(slot, SLOTS, quote="`") or "."
            raise SceneError(f"Compiled functions of an effect must be among {_listed(SLOTS)}, but {called} has `{slot}`{hint}")
    required = DEAD_LOAD_SLOTS if effect.dead_load else LIVE_FORCE_SLOTS
    kind = "A dead load" if effect.dead_load else "An effect that exerts forces"
    for slot in required:
        if slot not in kernels:
            raise SceneError(f"{kind} must have the compiled functions {_listed(required)}, but {called} has no `{slot}`.")
    if effect.dead_load and len(kernels) > len(required):
        surplus = next(slot for slot in kernels if slot not in required)
        raise SceneError(
            f"A dead load must have the compiled functions {_listed(required)} alone, but {called}, whose `dead_load` is True, has "
            f"`{surplus}`."
        )
    if effect.linear_in_node_state and "whole_step" in kernels:
        raise SceneError(
            f"A force that is linear in the state of its node must have no `whole_step`, for that at the middle of a step is as "
            f"good, but {called}, whose `linear_in_node_state` is True, has one."
        )
    for slot, kernel in kernels.items():
        found = _signatures(kernel) if isinstance(kernel, Dispatcher) else [repr(kernel)]
        if found != [SIGNATURES[slot]]:
            raise SceneError(
                f"The function `{slot}` of an effect must be compiled by Numba for signatures.{slot.upper()}_SIGNATURE alone, but "
                f"that of {called} is {_short(found) or 'compiled for none'}."
            )
        raises = may_raise(kernel)
        if raises:
            by_zero = any(words.startswith("ZeroDivisionError") for words in raises)
            raise SceneError(
                f"The function `{slot}` of an effect must not raise, but that of {called} may raise {_listed(raises, '')}"
                + ('; with @njit(..., error_model="numpy") what is divided by zero is inf or nan.' if by_zero else ".")
            )


def _signatures(kernel: Any) -> list[Any]:
    return [overload.signature for overload in kernel.overloads.values()]


def _short(signatures: Iterable[Any]) -> str:
    """Signatures with float64[:,:] for an array of two dimensions."""
    return re.sub(
        r"Array\((\w+), (\d)[^()]*\)", lambda found: f"{found[1]}[{','.join(int(found[2]) * ':')}]", _listed(signatures, "")
    )


def _listed(words: Iterable[Any], quote: str = "`") -> str:
    return ", ".join(f"{quote}{word}{quote}" for word in words)
