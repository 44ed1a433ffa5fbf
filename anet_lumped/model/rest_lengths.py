"""Rest lengths that change in time: which cables, by which functions of time, and how masses and effects follow."""

import dataclasses

import numpy as np

from anet_lumped.checks import SceneError, quoted
from anet_lumped.effects.effect import PAID_OUT
from anet_lumped.model.net import Lengths
from anet_lumped.prescribed.paths import DEGREE, Harmonic, Path, pack
from anet_lumped.prescribed.signals import Signal
from anet_lumped.prescribed.smoothstep import smoothstep

SHORTEST = 1e-3  # of a cable's length, what may be left of it
LOOKS = 2000  # at the lengths over a run
NO_SLOPES = np.zeros(0, np.int64), np.zeros(0)  # which numbers change with a length, and how


def changes(scene):
    """What the effects of a scene change of rest lengths.

    Returns
    -------
    dict of str and ([(factor, function), ...], [(factor, function), ...])
        For each cable that changes, what is p and what is e; at most one of each.

    Raises
    ------
    SceneError : two functions of time for the same
    """
    found = {}
    for effect in scene.effects:
        for name, quantity, factor, function in effect.length_changes(scene):
            terms = found.setdefault(name, ([], []))[quantity]
            if terms:
                what = "length paid out" if quantity == PAID_OUT else "strain at rest"
                raise SceneError(
                    f"The {what} of a cable must be one function of time, but {type(effect).__name__} gives a second one for cable "
                    f"{quoted(name)}."
                )
            terms.append((factor, function))
    return found


def _path(terms):
    """The sum of at most one function of time times its factor, as a Path in x."""
    if not terms:
        return Path("sum", (), np.zeros(1), np.zeros((1, 7, 3)), np.zeros(0))
    ((factor, function),) = terms
    if not isinstance(function, Signal):
        constant = np.zeros((1, 7, 3))
        constant[0, 0, 0] = factor * function
        return Path("sum", (), np.zeros(1), constant, np.zeros(0))
    path, sine = function.path, function.path.sine
    if sine is not None:
        sine = Harmonic(tuple(factor * a for a in sine.amplitude), *sine[1:])
    return dataclasses.replace(path, coefficients=factor * path.coefficients, sine=sine)


def paths(scene):
    """Lengths paid out and strains at rest of the cables whose length changes, as a list of Path in x."""
    return [_path(terms) for pair in changes(scene).values() for terms in pair if terms]


def table(scene, model, params_of):
    """`Lengths` of a model, which is complete but for them.

    Parameters
    ----------
    scene : Scene
    model : Model
    params_of : callable (Model, Scene) -> numbers of the effects of a scene that differs from that of the model in lengths alone

    Raises
    ------
    SceneError : an effect whose numbers are not linear in a length that is paid out, no length left to begin with, or a cable that
        creeps
    """
    shortest(scene, 0.0, 0.0)
    found = changes(scene)
    creeping = next((name for name in found if scene.cable(name).creeps), None)
    if creeping is not None:
        raise SceneError(f"A cable that creeps keeps its rest length, but that of cable {quoted(creeping)} is to change in time.")
    names, material, nodes, masses, places, slopes = list(found), [], [], [], [], []
    slopes_of = _slopes(scene, model, [name for name in names if found[name][PAID_OUT]], params_of)
    for name in names:
        cable = scene.cable(name)
        spring = 0.0 if cable.inextensible else cable.EA
        material.append([cable.length, spring, cable.dashpot, float(cable.BA is not None)])
        inside, share = np.zeros(0, np.int64), np.zeros(0)
        if found[name][PAID_OUT]:
            inside = model.nodes(name)
            share = np.full(len(inside), 2.0 * cable.half_segment_mass / cable.length)  # of two segments; at an end of one
            share[[0, -1]] *= 0.5
        nodes.append(inside)
        masses.append(share)
        own_places, own_slopes = slopes_of.get(name, NO_SLOPES)
        places.append(own_places)
        slopes.append(own_slopes)
    rows = len(names)
    return Lengths(
        cable=np.array([scene.cable_numbers[name] for name in names], np.int64),
        material=np.array(material, float).reshape(-1, 4),
        paths=pack([_path(terms) for name in names for terms in found[name]]),
        mass=model.mass if rows else np.zeros(0),
        mass_at=_starts(nodes),
        mass_node=_flat(nodes, np.int64),
        mass_slope=_flat(masses, float),
        params=model.effects.params if rows else np.zeros(0),
        param_at=_starts(places),
        param=_flat(places, np.int64),
        param_slope=_flat(slopes, float),
        times=np.full(3, np.nan),
        paid=np.zeros((4, rows)),
        trial=np.zeros((2, rows)),
        path_values=np.zeros((3, 2 * rows, 3)),
    )


