"""Order 4 from order 2: two runs of `edmc`, with a step and with its half, extrapolated at the saved times.

The error of a symmetric scheme is a series in even powers of the step, c h^2 + O(h^4), so that

    q = q_(h/2) + (q_(h/2) - q_h)/3

is off by O(h^4) where the motion is smooth; likewise velocities, tensions and energies. Neither run knows of the other, so that
what is stated of the scheme holds of both: the energy rises in neither, and that of the extrapolated run by its error at most.
`edmc` is symmetric but for its numerical damper (none at rho_inf = 1), which leaves a part of order 3 in stretching.
Source: Gragg, SIAM J. Numer. Anal. 2 (1965) 384; Hairer, Lubich & Wanner, Geometric Numerical Integration, II.4.
"""

from dataclasses import astuple, replace

import numpy as np

METHOD, ORDER = "edmc", 4
SAID = "; extrapolated with half of it"  # of the step, at the end of the reason of a run
WEIGHT = 1.0 / 3.0  # 1/(2^2 - 1)


def check(method, rtol, atol):
    """The method to extrapolate; ValueError where it or chosen steps are not to be extrapolated."""
    if method not in (None, METHOD) or rtol is not None or atol is not None:
        given = "`rtol` or `atol` is given" if method in (None, METHOD) else f"the method is {method}"
        raise ValueError(f'Argument `extrapolate` needs method="{METHOD}" with a fixed step, but {given}.')
    return METHOD


def is_extrapolated(run):
    """Whether a run came of two."""
    return run.reason.endswith(SAID)


def extrapolated(coarse, fine):
    """The run that two runs of a scheme of order 2 tend to.

    Parameters
    ----------
    coarse, fine : Run
        With a step and with half of it, saved at the same times.

    Returns
    -------
    Run
        With the coarse one's step, the work and time of both, and as ``error_estimate`` [m] the largest error of a place in the
        fine run, which it should be far below. If one of the two did not reach its end, that one.
    """
    for run in (coarse, fine):
        if not run.ok:
            return run
    tension = _beyond(coarse.segment_tension, fine.segment_tension)
    for cable in fine.scene.cables:
        if cable.compression == "none":
            own = fine.model.segments(cable.name)
            tension[:, own] = np.maximum(tension[:, own], 0.0)
    return replace(
        fine,
        q=_beyond(coarse.q, fine.q),
        v=_beyond(coarse.v, fine.v),
        energy=_beyond(coarse.energy, fine.energy),
        segment_tension=tension,
        dt=coarse.dt,
        reason=coarse.reason + SAID,
        work=type(fine.work)(*(a + b for a, b in zip(astuple(coarse.work), astuple(fine.work), strict=True))),
        error_estimate=float(WEIGHT * np.linalg.norm(fine.q - coarse.q, axis=2).max()),
        wall_time=coarse.wall_time + fine.wall_time,
    )


def _beyond(coarse, fine):
    return fine + WEIGHT * (fine - coarse)
