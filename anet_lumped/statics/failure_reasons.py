"""Reasons for which no rest was found: properties of the scene, or of the last shape, that make a rest hard or impossible."""

import numpy as np

from anet_lumped.checks import quoted
from anet_lumped.effects.bending import Bending
from anet_lumped.effects.ground import Ground
from anet_lumped.model.model import Model
from anet_lumped.scene.scene import Driven, Fixed

SHARP = 60.0  # degrees between adjacent segments: a shape with a larger angle is not resolved
FOLDED = 120.0  # degrees between adjacent segments: a cable that is stiff in bending and has a larger angle is folded
SHRUNK = 0.5  # of the rest length: a segment that bending has made shorter has collapsed


def reason(model: Model, q: np.ndarray) -> str:
    """The likely reason, and what to change: a clause without a full stop.

    Parameters
    ----------
    model : Model
    q : (n, 3) float64 [m], the shape that the search ended in
    """
    return (
        impossible(model, q)
        or _fluctuations(model)
        or _sharp_turn(model, q)
        or 'try `simulate` from start="straight", or another `start` of `equilibrium`'
    )


def _fluctuations(model):
    if all(effect.steady() == effect for effect in model.scene.effects):
        return ""
    return 'turbulence or waves may leave no rest at a time; begin with start="calm", the rest without them'


def impossible(model: Model, q: np.ndarray) -> str:
    """The reason for which no stable rest is possible, or none makes sense; "" if there is no such reason."""
    return _under_the_ground(model) or bends_but_does_not_push(model, q)


def _under_the_ground(model):
    for effect in model.scene.effects:
        if isinstance(effect, Ground):
            normal = np.array(effect.normal) / np.linalg.norm(effect.normal)
            for point in model.scene.all_points:
                if isinstance(point, Fixed | Driven):
                    at = point.path.at(0.0)[0] if isinstance(point, Driven) else point.at
                    height = float(normal @ np.asarray(at, float))
                    thickest = max(
                        (cable.diameter or 0.0 for cable in model.scene.cables if point.name in (cable.start, cable.end)),
                        default=0.0,
                    )
                    if height < effect.height - thickest:
                        return (
                            f"support {quoted(point.name)} must not be under the ground, but it is at a height of {height:g} m "
                            f"and the ground at {effect.height:g} m"
                        )
    return ""


def bends_but_does_not_push(model: Model, q: np.ndarray) -> str:
    """The reason, if a cable that cannot push is folded, or has segments that bending has shortened; else "".

    The energy of such a shape falls until segments have vanished: without a push of its segments the cable cannot unfold.
    """
    for cable, shortest, sharpest in _bent_without_pushing(model, q):
        if shortest < SHRUNK or sharpest > FOLDED:
            what = f"shrinks to {shortest:.1e} of its length" if shortest < SHRUNK else f"folds by {sharpest:.0f} degrees"
            return (
                f"a cable that is stiff in bending must push, but cable {quoted(cable.name)} with "
                f'compression="{cable.compression}" does not, and a segment of it {what}; use compression="linear"'
            )
    return ""


def _bent_without_pushing(model, q):
    """Cables that have bending stiffness and do not push: each with its shortest segment over L0, and sharpest turn [degrees]."""
    if not any(isinstance(effect, Bending) for effect in model.scene.effects):
        return
    for cable in model.scene.cables:
        if cable.EI > 0.0 and cable.segments > 1 and cable.compression != "linear" and not cable.EA_compression:
            length, turn = _lengths_and_turns(model, q, cable)
            yield cable, float(length.min()) / cable.L0, float(turn.max())


def _lengths_and_turns(model, q, cable):
    """Length of each segment of a cable [m], and the angles between next ones [degrees]."""
    d = np.diff(q[model.nodes(cable.name)], axis=0)
    length = np.linalg.norm(d, axis=1)
    unit = d / np.maximum(length, 1e-12 * cable.L0)[:, None]
    return length, np.degrees(np.arccos(np.clip((unit[1:] * unit[:-1]).sum(axis=1), -1.0, 1.0)))


def _sharp_turn(model, q):
    worst, where = SHARP, ""
    for cable in model.scene.cables:
        turn = _lengths_and_turns(model, q, cable)[1]
        if len(turn) and turn.max() > worst:
            worst = float(turn.max())
            where = (
                f"the curvature of a cable must not be finer than its segments, but cable {quoted(cable.name)} turns by "
                f"{worst:.0f} degrees at node {int(np.argmax(turn)) + 1}, between segments of {cable.L0:.3g} m; "
                "give it more segments"
            )
    return where
