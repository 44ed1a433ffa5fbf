"""What a random trial has besides: a cable that creeps, one that is cut, a ground by heights, waves, curvature, a rigid body."""

from dataclasses import replace

from anet_lumped import Body, Cable, CableCut, Free, effects

KINDS = ("nothing",) * 6 + ("creep", "cut", "ground map", "waves", "natural curvature", "body")


def with_extras(pick, trial):
    """The trial with one of `KINDS`; as it is where its cables, points or method do not take that.

    Parameters
    ----------
    pick : random_trials.Pick
    trial : random_trials.Trial
    """
    made = MADE.get(pick.one_of(KINDS))
    return trial if made is None else made(pick, trial)


def _creep(pick, trial):
    stiffer, slow = 10.0 ** pick.number(0.1, 1.5), 10.0 ** pick.number(-3.0, 1.0)
    if trial.method not in (None, "edmc") or trial.rtol is not None:
        return trial
    if any(cable.compression != "none" or cable.tension_strain or cable.inextensible for cable in trial.scene.cables):
        return trial
    cables = [replace(cable, EA_dynamic=stiffer * cable.EA, BA_creep=slow * cable.EA) for cable in trial.scene.cables]
    return replace(trial, scene=replace(trial.scene, cables=cables))


def _cut(pick, trial):
    cable = pick.one_of(tuple(trial.scene.cables))
    cut = CableCut(cable.name, trial.t_end * pick.number(0.0, 1.0), pick.integer(0, cable.segments - 1))
    return replace(trial, scene=replace(trial.scene, events=(*trial.scene.events, cut)))


def _ground_map(pick, trial):
    size, low, friction = pick.integer(2, 5), pick.one_of((-3.0, -1.5, 0.0)), pick.one_of((0.0, 0.5))
    at = [4.0 * i / (size - 1) - 2.0 for i in range(size)]
    heights = [[low + pick.number(-0.5, 0.5) for _ in range(size)] for _ in range(size)]
    return _acting(trial, effects.GroundMap(at, at, heights, friction=friction))


def _waves(pick, trial):
    from anet_lumped.effects.flow.waves import Airy, Jonswap

    height, period = 10.0 ** pick.number(-2.0, -0.5), pick.number(1.5, 8.0)
    wave = Airy(height, period) if pick.integer(0, 1) else Jonswap(height, period, pick.integer(0, 10**6), components=5)
    if any(isinstance(effect, effects.Water) for effect in trial.scene.effects):
        return trial
    return _acting(trial, effects.Water(level=pick.one_of((-0.5, 0.0, 3.0)), g=9.81, waves=[wave]))


def _natural_curvature(pick, trial):
    vector = tuple(pick.number(-3.0, 3.0) for _ in range(3))
    have = {type(effect) for effect in trial.scene.effects}
    more = [] if effects.Bending in have else [effects.Bending()]
    return _acting(trial, *more, effects.NaturalCurvature({cable.name: vector for cable in trial.scene.cables}))


def _body(pick, trial):
    """A box that hangs on a free point by a cable of its own."""
    free = [point for point in trial.scene.points if isinstance(point, Free)]
    mass, side, first = 10.0 ** pick.number(-2.0, 1.0), pick.number(0.05, 0.5), trial.scene.cables[0]
    if not free or first.inextensible:
        return trial
    point = pick.one_of(tuple(free))
    at = (point.at[0], point.at[1], point.at[2] - 0.3)
    box = Body("box", mass=mass, inertia=[mass * side**2 / 6.0] * 3, at=at, attachments={"hook": (0.0, 0.5 * side, 0.5 * side)})
    cable = Cable(
        point.name, "box.hook", length=0.3, mass_per_length=first.mass_per_length, EA=1e4, segments=pick.integer(1, 4),
        compression=first.compression, name="to the box", diameter=first.diameter, EI=first.EI,
    )  # fmt: skip
    scene = replace(trial.scene, bodies=(*trial.scene.bodies, box), cables=(*trial.scene.cables, cable))
    return replace(trial, scene=scene)


def _acting(trial, *more):
    return replace(trial, scene=replace(trial.scene, effects=(*trial.scene.effects, *more)))


MADE = {
    "creep": _creep,
    "cut": _cut,
    "ground map": _ground_map,
    "waves": _waves,
    "natural curvature": _natural_curvature,
    "body": _body,
}
