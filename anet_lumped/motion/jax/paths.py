"""Prescribed motions of driven points in JAX: what `paths.pack` lays out, evaluated for all points at once."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from anet_lumped.prescribed.paths import DEGREE
from anet_lumped.prescribed.smoothstep import smoothstep


class Paths(eqx.Module):
    """Several paths as arrays of one length: pieces (p, k), of which those that a path lacks begin at infinity."""

    breaks: jax.Array  # (p, k) [s]
    coefficients: jax.Array  # (p, k, 7, 3) [m/s^i]
    amplitude: jax.Array  # (p, 3) [m], zero for a path without a sine
    wave: jax.Array  # (p, 3): omega [rad/s], phase [rad], ramp [s]

    @staticmethod
    def of(paths):
        """Lay out a list of `anet_lumped.prescribed.paths.Path`."""
        most = max((len(path.breaks) for path in paths), default=1)
        breaks, coefficients = np.full((len(paths), most), np.inf), np.zeros((len(paths), most, DEGREE + 1, 3))
        amplitude, wave = np.zeros((2, len(paths), 3))
        for p, path in enumerate(paths):
            pieces = len(path.breaks)
            breaks[p, :pieces], coefficients[p, :pieces] = path.breaks, path.coefficients
            if path.sine is not None:
                amplitude[p], wave[p] = path.sine.amplitude, path.sine[1:]
        return Paths(*map(jnp.asarray, (breaks, coefficients, amplitude, wave)))

    def at(self, t, stop):
        """Places and velocities (p, 3) [m], [m/s] at time t [s].

        Beyond the time ``stop``, and at it, the piece before it goes on.
        """
        begun = (self.breaks <= t) & (self.breaks < stop)
        piece = jnp.maximum(jnp.sum(begun, axis=1) - 1, 0)
        path = jnp.arange(len(piece))
        tau, c = (t - self.breaks[path, piece])[:, None], self.coefficients[path, piece]
        held = ~begun[:, :1]
        tau = jnp.where(held, 0.0, tau)
        q, v = c[:, DEGREE], jnp.zeros_like(c[:, 0])
        for i in range(DEGREE - 1, -1, -1):  # Horner's scheme for the polynomial and its derivative
            v = v * tau + q
            q = q * tau + c[:, i]
        v = jnp.where(held, 0.0, v)
        omega, phase, ramp = self.wave.T[:, :, None]
        per_ramp = jnp.where(ramp > 0.0, 1.0 / jnp.where(ramp > 0.0, ramp, 1.0), 0.0)
        s = jnp.where(ramp > 0.0, jnp.clip(t * per_ramp, 0.0, 1.0), 1.0)
        e, slope, _ = smoothstep(s)
        de = slope * per_ramp
        sine, cosine = jnp.sin(omega * t + phase), jnp.cos(omega * t + phase)
        return q + self.amplitude * e * sine, v + self.amplitude * (de * sine + e * omega * cosine)
