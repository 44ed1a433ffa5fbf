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


def test_effects_may_be_made_while_another_thread_looks_for_one(monkeypatch):
    """Made here each time that a name is put into the name of a module, or is passed in a loop."""

    class Name(str):
        def __format__(self, how):
            make()
            return str(self)

    def make():
        REGISTRY.classes[f"another_{len(REGISTRY.classes)}"] = "Another"

    monkeypatch.setattr(REGISTRY, "classes", {Name("first"): "First", Name("second"): "Second"} | REGISTRY.classes)
    assert REGISTRY.name_of(Gravity()) == "gravity"
    for _ in REGISTRY:
        make()
    assert len(REGISTRY) > 20
