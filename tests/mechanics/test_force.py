"""Forces, energies and tensions of whole nets: against a slow twin, and the force as the slope of the energy."""

import naive
import numpy as np
import pytest
from systems import mesh, nets, scatter

from anet_lumped import Cable, Fixed, Free, Scene
from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.effects.laws.axial import SWITCHES
from anet_lumped.mechanics.bindings import system
from anet_lumped.mechanics.fresh_net import fresh_net
from anet_lumped.model.build import build
from anet_lumped.results.state import segment_tensions


@pytest.mark.parametrize("compression", SWITCHES)
def test_forces_energies_and_tensions_of_nets(compression):
    """The kernels of a net against its slow twin, and internal forces that sum to zero with no net torque."""
    effects = [Gravity(3.0, (1, -2, 2)), ViscousDamping(0.7)]
    for name, scene in {**nets(compression=compression, effects=effects), "mesh": mesh(3, 4, 3)}.items():
        model, rng = build(scene), np.random.default_rng(len(name))
        compiled, net = system(model), fresh_net(model)
        np.testing.assert_allclose(model.mass, naive.masses(model), rtol=1e-15)
        q, v = scatter(model, rng), rng.normal(size=(model.n, 3))
        f, power, energy = np.full((model.n, 3), np.nan), np.full(3, np.nan), np.zeros(3)
        compiled.force(0.0, q, v, net.address, f, power)
        compiled.observe(0.0, q, v, net.address, np.empty(model.n_segments), energy)
        expected, by_dampers, by_effects, put_in = naive.force(model, q, v)
        prescribed_moves = model.n_driven < model.n
        # sums of a few dozen rounded forces of up to 1e4 N
        np.testing.assert_allclose(f, expected, atol=1e-10, err_msg=name)
        assert power[:2] == pytest.approx([by_dampers, by_effects], rel=1e-12)
        assert power[2] == (pytest.approx(put_in, rel=1e-12) if prescribed_moves else 0.0)
        np.testing.assert_allclose(energy[:3], naive.energies(model, q, v), rtol=1e-12)
        inner = f - naive.external(model, q, v)
        np.testing.assert_allclose(inner.sum(axis=0), 0.0, atol=1e-10)
        np.testing.assert_allclose(np.cross(q, inner).sum(axis=0), 0.0, atol=1e-10)
        T, at = segment_tensions(model, q, v), iter(naive.tensions(model, q, v))
        for cable in scene.cables:
            expected = [next(at) for _ in range(cable.segments)]
            np.testing.assert_allclose(T[model.segments(cable.name)], expected, rtol=1e-10, atol=1e-10)


def test_force_of_trails_that_meet():
    """Trails of one group that pass one node at once, and lanes that wait: a star, whose segments all end at its hub."""
    names = [f"r{i}" for i in range(11)]
    scene = Scene(
        [Fixed("s", (0, 0, 0)), Free("hub"), *map(Free, names)],
        [
            Cable(a, "hub", segments=1, length=1.0 + 0.1 * i, mass_per_length=0.1, EA=300.0 + i, zeta=0.1, compression="damped")
            for i, a in enumerate(["s", *names])
        ],
    )
    model = build(scene)
    compiled, net, rng = system(model), fresh_net(model), np.random.default_rng(5)
    q, v = scatter(model, rng), rng.normal(size=(model.n, 3))
    f, power = np.zeros((model.n, 3)), np.zeros(3)
    compiled.force(0.0, q, v, net.address, f, power)
    assert len(net.trails.run) > 0 and len(net.trails.other_cables) == 0
    expected, by_dampers, *_ = naive.force(model, q, v)
    np.testing.assert_allclose(f, expected, atol=1e-11)  # sums of a dozen forces of 1e3 N
    assert power[0] == pytest.approx(by_dampers, rel=1e-12)


def test_force_is_the_slope_of_the_energy():
    """-dE/dq of a net without dampers, by central differences."""
    for compression in SWITCHES:
        model = build(nets(compression=compression, zeta=0.0)["wheel"])
        compiled, net, rng = system(model), fresh_net(model), np.random.default_rng(3)
        q, v = scatter(model, rng), np.zeros((model.n, 3))
        f, power, d = np.zeros((model.n, 3)), np.zeros(3), rng.normal(size=(model.n, 3))

        def energy(x):
            out = np.zeros(3)
            compiled.observe(0.0, q + x * d, v, net.address, np.empty(model.n_segments), out)  # noqa: B023
            return out[1] + out[2]

        compiled.force(0.0, q, v, net.address, f, power)
        h = 1e-5  # m; energies of 1e3 J leave 1e-13/h = 1e-8, a cubic remainder of k h^2 = 1e-6 of the slope
        assert -(energy(h) - energy(-h)) / (2 * h) == pytest.approx(np.sum(f * d), rel=1e-5)
