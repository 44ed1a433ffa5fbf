"""Effects by their names."""

import sys
import threading

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


@pytest.mark.parametrize("look", [list, lambda registry: registry.name_of(Gravity()), lambda registry: registry.library])
def test_effects_may_be_made_while_another_thread_looks_for_one(monkeypatch, look):
    stop, kinds = threading.Event(), {f"kind_{i}": "Kind" for i in range(5000)}
    monkeypatch.setattr(REGISTRY, "classes", kinds | REGISTRY.classes)

    def make():
        while not stop.is_set():
            REGISTRY.classes["another"] = "Another"
            del REGISTRY.classes["another"]

    maker = threading.Thread(target=make)
    maker.start()
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        for _ in range(30):
            assert look(REGISTRY)
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        maker.join()
