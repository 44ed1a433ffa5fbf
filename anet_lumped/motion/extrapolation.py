"""A higher order from two runs of a scheme, with a step and with its half, extrapolated at the saved times.

The error of a symmetric scheme is a series in even powers of the step, c h^2 + O(h^4), so that

    q = q_(h/2) + (q_(h/2) - q_h)/3

is off by O(h^4) where the motion is smooth; likewise velocities, tensions and energies. Each of the two runs is a run of the scheme
by itself, so that the scheme's statements hold of both: the energy rises in neither, and that of the extrapolated run by its error
at most. Schemes that are extrapolated say so in their record (`Scheme.extrapolated_order`).
`edmc` is symmetric but for its numerical damper (none at rho_inf = 1), which leaves a part of order 3 in stretching.
Source: Gragg, SIAM J. Numer. Anal. 2 (1965) 384; Hairer, Lubich & Wanner, Geometric Numerical Integration, II.4.
"""

from dataclasses import astuple, replace

import numpy as np

from anet_lumped.checks import InputError
from integrators import schemes

WEIGHT = 1.0 / 3.0  # 1/(2^2 - 1)


def method_to_extrapolate(method, rtol, atol):
    """The method to extrapolate; InputError if it, or steps chosen by a tolerance, are not to be extrapolated."""
    able = [name for name in schemes.names(own=True) if schemes.scheme(name).extrapolated_order is not None]
    if method not in (None, *able) or rtol is not None or atol is not None:
        given = "`rtol` or `atol` is given" if method in (None, *able) else f"the method is {method}"
        needed = " or ".join(f'method="{name}"' for name in able)
        raise InputError(f"Argument `extrapolate` needs {needed} with a fixed step, but {given}.")
    return able[0] if method is None else method


def extrapolated(coarse, fine):
    """The run to which two runs of a scheme of order 2 tend.

    Parameters
    ----------
    coarse, fine : Run
        With a step and with half of it, saved at the same times.

    Returns
    -------
    Run
        With the coarse one's step, the work and time of both, and as ``error_estimate`` [m] the largest error of a place in the
        fine run, which is far above that of the extrapolated one. If one of the two did not reach its end, that one.
    """
    for run in (coarse, fine):
        if not run.ok:
            return run
    tension = _extrapolate(coarse.segment_tension, fine.segment_tension)
    for cable in fine.scene.cables:
        if cable.compression == "none":
            own = fine.model.segments(cable.name)
            tension[:, own] = np.maximum(tension[:, own], 0.0)
    return replace(
        fine,
        q=_extrapolate(coarse.q, fine.q),
        v=_extrapolate(coarse.v, fine.v),
        energy=_extrapolate(coarse.energy, fine.energy),
        segment_tension=tension,
        largest_tension=_extrapolated_peaks(coarse.largest_tension, fine.largest_tension),
        crept=None if fine.crept is None else np.maximum(_extrapolate(coarse.crept, fine.crept), 0.0),
        T_max=None if fine.T_max is None else np.maximum(_extrapolate(coarse.T_max, fine.T_max), 0.0),
        shedding=None if fine.shedding is None else _extrapolated_shedding(coarse.shedding, fine.shedding),
        dt=coarse.dt,
        reason=coarse.reason + "; extrapolated with half of it",
        extrapolated=True,
        work=type(fine.work)(*(a + b for a, b in zip(astuple(coarse.work), astuple(fine.work), strict=True))),
        error_growth=np.maximum.accumulate(WEIGHT * np.linalg.norm(fine.q - coarse.q, axis=2).max(axis=1)),
        wall_time=coarse.wall_time + fine.wall_time,
    )


def _extrapolated_peaks(coarse, fine):
    """Largest tensions so far of each cable, which do not fall; None if the finer run has none."""
    if coarse is None or fine is None:
        return fine
    return np.maximum.accumulate(np.maximum(_extrapolate(coarse, fine), 0.0), axis=0)


def _extrapolated_shedding(coarse, fine):
    """Inner states of nodes that shed vortices: mean squares, the last two numbers, are not negative."""
    shedding = _extrapolate(coarse, fine)
    shedding[..., 2:] = np.maximum(shedding[..., 2:], 0.0)
    return shedding


def _extrapolate(coarse, fine):
    return fine + WEIGHT * (fine - coarse)
