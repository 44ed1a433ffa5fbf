"""Static shape of a scene: first the exact equilibrium of its hanging chains, then the loads that depend on the shape."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from anet_lumped.checks import check_number, quoted
from anet_lumped.mechanics.finite_laws import name_law_that_is_not_finite
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.model.held import connected, neighbours
from anet_lumped.model.model import Model
from anet_lumped.model.reach import overlong, shortfall
from anet_lumped.model.remainder import remainder
from anet_lumped.model.tables import (
    AXIAL_INEXTENSIBLE,
    AXIAL_L0,
    AXIAL_PUSH_SHARE,
    AXIAL_STIFFNESS,
    CABLE_FIRST_SEGMENT,
)
from anet_lumped.results.near_origin import computed_near_origin
from anet_lumped.results.state import State
from anet_lumped.scene.scene import Fixed, Scene, check_scene

from .equilibrium_error import EquilibriumError, NoRestError
from .forces_at_rest import force_of_effects
from .starts import Start, start_state
from .strains import warn_of_strain

TOLERANCE = 1e-12  # of the positions of cable ends, over the cables' lengths
SLACK = 1e-9  # of the load: a smaller tension of a segment is none
NOT_JUDGED = (RuntimeError, np.linalg.LinAlgError)  # raised where a tangent that is not finite is factored
UNSTRETCHED = 1e13  # EA over the load, in place of a cable that does not stretch: a strain of 1e-13

__all__ = ["EquilibriumError", "NoRestError", "equilibrium"]


@computed_near_origin
def equilibrium(scene: Scene, tolerance: float = TOLERANCE, start: Start | None = None) -> State:
    """Static shape of a scene, with driven points where they are at t = 0.

    Parameters
    ----------
    scene : Scene
    tolerance : float
        Error of the positions of cable ends, relative to the cables' lengths. Forces are balanced to rounding.
    start : "equilibrium", "straight", State, dict or None
        First guess, where a scene may have several rests: "straight", a State or the shape of each cable by its name, as for
        `simulate`. Under dead loads there is one rest, whatever the guess. With None, with "equilibrium", and with a guess that
        leads to no rest, the search tries shapes of its own.

    Returns
    -------
    State
        ``residual`` is the largest out-of-balance force over the load carried. ``stable`` is True, except where the user's own
        guess leads to a rest that the surroundings make unstable, such as a rope across a ball.

    Raises
    ------
    NoRestError
        Nothing holds a part of the net; a cable is slack and nothing loads it, so that any shape would do; a cable would
        have to push, or does not stretch and does not reach; a support is under the ground; a law or
        what is computed is not finite.
    EquilibriumError
        No convergence; or no rest that is stable. A NoRestError is one, too.
    InputError
        A start that is not one of these.

    Warns
    -----
    UserWarning
        A cable is stretched to more than three times its length, which no stiffness that is meant leads to.
    """
    check_scene(scene)
    rest = _equilibrium(scene, check_number("tolerance", tolerance, "", "`equilibrium`", sign="positive"), start)
    warn_of_strain(rest, 3)  # the caller of the decorated function
    return rest


def _equilibrium(scene: Scene, tolerance: float = TOLERANCE, start: Start | None = None) -> State:
    """`equilibrium` of a scene near its origin, which warns of nothing."""
    if scene.releases:
        return spread(scene, lambda held: _equilibrium(held, tolerance, start))
    effects = tuple(effect.at_rest() for effect in scene.effects if not effect.no_force_at_rest)
    if effects == scene.effects:
        return _rest(scene, tolerance, start)
    try:
        return replace(_rest(replace(scene, effects=effects), tolerance, start), model=build(scene))
    except EquilibriumError as error:
        error.state = None if error.state is None else replace(error.state, model=build(scene))
        raise


def spread(scene: Scene, of_held: Callable[[Scene], State]) -> State:
    """State of a scene with points that others hold, from that of the scene in which they are one."""
    model = build(scene)
    held = remainder(model, {}, {})

    def at_nodes(own: np.ndarray) -> np.ndarray:
        rows = np.zeros((model.n, own.shape[1]))
        rows[held.node] = own
        return held.follow(model, rows)

    def along(own: np.ndarray) -> np.ndarray:
        rows = np.zeros(model.n_segments)
        rows[held.segment] = own
        return rows

    def of_whole(found: State) -> State:
        crept, T_max = (None if own is None else along(own) for own in (found.crept, found.T_max))
        shed = None if found.shedding is None else at_nodes(found.shedding)
        q, v, tension = at_nodes(found.q), at_nodes(found.v), along(found.segment_tension)
        return replace(found, model=model, q=q, v=v, segment_tension=tension, crept=crept, T_max=T_max, shedding=shed)

    try:
        return of_whole(of_held(held.model.scene))
    except EquilibriumError as error:
        error.state = None if error.state is None else of_whole(error.state)
        raise


def rest_on(net: Any, model: Model, tolerance: float = TOLERANCE) -> State | None:
    """`equilibrium` of a scene near its origin, from its model, on arrays that are there already, a fresh net of it.

    Returns
    -------
    State or None
        None where effects rest in another way than they move, or where bodies do: then `equilibrium` makes arrays of its own.
    """
    scene = model.scene
    if scene.bodies or scene.releases or any(effect.no_force_at_rest or effect.at_rest() != effect for effect in scene.effects):
        return None
    return _rest_of(model, tolerance, None, net)


def _rest(scene: Scene, tolerance: float, start: Start | None) -> State:
    """Static shape of a scene whose effects are `at_rest`."""
    return _rest_of(build(scene), tolerance, start)


def _rest_of(model: Model, tolerance: float, start: Start | None, net: Any = None) -> State:
    """`_rest` of the scene of a model; on the arrays of a fresh ``net`` of it, if there is one."""
    from .hanging_chains import first_guess, solve, unroll  # compiled when a first rest is asked for

    scene = model.scene
    if scene.cables or all(effect.dead_load or effect.no_force_at_rest for effect in model.forces):
        _check_supports(model)
    given = None if start is None or (isinstance(start, str) and start == "equilibrium") else start_state(model, start)
    short = shortfall(scene, 0.0)
    if short is not None:
        raise NoRestError(short.words)
    if not scene.cables:
        return _rest_without_cables(model, tolerance, given)
    if model.has_bodies:
        return _rest_of_bodies(model, tolerance, given)
    q = np.zeros((model.n, 3))
    for point in scene.all_points:
        if isinstance(point, Fixed):
            q[model.node(point.name)] = point.at
    net = fresh_net(model, force=False, newton=False) if net is None else net
    v = np.zeros(q.shape)
    if model.n_driven < model.n:
        from anet_lumped.mechanics.drive import drive  # compiled for scenes with driven points

        drive(0.0, net.address, q, v)
    load, H = dead_load(model, net, q), np.empty((len(model.cable), 3))
    unloaded_scale = float(min([cable.EA for cable in scene.cables if not cable.inextensible], default=1.0))
    total = first_guess(net.address, load, q, unloaded_scale, H)
    scale = total if total > 0 else unloaded_scale
    # a straight cable that does not stretch would have no flexibility at all along itself
    EA = np.array([min(cable.EA, UNSTRETCHED * scale) if cable.inextensible else cable.EA for cable in scene.cables])
    for c in net.lengths.cable:
        if net.axial[c, AXIAL_INEXTENSIBLE] == 0.0:
            EA[c] = net.axial[c, AXIAL_STIFFNESS] * net.axial[c, AXIAL_L0]  # of a segment as long as it is at rest
    closing, balance, noise, iterations = solve(net.address, load, EA, scale, tolerance, H, q)
    if not (closing <= 10 * tolerance and balance <= 1e-10 + noise):
        raise EquilibriumError(
            f"No equilibrium was found in {iterations:.0f} iterations: imbalance {balance:.1e} of the load, tolerance "
            f"{1e-10 + noise:.0e}, and gaps of {closing:.1e} of the cables' lengths, tolerance {10 * tolerance:.0e}; "
            'try a moderate EA, or `simulate` from start="straight".'
        )
    tension, stable = np.empty(model.n_segments), True  # of cables without effects the energy is convex
    least, sum_of_all = unroll(net.address, load, EA, H, q, tension)
    _check_lengths_kept(model, q)
    settled = None
    if model.single_kinds[0]:  # cables of one segment
        settled, sum_of_all = _settle_bars(model, net, q, tension), math.nan
    if len(model.springs) or not all(effect.dead_load or effect.no_force_at_rest for effect in model.forces):
        from anet_lumped.mechanics.required_kernels import require

        from .search import Shape, stable_rest  # compiles what moves, of which dead loads need nothing

        require(net, model, newton=True)
        guess = (
            None if given is None else Shape(np.concatenate([given.q[: model.n_free], q[model.n_free :]]), given.segment_tension)
        )
        try:
            found = stable_rest(model, net, Shape(q.copy(), tension), guess, scale, _calm_shape(scene, tolerance))
        except NOT_JUDGED as error:
            raise _not_judged(model, q, error) from error
        if not found.ends_search:
            _refuse(model, net, found, q)
        (q, tension), balance, stable = found.shape, found.residual, found.stable
        _check_lengths_kept(model, q)
        sum_of_all = math.nan
    elif settled is not None or not least >= SLACK * scale:
        _check_slack(model, tension if settled is None else np.where(settled, np.inf, tension), total, scale)
    finite = math.isfinite(sum_of_all) or (np.isfinite(q).all() and np.isfinite(tension).all())
    if not (finite and math.isfinite(balance)):
        raise NoRestError(
            "The places and tensions of a rest must be finite, but those found are not: lengths, stiffnesses and loads of this "
            "scene differ by more than numbers can hold."
        )
    return State(model, 0.0, q, np.zeros(q.shape), tension, residual=balance, stable=stable)


rest_on_the_way = computed_near_origin(_equilibrium)
"""`equilibrium` of a scene that is tried on the way to another one: it warns of nothing."""


def calm(scene: Scene) -> Scene:
    """The scene without what fluctuates about a mean, turbulence and waves; the same one if nothing does."""
    effects = tuple(effect.steady() for effect in scene.effects)
    return scene if effects == scene.effects else replace(scene, effects=effects)


def _calm_shape(scene: Scene, tolerance: float) -> Any:
    """`Shape` of the rest without turbulence and waves, near which that with them is; None if there are none, or it has no rest."""
    from .search import Shape

    still = calm(scene)
    if still is scene:
        return None
    try:
        found = _rest(still, tolerance, None)
    except EquilibriumError:
        return None
    return Shape(found.q, found.segment_tension)


def _rest_without_cables(model: Model, tolerance: float, given: State | None) -> State:
    """Rest of bodies and points alone, which water or a ground may hold where nothing else does."""
    try:
        return _rest_of_bodies(model, tolerance, given)
    except EquilibriumError:
        _check_supports(model)
        raise


def _rest_of_bodies(model: Model, tolerance: float, given: State | None) -> State:
    """Rest of a scene with bodies that move: from the rest with the bodies held, pseudo-steps move all together."""
    from anet_lumped.mechanics.required_kernels import require

    from .held_bodies import first_shape, with_bodies_held
    from .search import Shape, stable_rest

    scene = model.scene
    net = fresh_net(model, force=False, newton=False)
    total = float(np.linalg.norm(dead_load(model, net, np.zeros((model.n, 3)))[: model.n_free], axis=1).sum())
    try:
        held = _rest(with_bodies_held(scene), tolerance, None) if scene.cables else None
    except EquilibriumError:
        held = None
    q, tension = first_shape(model, held)
    scale = total if total > 0 else float(min([cable.EA for cable in scene.cables if not cable.inextensible], default=1.0))
    require(net, model, newton=True)
    guess = None if given is None else Shape(np.concatenate([given.q[: model.n_free], q[model.n_free :]]), given.segment_tension)
    try:
        found = stable_rest(model, net, Shape(q.copy(), tension), guess, scale)
    except NOT_JUDGED as error:
        raise _not_judged(model, q, error) from error
    if not found.ends_search:
        _refuse(model, net, found, q)
    (q, tension), balance = found.shape, found.residual
    _check_lengths_kept(model, q)
    return State(model, 0.0, q, np.zeros_like(q), tension, residual=balance, stable=found.stable)


def _not_judged(model: Model, q: np.ndarray, error: Exception) -> EquilibriumError:
    """The `EquilibriumError` of a search that came to a tangent which is not finite, from the shape q (n, 3) [m] on."""
    law = name_law_that_is_not_finite(model, [(0.0, q, np.zeros_like(q))])
    return (NoRestError if law else EquilibriumError)(f"{law}No equilibrium was found: {error}")


def _refuse(model: Model, net: Any, found: Any, hanging: np.ndarray) -> None:
    """Raise an `EquilibriumError` that says why the shape that was found is not returned."""
    from .failure_reasons import impossible, reason

    q, tension = found.shape
    effects, why = ", ".join(type(effect).__name__ for effect in model.scene.effects), reason(model, q)
    if not found.balanced:
        law = name_law_that_is_not_finite(model, [(0.0, shape, np.zeros_like(q)) for shape in (hanging, q)])
        left = f"imbalance {found.residual:.1e} of the load, tolerance {found.tolerance:.0e}"
        left = left if math.isfinite(found.residual) else "no step of the search could be solved"
        raise (NoRestError if law or impossible(model, q) else EquilibriumError)(
            f"{law}No equilibrium was found with {effects}: {left}; {why}."
        )
    down = found.down.directions_down
    state = State(model, 0.0, q, np.zeros_like(q), tension, residual=found.residual, stable=False)
    if found.caught:
        from .caught import where_caught

        raise EquilibriumError(
            f"A rest must not be caught between an obstacle and what is under it, but that with {effects} is at "
            f"{where_caught(model, net, q)}; begin from a `start` of `equilibrium` that lies over the obstacle.",
            state,
        )
    raise (NoRestError if impossible(model, q) else EquilibriumError)(
        f"A rest must be stable, but from that with {effects} {down} direction{'s lead' if down > 1 else ' leads'} down, "
        f"and leaving it led to no other; {why}.",
        state,
    )


def dead_load(model: Model, net: Any, q: np.ndarray) -> np.ndarray:
    """(n, 3) force of the dead loads among a model's effects [N]."""
    return force_of_effects(model, net, q, [e for e, effect in enumerate(model.forces) if effect.dead_load])


