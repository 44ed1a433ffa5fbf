"""The physical effects a scene may ask for, besides the axial elasticity that every cable has.

Each is a class derived from `Effect`, in a file of its own that is imported when the effect is asked for: as
``anet_lumped.effects.Gravity`` or by its name in a scene file, ``REGISTRY["gravity"]``. A user's own effects are made of a law in
plain Python (`anet_lumped.effects.own.decorators`), or derived from `Effect` and registered.
"""

from collections.abc import Iterator, MutableMapping
from importlib import import_module
from typing import Any

from .effect import Effect, check_effect_class


class Registry(MutableMapping):
    """Classes of effects by the name of the effect, or the class's own name where the file of that name holds it.

    Such a file is imported when its effect is looked up. While one thread looks at the classes another may make an effect of its
    own; therefore a loop goes over a list of them.
    """

    def __init__(self, classes: dict[str, str | type]) -> None:
        self.classes = classes

    def __getitem__(self, name: str) -> type:
        kind = self.classes[name]
        return getattr(import_module(f"{__name__}.{name}"), kind) if isinstance(kind, str) else kind

    def __setitem__(self, name: str, kind: str | type) -> None:
        if not isinstance(kind, str):
            check_effect_class(kind)
        self.classes[name] = kind

    def __delitem__(self, name: str) -> None:
        del self.classes[name]

    def __iter__(self) -> Iterator[str]:
        return iter(list(self.classes))

    def __len__(self) -> int:
        return len(self.classes)

    @property
    def library(self) -> list[str]:
        """Names of the effects that come with the library, which are not those of a user's own."""
        return [name for name, kind in list(self.classes.items()) if isinstance(kind, str)]

    @property
    def class_names(self) -> list[str]:
        """Names of the classes."""
        return [kind if isinstance(kind, str) else kind.__name__ for kind in list(self.classes.values())]

    def name_of(self, effect: Any) -> str | None:
        """Return the name that the class of an effect has here, or None; imports nothing."""
        kind = type(effect)
        for name, known in list(self.classes.items()):
            if known is kind or (kind.__module__, kind.__name__) == (f"{__name__}.{name}", known):
                return name
        return None


REGISTRY = Registry(
    {
        "air": "Air",
        "applied_forces": "AppliedForces",
        "axial_damping": "AxialDamping",
        "bending": "Bending",
        "cable_friction": "CableFriction",
        "cable_friction_map": "CableFrictionMap",
        "dashpots": "Dashpots",
        "gravity": "Gravity",
        "ground": "Ground",
        "ground_map": "GroundMap",
        "line_change": "LineChange",
        "load": "Load",
        "moment_curvature": "MomentCurvature",
        "moordyn_bottom": "MoordynBottom",
        "natural_curvature": "NaturalCurvature",
        "obstacles": "Obstacles",
        "temperature": "Temperature",
        "viscous_damping": "ViscousDamping",
        "water": "Water",
    }
)

OWN = ("node_energy", "node_force", "segment_energy", "segment_force")  # make an effect of a user's law
__all__ = ["REGISTRY", "Effect", *OWN, *REGISTRY.class_names]


def __dir__() -> list[str]:
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])


def __getattr__(attribute: str) -> Any:
    if attribute in OWN:
        return getattr(import_module("anet_lumped.effects.own.decorators"), attribute)
    for name, kind in list(REGISTRY.classes.items()):
        if kind == attribute:
            return REGISTRY[name]
    raise AttributeError(f"module {__name__!r} has no attribute {attribute!r}")
