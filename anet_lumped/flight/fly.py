"""A flight: a scene whose bodies are quadrotors, under a controller, step by step."""

import logging
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from anet_lumped.checks import InputError, check_number, nearest, quoted, shown
from anet_lumped.motion.law_steps import LawSteps
from anet_lumped.motion.session import Session, SessionError
from anet_lumped.results.auditing import audited
from anet_lumped.results.run import STATUS, Run, RunInterrupt
from anet_lumped.scene.scene import Scene, check_scene
from integrators.system import INTERRUPTED

from .compiled_law import Wrench
from .fall import fallen
from .hovering import hovering
from .pilot import Pilot
from .quadrotor import THESIS_QUADROTOR, Quadrotor
from .rotors import Rotors
from .seen import Seen, Sensors

LOG = logging.getLogger(__name__)
STATES = 400  # saved if the caller does not say how many
TOLD_EVERY = 5.0  # [s], between two words on how far a flight is
ORDER = 1  # of a flight in its step, of any method: the pulls that a controller sees are those of the last step
AT_ONCE = 250  # steps that are taken at most before Python looks whether Ctrl-C has come


def quadrotors_of(scene: Scene, quadrotors: Quadrotor | Mapping[str, Quadrotor]) -> list[Quadrotor]:
    """The Quadrotor of each body that moves freely, in the order of the scene.

    Raises
    ------
    InputError : a body without one, one without a body, or another mass than the body's
    """
    names = [body.name for body in scene.bodies if not body.is_driven]
    found = dict.fromkeys(names, quadrotors) if isinstance(quadrotors, Quadrotor) else quadrotors
    if not isinstance(found, Mapping):
        raise InputError(f"Argument `quadrotors` must be a Quadrotor or a dict of them by body, but it is {shown(quadrotors)}.")
    for name in found:
        if name not in names:
            raise InputError(
                f"Argument `quadrotors` must name bodies that move freely, but it names {quoted(name)}"
                + (nearest(name, names) or ".")
            )
    for name in names:
        if not isinstance(found.get(name), Quadrotor):
            raise InputError(
                f"Every body that moves freely must have a Quadrotor, but body {quoted(name)} has {shown(found.get(name))}."
            )
        if not np.isclose(found[name].mass, scene.body(name).mass or 0.0, rtol=1e-6):
            raise InputError(
                f"A body must have the mass of its Quadrotor, {found[name].mass:g} kg, but {quoted(name)} has "
                f"{scene.body(name).mass:g} kg."
            )
    return [found[name] for name in names]


def fly(
    scene: Scene, controller: Callable[[Seen], Wrench], t_end: float, *, dt: float = 0.004,
    quadrotors: Quadrotor | Mapping[str, Quadrotor] = THESIS_QUADROTOR, sensors: Sensors | None = None,
    save_every: float | None = None, audit: bool | float = False, **session: Any,
) -> Run:  # fmt: skip
    """Fly a scene from where its quadrotors hover.

    Each step looks at the state, asks the controller, lets the rotors turn and marches the scene, with thrust, torque and drag held
    over the step in the axes of the bodies. The rotors begin as the controller first tells them.

    Parameters
    ----------
    scene : Scene
        All its bodies that move freely are quadrotors. They start where it has them, in the attitude in which they hover.
    controller : callable(Seen) -> Wrench, with ``reset()`` if it remembers anything
    t_end : float [s]
    dt : float [s]
    quadrotors : Quadrotor, or dict of them by the name of their body
    sensors : Sensors or None, what the controller sees of the state; None: all, exactly
    save_every : float or None [s], time between saved states, rounded to steps; None saves about 400
    audit : bool or float [m]
        Fly again with half the step and compare, as `simulate` does. The controller is reset and asked as often as before, and what
        it tells is held for two steps: what differs is the motion, not how often it is steered. Costs two to three times the
        flight, or seven.
    session : keyword arguments of `Session`; with a ``start``, bodies begin as the scene has them

    Returns
    -------
    Run
        Its status is not "done" if a step failed; it holds what was done by then. It is "audit failed" if its audit found more than
        is allowed. A warning says if the quadrotors fall.

    Raises
    ------
    InputError : an argument out of its range, or no controller
    RunInterrupt : Ctrl-C; with what was flown as its ``run``
    """
    check_scene(scene)
    t_end, dt = (check_number(name, x, "s", "fly", sign="positive") for name, x in (("t_end", t_end), ("dt", dt)))
    save_every = None if save_every is None else check_number("save_every", save_every, "s", "fly", sign="positive")
    if not isinstance(audit, bool):
        audit = check_number("audit", audit, "m", "fly", sign="positive")
    for name, value in (("dt", dt), ("save_every", save_every)):
        if value is not None and value > t_end * (1.0 + 1e-9):
            raise InputError(f"Argument `{name}` must not exceed t_end={t_end:g} s, but it is {value:g} s.")
    if not callable(controller):
        raise InputError(
            "Argument `controller` must be a callable from Seen to Wrench, such as `geometric` makes, but it is "
            f"{shown(controller)}: without one nothing holds the quadrotors up."
        )
    crew = quadrotors_of(scene, quadrotors)
    if "start" not in session:
        ready = hovering(scene)
        scene, session = ready.scene, session | {"start": ready.shapes}
    asked = _Asked(scene, controller, sensors, crew, round(t_end / dt), dt, save_every, session)
    run = _flown(asked, 1)
    if audit and run.ok:
        allowed = None if audit is True else float(audit)
        again = asked._replace(session=session | {"method": run.method})
        run = audited(run, lambda parts: _flown(again, parts), ORDER, allowed)
    said = fallen(run)
    return replace(run, warnings=(*run.warnings, said)) if said else run