def _settle_bars(model: Model, net: Any, q: np.ndarray, tension: np.ndarray) -> np.ndarray:
    """Set the tension of each segment between two held nodes to that of its law, in place of the rounded one of the search.

    Returns
    -------
    (n_segments,) bool : whether a segment is between two held nodes
    """
    (a, b), axial = model.ends.T, net.axial[model.cable_of]
    held = (a >= model.n_free) & (b >= model.n_free)
    stretch = np.linalg.norm(q[b] - q[a], axis=1) - axial[:, AXIAL_L0]
    law = axial[:, AXIAL_STIFFNESS] * stretch * np.where(stretch > 0.0, 1.0, axial[:, AXIAL_PUSH_SHARE])
    tension[held] = np.where((axial[:, AXIAL_INEXTENSIBLE] > 0.0) | (law == 0.0), 0.0, law)[held]
    return held


def _check_supports(model: Model) -> None:
    """Every part of the net must hang on a fixed or driven point."""
    if model.unheld is None:
        return
    name, scene = model.unheld, model.scene
    part = connected(neighbours(scene), [name])
    bodies = [body.name for body in scene.bodies]
    others = len(part & {*bodies, *(point.name for point in scene.points)}) - 1  # without the points that make up a body
    raise NoRestError(
        "Every part of a net must hang on a fixed or driven point, but nothing holds "
        f"{'body' if name in bodies else 'free point'} {quoted(name)}"
        + (f" and the {'other' if others == 1 else f'{others} others'} it is tied to" if others else "")
        + '; `simulate` moves it from start="straight" or a State'
        + (", and anet_lumped.flight lets quadrotors carry it." if any(body in part for body in bodies) else ".")
    )


def _check_lengths_kept(model: Model, q: np.ndarray) -> None:
    """Cables that do not stretch must have their lengths in a rest, which supports far from each other may make impossible."""
    words = overlong(model, q)
    if words is not None:
        raise NoRestError(words)


def _check_slack(model: Model, tension: np.ndarray, total: float, scale: float) -> None:
    """A slack cable is a static shape only where its own load shapes it and where it need not push."""
    smallest = np.minimum.reduceat(tension, model.cable[:, CABLE_FIRST_SEGMENT])
    for cable in (model.scene.cables[c] for c in np.flatnonzero(smallest < SLACK * scale).tolist()):
        if total == 0.0:
            raise NoRestError(
                f"Nothing loads the cables: the scene has no gravity, so that the slack cable {quoted(cable.name)} has no shape at "
                "rest; add gravity, or begin from a State."
            )
        pushes, law = cable.compression == "linear" or cable.EA_compression, cable.compression
        if pushes:
            raise NoRestError(
                f'A cable that hangs in equilibrium must be taut, but cable {quoted(cable.name)} with compression="{law}" has '
                f'a slack segment that would push; use compression="none" or "damped", or an even number of segments.'
            )
