"""A platform that carries the points of a scene which are driven from outside."""

from collections.abc import Sequence
from dataclasses import replace

from anet_lumped.checks import SceneError, Vector, check_names, check_number, look_up, quoted, shown
from anet_lumped.prescribed.six_motions import SixMotions, point_paths

from .scene import Driven, Point, Scene, check_scene

LATER = 1.01  # of the time that it moves, when it stops: a run of that time shall not end with velocities that are zero


def driven_from_outside(scene: Scene) -> tuple[str, ...]:
    """Names of the points whose path is `paths.external`, such as the coupled points of a MoorDyn file."""
    return tuple(point.name for point in scene.points if isinstance(point, Driven) and point.path.kind == "external")


def platform(
    scene: Scene, motions: SixMotions, t_end: float, *, points: Sequence[str] | None = None, origin: Vector = (0.0, 0.0, 0.0)
) -> Scene:
    """Return the scene with points that move as those of one rigid platform; what is pinned to them follows.

    Parameters
    ----------
    scene : Scene
    motions : SixMotions
        Of the platform about its place at rest, at which the points are where the scene has them.
    t_end : float [s]
        How long it moves; a hundredth of this time later it stands still.
    points : sequence of str or None
        Names of the points that it carries, whose path is `paths.external`; all such points if None.
    origin : (3,) array_like [m]
        About which it turns.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError : no such points
    """
    check_scene(scene)
    t_end = check_number("t_end", t_end, "s", "the motion of a platform", sign="positive")
    if not isinstance(motions, SixMotions):
        raise SceneError(f"The motions of a platform must be SixMotions, but they are {shown(motions)}.")
    able, by_name = driven_from_outside(scene), {point.name: point for point in scene.points if isinstance(point, Driven)}
    names = check_names("points", points, "a platform") or able
    if not names:
        raise SceneError(
            "A platform must carry points that are driven from outside, with the path paths.external, but there are none."
        )
    for name in names:
        look_up("point", name, {point.name: point for point in scene.points})
        if name not in able:
            raise SceneError(f"A platform must carry points with the path paths.external, but {quoted(name)} has another.")
    starts = {name: by_name[name].path.at(0.0)[0].tolist() for name in names}
    moved = dict(zip(starts, point_paths(motions, list(starts.values()), LATER * t_end, origin), strict=True))
    every: list[Point] = [Driven(point.name, moved[point.name]) if point.name in moved else point for point in scene.points]
    bodies = [replace(body, at=None) if body.is_jointed else body for body in scene.bodies]  # where their joints now start
    return replace(scene, points=every, bodies=bodies)