def _with_lengths(scene, by):
    """The scene whose cables are longer by what a dict of their names says [m], without what has no forces, as a `LineChange`."""
    cables = [dataclasses.replace(c, length=c.length + by[c.name]) if c.name in by else c for c in scene.cables]
    return dataclasses.replace(scene, cables=cables, effects=[effect for effect in scene.effects if effect.kernels()])


def _slopes(scene, model, names, params_of):
    """How the effects' numbers change with the lengths of cables: for each that is named, which numbers do, and their slopes.

    A number of a node or a segment changes with the cables that meet there. So cables that do not meet are lengthened together,
    each by another share, which tells the cable that a number changes with. One cable at a time would take minutes in a net.
    """
    base, slopes = model.effects.params, {}
    for group in _apart(scene, names):
        found = _slopes_of_group(scene, model, group, params_of)
        slopes |= found if found is not None else {name: _slopes_of_cable(scene, model, name, params_of) for name in group}
    by = {name: (1.0 + k / len(names)) * scene.cable(name).length for k, name in enumerate(names)}
    expected = base.copy()
    for name, (at, own) in slopes.items():
        expected[at] += by[name] * own
    together = params_of(model, _with_lengths(scene, by)) if len(names) > 1 else expected
    with np.errstate(invalid="ignore"):
        if (np.abs(together - expected) > 1e-9 * (np.abs(together) + np.abs(base))).any():  # cables apart share a number
            return {name: _slopes_of_cable(scene, model, name, params_of) for name in names}
    return slopes


def _apart(scene, names):
    """The cables that are named, in groups of cables that meet at no point and at no body."""
    groups, ends = [], []
    for name in names:
        own = {end.split(".")[0] for end in (scene.cable(name).start, scene.cable(name).end)}
        k = next((k for k, taken in enumerate(ends) if not taken & own), len(groups))
        if k == len(groups):
            groups.append([])
            ends.append(set())
        groups[k].append(name)
        ends[k] |= own
    return groups


def _slopes_of_group(scene, model, names, params_of):
    """`_slopes` of cables that do not meet; None if a number changes with several of them, or not linearly."""
    base, lengths = model.effects.params, np.array([scene.cable(name).length for name in names])
    share = 1.0 + np.arange(1, len(names) + 1) / len(names)
    by = [dict(zip(names, factor * lengths, strict=True)) for factor in (1.0, share)]
    with np.errstate(invalid="ignore"):  # an infinite depth stays as it is
        once, more = (params_of(model, _with_lengths(scene, longer)) - base for longer in by)
        at = np.flatnonzero(np.abs(once) > 1e-12 * np.abs(base))
    cable = np.clip(np.rint((more[at] / once[at] - 1.0) * len(names)).astype(np.int64) - 1, 0, len(names) - 1)
    if (np.abs(more[at] - share[cable] * once[at]) > 1e-9 * (np.abs(more[at] + base[at]) + np.abs(base[at]))).any():
        return None
    slopes = once[at] / lengths[cable]
    return {name: (at[cable == k], slopes[cable == k]) for k, name in enumerate(names)}


def _slopes_of_cable(scene, model, name, params_of):
    """`_slopes` of one cable.

    Raises
    ------
    SceneError : an effect whose numbers are not linear in the length
    """
    by, base = scene.cable(name).length, model.effects.params
    params, twice = (params_of(model, _with_lengths(scene, {name: factor * by})) for factor in (1.0, 2.0))
    with np.errstate(invalid="ignore"):  # an infinite depth stays as it is
        bent = np.abs(twice - 2.0 * params + base) > 1e-9 * (np.abs(twice) + np.abs(base))
        at = np.flatnonzero(np.abs(params - base) > 1e-12 * np.abs(base))
    if bent.any():
        e = int(np.searchsorted(model.effects.params_at, np.flatnonzero(bent)[0], side="right")) - 1
        raise SceneError(
            f"Effects beside LineChange must depend on lengths linearly, but {type(model.forces[e]).__name__} does not, of cable "
            f"{quoted(name)}."
        )
    return at, (params - base)[at] / by


