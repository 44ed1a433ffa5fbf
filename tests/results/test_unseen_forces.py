"""Blows and gusts that begin and end within a step: the run tells them, and the default takes steps that see them."""

import math

import numpy as np
import pytest

from anet_lumped import Cable, Fixed, Free, Scene, simulate
from anet_lumped.effects import Air, Gravity, node_energy, node_force
from anet_lumped.effects.flow.wind import Gust, Uniform

L, M, MU = 4.0, 5.0, 1e-3
IMPULSE = 5.0  # [N s] of a blow, which swings a weight of 5 kg on 4 m of line by 0.64 m


@node_force
def blow_by_force(t, q, v, impulse, at, lasts):
    s = (t - at) / lasts
    f = 2.0 * impulse / lasts * math.sin(math.pi * s) ** 2 if 0.0 < s < 1.0 else 0.0
    return f, 0.0, 0.0


@node_energy
def blow_by_energy(t, q, impulse, at, lasts):
    s = (t - at) / lasts
    f = 2.0 * impulse / lasts * math.sin(math.pi * s) ** 2 if 0.0 < s < 1.0 else 0.0
    return -f * q[0]


@node_energy
def bed(t, q, k):
    return 0.5 * k * q[2] * q[2] if q[2] < 0.0 else 0.0


def weight_on_a_line(effect, **payload):
    cable = Cable("top", "m", length=L, mass_per_length=MU, EA=1e5, segments=4, zeta=0.1, diameter=1e-4)
    return Scene([Fixed("top", (0, 0, 0)), Free("m", mass=M, **payload)], [cable], [Gravity(9.81), effect])


def swing(impulse):
    """Largest way aside of a pendulum that a blow sets off [m]: sin of cos(angle) = 1 - v^2/2gL."""
    return L * math.sqrt(1.0 - (1.0 - (impulse / M) ** 2 / (2.0 * 9.81 * L)) ** 2)


@pytest.mark.parametrize("law", [blow_by_force, blow_by_energy])
@pytest.mark.parametrize("lasts", [0.01, 0.004])
def test_the_default_sees_a_blow_that_begins_and_ends_within_its_first_step(law, lasts):
    """Steps of 20 ms kept "4 micrometres", without a warning, where the weight stood still; 4 mm and a tenth of the line's mass."""
    run = simulate(weight_on_a_line(law(IMPULSE, 3.3, lasts, points=["m"])), t_end=5.0)
    assert run.ok and np.abs(run.position("m")[:, 0]).max() == pytest.approx(swing(IMPULSE), abs=5e-3)


@pytest.mark.parametrize("at", [3.304, 0.001])
def test_a_given_step_tells_what_a_blow_that_it_does_not_see_would_do(at):
    """J/m sqrt(L/g), which is the swing but for the sine of its angle; the start of a run is no exception."""
    run = simulate(weight_on_a_line(blow_by_force(IMPULSE, at, 0.005, points=["m"])), t_end=5.0, method="edmc", dt=0.02)
    assert np.abs(run.position("m")[:, 0]).max() < 1e-6
    assert run.error_estimate == pytest.approx(swing(IMPULSE), rel=0.1)
    assert run.error[run.t < at - 0.02].max(initial=0.0) < 1e-6


def test_a_gust_shorter_than_a_step():
    """Of 8 ms to 120 m/s: the impulse rho/2 CdA u^2 3/4 rise, the mean of sin^4 being 3/8."""
    gust = Air(wind=[Uniform((0.0, 0.0, 0.0)), Gust((120.0, 0.0, 0.0), 3.311, 0.004)])
    scene = weight_on_a_line(gust, CdA=0.2)
    impulse = 0.5 * 1.225 * 0.2 * 120.0**2 * 0.75 * 0.004
    given = simulate(scene, t_end=5.0, method="edmc", dt=0.02)
    assert given.error_estimate == pytest.approx(swing(impulse), rel=0.15)
    run = simulate(scene, t_end=5.0)
    assert run.ok and np.abs(run.position("m")[:, 0]).max() == pytest.approx(swing(impulse), rel=0.05)


@pytest.mark.parametrize(
    "effect, sudden",
    [
        (blow_by_force(1.0, 1.0, 1.0), True), (bed(1e3), False), (Air(wind=Uniform((1.0, 0.0, 0.0))), False),
        (Air(wind=Gust((1.0, 0.0, 0.0), 1.0, 2.0)), True),
    ],
)  # fmt: skip
def test_which_effects_are_looked_at(effect, sudden):
    assert bool(effect.sudden) == sudden


def test_a_force_that_steps_resolve_leaves_next_to_nothing():
    """A gust of a hundred steps, and a law that turns once a second, which 50 steps take (omega h)^2/24 = 7e-4 of."""

    @node_force
    def turning(t, q, v, size):
        return size * math.sin(2.0 * math.pi * t), 0.0, 0.0

    from anet_lumped.results.unseen_forces import unseen_forces

    for effect in (turning(5.0, points=["m"]), Air(wind=Gust((40.0, 0.0, 0.0), 1.0, 1.0))):
        run = simulate(weight_on_a_line(effect, CdA=0.1), t_end=4.0, method="edmc", dt=0.02)
        assert unseen_forces(run)[-1] < 2e-3 * np.abs(run.position("m")[:, 0]).max()
