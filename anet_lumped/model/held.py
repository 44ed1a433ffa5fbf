"""Which points of a net hang on a fixed or driven point, over cables and bodies."""

from anet_lumped.scene.scene import Free, Scene


def first_unheld(scene: Scene) -> str | None:
    """Name of the first point that nothing holds; None if all of them are held."""
    names = [point.name for point in scene.all_points if not isinstance(point, Free)]
    names += [body.points[0].name for body in scene.bodies if body.pinned is not None and body.pinned_to is None]
    joined = neighbours(scene)
    held = connected(joined, names)
    return next((name for name in joined if name not in held), None)


def neighbours(scene: Scene) -> dict[str, list[str]]:
    """Names of the points that cables and bodies join to each point."""
    joined: dict[str, list[str]] = {point.name: [] for point in scene.all_points}

    def join(name: str, other: str) -> None:
        joined[name].append(other)
        joined[other].append(name)

    for cable in scene.cables:
        join(cable.start, cable.end)
    for body in scene.bodies:
        first = body.points[0].name
        for point in body.points[1:]:
            join(first, point.name)
        if body.pinned_to is not None:
            join(first, body.pinned_to)
    return joined


def connected(joined: dict[str, list[str]], names: list[str]) -> set[str]:
    """Names of all points that `neighbours` connect to some of ``names``, and these."""
    found, left = set(names), list(names)
    while left:
        more = [name for name in joined[left.pop()] if name not in found]
        found.update(more)
        left += more
    return found
