"""What the compiled functions of every effect look like, so that any of them fits any slot.

Of every effect:

force(t, q, v, index, params, f) -> power
    adds the force on each node to f (n, 3) [N] and returns the power [W] that it takes out of the mechanical energy (0 for a
    force that has an energy).
energy(t, q, index, params) -> energy
    potential energy [J], 0 where there is none.

Of some:

tangent(t, q, v, index, params, c_q, c_v, D, near, far)
    subtracts c_q df/dq + c_v df/dv [N/m] from the blocks of the moving nodes: D (n_free, 3, 3) of each with itself; near
    (n_segments, 2, 3, 3) of the two ends of each segment, row of the first node and column of the second, and back; far
    (n_segments, 2, 3, 3) of the first end of each segment and the second end of the next one of its cable, likewise. Only an
    effect that says that it ``couples`` nodes finds near (1) and far (2) there. Blocks of prescribed nodes are not asked for.
    An effect without it is a dead load: its force depends on neither place nor velocity, acts on moving nodes alone and has an
    energy.

between(t, h, base, q, index, params, f, D, near, far) -> dissipated
    adds the force that acts over a whole step of law ``LAW_BETWEEN`` from places ``base`` to ``q``, so that with the dissipated
    energy [J] >= 0 that it returns the step can not raise the energy, and subtracts its derivative in q from the blocks. Effects
    without it are taken at the middle of the step.
inertia(t, q, index, params, A)
    adds to the added masses A (n_free, 3, 3) [kg] of the moving nodes.

An effect whose parameters name cables or points has a method of_pieces(pieces, cables) besides, which returns the effect of the
same kind, or None, once cables have broken: ``pieces`` has the cables left of each broken one by its name, ``cables`` all.

Effects that exert no force but change what cables are long at rest have no compiled functions; instead

lengths(scene) -> list of (cable, quantity, factor, function)
    names of cables, and factor times a function of time (a Signal or a number) that is added to the length paid out of the whole
    cable [m] (`PAID_OUT`) or to the strain at rest of all its segments (`STRAIN`); ``signals`` are those functions of time.

``index`` (int64) and ``params`` (float64) are the effect's own numbers. A net holds the addresses of the functions of the
effects it has, as plain integers and 0 for none, so that its type is the same whatever they are: `as_force` and its like make
an address callable in compiled code.
"""

from numba import types

from anet_lumped.compiled.addresses import address, callable_at

_f1, _f2, _f3 = (types.Array(types.float64, d, "C") for d in (1, 2, 3))
_i1 = types.Array(types.int64, 1, "C")

FORCE = types.float64(types.float64, _f2, _f2, _i1, _f1, _f2)
_f4, _f8 = types.Array(types.float64, 4, "C"), types.float64
TANGENT = types.void(_f8, _f2, _f2, _i1, _f1, _f8, _f8, _f3, _f4, _f4)
ENERGY = _f8(_f8, _f2, _i1, _f1)
BETWEEN = _f8(_f8, _f8, _f2, _f2, _i1, _f1, _f2, _f3, _f4, _f4)
INERTIA = types.void(_f8, _f2, _i1, _f1, _f3)
PAID_OUT, STRAIN = 0, 1  # what an effect changes of a rest length
SLOTS = ("force", "tangent", "energy", "between", "inertia")


def names_left(name, pieces):
    """Names of what is left of a cable, for ``of_pieces``."""
    return [piece.name for piece in pieces[name]] if name in pieces else [name]


def addresses(effect):
    """Addresses of an effect's compiled functions in the order of `SLOTS`; 0 for those that it does not have."""
    kernels = effect.kernels()
    return [address(kernels[slot]) if slot in kernels else 0 for slot in SLOTS]


as_force, as_tangent, as_energy = callable_at(FORCE), callable_at(TANGENT), callable_at(ENERGY)
as_between, as_inertia = callable_at(BETWEEN), callable_at(INERTIA)
