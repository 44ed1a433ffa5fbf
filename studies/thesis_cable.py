"""The thesis's cable, and what its energy says of the stability of a step: nothing puts energy in, so that it may only fall.

The cable of 1 m and 0.1 kg hangs from its upper end. About rest it is disturbed by random velocities, too small to matter unless
they grow; let go from the horizontal it cracks like a whip.
"""

import warnings
from dataclasses import replace

import numpy as np

from anet_lumped.effects import Gravity, ViscousDamping
from anet_lumped.motion.simulate import simulate
from anet_lumped.motion.stability import step_limit, top_modes
from anet_lumped.scene.scene import Cable, Fixed, Free, Scene
from anet_lumped.statics.equilibrium import equilibrium
from integrators import schemes

LENGTH, MASS, SEGMENTS, GRAVITY = 1.0, 0.1, 20, 9.81  # the thesis's cable [m], [kg], -, [m/s^2]
SEGMENT_MASS = MASS / SEGMENTS  # [kg]
WEIGHT_ENERGY = MASS * GRAVITY * LENGTH  # [J]
FOUND_EA = MASS * GRAVITY / (2 * 0.1)  # makes the hung cable 1.1 m long [N]: EA = m g/2 eps; study `length_error`
FOUND_K = FOUND_EA * SEGMENTS / LENGTH  # [N/m]
CORD_EA = 9e3  # 3 mm nylon [N]
DISTURBANCE = 1e-10  # energy put into random velocities about rest, over WEIGHT_ENERGY
REST_TIME, REST_STEPS = 2.0, 200  # [s] and steps at least
REST_GROWTH = 1e3  # unstable if the energy rises by more, over that of the disturbance
WHIP_TIME = 1.2  # [s]; the cable cracks at about 0.55 s
WHIP_RISE = 0.1  # unstable if the energy rises by more, over what the whole swing is worth
SEED = 1  # of the disturbance


def hung(EA, damper=0.0, *, segments=SEGMENTS, compression="none", rate=0.0, tip=None):
    """The thesis's cable, held at its upper end.

    Parameters
    ----------
    EA : float [N]
    damper : float
        c of each segment [N s/m].
    rate : float
        Damping by the environment [1/s].
    tip : (3,) [m]
        Where the loose end starts, for `start="straight"`.

    Returns
    -------
    Scene
    """
    cable = Cable(
        "top", "tip", length=LENGTH, mass_per_length=MASS / LENGTH, EA=EA, BA=damper * LENGTH / segments,
        segments=segments, compression=compression,
    )  # fmt: skip
    effects = [Gravity(GRAVITY)] + [ViscousDamping(rate)] * (rate > 0)
    return Scene(points=[Fixed("top", (0.0, 0.0, 0.0)), Free("tip", at=tip)], cables=[cable], effects=effects)


def disturbed(scene, axes=(1.0, 1.0, 1.0)):
    """Rest with random velocities along `axes`, so that every mode has its share of an energy too small to matter.

    Returns
    -------
    State
    """
    rest = equilibrium(scene)
    n_free, mass = rest.model.n_free, rest.model.mass
    v = np.zeros_like(rest.q)
    v[:n_free] = np.random.default_rng(SEED).normal(size=(n_free, 3)) * axes
    v *= np.sqrt(DISTURBANCE * WEIGHT_ENERGY / (0.5 * mass[:, None] * v**2).sum())
    return replace(rest, v=v)


def energy_rise(run):
    """Largest mechanical energy of a run without driven points less that at its start, inf if it diverged [J]."""
    energy = run.energy[:, :3].sum(axis=1)
    return float(energy.max() - energy[0]) if run.reached_end and np.isfinite(energy).all() else np.inf


def rest_growth(scene, scheme, dt, steps=None, start=None):
    """Run about rest.

    Returns
    -------
    growth : float
        Rise of energy over that of the disturbance.
    at_once : bool
        The energy was largest right after the first steps: it overshot and fell, it did not grow.
    ended : str
    """
    duration = steps * dt if steps else max(REST_TIME, REST_STEPS * dt)
    run = quietly(scene, duration, method=scheme, dt=dt, start=start or disturbed(scene))
    at_once = run.reached_end and int(run.energy[:, :3].sum(axis=1).argmax()) <= 1
    return energy_rise(run) / (DISTURBANCE * WEIGHT_ENERGY), at_once, run.status


def whip_rise(scene, scheme, dt, duration=WHIP_TIME):
    """Run released from horizontal: rise of energy over what the swing is worth, and how the run ended."""
    run = quietly(scene, duration, method=scheme, dt=dt, start="straight")
    return energy_rise(run) / (WEIGHT_ENERGY / 2), run.status


def quietly(scene, t_end, **settings):
    """`simulate` without its warning that the step is too long, which is what is asked here."""
    with warnings.catch_warnings(action="ignore", category=UserWarning):
        return simulate(scene, t_end, **settings)


def explicit_schemes(**wanted):
    """Names of the explicit schemes of this package."""
    return schemes.names(own=True, explicit=True, **wanted)


def implicit_schemes():
    """Names of the implicit schemes of this package."""
    return schemes.names(own=True, explicit=False)


def label(scheme):
    """What figures and texts call a scheme."""
    return schemes.scheme(scheme).label


def predicted_step(scheme, scene):
    """Largest stable step of the scene's top axial mode [s]."""
    (mode,) = top_modes(scene).values()
    return float(step_limit(scheme, mode.omega, mode.zeta))