def _starts(rows):
    return np.cumsum([0, *map(len, rows)]).astype(np.int64)


def _flat(rows, kind):
    return np.concatenate([*rows, np.empty(0)]).astype(kind)


def of_a_run(lengths):
    """`Lengths` with scratch space of their own."""
    fresh = {name: np.array(getattr(lengths, name)) for name in ("times", "paid", "trial", "path_values")}
    return lengths._replace(**fresh)


def at_time(scene, t):
    """Lengths [m] at a time t [s], or at many (k,), of the cables whose length changes, by name."""
    lengths = {}
    for name, (paid, strain) in changes(scene).items():
        paths_of = _path(paid), _path(strain)
        paid_out, strained = (places(path, t)[:, 0] if np.ndim(t) else path.at(t)[0][0] for path in paths_of)
        lengths[name] = (scene.cable(name).length + paid_out) * (1.0 + strained)
    return lengths


def places(path, t):
    """Positions of a path at many times (k,) [s], (k, 3) [m]: those of `Path.at`, but for rounding."""
    piece = np.maximum(np.searchsorted(path.breaks, t, side="right") - 1, 0)
    tau = np.maximum(t - path.breaks[piece], 0.0)
    q = np.zeros((len(t), 3))
    for i in range(DEGREE, -1, -1):
        q = q * tau[:, None] + path.coefficients[piece, i]
    if path.sine is not None:
        amplitude, omega, phase, ramp = path.sine
        grown = np.ones_like(t) if ramp == 0.0 else smoothstep(np.clip(t / ramp, 0.0, 1.0))[0]
        q += np.outer(grown * np.sin(omega * t + phase), amplitude)
    return q


def shortest(scene, t0, t_end):
    """Smallest length of each cable that changes, from a time to another, by its name [m].

    Raises
    ------
    SceneError : a cable that would be reeled in to less than `SHORTEST` of its length
    """
    smallest = {}
    for name, (paid, strain) in changes(scene).items():
        length = scene.cable(name).length
        terms = _path(paid), _path(strain)
        inside = [path.breaks[(path.breaks > t0) & (path.breaks < t_end)] for path in terms]
        times = np.unique(np.concatenate([np.linspace(t0, t_end, LOOKS if t_end > t0 else 1), *inside]))
        paid_out, strained = (places(path, times)[:, 0] for path in terms)
        left = (length + paid_out) * (1.0 + strained)
        if not left.min() > SHORTEST * length:
            raise SceneError(
                f"A cable must keep at least {SHORTEST:g} of its length, but of cable {quoted(name)} with length={length:g} m "
                f"{left.min():.3g} m are left at t={times[left.argmin()]:.4g} s."
            )
        smallest[name] = float(left.min())
    return smallest


def at_shortest(scene, t0, t_end):
    """The scene with every cable as short as it will be in a run, which is what bounds its steps.

    Raises
    ------
    SceneError : as `shortest`
    """
    smallest = shortest(scene, t0, t_end)
    if not smallest:
        return scene
    cables = [dataclasses.replace(c, length=min(c.length, smallest.get(c.name, c.length))) for c in scene.cables]
    return dataclasses.replace(scene, cables=cables)


def numbers_at(model, t):
    """Masses of the nodes (n,) [kg] and numbers of the effects at a time [s], with the lengths that are paid out then.

    Parameters
    ----------
    model : Model
    t : float [s]
    """
    lengths = model.lengths
    if not len(lengths.cable):
        return model.mass, model.effects.params
    mass, params = model.mass.copy(), model.effects.params.copy()
    for r, (paid, _) in enumerate(changes(model.scene).values()):
        out = _path(paid).at(t)[0][0]
        of_mass = slice(lengths.mass_at[r], lengths.mass_at[r + 1])
        of_params = slice(lengths.param_at[r], lengths.param_at[r + 1])
        mass[lengths.mass_node[of_mass]] += out * lengths.mass_slope[of_mass]
        params[lengths.param[of_params]] += out * lengths.param_slope[of_params]
    return mass, params
