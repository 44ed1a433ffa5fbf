"""What it takes to drive a body: against its weight, its inertia, air, water and ground, and all that hangs at it."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from anet_lumped import Body, Cable, Fixed, Free, InputError, Scene, Session, equilibrium, paths, rod_body, simulate
from anet_lumped.effects import Air, Gravity, Ground, Water
from anet_lumped.effects.flow.wind import Uniform
from anet_lumped.prescribed.turning_path import TurningPath

G = 9.81
DOWN = np.array([0.0, 0.0, -G])
CDA, RHO, WIND = np.array([0.5, 0.8, 0.3]), 1.2, np.array([7.0, -2.0, 1.0])


def deck(**given):
    arguments = dict(
        mass=5.0, inertia=(0.3, 0.4, 0.5), centre_of_mass=(0.1, -0.05, 0.2), CdA=tuple(CDA),
        attachments={"hook": (0.3, 0.1, -0.1), "hinge": (-0.3, 0.0, -0.1)},
        path=paths.harmonic((0.0, 0.0, 3.0), (0.1, 0.05, 0.2), frequency=0.8),
        turning=paths.harmonic((0.0, 0.0, 0.0), (0.1, 0.2, 0.05), frequency=0.5),
    ) | given  # fmt: skip
    return Body("deck", **arguments)


def test_it_changes_the_momentum_of_all_that_it_carries():
    """R = d/dt of the momenta of cable and pole, by central differences, + m a of the deck, less all weights and the drag."""
    of_rod = dict(diameter=0.03, mass_per_length=0.6, segments=3)
    pole = rod_body("pole", (-0.3, 0.0, 2.9), (-0.4, 0.1, 2.0), **of_rod, pinned="a", pinned_to="deck.hinge")
    cable = Cable("deck.hook", "w", length=0.8, mass_per_length=0.1, EA=500.0, zeta=0.1, segments=4, diameter=1e-6)
    effects = [Gravity(G), Air(RHO, Uniform(tuple(WIND)))]
    scene = Scene([Free("w", mass=0.4)], [cable], effects, bodies=[deck(), pole])
    run = simulate(scene, 0.15, method="edmc", dt=5e-4, save_every=5e-4)
    free = slice(0, run.model.n_free)
    momentum = np.einsum("n,knx->kx", run.model.mass[free], run.v[:, free])
    rate, inner = np.gradient(momentum, run.t, axis=0)[4:-4], slice(4, -4)
    body, R = scene.body("deck"), run.rotation("deck")[inner]
    centre = TurningPath.of(*body.motion, body.rotation, body.centre_of_mass)
    rate += 5.0 * np.array([centre.at(t)[2] for t in run.t[inner]])
    u = np.einsum("kyx,ky->kx", R, WIND - run.velocity("deck")[inner])
    drag = np.einsum("kxy,ky->kx", R, 0.5 * RHO * CDA * np.abs(u) * u)
    nodes = [run.model.node_of[point.name] for point in scene.body("pole").points]
    of_pole = np.gradient(np.einsum("n,knx->kx", run.model.mass[nodes], run.v[:, nodes]), run.t, axis=0)[inner]
    wind_on_pole = of_pole - run.reaction("pole")[inner] - run.model.mass[nodes].sum() * DOWN
    half = 0.5 * 0.1 * 0.8 / 4
    hook = run.scene.point("deck.hook").path
    rate += half * np.array([hook.at(t)[2] for t in run.t[inner]])
    mass = run.model.mass[free].sum() + 5.0 + half
    found, taut = run.reaction("deck")[inner], run.segment_tension > 0.0
    kinks = np.flatnonzero((taut[1:] != taut[:-1]).any(axis=1))  # of the momenta, which central differences do not see
    smooth = np.abs(np.arange(len(run.t))[inner, None] - kinks).min(axis=1) > 2
    assert smooth.mean() > 0.7
    assert_allclose(found[smooth], (rate - mass * DOWN - drag - wind_on_pole)[smooth], atol=2e-3 * np.abs(found).max())
    assert np.abs(wind_on_pole).max() > 5e-3 * np.abs(found).max() and np.abs(drag).max() > 0.1 * np.abs(found).max()


@pytest.mark.parametrize("depth", [0.0, 0.4, 5.0])
def test_at_rest_it_is_weight_less_buoyancy(depth):
    """A box of 1 x 2 x 0.8 m, by Archimedes; the cable is slack and light."""
    box = deck(
        CdA=(0, 0, 0), hull=(1.0, 2.0, 0.8), centre_of_mass=(0, 0, 0), path=paths.external((0.0, 0.0, 0.4 - depth)), turning=None
    )
    cable = Cable("bed", "deck", length=9.0, mass_per_length=1e-9, EA=1e3, segments=2, diameter=1e-6, compression="linear")
    scene = Scene([Fixed("bed", (0, 0, -9))], [cable], [Gravity(G), Water(1000.0)], bodies=[box])
    rest = equilibrium(scene)
    under = 2.0 * min(depth, 0.8)
    pull = rest.tension("bed-deck")[-1] * np.array([0.0, 0.0, -1.0])
    assert_allclose(rest.reaction("deck"), np.array([0.0, 0.0, (5.0 - 1000.0 * under) * G]) - pull, atol=1e-5)


def test_the_ground_carries_what_is_driven_into_it():
    box = deck(CdA=(0, 0, 0), contact_area=0.5, path=paths.external((0.0, 0.0, 0.09)), turning=None, mass=None, inertia=None)
    cable = Cable("a", "b", length=1.0, mass_per_length=0.1, EA=1e3, segments=2, diameter=0.01)
    scene = Scene(
        [Fixed("a", (0, 0, 2)), Fixed("b", (0.9, 0, 2))],
        [cable],
        [Gravity(G), Ground(0.0, stiffness=1e5, damping=0.0)],
        bodies=[box],
    )
    rest = equilibrium(scene)
    push = 1e5 * 0.5 * 0.01
    assert_allclose(rest.reaction("deck"), (0.0, 0.0, -push), rtol=1e-9, atol=1e-9)
    assert_allclose(rest.reaction("ground"), (0.0, 0.0, push), rtol=1e-9, atol=1e-9)


def test_what_is_driven_from_outside_has_no_known_acceleration():
    cable = Cable("deck.hook", "w", length=0.8, mass_per_length=0.1, EA=500.0, segments=2)
    scene = Scene([Free("w", mass=0.4)], [cable], [Gravity(G)], bodies=[deck(path=paths.external((0, 0, 3)), turning=None)])
    with Session(scene, dt=0.01) as session:
        session.drive("deck", (0.0, 0.0, 3.01))
        session.step()
        with pytest.raises(InputError, match=r'needs the acceleration there, but "deck" is driven from outside'):
            session.state.reaction("deck")
