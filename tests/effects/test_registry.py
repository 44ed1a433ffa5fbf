"""Effects by their names."""

import pytest

import anet_lumped.effects
from anet_lumped.effects import REGISTRY, Gravity, ViscousDamping


def test_effects_are_found_by_name_and_not_imported_before():
    assert {REGISTRY["gravity"], REGISTRY["viscous_damping"]} == {Gravity, ViscousDamping} <= set(REGISTRY.values())
    assert REGISTRY.name_of(Gravity()) == "gravity" and REGISTRY.name_of(object()) is None
    known = [REGISTRY.classes[name] for name in REGISTRY.library]
    assert {kind if isinstance(kind, str) else kind.__name__ for kind in known} < set(anet_lumped.effects.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'Gravitas'"):
        anet_lumped.effects.Gravitas  # noqa: B018
