"""Random cables partly on the ground: each comes to a stable rest, that of the catenary on the bed."""

import dataclasses

import pytest

from anet_lumped import EquilibriumError
from studies.catalogue import rest_trials
from studies.catalogue.outcome import FAILED, HELD, REFUSED
from studies.catalogue.random_trials import Random
from studies.catalogue.rest_trials import attempt, draw


@pytest.mark.parametrize("number", range(20))
def test_random_cables_come_to_rest(number):
    trial = draw(Random((7, number)))
    assert trial is not None and attempt(trial) == (HELD, "")


def resolved():
    return next(trial for trial in (draw(Random((7, number))) for number in range(20)) if trial.resolved)


def test_a_wrong_tension_fails():
    outcome, why = attempt(dataclasses.replace(resolved(), H=2.0 * resolved().H))
    assert outcome == FAILED and "is right" in why


def test_a_rest_that_is_not_found_fails_where_segments_resolve_it(monkeypatch):
    def give_up(scene):
        raise EquilibriumError("There is none.")

    monkeypatch.setattr(rest_trials, "equilibrium", give_up)
    assert attempt(resolved()) == (FAILED, "There is none.")
    assert attempt(dataclasses.replace(resolved(), a=1e-3))[0] == REFUSED


def test_a_rest_that_is_not_stable_fails(monkeypatch):
    monkeypatch.setattr(
        rest_trials, "equilibrium", lambda scene, find=rest_trials.equilibrium: dataclasses.replace(find(scene), stable=False)
    )
    assert attempt(resolved())[0] == FAILED
