"""The compiled functions of a net, handed to an integrator as its `System`. A run compiles those that its method needs."""

import numpy as np
from numba import types

from anet_lumped.mechanics import notice, prescribe
from anet_lumped.mechanics import observe as observing
from anet_lumped.scene.origin import largest_distance
from integrators.system import System, first_class

NEWTON = ("residual", "direction", "correct", "settle", "adopt", "forget")
"""Functions that only an implicit method needs."""


class _Absent(types.WrapperAddressProtocol):
    """In place of a function that a method does not need: it has no address."""

    def __wrapper_address__(self):
        return 0

    def signature(self):
        raise TypeError("The function of a system that its method does not ask for has no signature.")


def system(model, force=True, newton=True, mean=True, links=False):
    """`System` of a model.

    Parameters
    ----------
    model : Model
    force : bool
        Whether the method needs forces at one time. Else `force` of the system writes no force, and no power.
    newton : bool
        Whether the method has implicit stages. Else the functions in `NEWTON` are absent.
    mean : bool
        Whether the method needs the mean of tensions over stages.
    links : bool
        Whether the cables do not stretch and forces are to keep their lengths.

    Returns
    -------
    System
    """
    if force and not links:
        from anet_lumped.mechanics.force import force as of_forces
    else:
        from anet_lumped.mechanics.no_force import no_force as of_forces
    events = len(model.breaking_tension) > 0
    observe = observing.observe
    if model.sheds:
        from anet_lumped.mechanics.inner_states import observe_and_inner as observe
    own = _of_links() if links else {}
    return System(
        prescribe=own.get("prescribe") or first_class(prescribe.prescribe),
        force=own.get("force") or first_class(of_forces),
        **(_newton() if newton else dict.fromkeys(NEWTON, _Absent())),
        average=_average() if newton and mean else _Absent(),
        remember=own.get("remember") or (_remember(model) if events else _Absent()),
        observe=own.get("observe") or first_class(observe),
        notice=own.get("notice") or first_class(notice.notice_acting if newton else notice.notice_by_law),
        margin=own.get("margin") or (_margin() if events else first_class(observing.no_margin)),
        project=own.get("project") or (_keep_bodies(model) if model.has_bodies else first_class(prescribe.keep)),
        per_mass=np.repeat(1.0 / np.where(model.mass > 0.0, model.mass, np.inf), 3).reshape(
            -1, 3
        ),  # a point without a cable has no mass
        notices=len(model.scene.cables),
        n_free=model.n_free,
        largest=largest_distance(model.scene),
    )


def _newton():
    from anet_lumped.mechanics import newton_step, residual, settle

    functions = {
        "residual": residual.residual,
        "direction": newton_step.direction,
        "correct": newton_step.correct,
        "settle": settle.settle,
        "adopt": newton_step.adopt,
        "forget": newton_step.forget,
    }
    return {name: first_class(function) for name, function in functions.items()}


def _of_links():
    """Functions of a system whose cables do not stretch, by their names in `System`."""
    from anet_lumped.mechanics.links import motion, project

    functions = {
        "prescribe": motion.prescribe_ends,
        "force": motion.force,
        "observe": motion.observe,
        "notice": motion.notice,
        "margin": motion.margin,
        "remember": motion.remember,
        "project": project.project,
    }
    return {name: first_class(function) for name, function in functions.items()}


def _keep_bodies(model):
    if len(model.bodies.joint):
        from anet_lumped.mechanics.bodies.joints import keep_joints

        return first_class(keep_joints)
    from anet_lumped.mechanics.bodies.shape import keep_bodies

    return first_class(keep_bodies)


def _average():
    from anet_lumped.mechanics.mean_tension import average

    return first_class(average)


def _margin():
    from anet_lumped.mechanics.breaking import margin

    return first_class(margin)


def _remember(model):
    if model.sheds:
        from anet_lumped.mechanics.inner_states import remember_with_inner

        return first_class(remember_with_inner)
    from anet_lumped.mechanics.memory import remember

    return first_class(remember)
