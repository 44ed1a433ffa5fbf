"""Rests converge to catenaries as segments become shorter, and have the least energy."""

from dataclasses import replace

import numpy as np
import pytest
from hanging import ENDS, MU, G, assorted, hung, potential_energy
from scipy.optimize import minimize, root

from anet_lumped import Fixed, Free, Scene, catenary, equilibrium
from anet_lumped.statics.catenary_net import catenary_net

REFINED = np.array([10, 20, 40, 80, 160])


def slope(errors):
    return np.polyfit(np.log(REFINED), np.log(errors), 1)[0]


@pytest.mark.parametrize("EA", [5.0, 100.0, 1e6])
@pytest.mark.parametrize("end", ["deep", "oblique", "taut"])
def test_converges_to_the_elastic_catenary_at_second_order(end, EA):
    """Places of the nodes and pull on the start; an error below 1e-11, round-off, has no order."""
    truth = catenary((0, 0, 0), ENDS[end], 1.0, EA=EA, mass_per_length=MU)
    shape, pull = [], []
    for n in REFINED:
        state = equilibrium(hung(ENDS[end], EA=EA, segments=int(n)))
        nodes = state.shape("a-b")
        shape.append(np.abs(nodes - truth.point(np.linspace(0, 1, n + 1))).max())
        direction = (nodes[1] - nodes[0]) / np.linalg.norm(nodes[1] - nodes[0])
        on_start = state.tension("a-b")[0] * direction + 0.5 * MU / n * G * np.array([0, 0, -1])
        pull.append(np.abs(on_start - truth.end_forces[0]).max() / np.abs(truth.end_forces[0]).max())
    for errors in (shape, pull):
        assert errors[-1] < 1e-11 or slope(errors) == pytest.approx(-2, abs=0.1)


@pytest.mark.parametrize("name", ["held net", "different heights", "tree", "two junctions", "loop"])
def test_nets_converge_to_nets_of_catenaries_at_second_order(name):
    scene = assorted(1e4)[name]
    free = [p.name for p in scene.points if isinstance(p, Free)]
    places = {p.name: p.at for p in scene.points if isinstance(p, Fixed)}
    near = equilibrium(scene)
    truth = catenary_net(scene, places | {p: near.position(p) for p in free}).points
    errors = []
    for n in REFINED:
        state = equilibrium(Scene(scene.points, [replace(c, segments=int(n)) for c in scene.cables], scene.effects))
        errors.append(max(np.abs(state.position(p) - truth[p]).max() for p in free))
    assert slope(errors) == pytest.approx(-2, abs=0.1)


@pytest.mark.parametrize("name", ["different heights", "two junctions", "loop", "parallel, one longer", "tree"])
def test_minimising_the_energy_finds_the_same_shape(name):
    """From a disturbed start, by a method that knows nothing of forces along cables. Soft and coarse, so that it can."""
    scene = assorted(20.0)[name]
    scene = Scene(scene.points, [replace(c, segments=3) for c in scene.cables], scene.effects)
    state = equilibrium(scene)
    energy, x = potential_energy(scene, state)
    start = x + 0.3 * np.random.default_rng(5).normal(size=x.shape)
    near = minimize(energy, start, jac=True, method="BFGS", options={"gtol": 1e-8, "maxiter": 5000}).x
    found = root(lambda x: energy(x)[1], near, tol=1e-14)  # BFGS ends where differences of energy do, at 1e-7 N
    assert np.abs(found.fun).max() < 1e-11
    assert x == pytest.approx(found.x, abs=1e-9)
