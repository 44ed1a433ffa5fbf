"""A winch that keeps a tension: it pays out while a cable pulls more than is wanted, and hauls in while it pulls less.

The winch looks at the end tension T after each step of a `Session` and turns, up to the next look, with the speed

    dp/dt = rate clip((T - T_wanted)/band, -1, 1) ,

the length p paid out. So T stays within `band` of what is wanted while the winch is quick enough. What comes back is a scene whose
`LineChange` has p(t), through all looks as a cubic spline: a run of it is a run as any other, with every method, and what the winch
gives is the work of the lengths in its account. The loop of T and p is stable where EA/L rate dt is well below the band; the
step is a quarter of that at most.
"""

import itertools
import math
from dataclasses import replace

from anet_lumped.checks import InputError, check_number, quoted
from anet_lumped.limits import STEPS, check_most
from anet_lumped.model.rest_lengths import changes
from anet_lumped.prescribed import signals
from anet_lumped.prescribed.signals import Signal
from anet_lumped.scene.scene import Scene, check_scene
from anet_lumped.statics.starts import Start

LOOPS = 0.25  # of the step at which the loop of tension and length would overshoot by all that is missing
LOOKS = 400  # in the time, at least
_NUMBERS = itertools.count()


def winched(
    scene: Scene, cable: str, *, tension: float, rate: float, t_end: float, band: float | None = None, at: str | None = None,
    start: Start = "equilibrium",
) -> Scene:  # fmt: skip
    """Scene in which a winch keeps the tension at the end of a cable: with a `LineChange` that pays it out and hauls it in.

    Parameters
    ----------
    scene : Scene without events, and without cables that break
    cable : name of the cable, which stretches
    tension : float [N], `end_tension` to keep at the point `at`
    rate : float [m/s], largest speed of the winch
    t_end : float [s], how long it works; then the length goes on as it last changed
    band : float or None [N], off by so much the winch turns at its full speed; a twentieth of the tension if None
    at : name of the point where the tension is measured; the cable's `start` if None
    start : what the motion starts from, as `simulate` takes it, and as the run of the scene is to start

    Returns
    -------
    Scene

    Raises
    ------
    InputError : a number that cannot be, a cable that does not stretch or whose length changes already
    SceneError : a cable that is wound in whole
    SessionError : a step that failed
    """
    check_scene(scene)
    own, owner = scene.cable(cable), f"the winch of cable {quoted(cable)}"
    tension = check_number("tension", tension, "N", owner, sign="positive")
    rate = check_number("rate", rate, "m/s", owner, sign="positive")
    t_end = check_number("t_end", t_end, "s", owner, sign="positive")
    band = 0.05 * tension if band is None else check_number("band", band, "N", owner, sign="positive")
    point = own.start if at is None else at
    _check(scene, cable)
    dt = min(t_end / LOOKS, LOOPS * band * own.length / (own.EA * rate))
    steps = math.ceil(t_end / dt)
    check_most(STEPS, steps, f"The winch of cable {quoted(cable)}, whose stiffness asks for steps of {dt:.2g} s,")
    held = signals.line(0.0, 0.0, 0.0)
    mark = Signal("winch", (("number", next(_NUMBERS)),), held.path)  # a scene of its own, whose paths are written to below
    marked = _with_length(scene, cable, mark)
    row = 2 * list(changes(marked)).index(cable)
    from .session import Session  # what it calls is compiled as it is imported

    session = Session(marked, dt, method="edmc", start=start)
    piece = session._net.lengths.paths.first[row]
    t, paid, speed = [session.t], [0.0], []
    for k in range(steps + 1):
        off = session.state.end_tension(cable, point) - tension
        speed.append(rate * min(max(off / band, -1.0), 1.0))
        if k == steps:
            break
        paths = session._net.lengths.paths
        for breaks, pieces in ((mark.path.breaks, mark.path.coefficients), (paths.breaks[piece:], paths.coefficients[piece:])):
            breaks[0], pieces[0, :2, 0] = t[-1], (paid[-1], speed[-1])
        session.step()
        t.append(session.t)
        paid.append(paid[-1] + (t[-1] - t[-2]) * speed[-1])
    return _with_length(scene, cable, signals.samples(t, paid, ends=(speed[0], speed[-1])))


def _check(scene: Scene, cable: str) -> None:
    """What a winch cannot work with."""
    if scene.cable(cable).inextensible:
        raise InputError(f"A winch keeps the tension of a cable that stretches, but cable {quoted(cable)} has EA=inf.")
    if cable in changes(scene):
        raise InputError(f"A winch must be alone in changing a length, but that of cable {quoted(cable)} changes already.")
    if scene.events or any(one.breaking_tension is not None for one in scene.cables):
        raise InputError("A winch works in a scene without events and without cables that break, but this one has some.")


def _with_length(scene: Scene, cable: str, signal: Signal) -> Scene:
    """The scene with a signal as the length paid out of a cable."""
    from anet_lumped.effects.line_change import LineChange  # scenes without a winch do not import it

    others = [effect for effect in scene.effects if not isinstance(effect, LineChange)]
    paid_out = [pair for effect in scene.effects if isinstance(effect, LineChange) for pair in dict(effect.paid_out).items()]
    return replace(scene, effects=(*others, LineChange((*paid_out, (cable, signal)))))
