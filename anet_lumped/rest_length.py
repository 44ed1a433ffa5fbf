"""Rest lengths that change in time: of a segment of a cable of N segments,

    L(t) = (length + p(t))/N (1 + e(t)) ,     k(t) = EA N/(length + p(t)) ,

with the length p paid out and the strain e at rest, and masses and the effects' numbers (weights, coefficients of drag), which are
linear in p. How they depend on it is found by cutting the scene with longer cables, so that no effect need know of it.

In force at one time, or over a step: then the lengths are those of both its ends, and all else is that of its middle.
"""

import dataclasses

import numpy as np
from numba import float64, int64, njit, void

from .chain import END, FIRST_NODE, SEGMENTS, START
from .checks import SceneError
from .effects.signatures import PAID_OUT, as_energy
from .net import Lengths, net_at
from .path_kernel import evaluate
from .paths import Harmonic, Path, pack
from .signals import Signal

_f1, _f2 = float64[::1], float64[:, ::1]
ENERGY = 2  # column of `Effects.address`
SHORTEST = 1e-3  # of a cable's length, what may be left of it
LOOKS = 2000  # at the lengths over a run


def changes(scene):
    """What the effects of a scene change of rest lengths.

    Returns
    -------
    dict of str and ([(factor, function), ...], [(factor, function), ...])
        For each cable that changes, what adds up to p and what adds up to e.
    """
    found = {}
    for effect in scene.effects:
        for name, quantity, factor, function in effect.lengths(scene) if hasattr(effect, "lengths") else ():
            found.setdefault(name, ([], []))[quantity].append((factor, function))
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


def table(scene, model, cut):
    """`Lengths` of a model, which is complete but for them.

    Parameters
    ----------
    scene : Scene
    model : Model
    cut : callable Scene -> Model

    Raises
    ------
    SceneError : an effect whose numbers are not linear in a length that is paid out, or no length left to begin with
    """
    at_shortest(scene, 0.0, 0.0)
    found = changes(scene)
    forces = [effect for effect in scene.effects if not hasattr(effect, "lengths")]
    names, material, nodes, masses, places, slopes = list(found), [], [], [], [], []
    for name in names:
        cable = scene.cable(name)
        spring = 0.0 if cable.inextensible else cable.EA
        material.append([cable.length, spring, cable.dashpot, float(cable.BA is not None)])
        if not found[name][PAID_OUT]:
            of_mass, of_params = np.zeros(model.n), np.zeros(len(model.effects.params))
        else:
            of_mass, of_params = _slopes(scene, model, cable, forces, cut)
        nodes.append(np.flatnonzero(of_mass))
        masses.append(of_mass[nodes[-1]])
        places.append(np.flatnonzero(of_params))
        slopes.append(of_params[places[-1]])
    rows = len(names)
    return Lengths(
        cable=np.array([[cable.name for cable in scene.cables].index(name) for name in names], np.int64),
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
        at=np.full(3, np.nan),
        paid=np.zeros((4, rows)),
        trial=np.zeros((2, rows)),
        place=np.zeros((3, 2 * rows, 3)),
    )


def _slopes(scene, model, cable, forces, cut):
    """How masses [kg/m] and the effects' numbers change with the length of a cable."""

    def longer(by):
        cables = [dataclasses.replace(c, length=c.length + by) if c.name == cable.name else c for c in scene.cables]
        other = cut(dataclasses.replace(scene, cables=cables, effects=forces))
        return other.mass, other.effects.params

    by = cable.length
    (mass, params), (_, twice) = longer(by), longer(2.0 * by)
    base = model.effects.params
    bent = np.abs(twice - 2.0 * params + base) > 1e-9 * (np.abs(twice) + np.abs(base))
    if bent.any():
        e = int(np.searchsorted(model.effects.params_at, np.flatnonzero(bent)[0], side="right")) - 1
        raise SceneError(
            f"Effects beside LineChange must depend on lengths linearly, but {type(forces[e]).__name__} does not, of cable "
            f'"{cable.name}".'
        )
    return (mass - model.mass) / by, np.where(np.abs(params - base) > 1e-12 * np.abs(base), params - base, 0.0) / by


def _starts(rows):
    return np.cumsum([0, *map(len, rows)]).astype(np.int64)


def _flat(rows, kind):
    return np.concatenate([*rows, np.empty(0)]).astype(kind)


def of_a_run(lengths):
    """`Lengths` with scratch space of their own."""
    fresh = {name: np.array(getattr(lengths, name)) for name in ("at", "paid", "trial", "place")}
    return lengths._replace(**fresh)


