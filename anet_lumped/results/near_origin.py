"""Computations of scenes that stand far from the origin, made about an origin near them; results come in the user's coordinates."""

import inspect
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np

from anet_lumped.checks import quoted
from anet_lumped.model.build import build
from anet_lumped.scene.origin import Near, near_origin
from anet_lumped.scene.scene import Scene

from .run import Run, State

P = ParamSpec("P")
T = TypeVar("T")


def computed_near_origin(compute: Callable[P, T]) -> Callable[P, T]:
    """Decorate a computation from a scene, and from a ``start`` if it has one, that returns a State or a Run.

    Also the States and Runs that its exceptions hold come back in the coordinates of the scene that was given.
    """
    signature = inspect.signature(compute)

    @wraps(compute)
    def computed(*args: P.args, **kwargs: P.kwargs) -> T:
        scene = args[0] if args else kwargs.get("scene")
        if not isinstance(scene, Scene):
            return compute(*args, **kwargs)  # which refuses it
        near = near_origin(scene)
        if near.fixed_by is not None:
            warnings.warn(_lost_digits(near), stacklevel=2)
        if near.scene is scene:
            return compute(*args, **kwargs)
        given = signature.bind(*args, **kwargs)
        given.arguments["scene"] = near.scene
        if "start" in given.arguments:
            given.arguments["start"] = _start_about(given.arguments["start"], near.origin)
        try:
            return _seen_by_user(compute(*given.args, **given.kwargs), scene, near)
        except BaseException as error:
            for name, value in vars(error).items():
                setattr(error, name, _seen_by_user(value, scene, near))
            raise

    return computed


def _seen_by_user(result: Any, scene: Scene, near: Near) -> Any:
    """A State or Run of the scene near its origin as one of the user's; anything else as it is."""
    if isinstance(result, State | Run) and result.scene == near.scene:
        return replace(result, model=build(scene), q=result.q + near.origin, q_near=result.q)
    return result


def _start_about(start: Any, origin: Any) -> Any:
    """A State, or shapes of cables by their names, about another origin; what is neither is refused later."""
    if isinstance(start, State) and _is_shape(start.q):
        q, kept = np.asarray(start.q, float), start.q_near
        if kept is None or kept.shape != q.shape or (kept + origin != q).any():
            kept = q - origin
        return replace(start, q=kept, q_near=None)
    if isinstance(start, Mapping):
        return {cable: shape - np.array(origin) if _is_shape(shape) else shape for cable, shape in start.items()}
    return start


def _is_shape(value: Any) -> bool:
    try:
        return np.asarray(value).dtype.kind != "c" and np.shape(np.asarray(value, float))[1:] == (3,)
    except (TypeError, ValueError, OverflowError):
        return False


def _lost_digits(near: Near) -> str:
    """Warning about places that are rounded, with the tension that rounding stands for."""
    scene = near.scene
    free = [point.at for point in scene.free_points if point.at is not None]
    free += [body.at for body in scene.bodies if body.at is not None]
    places = np.abs(scene.supports or free)
    rounding = float(np.spacing(places.max()))
    cable = max((cable for cable in scene.cables if not cable.inextensible), key=lambda cable: cable.stiffness, default=None)
    tension = "" if cable is None else f", which is {cable.stiffness * rounding:.1g} N in a segment of cable {quoted(cable.name)}"
    return (
        f"The scene is {places.max():.3g} m from its origin, where places are rounded to {rounding:.1g} m{tension}; its origin "
        f"cannot be moved nearer, because effect {type(near.fixed_by).__name__} depends on places."
    )
