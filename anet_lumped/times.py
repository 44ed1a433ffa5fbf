"""Times that a run must meet: those it saves and those that no step may cross."""

import numpy as np

from .scene import Driven

SAVES = 400  # states that come back when nothing else is asked for
RESTING = 1e-6  # of a path's whole way: what a driven point may move within a piece and still be called at rest


def save_times(t0, t_end, save_every):
    """Times at which a run with steps of its own saves: every ``save_every``, or `SAVES` of them, and the end.

    Returns
    -------
    t : increasing (k,) float64 [s]
    """
    if save_every is None:
        return np.linspace(t0, t_end, SAVES + 1)
    times = np.minimum(t0 + np.arange(0.0, (t_end - t0) * (1 + 1e-12), save_every), t_end)
    return times if t_end - times[-1] < 1e-9 * (t_end - t0) else np.append(times, t_end)


def stops(scene):
    """Times that no step may cross: the corners of driven points' paths, and where one sets out after a rest.

    At rest an adaptive step grows without bound and could pass over a short motion altogether; a solver that starts
    afresh where the motion sets out cannot.

    Returns
    -------
    stops : increasing (k,) float64 [s]
    """
    found = [np.zeros(0)]
    for point in scene.points:
        if isinstance(point, Driven):
            path = point.path
            lasting = np.diff(path.breaks)[:, None] ** np.arange(1, path.coefficients.shape[1])
            way = np.einsum("kix,ki->k", np.abs(path.coefficients[:-1, 1:]), lasting)  # at least the way of each piece
            moves = np.append(way > RESTING * way.sum(), True)
            sets_out = moves & np.append(True, ~moves[:-1])
            found += [path.corners, path.breaks[sets_out]]
    return np.unique(np.concatenate(found))