def at_shortest(scene, t0, t_end):
    """The scene with every cable as short as it will be in a run, which is what bounds its steps.

    Raises
    ------
    SceneError : a cable that would be reeled in to less than `SHORTEST` of its length
    """
    found, shortest = changes(scene), {}
    for name, (paid, strain) in found.items():
        length = scene.cable(name).length
        terms = _path(paid), _path(strain)
        inside = [path.breaks[(path.breaks > t0) & (path.breaks < t_end)] for path in terms]
        times = np.unique(np.concatenate([np.linspace(t0, t_end, LOOKS if t_end > t0 else 1), *inside]))
        left = np.array([(length + terms[0].at(t)[0][0]) * (1.0 + terms[1].at(t)[0][0]) for t in times])
        if not left.min() > SHORTEST * length:
            raise SceneError(
                f'A cable must keep at least {SHORTEST:g} of its length, but of cable "{name}" with length={length:g} m '
                f"{left.min():.3g} m are left at t={times[left.argmin()]:.4g} s."
            )
        shortest[name] = min(length, float(left.min()))
    if not shortest:
        return scene
    cables = [dataclasses.replace(c, length=shortest.get(c.name, c.length)) for c in scene.cables]
    return dataclasses.replace(scene, cables=cables)


@njit(cache=True, error_model="numpy")
def _write(net, paid):
    """Masses and the effects' numbers for lengths paid out (rows,) [m]."""
    lengths, mass, params = net.lengths, net.mass, net.effects.params
    for i in range(lengths.mass.shape[0]):
        mass[i] = lengths.mass[i]
    for i in range(lengths.params.shape[0]):
        params[i] = lengths.params[i]
    for r in range(paid.shape[0]):
        for i in range(lengths.mass_at[r], lengths.mass_at[r + 1]):
            mass[lengths.mass_node[i]] += lengths.mass_slope[i] * paid[r]
        for i in range(lengths.param_at[r], lengths.param_at[r + 1]):
            params[lengths.param[i]] += lengths.param_slope[i] * paid[r]


@njit(cache=True, error_model="numpy")
def _square(net, c):
    """Square of the highest frequency of a segment of cable c, as `Net.law` has it [1/s2]."""
    count, node, largest, before = net.cable[c, SEGMENTS], net.cable[c, FIRST_NODE], 0.0, net.cable[c, START]
    for j in range(count):
        i = node + j if j < count - 1 else net.cable[c, END]
        mobility = (1.0 / net.mass[before] if before < net.n_free else 0.0) + (1.0 / net.mass[i] if i < net.n_free else 0.0)
        largest, before = max(largest, mobility), i
    return net.law[c, 1] * largest


@njit(void(int64, float64, float64, float64), cache=True, error_model="numpy")
def set_lengths(place, before, middle, now):
    """Write `Net.law`, the masses and the effects' numbers of a net: L0 at two times, all else at the one in the middle.

    Parameters
    ----------
    place : int64, address of the net
    before, middle, now : float64 [s]; thrice the same for one time
    """
    net = net_at(place)
    lengths, law = net.lengths, net.law
    at, paid, x, rate = lengths.at, lengths.paid, lengths.place[0], lengths.place[1]
    if at[0] == before and at[1] == middle and at[2] == now:
        return
    at[0], at[1], at[2] = before, middle, now
    for k in range(3):
        evaluate(at[k], lengths.paths, x, rate, lengths.place[2])
        for r in range(lengths.cable.shape[0]):
            c, length, p, e = lengths.cable[r], lengths.material[r, 0], x[2 * r, 0], x[2 * r + 1, 0]
            count, paid[k, r] = net.cable[c, SEGMENTS], p
            L = (length + p) / count
            if k == 0:
                law[c, 8] = L * (1.0 + e)
            elif k == 1:
                law[c, 1] = lengths.material[r, 1] / L
                law[c, 2] = lengths.material[r, 2] * (length / (length + p) if lengths.material[r, 3] > 0.0 else 1.0)
            else:
                paid[3, r] = rate[2 * r, 0]
                law[c, 0], law[c, 7] = L * (1.0 + e), rate[2 * r, 0] / count * (1.0 + e) + L * rate[2 * r + 1, 0]
    _write(net, paid[1])
    for c in range(net.cable.shape[0]):  # a cable beside one that changes shares a mass with it
        law[c, 5] = _square(net, c)


@njit(float64(int64, float64, _f2, _f2, _f1, _f1), cache=True, error_model="numpy")
def energy_between(place, t, q, v, less, more):
    """Kinetic and potential energy [J] of a state with the masses of lengths ``more`` paid out, less that of lengths ``less``.

    Parameters
    ----------
    q, v : (n, 3) float64 [m], [m/s]
    less, more : (rows,) float64 [m]
    """
    net = net_at(place)
    effects, gain = net.effects, 0.0
    for side in range(2):
        _write(net, more if side == 1 else less)
        energy = 0.0
        for i in range(net.n_free):
            energy += 0.5 * net.mass[i] * (v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
        for e in range(effects.address.shape[0]):
            i, j = effects.index_at[e], effects.index_at[e + 1]
            a, b = effects.params_at[e], effects.params_at[e + 1]
            energy += as_energy(effects.address[e, ENERGY])(t, q, effects.index[i:j], effects.params[a:b])
        gain += energy if side == 1 else -energy
    _write(net, net.lengths.paid[1])
    return gain
