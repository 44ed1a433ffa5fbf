"""The one contract for effects: what a physical effect brings, and what it says of itself.

No compiler is imported here, so that a scene without effects needs none.
"""

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

from anet_lumped.checks import SceneError, Vector, check_number, shown

if TYPE_CHECKING:
    import numpy as np

    from anet_lumped.prescribed.signals import Signal

PAID_OUT, STRAIN = 0, 1
"""What a `LengthChange` changes: the length paid out of a whole cable [m], or the strain at rest of all its segments."""


class LengthChange(NamedTuple):
    """A change of a cable's rest length in time: ``factor * function(t)`` is added to ``quantity``, `PAID_OUT` or `STRAIN`."""

    cable: str
    quantity: int
    factor: float
    function: "Signal | float"


class Effect:
    """A physical effect that a scene may have: a frozen dataclass whose fields are its parameters, in SI units.

    The duties of one that is written by hand (laws for one node or one segment need none of this, see `anet_lumped.effects.own`):

    1. It is a frozen dataclass derived from `Effect`, alone in a file that is named as the effect is in the registry
       (`anet_lumped.effects.REGISTRY`) and in a scene file.
    2. `check_parameters` checks each field with the functions of `anet_lumped.checks`, which raise a `SceneError` that says what
       must hold and what was given, and writes the checked values back with `_set`.
    3. An effect that exerts forces returns its compiled functions from `kernels` and the numbers that they read from `table`. One
       that changes how long cables are at rest returns these changes from `length_changes`. An effect does at least one of both.
    4. It says of itself what is true, by the members below. The defaults claim nothing, so that no result depends on them; a claim
       saves work. Claims are compared with the compiled functions at random states whenever a model is built.
    5. If its parameters name cables, `after_break` returns the same effect on what is left of broken cables; if they name bodies
       or points of theirs, `without_bodies` returns it for a scene in which those are held. If it acts at points that it names,
       `of_cables` returns it without these.
    6. `seen_from` returns the same effect in coordinates with another origin, if it can; `at_rest` the effect without its friction;
       `steady` the effect without turbulence and waves.
    7. `example` returns an instance that acts on a given scene, for studies and documentation.

    It knows neither the scene's other effects nor the integrator, and an effect that a scene lacks costs that scene nothing.
    """

    coupled_neighbours: ClassVar[int] = 0
    """How many segments away a node may be for its position or velocity to change the force on another node: 0, 1 or 2."""

    stiff: ClassVar[bool] = False
    """Whether it brings motions faster than the cables' axial ones, so that no stable explicit step is known before a run."""

    is_ground: ClassVar[bool] = False
    """Whether it is what a net rests on, whose reaction a State tells."""

    from_outside: ClassVar[bool] = False
    """Whether a `Session` brings it and gives it its numbers, so that no registry and no scene file has it."""

    jax_traceable: ClassVar[bool] = False
    """Whether JAX can trace the lines of its `force` on arrays, and `table` reads no more of a model than `mass` and `n_free`."""

    @property
    def dead_load(self) -> bool:
        """Whether the force on each node is the same at any position, velocity and time, and zero on nodes that do not move.

        Then `kernels` holds `force` and `energy` alone. Statics take such loads into the first, exact solution.
        """
        return False

    @property
    def no_force_at_rest(self) -> bool:
        """Whether it exerts no force on nodes at rest, wherever they are and at any time. Statics leave it out."""
        return False

    @property
    def linear_in_node_state(self) -> bool:
        """Whether the force on each node is linear in the position and velocity of that node, and depends on no other node.

        Then a whole Newton step leaves none of its force out of balance, and no step is spent on looking.
        """
        return self.dead_load

    @property
    def passive(self) -> bool:
        """Whether it only stores and takes mechanical energy, in motions that any stable step resolves.

        Then the mechanical energy of a run alone tells whether the method added some. Otherwise what dampers and effects took is
        added: a wind gives energy, and a step that pumps a stiff effect is found out although dampers take the energy again.
        """
        return self.dead_load

    @property
    def keeps_energy(self) -> bool:
        """Whether no step of a method that never raises the energy raises it by this effect.

        So it is where the force does over a whole step the work that its energy says, and where there is a force against velocities
        alone. A force that has no energy may put in some.
        """
        return not self.kernels() or self.dead_load or self.no_force_at_rest or "whole_step" in self.kernels()

    @property
    def same_everywhere(self) -> bool:
        """Whether its forces stay the same when the whole scene is moved, with whatever its parameters say of places."""
        return self.dead_load or not self.kernels()

    @property
    def time_scales(self) -> tuple[float, ...]:
        """Times in which what it does changes [s], which steps have to resolve."""
        return ()

    @property
    def sudden(self) -> tuple[tuple[float, float, float], ...]:
        """Times in which its force may come and go while hardly anything moves: from, to, and the shortest time that takes [s]."""
        return ()

    @property
    def signals(self) -> "tuple[Signal, ...]":
        """Functions of time among its parameters, whose corners steps end on."""
        return ()

    @property
    def uniform_acceleration(self) -> Vector:
        """Acceleration that it gives to every moving node alike, such as gravity [m/s2]."""
        return 0.0, 0.0, 0.0

    @property
    def mass_damping_rate(self) -> float:
        """Rate a of its damping proportional to mass, f = -a m v, that adds to every mode alike [1/s]."""
        return 0.0

    def highest_frequency(self, scene: Any) -> float:
        """Highest circular frequency of the motions that it brings to a scene [rad/s]; 0 if it brings none."""
        return 0.0

    def highest_damping_rate(self, scene: Any) -> float:
        """Largest rate c/m of the dampers that it brings to a scene, over the mass that they act on [1/s]; 0 if it brings none."""
        return 0.0

    @property
    def narrowest(self) -> float:
        """Half of the smallest width of what nodes may not go through [m]; infinite if there is no such thing."""
        return math.inf

    def check_parameters(self) -> None:
        """Check the fields and write back what they become, with `_set`; raise a SceneError for what cannot be."""

    def kernels(self) -> Mapping[str, Callable[..., Any]]:
        """Compiled functions by their slot in `signatures.SLOTS`; none for an effect that exerts no force."""
        return {}

    def table(self, model: Any) -> "tuple[np.ndarray, np.ndarray]":
        """Numbers that the compiled functions read, ``index`` (k,) int64 and ``params`` (l,) float64, for a Model.

        Raises
        ------
        SceneError : the scene lacks what the effect needs
        """
        raise NotImplementedError(f"An effect with compiled functions must have a `table`, but {self._called} has none.")

    def length_changes(self, scene: Any) -> Sequence[LengthChange]:
        """Changes of rest lengths in a scene; none for an effect that only exerts forces."""
        return ()

    def on_bodies(self, scene: Any) -> "Effect | None":
        """What the effect does to the rigid bodies of a scene, as an effect with compiled functions of its own; None if nothing."""
        return None

    def on_shedding(self, scene: Any) -> "Effect | None":
        """What the effect does by the vortices of cables that shed some, as an effect with compiled functions of its own."""
        return None

    def inner_states(self, index: "np.ndarray", params: "np.ndarray") -> "np.ndarray":
        """Positions in ``params`` of the inner states, numbers that its `settle` advances from step to step, (m,) int64."""
        import numpy as np

        return np.empty(0, np.int64)

    def after_break(self, pieces: Mapping[str, Sequence[Any]], cables: Sequence[Any]) -> "Effect | None":
        """The same effect once cables have broken, or None if it acts on nothing any more.

        Parameters
        ----------
        pieces : the cables that are left of each broken one, by its name
        cables : all cables that there are now
        """
        return self

    def without_bodies(self, held: Sequence[str]) -> "Effect | None":
        """The same effect where the points named, those of bodies, do not move; or None if it acts on nothing else."""
        return self

    def of_cables(self) -> "Effect | None":
        """The effect on what is spread over cables, without what it does at points; None if it acts at points alone."""
        return self

    def at_rest(self) -> "Effect":
        """The effect for the search for a rest: without friction, which holds nodes that creep wherever they are."""
        return self

    def steady(self) -> "Effect":
        """The effect without what fluctuates about a mean, turbulence and waves, in which a rest is easier to find."""
        return self

    def seen_from(self, origin: Vector, scene: Any) -> "Effect | None":
        """The effect of a scene, in coordinates whose origin lies at ``origin`` (3,) [m] of today's; None if it cannot say.

        A scene far from its origin is computed near it, where places have more digits, unless one of its effects returns None.
        """
        return self if self.same_everywhere else None

    @classmethod
    def example(cls, scene: Any) -> Self:
        """An instance that acts on a scene. To be overridden where fields have no defaults or the defaults do not fit."""
        return cls()

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if "__post_init__" in vars(cls):
            raise TypeError(f"An effect must check its parameters in `check_parameters`, but {cls.__name__} has `__post_init__`.")

    def __post_init__(self) -> None:
        self.check_parameters()
        self.check_kernels()

    def check_kernels(self) -> None:
        """Refuse compiled functions that are missing, unknown, of another signature or able to raise.

        Raises
        ------
        SceneError : names the effect, the entry and what must hold
        """
        if self.kernels():
            from .kernel_checks import check_kernels  # with the compiler

            check_kernels(self)
        elif type(self).length_changes is Effect.length_changes:
            raise SceneError(f"An effect must have `kernels` or `length_changes`, but {self._called} has neither.")

    @property
    def _called(self) -> str:
        """How messages call it."""
        return f"effect {type(self).__name__}"

    def _check_numbers(self, **kinds: tuple[str, str]) -> None:
        """Check fields that are numbers, each by its unit and sign as `check_number` takes them, and write them back."""
        for name, (unit, sign) in kinds.items():
            self._set(**{name: check_number(name, getattr(self, name), unit, self._called, sign=sign)})

    def _set(self, **values: Any) -> None:
        """Write fields of the frozen dataclass while it is being made."""
        for name, value in values.items():
            object.__setattr__(self, name, value)


def check_effect_class(kind: Any) -> None:
    """Refuse what is no class of effects.

    Raises
    ------
    SceneError : not derived from `Effect`, or no frozen dataclass of its own
    """
    if not (isinstance(kind, type) and issubclass(kind, Effect)):
        raise SceneError(f"An effect must be a class derived from anet_lumped.effects.Effect, but it is {shown(kind)}.")
    if not dataclasses.is_dataclass(kind) or not kind.__dataclass_params__.frozen:  # type: ignore[attr-defined]
        raise SceneError(f"An effect must be a frozen dataclass, @dataclass(frozen=True), but {kind.__name__} is none.")


def height_under(scene: Any) -> float:
    """Height of a plane that a scene's cables reach, for `Effect.example`: 0.6 of the longest below the lowest support [m]."""
    return float(min(z for _, _, z in scene.supports) - 0.6 * scene.longest)


def names_left(name: str, pieces: Mapping[str, Sequence[Any]]) -> list[str]:
    """Names of what is left of a cable, for `Effect.after_break`."""
    return [piece.name for piece in pieces[name]] if name in pieces else [name]