class _Asked(NamedTuple):
    """A flight as it is asked for, see `fly`; ``steps`` of ``dt`` [s], at each of which the controller is asked."""

    scene: Scene
    controller: Callable[[Seen], Wrench]
    sensors: Sensors | None
    crew: list[Quadrotor]
    steps: int
    dt: float
    save_every: float | None
    session: dict[str, Any]


def _flown(asked: _Asked, parts: int) -> Run:
    """The flight with each step in so many parts.

    Raises
    ------
    RunInterrupt : Ctrl-C; with what was flown as its ``run``
    """
    scene, controller, sensors, crew, steps, dt, save_every, session = asked
    every = max(1, round(steps / STATES if save_every is None else save_every / dt))
    march = Session(scene, dt / parts, **session)
    for one in (controller, sensors):
        if one is not None and hasattr(one, "reset"):
            one.reset()
    steps_of = LawSteps(march, Pilot(controller, sensors, Rotors(crew, dt), len(scene.free_points)), parts)
    reached, status, message = (march.state, march.energy), "done", ""
    rows, events = [reached], None
    begin = told_at = time.perf_counter()
    try:
        for k in range(0, steps, every):
            if (now := time.perf_counter()) - told_at > TOLD_EVERY:
                told_at = now
                LOG.info("step %d of %d, %.0f s left if the others take as long", k, steps, (now - begin) * (steps - k) / k)
            for first in range(k, last := min(k + every, steps), AT_ONCE):
                steps_of.march(parts * min(AT_ONCE, last - first))
                reached = march.state, march.energy
            rows.append(reached)
    except SessionError as failure:
        status, message = failure.status, str(failure)
    except KeyboardInterrupt:  # perhaps within a step, so that the session holds no state: the last one reached was copied
        if rows[-1] is not reached:
            rows.append(reached)
        status, events = STATUS[INTERRUPTED], reached[0].events
        message = f"{march.method} with dt={march.dt:.3g} s was stopped by the user at t={reached[0].t:.4g} s."
    wall_time = time.perf_counter() - begin
    run = Run(
        model=march.model, t=np.array([state.t for state, _ in rows]), q=np.array([state.q for state, _ in rows]),
        v=np.array([state.v for state, _ in rows]), energy=np.array([energy for _, energy in rows]), method=march.method,
        dt=march.dt, reason=march.reason, status=status, message=message, work=march.work, wall_time=wall_time,
        segment_tension=np.array([state.segment_tension for state, _ in rows]), events=march.events if events is None else events,
        pushed=True,
        crept=None if rows[0][0].crept is None else np.array([state.crept for state, _ in rows]),
        T_max=None if rows[0][0].T_max is None else np.array([state.T_max for state, _ in rows]),
        shedding=None if rows[0][0].shedding is None else np.array([state.shedding for state, _ in rows]),
    )  # fmt: skip
    if status == STATUS[INTERRUPTED]:
        raise RunInterrupt(run)
    return run
