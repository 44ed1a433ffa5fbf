"""Lengths that are told by what they are to give at rest: `chain.length=sag:0.5m`, `=tension:2kN@fairlead`, `=lowest:-3m`."""

import re

from studies.quantities import metres, newtons

WANTED = re.compile(r"(.+)\.length\s*=\s*(sag|tension|lowest)\s*:\s*([^@]+?)\s*(?:@\s*(.+))?")


def apart(texts):
    """The texts NAME=VALUE that want a length by what it gives, and all others."""
    wanted = [text for text in texts if WANTED.fullmatch(text)]
    return wanted, [text for text in texts if text not in wanted]


def with_wanted_lengths(scene, texts):
    """The scene with the lengths that such texts want, one after the other."""
    if not texts:
        return scene
    from anet_lumped.checks import InputError, quoted
    from anet_lumped.statics.tensioned import tensioned

    for text in texts:
        cable, what, amount, point = WANTED.fullmatch(text).groups()
        if point is not None and what != "tension":
            raise InputError(f"Only a tension is wanted at a point, but {quoted(text)} wants a {what} there.")
        if what == "tension":
            scene = tensioned(scene, cable, end_tension=newtons(amount), at=point)
        else:
            scene = tensioned(scene, cable, **{what: metres(amount)})
    return scene
