"""Compiled functions of toy effects, right and wrong, and effects that are made of them."""

from dataclasses import make_dataclass
from functools import cached_property

import numpy as np
from numba import njit

from anet_lumped import Cable, Fixed, Free, Scene
from anet_lumped.effects import REGISTRY, Effect, Gravity
from anet_lumped.effects.signatures import (
    ENERGY_SIGNATURE,
    FORCE_SIGNATURE,
    INERTIA_SIGNATURE,
    TANGENT_SIGNATURE,
    WHOLE_STEP_SIGNATURE,
)

NAME = "toy"


class Later:
    """A function that Numba compiles when an effect is made of it; every worker imports this file, and few need what is in it."""

    def __init__(self, function, signature, options):
        self.function, self.signature, self.options = function, signature, options

    @cached_property
    def compiled(self):
        return njit(self.signature, **self.options)(self.function)


def later(signature=None, **options):
    """`numba.njit`, but later."""
    return lambda function: Later(function, signature, options)


@later(FORCE_SIGNATURE)
def pull(t, q, v, index, params, f):
    """-q on each of the nodes that ``params`` has a number for."""
    for i in range(params.shape[0]):
        for x in range(3):
            f[i, x] -= params[i] * q[i, x]
    return 0.0


@later(TANGENT_SIGNATURE)
def pull_tangent(t, q, v, index, params, c_q, c_v, D, near, far):
    for i in range(min(params.shape[0], D.shape[0])):
        for x in range(3):
            D[i, x, x] += c_q * params[i]


@later(ENERGY_SIGNATURE)
def pull_energy(t, q, index, params):
    total = 0.0
    for i in range(params.shape[0]):
        for x in range(3):
            total += 0.5 * params[i] * q[i, x] ** 2
    return total


@later(ENERGY_SIGNATURE)
def none(t, q, index, params):
    return 0.0


@later(TANGENT_SIGNATURE)
def level(t, q, v, index, params, c_q, c_v, D, near, far):
    pass


@later(FORCE_SIGNATURE)
def still(t, q, v, index, params, f):
    return 0.0


@later(FORCE_SIGNATURE)
def constant(t, q, v, index, params, f):
    f[0, 0] += 1.0
    return 0.0


@later(ENERGY_SIGNATURE)
def of_constant(t, q, index, params):
    return -q[0, 0]


@later(FORCE_SIGNATURE)
def dragged(t, q, v, index, params, f):
    f[0, 0] -= v[0, 0]
    return v[0, 0] * v[0, 0]


@later(FORCE_SIGNATURE)
def pushed(t, q, v, index, params, f):
    f[0, 0] += v[0, 0]
    return -v[0, 0] * v[0, 0]


@later(FORCE_SIGNATURE)
def growing(t, q, v, index, params, f):
    f[0, 0] += t
    return 0.0


@later(FORCE_SIGNATURE)
def on_supports(t, q, v, index, params, f):
    f[f.shape[0] - 1, 2] += 1.0
    return 0.0


@later(FORCE_SIGNATURE)
def paid(t, q, v, index, params, f):
    f[0, 0] += 1.0
    return 1.0


@later(FORCE_SIGNATURE)
def cubic(t, q, v, index, params, f):
    f[0, 0] -= q[0, 0] ** 3
    return 0.0


@later(FORCE_SIGNATURE)
def joined(t, q, v, index, params, f):
    f[0, 0] -= q[0, 0] - q[1, 0]
    return 0.0


@later(TANGENT_SIGNATURE)
def wide(t, q, v, index, params, c_q, c_v, D, near, far):
    near[0, 0, 0, 0] -= c_q


@later(TANGENT_SIGNATURE)
def wider(t, q, v, index, params, c_q, c_v, D, near, far):
    far[0, 0, 0, 0] -= c_q


@later(WHOLE_STEP_SIGNATURE)
def step(t, h, damper, base, q, index, params, f, D, near, far):
    return 0.0, 0.0


@later(WHOLE_STEP_SIGNATURE)
def wide_step(t, h, damper, base, q, index, params, f, D, near, far):
    near[0, 0, 0, 0] -= 1.0
    return 0.0, 0.0


@later(WHOLE_STEP_SIGNATURE)
def giving_step(t, h, damper, base, q, index, params, f, D, near, far):
    return -1.0, 0.0


@later(INERTIA_SIGNATURE)
def light(t, q, index, params, A):
    pass


@later(TANGENT_SIGNATURE)
def viscous(t, q, v, index, params, c_q, c_v, D, near, far):
    D[0, 0, 0] += c_v


LIVE = {"force": pull, "tangent": pull_tangent, "energy": pull_energy}
DEAD = {"force": constant, "energy": of_constant}


def made(kernels, numbers=(), **members):
    """An effect of the user's own, registered: compiled functions, their numbers, and what it says of itself."""
    table = np.zeros(0, np.int64), np.array(numbers, float)
    if isinstance(kernels, dict):
        kernels = {slot: kernel.compiled if isinstance(kernel, Later) else kernel for slot, kernel in kernels.items()}
    namespace = {"kernels": lambda self: kernels, "table": lambda self, model: table} | members
    kind = make_dataclass("Toy", [], bases=(Effect,), namespace=namespace, frozen=True)
    REGISTRY[NAME] = kind
    return kind()


def hung(*effects, segments=1, mass=0.2):
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, zeta=0.1, segments=segments)
    return Scene([Fixed("a", (0, 0, 0)), Free("b", mass=mass, at=(0, 0, -1))], [cable], [Gravity(), *effects])
