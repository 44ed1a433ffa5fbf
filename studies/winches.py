"""Winches of the command line: `--winch tether=30N@ground,0.2m/s` keeps 30 N at the point "ground" by at most 0.2 m/s."""

import re
from typing import Annotated

import typer

from studies.quantities import metres_per_second, newtons

Winches = Annotated[
    list[str], typer.Option("--winch", metavar="CABLE=TENSION,SPEED", help="Keep a tension by a winch: tether=60N@winch,0.2m/s.")
]
WINCH = re.compile(r"([^=]+?)\s*=\s*([^@,]+?)\s*(?:@\s*([^,]+?))?\s*,\s*([^,]+)")


def with_winches(scene, texts, t_end, start):
    """The scene with the winches of such texts, one after the other; `start` as the run takes it."""
    if not texts:
        return scene
    from anet_lumped.checks import InputError, quoted
    from anet_lumped.motion.winch import winched

    for text in texts:
        parts = WINCH.fullmatch(text.strip())
        if parts is None:
            raise InputError(f"A winch must be as tether=30N@ground,0.2m/s or tether=30N,0.2m/s, but it is {quoted(text)}.")
        cable, tension, point, rate = parts.groups()
        scene = winched(
            scene, cable, tension=newtons(tension), rate=metres_per_second(rate), t_end=t_end, at=point, start=start
        )  # fmt: skip
    return scene
